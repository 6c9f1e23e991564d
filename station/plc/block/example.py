"""A complete program around the block: it takes a part in, has it judged and sends it out.

Its window and command are plain variables, which each dialect ties to its own memory.
"""

from station.plc.block.data_types import COMMAND, SERIAL, WINDOW
from station.plc.block.definition import NAME, Variable

PROGRAM = "WeldgateExample"
"""Name of the program."""
STEPS = "0 empty, 10 wait until the station is ready, 20 in work, 30 good part out, 40 bad part out"
INPUTS: tuple[Variable, ...] = (
    Variable("input", "PartThere", "BOOL", "a part lies in the nest"),
    Variable("input", "Reset", "BOOL", "the bad part was removed by hand"),
    Variable("input", "Released", "WORD", "CONFIG_CRC of the released settings, read once from register 112"),
)
"""Inputs of the program."""
OUTPUTS: tuple[Variable, ...] = (
    Variable("output", "GoodOut", "BOOL", "let the part go"),
    Variable("output", "BadOut", "BOOL", "stop the part and light the lamp"),
    Variable("output", "Why", "UINT", "Refusal of the last part"),
)
"""Outputs of the program."""
LOCALS: tuple[Variable, ...] = (
    Variable("local", "Window", WINDOW.name, "status window"),
    Variable("local", "Command", COMMAND.name, "command window"),
    Variable("local", "Serial", SERIAL.name, "serial of the part, from the reader"),
    Variable("local", "Fresh", "BOOL", "TRUE: every call counts as a new read", initial="TRUE"),
    Variable("local", "Demonstration", "BOOL", "TRUE at a station without a camera, never in production"),
    Variable("local", "Stage", "UINT", STEPS),
    Variable("local", "Start", "BOOL", ""),
    Variable("local", "Station", NAME, ""),
)
"""Variables of the program, besides its inputs and outputs."""


def statements() -> str:
    """Return what the program does in each cycle, in Structured Text."""
    return f"""\
(* the block is called once in each cycle, in the same task in which its outputs are read *)
Station(Window := Window, Fresh := Fresh, Start := Start, Serial := Serial, Crc := Released,
        AcceptSimulated := Demonstration);
Command := Station.Command;

(* {STEPS} *)
CASE Stage OF
0:
    Start := FALSE; (* Start rests between two parts *)
    IF PartThere THEN
        Stage := 10;
    END_IF;
10:
    IF Station.Ready THEN
        Start := TRUE;
        Stage := 20;
    END_IF;
20:
    IF Station.PartDone THEN (* for one call; PartOk counts in this call alone *)
        Start := FALSE;
        Why := Station.Refusal;
        IF Station.PartOk THEN
            GoodOut := TRUE;
            Stage := 30;
        ELSE
            BadOut := TRUE;
            Stage := 40;
        END_IF;
    END_IF;
30:
    IF NOT PartThere THEN
        GoodOut := FALSE;
        Stage := 0;
    END_IF;
40:
    IF Reset AND NOT PartThere THEN
        BadOut := FALSE;
        Stage := 0;
    END_IF;
END_CASE;
"""
