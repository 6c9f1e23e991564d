"""Requests of windows to the engine and its answers: frozen messages, defined once.

A message carries the token of its login; only the engine knows the user and the rights behind it. A message
that is too old is refused: its sender has already seen that there was no answer.
"""

from dataclasses import dataclass, field
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from station.journal.reviews import Marks, Opinion
from station.journal.users import Level
from station.numbers import Number, not_bool

TOO_OLD = "the request came too late: nothing was done"
"""Refusal of a request that is too old."""
FAULT = "internal error: see the engine's log"
"""Refusal of a request that failed because of a fault in the engine."""
MIN_REASON = 5
"""Minimum number of characters of the reason of a change."""

Name = Annotated[str, Field(max_length=100)]
"""A name of limited length."""
Text = Annotated[str, Field(max_length=1000)]
"""A text of limited length."""


@dataclass(frozen=True, slots=True)
class LogIn:
    """Request to log in by name and PIN; with a commissioning code it first makes an administrator."""

    name: Name
    pin: Annotated[str, Field(max_length=20)] = field(repr=False)
    code: Annotated[str, Field(max_length=30)] = field(default="", repr=False)
    type: Literal["log in"] = "log in"


@dataclass(frozen=True, slots=True)
class StayLoggedIn:
    """Request to renew a login, which shows that the window is alive."""

    touched: bool
    """True if a person has used the window since the last renewal."""
    type: Literal["stay logged in"] = "stay logged in"


@dataclass(frozen=True, slots=True)
class LogOut:
    """Request to end a login and its service mode."""

    why: Literal["asked to", "idle", "window closed"] = "asked to"
    type: Literal["log out"] = "log out"


@dataclass(frozen=True, slots=True)
class SaveUser:
    """Request to add a user, or to change the level and PIN of a user."""

    name: Name
    level: Annotated[Level, BeforeValidator(not_bool)]
    pin: Annotated[str, Field(max_length=20)] = field(repr=False)
    type: Literal["save user"] = "save user"


@dataclass(frozen=True, slots=True)
class RemoveUser:
    """Request to remove a user."""

    name: Name
    type: Literal["remove user"] = "remove user"


SettingValue = Number | dict[int, Number]
"""Value of one setting: a number, or numbers by segment."""


@dataclass(frozen=True, slots=True)
class Changed:
    """A setting and its new value."""

    place: Annotated[tuple[Name, ...], Field(min_length=2, max_length=6)]
    """Path of names: ("camera", "gain_db") or ("recipes", "1", "model", "limits", "hole", "threshold")."""
    value: SettingValue
    shown: SettingValue | None = None
    """Value that the window showed before; written to the journal where the model decides the value."""


@dataclass(frozen=True, slots=True)
class ChangeSettings:
    """Request to change settings, all of them or none; answered once they are active or refused."""

    values: Annotated[tuple[Changed, ...], Field(min_length=1, max_length=50)]
    reason: Text
    type: Literal["change settings"] = "change settings"


@dataclass(frozen=True, slots=True)
class ReloadSettings:
    """Request to read the settings file again, after it was edited by hand."""

    type: Literal["reload settings"] = "reload settings"


@dataclass(frozen=True, slots=True)
class Acknowledge:
    """Request to acknowledge an alarm."""

    number: int
    """Number of the alarm's entry in the journal."""
    type: Literal["acknowledge"] = "acknowledge"


@dataclass(frozen=True, slots=True)
class GiveReview:
    """Request to save a review of a verdict; the verdict itself is not changed."""

    inspection_id: int
    opinion: Opinion
    comment: Text = ""
    marks: Marks = field(default_factory=dict)
    """Missed defect kind by segment."""
    type: Literal["give review"] = field(default="give review", kw_only=True)


@dataclass(frozen=True, slots=True)
class TakeTestImage:
    """Request to take an image of what is in the nest now and judge it, without the PLC."""

    type: Literal["take test image"] = "take test image"


@dataclass(frozen=True, slots=True)
class CheckMaster:
    """Request to judge the master that is in the nest now."""

    serial: Name
    type: Literal["check master"] = "check master"


@dataclass(frozen=True, slots=True, kw_only=True)
class HoldService:
    """Request to begin or renew service mode: READY 0 and MODE 3 until it is no longer renewed."""

    bit: int = 0
    """Bit of STATUS to set by hand; 0: none."""
    look: bool = False
    """True to take setup images, one after the other; they are neither judged nor recorded."""
    exposure_us: Annotated[float, Field(gt=0, le=1_000_000, allow_inf_nan=False)] | None = None
    """Exposure of the setup images; None: that of the settings."""
    gain_db: Annotated[float, Field(ge=0, le=48, allow_inf_nan=False)] | None = None
    """Gain of the setup images; None: that of the settings."""
    type: Literal["hold service"] = "hold service"


@dataclass(frozen=True, slots=True)
class EndService:
    """Request to end service mode."""

    type: Literal["end service"] = "end service"


@dataclass(frozen=True, slots=True)
class ResetCounts:
    """Request to set the counters back to 0."""

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
"""A request of a window."""


@dataclass(frozen=True, slots=True)
class Message:
    """A request with its token and number, as it is sent to the engine."""

    request_id: int
    """Number chosen by the window; the answer carries it."""
    sent_s: float
    """Monotonic time of sending; all processes of the machine share this clock."""
    request: Annotated[Request, Field(discriminator="type")]
    token: Annotated[str, Field(max_length=100)] = field(default="", repr=False)
    """Token of the login, or empty."""


@dataclass(frozen=True, slots=True)
class Answer:
    """Answer of the engine to one request."""

    request_id: int
    refusal: str = ""
    """Reason of the refusal in one line; empty if the request was carried out."""
    logged_in: bool = field(default=False, kw_only=True)
    """True if the message's token belongs to a login."""
    locked_s: float = field(default=0.0, kw_only=True)
    """Seconds until another PIN may be tried."""
    token: str = field(default="", repr=False, kw_only=True)
    """Token of the new login, or empty."""
    name: str = field(default="", kw_only=True)
    """Name of the user who has logged in, or empty."""
    level: Level | None = field(default=None, kw_only=True)
    """Level of the user who has logged in."""

    @property
    def done(self) -> bool:
        """True if the request was carried out."""
        return not self.refusal
