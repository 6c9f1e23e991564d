"""Prints one file for OpenPLC: types, block, program with located words, and configuration.

OpenPLC's Modbus server shows %MW0 as holding register 1024. The station is the client (`preset = "openplc"`):
it reads the command window at %MW0 and writes the status window at %MW100.
"""

from station.plc.block.dialects import declared, structured_text
from station.plc.block.example import INPUTS, LOCALS, OUTPUTS, PROGRAM, statements
from station.plc.map.registers import COMMAND_START, COMMAND_WORDS, STATUS_START, STATUS_WORDS

LOCATED = {"PartThere": "%IX0.0", "Reset": "%IX0.1", "GoodOut": "%QX0.0", "BadOut": "%QX0.1"}
"""Terminals of the program's inputs and outputs."""
TASK = "T#20ms"


def openplc() -> str:
    """Return the file, which OpenPLC compiles as it is."""
    at_terminals = "".join(
        f"    {each.name} AT {LOCATED[each.name]} : {each.type}; (* {each.meaning} *)\n"
        for each in (*INPUTS, *OUTPUTS)
        if each.name in LOCATED
    )
    command = [(f"Cmd{i}", COMMAND_START + i) for i in range(COMMAND_WORDS)]
    status = [(f"Sta{i}", STATUS_START + i) for i in range(STATUS_WORDS)]
    words = "".join(f"    {name} AT %MW{address} : WORD;\n" for name, address in (*command, *status))
    others = [each for each in (*INPUTS, *OUTPUTS, *LOCALS) if each.name not in LOCATED]
    taken = "".join(f"Window[{i}] := {name};\n" for i, (name, _) in enumerate(status))
    given = "".join(f"{name} := Command[{i}];\n" for i, (name, _) in enumerate(command))
    return (
        f"{structured_text()}\n"
        f"PROGRAM {PROGRAM}\n"
        f"VAR\n{at_terminals}{words}END_VAR\n"
        f"VAR\n{''.join(declared(each, each.type) for each in others)}END_VAR\n\n"
        f"{taken}\n{statements()}\n{given}END_PROGRAM\n\n"
        f"CONFIGURATION Config0\n"
        f"    RESOURCE Res0 ON PLC\n"
        f"        TASK Main(INTERVAL := {TASK}, PRIORITY := 0);\n"
        f"        PROGRAM Instance0 WITH Main : {PROGRAM};\n"
        f"    END_RESOURCE\n"
        f"END_CONFIGURATION\n"
    )
