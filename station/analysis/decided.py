"""Decides on the segments of a record again, with the limits in the record itself."""

from station.classify.decision import segment_kind
from station.defects import DefectKind
from station.records import Record


def defect_kinds(record: Record) -> list[DefectKind | None]:
    """Return the kind of defect in each segment, including defects that were tolerated, or None."""
    limits = record.provenance.thresholds
    return [
        segment_kind(scores, limits.of_segment(index))
        for index, scores in enumerate(record.inspection.scores)
    ]
