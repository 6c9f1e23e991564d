"""The PLC's function block in plain Structured Text: names, variables and acceptance rule.

`statements` holds what the block does. Its texts are printed into the files for PLCs and are part of the
interface.
"""

from dataclasses import dataclass, field
from typing import Literal

from station.plc.block.data_types import COMMAND, RECORD, RESULT, SERIAL, WINDOW
from station.plc.map.registers import BY_NAME, STATUS_START, Flags, Status

NAME = "WeldgateStation"
"""Name of the function block."""
MAX_AGE_10MS = 500
"""Age from which a result is too old, in units of 10 ms."""
OWN_HEARTBEAT = "T#100ms"
"""Time between two changes of the PLC's heartbeat."""

Role = Literal["input", "output", "local"]
"""Section in which a variable is declared."""


@dataclass(frozen=True, slots=True)
class Variable:
    """One variable of the function block."""

    role: Role
    name: str
    type: str
    meaning: str
    initial: str = field(default="", kw_only=True)


def word(name: str, offset: int = 0) -> str:
    """Return the expression for a word of a register in the status window."""
    return f"Window[{BY_NAME[name].address - STATUS_START + offset}]"


def is_set(name: str, mask: int) -> str:
    """Return the condition that a bit of a register in the status window is set."""
    return f"(({word(name)} AND 16#{mask:04X}) <> 16#0000)"


def is_clear(name: str, mask: int) -> str:
    """Return the condition that none of these bits of a register in the status window is set."""
    return f"(({word(name)} AND 16#{mask:04X}) = 16#0000)"


POINTS: tuple[tuple[str, str], ...] = (
    ("heartbeat stands still", "BeatFresh"),
    ("RESULT_VALID is 0", is_set("STATUS", Status.RESULT_VALID)),
    ("OK and NOK are not 1 and 0", f"{is_set('STATUS', Status.OK)} AND {is_clear('STATUS', Status.NOK)}"),
    (
        "VERDICT is not OK with its complement",
        f"({word('VERDICT')} = 16#0001) AND ({word('VERDICT_INV')} = 16#FFFE)",
    ),
    ("SEQ_HEAD differs from SEQ_TAIL", f"{word('SEQ_HEAD')} = {word('SEQ_TAIL')}"),
    ("result of another trigger", f"WORD_TO_UINT({word('RESULT_TRIGGER_ID')}) = TriggerId"),
    ("result of another serial", "SerialSame"),
    ("recipe is not the expected one", f"WORD_TO_UINT({word('ACTIVE_RECIPE')}) = Recipe"),
    ("configuration is not the released one", f"{word('CONFIG_CRC')} = Crc"),
    ("result too old", f"WORD_TO_UINT({word('RESULT_AGE_10MS')}) <= {MAX_AGE_10MS}"),
    (
        "station reports failure or function check",
        is_clear("STATUS", Status.FAILURE | Status.FUNCTION_CHECK),
    ),
    ("picture of an emulated camera", f"AcceptSimulated OR {is_clear('FLAGS', Flags.SIMULATED)}"),
    ("picture unlike the training images", f"AcceptNovel OR {is_clear('FLAGS', Flags.NOVEL)}"),
)
"""Acceptance rule: text of each point's refusal, and its condition. A part passes if all hold at once."""
NOT_READY, NO_RESULT, START_AGAIN = (len(POINTS) + number for number in (1, 2, 3))
"""Values of Refusal for a part without a result, and for one during which Start rose again."""
REFUSALS = (
    "",
    *(name for name, _ in POINTS),
    "station not READY, or without heartbeat",
    "no result inside the window",
    "Start rose again while the part was in work",
)
"""Meaning of each value of Refusal."""

VARIABLES: tuple[Variable, ...] = (
    Variable("input", "Window", WINDOW.name, "status window, taken in one read"),
    Variable(
        "input",
        "Fresh",
        "BOOL",
        "TRUE in the call in which a new read has arrived; where nothing tells so, always TRUE",
    ),
    Variable(
        "input",
        "Start",
        "BOOL",
        "rising edge while Ready: judge the part that is in the nest now; FALSE for at least one call "
        "between two parts",
    ),
    Variable("input", "Golden", "BOOL", "a master is in the nest; it never passes"),
    Variable(
        "input",
        "Serial",
        SERIAL.name,
        "serial of the part, two characters a word, the first in the high byte; echoed word by word",
    ),
    Variable("input", "Recipe", "UINT", "expected ACTIVE_RECIPE", initial="1"),
    Variable("input", "Crc", "WORD", "released CONFIG_CRC"),
    Variable("input", "AcceptSimulated", "BOOL", "TRUE only in a demonstration without a camera"),
    Variable(
        "input",
        "AcceptNovel",
        "BOOL",
        "TRUE only with model.novel = flag: let OK parts pass that are unlike the training images",
    ),
    Variable("input", "WindowTime", "TIME", "the result must come within; read at Start", initial="T#4s"),
    Variable(
        "input",
        "HeartbeatTime",
        "TIME",
        "the station's heartbeat must move within; at least three reads",
        initial="T#500ms",
    ),
    Variable(
        "input", "Extra", "WORD", "further bits of CONTROL, as CLEAR_ERROR, EXEC_COMMAND, SET_OFFLINE, ABORT"
    ),
    Variable("input", "CommandCode", "UINT", "COMMAND for EXEC_COMMAND"),
    Variable("input", "Argument", "UINT", "ARG of the command"),
    Variable("input", "PlcTime", "UDINT", "PLC_TIME, epoch seconds; needed for command 21 alone"),
    Variable("output", "Command", COMMAND.name, "command window, to be written whole"),
    Variable("output", "PartOk", "BOOL", "the part may pass; TRUE in the call of PartDone alone"),
    Variable("output", "PartDone", "BOOL", "the part is answered; TRUE for one call"),
    Variable("output", "Busy", "BOOL", "a part is in work"),
    Variable("output", "Ready", "BOOL", "a rising edge of Start is accepted"),
    Variable("output", "ExposureDone", "BOOL", "the image of the part in work is taken: it may move"),
    Variable("output", "Refusal", "UINT", "first point that did not hold, 0: none"),
    Variable("output", "Result", RESULT, "the last answer; cleared when the next part begins"),
    Variable("output", "Info", RECORD, "the status window, decoded"),
    Variable(
        "local",
        "State",
        "UINT",
        "0 idle, 10 wait for READY and a heartbeat, 20 number written, 30 triggered, 40 in work, "
        "50 acknowledged",
    ),
    Variable("local", "Control", "WORD", "bits of the handshake"),
    Variable("local", "TriggerId", "UINT", "of the part in the nest"),
    Variable("local", "Passed", "BOOL", "all points held"),
    Variable("local", "Ended", "BOOL", "the part is answered in this call"),
    Variable("local", "Holds", "BOOL", "one condition; compilers differ in what they make of NOT (a AND b)"),
    Variable("local", "StartRose", "BOOL", ""),
    Variable(
        "local", "StartBefore", "BOOL", "TRUE at first: no edge of a Start that is held", initial="TRUE"
    ),
    Variable("local", "BeatKnown", "BOOL", ""),
    Variable("local", "BeatEver", "BOOL", ""),
    Variable("local", "BeatMoved", "BOOL", ""),
    Variable("local", "BeatFresh", "BOOL", ""),
    Variable("local", "BeatSeen", "WORD", ""),
    Variable("local", "BeatLate", "BOOL", "Q of the timer, read once a call: each access may update a timer"),
    Variable("local", "OwnPulse", "BOOL", "Q of the timer, read once a call"),
    Variable("local", "PartLate", "BOOL", "Q of the timer, read once a call"),
    Variable("local", "PartTime", "TIME", "WindowTime of the part in work"),
    Variable("local", "SerialSame", "BOOL", ""),
    Variable("local", "OwnBeat", "UDINT", ""),
    Variable("local", "Bits", "UDINT", "bits of a REAL"),
    Variable("local", "Exponent", "INT", ""),
    Variable("local", "i", "INT", ""),
    Variable("local", "BeatTimer", "TON", ""),
    Variable("local", "OwnTimer", "TON", ""),
    Variable("local", "PartTimer", "TON", ""),
)
"""Variables of the function block in the order of their declaration."""
