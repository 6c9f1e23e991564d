"""Results of a replay: one JSON form, the same to the bit through files and processes."""

import json
import pickle
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import station.replay.run
from station.__main__ import main
from station.archive.writer import Archive
from station.defects import Reason
from station.domain import (
    SEGMENTS,
    Finding,
    Frame,
    Inspection,
    Origin,
    SegmentQuality,
    Timing,
    Unseen,
    Verdict,
)
from station.inspection.inspector import Inspector
from station.records import Part
from station.replay.compare import compare
from station.replay.files import Source, sources
from station.replay.judge import as_replayed
from station.replay.replayed import Circle, Replayed
from station.replay.results import as_entry, from_entry, write_csv, write_json
from station.settings.model import ArchiveSettings
from tests.parts import FRAMES, label_with, ok_inspection, provenance, segment_quality

NUMBER = st.floats(allow_nan=False)
MAYBE = st.none() | NUMBER
FINDING = st.builds(
    Finding,
    kind=st.sampled_from(Reason),
    start_deg=st.floats(-360, 360),
    end_deg=st.floats(360, 1080),
    length_mm=NUMBER,
    score=NUMBER,
    width_mm=MAYBE,
    area_mm2=MAYBE,
)
QUALITY = st.builds(
    SegmentQuality,
    mean_dn=NUMBER,
    dark_fraction=NUMBER,
    saturated_fraction=NUMBER,
    contrast=NUMBER,
    sharpness=NUMBER,
    fine_structure=NUMBER,
    weld=NUMBER,
    visible=MAYBE,
)
INSPECTED = st.builds(
    Replayed,
    name=st.text(),
    verdict=st.sampled_from(Verdict),
    reason=st.none() | st.text(),
    circle=st.none() | st.builds(Circle, NUMBER, NUMBER, NUMBER),
    scores=st.just(()) | st.tuples(NUMBER, *[MAYBE] * (SEGMENTS - 1)),
    detail=st.none() | st.text(),
    unseen=st.just(()) | st.tuples(*[st.none() | st.sampled_from(Unseen)] * SEGMENTS),
    segment_quality=st.just(()) | QUALITY.map(lambda quality: (quality,) * SEGMENTS),
    findings=st.lists(FINDING, max_size=3).map(tuple),
    novelty=MAYBE,
    inspection_ms=NUMBER,
    warnings=st.lists(st.text(), max_size=2).map(tuple),
)
NOT_INSPECTED = st.builds(Replayed, name=st.text(), verdict=st.just(Verdict.ERROR), reason=st.text())

HOLE = Finding(kind=Reason.HOLE, start_deg=12.5, end_deg=17.0, length_mm=0.3, score=0.75, width_mm=0.25)
JUDGED = Replayed(
    name="a.png",
    verdict=Verdict.NOK,
    reason="hole",
    circle=Circle(100.5, 99.25, 80.0),
    scores=(0.75, *[0.125] * 19, None),
    detail="segment 21: covered (0 % of it visible, limit 50 %)",
    unseen=(None,) * 20 + (Unseen.COVERED,),
    segment_quality=(replace(segment_quality(), visible=0.0),) * SEGMENTS,
    findings=(HOLE,),
    novelty=1.5,
    inspection_ms=40.25,
)
UNREADABLE = Replayed(name="b.png", verdict=Verdict.ERROR, reason="b.png: not a readable image")
JUDGED_ENTRY = {
    "center": [100.5, 99.25],
    "radius": 80.0,
    "verdict": "NOK",
    "reason": "hole",
    "detail": "segment 21: covered (0 % of it visible, limit 50 %)",
    "segments": [0.75, *[0.125] * 19, None],
    "unseen": [None] * 20 + ["covered"],
    "segment_quality": [
        {
            "mean_dn": 100.0,
            "dark_fraction": 0.0,
            "saturated_fraction": 0.0,
            "contrast": 0.3,
            "sharpness": 0.1,
            "fine_structure": 1.0,
            "weld": 1.0,
            "visible": 0.0,
        }
    ]
    * SEGMENTS,
    "unwrap_start_deg": 0.0,
    "direction": "cw",
    "findings": [
        {
            "kind": "hole",
            "start_deg": 12.5,
            "end_deg": 17.0,
            "length_mm": 0.3,
            "score": 0.75,
            "width_mm": 0.25,
            "area_mm2": None,
        }
    ],
    "novelty": 1.5,
    "inspection_ms": 40.25,
}
UNREADABLE_ENTRY = {
    "verdict": "ERROR",
    "reason": "b.png: not a readable image",
    "segments": [None] * SEGMENTS,
    "findings": [],
}


@given(INSPECTED | NOT_INSPECTED)
def test_the_json_form_is_read_back_to_the_bit(replayed: Replayed) -> None:
    text = json.dumps(as_entry(replayed))
    again = from_entry(replayed.name, json.loads(text), replayed.warnings)
    assert again == replayed
    assert json.dumps(as_entry(again)) == text
    assert pickle.loads(pickle.dumps(replayed)) == replayed


def test_the_file_has_the_documented_form_byte_for_byte(tmp_path: Path) -> None:
    write_json(tmp_path / "out.json", [JUDGED, UNREADABLE])
    expected = json.dumps({"a.png": JUDGED_ENTRY, "b.png": UNREADABLE_ENTRY}, indent=1)
    assert (tmp_path / "out.json").read_text() == expected


def test_the_table_has_one_row_per_image(tmp_path: Path) -> None:
    write_csv(tmp_path / "out.csv", [JUDGED, UNREADABLE])
    assert (tmp_path / "out.csv").read_text().splitlines() == [
        "file,verdict,reason,center_x_px,center_y_px,radius_px,worst_p_nok,detail",
        'a.png,NOK,hole,100.5,99.25,80.0,0.75,"segment 21: covered (0 % of it visible, limit 50 %)"',
        "b.png,ERROR,b.png: not a readable image,,,,,",
    ]


@pytest.mark.parametrize(
    "damaged",
    [
        {},
        {**JUDGED_ENTRY, "verdict": "FINE"},
        {**JUDGED_ENTRY, "center": []},
        {**JUDGED_ENTRY, "segments": None},
        {**JUDGED_ENTRY, "findings": [{"kind": "a word"}]},
        {**JUDGED_ENTRY, "findings": ["hole"]},
    ],
)
def test_an_entry_of_another_form_is_an_error(damaged: dict[str, object]) -> None:
    with pytest.raises((ValueError, KeyError, TypeError, AttributeError, IndexError)):
        from_entry("a.png", damaged)  # type: ignore[arg-type]


def test_an_error_of_the_line_without_a_ring_is_inspected_but_has_no_scores() -> None:
    line = "no weld found: the best circle scores 0.10, minimum is 0.25"
    inspection = Inspection.error(Reason.NO_WELD_FOUND, timing=Timing(locate_ms=3.0), detail=line)
    found = as_replayed("a.png", inspection)
    assert found.problem is None
    assert found.worst is None
    entry = as_entry(found)
    assert (entry["center"], entry["segments"], entry["inspection_ms"]) == (None, [None] * SEGMENTS, 3.0)
    assert (entry["detail"], entry["unseen"], entry["segment_quality"]) == (line, None, None)


def test_a_continued_run_equals_an_uninterrupted_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, out = tmp_path / "images", tmp_path / "out.json"
    folder.mkdir()
    for name in ("OK", "hole"):
        (folder / f"{name}.png").write_bytes((FRAMES / label_with(name)["frame"]).read_bytes())
    (folder / "a.png").write_text("not an image")
    command = ["replay", str(folder), "--json", str(out), "--processes", "1"]
    assert main(command) == 1, "one image is not readable"
    whole = json.loads(out.read_text())
    assert whole["a.png"] == {**UNREADABLE_ENTRY, "reason": whole["a.png"]["reason"]}
    judge = station.replay.run.judge_image
    judged: list[str] = []

    def until_the_last(inspector: Inspector, source: Source) -> Replayed:
        judged.append(source.name)
        if judged == ["OK.png", "a.png", "hole.png"]:
            raise KeyboardInterrupt
        return judge(inspector, source)

    monkeypatch.setattr(station.replay.run, "judge_image", until_the_last)
    assert main(command) == 130
    part = tmp_path / "out.json.part"
    key, line = part.read_text().splitlines()
    mark, kept = json.loads(line)
    assert kept == {"name": "OK.png", "entry": kept["entry"], "problem": None, "warnings": []}
    damaged = ('[["no mark"], {}]', json.dumps([mark, {"name": "OK.png"}]), '["cut off in the mid')
    part.write_text("\n".join((key, line, *damaged)))
    assert main(command) == 1
    assert judged == ["OK.png", "a.png", "hole.png", "a.png", "hole.png"]
    continued = json.loads(out.read_text())
    assert continued["OK.png"] == kept["entry"], "to the bit, with the time it took"
    assert list(continued) == list(whole)
    assert _untimed(continued) == _untimed(whole)


def _untimed(entries: dict[str, dict[str, object]]) -> dict[str, dict[str, object]]:
    return {name: {**entry, "inspection_ms": None} for name, entry in entries.items()}


@pytest.mark.parametrize("name", ["records", "2026-11-22"])
def test_the_archive_of_an_image_is_known_whatever_its_name(tmp_path: Path, name: str) -> None:
    image = cv2.imread(str(FRAMES / label_with("OK")["frame"]), cv2.IMREAD_GRAYSCALE)
    assert image is not None
    folder = tmp_path / name
    archive = Archive(ArchiveSettings(folder=folder, min_free_mb=1, thin_free_mb=1, warn_free_mb=1))
    grabbed_at, made_by = datetime(2026, 11, 22, 12, tzinfo=UTC), provenance()
    frame = Frame(np.asarray(image, np.uint8), grabbed_at, "cam", Origin.SIMULATED)
    part = Part("S1", 1, Origin.SIMULATED)
    archive.commit(archive.begin(frame), ok_inspection(), part, made_by, now=grabbed_at)
    archive.close()
    (tmp_path / "other.png").write_bytes(next(folder.rglob("*.png")).read_bytes())
    recorded, other = sources([folder, tmp_path / "other.png"])
    assert (recorded.archive, other.archive) == (folder, None)
    same = as_replayed(recorded.name, ok_inspection())
    agreed = compare([recorded, other], {recorded.name: same, other.name: UNREADABLE}, made_by)
    assert (agreed.compared, agreed.same_judge, agreed.not_alike, agreed.flips) == (1, 1, (), ())
    moved = replace(same, findings=(HOLE,))
    assert compare([recorded], {recorded.name: moved}, made_by).not_alike == (recorded.name,)
    flipped = replace(same, verdict=Verdict.NOK)
    (flip,) = compare([recorded], {recorded.name: flipped}, made_by).flips
    assert (flip.before, flip.now, flip.worst_now) == (Verdict.OK, Verdict.NOK, same.worst)
