"""What was decided of each segment, by the limits that the record itself names."""

from station.classify.decision import segment_kind
from station.defects import DefectKind
from station.records import Record


def defect_kinds(record: Record) -> list[DefectKind | None]:
    """Return the kind of defect seen in each segment, also where it was small enough to be tolerated."""
    limits = record.provenance.thresholds
    return [
        segment_kind(scores, limits.of_segment(index))
        for index, scores in enumerate(record.inspection.scores)
    ]
