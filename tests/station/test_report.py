"""The report: everything in one file, and what it says is what the records say."""

import re
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.__main__ import main
from station.analysis.report.figures import BAD, TEXT, angle_counts, bars, clock_face, trend
from station.archive.writer import Archive
from station.defects import Reason
from station.domain import SEGMENTS, Frame, Image, Inspection, Origin, Purpose
from station.records import Part
from station.settings.model import ArchiveSettings
from tests.parts import label_with, nok_inspection, ok_inspection, provenance

NOON = datetime(2026, 11, 22, 12, tzinfo=UTC)


@pytest.fixture
def folder(tmp_path: Path, frames: dict[str, Image]) -> Path:
    archive = Archive(ArchiveSettings(folder=tmp_path / "a", min_free_mb=1, thin_free_mb=1, warn_free_mb=1))
    image = frames[label_with("hole")["frame"]]
    found = [
        ok_inspection(),
        nok_inspection(),
        Inspection.error(Reason.NO_WELD_FOUND),
        nok_inspection(),
        ok_inspection(),
    ]
    for number, inspection in enumerate(found):
        when = NOON + timedelta(minutes=number)
        purpose = Purpose.TEST if number == 4 else Purpose.PART
        part = Part(f"<CELL & {number}>", number + 1, Origin.SIMULATED, purpose)
        frame = Frame(image, when, "cam", Origin.SIMULATED) if number == 3 else None
        record = archive.commit(archive.begin(frame), inspection, part, provenance(), now=when)
        archive.mark_shown(record.inspection_id, number != 1)
    archive.close()
    return tmp_path / "a"


def test_the_page_says_what_the_records_say_and_needs_nothing_else(folder: Path, tmp_path: Path) -> None:
    assert main(["records", "report", str(folder), str(tmp_path / "r.html"), "--title", "Lot <7>"]) == 0
    page = (tmp_path / "r.html").read_text()
    rows = dict(re.findall(r"<tr><th>([^<]+)</th><td>([^<]+)</td></tr>", page))
    assert (rows["parts"], rows["OK"], rows["NOK"], rows["ERROR"], rows["yield"]) == (
        "4",
        "1",
        "2",
        "1",
        "25.0%",
    )
    assert rows["not shown to the PLC"] == "1"
    assert page.count("data:image/jpeg;base64,") == 1
    assert page.count("no image") == 1
    assert "Lot &lt;7&gt;" in page
    assert "&lt;CELL &amp; 3&gt;" in page
    assert "<CELL" not in page
    assert not re.search(r'(src|href)="(?!data:)', page)


def test_a_report_as_pdf(folder: Path, tmp_path: Path) -> None:
    assert main(["records", "report", str(folder), str(tmp_path / "r.pdf")]) == 0
    assert (tmp_path / "r.pdf").read_bytes()[:5] == b"%PDF-"


def test_records_with_problems_are_in_the_report_and_in_the_exit_code(folder: Path, tmp_path: Path) -> None:
    next(folder.rglob("00000004.png")).write_bytes(b"x")
    assert main(["records", "report", str(folder), str(tmp_path / "r.html")]) == 1
    page = (tmp_path / "r.html").read_text()
    assert "its frame 2026-11-22/00000004.png was modified" in page
    assert "cannot be read" in page


def test_no_parts_and_no_place_are_one_line(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["records", "report", str(folder), str(tmp_path / "r.html"), "--serial", "nobody"]) == 2
    assert "contain no parts" in capsys.readouterr().err
    assert main(["records", "report", str(folder), str(tmp_path / "absent" / "r.html")]) == 2
    assert not (tmp_path / "r.html").exists()


@given(st.lists(st.lists(st.booleans(), min_size=SEGMENTS, max_size=SEGMENTS), max_size=9))
def test_figures_hold_for_any_counts(parts: list[list[bool]]) -> None:
    counts = angle_counts(parts)
    assert sum(counts) == sum(map(sum, parts))
    face, chart = clock_face(counts), bars([("hole", sum(counts))])
    assert [label.text for label in face.labels if label.colour == TEXT] == [
        str(i) for i in range(1, SEGMENTS + 1)
    ]
    assert [label.text for label in face.labels if label.colour == BAD] == [
        str(count) for count in counts if count
    ]
    assert len(face.sectors) == SEGMENTS + sum(count > 0 for count in counts)
    line = trend([None, *map(float, counts)], [True] * (SEGMENTS + 1), "x", 0.5)
    places = [value for at in (*face.labels, *chart.labels, *line.dots) for value in (at.x_px, at.y_px)]
    assert all(0 <= value <= 520 for value in places)
