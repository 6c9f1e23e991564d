"""What was decided of each segment, by the limits that the record itself names."""

from station.classify.decision import refused_kinds, segment_kind
from station.domain import Reason
from station.records import Record


def defect_kinds(record: Record) -> list[Reason | None]:
    """Kind of defect seen in each segment, also where it was small enough to be tolerated."""
    limits = record.provenance.thresholds
    return [segment_kind(scores, limits.of(index)) for index, scores in enumerate(record.inspection.scores)]


def segment_kinds(record: Record) -> list[Reason | None]:
    """Kind of each of the 21 segments that is refused, None for the others; empty if none was judged."""
    return refused_kinds(record.inspection.scores, record.inspection.findings, record.provenance.thresholds)
