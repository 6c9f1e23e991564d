"""Limits of the decision."""

from dataclasses import dataclass

from station.domain import Reason


@dataclass(frozen=True, slots=True)
class Thresholds:
    """A segment is NOK from these probabilities on; findings shorter than their kind's least length are told, and tolerated."""

    hole: float
    missing_weld: float
    segments: tuple[tuple[int, float], ...] = ()
    """Number, 1 to 21, and probability of either defect, of segments with a limit of their own."""
    hole_min_mm: float = 0.0
    missing_min_mm: float = 0.0

    def of(self, index: int) -> "Thresholds":
        """As they are for one segment, 0 to 20."""
        own = dict(self.segments).get(index + 1)
        return self if own is None else Thresholds(own, own)

    def least_mm(self, kind: Reason) -> float:
        """Of a kind."""
        return self.hole_min_mm if kind is Reason.HOLE else self.missing_min_mm
