"""Evaluation of a ring network: what the station's `locate` finds on labelled pictures."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

import numpy as np

from models.ring.pictures import Picture
from station.classify.onnx import RingNetwork
from station.errors import LocateError
from station.vision.locate import Expected, locate
from station.vision.reduced import FINDER_UM_PER_PX, Circle

LINE_UM_PER_PX = 13.0
"""Scale of the pixels in which errors are given."""
TOLERANCE_MM = Expected().tolerance_mm
OTHER_RADII_MM = tuple(float(value) for value in np.arange(2.0, 7.6, 0.3))
"""Radii at which no ring may be found on a picture that does not show one."""
APART_MM = 0.5
"""Distance of a radius from the true one from which a ring found with it is a false one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What `locate` found on one picture."""

    picture: Picture
    found: bool
    """Whether the ring was found."""
    center_error_px: float
    """Distance of the centre from the true one in px of 13 µm; NaN if it was not found."""
    radius_error_px: float
    """Difference of the radius in px of 13 µm; NaN if it was not found."""
    false_rings: int
    """Number of radii at which a ring was found that is not there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """What was found on several pictures."""

    pictures_with_ring: int
    found: int
    center_error_px_median: float | None
    center_error_px_worst: float | None
    radius_error_px_median: float | None
    radius_error_px_worst: float | None
    pictures_with_false_ring: int
    pictures: int


def evaluate_ring(
    pictures: Sequence[Picture], network: RingNetwork, advance: Callable[[], None] = lambda: None
) -> list[Outcome]:
    """Return what `locate` finds on each picture: the ring at its radius, and rings at all other radii."""
    outcomes = []
    for picture in pictures:
        outcomes.append(_judge(picture, network))
        advance()
    return outcomes


def summary(outcomes: Sequence[Outcome]) -> Summary:
    """Return the figures of several pictures."""
    found = [outcome for outcome in outcomes if outcome.found]
    center = [outcome.center_error_px for outcome in found]
    radius = [abs(outcome.radius_error_px) for outcome in found]
    return Summary(
        pictures_with_ring=sum(outcome.picture.circle is not None for outcome in outcomes),
        found=len(found),
        center_error_px_median=round(float(np.median(center)), 2) if found else None,
        center_error_px_worst=round(max(center), 2) if found else None,
        radius_error_px_median=round(float(np.median(radius)), 2) if found else None,
        radius_error_px_worst=round(max(radius), 2) if found else None,
        pictures_with_false_ring=sum(outcome.false_rings > 0 for outcome in outcomes),
        pictures=len(outcomes),
    )


def lines(outcomes: Sequence[Outcome]) -> list[str]:
    """Return a table: all pictures, then those of each weld family and of each sheet finish."""
    groups = {"all": list(outcomes)}
    for outcome in outcomes:
        groups.setdefault(f"weld {outcome.picture.weld or 'none'}", []).append(outcome)
    for outcome in outcomes:
        groups.setdefault(f"sheet {outcome.picture.sheet}", []).append(outcome)
    head = f"{'':18} {'found':>11}  centre px      radius px      false rings"
    return [head, *(_line(name, summary(group)) for name, group in sorted(groups.items()))]


def as_json(outcomes: Sequence[Outcome]) -> dict[str, int | float | None]:
    """Return the figures of several pictures as they are written into a card."""
    return asdict(summary(outcomes))


def _line(name: str, one: Summary) -> str:
    def pair(median: float | None, worst: float | None) -> str:
        return f"{'-':>13}" if median is None or worst is None else f"{median:5.2f} / {worst:5.2f}"

    center = pair(one.center_error_px_median, one.center_error_px_worst)
    radius = pair(one.radius_error_px_median, one.radius_error_px_worst)
    found = f"{one.found:5} / {one.pictures_with_ring:3}"
    return f"{name:18} {found}  {center}  {radius}  {one.pictures_with_false_ring} / {one.pictures}"


def _judge(picture: Picture, network: RingNetwork) -> Outcome:
    marks = network(picture.image)

    def circle_at(radius_mm: float) -> Circle | None:
        expected = Expected(radius_mm, TOLERANCE_MM)
        try:
            ring = locate(picture.image, expected, lambda _: marks, um_per_px=FINDER_UM_PER_PX).ring
        except LocateError as error:
            return Circle(0.0, 0.0, 0.0) if error.out_of_view else None
        return Circle(ring.center_x_px, ring.center_y_px, ring.radius_px)

    true = picture.circle
    true_mm = np.inf if true is None else true.radius * FINDER_UM_PER_PX / 1000
    others = [radius_mm for radius_mm in OTHER_RADII_MM if abs(radius_mm - true_mm) >= APART_MM]
    false_rings = sum(circle_at(radius_mm) is not None for radius_mm in others)
    found = None if true is None else circle_at(true_mm)
    px = FINDER_UM_PER_PX / LINE_UM_PER_PX
    apart = np.nan if found is None or true is None else np.hypot(found.x - true.x, found.y - true.y) * px
    return Outcome(
        picture=picture,
        found=found is not None,
        center_error_px=float(apart),
        radius_error_px=np.nan if found is None or true is None else (found.radius - true.radius) * px,
        false_rings=false_rings,
    )
