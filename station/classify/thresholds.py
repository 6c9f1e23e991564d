"""Limits of the decision: score and length from which a defect rejects a segment."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from station.defects import DefectKind
from station.errors import SettingsError
from station.settings.model import LimitSettings


@dataclass(frozen=True, slots=True)
class Limit:
    """Threshold and minimum length of one kind of defect."""

    kind: DefectKind
    threshold: float
    """Score from which a segment is rejected."""
    min_mm: float = 0.0
    """Minimum length: shorter findings are reported but tolerated."""


@dataclass(frozen=True, slots=True)
class Thresholds:
    """Limits of all kinds of defect that the classifier knows, in the order of its classes."""

    kinds: tuple[Limit, ...]
    segments: tuple[tuple[int, float], ...] = ()
    """Segments that have their own threshold: number (1 to 21) and threshold, which applies to all kinds."""

    def of_segment(self, index: int) -> "Thresholds":
        """Return the limits that apply to the segment with this index, 0 to 20."""
        own = dict(self.segments).get(index + 1)
        return (
            self if own is None else Thresholds(tuple(replace(limit, threshold=own) for limit in self.kinds))
        )

    def of(self, kind: DefectKind) -> Limit:
        """Return the limits of one kind of defect. Raises KeyError if the classifier does not know it."""
        for limit in self.kinds:
            if limit.kind == kind:
                return limit
        raise KeyError(kind.name)

    @property
    def lowest(self) -> float:
        """Lowest threshold of all kinds."""
        return min(limit.threshold for limit in self.kinds)


def in_use(
    of_model: Thresholds, limits: Mapping[str, LimitSettings], segments: Mapping[int, float]
) -> Thresholds:
    """Return the limits of a model file, overridden by those of the settings.

    Raises SettingsError if the settings name a kind of defect that the model does not know.
    """
    unknown = sorted(set(limits) - {limit.kind.name for limit in of_model.kinds})
    if unknown:
        known = ", ".join(limit.kind.name for limit in of_model.kinds)
        raise SettingsError(
            f"model.limits.{unknown[0]}: the classifier does not know this kind of defect; it knows {known}"
        )
    kinds = []
    for limit in of_model.kinds:
        own = limits.get(limit.kind.name, LimitSettings())
        threshold = limit.threshold if own.threshold is None else own.threshold
        kinds.append(Limit(limit.kind, threshold, own.min_mm))
    return Thresholds(tuple(kinds), tuple(sorted(segments.items())))
