"""What the page Live says of the newest part, as text."""

from station.analysis.worst_segment import worst_segment
from station.channel.events import PartEvent
from station.domain import Inspection
from station.panel.look.words import translate


def caption(part: PartEvent) -> str:
    """Return number, serial and time of a part."""
    record = part.record
    return f"{record.inspection_id}  {record.serial}  {record.grabbed_at.astimezone():%H:%M:%S}"


def novelty(part: PartEvent) -> str:
    """Return how the image of a part compares with the training images."""
    if part.novel:
        return translate("live", "UNLIKE TRAINING")
    if part.drift is not None and part.drift.alarm:
        return translate("live", "DRIFTING")
    return translate("live", "known")


def worst(inspection: Inspection) -> str:
    """Return brightness and contrast of the worst segment: a dirty glass shows here first."""
    found = worst_segment(inspection)
    return "–" if found is None else f"{found.mean_dn:.0f} · {found.contrast:.2f}"


def cycle_ms(part: PartEvent) -> float:
    """Return the time from the grab to the published result of a part, in milliseconds."""
    timing = part.record.inspection.timing
    steps = (timing.grab_ms, timing.locate_ms, timing.unwrap_ms, timing.classify_ms)
    return sum(ms for ms in (*steps, part.record_ms, part.publish_ms) if ms is not None)
