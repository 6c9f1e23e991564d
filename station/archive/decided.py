"""What was decided of each segment, by the limits that the record itself names."""

from station.classify.decision import refused_kinds
from station.domain import Reason
from station.records import Record


def segment_kinds(record: Record) -> list[Reason | None]:
    """Kind of each of the 21 segments, None for OK; empty if none was judged."""
    return refused_kinds(record.inspection.scores, record.inspection.findings, record.provenance.thresholds)
