"""Why a part is not OK: the kinds of defect, and the reasons why a part could not be judged.

This file alone defines which kinds of defect there are. Settings, scores, findings, labels, training,
reports, registers and the window loop over `KINDS`; the generator has one module per kind in `synth.defects`.
"""

from dataclasses import dataclass
from enum import Enum, StrEnum
from typing import Any


class Reason(StrEnum):
    """Why a part is not OK: the text for records and people, and the number for the PLC.

    The numbers are part of the wire protocol: a new reason takes the next free number, and no number changes.
    """

    code: int
    """Value of the register REASON; for a part that could not be judged, ERROR_CODE is 16#1000 plus it."""

    def __new__(cls, text: str, code: int = 0) -> "Reason":
        """Make a member. Raises ValueError if it has no code, or the code of another member."""
        if code < 1 or code in {member.code for member in cls}:
            raise ValueError(f"reason {text!r} needs a PLC code of its own, 1 or higher")
        member = str.__new__(cls, text)
        member._value_ = text
        member.code = code
        return member

    HOLE = "hole", 1
    MISSING_WELD = "missing weld", 2
    NO_WELD_FOUND = "no weld found", 3
    WELD_OUT_OF_VIEW = "weld not wholly in view", 4
    WRONG_SIZE = "frame has the wrong size", 5
    INCOMPLETE_FRAME = "frame incompletely grabbed", 6
    TOO_DARK = "image too dark", 7
    TOO_BRIGHT = "image too bright", 8
    BLURRED = "image blurred", 9
    CAMERA_LOST = "camera lost", 10
    NO_FRAME = "no frame in time", 11
    DEADLINE = "deadline missed", 12
    MODEL_FAILED = "classifier failed", 13
    RECORD_FAILED = "record could not be written", 14
    ABORTED = "aborted by the PLC", 15
    INTERNAL = "internal error", 16
    SEGMENT_NOT_SEEN = "segment not seen", 17
    UNLIKE_TRAINING = "unlike the training images", 18
    NOT_OF_TRIGGER = "frame not of this trigger", 19


class Width(Enum):
    """How the width of a finding is measured on the defect map."""

    EDGE_TO_EDGE = "edge to edge"
    MEAN = "mean"
    """Area divided by length, for long findings with uneven borders."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DefectKind:
    """One kind of defect, with everything that the rest of weldgate needs to know about it."""

    name: str
    """Key in settings, labels, datasets and model files; never changes once released."""
    reason: Reason
    """Text for people, and code for the PLC."""
    color_rgb: tuple[int, int, int]
    """Colour of its layer of the defect map in the window."""
    line_fraction: float
    """Expected fraction of a line's segments that show it; weights scores and thresholds."""
    is_mapped: bool = True
    """True if the classifier's defect map has a channel for it, which measures its findings; False if only
    whole crops are judged, and its findings are whole segments."""
    joins_mm: float = 0.0
    """Distance below which two areas of the defect map are one finding."""
    width: Width = Width.EDGE_TO_EDGE

    @classmethod
    def __get_pydantic_core_schema__(cls, _source: object, _handler: object) -> Any:
        """Return a schema that reads and writes a kind as its name, and refuses unknown names."""
        from pydantic_core import core_schema

        as_name = core_schema.plain_serializer_function_ser_schema(
            lambda kind: kind.name, return_schema=core_schema.str_schema()
        )
        return core_schema.no_info_plain_validator_function(_checked, serialization=as_name)


KINDS: tuple[DefectKind, ...] = (
    DefectKind(name="hole", reason=Reason.HOLE, color_rgb=(255, 60, 50), line_fraction=0.06),
    DefectKind(
        name="missing_weld",
        reason=Reason.MISSING_WELD,
        color_rgb=(255, 190, 40),
        line_fraction=0.04,
        joins_mm=1.0,
        width=Width.MEAN,
    ),
)
"""All kinds of defect by increasing severity: a crop that shows several is labelled with the last of them."""


def kind_named(name: str) -> DefectKind:
    """Return the kind with this name. Raises ValueError with the known names."""
    for kind in KINDS:
        if kind.name == name:
            return kind
    raise ValueError(f"unknown kind of defect {name!r}; known: {', '.join(kind.name for kind in KINDS)}")


def kind_of(reason: Reason) -> DefectKind | None:
    """Return the kind of defect that has this reason, or None if the reason is not a defect."""
    return next((kind for kind in KINDS if kind.reason is reason), None)


def _checked(value: object) -> DefectKind:
    return value if isinstance(value, DefectKind) else kind_named(str(value))
