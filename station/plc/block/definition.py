"""The PLC's function block in plain Structured Text: variables, acceptance rule and handshake.

It uses only what IEC 61131-3 and SCL have in common, so that the dialects differ in their declarations alone.
Its texts are printed into the files for PLCs and are part of the interface.
"""

from dataclasses import dataclass, field
from typing import Literal

from station.plc.map.registers import (
    BY_NAME,
    COMMAND_WORDS,
    MAP,
    STATUS_START,
    STATUS_WORDS,
    Control,
    Flags,
    Register,
    Status,
)

NAME = "WeldgateStation"
"""Name of the function block."""
RECORD = "WeldgateStatus"
"""Name of the type that holds the decoded status window."""
MAX_AGE_10MS = 500
"""Age from which a result is too old, in units of 10 ms."""
HEARTBEAT = "T#500ms"
"""Time within which the station's heartbeat must change."""
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


def bit(name: str, mask: int) -> str:
    """Return the condition that a bit of a register in the status window is set."""
    return f"(({word(name)} AND 16#{mask:04X}) <> 16#0000)"


POINTS: tuple[tuple[str, str], ...] = (
    ("heartbeat stands still", "BeatFresh"),
    ("RESULT_VALID is 0", bit("STATUS", Status.RESULT_VALID)),
    ("OK and NOK are not 1 and 0", f"{bit('STATUS', Status.OK)} AND NOT {bit('STATUS', Status.NOK)}"),
    (
        "VERDICT is not OK with its complement",
        f"({word('VERDICT')} = 16#0001) AND ({word('VERDICT_INV')} = 16#FFFE)",
    ),
    ("SEQ_HEAD differs from SEQ_TAIL", f"({word('SEQ_HEAD')} = {word('SEQ_TAIL')})"),
    ("result of another trigger", f"(WORD_TO_UINT({word('RESULT_TRIGGER_ID')}) = TriggerId)"),
    ("result of another serial", "SerialSame"),
    ("recipe is not the expected one", f"(WORD_TO_UINT({word('ACTIVE_RECIPE')}) = Recipe)"),
    ("configuration is not the released one", f"({word('CONFIG_CRC')} = Crc)"),
    ("result too old", f"(WORD_TO_UINT({word('RESULT_AGE_10MS')}) <= {MAX_AGE_10MS})"),
    (
        "station reports failure or function check",
        f"NOT {bit('STATUS', Status.FAILURE | Status.FUNCTION_CHECK)}",
    ),
    ("picture of an emulated camera", f"AcceptSimulated OR NOT {bit('FLAGS', Flags.SIMULATED)}"),
    ("picture unlike the training images", f"AcceptNovel OR NOT {bit('FLAGS', Flags.NOVEL)}"),
)
"""Acceptance rule: text of each point's refusal, and its condition. A part passes if all hold at once."""
NOT_READY, NO_RESULT = len(POINTS) + 1, len(POINTS) + 2
"""Values of Refusal for a part without a result."""
REFUSALS = (
    "",
    *(name for name, _ in POINTS),
    "station not READY, or without heartbeat",
    "no result inside the window",
)
"""Meaning of each value of Refusal."""


def fields() -> list[tuple[str, str, Register]]:
    """Return name, type and register of each field of the record: 32-bit values as UDINT, text as words."""
    found = []
    for register in MAP:
        if register.address >= STATUS_START:
            plain = {"u16": "UINT", "u32": "UDINT", "f32": "UDINT", "ascii": "WORD"}[register.kind]
            count = register.words if register.kind == "ascii" else register.count
            found.append(
                (register.name, plain if count == 1 else f"ARRAY[0..{count - 1}] OF {plain}", register)
            )
    return found


VARIABLES: tuple[Variable, ...] = (
    Variable("input", "Window", f"ARRAY[0..{STATUS_WORDS - 1}] OF WORD", "status window, taken in one read"),
    Variable("input", "Fresh", "BOOL", "TRUE in the cycle in which a new read has arrived"),
    Variable("input", "Start", "BOOL", "rising edge: judge the part that is in the nest now"),
    Variable("input", "Golden", "BOOL", "a master is in the nest; it never passes"),
    Variable(
        "input",
        "Serial",
        "ARRAY[0..15] OF WORD",
        "serial of the part, two characters a word, the first in the high byte",
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
    Variable("input", "WindowTime", "TIME", "the result must come within", initial="T#4s"),
    Variable(
        "input", "Extra", "WORD", "further bits of CONTROL, as CLEAR_ERROR, EXEC_COMMAND, SET_OFFLINE, ABORT"
    ),
    Variable("input", "CommandCode", "UINT", "COMMAND for EXEC_COMMAND"),
    Variable("input", "Argument", "UINT", "ARG of the command"),
    Variable(
        "output", "Command", f"ARRAY[0..{COMMAND_WORDS - 1}] OF WORD", "command window, to be written whole"
    ),
    Variable("output", "PartOk", "BOOL", "the part may pass; FALSE until all points held in one read"),
    Variable("output", "PartDone", "BOOL", "the part is answered"),
    Variable("output", "Busy", "BOOL", "a part is in work"),
    Variable("output", "Refusal", "UINT", "first point that did not hold, 0: none"),
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
    Variable("local", "BeatKnown", "BOOL", ""),
    Variable("local", "BeatEver", "BOOL", ""),
    Variable("local", "BeatMoved", "BOOL", ""),
    Variable("local", "BeatFresh", "BOOL", ""),
    Variable("local", "BeatSeen", "WORD", ""),
    Variable("local", "SerialSame", "BOOL", ""),
    Variable("local", "OwnBeat", "UDINT", ""),
    Variable("local", "i", "INT", ""),
    Variable("local", "BeatTimer", "TON", ""),
    Variable("local", "OwnTimer", "TON", ""),
    Variable("local", "PartTimer", "TON", ""),
    Variable("local", "StartEdge", "R_TRIG", ""),
)
"""Variables of the function block in the order of their declaration."""


def body() -> str:
    """Return the block's statements."""
    rule = "\n".join(
        f"        IF (Refusal = 0) AND NOT ({point}) THEN\n"
        f"            Refusal := {number}; (* {name} *)\n        END_IF;"
        for number, (name, point) in enumerate(POINTS, start=1)
    )
    enable, trigger, acknowledge = (
        int(Control.ENABLE),
        int(Control.ENABLE | Control.TRIGGER),
        int(Control.ENABLE | Control.RESULT_ACK),
    )
    golden = trigger | int(Control.GOLDEN_CHECK)
    acknowledged = f"(WORD_TO_UINT({word('ACK_TRIGGER_ID')}) = TriggerId)"
    serial, echo = BY_NAME["PART_SERIAL"].address, BY_NAME["SERIAL_ECHO"].address - STATUS_START
    return f"""\
(* heartbeat of the station: must move within {HEARTBEAT} *)
BeatMoved := FALSE;
IF Fresh THEN
    BeatMoved := BeatKnown AND ({word("HEARTBEAT")} <> BeatSeen);
    BeatSeen := {word("HEARTBEAT")};
    BeatKnown := TRUE;
END_IF;
BeatEver := BeatEver OR BeatMoved;
BeatTimer(IN := NOT BeatMoved, PT := {HEARTBEAT});
BeatFresh := BeatEver AND NOT BeatTimer.Q;

(* our own heartbeat *)
OwnTimer(IN := NOT OwnTimer.Q, PT := {OWN_HEARTBEAT});
IF OwnTimer.Q THEN
    OwnBeat := (OwnBeat + 1) MOD 65536;
    Command[1] := UDINT_TO_WORD(OwnBeat);
END_IF;

(* the record, decoded *)
{_decoded()}

StartEdge(CLK := Start);
PartTimer(IN := (State <> 0), PT := WindowTime);
CASE State OF
0:
    Control := 16#{enable:04X};
    IF StartEdge.Q THEN
        PartOk := FALSE;
        PartDone := FALSE;
        Refusal := 0;
        Busy := TRUE;
        State := 10;
    END_IF;
10:
    IF Fresh AND BeatFresh AND {bit("STATUS", Status.READY)} THEN
        TriggerId := (TriggerId MOD 65535) + 1;
        IF TriggerId = WORD_TO_UINT({word("ACK_TRIGGER_ID")}) THEN
            TriggerId := (TriggerId MOD 65535) + 1;
        END_IF;
        Command[2] := UINT_TO_WORD(TriggerId);
        FOR i := 0 TO 15 DO
            Command[{serial} + i] := Serial[i];
        END_FOR;
        State := 20;
    END_IF;
20:
    IF Fresh THEN
        IF Golden THEN
            Control := 16#{golden:04X};
        ELSE
            Control := 16#{trigger:04X};
        END_IF;
        State := 30;
    END_IF;
30:
    IF Fresh AND {bit("STATUS", Status.TRIGGER_ACK)} AND {acknowledged} THEN
        Control := 16#{enable:04X};
        State := 40;
    END_IF;
40:
    IF Fresh AND {bit("STATUS", Status.RESULT_VALID)} THEN
        SerialSame := TRUE;
        FOR i := 0 TO 15 DO
            SerialSame := SerialSame AND (Window[{echo} + i] = Serial[i]);
        END_FOR;
{rule}
        PartOk := (Refusal = 0) AND NOT Golden;
        Control := 16#{acknowledge:04X};
        State := 50;
    END_IF;
50:
    IF Fresh AND NOT {bit("STATUS", Status.RESULT_VALID)} THEN
        Control := 16#{enable:04X};
        Busy := FALSE;
        PartDone := TRUE;
        State := 0;
    END_IF;
END_CASE;

(* the window is over: whatever comes now is too late *)
IF PartTimer.Q AND (State <> 0) THEN
    IF State < 30 THEN
        Refusal := {NOT_READY};
    ELSIF State < 50 THEN
        Refusal := {NO_RESULT};
    END_IF;
    PartOk := PartOk AND (State = 50);
    Control := 16#{enable:04X};
    Busy := FALSE;
    PartDone := TRUE;
    State := 0;
END_IF;
Command[0] := Control OR Extra;
Command[3] := UINT_TO_WORD(CommandCode);
Command[4] := UINT_TO_WORD(Argument);
"""


def _decoded() -> str:
    lines = []
    for name, _, register in fields():
        at = register.address - STATUS_START
        if register.kind in ("u32", "f32"):
            lines.append(
                f"Info.{name} := (WORD_TO_UDINT(Window[{at}]) * 65536) + WORD_TO_UDINT(Window[{at + 1}]);"
            )
        elif register.words == 1:
            lines.append(f"Info.{name} := WORD_TO_UINT(Window[{at}]);")
        else:
            value = f"Window[{at} + i]" if register.kind == "ascii" else f"WORD_TO_UINT(Window[{at} + i])"
            lines.append(f"FOR i := 0 TO {register.words - 1} DO\n    Info.{name}[i] := {value};\nEND_FOR;")
    return "\n".join(lines)
