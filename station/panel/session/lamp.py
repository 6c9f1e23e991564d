"""What the verdict lamp shows, and for how long; pure. Green fades: no old OK stays on the screen."""

from dataclasses import dataclass
from enum import StrEnum

from station.channel.events import STATUS_LOST_S, PartEvent, StatusEvent
from station.domain import Origin, Purpose, Verdict
from station.panel.look.purposes import PURPOSE_WORDS
from station.plc.map.alarms import TEXTS, Alarm
from station.plc.map.registers import Offline, VerdictCode

FRESH_S = 3.0
"""Age up to which a verdict is shown at full strength."""
GONE_S = 10.0
"""Age from which a verdict is no longer shown."""
IN_SERVICE = "is working on the station"
"""Says what the person is doing whose name follows."""
LATE = "result came too late for the PLC"
"""Why the PLC reads ERROR for a part that was judged."""


class Tone(StrEnum):
    """Name of a colour of the theme."""

    GOOD = "good"
    BAD = "bad"
    WARN = "warn"
    TEST = "test"
    QUIET = "quiet"


WHY_OFFLINE = {
    Offline.STARTING: "the station is starting",
    Offline.NOT_ENABLED: "the PLC has not enabled the station",
    Offline.SET_OFFLINE: "the PLC has set the station offline",
    Offline.ARCHIVE_FULL: "records cannot be written",
    Offline.STATION_STALLED: "the inspection has stopped",
    Offline.PREPARING: "a recipe is being loaded",
    Offline.SELF_TEST_FAILED: "self-test failed",
    Offline.SERVICE: IN_SERVICE,
    Offline.ATTENDED: "an image is being taken or settings are being loaded on request of a window",
}
"""Why the station is offline, for reasons that have no word of their own on the lamp."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Lamp:
    """Word, symbol and colour of the lamp."""

    word: str
    symbol: str
    tone: Tone
    strength: float = 1.0
    """1: fresh, 0: faded."""
    detail: str = ""
    """Text below the word; the window translates it."""
    more: str = ""
    """Text after `detail` that is not translated."""


OFFLINE = Lamp(word="OFFLINE", symbol="○", tone=Tone.QUIET, detail="no connection to the engine")
"""The lamp while the engine sends nothing."""


def lamp(status: StatusEvent | None, part: PartEvent | None, now_s: float) -> Lamp:
    """Return the state of the lamp from the newest status and part; `now_s` is monotonic time.

    Green means a fresh OK of this run of the engine that the PLC reads and accepts, while nothing keeps the
    station offline.
    """
    if status is None or now_s - status.at_s > STATUS_LOST_S:
        return OFFLINE
    if status.service:
        return Lamp(word="SERVICE", symbol="⚙", tone=Tone.TEST, detail=IN_SERVICE, more=status.service)
    age_s = 1e9 if part is None or part.at_s < status.started_s else now_s - part.at_s
    offline = status.line.offline
    blocked = offline is not Offline.NONE
    if part is not None and age_s <= GONE_S and not (part.reported is VerdictCode.OK and blocked):
        return _of_part(part, Alarm.MASTERS_DUE in status.alarms, _fade(age_s))
    if offline is Offline.PLC_SILENT:
        cause = TEXTS[Alarm.PLC_SILENT].cause
        return Lamp(word="PLC LOST", symbol="⚠", tone=Tone.WARN, detail=cause)
    if offline is Offline.CAMERA_LOST:
        cause = TEXTS[Alarm.CAMERA_LOST].cause
        return Lamp(word="OFFLINE", symbol="○", tone=Tone.WARN, detail=cause, more=status.camera_message)
    if offline is not Offline.NONE:
        return Lamp(word="OFFLINE", symbol="○", tone=Tone.QUIET, detail=WHY_OFFLINE[offline])
    return Lamp(word="NO VERDICT", symbol="–", tone=Tone.QUIET, detail="waiting for a part")


def _of_part(part: PartEvent, masters_due: bool, strength: float) -> Lamp:
    """Return the lamp for a part that is not too old."""
    record, verdict = part.record, str(part.record.verdict)
    reason = str(record.inspection.reason or "")
    if record.purpose is not Purpose.PART:
        return _test(strength, detail=PURPOSE_WORDS[record.purpose], more=verdict)
    if part.reported is VerdictCode.ERROR and record.verdict is not Verdict.ERROR:
        reason = LATE
    if part.reported is VerdictCode.ERROR:
        numbers = (record.inspection.detail or "") if record.verdict is Verdict.ERROR else ""
        more = numbers.removeprefix(f"{reason}: ")
        return Lamp(word="ERROR", symbol="!", tone=Tone.WARN, strength=strength, detail=reason, more=more)
    if part.reported is VerdictCode.TEST and record.origin is Origin.REPLAY:
        return _test(strength, detail="replay", more=verdict)
    if part.reported is VerdictCode.TEST:
        return _test(strength, detail="verdict cannot be trusted: see page Alarms", more=verdict)
    if part.reported is VerdictCode.OK and masters_due:
        return _test(strength, detail="master check is due: the PLC releases no parts", more=verdict)
    if part.reported is VerdictCode.OK:
        return Lamp(word="OK", symbol="✓", tone=Tone.GOOD, strength=strength, detail="21 of 21 segments")
    return Lamp(word="NOK", symbol="✗", tone=Tone.BAD, strength=strength, detail=reason)


def _test(strength: float, *, detail: str, more: str) -> Lamp:
    return Lamp(word="TEST", symbol="T", tone=Tone.TEST, strength=strength, detail=detail, more=more)


def _fade(age_s: float) -> float:
    return 1.0 if age_s <= FRESH_S else max(0.25, 1.0 - (age_s - FRESH_S) / (GONE_S - FRESH_S))


def foot(part: PartEvent | None, now_s: float) -> str:
    """Return the line below the lamp: serial or number of the part, and its age; `now_s` is monotonic."""
    if part is None:
        return ""
    return f"{part.record.serial or part.record.inspection_id} · {_ago(now_s - part.at_s)}"


def _ago(age_s: float) -> str:
    for unit, length_s in (("d", 86_400), ("h", 3600), ("min", 60)):
        if age_s >= 2 * length_s:
            return f"{age_s / length_s:.0f} {unit}"
    return f"{age_s:.0f} s"
