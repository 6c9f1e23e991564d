"""Opinions, other limits, statistics, the station's condition: pure laws."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.analysis.export import export
from station.analysis.statistics import shift_of, summarise
from station.analysis.what_if import WhatIf, what_if
from station.archive.reader import read_records
from station.archive.room import Room
from station.archive.writer import Archive
from station.classify.thresholds import Thresholds
from station.defects import Reason
from station.domain import SEGMENTS, Frame, Image, Inspection, Origin, Purpose, Verdict
from station.engine.health import StationState, alarms, health
from station.errors import LoginError
from station.inspection.verdict import Novel
from station.journal.review_writer import save_review
from station.journal.reviews import Opinion, Review, State, possible, reviews
from station.plc.map.alarms import Alarm
from station.plc.map.registers import Offline
from station.records import Part, Record
from station.settings.model import ArchiveSettings, QualitySettings
from tests.parts import (
    label_with,
    nok_inspection,
    ok_inspection,
    provenance,
    record,
    scores_of,
    segment_quality,
    thresholds,
    unseen_inspection,
)

OPINIONS = st.dictionaries(st.sampled_from(["Ada", "Bob", "Cy"]), st.sampled_from(list(Opinion)))
NOON = datetime(2026, 11, 22, 12, tzinfo=UTC)


@given(OPINIONS)
def test_an_opinion_counts_once_two_share_it_and_nobody_differs(opinions: dict[str, Opinion]) -> None:
    review = Review(opinions)
    assert (review.agreed is not None) == (len(opinions) >= 2 and len(set(opinions.values())) == 1)
    assert (review.state is State.DISPUTED) == (len(set(opinions.values())) > 1)


def test_a_verdict_stays_whatever_people_say_and_what_they_agree_on_is_exported(
    tmp_path: Path, frames: dict[str, Image]
) -> None:
    folder = tmp_path / "records"
    archive = Archive(ArchiveSettings(folder=folder, min_free_mb=1, thin_free_mb=1, warn_free_mb=1))
    image = frames[label_with("hole")["frame"]]
    for number, inspection in enumerate(
        [nok_inspection(), nok_inspection(), ok_inspection(), nok_inspection(), ok_inspection()]
    ):
        frame = Frame(image, NOON + timedelta(minutes=number), "cam", Origin.SIMULATED)
        archive.commit(
            archive.begin(frame),
            inspection,
            Part(f"C{number}", number + 1, Origin.SIMULATED),
            provenance(),
            now=frame.grabbed_at,
        )
    archive.close()
    before = {path: path.read_bytes() for path in folder.rglob("*.json")}
    for who in ("Ada", "Bob"):
        save_review(folder, who, may_second=True, inspection_id=1, verdict="NOK", opinion=Opinion.RIGHT)
        save_review(
            folder,
            who,
            may_second=True,
            inspection_id=2,
            verdict="NOK",
            opinion=Opinion.FALSE_CALL,
            comment="soot",
        )
        marks = {7: Reason.HOLE if who == "Ada" else Reason.MISSING_WELD}
        save_review(
            folder, who, may_second=True, inspection_id=3, verdict="OK", opinion=Opinion.MISSED, marks=marks
        )
        marks = {7: Reason.HOLE if who == "Ada" else Reason.MISSING_WELD, 9: Reason.MISSING_WELD}
        save_review(
            folder,
            who,
            may_second=True,
            inspection_id=5,
            verdict="OK",
            opinion=Opinion.MISSED,
            comment="see the section",
            marks=marks,
        )
    save_review(folder, "Ada", may_second=True, inspection_id=4, verdict="NOK", opinion=Opinion.FALSE_CALL)
    with pytest.raises(ValueError, match="does not fit the verdict ERROR"):
        save_review(folder, "Ada", may_second=True, inspection_id=6, verdict="ERROR", opinion=Opinion.RIGHT)
    marks = {7: Reason.HOLE}
    with pytest.raises(ValueError, match="does not fit the verdict OK"):
        save_review(
            folder, "Ada", may_second=True, inspection_id=5, verdict="OK", opinion=Opinion.RIGHT, marks=marks
        )
    with pytest.raises(LoginError, match="level quality"):
        save_review(folder, "Cy", may_second=False, inspection_id=4, verdict="NOK", opinion=Opinion.RIGHT)
    assert [reviews(folder)[n].state for n in (1, 2, 3, 4)] == [State.AGREED] * 3 + [State.ONE]
    assert {path: path.read_bytes() for path in folder.rglob("*.json")} == before
    problems = list(export(read_records(folder), folder, tmp_path / "out", "reviewed"))
    assert [said for _, said in problems] == [
        "not exported: a defect was missed, but the two reviews name no segment with the same kind"
    ]
    crops = {
        name: sorted(p.name for p in (tmp_path / "out" / name).iterdir())
        for name in ("ok", "hole", "missing_weld")
    }
    assert crops["hole"] == ["00000001_04.png"]
    assert crops["missing_weld"] == ["00000005_09.png"]
    assert len(crops["ok"]) == 2 * SEGMENTS - 1
    assert possible("ERROR") == ()


SCORES = st.floats(0, 1).flatmap(lambda a: st.floats(0, 1 - a).map(lambda b: (1 - a - b, a, b)))


def judged(scores: list[tuple[float, float, float]], number: int = 1) -> Record:
    """A record that was decided by its own limits, 0.5 and 0.5."""
    from station.classify.decision import rejected_kinds

    made = tuple(scores_of(*s) for s in scores)
    rejected = rejected_kinds(made, (), thresholds(0.5, 0.5))
    verdict, reason = (Verdict.NOK, Reason.HOLE) if any(rejected) else (Verdict.OK, None)
    return record(
        replace(ok_inspection(), verdict=verdict, reason=reason, scores=made, rejected=rejected), number
    )


def asked_of(
    parts: list[Record], limits: Thresholds, quality: QualitySettings, novel: Novel = "error"
) -> WhatIf:
    return what_if(parts, limits, quality, novelty_limit=1.8, novel=novel)


@given(st.lists(SCORES, min_size=SEGMENTS, max_size=SEGMENTS), st.floats(0.01, 0.99), st.floats(0.01, 0.99))
def test_what_if_with_the_same_limits_changes_nothing_and_stricter_ones_release_nothing(
    scores: list[tuple[float, float, float]], hole: float, missing: float
) -> None:
    part = judged(scores)
    same = asked_of([part], thresholds(0.5, 0.5), QualitySettings())
    assert (same.released, same.rejected) == ((), ())
    asked = asked_of([part], thresholds(hole, missing), QualitySettings())
    if hole <= 0.5 and missing <= 0.5:
        assert asked.released == ()
    if hole >= 0.5 and missing >= 0.5:
        assert asked.rejected == ()
    assert asked.compared == 1


def test_what_if_counts_parts_alone_and_says_what_nobody_knows() -> None:
    dark = replace(ok_inspection(), verdict=Verdict.ERROR, reason=Reason.TOO_DARK, scores=(), rejected=())
    parts = [
        record(ok_inspection(), 1),
        record(nok_inspection(), 2),
        replace(record(nok_inspection(), 3), purpose=Purpose.TEST),
        record(dark, 4),
    ]
    found = asked_of(parts, thresholds(0.95, 0.95), QualitySettings(min_sharpness=0.0))
    assert (found.compared, found.unknown) == (2, 1)
    assert [(f.inspection_id, f.before, f.after, f.segment) for f in found.released] == []
    sharper = asked_of(parts, thresholds(0.5, 0.5), QualitySettings(min_sharpness=9.0))
    assert [(f.inspection_id, f.after) for f in sharper.rejected] == [(1, Verdict.ERROR)]


def test_what_if_shows_both_ways_with_parts_unlike_the_training_images() -> None:
    flagged = replace(ok_inspection(), novelty=2.5)
    unlike = replace(flagged, verdict=Verdict.ERROR, reason=Reason.UNLIKE_TRAINING)
    parts = [record(flagged, 1), record(unlike, 2), record(replace(nok_inspection(), novelty=2.5), 3)]
    for novel, released, rejected in (("error", [], [1]), ("flag", [2], [])):
        found = asked_of(parts, thresholds(0.5, 0.5), QualitySettings(), novel)  # type: ignore[arg-type]
        assert [flip.inspection_id for flip in found.released] == released
        assert [flip.inspection_id for flip in found.rejected] == rejected
        assert found.unlike == 2, "whatever is set, the number of parts that hang on it is shown"


def test_what_if_looks_at_the_segments_with_the_limits_asked() -> None:
    parts = [record(ok_inspection(), 1), record(unseen_inspection(), 2)]
    as_now = asked_of(parts, thresholds(0.5, 0.5), QualitySettings())
    assert (as_now.released, as_now.rejected) == ((), ())
    lax = QualitySettings(min_segment_mean_dn=1.0, max_segment_dark_fraction=1.0)
    assert [flip.inspection_id for flip in asked_of(parts, thresholds(0.5, 0.5), lax).released] == [2]
    strict = asked_of(parts, thresholds(0.5, 0.5), QualitySettings(min_segment_contrast=0.5))
    assert [flip.after for flip in strict.rejected] == [Verdict.ERROR]


@pytest.mark.parametrize(
    ("when", "shift"),
    [
        (datetime(2026, 11, 22, 6, 0), "2026-11-22 / 1"),
        (datetime(2026, 11, 22, 13, 59), "2026-11-22 / 1"),
        (datetime(2026, 11, 22, 14, 0), "2026-11-22 / 2"),
        (datetime(2026, 11, 22, 23, 0), "2026-11-22 / 3"),
        (datetime(2026, 11, 23, 5, 59), "2026-11-22 / 3"),
    ],
)
def test_the_night_shift_runs_over_midnight(when: datetime, shift: str) -> None:
    assert shift_of(when) == shift


def test_statistics_count_parts_by_shift_recipe_reason_and_segment() -> None:
    parts = [
        record(i, n)
        for n, i in enumerate([ok_inspection(), nok_inspection(), Inspection.error(Reason.NO_FRAME)], 1)
    ]
    parts.append(replace(record(nok_inspection(), 4), purpose=Purpose.GOLDEN))
    summary = summarise(reversed(parts))
    (group,) = summary.groups
    assert (group.recipe, group.ok, group.nok, group.error) == (1, 1, 1, 1)
    assert group.yield_share == pytest.approx(1 / 3)
    assert dict(summary.reasons) == {"hole": 1, "no frame in time": 1}
    assert [i for i, count in enumerate(summary.segments) if count] == [3]
    assert [p.number for p in summary.points] == [1, 2, 3]
    assert summary.points[0].cycle_ms == 54.0
    assert summary.thresholds == (0.5, 0.5)


def test_the_worst_segment_of_a_part_is_a_point_of_the_trends() -> None:
    mixed = [segment_quality()] * SEGMENTS
    mixed[3] = replace(segment_quality(), mean_dn=20.0, contrast=0.9, visible=0.4)
    mixed[7] = replace(segment_quality(), saturated_fraction=0.2, weld=0.5, visible=0.9)
    parts = [
        record(replace(ok_inspection(), segment_quality=tuple(mixed)), 1),
        record(Inspection.error(Reason.NO_FRAME), 2),
    ]
    first, second = summarise(parts).points
    assert first.worst_segment == replace(
        segment_quality(), mean_dn=20.0, saturated_fraction=0.2, weld=0.5, visible=0.4
    )
    assert second.worst_segment is None
    (none_seen,) = summarise([record(unseen_inspection(), 3)]).points
    assert none_seen.worst == pytest.approx(0.01), "of the segments that were seen"


BOOLS = st.booleans()
STATES = st.builds(
    StationState,
    camera_connected=BOOLS,
    can_write=BOOLS,
    room=st.sampled_from(list(Room)),
    plc_silent=BOOLS,
    self_test_failed=BOOLS,
    master_wrong=BOOLS,
    masters_due=BOOLS,
    drifting=BOOLS,
    settings_refused=BOOLS,
    clock_in_doubt=BOOLS,
    service=st.sampled_from(["", "Ada"]),
    order_waiting=BOOLS,
    bit=st.just(0),
    recipe=st.just(1),
    config_crc=st.just(7),
)


@given(STATES)
def test_the_station_is_ready_only_if_nothing_keeps_it_and_everything_that_lasts_is_an_alarm(
    state: StationState,
) -> None:
    published, active = health(state), alarms(state)
    assert published.ready == (published.offline is Offline.NONE)
    assert published.ready == (
        state.camera_connected
        and state.can_write
        and not (state.self_test_failed or state.service or state.order_waiting)
    )
    assert published.failure == any(
        alarm in active for alarm in (Alarm.CAMERA_LOST, Alarm.ARCHIVE_FULL, Alarm.SELF_TEST_FAILED)
    )
    assert published.function_check == (Alarm.MASTER_WRONG in active or Alarm.MASTERS_DUE in active)
    assert (Alarm.CLOCK_IN_DOUBT in active) == state.clock_in_doubt
    assert published.alarm == (int(active[0]) if active else 0)
