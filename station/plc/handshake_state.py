"""Inputs, state and outcome of the handshake: frozen facts without rules."""

from dataclasses import dataclass
from enum import StrEnum

from station.plc.map.registers import Control, Offline, all_bits
from station.plc.port import NO_SERIAL, Command, Health, Result, Trigger

ALL_CONTROL = all_bits(Control)
"""Mask of all bits of CONTROL, which count as held until the first read of the PLC."""


class Phase(StrEnum):
    """Phase of the handshake; the module `handshake` shows how they follow each other."""

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
    """Longest time without a change of PLC_HEARTBEAT; 0: not monitored."""
    alive_s: float = 3.0
    """Longest time between two check-ins of the inspection."""
    command_s: float = 30.0
    """Time after which a command that was not carried out is refused."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Inputs:
    """Inputs of one step; `control` and the rest of the command window come from the same read."""

    control: Control
    plc_heartbeat: int
    trigger_id: int
    serial: str
    command: int
    health: Health
    health_age_s: float
    exposure_done_for: int | None = None
    """Number of the trigger whose image has been taken."""
    result: Result | None = None
    arg: int = 0
    serial_words: tuple[int, ...] = NO_SERIAL
    """Words of PART_SERIAL."""
    plc_time_s: int = 0
    """PLC_TIME; 0: not known."""
    command_done: tuple[int, bool] | None = None
    """Number of the command that has ended, and whether it succeeded."""
    link: bool = True
    """True if the PLC can be reached."""
    link_was_lost: bool = False
    """True if the last record may not have reached the PLC completely."""


@dataclass(frozen=True, slots=True, kw_only=True)
class State:
    """State that the handshake keeps between two steps."""

    phase: Phase = Phase.OFFLINE
    control: Control = ALL_CONTROL
    """CONTROL as last read; all bits at the start, so that a bit already held does not count as an edge."""
    trigger: Trigger | None = None
    last_id: int = 0
    accepted: int = 0
    """Number of triggers accepted so far."""
    trigger_ack: bool = False
    exposure_done: bool = False
    missed: bool = False
    error: bool = False
    error_code: int = 0
    cmd_done: bool = False
    cmd_echo: int = 0
    command: Command | None = None
    """Command that the station is carrying out."""
    commands: int = 0
    """Number of commands passed to the station so far."""
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
    """Outcome of one step: the new state and what the line must do."""

    state: State
    start: Trigger | None = None
    command: Command | None = None
    refused: bool = False
    """True if the offered result was not accepted for publication."""
    again: bool = False
    """True if another step must follow at once, after publishing."""
