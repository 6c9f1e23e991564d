"""What the handshake sees, remembers and decides: frozen facts, no rule."""

from dataclasses import dataclass
from enum import StrEnum

from station.plc.map.registers import Control, Offline, all_bits
from station.plc.port import Command, Health, Result, Trigger

ALL_CONTROL = all_bits(Control)
"""Every bit of CONTROL: what counts as held until the PLC is heard."""


class Phase(StrEnum):
    """Where the handshake stands."""

    OFFLINE = "offline"
    IDLE = "idle"
    WIPED = "wiped"
    BUSY = "busy"
    SHOWN = "shown"


@dataclass(frozen=True, slots=True, kw_only=True)
class Times:
    """Time-outs in seconds."""

    deadline_s: float = 2.0
    result_ttl_s: float = 10.0
    stuck_s: float = 5.0
    plc_heartbeat_s: float = 2.0
    """0: not watched."""
    alive_s: float = 3.0
    """The inspection must have checked in within this time."""
    command_s: float = 30.0
    """A command not carried out by then is refused."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Inputs:
    """What one step sees. `control` and the rest of the command window as read at once."""

    control: Control
    plc_heartbeat: int
    trigger_id: int
    serial: str
    command: int
    health: Health
    health_age_s: float
    exposure_done_for: int | None = None
    """Number of the trigger whose picture is taken."""
    result: Result | None = None
    arg: int = 0
    command_done: tuple[int, bool] | None = None
    """Number of the command that was carried out, and whether well."""
    link: bool = True
    """The PLC can be reached."""
    link_was_lost: bool = False
    """The last record may not have reached the PLC whole."""


@dataclass(frozen=True, slots=True, kw_only=True)
class State:
    """All that the handshake remembers."""

    phase: Phase = Phase.OFFLINE
    control: Control = ALL_CONTROL
    """As seen last; all bits at the start, so that a bit the PLC still holds is no edge."""
    trigger: Trigger | None = None
    last_id: int = 0
    accepted: int = 0
    """Triggers accepted so far."""
    trigger_ack: bool = False
    exposure_done: bool = False
    missed: bool = False
    error: bool = False
    error_code: int = 0
    cmd_done: bool = False
    cmd_echo: int = 0
    command: Command | None = None
    """Being carried out."""
    commands: int = 0
    """Commands handed to the station so far."""
    result: Result | None = None
    shown_s: float = 0.0
    process_ms: int = 0
    sequence: int = 0
    heartbeat: int = 0
    heartbeat_s: float = 0.0
    plc_heartbeat: int = -1
    plc_seen_s: float = -1e9
    trigger_since_s: float = 0.0
    ack_since_s: float = 0.0
    stuck: bool = False
    offline: Offline = Offline.STARTING


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """Outcome of one step: the new state, and what to do."""

    state: State
    start: Trigger | None = None
    command: Command | None = None
    refused: bool = False
    """The offered result was not shown."""
    again: bool = False
    """Step again at once, after publishing."""
