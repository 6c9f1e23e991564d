"""Covers the defects of labelled parts in twelve ways; exit status 1 if one of the parts is then called OK.

The same covers beside the weld of good parts must not change their verdict.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from deploy.chaos.covers import COVERS, Area, Image
from models.data.lot import LabelledFrame, frames, read_labels
from models.errors import LearningError
from station.domain import SEGMENT_DEG, Inspection, Ring, Verdict
from station.errors import WeldgateError
from station.inspection.inspector import Inspector
from station.inspection.loading import load_inspector
from station.numbers import whole_option
from station.settings.file import load
from station.settings.model import for_images

NETWORKS = Path(__file__).parents[2] / "models" / "shipped"
HALF_PX = 75.0
"""Half the width of what is covered: the strip and a little more."""
BESIDE_PX = 190.0
"""Distance from the weld at which good parts are covered."""
BESIDE_HALF_PX = 45.0
"""Half the width of what is covered there."""
BESIDE_DEG = 30.0
"""Length of what is covered there."""
MARGIN_DEG = 2.0
"""How far a cover reaches beyond what it hides."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run and print the table. Return 0 if no covered defect was called OK, 1 if one was, 2 on bad input."""
    parser = argparse.ArgumentParser(
        prog="python -m deploy.chaos.covered", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("lots", type=Path, nargs="+", metavar="LOT", help="labelled frames at 13 um/px")
    parser.add_argument("-c", "--settings", type=Path, metavar="FILE", help="judge with these settings")
    parser.add_argument("--seed", type=whole_option, default=0)
    own = parser.parse_args(arguments)
    try:
        settings = for_images(NETWORKS) if own.settings is None else load(own.settings)
        inspector, _ = load_inspector(settings)
        parts = [part for lot in own.lots for part in frames(lot, read_labels(lot))]
    except (LearningError, WeldgateError) as error:
        print(f"covered: {error}", file=sys.stderr)
        return 2
    found: dict[str, Counter[str]] = {name: Counter() for name in COVERS}
    for number, (label, image) in enumerate(track(parts, disable=not sys.stderr.isatty())):
        for name, verdict in judged_under_covers(inspector, label, image, seed=own.seed + number):
            found[name][f"{label.verdict} {verdict}"] += 1
    _print(found)
    return 1 if any(counts["NOK OK"] for counts in found.values()) else 0


def judged_under_covers(
    inspector: Inspector, label: LabelledFrame, image: Image, *, seed: int
) -> Iterator[tuple[str, Verdict]]:
    """Yield each cover and the verdict on the part under it, for a part that is judged rightly without one.

    On a bad part the covers lie over its defects, on a good part beside the weld.
    """
    plain = inspector.inspect(image)
    if plain.ring is None or str(plain.verdict) != label.verdict:
        return
    rng = np.random.default_rng(seed)
    areas = list(_defects(plain.ring, plain) if label.verdict == "NOK" else _beside(plain.ring, rng))
    height, width = image.shape
    weight = np.maximum.reduce([area.weight((height, width)) for area in areas])
    for name, cover in COVERS.items():
        if label.verdict == "OK" and name == "half light":
            continue  # it cannot be kept away from the weld
        yield name, inspector.inspect(cover(rng, image, weight)).verdict


def _defects(ring: Ring, plain: Inspection) -> Iterator[Area]:
    """Yield what hides the rejected segments and the findings, with a little of their neighbours."""
    arcs = [(number * SEGMENT_DEG, (number + 1) * SEGMENT_DEG) for number, bad in enumerate(plain.nok) if bad]
    arcs += [(finding.start_deg, finding.end_deg) for finding in plain.findings]
    for start, end in arcs:
        yield _area(
            ring, start - MARGIN_DEG, end + MARGIN_DEG, radius_px=ring.radius_px, half_width_px=HALF_PX
        )


def _beside(ring: Ring, rng: np.random.Generator) -> Iterator[Area]:
    """Yield a place inside the ring."""
    start = float(rng.uniform(0, 360))
    radius = ring.radius_px - BESIDE_PX
    yield _area(ring, start, start + BESIDE_DEG, radius_px=radius, half_width_px=BESIDE_HALF_PX)


def _area(ring: Ring, start_deg: float, end_deg: float, *, radius_px: float, half_width_px: float) -> Area:
    return Area(
        center_x_px=ring.center_x_px,
        center_y_px=ring.center_y_px,
        radius_px=radius_px,
        start_deg=start_deg,
        end_deg=end_deg,
        half_width_px=half_width_px,
    )


def _print(found: dict[str, Counter[str]]) -> None:
    table = Table("cover", "bad parts", "NOK", "ERROR", "OK (!)", "good parts", "still OK", "ERROR", "NOK")
    rows = {**found, "all": sum(found.values(), Counter())}
    for name, counts in rows.items():
        bad = [counts[f"NOK {verdict}"] for verdict in (Verdict.NOK, Verdict.ERROR, Verdict.OK)]
        good = [counts[f"OK {verdict}"] for verdict in (Verdict.OK, Verdict.ERROR, Verdict.NOK)]
        table.add_row(name, *(str(count) for count in (sum(bad), *bad, sum(good), *good)))
    Console().print(table)


if __name__ == "__main__":
    sys.exit(main())
