"""What the big lamp shows, and for how long; pure. A green ages: no old OK stays on the screen."""

from dataclasses import dataclass
from enum import StrEnum

from station.domain import Origin, Purpose, Verdict
from station.events import PartEvent, StatusEvent
from station.plc.registers import Offline

STATUS_LOST_S = 2.0
FRESH_S = 3.0
GONE_S = 10.0


class Tone(StrEnum):
    """Colour of the theme."""

    GOOD = "good"
    BAD = "bad"
    WARN = "warn"
    TEST = "test"
    QUIET = "quiet"


WHY_OFFLINE = {
    Offline.STARTING: "the station starts",
    Offline.NOT_ENABLED: "the PLC has not enabled the station",
    Offline.SET_OFFLINE: "the PLC has set the station offline",
    Offline.ARCHIVE_FULL: "no records can be written",
    Offline.STATION_STALLED: "the inspection stands still",
    Offline.PREPARING: "a recipe is loaded",
    Offline.SELF_TEST_FAILED: "the stored frame is judged differently",
    Offline.SERVICE: "works on the station",
    Offline.ATTENDED: "a picture is taken or settings are loaded, as asked for in the window",
}
"""For reasons that the lamp has no word of its own for."""


@dataclass(frozen=True, slots=True)
class Lamp:
    """Word, symbol and colour; `strength` 1 fresh to 0 faded. `detail` has a word of the vocabulary, `more` what is as it is."""

    word: str
    symbol: str
    tone: Tone
    strength: float
    detail: str = ""
    more: str = ""


def lamp(status: StatusEvent | None, status_age_s: float, part: PartEvent | None, part_age_s: float) -> Lamp:
    """State of the lamp from what was last heard and how long ago."""
    if status is None or status_age_s > STATUS_LOST_S:
        return Lamp("OFFLINE", "○", Tone.QUIET, 1.0, "no word from the engine")
    if status.service:
        return Lamp("SERVICE", "⚙", Tone.TEST, 1.0, "works on the station", status.service)
    lost = status.offline in (Offline.PLC_SILENT, Offline.CAMERA_LOST, Offline.STATION_STALLED)
    good = part is not None and part.record.verdict is Verdict.OK
    if part is not None and part_age_s <= GONE_S and not (good and lost):
        return _of_part(part, _fade(part_age_s))
    if status.offline is Offline.PLC_SILENT:
        return Lamp("PLC LOST", "⚠", Tone.WARN, 1.0, "the PLC's heartbeat stands still")
    if status.offline is Offline.CAMERA_LOST:
        return Lamp("OFFLINE", "○", Tone.WARN, 1.0, "camera lost", status.camera_message)
    if status.offline is not Offline.NONE:
        return Lamp("OFFLINE", "○", Tone.QUIET, 1.0, WHY_OFFLINE[status.offline])
    return Lamp("NO VERDICT", "–", Tone.QUIET, 1.0, "waiting for a part")


def _of_part(part: PartEvent, strength: float) -> Lamp:
    record = part.record
    reason = "" if record.inspection.reason is None else str(record.inspection.reason)
    if record.purpose is Purpose.TEST:
        return Lamp("TEST", "T", Tone.TEST, strength, "test picture", str(record.verdict))
    if record.verdict is Verdict.ERROR or not (part.shown_to_plc or record.purpose is Purpose.GOLDEN):
        return Lamp("ERROR", "!", Tone.WARN, strength, reason or "result came too late for the PLC")
    if record.purpose is Purpose.GOLDEN or record.origin is Origin.REPLAY:
        return Lamp("TEST", "T", Tone.TEST, strength, "master" if record.purpose is Purpose.GOLDEN else "replay", str(record.verdict))
    if record.verdict is Verdict.OK:
        return Lamp("OK", "✓", Tone.GOOD, strength, "21 of 21 segments")
    return Lamp("NOK", "✗", Tone.BAD, strength, reason)


def _fade(age_s: float) -> float:
    return 1.0 if age_s <= FRESH_S else max(0.25, 1.0 - (age_s - FRESH_S) / (GONE_S - FRESH_S))
