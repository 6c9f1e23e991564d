"""The lamp: each state by word, symbol and colour; a green never grows old."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.domain import Inspection, Origin, Purpose, Reason
from station.events import PartEvent, StatusEvent
from station.panel.live.lamp_state import FRESH_S, GONE_S, STATUS_LOST_S, WHY_OFFLINE, Tone, lamp
from station.plc.registers import Offline
from tests.panel.made import part, status
from tests.parts import nok_inspection, ok_inspection

UP = status(origin=Origin.CAMERA)


@pytest.mark.parametrize(
    ("event", "word", "symbol", "tone"),
    [
        (part(ok_inspection()), "OK", "✓", Tone.GOOD),
        (part(nok_inspection()), "NOK", "✗", Tone.BAD),
        (part(Inspection.error(Reason.NO_WELD_FOUND)), "ERROR", "!", Tone.WARN),
        (part(ok_inspection(), origin=Origin.REPLAY), "TEST", "T", Tone.TEST),
        (part(ok_inspection(), purpose=Purpose.TEST), "TEST", "T", Tone.TEST),
        (part(ok_inspection(), purpose=Purpose.GOLDEN), "TEST", "T", Tone.TEST),
        (replace(part(ok_inspection()), shown_to_plc=False), "ERROR", "!", Tone.WARN),
        (None, "NO VERDICT", "–", Tone.QUIET),
    ],
)
def test_words_symbols_and_colours(event: PartEvent | None, word: str, symbol: str, tone: Tone) -> None:
    shown = lamp(UP, 0.1, event, 0.1)
    assert (shown.word, shown.symbol, shown.tone) == (word, symbol, tone)


@pytest.mark.parametrize(
    ("said", "word", "detail"),
    [
        (None, "OFFLINE", "no word from the engine"),
        (status(Offline.PLC_SILENT), "PLC LOST", "the PLC's heartbeat stands still"),
        (status(Offline.CAMERA_LOST, camera="camera 1: cable"), "OFFLINE", "camera lost"),
        (status(Offline.NOT_ENABLED), "OFFLINE", "the PLC has not enabled the station"),
        (status(Offline.SERVICE, service="Ada"), "SERVICE", "works on the station"),
    ],
)
def test_what_is_lost_is_told_apart_and_no_green_covers_it(said: StatusEvent | None, word: str, detail: str) -> None:
    shown = lamp(said, 0.1 if said else 1e9, None, 1e9)
    assert (shown.word, shown.detail) == (word, detail)
    if said is None or said.service or said.offline in (Offline.PLC_SILENT, Offline.CAMERA_LOST):
        assert lamp(said, 0.1 if said else 1e9, part(ok_inspection()), 0.1).word == word


def test_every_reason_to_be_offline_has_words() -> None:
    assert set(WHY_OFFLINE) | {Offline.NONE, Offline.CAMERA_LOST, Offline.PLC_SILENT} == set(Offline)


@given(st.floats(0, 1e6), st.floats(0, 1e6))
def test_no_old_green(status_age_s: float, part_age_s: float) -> None:
    shown = lamp(UP, status_age_s, part(ok_inspection()), part_age_s)
    if shown.tone is Tone.GOOD:
        assert part_age_s <= GONE_S
        assert status_age_s <= STATUS_LOST_S
        assert shown.strength == 1.0 or part_age_s > FRESH_S


def test_green_fades() -> None:
    strengths = [lamp(UP, 0.1, part(ok_inspection()), age).strength for age in (0, FRESH_S, 5, 8, GONE_S)]
    assert strengths == sorted(strengths, reverse=True)
    assert strengths[0] > strengths[-1]
