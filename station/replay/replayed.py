"""The result of judging one recorded image again."""

from dataclasses import dataclass

from station.domain import Finding, Verdict


@dataclass(frozen=True, slots=True)
class Circle:
    """The ring in pixels of the image as it was read, whatever scale it was judged at."""

    center_x_px: float
    center_y_px: float
    radius_px: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Replayed:
    """One recorded image as it is judged now, or the reason why it could not be."""

    name: str
    """Name of the image among all images of the replay."""
    verdict: Verdict
    reason: str | None
    """Reason of the verdict, or why the image was not inspected; None for OK."""
    circle: Circle | None = None
    """None: no ring was found."""
    scores: tuple[float, ...] = ()
    """Probability of NOK of each of the 21 segments; empty if none was judged."""
    findings: tuple[Finding, ...] = ()
    novelty: float | None = None
    inspection_ms: float | None = None
    """None: the image could not be read or inspected."""
    warnings: tuple[str, ...] = ()
    """What reading the image lost, a line each."""

    @property
    def problem(self) -> str | None:
        """Why the image could not be inspected; None if it was."""
        return self.reason if self.inspection_ms is None else None

    @property
    def worst(self) -> float | None:
        """Highest score among the segments; None if none was judged."""
        return max(self.scores, default=None)
