"""A wrong clock deletes nothing: records age by their order, and a jump waits for a person."""

import sqlite3
import threading
import time
from contextlib import closing
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.__main__ import main
from station.archive.age import BACK, Clock, Right, first_young, jumps, trusted, undecided
from station.archive.prune import as_ranges
from station.archive.reader import find, verify
from station.archive.writer import Archive
from station.domain import Frame, Origin
from station.engine.retention import STEPPED, Housekeeping, decide, prune_archive, read_clock
from station.errors import RecordError
from station.journal.journal import Kind, entries, verify_journal
from station.records import Part
from station.settings.model import ArchiveSettings, KeepSettings
from tests.parts import nok_inspection, ok_inspection, provenance

NOW = datetime(2026, 11, 22, 12, tzinfo=UTC)
ROOMY = {"min_free_mb": 1, "thin_free_mb": 1, "warn_free_mb": 1}
KEEP = KeepSettings(ok_all_days=7, ok_share=0.0, ok_days=7, nok_days=30, error_days=30, record_days=60)


def put(folder: Path, *times: datetime, good: bool = False) -> None:
    archive = Archive(ArchiveSettings(folder=folder, **ROOMY))
    for when in times:
        frame = Frame(np.zeros((8, 8), np.uint8), when, "cam", Origin.SIMULATED)
        archive.commit(
            archive.begin(frame),
            ok_inspection() if good else nok_inspection(),
            Part("S", 1, Origin.SIMULATED),
            provenance(),
            now=when,
        )
    archive.close()


def pruned(folder: Path, now: datetime = NOW) -> tuple[int, int, str]:
    done = prune_archive(folder, KEEP, who="station", now=now)
    return done.frames, done.records, done.doubt


@pytest.mark.parametrize("wrong", [datetime(1970, 1, 2, tzinfo=UTC), datetime(2000, 1, 1, tzinfo=UTC)])
def test_a_station_that_began_with_a_wrong_clock_keeps_its_first_parts(
    tmp_path: Path, wrong: datetime
) -> None:
    put(tmp_path, wrong, wrong + timedelta(minutes=1), NOW)
    frames, records, doubt = pruned(tmp_path)
    assert (frames, records) == (0, 0)
    assert "record 3" in doubt
    decide(tmp_path, 3, Right.AFTER, who="Ada")
    assert pruned(tmp_path) == (0, 0, "")
    put(tmp_path, NOW + timedelta(days=29), NOW + timedelta(days=35))
    assert pruned(tmp_path, NOW + timedelta(days=35))[0] == 3, "their age is that of the part after them"
    assert list(verify(tmp_path)) == []


def test_a_clock_far_ahead_deletes_nothing_when_one_part_is_recorded(tmp_path: Path) -> None:
    ahead = NOW + timedelta(days=4000)
    put(tmp_path, *(NOW - timedelta(days=number) for number in (3, 2, 1, 0)), ahead)
    frames, records, doubt = pruned(tmp_path, ahead)
    assert (frames, records) == (0, 0)
    assert "record 5" in doubt
    decide(tmp_path, 5, Right.BEFORE, who="Ada")
    frames, records, doubt = pruned(tmp_path, ahead)
    assert (frames, records) == (0, 0)
    assert "still says" in doubt
    assert pruned(tmp_path) == (0, 0, ""), "the clock was set right"
    put(tmp_path, NOW + timedelta(hours=1))
    assert "record 6" in pruned(tmp_path, NOW + timedelta(hours=2))[2]
    decide(tmp_path, 6, Right.AFTER, who="Ada")
    assert pruned(tmp_path, NOW + timedelta(hours=2)) == (0, 0, "")


def test_a_pause_is_a_jump_until_a_person_says_so(tmp_path: Path) -> None:
    put(tmp_path, NOW - timedelta(days=100), NOW)
    assert "record 2" in pruned(tmp_path)[2]
    decide(tmp_path, 2, Right.BOTH, who="Ada")
    assert pruned(tmp_path) == (1, 1, "")


def test_a_clock_behind_the_newest_record_stops_the_pruning(tmp_path: Path) -> None:
    put(tmp_path, *(NOW - timedelta(days=number) for number in (40, 20, 0)))
    assert "newest record" in pruned(tmp_path, NOW - timedelta(days=2))[2]
    assert pruned(tmp_path)[2] == ""


def test_each_deletion_is_in_the_journal_before_it_is_done(tmp_path: Path) -> None:
    put(tmp_path, *(NOW - timedelta(days=number) for number in (90, 70, 50, 20, 0)))
    put(tmp_path, NOW, good=True)
    assert pruned(tmp_path)[:2] == (3, 2)
    found = [(e.subject, e.after, e.reason) for e in entries(tmp_path, (Kind.DELETED,), newest_first=False)]
    assert found == [("frames", "1-3", "nok_days = 30"), ("records", "1-2", "record_days = 60")]
    assert list(verify_journal(tmp_path)) == []


def test_nothing_is_deleted_if_the_journal_cannot_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    put(tmp_path, *(NOW - timedelta(days=number) for number in (90, 70, 50, 20, 0)))

    def refused(*_: object, **__: object) -> None:
        raise RecordError("the disk is full")

    monkeypatch.setattr("station.engine.retention.append", refused)
    with pytest.raises(RecordError, match="full"):
        pruned(tmp_path)
    assert len(list(tmp_path.glob("*/*.png"))) == 5
    assert list(verify(tmp_path)) == []


def test_the_command_lists_jumps_and_takes_the_answer(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    put(tmp_path, NOW, datetime(2000, 1, 1, tzinfo=UTC), NOW + timedelta(hours=1))
    assert main(["records", "clock", str(tmp_path)]) == 1
    assert "2 jumps, 2 in doubt" in capsys.readouterr().out
    assert main(["records", "clock", str(tmp_path), "--right", "before"]) == 2
    assert "name one jump with --record; records after a jump: 2, 3" in capsys.readouterr().err
    assert main(["records", "clock", str(tmp_path), "--right", "before", "--record", "2"]) == 1
    assert main(["records", "clock", str(tmp_path), "--right", "after", "--record", "3"]) == 0
    assert "2 jumps, 0 in doubt" in capsys.readouterr().out
    assert [e.after for e in entries(tmp_path, (Kind.CLOCK,), newest_first=False)] == ["before", "after"]


def test_the_engine_sees_a_step_of_the_clock_however_small_the_gap(tmp_path: Path) -> None:
    put(tmp_path, NOW)
    wall, since = [1e9], [0.0]
    keeper = Housekeeping(tmp_path, KEEP, wall_s=lambda: wall[0], since_start_s=lambda: since[0], look_s=0.01)
    try:
        time.sleep(0.1)
        assert entries(tmp_path, (Kind.CLOCK,)) == []
        wall[0] += 10 * 86400
        until = time.monotonic() + 60
        while not entries(tmp_path, (Kind.CLOCK,)) and time.monotonic() < until:
            threading.Event().wait(0.02)
    finally:
        keeper.close()
    (entry,) = entries(tmp_path, (Kind.CLOCK,))
    assert (entry.subject, entry.after, entry.reason) == ("2", "+240.0 h", STEPPED)
    put(tmp_path, NOW + timedelta(days=10))
    assert "record 2" in pruned(tmp_path, NOW + timedelta(days=10))[2]


Runs = st.lists(
    st.tuples(st.booleans(), st.lists(st.floats(0.01, 20.0), min_size=1, max_size=6)), min_size=1, max_size=5
)


@given(Runs, st.floats(1, 100), st.data())
def test_nothing_young_is_ever_taken_for_old(
    runs: list[tuple[bool, list[float]]], keep_days: float, data: st.DataObject
) -> None:
    """Over any history of right and wrong clocks: answered rightly, only what is truly old counts as old."""
    true_day, truth, dates, decisions_by_number = 20_000.0, [], [], {}
    number, before = 0, None
    runs = [*runs[:-1], (True, runs[-1][1])]  # now the clock is right, as the pruning itself checks
    for right, gaps in runs:
        shift = 0.0 if right else data.draw(st.floats(-20_000, 20_000))
        for place, gap in enumerate(gaps):
            number, true_day = number + 1, true_day + gap
            truth.append(true_day)
            dates.append(true_day + shift)
            if place == 0 and before is not None:
                decisions_by_number[number] = (before, right)
        before = right
    with closing(sqlite3.connect(":memory:")) as index:
        index.execute("CREATE TABLE records (inspection_id INTEGER PRIMARY KEY, grabbed_at TEXT)")
        start = datetime(1970, 1, 1, tzinfo=UTC)
        stamps = [(start + timedelta(days=day)).isoformat() for day in dates]
        index.executemany("INSERT INTO records VALUES (?, ?)", list(enumerate(stamps, start=1)))
        wrong_runs = {n for n, (was, now) in decisions_by_number.items() if not (was and now)}
        clock = Clock(steps=frozenset(wrong_runs))
        found = jumps(index, clock)
        answers = {}
        for jump in found:
            was, now = decisions_by_number.get(jump.number, (True, True))
            if not was and not now:
                answers[jump.number] = data.draw(st.sampled_from([Right.BEFORE, Right.AFTER]))
            else:
                answers[jump.number] = Right.BOTH if was and now else Right.BEFORE if was else Right.AFTER
        clock = Clock(answers, clock.steps)
        assert undecided(found, clock) == []
        if any(not was and not now for was, now in decisions_by_number.values()):
            return  # of two wrong runs side by side only one answer each can be given
        condition = trusted(found, clock)
        limit = first_young(index, start + timedelta(days=true_day - keep_days), condition)
        for place, true in enumerate(truth, start=1):
            if place < limit:
                assert true <= true_day - keep_days + BACK / timedelta(days=1)


@given(st.sets(st.integers(1, 60)))
def test_ranges_say_each_number_once(numbers: set[int]) -> None:
    said = set()
    for part in filter(None, as_ranges(sorted(numbers)).split(", ")):
        first, _, last = part.partition("-")
        said |= set(range(int(first), int(last or first) + 1))
    assert said == numbers


def test_find_still_lists_all(tmp_path: Path) -> None:
    put(tmp_path, NOW, datetime(1970, 1, 1, tzinfo=UTC))
    assert len(find(tmp_path)) == 2
    assert read_clock(tmp_path) == Clock({}, frozenset())
