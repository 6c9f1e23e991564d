"""What the big lamp shows, and for how long; pure. A green ages: no old OK stays on the screen."""

from dataclasses import dataclass
from enum import StrEnum

from station.channel.events import STATUS_LOST_S, PartEvent, StatusEvent
from station.domain import Origin, Purpose, Verdict
from station.plc.map.alarms import Alarm
from station.plc.map.registers import Offline, VerdictCode

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


def lamp(status: StatusEvent | None, part: PartEvent | None, now_s: float) -> Lamp:
    """State of the lamp from what was last heard and when it was sent; `now_s`: monotonic time.

    Green stands for a fresh OK that the PLC reads and takes: of this run of the engine, while nothing keeps the station off the line.
    """
    if status is None or now_s - status.at_s > STATUS_LOST_S:
        return Lamp("OFFLINE", "○", Tone.QUIET, 1.0, "no word from the engine")
    if status.service:
        return Lamp("SERVICE", "⚙", Tone.TEST, 1.0, "works on the station", status.service)
    age_s = 1e9 if part is None or part.at_s < status.started_s else now_s - part.at_s
    offline = status.line.offline
    blocked = offline is not Offline.NONE
    if part is not None and age_s <= GONE_S and not (part.told is VerdictCode.OK and blocked):
        return _of_part(part, Alarm.MASTERS_DUE in status.alarms, _fade(age_s))
    if offline is Offline.PLC_SILENT:
        return Lamp("PLC LOST", "⚠", Tone.WARN, 1.0, "the PLC's heartbeat stands still")
    if offline is Offline.CAMERA_LOST:
        return Lamp("OFFLINE", "○", Tone.WARN, 1.0, "camera lost", status.camera_message)
    if offline is not Offline.NONE:
        return Lamp("OFFLINE", "○", Tone.QUIET, 1.0, WHY_OFFLINE[offline])
    return Lamp("NO VERDICT", "–", Tone.QUIET, 1.0, "waiting for a part")


def _of_part(part: PartEvent, masters_due: bool, strength: float) -> Lamp:
    record = part.record
    reason, found = (
        "" if record.inspection.reason is None else str(record.inspection.reason),
        str(record.verdict),
    )
    if record.purpose is not Purpose.PART:
        return Lamp(
            "TEST",
            "T",
            Tone.TEST,
            strength,
            "master" if record.purpose is Purpose.GOLDEN else "test picture",
            found,
        )
    if part.told is VerdictCode.ERROR:
        late = record.verdict is not Verdict.ERROR
        return Lamp("ERROR", "!", Tone.WARN, strength, "result came too late for the PLC" if late else reason)
    if part.told is VerdictCode.TEST:
        why = "replay" if record.origin is Origin.REPLAY else "not to be trusted: see Alarms"
        return Lamp("TEST", "T", Tone.TEST, strength, why, found)
    if part.told is VerdictCode.OK and masters_due:
        return Lamp("TEST", "T", Tone.TEST, strength, "masters are due: the PLC releases nothing", found)
    if part.told is VerdictCode.OK:
        return Lamp("OK", "✓", Tone.GOOD, strength, "21 of 21 segments")
    return Lamp("NOK", "✗", Tone.BAD, strength, reason)


def _fade(age_s: float) -> float:
    return 1.0 if age_s <= FRESH_S else max(0.25, 1.0 - (age_s - FRESH_S) / (GONE_S - FRESH_S))


def foot(part: PartEvent | None, now_s: float) -> str:
    """Return what stands below the lamp: which part it is of, and how old that is; `now_s`: monotonic time."""
    return (
        ""
        if part is None
        else f"{part.record.serial or part.record.inspection_id} · {_ago(now_s - part.at_s)}"
    )


def _ago(age_s: float) -> str:
    for unit, length_s in (("d", 86_400), ("h", 3600), ("min", 60)):
        if age_s >= 2 * length_s:
            return f"{age_s / length_s:.0f} {unit}"
    return f"{age_s:.0f} s"
