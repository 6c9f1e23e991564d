"""What the big lamp shows, and for how long; pure. A green ages: no old OK stays on the screen."""

from dataclasses import dataclass

from station.domain import Origin, Purpose, Verdict
from station.events import PartEvent, StatusEvent
from station.panel import theme
from station.plc.registers import Offline

STATUS_LOST_S = 2.0
FRESH_S = 3.0
GONE_S = 10.0


@dataclass(frozen=True, slots=True)
class Lamp:
    """Word, symbol and colour; `strength` 1 fresh to 0 faded."""

    word: str
    symbol: str
    color: str
    strength: float
    detail: str


def lamp(status: StatusEvent | None, status_age_s: float, part: PartEvent | None, part_age_s: float) -> Lamp:
    """State of the lamp from what was last heard and how long ago."""
    if status is None or status_age_s > STATUS_LOST_S:
        return Lamp("OFFLINE", "○", theme.QUIET, 1.0, "no word from the engine")
    lost = status.offline in (Offline.PLC_SILENT, Offline.CAMERA_LOST, Offline.STATION_STALLED)
    good = part is not None and part.record.verdict is Verdict.OK
    if part is not None and part_age_s <= GONE_S and not (good and lost):
        return _of_part(part, _fade(part_age_s))
    if status.offline is Offline.PLC_SILENT:
        return Lamp("PLC LOST", "⚠", theme.WARN, 1.0, "the PLC's heartbeat stands still")
    if status.offline is not Offline.NONE:
        detail = status.camera_message if status.offline is Offline.CAMERA_LOST else status.offline.name.lower().replace("_", " ")
        return Lamp("OFFLINE", "○", theme.WARN if status.offline is Offline.CAMERA_LOST else theme.QUIET, 1.0, detail)
    return Lamp("NO VERDICT", "–", theme.QUIET, 1.0, "waiting for a part")


def _of_part(part: PartEvent, strength: float) -> Lamp:
    record = part.record
    reason = "" if record.inspection.reason is None else str(record.inspection.reason)
    if record.purpose is Purpose.TEST:
        return Lamp("TEST", "T", theme.TEST, strength, f"test picture, judged {record.verdict}{reason and ': ' + reason}")
    if record.verdict is Verdict.ERROR or not part.shown_to_plc:
        return Lamp("ERROR", "!", theme.WARN, strength, reason or "result came too late for the PLC")
    if record.purpose is Purpose.GOLDEN or record.origin is Origin.REPLAY:
        what = "master" if record.purpose is Purpose.GOLDEN else "replay"
        return Lamp("TEST", "T", theme.TEST, strength, f"{what}, judged {record.verdict}")
    if record.verdict is Verdict.OK:
        return Lamp("OK", "✓", theme.GOOD, strength, "21 of 21 segments")
    return Lamp("NOK", "✗", theme.BAD, strength, reason)


def _fade(age_s: float) -> float:
    return 1.0 if age_s <= FRESH_S else max(0.25, 1.0 - (age_s - FRESH_S) / (GONE_S - FRESH_S))
