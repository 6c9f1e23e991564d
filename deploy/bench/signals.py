"""Draws the edges of a bus log as lanes over time, in SVG; pure."""

from collections.abc import Sequence
from html import escape

from station.plc.bus_log import Edge

LANES = (
    ("PLC", "ENABLE"),
    ("PLC", "TRIGGER"),
    ("PLC", "RESULT_ACK"),
    ("station", "READY"),
    ("station", "TRIGGER_ACK"),
    ("station", "BUSY"),
    ("station", "EXPOSURE_DONE"),
    ("station", "RESULT_VALID"),
    ("station", "OK"),
)
"""Signals from top to bottom: who writes them, and their names."""
LEFT, LANE, HIGH, WIDTH = 190, 34, 18, 900
"""Left margin, height of a lane, height of a 1, and width of the drawing."""
MARGIN_MS = 30.0
"""Time shown before the first and after the last edge."""
GRID_MS = 50
STYLE = """<style>
.weldgate{font:14px system-ui,sans-serif}
.weldgate text{fill:var(--color-foreground-primary,#222)}
.weldgate .grid{stroke:#857b6b;stroke-opacity:.3}
.weldgate .plc{fill:none;stroke:#3577ad;stroke-width:2}
.weldgate .station{fill:none;stroke:#5d8a3a;stroke-width:2}
</style>"""
"""Style of the drawing, as that of the others in the documentation."""


def drawn(seen: Sequence[tuple[float, Edge]], lanes: Sequence[tuple[str, str]], title: str) -> str:
    """Return the drawing of edges with their times in seconds; raises ValueError if there are none."""
    wanted = [(time_s, edge) for time_s, edge in seen if (edge.by, edge.name) in lanes]
    if not wanted:
        raise ValueError("no edge to draw")
    begin_s = wanted[0][0]
    span_ms = (wanted[-1][0] - begin_s) * 1000 + 2 * MARGIN_MS
    scale = (WIDTH - LEFT - 10) / span_ms
    height = LANE * len(lanes) + 46
    parts = [
        f'<svg class="weldgate" xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" '
        f'style="min-width:620px;max-width:{WIDTH}px" role="img" aria-label="{escape(title)}">',
        f"<title>{escape(title)}</title>",
        STYLE,
    ]
    bottom = LANE * len(lanes) + 10
    for mark in range(0, int(span_ms - 2 * MARGIN_MS) + GRID_MS, GRID_MS):
        x = LEFT + (mark + MARGIN_MS) * scale
        parts.append(f'<line x1="{x:.1f}" y1="4" x2="{x:.1f}" y2="{bottom}" class="grid"/>')
        parts.append(f'<text x="{x:.1f}" y="{bottom + 16}" text-anchor="middle">{mark}</text>')
    parts.append(f'<text x="{WIDTH - 10}" y="{bottom + 32}" text-anchor="end">ms, {escape(title)}</text>')
    for index, lane in enumerate(lanes):
        own = [((time_s - begin_s) * 1000 + MARGIN_MS, edge) for time_s, edge in wanted if _of(edge) == lane]
        parts += _lane(lane, LANE * index + 8, own, scale)
    return "\n".join([*parts, "</svg>"]) + "\n"


def _of(edge: Edge) -> tuple[str, str]:
    return edge.by, edge.name


def _lane(lane: tuple[str, str], top: int, own: Sequence[tuple[float, Edge]], scale: float) -> list[str]:
    base = top + HIGH
    level = 1 - int(own[0][1].value) if own else int(lane[1] == "ENABLE")
    path = f"M {LEFT} {base - HIGH * level}"
    for at_ms, edge in own:
        path += f" H {LEFT + at_ms * scale:.1f} V {base - HIGH * int(edge.value)}"
    path += f" H {WIDTH - 10}"
    return [
        f'<text x="{LEFT - 10}" y="{base - 3}" text-anchor="end">{lane[0]}: {lane[1]}</text>',
        f'<path d="{path}" class="{lane[0].lower()}"/>',
    ]
