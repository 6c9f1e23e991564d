"""Errors against the truth, with their intervals and pictures."""

import csv
import json
import re
import shutil
import subprocess
import sys
import time
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from station.__main__ import main
from station.analysis.truth import errors, interval, read_truth
from station.archive.writer import Archive
from station.domain import Frame, Image, Origin
from station.errors import RecordError
from station.records import Part
from station.settings.model import ArchiveSettings
from tests.parts import FRAMES, label_with, labels, nok_inspection, ok_inspection, provenance

WORDS = st.sampled_from(["OK", "NOK", "ERROR"])
NOON = datetime(2026, 11, 22, 12, tzinfo=UTC)


@given(st.dictionaries(st.text(), st.sampled_from(["OK", "NOK"])), st.dictionaries(st.text(), WORDS))
def test_every_part_of_known_truth_is_right_or_one_kind_of_wrong(
    truth: dict[str, str], judged: dict[str, str]
) -> None:
    found = errors(truth, judged)
    known = [name for name in judged if name in truth]
    wrong = [*found.escapes, *found.false_rejects, *found.not_judged]
    assert found.ok + found.nok == len(known)
    assert len(set(wrong)) == len(wrong)
    assert set(known) - set(wrong) == {name for name in known if truth[name] == judged[name]}


@settings(deadline=None)  # the first call loads SciPy
@given(st.integers(0, 400), st.integers(1, 400))
def test_an_interval_holds_its_share(hits: int, trials: int) -> None:
    hits = min(hits, trials)
    low, high = interval(hits, trials)
    assert 0 <= low <= hits / trials <= high <= 1


def test_an_interval_of_nothing_and_of_twenty_of_twenty() -> None:
    assert interval(0, 0) == (0, 1)
    assert interval(0, 20)[1] == pytest.approx(0.1684, abs=1e-4)  # Clopper and Pearson's tables


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("t.csv", "part;truth\n", "columns name and verdict"),
        ("t.csv", "name,verdict\nA,good\n", "'A' is 'good'"),
        ("t.csv", "name,verdict\nA,OK\nA,NOK\n", "OK and NOK"),
        ("t.csv", "name,verdict\n", "contains no parts"),
        ("t.json", "[1]", "columns name and verdict"),
        ("t.json", "{", "columns name and verdict"),
    ],
)
def test_a_truth_that_cannot_be_read_is_refused_in_one_line(
    tmp_path: Path, name: str, text: str, message: str
) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(RecordError, match=re.escape(message)) as caught:
        read_truth(tmp_path / name)
    assert "\n" not in str(caught.value)
    with pytest.raises(RecordError, match="cannot be read"):
        read_truth(tmp_path / "absent.csv")


def test_a_report_shows_escapes_and_false_rejects(tmp_path: Path, frames: dict[str, Image]) -> None:
    folder = tmp_path / "records"
    archive = Archive(ArchiveSettings(folder=folder, min_free_mb=1, thin_free_mb=1, warn_free_mb=1))
    image = frames[label_with("hole")["frame"]]
    for number, inspection in enumerate(
        [ok_inspection(), nok_inspection(), ok_inspection(), nok_inspection()]
    ):
        frame = Frame(image, NOON + timedelta(minutes=number), "cam", Origin.SIMULATED)
        part = Part(f"CELL-{number}", number + 1, Origin.SIMULATED)
        archive.commit(archive.begin(frame), inspection, part, provenance(), now=frame.grabbed_at)
    archive.close()
    with (tmp_path / "truth.csv").open("w", newline="") as file:
        csv.writer(file).writerows(
            [("name", "verdict"), ("CELL-0", "NOK"), ("CELL-1", "OK"), ("CELL-2", "OK"), ("ELSEWHERE", "OK")]
        )
    assert (
        main(
            [
                "records",
                "report",
                str(folder),
                str(tmp_path / "r.html"),
                "--truth",
                str(tmp_path / "truth.csv"),
            ]
        )
        == 0
    )
    page = (tmp_path / "r.html").read_text()
    assert "1 of 1, 100.0%" in page, "one NOK part was judged OK"
    assert "1 of 2, 50.0%" in page, "one of two OK parts was judged NOK"
    escapes, rejects = page.split("<h3>Escapes")[1].split("<h3>False rejects")
    assert "CELL-0" in escapes
    assert "data:image/jpeg" in escapes
    assert "CELL-1" in rejects.split("<h2>")[0]


def test_a_replay_report_shows_flips_errors_and_bad_files(tmp_path: Path) -> None:
    folder = tmp_path / "images"
    folder.mkdir()
    for item in labels():
        shutil.copy(FRAMES / item["frame"], folder)
    (folder / "broken.png").write_bytes(b"x")
    truth = {Path(item["frame"]).stem: "NOK" if item["verdict"] == "OK" else "OK" for item in labels()}
    (tmp_path / "truth.json").write_text(json.dumps(truth))
    arguments = [
        "replay",
        str(folder),
        "--processes",
        "1",
        "--report",
        str(tmp_path / "r"),
        "--truth",
        str(tmp_path / "truth.json"),
    ]
    assert main(arguments) == 1
    page = (tmp_path / "r" / "report.html").read_text()
    ok = sum(item["verdict"] == "OK" for item in labels())
    assert f"<h2>Escapes: {ok}</h2>" in page
    assert f"<h2>False rejects: {len(labels()) - ok}</h2>" in page
    assert page.count("data:image/jpeg") == len(labels())
    assert "broken.png: not a readable image" in page
    assert not re.search(r'(src|href)="(?!data:)', page)


def test_the_processes_of_a_killed_replay_end_too(tmp_path: Path) -> None:
    for number in range(40):
        shutil.copy(FRAMES / labels()[0]["frame"], tmp_path / f"{number}.png")
    replay = subprocess.Popen(
        [sys.executable, "-m", "station", "replay", str(tmp_path), "--processes", "2"],
        stdout=subprocess.DEVNULL,
    )
    children: list[str] = []
    until = time.monotonic() + 60
    while (
        len(children) < 3 and time.monotonic() < until
    ):  # two processes, and the one that tracks what they share
        children = subprocess.run(
            ["pgrep", "-P", str(replay.pid)], capture_output=True, text=True, check=False
        ).stdout.split()
        time.sleep(0.1)
    replay.kill()
    replay.wait()
    assert len(children) >= 2
    while (
        left := [pid for pid in children if Path(f"/proc/{pid}/exe").exists()]
    ) and time.monotonic() < until:
        time.sleep(0.1)
    assert not left
