"""The page Statistics: yield by shift and recipe, defects by angle and reason, trends with limits, times."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QPushButton, QStackedWidget, QVBoxLayout, QWidget

from station.analysis.report.page import report
from station.analysis.statistics import Summary, summarise
from station.archive.reader import Query, find, read_records, read_words
from station.archive.schema import NAME as INDEX
from station.channel.requests import Answer, ResetCounts
from station.domain import Verdict
from station.files.durable import write_whole
from station.journal.users import Level
from station.panel.look.words import data, translate
from station.panel.pages.page import Page
from station.panel.session.session import Session
from station.panel.widgets.card import Choice, Table, label, titled
from station.panel.widgets.charts import Chart
from station.panel.widgets.dialogs import ask_file
from station.panel.widgets.progress import Progress
from station.panel.widgets.weld.clock_face import ClockFace
from station.panel.widgets.work import WorkBar
from station.records import Record
from station.settings.model import for_recipe
from station.vision.seen import CHECKS

PARTS = (100, 300, 1000, 5000)
"""Numbers of the newest parts to choose from."""


class StatisticsPage(Page):
    """Reads the archive when the page is first shown, and on request."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.summary: Summary | None = None
        self.groups = Table(
            (
                translate("statistics", "shift"),
                translate("statistics", "recipe"),
                "OK",
                "NOK",
                translate("statistics", "not judged"),
                translate("statistics", "yield"),
            ),
            stretch=0,
        )
        self._lay_out()
        self._work.failed.connect(self.problem.setText)
        self.how_many.currentIndexChanged.connect(self.read)
        session.account.changed.connect(self._on_user)
        self._on_user()
        self._first = QTimer(self)
        self._first.setInterval(300)
        self._first.timeout.connect(self._when_seen)
        self._first.start()

    def _lay_out(self) -> None:
        self.how_many = Choice()
        last = translate("statistics", "the last")
        for count in PARTS:
            self.how_many.addItem(f"{last} {count}", count)
        self.how_many.setCurrentIndex(1)
        self.read_again, self.report = (
            QPushButton(translate("statistics", "Refresh")),
            QPushButton(translate("statistics", "Report…")),
        )
        self.read_again.clicked.connect(self.read)
        self.report.clicked.connect(self._ask_report)
        self._work, self.problem, self._message = WorkBar(), label("", "problem"), label("", "quiet")
        self.zero = QPushButton(translate("statistics", "Reset counters"))
        self.zero.setToolTip(
            translate(
                "statistics", "Set the counters of the page Live and of the PLC to 0. The journal records it."
            )
        )
        self.zero.clicked.connect(self._reset)
        top = QHBoxLayout()
        for widget in (self.how_many, self.read_again, self.report, self.zero, self.problem, self._message):
            top.addWidget(widget)
        top.addStretch(1)
        self.view = Choice()
        for text in (translate("statistics", "whole strip"), translate("statistics", "worst segment")):
            self.view.addItem(text)
        self.view.setToolTip(
            translate(
                "statistics", "Dirt on the glass shows in the worst segment weeks before it costs an OK."
            )
        )
        top.insertWidget(1, self.view)
        self.clock = ClockFace()
        self.reasons = Chart(translate("statistics", "reasons"))
        grey_levels = translate("statistics", "grey levels")
        self.trends = {
            "worst": Chart(translate("statistics", "worst score of a part")),
            "mean_dn": Chart(translate("statistics", "mean brightness"), grey_levels),
            "sharpness": Chart(translate("statistics", "sharpness")),
            "saturated": Chart(translate("statistics", "saturated fraction")),
            "novelty": Chart(translate("statistics", "distance to the training images")),
        }
        worst = translate("statistics", "worst segment")
        self.segment_trends = {
            "mean_dn": Chart(f"{worst}: " + translate("statistics", "brightness"), grey_levels),
            "contrast": Chart(f"{worst}: " + translate("statistics", "contrast")),
            "sharpness": Chart(f"{worst}: " + translate("statistics", "sharpness")),
            "saturated_fraction": Chart(f"{worst}: " + translate("statistics", "saturated fraction")),
            "weld": Chart(f"{worst}: " + translate("statistics", "fraction with a weld")),
            "visible": Chart(f"{worst}: " + translate("statistics", "visible fraction")),
        }
        self.cycle = Chart(translate("statistics", "inspection time"), "ms")
        trends = self.trends
        upper = (trends["worst"], trends["mean_dn"], trends["sharpness"])
        stack = QStackedWidget()
        stack.addWidget(_in_two_rows((*upper, self.cycle, trends["saturated"], trends["novelty"])))
        stack.addWidget(_in_two_rows(tuple(self.segment_trends.values())))
        self.view.currentIndexChanged.connect(stack.setCurrentIndex)
        grid = QGridLayout()
        grid.addWidget(titled(translate("statistics", "shifts and recipes"), self.groups), 0, 0, 1, 6)
        grid.addWidget(titled(translate("statistics", "NOK segments by angle"), self.clock), 0, 6, 1, 3)
        grid.addWidget(self.reasons, 0, 9, 1, 3)
        grid.addWidget(stack, 1, 0, 2, 12)
        for column in range(12):
            grid.setColumnStretch(column, 1)
        for row in range(3):
            grid.setRowStretch(row, 1)
        rows = QVBoxLayout(self)
        rows.addLayout(top)
        rows.addWidget(self._work)
        rows.addLayout(grid, 1)

    def _on_user(self) -> None:
        hint = (
            ""
            if self._session.account.may(Level.OPERATOR)
            else translate("statistics", "Log in first (page Setup).")
        )
        self.report.setEnabled(not hint)
        self.report.setToolTip(hint)
        self.zero.setEnabled(self._session.account.may(Level.SETTER))

    def _reset(self) -> None:
        self.zero.setEnabled(False)
        self._session.account.ask(ResetCounts(), self._on_reset, self)

    def _on_reset(self, answer: Answer) -> None:
        self.problem.setText(data(answer.refusal) if answer.refusal else "")
        self._on_user()

    def _when_seen(self) -> None:
        if self.isVisible():
            self._first.stop()
            self.read()

    def read(self) -> None:
        """Read the records of the chosen number of parts next to the window and show them."""
        folder, limit = self._session.received.folder, int(self.how_many.currentData())
        title = translate("statistics", "Reading records")
        self._work.start(title, lambda progress: summarise(_records(folder, limit, progress)), self._show)

    def _show(self, summary: Summary) -> None:
        self.summary = summary
        self.problem.setText("" if summary.points else translate("statistics", "No parts yet."))
        self.groups.fill(
            [
                (
                    group.shift,
                    str(group.recipe),
                    str(group.ok),
                    str(group.nok),
                    str(group.error),
                    f"{group.yield_share:.1%}",
                )
                for group in summary.groups
            ]
        )
        self.clock.show_counts(summary.segments)
        self.reasons.show_bars([(data(name), count) for name, count in summary.reasons[:5]])
        bad = [point.verdict is not Verdict.OK for point in summary.points]
        status = self._session.received.status
        recipe = 1 if status is None else status.recipe
        quality = for_recipe(self._session.received.settings, recipe).quality
        limits: dict[str, list[float]] = {
            "worst": list(summary.thresholds),
            "mean_dn": [quality.min_mean_dn],
            "sharpness": [quality.min_sharpness],
            "saturated": [quality.max_saturated_share],
            "novelty": [],
        }
        for key, chart in self.trends.items():
            chart.show_trend([getattr(point, key) for point in summary.points], bad, limits[key])
        worst = [point.worst_segment for point in summary.points]
        for check in CHECKS:
            if check.measured in self.segment_trends:
                values = [None if own is None else getattr(own, check.measured) for own in worst]
                limit = float(getattr(quality, check.limit_name))
                self.segment_trends[check.measured].show_trend(values, bad, [limit])
        self.cycle.show_histogram([point.cycle_ms for point in summary.points])

    def _ask_report(self) -> None:
        path = ask_file(self, self._session, translate("statistics", "Report file"), "report.html")
        if path is not None:
            self.write_report(path)

    def write_report(self, target: Path) -> None:
        """Write a report on the chosen number of parts as one HTML file, next to the window."""
        folder, limit = self._session.received.folder, int(self.how_many.currentData())

        def work(progress: Progress) -> str | None:
            entries = []
            for count, entry in enumerate(read_records(folder, Query(newest_first=True, limit=limit))):
                if not progress(count, limit):
                    return None
                entries.append(entry)
            page = report(entries[::-1], folder, "weldgate")
            write_whole(target, page.encode("utf-8", "backslashreplace"))
            return str(target)

        self._work.start(translate("statistics", "Writing the report"), work, self._message.setText)

    def close_page(self) -> None:
        """Stop timer and work."""
        self._first.stop()
        self._work.close_work()


def _in_two_rows(charts: Sequence[Chart]) -> QWidget:
    """Return six charts in two rows."""
    inside = QWidget()
    grid = QGridLayout(inside)
    grid.setContentsMargins(0, 0, 0, 0)
    for index, chart in enumerate(charts):
        grid.addWidget(chart, *divmod(index, 3))
    return inside


def _records(folder: Path, limit: int, progress: Progress) -> Iterator[Record]:
    rows = find(folder, Query(newest_first=True, limit=limit)) if (folder / INDEX).exists() else []
    for count, row in enumerate(rows):
        if not progress(count, len(rows)):
            return
        record, _ = read_words(folder, row)
        if record is not None:
            yield record
