"""Types that the PLC's function block declares: named arrays and two records.

Strict compilers refuse an array without a name as the type of a parameter.
"""

from dataclasses import dataclass

from station.plc.map.registers import (
    BY_NAME,
    COMMAND_WORDS,
    MAP,
    STATUS_START,
    STATUS_WORDS,
    Register,
)

RECORD = "WeldgateStatus"
"""Name of the type that holds the decoded status window."""
RESULT = "WeldgateResult"
"""Name of the type that holds the answer to a part."""


@dataclass(frozen=True, slots=True)
class Array:
    """Named array type that starts at 0."""

    name: str
    count: int
    type: str

    def __str__(self) -> str:
        return f"ARRAY[0..{self.count - 1}] OF {self.type}"


@dataclass(frozen=True, slots=True)
class Field:
    """One field of a record type."""

    name: str
    type: str
    meaning: str


WINDOW = Array("WeldgateWindow", STATUS_WORDS, "WORD")
COMMAND = Array("WeldgateCommand", COMMAND_WORDS, "WORD")
SERIAL = Array("WeldgateSerial", BY_NAME["PART_SERIAL"].words, "WORD")
SCORES = Array("WeldgateScores", BY_NAME["SEG_SCORE"].words, "UINT")
ARRAYS: dict[str, Array] = {array.name: array for array in (WINDOW, COMMAND, SERIAL, SCORES)}
"""Array types by name."""
BITS = ("STATUS", "CONFIG_CRC", "FLAGS")
"""Registers of one word that hold bits and no number."""


def plain_type(register: Register) -> str:
    """Return the type of a register's decoded value. Raises ValueError if an array type is missing."""
    if register.count > 1:
        array = SERIAL if register.kind == "ascii" else SCORES
        if array.count != register.words:
            raise ValueError(f"{register.name}: needs an array type of {register.words} words of its own")
        return array.name
    number = {"u16": "UINT", "u32": "UDINT", "f32": "REAL"}[register.kind]
    return "WORD" if register.name in BITS else number


STATUS_FIELDS: tuple[Field, ...] = tuple(
    Field(register.name, plain_type(register), register.meaning)
    for register in MAP
    if register.address >= STATUS_START
)
"""Fields of the decoded status window."""
COPIED = (
    "VERDICT",
    "REASON",
    "ERROR_CODE",
    "INSPECTION_ID",
    "FLAGS",
    "SEG_NOK_MASK",
    "SEG_INVALID_MASK",
    "WORST_SEG",
    "WORST_SCORE",
    "SEG_SCORE",
)
"""Registers that the answer to a part keeps after the station has cleared them."""
RESULT_FIELDS: tuple[Field, ...] = (
    Field("NUMBER", "UDINT", "number of this answer, counted since the block started"),
    Field("REFUSAL", "UINT", "first point that did not hold, 0: none"),
    Field("TRIGGER_ID", "UINT", "number of the part's trigger, 0: none was sent"),
    *(field for name in COPIED for field in STATUS_FIELDS if field.name == name),
)
"""Fields of the answer to a part."""
RECORDS: dict[str, tuple[Field, ...]] = {RECORD: STATUS_FIELDS, RESULT: RESULT_FIELDS}
"""Fields by record type."""
