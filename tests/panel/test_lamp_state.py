from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.domain import Inspection, Origin, Reason
from station.events import Counts, PartEvent, StatusEvent
from station.panel import theme
from station.panel.lamp_state import FRESH_S, GONE_S, lamp
from station.plc.registers import Offline
from tests.parts import nok_inspection, ok_inspection, record

UP = StatusEvent(True, "", True, True, Offline.NONE, Origin.CAMERA, Counts(1, 0, 0))


def part(inspection: Inspection, origin: Origin = Origin.CAMERA) -> PartEvent:
    return PartEvent(record(inspection, origin=origin), (False,) * 21, False, None, True, 1.0, 1.0)


@pytest.mark.parametrize(
    ("event", "word", "color"),
    [
        (part(ok_inspection()), "OK", theme.GOOD),
        (part(nok_inspection()), "NOK", theme.BAD),
        (part(Inspection.error(Reason.NO_WELD_FOUND)), "ERROR", theme.WARN),
        (part(ok_inspection(), Origin.REPLAY), "TEST", theme.TEST),
        (replace(part(ok_inspection()), shown_to_plc=False), "ERROR", theme.WARN),
        (None, "NO VERDICT", theme.QUIET),
    ],
)
def test_words_and_colours(event: PartEvent | None, word: str, color: str) -> None:
    shown = lamp(UP, 0.1, event, 0.1)
    assert (shown.word, shown.color) == (word, color)


def test_lost_engine_plc_and_camera_are_told_apart() -> None:
    assert lamp(None, 1e9, None, 1e9).word == "OFFLINE"
    assert lamp(replace(UP, offline=Offline.PLC_SILENT), 0.1, None, 1e9).word == "PLC LOST"
    lost = replace(UP, offline=Offline.CAMERA_LOST, camera_message="camera 1: cable")
    assert lamp(lost, 0.1, None, 1e9).detail == "camera 1: cable"


@given(st.floats(0, 1e6), st.floats(0, 1e6))
def test_no_old_green(status_age_s: float, part_age_s: float) -> None:
    shown = lamp(UP, status_age_s, part(ok_inspection()), part_age_s)
    if shown.color == theme.GOOD:
        assert part_age_s <= GONE_S
        assert status_age_s <= 2.0
        assert shown.strength == 1.0 or part_age_s > FRESH_S


def test_green_fades() -> None:
    strengths = [lamp(UP, 0.1, part(ok_inspection()), age).strength for age in (0, FRESH_S, 5, 8, GONE_S)]
    assert strengths == sorted(strengths, reverse=True)
    assert strengths[0] > strengths[-1]
