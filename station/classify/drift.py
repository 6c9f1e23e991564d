"""Detects drift: the appearance of the parts moves away from the line's own good parts.

The method is a moving average of the appearance features (multivariate EWMA: Lowry et al., Technometrics 34,
1992), which treats the features as independent.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter, ValidationError

from station.errors import ModelError
from station.files.durable import write_whole

Array = NDArray[np.float64]

WEIGHT = 0.1
"""Weight of the newest part; each older part has 0.9 times the weight of the next, so about 20 parts
count."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """Appearance of the good parts of one line, as seen by one classifier."""

    model_hash: str
    """SHA-256 of the classifier's file; the appearance depends on the classifier."""
    parts: int
    """Number of parts from which the reference was made."""
    mean: tuple[float, ...]
    spread: tuple[float, ...]
    """Standard deviation from part to part."""
    limit: float
    """Drift above which an alarm is raised."""


@dataclass(frozen=True, slots=True)
class Drift:
    """Distance of the last parts from the reference: 0 without drift, above `limit` an alarm is raised."""

    value: float
    limit: float

    @property
    def alarm(self) -> bool:
        """True if the images have changed."""
        return self.value > self.limit


class DriftWatch:
    """Moving average of the appearance, updated with each part."""

    def __init__(self, reference: Reference) -> None:
        self._limit = reference.limit
        self._mean, self._spread = np.array(reference.mean), np.array(reference.spread)
        self._average: Array = np.zeros(len(self._mean))

    def part(self, appearance: Array) -> Drift:
        """Add the appearance (D,) of a part and return the drift.

        The drift is the mean square of the averaged deviation from the reference, in units of the spread.
        """
        self._average = (1 - WEIGHT) * self._average + WEIGHT * (appearance - self._mean) / self._spread
        return Drift(float((self._average**2).mean()), self._limit)


_ADAPTER = TypeAdapter(Reference)


def write_reference(path: Path, reference: Reference) -> None:
    """Write a reference atomically. Raises OSError."""
    write_whole(path, _ADAPTER.dump_json(reference) + b"\n")


def read_reference(path: Path, model_hash: str, size: int) -> Reference:
    """Return the reference in a file, made with this classifier and with appearances of this size.

    Raises ModelError.
    """
    action = "make a new one with weldgate-models first-day --reference"
    try:
        reference = _ADAPTER.validate_json(path.read_bytes(), strict=True)
    except OSError as error:
        raise ModelError(f"{path}: reference cannot be read ({error.strerror}); {action}") from None
    except ValidationError:
        raise ModelError(f"{path}: not a reference of good parts; {action}") from None
    if reference.model_hash != model_hash:
        raise ModelError(f"{path}: made with a different classifier from the one in use; {action}")
    sound = len(reference.mean) == len(reference.spread) == size and np.isfinite(reference.mean).all()
    if not (sound and 0 < reference.limit < np.inf and all(0 < own < np.inf for own in reference.spread)):
        raise ModelError(f"{path}: the numbers are damaged; {action}")
    return reference
