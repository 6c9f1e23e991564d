"""Figures of a report as plain data, which the templates draw as SVG; pure."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, pi, sin

from station.domain import SEGMENT_DEG, SEGMENTS

GOOD, BAD, GREY, TEXT = "#2e8b57", "#c0392b", "#b8bcc2", "#23272d"
"""Colours of the figures."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Label:
    """Short text at a position in a figure."""

    x_px: float
    y_px: float
    text: str
    anchor: str = "middle"
    colour: str = TEXT


@dataclass(frozen=True, slots=True)
class Sector:
    """Sector of a ring, as the SVG path of its outline."""

    path: str
    colour: str


@dataclass(frozen=True, slots=True)
class ClockFace:
    """Number of rejections of each of the 21 segments, arranged by their position on the weld."""

    sectors: tuple[Sector, ...]
    labels: tuple[Label, ...]


@dataclass(frozen=True, slots=True)
class Bar:
    """One horizontal bar."""

    y_px: int
    length_px: float


@dataclass(frozen=True, slots=True)
class Bars:
    """Horizontal bars with their names and counts."""

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


@dataclass(frozen=True, slots=True, kw_only=True)
class Trend:
    """One value per part in order, above an axis from 0 to `top`."""

    name: str
    top: str
    """Label of the upper end of the axis."""
    limit_y_px: float | None
    """Height of the dashed line of the limit; None if there is no limit."""
    dots: tuple[Dot, ...]
    colour: str = TEXT
    axis_colour: str = GREY


def clock_face(counts: Sequence[int]) -> ClockFace:
    """Lay out the counts of 21 segments as sectors: angle 0 on the right, clockwise as in the image."""
    most, sectors, labels = max([*counts, 1]), [], []
    for index, count in enumerate(counts):
        start, end = (pi / 180 * SEGMENT_DEG * (index + margin) for margin in (0.06, 0.94))
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
    x_px, y_px = 150 + radius_px * cos(angle), 154 + radius_px * sin(angle)
    return Label(x_px=x_px, y_px=y_px, text=text, colour=colour)


def _sector(inner: float, outer: float, start: float, end: float) -> str:
    corners = [(outer, start), (outer, end), (inner, end), (inner, start)]
    first, second, third, fourth = (
        f"{150 + radius * cos(angle):.1f} {150 + radius * sin(angle):.1f}" for radius, angle in corners
    )
    arcs = (f"A{outer:.1f} {outer:.1f} 0 0 1 {second}", f"A{inner:.1f} {inner:.1f} 0 0 0 {fourth}")
    return f"M{first}{arcs[0]}L{third}{arcs[1]}Z"


def bars(named: Sequence[tuple[str, int]]) -> Bars:
    """Lay out counts as horizontal bars, longest first."""
    rows = sorted(named, key=lambda item: -item[1])
    most = max([count for _, count in rows] + [1])
    drawn, labels = [], []
    for i, (name, count) in enumerate(rows):
        y_px, length_px = 26 * i + 4, 300 * count / most
        drawn.append(Bar(y_px, length_px))
        labels.append(Label(x_px=150, y_px=y_px + 15, text=name, anchor="end"))
        labels.append(Label(x_px=168 + length_px, y_px=y_px + 15, text=str(count), anchor="start"))
    return Bars(26 * len(rows) + 6, tuple(drawn), tuple(labels))


def trend(
    values: Sequence[float | None], bad: Sequence[bool], name: str, limit: float | None = None
) -> Trend:
    """Lay out one value per part in order; `bad` parts are red, a limit is a dashed line."""
    known = [value for value in values if value is not None] + ([] if limit is None else [limit])
    top = max([*known, 1e-9]) * 1.08
    step = 460 / max(len(values) - 1, 1)
    dots = tuple(
        Dot(45 + step * i, 130 - 115 * value / top, BAD if red else GOOD)
        for i, (value, red) in enumerate(zip(values, bad, strict=True))
        if value is not None
    )
    limit_y_px = None if limit is None else 130 - 115 * limit / top
    return Trend(name=name, top=f"{top:.3g}", limit_y_px=limit_y_px, dots=dots)


def angle_counts(nok: Sequence[Sequence[bool]]) -> list[int]:
    """Return the number of rejections of each segment, for parts with 21 decisions each."""
    return [sum(part[i] for part in nok) for i in range(SEGMENTS)]
