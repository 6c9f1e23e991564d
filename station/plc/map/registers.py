"""The register map as data, and the packing and unpacking of its words; pure.

Addresses are 0-based PDU addresses; 32-bit values have the high word first; bit address = register * 16 +
bit, where bit 0 is the least significant one.
"""

import struct
from dataclasses import dataclass, field
from enum import IntEnum, IntFlag
from functools import reduce
from operator import or_
from typing import Literal, TypeVar

from station.domain import SEGMENTS
from station.register_windows import COMMAND_START as COMMAND_START
from station.register_windows import COMMAND_WORDS as COMMAND_WORDS
from station.register_windows import STATUS_START as STATUS_START
from station.register_windows import STATUS_WORDS as STATUS_WORDS

Kind = Literal["u16", "u32", "f32", "ascii"]
Value = int | float | str | tuple[int, ...]
Bits = TypeVar("Bits", bound=IntFlag)

TEST_U32, TEST_F32 = 0x12345678, 123.456
"""Constant values by which an integrator checks the word order."""
MAP_VERSION = 2
"""Version of the map, published in the register of the same name."""


class Control(IntFlag):
    """Bits of CONTROL, written by the PLC."""

    ENABLE = 1
    TRIGGER = 2
    RESULT_ACK = 4
    CLEAR_ERROR = 8
    EXEC_COMMAND = 16
    SET_OFFLINE = 32
    GOLDEN_CHECK = 64
    ABORT = 128


class Status(IntFlag):
    """Bits of STATUS, written by the station; OK and NOK are complementary while RESULT_VALID is 1."""

    ONLINE = 1
    READY = 2
    TRIGGER_ACK = 4
    EXPOSURE_DONE = 8
    BUSY = 16
    RESULT_VALID = 32
    OK = 64
    NOK = 128
    ERROR = 256
    MISSED_TRIGGER = 512
    OVERRUN = 1024
    CMD_DONE = 2048
    MAINTENANCE = 4096
    FUNCTION_CHECK = 8192
    OUT_OF_SPEC = 16384
    FAILURE = 32768


class Flags(IntFlag):
    """Bits of FLAGS, written by the station."""

    SIMULATED = 1
    NOVEL = 2
    DRIFT = 4


class VerdictCode(IntEnum):
    """Values of VERDICT; 0 means that there is no verdict."""

    NONE = 0
    OK = 1
    NOK = 2
    ERROR = 3
    TEST = 4


class Offline(IntEnum):
    """Values of OFFLINE_REASON: why READY is 0."""

    NONE = 0
    STARTING = 1
    NOT_ENABLED = 2
    SET_OFFLINE = 3
    CAMERA_LOST = 4
    ARCHIVE_FULL = 5
    PLC_SILENT = 6
    STATION_STALLED = 7
    PREPARING = 8
    SELF_TEST_FAILED = 9
    SERVICE = 10
    ATTENDED = 11


class CommandCode(IntEnum):
    """Values of COMMAND; commands that MERLIC also has use its codes."""

    LOAD_RECIPE = 2
    RESET = 7
    ABORT = 9
    ACK_ERROR = 11
    RESET_COUNTERS = 20
    TIME_SYNC = 21


REFUSED = 0xFFFF
"""Value of CMD_ECHO for a command that was refused."""
ERROR_NOT_JUDGED = 0x1000
"""Value of ERROR_CODE for a part that could not be judged, to which REASON is added."""
ALL_SEGMENTS = (1 << SEGMENTS) - 1
"""Mask with the bits of all segments, for SEG_NOK_MASK and SEG_INVALID_MASK."""


@dataclass(frozen=True, slots=True)
class Register:
    """One entry of the register map."""

    address: int
    name: str
    kind: Kind
    meaning: str
    count: int = field(default=1, kw_only=True)
    """Number of values, or of characters for ascii."""

    @property
    def words(self) -> int:
        """Number of registers that the value takes."""
        return {"u16": self.count, "u32": 2 * self.count, "f32": 2 * self.count, "ascii": self.count // 2}[
            self.kind
        ]


MAP: tuple[Register, ...] = (
    Register(
        0,
        "CONTROL",
        "u16",
        "bits ENABLE, TRIGGER (edge), RESULT_ACK, CLEAR_ERROR (edge), EXEC_COMMAND (edge), SET_OFFLINE, "
        "GOLDEN_CHECK, ABORT",
    ),
    Register(1, "PLC_HEARTBEAT", "u16", "any change counts"),
    Register(2, "TRIGGER_ID", "u16", "1 to 65535, must differ from the last accepted; 0 is invalid"),
    Register(3, "COMMAND", "u16", "command code for EXEC_COMMAND, see COMMAND"),
    Register(4, "ARG", "u16", "argument of the command: number of the recipe"),
    Register(5, "PART_SERIAL", "ascii", "part serial, 0-padded, high byte first", count=32),
    Register(21, "PLC_TIME", "u32", "epoch seconds, for command 21; 0: not known"),
    Register(100, "STATUS", "u16", "bits, see Status"),
    Register(101, "HEARTBEAT", "u16", "+1 per 100 ms while the inspection is alive"),
    Register(102, "SEQ_HEAD", "u16", "record counter"),
    Register(103, "ACK_TRIGGER_ID", "u16", "last accepted trigger"),
    Register(104, "RESULT_TRIGGER_ID", "u16", "trigger of this result"),
    Register(105, "VERDICT", "u16", "0 none, 1 OK, 2 NOK, 3 ERROR, 4 TEST"),
    Register(106, "VERDICT_INV", "u16", "bitwise complement of VERDICT"),
    Register(107, "INSPECTION_ID", "u32", "never reused"),
    Register(109, "REASON", "u16", "why the part is not OK, see the reason table"),
    Register(110, "ERROR_CODE", "u16", "why there is no verdict, or what the PLC did wrong"),
    Register(111, "ACTIVE_RECIPE", "u16", "recipe in use"),
    Register(112, "CONFIG_CRC", "u16", "CRC over model, thresholds and camera settings"),
    Register(113, "SEG_COUNT", "u16", "number of segments"),
    Register(114, "SEG_NOK_MASK", "u32", "bit i: segment i is NOK"),
    Register(116, "SEG_INVALID_MASK", "u32", "bit i: segment i was not seen or not judged, and is not NOK"),
    Register(118, "WORST_SEG", "u16", "segment with the highest score"),
    Register(119, "WORST_SCORE", "u16", "its score x 10000"),
    Register(120, "T_PROCESS_MS", "u16", "trigger accepted to result, ms"),
    Register(121, "RESULT_AGE_10MS", "u16", "age of the result, 10 ms"),
    Register(122, "SERIAL_ECHO", "ascii", "part serial as judged", count=32),
    Register(
        138,
        "SEG_SCORE",
        "u16",
        "score of each segment x 10000; 0 if its bit of SEG_INVALID_MASK is set",
        count=SEGMENTS,
    ),
    Register(
        159,
        "MODE",
        "u16",
        "1 PRD: parts are judged; 2 SBY: READY is 0; 3 ENG: someone works on the station, see SERVICE",
    ),
    Register(160, "OFFLINE_REASON", "u16", "why READY is 0"),
    Register(161, "CMD_ECHO", "u16", "last command done; 65535: refused"),
    Register(162, "COUNT_OK", "u32", "parts OK since start"),
    Register(164, "COUNT_NOK", "u32", "parts NOK since start"),
    Register(166, "COUNT_ERROR", "u32", "parts not judged since start"),
    Register(168, "TEST_U32", "u32", "always 16#12345678"),
    Register(170, "TEST_F32", "f32", "always 123.456"),
    Register(172, "MAP_VERSION", "u16", "version of this map"),
    Register(173, "SW_VERSION", "u16", "major * 256 + minor"),
    Register(
        174,
        "FLAGS",
        "u16",
        "bit 0 SIMULATED: picture of an emulated camera; bit 1 NOVEL: it is unlike all training images; "
        "bit 2 DRIFT: the last pictures differ from the line's reference",
    ),
    Register(175, "SEQ_TAIL", "u16", "equals SEQ_HEAD when the record is complete"),
)
"""Registers in the order of their addresses; their meanings are printed in the documents."""
BY_NAME = {register.name: register for register in MAP}
"""Registers by name."""


def pack(register: Register, value: Value) -> list[int]:
    """Return the words of one value. Raises ValueError if it does not fit.

    A value of kind ascii is a text, or its words as they are.
    """
    if register.kind == "ascii":
        if isinstance(value, tuple):
            value = struct.pack(f">{len(value)}H", *value).decode("latin-1")
        if not isinstance(value, str):
            raise ValueError(f"{register.name}: text expected")
        raw = value.encode("latin-1", "replace")
        if len(raw) > register.count:
            raise ValueError(f"{register.name}: {len(raw)} characters; at most {register.count} fit")
        raw = raw.ljust(register.count, b"\0")
        return list(struct.unpack(f">{register.words}H", raw))
    values = value if isinstance(value, tuple) else (value,)
    if len(values) != register.count or isinstance(value, str):
        raise ValueError(f"{register.name}: {register.count} numbers expected")
    code = {"u16": "H", "u32": "I", "f32": "f"}[register.kind]
    try:
        raw = struct.pack(f">{register.count}{code}", *values)
    except struct.error as error:
        raise ValueError(f"{register.name}: {value} does not fit: {error}") from None
    return list(struct.unpack(f">{register.words}H", raw))


def unpack(register: Register, words: list[int]) -> Value:
    """Return the value of one register's words.

    A text ends before its first NUL; characters that cannot be printed read U+FFFD.
    """
    raw = struct.pack(f">{register.words}H", *words)
    if register.kind == "ascii":
        text = raw.split(b"\0", 1)[0].decode("latin-1")
        return "".join(letter if letter.isprintable() else "\ufffd" for letter in text)
    code = {"u16": "H", "u32": "I", "f32": "f"}[register.kind]
    values = struct.unpack(f">{register.count}{code}", raw)
    return values[0] if register.count == 1 else values


def pack_window(start: int, words: int, values: dict[str, Value]) -> list[int]:
    """Return the words of a window; registers that `values` does not name are 0."""
    window = [0] * words
    for name, value in values.items():
        register = BY_NAME[name]
        at = register.address - start
        window[at : at + register.words] = pack(register, value)
    return window


def unpack_window(start: int, words: list[int]) -> dict[str, Value]:
    """Return the values of all registers that lie completely in the window, by name."""
    end = start + len(words)
    return {
        register.name: unpack(register, words[register.address - start :][: register.words])
        for register in MAP
        if start <= register.address and register.address + register.words <= end
    }


def reordered(start: int, words: list[int]) -> list[int]:
    """Return a window with the words of each 32-bit value swapped, for a PLC with the low word first.

    Applied twice, it gives the window back.
    """
    swapped = list(words)
    for register in MAP:
        at = register.address - start
        if register.kind in ("u32", "f32") and 0 <= at and at + register.words <= len(words):
            swapped[at], swapped[at + 1] = words[at + 1], words[at]
    return swapped


def all_bits(flags: type[Bits]) -> Bits:
    """Return all bits that have a name in `flags`."""
    return flags(reduce(or_, map(int, flags), 0))


def named_bits(flags: type[Bits], register: int) -> Bits:
    """Return the bits of a register that have a name in `flags`; a bit without a name is ignored on purpose.

    This is the only place that masks CONTROL, STATUS and FLAGS: a bit added to the enum is known everywhere.
    """
    return flags(register & all_bits(flags))


def number(values: dict[str, Value], name: str) -> int:
    """Return a whole number of an unpacked window. Raises ValueError if it is of another type."""
    value = values[name]
    if not isinstance(value, int):
        raise ValueError(f"{name}: not a whole number")
    return value
