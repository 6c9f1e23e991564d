"""What the operator looks at: the picture, the lamp, the part, the last NOK, where defects lie."""

import time

from PySide6.QtCore import QTimer
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QPushButton, QSizePolicy, QVBoxLayout, QWidget

from station.domain import SEGMENTS, Verdict
from station.panel.card import Facts, label, titled
from station.panel.live.clock_face import ClockFace
from station.panel.live.lamp_state import lamp
from station.panel.live.strip_view import StripView
from station.panel.live.verdict_lamp import VerdictLamp
from station.panel.live.weld_view import WeldView
from station.panel.page import Page
from station.panel.pictures import drawn, nok_scores, strip_image
from station.panel.session import Session
from station.panel.words import translate
from station.panel.work import Told, WorkBar
from station.settings import for_recipe

AGE_MS = 200


class LivePage(Page):
    """Built from the session; follows it."""

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
                "picture": translate("live", "picture"),
                "parts": translate("live", "parts"),
                "ok": "OK",
                "nok": "NOK",
                "error": translate("live", "not judged"),
                "yield": translate("live", "yield"),
            },
            columns=2,
        )
        self._nok_strip, self._nok_text = StripView(70), label("–", "quiet")
        self.test = QPushButton(translate("live", "Test picture"))
        self.test.setToolTip(translate("live", "Take a picture of what lies there now and judge it; the PLC is told nothing"))
        self.test.clicked.connect(lambda: session.test_picture())
        self.show_map = QPushButton(translate("live", "Defect map"))
        self.show_map.setToolTip(translate("live", "Where the network sees defects in the last NOK part"))
        self.show_map.clicked.connect(self._ask_map)
        self._work = WorkBar()
        self._work.done.connect(self._nok_strip.show_map)
        self._work.failed.connect(lambda why: self._nok_text.setText(why))
        self._lay_out()
        session.status_changed.connect(self._on_status)
        session.part_came.connect(self._on_part)
        session.preview_came.connect(self._on_preview)
        self._ageing = QTimer(self)
        self._ageing.timeout.connect(self.age)
        self._ageing.start(AGE_MS)
        self._on_status()
        self._on_part()
        self._on_preview()
        self.age()

    def _lay_out(self) -> None:
        side = QWidget()
        side.setFixedWidth(380)
        column = QVBoxLayout(side)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.lamp, 3)
        column.addWidget(self.facts)
        column.addWidget(titled(translate("live", "NOK segments of the last parts"), self.clock), 3)
        buttons = QHBoxLayout()
        for button in (self.test, self.show_map):
            button.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
            buttons.addWidget(button)
        column.addLayout(buttons)
        pinned = QWidget()
        rows = QVBoxLayout(pinned)
        rows.setContentsMargins(0, 0, 0, 0)
        rows.addWidget(self._nok_strip)
        last = titled(translate("live", "last NOK"), pinned)
        foot = last.layout()
        if foot is not None:
            foot.addWidget(self._nok_text)
            foot.addWidget(self._work)
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
        status = self._session.status
        if status is None:
            return
        c = status.counts
        share = f"{c.ok / c.total:.1%}" if c.total else "–"
        self.facts.set(parts=c.total, ok=c.ok, nok=c.nok, error=c.error, recipe=status.recipe, **{"yield": share})
        self.age()

    def _on_part(self) -> None:
        last = self._session.last
        if last is None:
            return
        event, record = last.event, last.event.record
        t = record.inspection.timing
        steps = (t.grab_ms, t.locate_ms, t.unwrap_ms, t.classify_ms, event.record_ms, event.publish_ms)
        drifting = event.drift is not None and event.drift.alarm
        known = translate("live", "known")
        picture = translate("live", "UNLIKE TRAINING") if event.novel else translate("live", "DRIFTING") if drifting else known
        cycle = f"{sum(ms for ms in steps if ms is not None):.0f} ms"
        self.facts.set(part=record.inspection_id, serial=record.serial or "–", picture=picture, cycle=cycle)
        counts = [0] * SEGMENTS
        for heard in self._session.parts:
            for index, nok in enumerate(heard.event.seg_nok):
                counts[index] += nok
        self.clock.show_counts(tuple(counts))
        self._show_picture()
        self.age()

    def _on_preview(self) -> None:
        self._show_picture()
        pinned = self._session.last_nok
        self.show_map.setEnabled(pinned is not None)
        if pinned is not None:
            event, preview = pinned
            record = event.record
            text = f"{record.inspection_id}  {record.serial}  {record.grabbed_at.astimezone():%H:%M:%S}"
            if text != self._nok_text.text():
                self._nok_text.setText(text)
                self._nok_strip.show_strip(strip_image(preview), nok_scores(record), event.seg_nok)

    def _show_picture(self) -> None:
        """The last part's own picture; else, darkened, the one before, and said so."""
        last, preview = self._session.last, self._session.preview
        if preview is None or last is None:
            return
        record = last.event.record
        if preview.inspection_id == record.inspection_id:
            self.weld.show_weld(drawn(preview, last.event))
            self.strip.show_strip(strip_image(preview), nok_scores(record), last.event.seg_nok)
        else:
            note = translate("live", "no picture of this part") + f"\n({preview.inspection_id})"
            self.weld.show_weld(drawn(preview, None), note)
            self.strip.show_strip(None, nok_scores(record), last.event.seg_nok)

    def age(self) -> None:
        """Lamps fade with time."""
        session = self._session
        last, now = session.last, time.monotonic()
        status = session.status
        self.test.setEnabled(session.engine_there and status is not None and status.camera_there)
        part_age_s = now - last.at_s if last is not None else 1e9
        foot = "" if last is None else f"{last.event.record.serial or last.event.record.inspection_id} · {min(part_age_s, 9999):.0f} s"
        self.lamp.show_lamp(lamp(status, session.status_age_s, last.event if last else None, part_age_s), foot)

    def _ask_map(self) -> None:
        pinned = self._session.last_nok
        if pinned is None or pinned[0].record.verdict is not Verdict.NOK:
            return
        record, folder = pinned[0].record, self._session.folder
        settings, number = self._session.settings, record.provenance.recipe

        def work(_told: Told) -> QImage:
            from station.panel.kept import defect_map  # only who asks pays for the network
            from station.recipe import load_inspector

            return defect_map(load_inspector(for_recipe(settings, number))[0].classifier, folder, record)

        self._work.start(translate("live", "defect map"), work)

    def close_page(self) -> None:
        """Nothing is left running."""
        self._ageing.stop()
        self._work.close_work()
