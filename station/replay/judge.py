"""Reads one image and judges it like the line."""

from collections.abc import Sequence

from station.domain import Inspection, Verdict
from station.errors import ImageError
from station.files.image import read_marked
from station.inspection.inspector import Inspector
from station.replay.files import Source
from station.replay.replayed import Circle, Replayed


def judge_image(inspector: Inspector, source: Source) -> Replayed:
    """Read an image and inspect it; a warning says if the weld does not fit into it."""
    try:
        image, warnings = read_marked(source.path)
    except ImageError as error:
        return _not_inspected(source, str(error))
    try:
        inspection = inspector.inspect(image)
    except Exception as error:  # noqa: BLE001 - one bad image must not stop the others
        text = str(error).splitlines()[0][:100] if str(error) else ""
        return _not_inspected(source, f"{source.path}: could not be judged ({type(error).__name__}: {text})")
    if inspection.ring is None and (problem := inspector.view_problem(image)):
        warnings = (*warnings, problem)
    return as_replayed(source.name, inspection, [f"{source.path}: {warning}" for warning in warnings])


def as_replayed(name: str, inspection: Inspection, warnings: Sequence[str] = ()) -> Replayed:
    """Return the result of inspecting an image."""
    timing = inspection.timing
    steps = (timing.locate_ms, timing.unwrap_ms, timing.classify_ms)
    return Replayed(
        name=name,
        verdict=inspection.verdict,
        reason=None if inspection.reason is None else str(inspection.reason),
        circle=_circle(inspection),
        scores=() if inspection.worst is None else inspection.nok_scores,
        findings=inspection.findings,
        novelty=inspection.novelty,
        detail=inspection.detail,
        unseen=inspection.unseen,
        segment_quality=inspection.segment_quality,
        inspection_ms=sum(ms for ms in steps if ms is not None),
        warnings=tuple(warnings),
    )


def _circle(inspection: Inspection) -> Circle | None:
    ring = inspection.ring
    return None if ring is None else Circle(ring.center_x_px, ring.center_y_px, ring.radius_px)


def _not_inspected(source: Source, why: str) -> Replayed:
    return Replayed(name=source.name, verdict=Verdict.ERROR, reason=why)
