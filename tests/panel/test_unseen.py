"""A segment that was not seen looks like neither OK nor NOK, and says why."""

from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QEvent, QPoint
from PySide6.QtGui import QHelpEvent, QImage
from PySide6.QtWidgets import QApplication, QToolTip
from pytestqt.qtbot import QtBot

from station.analysis.statistics import summarise
from station.archive.writer import Archive
from station.defects import Reason
from station.domain import SEGMENTS, Inspection, Origin, Purpose
from station.panel.look import theme, words
from station.panel.pages.history.record_view import RecordView
from station.panel.pages.live.page import LivePage
from station.panel.pages.statistics.page import StatisticsPage
from station.panel.pages.table import PageKey
from station.panel.session.lamp import lamp
from station.panel.widgets.weld.strip_view import LABEL_PX, StripView
from station.panel.window import Window
from station.records import Part
from station.settings.model import ArchiveSettings
from station.settings.quality import QualitySettings
from tests.panel.made import part, status
from tests.parts import nok_inspection, ok_inspection, provenance, record, segment_quality, unseen_inspection

WIDTH_PX = 21 * 50


@pytest.fixture
def strip(qtbot: QtBot) -> StripView:
    made = StripView()
    qtbot.addWidget(made)
    made.resize(WIDTH_PX, 130)
    return made


def cell_color(strip: StripView, segment: int) -> str:
    """Colour in the corner of the cell of a segment."""
    x_px = (segment - 1) * 50 + 4
    return str(strip.grab().toImage().pixelColor(x_px, strip.height() - LABEL_PX + 4).name())


def test_an_unseen_segment_differs_from_a_good_and_from_a_bad_one(strip: StripView) -> None:
    bad = nok_inspection()
    both = replace(bad, unseen=unseen_inspection().unseen)
    strip.show_strip(QImage(), both)
    assert strip.causes == {5: "too dark"}
    assert strip.scores[4] is None
    colors = theme.colors()
    assert [cell_color(strip, number) for number in (4, 5, 6)] == [colors.bad, colors.warn, colors.surface]
    strip.show_strip(QImage(), replace(both, unseen=(None,) * SEGMENTS))
    assert strip.causes == {}
    strip.show_strip(None, None)
    assert (strip.scores, strip.causes) == ((), {})


def test_the_cause_is_told_where_the_pointer_is_in_the_language_in_use(strip: StripView) -> None:
    strip.show_strip(QImage(), unseen_inspection())
    for language, cause in (("en", "too dark"), ("de", "zu dunkel")):
        words.use(language)
        at = QPoint(4 * 50 + 25, 10)
        QApplication.sendEvent(strip, QHelpEvent(QEvent.Type.ToolTip, at, strip.mapToGlobal(at)))
        assert QToolTip.text() == cause
    strip.grab()


def test_a_rejected_segment_is_bad_even_if_it_was_not_seen(strip: StripView) -> None:
    unseen = tuple(unseen_inspection().unseen[4] if i == 3 else None for i in range(SEGMENTS))
    strip.show_strip(QImage(), replace(nok_inspection(), unseen=unseen))
    assert strip.causes == {}
    assert cell_color(strip, 4) == theme.colors().bad


def test_the_lamp_gives_the_numbers_and_says_nothing_twice() -> None:
    up = status(origin=Origin.CAMERA, at_s=1000.0)
    shown = lamp(up, part(unseen_inspection(), at_s=1000.0), 1000.0)
    assert (shown.word, shown.detail) == ("ERROR", "segment not seen")
    assert shown.more == "segment 5: too dark (mean grey level 3.0, limit 10)"
    numbers = "the best circle scores 0.10, minimum is 0.25"
    lost = Inspection.error(Reason.NO_WELD_FOUND, detail=f"no weld found: {numbers}")
    shown = lamp(up, part(lost, at_s=1000.0), 1000.0)
    assert (shown.detail, shown.more) == ("no weld found", numbers)


def test_live_shows_the_worst_segment_and_leaves_unseen_ones_out_of_the_scores(window: Window) -> None:
    window.session.bridge.status.emit(status())
    window.session.bridge.parts.emit([part(ok_inspection(), 1), part(unseen_inspection(), 2)])
    window.go(PageKey.LIVE)
    page = window.page
    assert isinstance(page, LivePage)
    assert page.strip.causes == {5: "too dark"}
    assert page.facts.values["segment"].text() == "3 · 0.30"
    page.strip.touched.emit(4)
    assert len(page.scores.scores) == 1
    page.strip.touched.emit(5)
    assert len(page.scores.scores) == 2


def test_history_shows_detail_and_worst_segment(qtbot: QtBot, tmp_path: Path) -> None:
    from station.archive.reader import find

    archive = Archive(ArchiveSettings(folder=tmp_path, min_free_mb=1, thin_free_mb=1, warn_free_mb=1))
    made = record(unseen_inspection())
    one = Part("S1", 1, Origin.SIMULATED, Purpose.PART)
    archive.commit(archive.begin(None), made.inspection, one, provenance(), now=made.grabbed_at)
    archive.close()
    view = RecordView()
    qtbot.addWidget(view)
    (row,) = find(tmp_path)
    view.show_row(tmp_path, row)
    assert "segment 5: too dark (mean grey level 3.0, limit 10)" in view.problem.text()
    assert "brightness 3" in view.worst.text()
    assert "weld 100%" in view.worst.text()
    assert view.strip.causes == {5: "too dark"}
    view.show_nothing()
    assert (view.problem.text(), view.worst.text()) == ("", "–")


def test_statistics_draw_the_worst_segment_with_its_limit(window: Window) -> None:
    dirty = replace(segment_quality(), contrast=0.06)
    inspections = [ok_inspection(), replace(ok_inspection(), segment_quality=(dirty,) * SEGMENTS)]
    window.go(PageKey.STATISTICS)
    page = window.page
    assert isinstance(page, StatisticsPage)
    page._show(summarise(record(own, number) for number, own in enumerate(inspections, 1)))
    chart = page.segment_trends["contrast"]
    (dots,) = [item for item in chart.listDataItems() if item.yData is not None]
    assert list(dots.yData) == [0.3, 0.06]
    (line,) = [item for item in chart.items() if type(item).__name__ == "InfiniteLine"]
    assert line.value() == QualitySettings().min_segment_contrast
    assert not page.segment_trends["visible"].listDataItems(), "no network tells it"
    assert not chart.isVisible()
    page.view.setCurrentIndex(1)
    assert chart.isVisibleTo(page)
