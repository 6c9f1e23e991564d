"""Lays out a graph without circles in layers, arrows pointing down, and writes it as SVG. Pure."""

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from html import escape

BOX_W, BOX_H = 138, 34
GAP_X, GAP_Y = 20, 46
BEND_W = 14
"""Width kept free where an arrow passes a layer."""
SWEEPS = 24
SMALLEST_W = 620
"""A larger drawing is not made smaller than this: on a phone it is moved aside instead."""

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Box:
    """One node as it is drawn."""

    name: str
    label: str
    family: str
    """Class of the box: decides its colour."""
    about: str
    """Shown when the pointer rests on it."""


def levels_of(below: Mapping[str, Sequence[str]]) -> dict[str, int]:
    """Return the level of each node: 0 for those with nothing below, else one more than the highest below."""
    found: dict[str, int] = {}

    def level(name: str) -> int:
        if name not in found:
            found[name] = 1 + max((level(to) for to in below[name]), default=-1)
        return found[name]

    for name in sorted(below):
        level(name)
    return found


def draw(
    boxes: Sequence[Box], main: Sequence[tuple[str, str]], implied: Sequence[tuple[str, str]], title: str
) -> str:
    """Return the SVG of a graph. `implied` arrows are shown for the box on which the pointer rests."""
    below: dict[str, list[str]] = {box.name: [] for box in boxes}
    for of, to in [*main, *implied]:
        below[of].append(to)
    levels = levels_of(below)
    rows, chains = _rows(levels, main)
    rows = _ordered(rows, chains)
    xs = _placed(rows, chains)
    left = min(x - _width(name) / 2 for name, x in xs.items())
    right = max(x + _width(name) / 2 for name, x in xs.items())
    top = max(levels.values())

    def centre(name: str) -> Point:
        row = next(number for number, names in rows.items() if name in names)
        return xs[name] - left + 8, (top - row) * (BOX_H + GAP_Y) + BOX_H / 2 + 8

    width, height = right - left + 16, top * (BOX_H + GAP_Y) + BOX_H + 16
    lines = [_arrow([centre(name) for name in chain]) for chain in chains]
    drawn = [_box(box, centre, [to for of, to in [*main, *implied] if of == box.name]) for box in boxes]
    return "\n".join(
        [
            f'<svg class="rooms" xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}"'
            f' role="img" style="min-width:{min(width, SMALLEST_W):.0f}px;max-width:{width:.0f}px"'
            f' aria-label="{escape(title)}">',
            f"<title>{escape(title)}</title>",
            STYLE,
            '<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4"'
            ' markerWidth="7" markerHeight="7" orient="auto">'
            '<path d="M0 0L8 4L0 8z" class="tip"/></marker></defs>',
            *lines,
            *drawn,
            "</svg>",
        ]
    )


STYLE = """<style>
.rooms{width:100%;height:auto;font:14px system-ui,sans-serif}
.rooms .line{fill:none;stroke:var(--color-foreground-muted,#888);stroke-width:1.3;marker-end:url(#tip)}
.rooms .tip{fill:var(--color-foreground-muted,#888)}
.rooms rect{stroke-width:1.3;rx:6px}
.rooms text{fill:#14202b;text-anchor:middle;dominant-baseline:central}
.rooms .own rect{fill:#d7e8f7;stroke:#3577ad}
.rooms .other rect{fill:#e4e1ee;stroke:#6d5ba3}
.rooms .ground rect{fill:#e6ecd9;stroke:#6a8738}
.rooms .all{opacity:0;pointer-events:none}
.rooms .all .line{stroke:#d1622b;stroke-width:2}
.rooms g:hover>.all,.rooms g:focus>.all{opacity:1}
.rooms g:hover>rect,.rooms g:focus>rect{stroke:#d1622b;stroke-width:2.5}
</style>"""


def _width(name: str) -> int:
    return BEND_W if name.startswith("~") else BOX_W


def _rows(
    levels: Mapping[str, int], arrows: Sequence[tuple[str, str]]
) -> tuple[dict[int, list[str]], list[list[str]]]:
    """Return the nodes of each level with the bends of long arrows, and each arrow's chain of points."""
    rows: dict[int, list[str]] = {level: [] for level in range(max(levels.values()) + 1)}
    for name in sorted(levels):
        rows[levels[name]].append(name)
    chains: list[list[str]] = []
    for of, to in arrows:
        bends = [f"~{of}>{to}@{level}" for level in range(levels[of] - 1, levels[to], -1)]
        for bend in bends:
            rows[int(bend.rsplit("@", 1)[1])].append(bend)
        chains.append([of, *bends, to])
    return rows, chains


def _neighbours(chains: Sequence[Sequence[str]]) -> tuple[dict[str, list[str]], dict[str, list[str]]]:
    up: dict[str, list[str]] = {}
    down: dict[str, list[str]] = {}
    for chain in chains:
        for high, low in itertools.pairwise(chain):
            down.setdefault(high, []).append(low)
            up.setdefault(low, []).append(high)
    return up, down


def _crossings(rows: Mapping[int, Sequence[str]], down: Mapping[str, Sequence[str]]) -> int:
    count = 0
    for level in range(1, len(rows)):
        place = {name: index for index, name in enumerate(rows[level - 1])}
        ends = [(index, place[to]) for index, name in enumerate(rows[level]) for to in down.get(name, [])]
        count += sum(one[0] < other[0] and one[1] > other[1] for one in ends for other in ends)
    return count


def _ordered(rows: dict[int, list[str]], chains: Sequence[Sequence[str]]) -> dict[int, list[str]]:
    """Return each level in an order that lets few arrows cross: by the mean place of the neighbours."""
    up, down = _neighbours(chains)
    best, fewest = rows, _crossings(rows, down)
    for sweep in range(SWEEPS):
        near, way = (down, 1) if sweep % 2 == 0 else (up, -1)
        rows = {level: list(names) for level, names in rows.items()}
        for level in sorted(rows)[::way][1:]:
            place = {name: index for index, name in enumerate(rows[level - way])}
            own = {name: index for index, name in enumerate(rows[level])}
            means = {name: _mean([place[to] for to in near.get(name, [])], own[name]) for name in rows[level]}
            rows[level].sort(key=means.__getitem__)
        if (crossed := _crossings(rows, down)) < fewest:
            best, fewest = rows, crossed
    return best


def _mean(values: Sequence[float], otherwise: float) -> float:
    return sum(values) / len(values) if values else otherwise


def _placed(rows: Mapping[int, Sequence[str]], chains: Sequence[Sequence[str]]) -> dict[str, float]:
    """Return the centre of each node: near the mean of its neighbours, without overlap."""
    up, down = _neighbours(chains)
    xs: dict[str, float] = {}
    for names in rows.values():
        xs.update(_apart(names, dict.fromkeys(names, 0.0)))
    for sweep in range(SWEEPS):
        levels = sorted(rows, reverse=sweep % 2 == 1)
        for level in levels:
            wished = {
                name: _mean([xs[to] for to in (*up.get(name, []), *down.get(name, []))], xs[name])
                for name in rows[level]
            }
            xs.update(_apart(rows[level], wished))
    return xs


def _apart(names: Sequence[str], wished: Mapping[str, float]) -> dict[str, float]:
    """Return the places nearest to the wished ones (least squares) that keep order and distances."""
    offsets, at = [], 0.0
    for index, name in enumerate(names):
        if index:
            at += (_width(names[index - 1]) + _width(name)) / 2 + GAP_X
        offsets.append(at)
    blocks: list[tuple[float, int]] = []
    for name, offset in zip(names, offsets, strict=True):
        mean, count = wished[name] - offset, 1
        while blocks and blocks[-1][0] > mean:
            before, more = blocks.pop()
            mean, count = (mean * count + before * more) / (count + more), count + more
        blocks.append((mean, count))
    starts = [mean for mean, count in blocks for _ in range(count)]
    return {name: start + offset for name, start, offset in zip(names, starts, offsets, strict=True)}


def _arrow(points: Sequence[Point]) -> str:
    """Return a smooth line from the lower edge of the first box to the upper edge of the last."""
    first, last = points[0], points[-1]
    ways = [(first[0], first[1] + BOX_H / 2), *points[1:-1], (last[0], last[1] - BOX_H / 2)]
    path = f"M{ways[0][0]:.1f} {ways[0][1]:.1f}"
    for (x, y), (to_x, to_y) in itertools.pairwise(ways):
        middle = (y + to_y) / 2
        path += f"C{x:.1f} {middle:.1f} {to_x:.1f} {middle:.1f} {to_x:.1f} {to_y:.1f}"
    return f'<path class="line" d="{path}"/>'


def _box(box: Box, centre: Callable[[str], Point], all_below: Sequence[str]) -> str:
    x, y = centre(box.name)
    arrows = "".join(_arrow([(x, y), centre(to)]) for to in all_below)
    return (
        f'<g class="{box.family}" tabindex="0"><title>{escape(box.about)}</title><g class="all">{arrows}</g>'
        f'<rect x="{x - BOX_W / 2:.1f}" y="{y - BOX_H / 2:.1f}" width="{BOX_W}" height="{BOX_H}" rx="6"/>'
        f'<text x="{x:.1f}" y="{y:.1f}">{escape(box.label)}</text></g>'
    )
