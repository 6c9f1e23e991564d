"""What a panel may ask of the engine: frozen messages, defined once."""

from dataclasses import dataclass
from typing import ClassVar, Literal


@dataclass(frozen=True, slots=True)
class TestPicture:
    """Take a picture of what lies there now and judge it; the PLC is told nothing."""

    asked_s: float
    """Epoch seconds."""
    type: Literal["test picture"] = "test picture"
    __test__: ClassVar[bool] = False
