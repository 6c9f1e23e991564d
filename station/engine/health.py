"""How the station stands: from what was seen of camera, disk, line and itself to what the PLC and the people are told; pure."""

from dataclasses import dataclass

from station.archive.room import Room
from station.plc.map.alarms import Alarm
from station.plc.map.registers import Offline
from station.plc.port import Health


@dataclass(frozen=True, slots=True, kw_only=True)
class Seen:
    """What was found just now."""

    camera_there: bool
    can_write: bool
    room: Room
    plc_silent: bool
    self_test_failed: bool
    master_wrong: bool
    masters_due: bool
    drifting: bool
    settings_refused: bool
    service: str
    """Who works on the station, or empty."""
    attended: bool
    """Somebody asked for a picture or for other settings: it is done once no part is in work."""
    bit: int
    recipe: int
    config_crc: int


def alarms(seen: Seen) -> tuple[Alarm, ...]:
    """What lasts, the gravest first."""
    lasting = (
        (Alarm.CAMERA_LOST, not seen.camera_there),
        (Alarm.ARCHIVE_FULL, not seen.can_write),
        (Alarm.SELF_TEST_FAILED, seen.self_test_failed),
        (Alarm.MASTER_WRONG, seen.master_wrong),
        (Alarm.PLC_SILENT, seen.plc_silent),
        (Alarm.SETTINGS_REFUSED, seen.settings_refused),
        (Alarm.MASTERS_DUE, seen.masters_due),
        (Alarm.PICTURES_DRIFT, seen.drifting),
        (Alarm.DISK_FILLS, seen.can_write and seen.room is not Room.ENOUGH),
    )
    return tuple(alarm for alarm, on in lasting if on)


def health(seen: Seen) -> Health:
    """For the line."""
    offline = Offline.NONE
    if not seen.camera_there:
        offline = Offline.CAMERA_LOST
    elif not seen.can_write:
        offline = Offline.ARCHIVE_FULL
    elif seen.self_test_failed:
        offline = Offline.SELF_TEST_FAILED
    failed = offline is not Offline.NONE
    if seen.service:
        offline = Offline.SERVICE
    elif seen.attended and not failed:
        offline = Offline.ATTENDED
    lasting = alarms(seen)
    return Health(
        ready=offline is Offline.NONE,
        offline=offline,
        failure=failed,
        config_crc=seen.config_crc,
        out_of_spec=seen.drifting,
        function_check=seen.master_wrong or seen.masters_due,
        maintenance=seen.room is not Room.ENOUGH,
        recipe=seen.recipe,
        alarm=int(lasting[0]) if lasting else 0,
        bit=seen.bit,
    )
