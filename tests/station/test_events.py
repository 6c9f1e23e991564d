"""What the engine sends is what the window reads."""

import json
from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from station.channel.zeromq import _EVENTS
from station.plc.map.registers import (
    COMMAND_START,
    COMMAND_WORDS,
    STATUS_START,
    STATUS_WORDS,
    Control,
    Offline,
    Status,
    pack_window,
    unpack_window,
)
from station.plc.map.status_window import decoded
from station.plc.port import Counts, LineState
from tests.panel.made import status

STATES = st.builds(
    LineState,
    control=st.integers(0, 0xFF).map(Control),
    status=st.integers(0, 0xFFFF).map(Status),
    offline=st.sampled_from(Offline),
    error_code=st.integers(0, 0xFFFF),
    counts=st.builds(Counts, *[st.integers(0, 0xFFFFFFFF)] * 3),
)


@given(STATES)
def test_a_state_of_the_line_is_what_the_words_of_both_windows_say(state: LineState) -> None:
    command = pack_window(COMMAND_START, COMMAND_WORDS, {"CONTROL": int(state.control)})
    words = pack_window(
        STATUS_START,
        STATUS_WORDS,
        {
            "STATUS": int(state.status),
            "OFFLINE_REASON": int(state.offline),
            "ERROR_CODE": state.error_code,
            "COUNT_OK": state.counts.ok,
            "COUNT_NOK": state.counts.nok,
            "COUNT_ERROR": state.counts.error,
        },
    )
    assert decoded(unpack_window(COMMAND_START, command), unpack_window(STATUS_START, words)) == state


@given(STATES)
def test_a_state_of_the_line_crosses_the_channel_as_plain_numbers(state: LineState) -> None:
    event = replace(status(), line=state)
    sent = _EVENTS.dump_json(event)
    assert _EVENTS.validate_json(sent) == event
    assert json.loads(sent)["line"] == {
        "control": int(state.control),
        "status": int(state.status),
        "offline": int(state.offline),
        "error_code": state.error_code,
        "counts": {"ok": state.counts.ok, "nok": state.counts.nok, "error": state.counts.error},
    }
