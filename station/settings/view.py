"""Refuses recipes whose weld cannot be in view: the strip must fit into the images."""

from math import ceil

from station.domain import NETWORK_UM_PER_PX, STRIP_ROWS
from station.errors import SettingsError
from station.settings.model import Settings, WeldSettings, for_recipe


def view_problem(weld: WeldSettings, width_px: int, height_px: int) -> str | None:
    """Return why no weld of this size can be wholly in view in images of this size, or None if it can be."""
    reach_um = (weld.radius_mm + weld.radius_tolerance_mm) * 1000 + STRIP_ROWS / 2 * NETWORK_UM_PER_PX
    needed_px = ceil(2 * reach_um / weld.um_per_px) + 1
    if min(width_px, height_px) >= needed_px:
        return None
    return (
        f"images of {width_px} x {height_px} px are too small for a radius of {weld.radius_mm:g} + "
        f"{weld.radius_tolerance_mm:g} mm at {weld.um_per_px:g} µm/px, which needs {needed_px} x {needed_px} "
        "px; correct weld.radius_mm and weld.um_per_px, or enlarge camera.width_px and camera.height_px"
    )


def check_view(settings: Settings, size_px: tuple[int, int] | None) -> None:
    """Raise SettingsError if the weld of a recipe does not fit into images of this width and height.

    None, if the size is not yet known, is accepted.
    """
    if size_px is None:
        return
    for number in sorted({1, *settings.recipes}):
        problem = view_problem(for_recipe(settings, number).weld, *size_px)
        if problem is not None:
            raise SettingsError(f"recipe {number}: {problem}")
