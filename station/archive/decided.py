"""What was decided of each segment, by the limits that the record itself names."""

from station.classify.decision import Thresholds, segment_kind
from station.domain import Reason
from station.records import Record


def segment_kinds(record: Record) -> list[Reason | None]:
    """Kind of each of the 21 segments, None for OK; empty if none was judged."""
    limits = Thresholds(record.provenance.hole_threshold, record.provenance.missing_threshold)
    return [segment_kind(scores, limits) for scores in record.inspection.scores]
