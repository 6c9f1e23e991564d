"""The PLC's acceptance rule: every point alone refuses a part."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.plc.registers import STATUS_START, STATUS_WORDS, Flags, Status, Value, pack_window, unpack_window
from station.plc.simulated_line import refusal

GOOD: dict[str, Value] = {
    "STATUS": int(Status.ONLINE | Status.RESULT_VALID | Status.OK),
    "SEQ_HEAD": 5,
    "SEQ_TAIL": 5,
    "RESULT_TRIGGER_ID": 9,
    "VERDICT": 1,
    "VERDICT_INV": 0xFFFE,
    "CONFIG_CRC": 77,
    "SERIAL_ECHO": "CELL-1",
    "RESULT_AGE_10MS": 3,
}


def read(**changes: Value) -> dict[str, Value]:
    return unpack_window(STATUS_START, pack_window(STATUS_START, STATUS_WORDS, {**GOOD, **changes}))


def refused(values: dict[str, Value], heartbeat_fresh: bool = True, accept_simulated: bool = False) -> str | None:
    return refusal(values, 9, "CELL-1", heartbeat_fresh, 77, accept_simulated)


def test_a_complete_ok_is_accepted() -> None:
    assert refused(read()) is None


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"STATUS": int(Status.OK)}, "RESULT_VALID"),
        ({"STATUS": int(Status.RESULT_VALID)}, "OK and NOK"),
        ({"STATUS": int(Status.RESULT_VALID | Status.OK | Status.NOK)}, "OK and NOK"),
        ({"VERDICT": 4, "VERDICT_INV": 0xFFFB}, "VERDICT"),
        ({"VERDICT_INV": 0}, "complement"),
        ({"SEQ_TAIL": 4}, "SEQ_HEAD"),
        ({"RESULT_TRIGGER_ID": 8}, "another trigger"),
        ({"SERIAL_ECHO": "CELL-2"}, "another trigger or serial"),
        ({"CONFIG_CRC": 78}, "configuration"),
        ({"RESULT_AGE_10MS": 501}, "too old"),
        ({"STATUS": GOOD["STATUS"] | Status.FAILURE}, "failure"),  # type: ignore[operator]
        ({"STATUS": GOOD["STATUS"] | Status.FUNCTION_CHECK}, "function check"),  # type: ignore[operator]
        ({"FLAGS": int(Flags.SIMULATED)}, "emulated camera"),
    ],
)
def test_each_point_alone_refuses(changes: dict[str, Value], said: str) -> None:
    reason = refused(read(**changes))
    assert reason is not None
    assert said in reason


def test_a_standing_heartbeat_refuses() -> None:
    assert refused(read(), heartbeat_fresh=False) == "heartbeat stands still"


def test_simulated_pictures_pass_only_where_wanted() -> None:
    assert refused(read(FLAGS=int(Flags.SIMULATED)), accept_simulated=True) is None


@given(st.integers(1, STATUS_WORDS - 1))
def test_a_read_torn_between_a_wiped_and_a_good_record_never_passes(cut: int) -> None:
    good = pack_window(STATUS_START, STATUS_WORDS, GOOD)
    wiped = pack_window(STATUS_START, STATUS_WORDS, {"SEQ_HEAD": 4, "SEQ_TAIL": 4, "CONFIG_CRC": 77})
    for torn in (good[:cut] + wiped[cut:], wiped[:cut] + good[cut:]):
        assert torn == good or refused(unpack_window(STATUS_START, torn)) is not None
