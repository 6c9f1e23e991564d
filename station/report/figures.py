"""Small figures as SVG text; pure."""

from collections.abc import Sequence
from math import cos, pi, sin

from station.domain import SEGMENT_DEG, SEGMENTS

GOOD, BAD, GREY, TEXT = "#2e8b57", "#c0392b", "#b8bcc2", "#23272d"


def clock_face(counts: Sequence[int]) -> str:
    """NOK segments by where they lie on the weld: 21 sectors, angle 0 at the right, clockwise as in the picture."""
    most, parts = max([*counts, 1]), []
    for index, count in enumerate(counts):
        start, end = (pi / 180 * SEGMENT_DEG * (index + k) for k in (0.06, 0.94))
        inner, outer = 70.0, 70.0 + 60.0 * count / most
        middle = (start + end) / 2
        colour = BAD if count else GREY
        for low, high, fill in ((64.0, 69.0, GREY), (inner, outer, colour)):
            if high > low:
                parts.append(f'<path d="{_sector(low, high, start, end)}" fill="{fill}"/>')
        x, y = 150 + 50 * cos(middle), 150 + 50 * sin(middle)
        parts.append(f'<text x="{x:.1f}" y="{y + 4:.1f}" text-anchor="middle" font-size="11" fill="{TEXT}">{index + 1}</text>')
        if count:
            x, y = 150 + (outer + 11) * cos(middle), 150 + (outer + 11) * sin(middle)
            parts.append(f'<text x="{x:.1f}" y="{y + 4:.1f}" text-anchor="middle" font-size="11" fill="{BAD}">{count}</text>')
    return f'<svg viewBox="0 0 300 300" width="300" role="img" aria-label="NOK segments by angle">{"".join(parts)}</svg>'


def _sector(inner: float, outer: float, start: float, end: float) -> str:
    points = [(outer, start), (outer, end), (inner, end), (inner, start)]
    a, b, c, d = (f"{150 + r * cos(t):.1f} {150 + r * sin(t):.1f}" for r, t in points)
    return f"M{a}A{outer:.1f} {outer:.1f} 0 0 1 {b}L{c}A{inner:.1f} {inner:.1f} 0 0 0 {d}Z"


def bars(named: Sequence[tuple[str, int]]) -> str:
    """Horizontal bars with their numbers, the longest first."""
    rows = sorted(named, key=lambda item: -item[1])
    most, height = max([count for _, count in rows] + [1]), 26 * len(rows) + 6
    parts = []
    for i, (name, count) in enumerate(rows):
        y = 26 * i + 4
        parts.append(f'<text x="150" y="{y + 15}" text-anchor="end" font-size="13" fill="{TEXT}">{name}</text>')
        parts.append(f'<rect x="160" y="{y}" width="{300 * count / most:.1f}" height="20" fill="{BAD}"/>')
        parts.append(f'<text x="{168 + 300 * count / most:.1f}" y="{y + 15}" font-size="13" fill="{TEXT}">{count}</text>')
    return f'<svg viewBox="0 0 520 {height}" width="520" role="img" aria-label="counts">{"".join(parts)}</svg>'


def trend(values: Sequence[float | None], bad: Sequence[bool], name: str, limit: float | None = None) -> str:
    """One value a part in order; `bad` parts are red, a limit is dashed."""
    known = [v for v in values if v is not None] + ([] if limit is None else [limit])
    top = max([*known, 1e-9]) * 1.08
    step = 460 / max(len(values) - 1, 1)
    dots = []
    for i, (value, red) in enumerate(zip(values, bad, strict=True)):
        if value is not None:
            dots.append(f'<circle cx="{45 + step * i:.1f}" cy="{130 - 115 * value / top:.1f}" r="2" fill="{BAD if red else GOOD}"/>')
    line = ""
    if limit is not None:
        y = 130 - 115 * limit / top
        line = f'<line x1="45" x2="505" y1="{y:.1f}" y2="{y:.1f}" stroke="{TEXT}" stroke-dasharray="5 4"/>'
    axis = f'<path d="M45 15V130H505" fill="none" stroke="{GREY}"/><text x="40" y="22" text-anchor="end" font-size="11">{top:.3g}</text>'
    title = f'<text x="45" y="11" font-size="12" font-weight="600" fill="{TEXT}">{name}</text>'
    zero = '<text x="40" y="132" text-anchor="end" font-size="11">0</text>'
    return f'<svg viewBox="0 0 520 140" width="520" role="img" aria-label="{name}">{title}{axis}{zero}{line}{"".join(dots)}</svg>'


def angle_counts(nok: Sequence[Sequence[bool]]) -> list[int]:
    """How often each segment was NOK, of parts with 21 decisions each."""
    return [sum(part[i] for part in nok) for i in range(SEGMENTS)]
