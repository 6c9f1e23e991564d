"""Derives alarms, and the health for the PLC, from the state of camera, disk, line and checks; pure."""

from dataclasses import dataclass

from station.archive.room import Room
from station.plc.map.alarms import Alarm
from station.plc.map.registers import Offline
from station.plc.port import Health


@dataclass(frozen=True, slots=True, kw_only=True)
class StationState:
    """State of the station's parts at one moment."""

    camera_connected: bool
    can_write: bool
    room: Room
    plc_silent: bool
    self_test_failed: bool
    master_wrong: bool
    masters_due: bool
    drifting: bool
    settings_refused: bool
    clock_in_doubt: bool
    """True if nothing is deleted for its age because the clock may be wrong."""
    service: str
    """User in service mode, or empty."""
    order_waiting: bool
    """True if an order waits for a moment without a part in progress."""
    bit: int
    """Bit of STATUS that is set by hand; 0: none."""
    recipe: int
    config_crc: int


def alarms(state: StationState) -> tuple[Alarm, ...]:
    """Return the active alarms, the most severe first."""
    conditions = (
        (Alarm.CAMERA_LOST, not state.camera_connected),
        (Alarm.ARCHIVE_FULL, not state.can_write),
        (Alarm.SELF_TEST_FAILED, state.self_test_failed),
        (Alarm.MASTER_WRONG, state.master_wrong),
        (Alarm.PLC_SILENT, state.plc_silent),
        (Alarm.SETTINGS_REFUSED, state.settings_refused),
        (Alarm.MASTERS_DUE, state.masters_due),
        (Alarm.PICTURES_DRIFT, state.drifting),
        (Alarm.CLOCK_IN_DOUBT, state.clock_in_doubt),
        (Alarm.DISK_FILLS, state.can_write and state.room is not Room.ENOUGH),
    )
    return tuple(alarm for alarm, active in conditions if active)


def health(state: StationState) -> Health:
    """Return the health that the line publishes."""
    offline = Offline.NONE
    if not state.camera_connected:
        offline = Offline.CAMERA_LOST
    elif not state.can_write:
        offline = Offline.ARCHIVE_FULL
    elif state.self_test_failed:
        offline = Offline.SELF_TEST_FAILED
    failed = offline is not Offline.NONE
    if state.service:
        offline = Offline.SERVICE
    elif state.order_waiting and not failed:
        offline = Offline.ATTENDED
    active = alarms(state)
    return Health(
        ready=offline is Offline.NONE,
        offline=offline,
        failure=failed,
        config_crc=state.config_crc,
        out_of_spec=state.drifting,
        function_check=state.master_wrong or state.masters_due,
        maintenance=state.room is not Room.ENOUGH,
        recipe=state.recipe,
        alarm=int(active[0]) if active else 0,
        bit=state.bit,
    )
