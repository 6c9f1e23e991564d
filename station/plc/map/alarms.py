"""Alarms of the station: code, cause and action, for the window, ERROR_CODE and the register map."""

from dataclasses import dataclass
from enum import IntEnum

from station.defects import Reason
from station.plc.map.codes import (
    ERROR_ABORTED,
    ERROR_BAD_TRIGGER_ID,
    ERROR_DEADLINE,
    ERROR_LINK_LOST,
    ERROR_STUCK_BIT,
)
from station.plc.map.registers import ERROR_NOT_JUDGED


class Alarm(IntEnum):
    """Alarms that stay active; ERROR_CODE shows them while there is no other error."""

    CAMERA_LOST = 0x3001
    ARCHIVE_FULL = 0x3002
    DISK_FILLS = 0x3003
    PLC_SILENT = 0x3004
    SELF_TEST_FAILED = 0x3005
    MASTER_WRONG = 0x3006
    MASTERS_DUE = 0x3007
    PICTURES_DRIFT = 0x3008
    SETTINGS_REFUSED = 0x3009
    CLOCK_IN_DOUBT = 0x300A


ENGINE_HUNG = 0x300B
"""Code in the journal of an engine that ended itself; ERROR_CODE never shows it."""


@dataclass(frozen=True, slots=True)
class Explained:
    """Explanation of an alarm code for the operator."""

    cause: str
    action: str


TEXTS: dict[int, Explained] = {
    Alarm.CAMERA_LOST: Explained(
        "camera lost", "check power and cable of the camera; the station reconnects automatically"
    ),
    Alarm.ARCHIVE_FULL: Explained(
        "records cannot be written", "free space on the archive's disk; check that it is writable"
    ),
    Alarm.DISK_FILLS: Explained(
        "the archive's disk is nearly full", "free space, or shorten the retention (archive.keep)"
    ),
    Alarm.PLC_SILENT: Explained("PLC heartbeat lost", "check the PLC program and the network to the PLC"),
    Alarm.SELF_TEST_FAILED: Explained(
        "self-test failed: the stored frame is judged differently",
        "restart the station; if it comes back, check the PC's memory",
    ),
    Alarm.MASTER_WRONG: Explained(
        "a master was judged wrongly", "check master, light and focus; run the master check again"
    ),
    Alarm.MASTERS_DUE: Explained("master check is due", "run the master check"),
    Alarm.PICTURES_DRIFT: Explained(
        "image drift detected", "check light, focus, glass and the surface of the parts"
    ),
    Alarm.SETTINGS_REFUSED: Explained(
        "changed settings could not be used", "see the engine's log; the previous settings stay active"
    ),
    Alarm.CLOCK_IN_DOUBT: Explained(
        "the clock jumped: no old records are deleted",
        "set the clock right, then say which dates are right: weldgate records clock",
    ),
    ENGINE_HUNG: Explained(
        "the engine hung and ended itself",
        "see the engine's log for what hung; check camera, disk and network cards",
    ),
    ERROR_DEADLINE: Explained(
        "no result within the deadline", "see cycle times on the page Statistics; check the PC's load"
    ),
    ERROR_ABORTED: Explained("the PLC aborted the part", "check the program of the line"),
    ERROR_BAD_TRIGGER_ID: Explained(
        "TRIGGER_ID was 0 or repeated", "correct the PLC program: each part needs a new number"
    ),
    ERROR_STUCK_BIT: Explained(
        "TRIGGER or RESULT_ACK was held too long", "correct the PLC program: see the page Line"
    ),
    ERROR_LINK_LOST: Explained(
        "the connection was lost while the result was written", "check the network to the PLC"
    ),
}

"""Explanation by alarm or error code."""
_AGAIN = "judge the part again; if it comes back, "
_PART_ACTIONS = {
    Reason.NO_WELD_FOUND: "check that a part is in the nest and in the camera's view",
    Reason.WELD_OUT_OF_VIEW: "check the part's seat and the camera's position",
    Reason.WRONG_SIZE: "set width and height of the camera as in the settings",
    Reason.INCOMPLETE_FRAME: "check network cable, switch and jumbo frames",
    Reason.TOO_DARK: "check the light and the exposure",
    Reason.TOO_BRIGHT: "check the light and the exposure",
    Reason.BLURRED: "check focus and glass, and that the part stands still",
    Reason.CAMERA_LOST: "check power and cable of the camera",
    Reason.NO_FRAME: "check the trigger line and camera.timeout_ms",
    Reason.MODEL_FAILED: "restart the station, restore the model file",
    Reason.RECORD_FAILED: "check the archive's disk",
    Reason.INTERNAL: "send the engine's log to the maker",
    Reason.SEGMENT_NOT_SEEN: "check light, glass and nest for dirt, shadow and glare",
    Reason.UNLIKE_TRAINING: "check light, focus and surface",
    Reason.NOT_OF_TRIGGER: "check the trigger line: its edge must come after BUSY, once per part",
}
for _reason, _action in _PART_ACTIONS.items():
    TEXTS[ERROR_NOT_JUDGED + _reason.code] = Explained(str(_reason), _AGAIN + _action)
