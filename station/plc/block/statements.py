"""What the PLC's function block does in each call, in plain Structured Text.

It uses only what IEC 61131-3 and SCL have in common, so that the dialects differ in their declarations alone,
and only what all controllers do alike: Q of a timer is read once, right after its call (an S7-1200 or S7-1500
updates a timer at each access), edges are made without vendor blocks, no comparison is negated, a FOR has
constant bounds (one compiler leaves out a loop that would run once).
"""

from station.plc.block.data_types import ARRAYS, COPIED, RESULT_FIELDS, Field, plain_type
from station.plc.block.definition import (
    NO_RESULT,
    NOT_READY,
    OWN_HEARTBEAT,
    POINTS,
    START_AGAIN,
    is_clear,
    is_set,
    word,
)
from station.plc.map.registers import BY_NAME, MAP, STATUS_START, Control, Register, Status

ENABLE = int(Control.ENABLE)
TRIGGER = int(Control.ENABLE | Control.TRIGGER)
GOLDEN = TRIGGER | int(Control.GOLDEN_CHECK)
ACKNOWLEDGE = int(Control.ENABLE | Control.RESULT_ACK)
CLEAR = int(Control.CLEAR_ERROR)
MANTISSA = 0x800000
"""Implicit leading bit of a REAL's mantissa; its other bits lie below."""
EXPONENT = 150
"""Exponent at which the mantissa of a REAL counts in ones."""
FAR = 40
"""Largest distance from that exponent that is decoded: a REAL beyond it reads 0."""


def body() -> str:
    """Return the block's statements."""
    return "\n".join((_beats(), _decoded(), _edge(), _handshake(), _end()))


def _beats() -> str:
    return f"""\
(* an answer holds for one call *)
PartDone := FALSE;
PartOk := FALSE;
Ended := FALSE;

(* heartbeat of the station: must move within HeartbeatTime *)
BeatMoved := FALSE;
IF Fresh THEN
    BeatMoved := BeatKnown AND ({word("HEARTBEAT")} <> BeatSeen);
    BeatSeen := {word("HEARTBEAT")};
    BeatKnown := TRUE;
END_IF;
BeatEver := BeatEver OR BeatMoved;
BeatTimer(IN := NOT BeatMoved, PT := HeartbeatTime);
BeatLate := BeatTimer.Q;
BeatFresh := BeatEver AND NOT BeatLate;

(* our own heartbeat *)
OwnTimer(IN := NOT OwnPulse, PT := {OWN_HEARTBEAT});
OwnPulse := OwnTimer.Q;
IF OwnPulse THEN
    OwnBeat := (OwnBeat + 1) MOD 65536;
    Command[1] := UDINT_TO_WORD(OwnBeat);
END_IF;
"""


def _edge() -> str:
    return f"""\
(* a rising edge of Start; while a part is in work, another one may lie in the nest *)
StartRose := Start AND NOT StartBefore;
StartBefore := Start;
IF StartRose AND (State <> 0) THEN
    Passed := FALSE;
    IF Refusal = 0 THEN
        Refusal := {START_AGAIN};
    END_IF;
END_IF;
"""


def _handshake() -> str:
    rule = "\n".join(
        f"        Holds := {point};\n"
        f"        IF (Refusal = 0) AND NOT Holds THEN\n"
        f"            Refusal := {number}; (* {name} *)\n        END_IF;"
        for number, (name, point) in enumerate(POINTS, start=1)
    )
    acknowledged = f"(WORD_TO_UINT({word('ACK_TRIGGER_ID')}) = TriggerId)"
    serial, echo = BY_NAME["PART_SERIAL"].address, BY_NAME["SERIAL_ECHO"].address - STATUS_START
    last = BY_NAME["PART_SERIAL"].words - 1
    return f"""\
PartTimer(IN := (State <> 0), PT := PartTime);
PartLate := PartTimer.Q;
CASE State OF
0:
    Control := 16#{ENABLE:04X};
    IF StartRose THEN
        Passed := FALSE;
        Refusal := 0;
{_cleared()}
        PartTime := WindowTime;
        Busy := TRUE;
        State := 10;
    END_IF;
10:
    IF Fresh AND BeatFresh AND {is_set("STATUS", Status.READY)} THEN
        TriggerId := (TriggerId MOD 65535) + 1;
        IF TriggerId = WORD_TO_UINT({word("ACK_TRIGGER_ID")}) THEN
            TriggerId := (TriggerId MOD 65535) + 1;
        END_IF;
        Command[2] := UINT_TO_WORD(TriggerId);
        FOR i := 0 TO {last} DO
            Command[{serial} + i] := Serial[i];
        END_FOR;
        State := 20;
    END_IF;
20:
    IF Fresh THEN
        IF Golden THEN
            Control := 16#{GOLDEN:04X};
        ELSE
            Control := 16#{TRIGGER:04X};
        END_IF;
        IF {is_set("STATUS", Status.ERROR)} THEN
            Control := Control OR 16#{CLEAR:04X}; (* the error of the part before *)
        END_IF;
        Result.TRIGGER_ID := TriggerId;
        State := 30;
    END_IF;
30:
    IF Fresh AND {is_set("STATUS", Status.TRIGGER_ACK)} AND {acknowledged} THEN
        Control := 16#{ENABLE:04X};
        State := 40;
    END_IF;
40:
    Holds := {is_set("STATUS", Status.EXPOSURE_DONE)} AND {acknowledged};
    ExposureDone := ExposureDone OR (Fresh AND Holds);
    IF Fresh AND {is_set("STATUS", Status.RESULT_VALID)} THEN
        SerialSame := TRUE;
        FOR i := 0 TO {last} DO
            SerialSame := SerialSame AND (Window[{echo} + i] = Serial[i]);
        END_FOR;
{rule}
        Passed := (Refusal = 0) AND NOT Golden;
{_kept()}
        Control := 16#{ACKNOWLEDGE:04X};
        State := 50;
    END_IF;
50:
    IF Fresh AND {is_clear("STATUS", Status.RESULT_VALID)} THEN
        Ended := TRUE;
    END_IF;
END_CASE;

(* the window is over: a part without a result is refused *)
IF PartLate AND (State <> 0) THEN
    IF (State < 30) AND (Refusal = 0) THEN
        Refusal := {NOT_READY};
    ELSIF (State < 50) AND (Refusal = 0) THEN
        Refusal := {NO_RESULT};
    END_IF;
    Ended := TRUE;
END_IF;
"""


def _end() -> str:
    ready = is_set("STATUS", Status.READY)
    high = BY_NAME["PLC_TIME"].address
    return f"""\
IF Ended THEN
    Control := 16#{ENABLE:04X};
    Busy := FALSE;
    ExposureDone := FALSE;
    PartDone := TRUE;
    PartOk := Passed;
    Result.NUMBER := Result.NUMBER + 1;
    Result.REFUSAL := Refusal;
    State := 0;
END_IF;
Ready := (State = 0) AND NOT Start AND BeatFresh AND {ready};
Command[0] := Control OR Extra;
Command[3] := UINT_TO_WORD(CommandCode);
Command[4] := UINT_TO_WORD(Argument);
Command[{high}] := UDINT_TO_WORD(PlcTime / 65536);
Command[{high + 1}] := UDINT_TO_WORD(PlcTime MOD 65536);
"""


def _cleared() -> str:
    """Return the statements that clear the answer to the part before; its number stays."""
    return "\n".join(f"        {line}" for field in RESULT_FIELDS[1:] for line in _clearing(field))


def _clearing(field: Field) -> list[str]:
    if field.type in ARRAYS:
        last = ARRAYS[field.type].count - 1
        return [f"FOR i := 0 TO {last} DO", f"    Result.{field.name}[i] := 0;", "END_FOR;"]
    return [f"Result.{field.name} := {'16#0000' if field.type == 'WORD' else '0'};"]


def _kept() -> str:
    """Return the statements that copy the result, which the station clears when it is acknowledged."""
    lines: list[str] = []
    for name in COPIED:
        count = BY_NAME[name].count
        if count == 1:
            lines.append(f"Result.{name} := Info.{name};")
        else:
            lines += [f"FOR i := 0 TO {count - 1} DO", f"    Result.{name}[i] := Info.{name}[i];", "END_FOR;"]
    return "\n".join(f"        {line}" for line in lines)


def _decoded() -> str:
    lines = ["(* the record, decoded *)"]
    for register in MAP:
        if register.address >= STATUS_START:
            lines.append(_decoding(register, register.address - STATUS_START))
    return "\n".join(lines) + "\n"


def _decoding(register: Register, at: int) -> str:
    kind = plain_type(register)
    if kind in ARRAYS:
        value = f"Window[{at} + i]" if register.kind == "ascii" else f"WORD_TO_UINT(Window[{at} + i])"
        last = register.words - 1
        return f"FOR i := 0 TO {last} DO\n    Info.{register.name}[i] := {value};\nEND_FOR;"
    whole = f"(WORD_TO_UDINT(Window[{at}]) * 65536) + WORD_TO_UDINT(Window[{at + 1}])"
    if kind == "REAL":
        return _real(f"Info.{register.name}", whole)
    value = {"WORD": f"Window[{at}]", "UINT": f"WORD_TO_UINT(Window[{at}])"}.get(kind, whole)
    return f"Info.{register.name} := {value};"


def _real(place: str, bits: str) -> str:
    """Return statements that decode a REAL by arithmetic: a conversion by bits is not standard."""
    return f"""\
Bits := {bits};
Exponent := UDINT_TO_INT((Bits / {MANTISSA}) MOD 256);
{place} := 0.0;
IF (Exponent > {EXPONENT - FAR}) AND (Exponent < {EXPONENT + FAR}) THEN
    {place} := UDINT_TO_REAL((Bits MOD {MANTISSA}) + {MANTISSA});
    IF Bits >= {1 << 31} THEN
        {place} := 0.0 - {place};
    END_IF;
    FOR i := 1 TO {FAR} DO
        IF Exponent < {EXPONENT} THEN
            {place} := {place} * 0.5;
            Exponent := Exponent + 1;
        ELSIF Exponent > {EXPONENT} THEN
            {place} := {place} * 2.0;
            Exponent := Exponent - 1;
        END_IF;
    END_FOR;
END_IF;"""
