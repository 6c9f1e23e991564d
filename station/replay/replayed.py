"""Result of judging one recorded image again."""

from dataclasses import dataclass

from station.domain import Finding, SegmentQuality, Unseen, Verdict


@dataclass(frozen=True, slots=True)
class Circle:
    """Ring in pixels of the image."""

    center_x_px: float
    center_y_px: float
    radius_px: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Replayed:
    """Result for one recorded image, or the reason why it could not be judged."""

    name: str
    """Name of the image, unique in the replay."""
    verdict: Verdict
    reason: str | None
    """Reason of the verdict, or why the image was not inspected; None for OK."""
    circle: Circle | None = None
    """Ring of the weld; None if no ring was found."""
    scores: tuple[float | None, ...] = ()
    """Score of NOK of each of the 21 segments, None for one that was not seen and is not rejected; empty if
    there is no score at all."""
    findings: tuple[Finding, ...] = ()
    novelty: float | None = None
    detail: str | None = None
    """One line with the numbers behind the reason, and with the segments that were not seen."""
    unseen: tuple[Unseen | None, ...] = ()
    """Why each of the 21 segments was not seen, None for one that was; empty if none was looked at."""
    segment_quality: tuple[SegmentQuality, ...] = ()
    """Image quality of each of the 21 segments; empty if it was not measured."""
    inspection_ms: float | None = None
    """Duration of the inspection; None if the image could not be read or inspected."""
    warnings: tuple[str, ...] = ()
    """One line for each kind of loss in the image file, such as JPEG compression."""

    @property
    def problem(self) -> str | None:
        """Reason why the image could not be inspected; None if it was inspected."""
        return self.reason if self.inspection_ms is None else None

    @property
    def worst(self) -> float | None:
        """Highest score of NOK among the segments; None if none was judged."""
        return max((score for score in self.scores if score is not None), default=None)
