"""The lamp: each state by word, symbol and colour; green fades, and never claims more than the PLC reads."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.channel.events import STATUS_LOST_S, PartEvent, StatusEvent
from station.defects import Reason
from station.domain import Inspection, Origin, Purpose
from station.panel.session.lamp import FRESH_S, GONE_S, WHY_OFFLINE, Tone, lamp
from station.plc.map.alarms import TEXTS, Alarm
from station.plc.map.registers import Offline, VerdictCode
from tests.panel.made import part, status
from tests.parts import nok_inspection, ok_inspection

NOW_S = 1000.0
UP = status(origin=Origin.CAMERA, at_s=NOW_S)
GOOD = part(ok_inspection(), at_s=NOW_S)


@pytest.mark.parametrize(
    ("event", "word", "symbol", "tone"),
    [
        (GOOD, "OK", "✓", Tone.GOOD),
        (part(nok_inspection(), at_s=NOW_S), "NOK", "✗", Tone.BAD),
        (part(Inspection.error(Reason.NO_WELD_FOUND), at_s=NOW_S), "ERROR", "!", Tone.WARN),
        (part(ok_inspection(), origin=Origin.REPLAY, at_s=NOW_S), "TEST", "T", Tone.TEST),
        (part(ok_inspection(), purpose=Purpose.TEST, at_s=NOW_S), "TEST", "T", Tone.TEST),
        (part(ok_inspection(), purpose=Purpose.GOLDEN, at_s=NOW_S), "TEST", "T", Tone.TEST),
        (part(ok_inspection(), at_s=NOW_S, trusted=False), "TEST", "T", Tone.TEST),
        (replace(GOOD, reported=VerdictCode.ERROR), "ERROR", "!", Tone.WARN),
        (None, "NO VERDICT", "–", Tone.QUIET),
    ],
)
def test_words_symbols_and_colours(event: PartEvent | None, word: str, symbol: str, tone: Tone) -> None:
    shown = lamp(UP, event, NOW_S + 0.1)
    assert (shown.word, shown.symbol, shown.tone) == (word, symbol, tone)


@pytest.mark.parametrize(
    ("event", "word", "detail"),
    [
        (None, "OFFLINE", "no connection to the engine"),
        (status(Offline.PLC_SILENT, at_s=NOW_S), "PLC LOST", TEXTS[Alarm.PLC_SILENT].cause),
        (
            status(Offline.CAMERA_LOST, camera="camera 1: cable", at_s=NOW_S),
            "OFFLINE",
            TEXTS[Alarm.CAMERA_LOST].cause,
        ),
        (status(Offline.NOT_ENABLED, at_s=NOW_S), "OFFLINE", "the PLC has not enabled the station"),
        (status(Offline.SERVICE, service="Ada", at_s=NOW_S), "SERVICE", "is working on the station"),
    ],
)
def test_each_loss_has_its_own_words_and_no_green_covers_it(
    event: StatusEvent | None, word: str, detail: str
) -> None:
    shown = lamp(event, None, NOW_S)
    assert (shown.word, shown.detail) == (word, detail)
    assert lamp(event, GOOD, NOW_S).word == word


def test_every_reason_to_be_offline_has_words() -> None:
    assert set(WHY_OFFLINE) | {Offline.NONE, Offline.CAMERA_LOST, Offline.PLC_SILENT} == set(Offline)


@pytest.mark.parametrize("offline", [reason for reason in Offline if reason is not Offline.NONE])
def test_no_green_while_the_station_is_off_the_line(offline: Offline) -> None:
    assert lamp(status(offline, at_s=NOW_S), GOOD, NOW_S).tone is not Tone.GOOD


def test_no_green_from_an_earlier_run_of_the_engine() -> None:
    assert lamp(status(at_s=NOW_S + 2, started_s=NOW_S + 1), GOOD, NOW_S + 2).word == "NO VERDICT"


def test_no_green_that_the_plc_does_not_accept() -> None:
    shown = lamp(status(at_s=NOW_S, alarms=(int(Alarm.MASTERS_DUE),)), GOOD, NOW_S)
    assert (shown.word, shown.more) == ("TEST", "OK")


@given(
    st.floats(0, 1e6),
    st.floats(0, 1e6),
    st.sampled_from(list(VerdictCode)),
    st.sampled_from(list(Offline)),
    st.floats(0, 2e6),
)
def test_green_is_a_fresh_ok_that_the_plc_reads(
    status_age_s: float, part_age_s: float, told: VerdictCode, offline: Offline, started_s: float
) -> None:
    now_s = 2e6
    event = status(offline, at_s=now_s - status_age_s, started_s=started_s)
    shown = lamp(event, replace(GOOD, at_s=now_s - part_age_s, reported=told), now_s)
    if shown.tone is Tone.GOOD:
        assert told is VerdictCode.OK
        assert offline is Offline.NONE
        assert now_s - part_age_s >= started_s
        assert part_age_s <= GONE_S
        assert status_age_s <= STATUS_LOST_S
        assert shown.strength == 1.0 or part_age_s > FRESH_S


def test_green_fades() -> None:
    ages = (0, FRESH_S, 5, 8, GONE_S)
    strengths = [lamp(replace(UP, at_s=NOW_S + age), GOOD, NOW_S + age).strength for age in ages]
    assert strengths == sorted(strengths, reverse=True)
    assert strengths[0] > strengths[-1]
