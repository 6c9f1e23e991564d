"""Small figures of a report as plain data, which the templates draw as SVG; pure."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, pi, sin

from station.domain import SEGMENT_DEG, SEGMENTS

GOOD, BAD, GREY, TEXT = "#2e8b57", "#c0392b", "#b8bcc2", "#23272d"


@dataclass(frozen=True, slots=True)
class Label:
    """A short text at a place in a figure."""

    x_px: float
    y_px: float
    text: str
    anchor: str = "middle"
    colour: str = TEXT


@dataclass(frozen=True, slots=True)
class Sector:
    """A part of a ring, as the path of its outline."""

    path: str
    colour: str


@dataclass(frozen=True, slots=True)
class ClockFace:
    """How often each of the 21 segments was NOK, by where they lie on the weld."""

    sectors: tuple[Sector, ...]
    labels: tuple[Label, ...]


@dataclass(frozen=True, slots=True)
class Bar:
    """One bar, from the left."""

    y_px: int
    length_px: float


@dataclass(frozen=True, slots=True)
class Bars:
    """Horizontal bars with their names and numbers."""

    height_px: int
    bars: tuple[Bar, ...]
    labels: tuple[Label, ...]
    colour: str = BAD


@dataclass(frozen=True, slots=True)
class Dot:
    """One value of a trend."""

    x_px: float
    y_px: float
    colour: str


@dataclass(frozen=True, slots=True)
class Trend:
    """One value for each part in their order, above an axis from 0 to `top`."""

    name: str
    top: str
    limit_y_px: float | None
    """Height of the dashed line; None: there is no limit."""
    dots: tuple[Dot, ...]
    colour: str = TEXT
    axis_colour: str = GREY


def clock_face(counts: Sequence[int]) -> ClockFace:
    """Lay out the counts of 21 segments as sectors: angle 0 at the right, clockwise as in the image."""
    most, sectors, labels = max([*counts, 1]), [], []
    for index, count in enumerate(counts):
        start, end = (pi / 180 * SEGMENT_DEG * (index + k) for k in (0.06, 0.94))
        inner, outer = 70.0, 70.0 + 60.0 * count / most
        middle = (start + end) / 2
        for low, high, colour in ((64.0, 69.0, GREY), (inner, outer, BAD)):
            if high > low:
                sectors.append(Sector(_sector(low, high, start, end), colour))
        labels.append(_at(50, middle, str(index + 1), TEXT))
        if count:
            labels.append(_at(outer + 11, middle, str(count), BAD))
    return ClockFace(tuple(sectors), tuple(labels))


def _at(radius_px: float, angle: float, text: str, colour: str) -> Label:
    return Label(150 + radius_px * cos(angle), 154 + radius_px * sin(angle), text, colour=colour)


def _sector(inner: float, outer: float, start: float, end: float) -> str:
    points = [(outer, start), (outer, end), (inner, end), (inner, start)]
    a, b, c, d = (f"{150 + r * cos(t):.1f} {150 + r * sin(t):.1f}" for r, t in points)
    return f"M{a}A{outer:.1f} {outer:.1f} 0 0 1 {b}L{c}A{inner:.1f} {inner:.1f} 0 0 0 {d}Z"


def bars(named: Sequence[tuple[str, int]]) -> Bars:
    """Lay out counts as horizontal bars, the longest first."""
    rows = sorted(named, key=lambda item: -item[1])
    most = max([count for _, count in rows] + [1])
    drawn, labels = [], []
    for i, (name, count) in enumerate(rows):
        y_px, length_px = 26 * i + 4, 300 * count / most
        drawn.append(Bar(y_px, length_px))
        labels.append(Label(150, y_px + 15, name, "end"))
        labels.append(Label(168 + length_px, y_px + 15, str(count), "start"))
    return Bars(26 * len(rows) + 6, tuple(drawn), tuple(labels))


def trend(
    values: Sequence[float | None], bad: Sequence[bool], name: str, limit: float | None = None
) -> Trend:
    """Lay out one value for each part in their order; `bad` parts are red, a limit is dashed."""
    known = [v for v in values if v is not None] + ([] if limit is None else [limit])
    top = max([*known, 1e-9]) * 1.08
    step = 460 / max(len(values) - 1, 1)
    dots = tuple(
        Dot(45 + step * i, 130 - 115 * value / top, BAD if red else GOOD)
        for i, (value, red) in enumerate(zip(values, bad, strict=True))
        if value is not None
    )
    return Trend(name, f"{top:.3g}", None if limit is None else 130 - 115 * limit / top, dots)


def angle_counts(nok: Sequence[Sequence[bool]]) -> list[int]:
    """How often each segment was NOK, of parts with 21 decisions each."""
    return [sum(part[i] for part in nok) for i in range(SEGMENTS)]
