"""Ranges that a generator recipe holds, their bounds, and how values are drawn from them."""

from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator, ConfigDict

Range = tuple[float, float]
Count = tuple[int, int]

NO_OTHER_KEYS = ConfigDict(extra="forbid")
"""Pydantic configuration of a group of ranges: an unknown key in a recipe file is refused."""


def within(low: float, high: float) -> AfterValidator:
    """Return a validator of a number or a range that must lie between `low` and `high`."""

    def check(value: Any) -> Any:
        ends = value if isinstance(value, tuple) else (value, value)
        if not (low <= ends[0] <= ends[1] <= high):
            shown = list(ends) if isinstance(value, tuple) else value
            raise ValueError(f"{shown} is not allowed; {low:g} to {high:g}, the smaller first")
        return value

    return AfterValidator(check)


Fraction = Annotated[float, within(0, 1)]
Fractions = Annotated[Range, within(0, 1)]
Few = Annotated[Count, within(0, 200)]
Weight = Annotated[float, within(0, 1000)]


def uniform(rng: np.random.Generator, bounds: Range) -> float:
    """Draw a number evenly between two bounds."""
    return float(rng.uniform(*bounds))


def log_uniform(rng: np.random.Generator, bounds: Range) -> float:
    """Draw a number whose logarithm is even between the bounds' logarithms."""
    return float(np.exp(rng.uniform(*np.log(bounds))))


def count(rng: np.random.Generator, bounds: Count) -> int:
    """Draw a whole number, both bounds included."""
    return int(rng.integers(bounds[0], bounds[1] + 1))


def either_way(rng: np.random.Generator, limit: float) -> float:
    """Draw a number evenly between -limit and limit."""
    return float(rng.uniform(-1, 1)) * limit
