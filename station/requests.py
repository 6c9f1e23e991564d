"""What a panel may ask of the engine: frozen messages, defined once. An old one is not carried out: its sender saw that nothing came."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

from pydantic import Field


@dataclass(frozen=True, slots=True)
class TestPicture:
    """Take a picture of what lies there now and judge it; the PLC is told nothing."""

    asked_s: float
    """Epoch seconds."""
    master: str = ""
    """Serial of the master that lies there, if it is one."""
    type: Literal["test picture"] = "test picture"
    __test__: ClassVar[bool] = False


@dataclass(frozen=True, slots=True)
class Service:
    """Someone works on the station: READY 0, MODE 3, until this is not said again in time."""

    asked_s: float
    who: str
    bit: int = 0
    """The one bit of STATUS to set by hand."""
    look: bool = False
    """Take setting-up pictures, one after the other, judged and recorded by nobody."""
    exposure_us: Annotated[float, Field(gt=0, le=1_000_000, allow_inf_nan=False)] | None = None
    gain_db: Annotated[float, Field(ge=0, le=48, allow_inf_nan=False)] | None = None
    """For the pictures; None: as the settings say."""
    over: bool = False
    """The work is done."""
    type: Literal["service"] = "service"


@dataclass(frozen=True, slots=True)
class Reload:
    """The settings were changed at the station: read them again."""

    asked_s: float
    type: Literal["reload"] = "reload"


@dataclass(frozen=True, slots=True)
class ResetCounts:
    """Set the counters back to 0."""

    asked_s: float
    who: str
    type: Literal["reset counts"] = "reset counts"


Request = TestPicture | Service | Reload | ResetCounts
