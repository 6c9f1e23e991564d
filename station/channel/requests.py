"""What a window may ask of the engine, and how the engine answers: frozen messages, defined once.

A message carries the token that its login was given; who asks and what they may do is known to the engine
alone. A message that is too old is refused: its sender has seen that nothing came.
"""

from dataclasses import dataclass, field
from typing import Annotated, Literal

from pydantic import Field

from station.journal.reviews import Marks, Opinion
from station.journal.users import Level

TOO_OLD = "the request came too late: nothing was done"
"""Refusal of a request whose sender has seen that nothing came."""

FAULT = "internal error: see the engine's log"
"""Refusal of a request that ended in a fault of the engine."""
MIN_REASON = 5
"""Characters that the reason of a change needs at least."""

Name = Annotated[str, Field(max_length=100)]
Text = Annotated[str, Field(max_length=1000)]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]


@dataclass(frozen=True, slots=True)
class LogIn:
    """Log in by name and PIN; at a station without users this makes the first administrator."""

    name: Name
    pin: Annotated[str, Field(max_length=20)] = field(repr=False)
    type: Literal["log in"] = "log in"


@dataclass(frozen=True, slots=True)
class StayLoggedIn:
    """Renew the login: the window is alive; `touched`: somebody used it since the last renewal."""

    touched: bool
    type: Literal["stay logged in"] = "stay logged in"


@dataclass(frozen=True, slots=True)
class LogOut:
    """End the login, and with it service mode."""

    why: Literal["asked to", "idle", "window closed"] = "asked to"
    type: Literal["log out"] = "log out"


@dataclass(frozen=True, slots=True)
class SaveUser:
    """Add a user, or give a known one another level and PIN."""

    name: Name
    level: Level
    pin: Annotated[str, Field(max_length=20)] = field(repr=False)
    type: Literal["save user"] = "save user"


@dataclass(frozen=True, slots=True)
class RemoveUser:
    """Remove a user."""

    name: Name
    type: Literal["remove user"] = "remove user"


SettingValue = Number | dict[int, Number]
"""Value of one setting: a number, or numbers by segment."""


@dataclass(frozen=True, slots=True)
class Changed:
    """One setting and its new value."""

    place: Annotated[tuple[Name, ...], Field(min_length=2, max_length=6)]
    """Names from the top: ("camera", "gain_db") or ("recipes", "1", "model", "limits", "hole", "threshold")."""
    value: SettingValue
    shown: SettingValue | None = None
    """Value that the window showed before; noted where the settings leave it to the model."""


@dataclass(frozen=True, slots=True)
class ChangeSettings:
    """Change settings of the station, all of them or none; answered once they are in use or refused."""

    values: Annotated[tuple[Changed, ...], Field(min_length=1, max_length=50)]
    reason: Text
    type: Literal["change settings"] = "change settings"


@dataclass(frozen=True, slots=True)
class ReloadSettings:
    """Read the settings file again, after somebody has edited it by hand."""

    type: Literal["reload settings"] = "reload settings"


@dataclass(frozen=True, slots=True)
class Acknowledge:
    """Acknowledge an alarm."""

    number: int
    """Number of the alarm's entry in the journal."""
    type: Literal["acknowledge"] = "acknowledge"


@dataclass(frozen=True, slots=True)
class GiveReview:
    """Say what one thinks of a verdict; the verdict itself stays."""

    inspection_id: int
    opinion: Opinion
    comment: Text = ""
    marks: Marks = field(default_factory=dict)
    """Segments in which a defect was missed."""
    type: Literal["give review"] = "give review"


@dataclass(frozen=True, slots=True)
class TakeTestImage:
    """Take an image of what lies there now and judge it; the PLC is not informed."""

    type: Literal["take test image"] = "take test image"


@dataclass(frozen=True, slots=True)
class CheckMaster:
    """Judge the master that lies there now."""

    serial: Name
    type: Literal["check master"] = "check master"


@dataclass(frozen=True, slots=True)
class HoldService:
    """Begin or renew service mode: READY 0, MODE 3, until this is not said again in time."""

    bit: int = 0
    """The one bit of STATUS to set by hand."""
    look: bool = False
    """Take setup images, one after the other; they are neither judged nor recorded."""
    exposure_us: Annotated[float, Field(gt=0, le=1_000_000, allow_inf_nan=False)] | None = None
    gain_db: Annotated[float, Field(ge=0, le=48, allow_inf_nan=False)] | None = None
    """For the setup images; None: as the settings say."""
    type: Literal["hold service"] = "hold service"


@dataclass(frozen=True, slots=True)
class EndService:
    """End service mode."""

    type: Literal["end service"] = "end service"


@dataclass(frozen=True, slots=True)
class ResetCounts:
    """Set the counters back to 0."""

    type: Literal["reset counts"] = "reset counts"


Request = (
    LogIn
    | StayLoggedIn
    | LogOut
    | SaveUser
    | RemoveUser
    | ChangeSettings
    | ReloadSettings
    | Acknowledge
    | GiveReview
    | TakeTestImage
    | CheckMaster
    | HoldService
    | EndService
    | ResetCounts
)


@dataclass(frozen=True, slots=True)
class Message:
    """One request on its way to the engine."""

    request_id: int
    """Chosen by the window; the answer bears it."""
    sent_s: float
    """Monotonic time: one clock for all processes of the machine."""
    request: Annotated[Request, Field(discriminator="type")]
    token: Annotated[str, Field(max_length=100)] = field(default="", repr=False)
    """Token of the login, or empty."""


@dataclass(frozen=True, slots=True)
class Answer:
    """What the engine says to one request."""

    request_id: int
    refusal: str = ""
    """Why it was refused, in one line; empty: it was done."""
    logged_in: bool = False
    """True if the message's token belongs to a login."""
    locked_s: float = 0.0
    """Seconds until another PIN may be tried."""
    token: str = field(default="", repr=False)
    """Token of the new login."""
    name: str = ""
    level: Level | None = None
    """Who has logged in."""

    @property
    def done(self) -> bool:
        """True if the request was carried out."""
        return not self.refusal
