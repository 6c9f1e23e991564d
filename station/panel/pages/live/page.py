"""The page Live: verdict lamp, image and strip of the newest part, counters, the last NOK part."""

import time

from PySide6.QtCore import QTimer
from PySide6.QtGui import QHideEvent, QImage, QResizeEvent
from PySide6.QtWidgets import (
    QGridLayout,
    QHBoxLayout,
    QPushButton,
    QSizePolicy,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from station.channel.requests import Answer, TakeTestImage
from station.domain import SEGMENTS, Inspection, Purpose
from station.journal.users import Level
from station.panel.look.words import data, translate
from station.panel.pages.live.facts import caption, cycle_ms, novelty, worst
from station.panel.pages.live.score_history import ScoreHistory
from station.panel.pages.live.verdict_lamp import VerdictLamp
from station.panel.pages.page import Page
from station.panel.session.lamp import foot, lamp
from station.panel.session.received import shows
from station.panel.session.session import Session
from station.panel.widgets.card import Facts, label, titled
from station.panel.widgets.progress import Progress
from station.panel.widgets.weld.clock_face import ClockFace
from station.panel.widgets.weld.previews import drawn, drawn_part, strip_image
from station.panel.widgets.weld.strip_view import StripView
from station.panel.widgets.weld.weld_view import WeldView
from station.panel.widgets.work import WorkBar

AGE_MS = 200
"""Interval at which the lamp is shown again, as it fades with time."""
SIDE_PX, SIDE_FRACTION = 380, 0.32


class LivePage(Page):
    """Shows what the session receives."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.weld, self.strip, self.lamp, self.clock = WeldView(), StripView(), VerdictLamp(), ClockFace()
        self.facts = Facts(
            {
                "part": translate("live", "part"),
                "serial": translate("live", "serial"),
                "recipe": translate("live", "recipe"),
                "cycle": translate("live", "cycle"),
                "novelty": translate("live", "image"),
                "segment": translate("live", "worst segment"),
                "parts": translate("live", "parts"),
                "ok": "OK",
                "nok": "NOK",
                "error": translate("live", "not judged"),
                "yield": translate("live", "yield"),
            },
            columns=2,
        )
        self.nok_strip, self.nok_text = StripView(70), label("–", "quiet")
        self._nok_shown: tuple[int, bool] | None = None
        """Number of the last NOK part that is shown, and whether its image had come."""
        self.scores, self._segment = ScoreHistory(), 0
        self.strip.touched.connect(self._show_scores)
        self.nok_strip.touched.connect(lambda _: self._open_pinned())
        self.scores.touched.connect(lambda: self._angles.setCurrentWidget(self.clock))
        self.test = QPushButton(translate("live", "Test image"))
        self.test.setToolTip(
            translate("live", "Take an image now and judge it. Nothing is reported to the PLC.")
        )
        self.test.clicked.connect(self.take_test_image)
        self.hold = QPushButton(translate("live", "Hold"))
        self.hold.setToolTip(translate("live", "Keep this image on the page. Lamp and counters continue."))
        self.hold.setCheckable(True)
        self.hold.toggled.connect(self._show_image)
        self._held = False
        """True while an image is held."""
        self.show_map = QPushButton(translate("live", "Defect map"))
        self.show_map.setToolTip(
            translate("live", "Show where the network sees defects on the last NOK part")
        )
        self.show_map.clicked.connect(self._ask_map)
        self._work = WorkBar()
        self._work.failed.connect(lambda why: self.nok_text.setText(data(why)))
        self._lay_out()
        session.received.status_changed.connect(self._on_status)
        session.received.part_came.connect(self._on_part)
        session.received.preview_came.connect(self._on_preview)
        session.account.changed.connect(self.age)
        self._ageing = QTimer(self)
        self._ageing.timeout.connect(self.age)
        self._ageing.start(AGE_MS)
        self._on_status()
        self._on_part()
        self._on_preview()
        self.age()

    def _lay_out(self) -> None:
        self._side = side = QWidget()
        side.setFixedWidth(SIDE_PX)
        column = QVBoxLayout(side)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.lamp, 4)
        column.addWidget(self.facts)
        self._angles = QStackedWidget()
        for widget in (self.clock, self.scores):
            self._angles.addWidget(widget)
        column.addWidget(titled(translate("live", "NOK segments of the newest parts"), self._angles), 3)
        buttons = QHBoxLayout()
        for button in (self.test, self.show_map, self.hold):
            button.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
            buttons.addWidget(button)
        column.addLayout(buttons)
        pinned = QWidget()
        rows = QVBoxLayout(pinned)
        rows.setContentsMargins(0, 0, 0, 0)
        rows.addWidget(self.nok_strip)
        last = titled(translate("live", "last NOK"), pinned)
        below = last.layout()
        if below is not None:
            below.addWidget(self.nok_text)
            below.addWidget(self._work)
        grid = QGridLayout(self)
        grid.addWidget(self.weld, 0, 0)
        grid.addWidget(side, 0, 1, 2, 1)
        bottom = QVBoxLayout()
        bottom.addWidget(self.strip)
        bottom.addWidget(last)
        grid.addLayout(bottom, 1, 0)
        grid.setRowStretch(0, 1)
        grid.setColumnStretch(0, 1)

    def _on_status(self) -> None:
        status = self._session.received.status
        if status is None:
            return
        counts = status.line.counts
        self.facts.set(
            parts=counts.total,
            ok=counts.ok,
            nok=counts.nok,
            error=counts.error,
            recipe=status.recipe,
            **{"yield": f"{counts.ok / counts.total:.1%}" if counts.total else "–"},
        )
        self.age()

    def _on_part(self) -> None:
        last = self._session.received.last
        if last is None:
            return
        record = last.record
        self.facts.set(
            part=record.inspection_id,
            serial=record.serial or "–",
            novelty=novelty(last),
            cycle=f"{cycle_ms(last):.0f} ms",
            segment=worst(record.inspection),
        )
        counts = [0] * SEGMENTS
        for inspection in self._inspections():
            for index, nok in enumerate(inspection.nok):
                counts[index] += nok
        self.clock.show_counts(tuple(counts))
        if self._angles.currentWidget() is self.scores:
            self._show_scores(self._segment)
        self._show_image()
        self._show_pinned()
        self.age()

    def _inspections(self) -> list[Inspection]:
        """Return the inspections of the newest parts, without masters and test images."""
        parts = self._session.received.parts
        return [part.record.inspection for part in parts if part.record.purpose is Purpose.PART]

    def _on_preview(self) -> None:
        self._show_image()
        self._show_pinned()

    def _show_pinned(self) -> None:
        pinned = self._session.received.last_nok
        self.show_map.setEnabled(pinned is not None and pinned.preview is not None)
        if pinned is not None:
            part, preview = pinned.part, pinned.preview
            shown = part.record.inspection_id, preview is not None
            if shown != self._nok_shown:
                self._nok_shown = shown
                self.nok_text.setText(caption(part))
                strip = None if preview is None else strip_image(preview)
                self.nok_strip.show_strip(strip, part.record.inspection)

    def _show_image(self) -> None:
        """Show the image of the newest part; until it comes, darken the one before and say so."""
        last, preview = self._session.received.last, self._session.received.preview
        if last is None or (self.hold.isChecked() and self._held):
            return
        self._held = False
        if preview is not None and shows(preview, last):
            self._held = self.hold.isChecked()
            held = "  ·  " + translate("live", "HELD") if self._held else ""
            self.weld.show_weld(drawn_part(preview, last), caption=caption(last) + held)
            self.strip.show_strip(strip_image(preview), last.record.inspection)
        else:
            before = "" if preview is None else f"\n({preview.inspection_id})"
            note = translate("live", "no image of this part") + before
            self.weld.show_weld(None if preview is None else drawn(preview), note)
            self.strip.show_strip(None, last.record.inspection)

    def age(self) -> None:
        """Show the lamp as it is now: it fades with time."""
        session = self._session
        last, now = session.received.last, time.monotonic()
        status = session.received.status
        there = session.received.engine_there and status is not None and status.camera_there
        self.test.setEnabled(there and session.account.may(Level.OPERATOR))
        self.lamp.show_lamp(lamp(status, last, now), foot(last, now))

    def _ask_map(self) -> None:
        pinned = self._session.received.last_nok
        if pinned is None:
            return
        record, settings = pinned.part.record, self._session.received.settings

        def work(_progress: Progress) -> tuple[int, QImage]:
            from station.panel.widgets.weld.recorded import defect_map  # loads the network: on request only

            return defect_map(settings, record)

        self._work.start(translate("live", "Computing the defect map"), work, self._on_map)

    def take_test_image(self) -> None:
        """Ask the engine for a test image."""
        self._session.account.ask(TakeTestImage(), self._on_answer, self)

    def _on_answer(self, answer: Answer) -> None:
        if not answer.done:
            self.nok_text.setText(data(answer.refusal))

    def _on_map(self, made: tuple[int, QImage]) -> None:
        number, overlay = made
        if self._nok_shown is not None and self._nok_shown[0] == number:  # else another NOK part has come
            self.nok_strip.show_map(overlay)

    def _show_scores(self, segment: int) -> None:
        """Show the scores of one segment over the newest parts, the oldest first."""
        self._segment = segment
        shown = [
            (score, inspection.nok[segment])
            for inspection in self._inspections()
            if inspection.scores and (score := inspection.nok_scores[segment]) is not None
        ]
        parts, name = translate("live", "parts"), translate("live", "segment")
        foot = f"{name} {segment + 1} · {len(shown)} {parts}"
        self.scores.show_scores([score for score, _ in shown], [nok for _, nok in shown], foot)
        self._angles.setCurrentWidget(self.scores)

    def _open_pinned(self) -> None:
        if self._nok_shown is not None and self._nok_shown[0] > 0:
            self._session.part_chosen.emit(self._nok_shown[0])

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        """Make the lamp larger on a larger screen, as it is read from afar."""
        super().resizeEvent(event)
        self._side.setFixedWidth(max(SIDE_PX, int(self.width() * SIDE_FRACTION)))

    def hideEvent(self, event: QHideEvent) -> None:  # noqa: N802 - Qt's name
        """Release a held image when the page is left."""
        self.hold.setChecked(False)
        super().hideEvent(event)

    def close_page(self) -> None:
        """Stop timer and work."""
        self._ageing.stop()
        self._work.close_work()
