"""Whether a line's pictures drift away from those of its own good parts, before a single part looks strange.

A moving average of the look of the parts (multivariate EWMA: Lowry et al., Technometrics 34, 1992; components taken as independent).
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
"""Of the newest part; the part before it has 0.9 times as much, and so on: about the last twenty parts count."""


@dataclass(frozen=True, slots=True)
class Reference:
    """How the good parts of one line look to one classifier."""

    model_hash: str
    """SHA-256 of the classifier's file: another one sees another look."""
    parts: int
    mean: tuple[float, ...]
    spread: tuple[float, ...]
    """Standard deviation from part to part."""
    limit: float
    """Drift from which the line is reported."""


@dataclass(frozen=True, slots=True)
class Drift:
    """How far the last parts are from the reference: 0 is as it, above `limit` is reported."""

    value: float
    limit: float

    @property
    def alarm(self) -> bool:
        """Whether the pictures have changed."""
        return self.value > self.limit


class DriftWatch:
    """The moving average, part after part."""

    def __init__(self, reference: Reference) -> None:
        self._limit = reference.limit
        self._mean, self._spread = np.array(reference.mean), np.array(reference.spread)
        self._average: Array = np.zeros(len(self._mean))

    def part(self, look: Array) -> Drift:
        """Drift with this part's look (D,) counted: mean square of the average deviation, in units of the spread."""
        self._average = (1 - WEIGHT) * self._average + WEIGHT * (look - self._mean) / self._spread
        return Drift(float((self._average**2).mean()), self._limit)


_ADAPTER = TypeAdapter(Reference)


def write_reference(path: Path, reference: Reference) -> None:
    """The whole file, or nothing. Raises OSError."""
    write_whole(path, _ADAPTER.dump_json(reference) + b"\n")


def read_reference(path: Path, model_hash: str, size: int) -> Reference:
    """A line's reference, for the classifier in use and its looks (size,). Raises ModelError."""
    again = "make it with weldgate-models first-day --reference"
    try:
        reference = _ADAPTER.validate_json(path.read_bytes())
    except OSError as error:
        raise ModelError(f"{path}: reference cannot be read ({error.strerror}); {again}") from None
    except ValidationError:
        raise ModelError(f"{path}: not a reference of good parts; {again}") from None
    if reference.model_hash != model_hash:
        raise ModelError(f"{path}: made with another classifier than the one in use; {again}")
    sound = len(reference.mean) == len(reference.spread) == size and np.isfinite(reference.mean).all()
    if not (sound and 0 < reference.limit < np.inf and all(0 < s < np.inf for s in reference.spread)):
        raise ModelError(f"{path}: numbers are damaged; {again}")
    return reference
