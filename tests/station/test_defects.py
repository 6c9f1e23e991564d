"""Kinds of defect as data: codes never move, nothing comes from another kind, old files are read."""

import inspect
import json
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

import station.defects
from station.classify.decision import findings, rejected_kinds, segment_kind
from station.classify.extent import CELLS
from station.classify.thresholds import Limit, Thresholds, in_use
from station.defects import KINDS, DefectKind, Reason, Width, kind_named, kind_of
from station.domain import SEGMENTS, Ring, SegmentScores, Verdict
from station.errors import SettingsError
from station.files.installation import SHIPPED_NETWORKS
from station.inspection import loading
from station.inspection.loading import prepare
from station.plc.map.registers import MAP_VERSION
from station.record_versions import FORMAT
from station.records import from_json, to_json
from station.settings.file import load
from station.settings.model import LimitSettings, for_images
from tests.station.test_settings import GOOD

OLD_RECORDS = Path(__file__).parent / "old_records"
RING = Ring(600.0, 600.0, 428.0, 1.0)
HOLE, GONE = kind_named("hole"), kind_named("missing_weld")
DENT = DefectKind(name="dent", reason=Reason.BLURRED, color_rgb=(0, 200, 255), line_fraction=0.01)
"""A kind that the station does not ship, with a reason that it does not need otherwise here."""
THREE = (HOLE, DENT, GONE)

CODES = {
    2: {
        "hole": 1,
        "missing weld": 2,
        "no weld found": 3,
        "weld not wholly in view": 4,
        "frame has the wrong size": 5,
        "frame incompletely grabbed": 6,
        "image too dark": 7,
        "image too bright": 8,
        "image blurred": 9,
        "camera lost": 10,
        "no frame in time": 11,
        "deadline missed": 12,
        "classifier failed": 13,
        "record could not be written": 14,
        "aborted by the PLC": 15,
        "internal error": 16,
        "segment not seen": 17,
        "unlike the training images": 18,
        "frame not of this trigger": 19,
    }
}
"""What a PLC that was programmed against each version of the map reads; entries are added, never changed.

A version that changes no code needs no entry.
"""


def test_the_plc_codes_of_a_map_version_never_change() -> None:
    pinned = CODES[max(version for version in CODES if version <= MAP_VERSION)]
    assert {str(reason): reason.code for reason in Reason}.items() >= pinned.items()
    assert len({reason.code for reason in Reason}) == len(Reason)


@pytest.mark.parametrize(
    "line",
    ['MISSING_WELD = "missing weld", 1', 'MISSING_WELD = "missing weld", 0', 'MISSING_WELD = "missing weld"'],
)
def test_a_reason_without_a_code_of_its_own_ends_the_start(line: str) -> None:
    source = inspect.getsource(station.defects).replace('MISSING_WELD = "missing weld", 2', line)
    with pytest.raises(ValueError, match="'missing weld' needs a PLC code of its own"):
        exec(compile(source, "defects.py", "exec"), {"__name__": "station.defects"})


def test_kinds_are_distinct_and_found_by_name_and_reason() -> None:
    for field in ("name", "reason", "color_rgb"):
        assert len({getattr(kind, field) for kind in KINDS}) == len(KINDS)
    assert (
        [kind_named(kind.name) for kind in KINDS] == [kind_of(kind.reason) for kind in KINDS] == list(KINDS)
    )
    assert kind_of(Reason.CAMERA_LOST) is None
    with pytest.raises(ValueError, match="unknown kind of defect 'dent'; known: hole"):
        kind_named("dent")


def scores(**defects: float) -> SegmentScores:
    return SegmentScores(1.0 - sum(defects.values()), {kind: defects.get(kind.name, 0.0) for kind in THREE})


def row(**bad: SegmentScores) -> tuple[SegmentScores, ...]:
    return tuple(bad.get(f"s{i}", scores()) for i in range(SEGMENTS))


def limits(min_mm: dict[str, float] | None = None) -> Thresholds:
    return Thresholds(tuple(Limit(kind, 0.5, (min_mm or {}).get(kind.name, 0.0)) for kind in THREE))


def area(kind: DefectKind, rows: slice, columns: slice) -> np.ndarray[tuple[int, ...], np.dtype[np.float32]]:
    maps = np.zeros((SEGMENTS, len(THREE), CELLS, CELLS), np.float32)
    maps[4, THREE.index(kind), rows, columns] = 1
    return maps


def test_a_third_kind_is_rejected_under_its_own_name() -> None:
    for kind in THREE:
        assert segment_kind(scores(**{kind.name: 0.9}), limits()) == kind
    judged = row(s4=scores(dent=0.9))
    assert rejected_kinds(judged, (), limits())[4] is DENT.reason


def test_a_third_kind_inherits_no_minimum_length_of_another() -> None:
    """A dent must not be tolerated because short missing welds are."""
    judged, maps = row(s4=scores(dent=0.9)), area(DENT, slice(14, 18), slice(10, 14))
    found = findings(judged, maps, THREE, limits(), ring=RING, um_per_px=13.0)
    for others in ({"missing_weld": 3.0}, {"hole": 3.0}, {"missing_weld": 3.0, "hole": 3.0}):
        assert rejected_kinds(judged, found, limits(others))[4] is DENT.reason
    assert rejected_kinds(judged, found, limits({"dent": 3.0}))[4] is None


def test_a_third_kind_over_its_threshold_forbids_to_tolerate_the_likeliest() -> None:
    for other in (DENT, GONE):
        judged = row(s4=scores(hole=0.51, **{other.name: 0.46}))
        low = Thresholds(tuple(Limit(kind, 0.4, 3.0 if kind == HOLE else 0.0) for kind in THREE))
        found = findings(
            judged, area(HOLE, slice(14, 18), slice(10, 14)), THREE, low, ring=RING, um_per_px=13.0
        )
        assert rejected_kinds(judged, found, low)[4] is HOLE.reason
    alone = row(s4=scores(hole=0.6))
    found = findings(alone, area(HOLE, slice(14, 18), slice(10, 14)), THREE, low, ring=RING, um_per_px=13.0)
    assert rejected_kinds(alone, found, low)[4] is None


def test_each_kind_is_measured_as_it_says() -> None:
    """A slanted line is as wide as it is thick for one way, as far as it reaches for the other."""
    for kind in THREE:
        maps = np.zeros((SEGMENTS, len(THREE), CELLS, CELLS), np.float32)
        for i in range(16):
            maps[4, THREE.index(kind), 8 + i, 8 + i] = 1
        (found,) = findings(
            row(s4=scores(**{kind.name: 0.9})), maps, THREE, limits(), ring=RING, um_per_px=13.0
        )
        cell_mm = 4 * 0.013
        assert found.width_mm == pytest.approx(
            16 * cell_mm if kind.width is Width.EDGE_TO_EDGE else cell_mm, rel=0.01
        )


def test_a_kind_that_has_no_map_is_found_by_whole_segments() -> None:
    judged = row(s4=scores(dent=0.9), s5=scores(dent=0.8))
    maps = np.zeros((SEGMENTS, 2, CELLS, CELLS), np.float32)
    (found,) = findings(judged, maps, (HOLE, GONE), limits({"dent": 5.0}), ring=RING, um_per_px=13.0)
    assert (found.kind, found.width_mm, found.score) == (DENT.reason, None, pytest.approx(0.9))
    assert rejected_kinds(judged, (found,), limits({"dent": 5.0}))[4:6] == (DENT.reason,) * 2


def test_limits_of_a_kind_that_the_model_does_not_know_are_refused() -> None:
    of_model = Thresholds((Limit(HOLE, 0.46), Limit(GONE, 0.34)))
    with pytest.raises(SettingsError, match=r"model\.limits\.dent: .*it knows hole, missing_weld"):
        in_use(of_model, {"dent": LimitSettings(threshold=0.5)}, {})
    assert in_use(of_model, {"hole": LimitSettings(min_mm=0.2)}, {}).of(HOLE) == Limit(HOLE, 0.46, 0.2)


def test_a_kind_that_no_network_judges_is_said_at_the_start(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    settings = for_images(SHIPPED_NETWORKS)
    monkeypatch.setattr(loading, "KINDS", (HOLE, GONE))
    prepare(settings, 1)
    assert not caplog.text
    monkeypatch.setattr(loading, "KINDS", THREE)
    prepare(settings, 1)
    assert "weldgate.onnx does not know image blurred: parts with it can read OK" in caplog.text


@pytest.mark.parametrize(("version", "rejected"), [(1, (2, 8, 19)), (2, (19,)), (3, (2, 8, 19))])
def test_records_of_older_versions_are_read_with_their_decisions(
    version: int, rejected: tuple[int, ...]
) -> None:
    record = from_json((OLD_RECORDS / f"version_{version}.json").read_bytes())
    assert tuple(i for i, bad in enumerate(record.inspection.nok, start=1) if bad) == rejected
    assert record.provenance.thresholds.of(HOLE).threshold == 0.46
    assert record.provenance.thresholds.of(GONE).threshold == 0.34
    raw = json.loads((OLD_RECORDS / f"version_{version}.json").read_text())["inspection"]
    assert [s.nok for s in record.inspection.scores] == [1.0 - s["ok"] for s in raw["scores"]]
    assert [f.length_mm for f in record.inspection.findings] == [f["length_mm"] for f in raw["findings"]]
    assert record.inspection.unseen == (None,) * SEGMENTS
    assert not any(record.inspection.invalid)
    assert record.format == FORMAT
    assert from_json(to_json(record)) == record


def test_an_ok_of_the_time_before_segments_were_looked_at_stays_an_ok() -> None:
    record = from_json((OLD_RECORDS / "version_3_ok.json").read_bytes())
    assert record.verdict is Verdict.OK
    assert (record.inspection.segment_quality, record.inspection.detail) == ((), None)
    assert from_json(to_json(record)) == record


def test_a_record_of_today_that_lacks_what_was_seen_is_no_ok() -> None:
    raw = json.loads((OLD_RECORDS / "version_3_ok.json").read_text())
    with pytest.raises(ValidationError, match="all seen"):
        from_json(json.dumps({**raw, "format": FORMAT}).encode())


def test_a_damaged_record_of_any_version_is_refused() -> None:
    raw = json.loads((OLD_RECORDS / "version_2.json").read_text())
    for change in (
        {"format": 5},
        {"format": FORMAT},
        {"inspection": None},
        {"provenance": {}},
        {"format": 3},
    ):
        with pytest.raises(ValueError, match=r"not a record|validation error|Expecting"):
            from_json(json.dumps({**raw, **change}).encode())
    for text in (b"", b"[]", b"null", b"{"):
        with pytest.raises(ValueError, match=r"not a record|validation error|Expecting"):
            from_json(text)


OLD_LIMITS = "[model]\nhole_threshold = 0.3\nmissing_min_mm = 0.5\n[recipes.2.model]\nhole_threshold = 0.7\n"


def test_settings_under_their_old_names_are_read(tmp_path: Path) -> None:
    path = tmp_path / "station.toml"
    path.write_text(GOOD + OLD_LIMITS)
    adjusted = {"recipes": {"2": {"model": {"missing_threshold": 0.6}}, "1": {"model": {"hole_min_mm": 0.1}}}}
    path.with_suffix(".adjusted.json").write_text(json.dumps(adjusted))
    settings = load(path)
    assert settings.model.limits == {
        "hole": LimitSettings(threshold=0.3),
        "missing_weld": LimitSettings(min_mm=0.5),
    }
    assert settings.recipes[2].model == {
        "limits": {"hole": {"threshold": 0.7}, "missing_weld": {"threshold": 0.6}}
    }
    assert settings.recipes[1].model == {"limits": {"hole": {"min_mm": 0.1}}}


def test_a_value_under_its_old_and_its_new_name_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "station.toml"
    path.write_text(GOOD + "[model]\nhole_threshold = 0.3\n[model.limits.hole]\nthreshold = 0.4\n")
    with pytest.raises(
        SettingsError, match=r"model\.hole_threshold is the old name of model\.limits\.hole\.threshold"
    ):
        load(path)
