"""A 3D surface measurement of one OK weld, read, levelled and laid straight.

The only file that imports SurfaceTopography. It reads x3p, opd, sur and the other formats of
SurfaceTopography, and npy (heights in um) with a stated step. Source: paper, section 3.3 (white-light
interferometer, 6 x 6 mm, 3 um).
"""

import hashlib
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from synth.errors import SynthError

Array = NDArray[np.float64]

SHIPPED = Path(__file__).parents[1] / "shipped" / "weld.x3p"
"""An artificial measurement, in place of a real one: see its metadata and `synth.measured.artificial`."""
STEP_UM = (0.1, 50.0)
"""Steps that are accepted."""
SIZE_MM = (0.5, 50.0)
"""Sides of a map that are accepted."""
RANGE_UM = (0.05, 5000.0)
"""Height ranges that are accepted."""
MIN_VALID = 0.3
"""Smallest accepted fraction of points with a height."""


@dataclass(frozen=True, slots=True, eq=False)
class Measurement:
    """Heights of a weld that runs along the columns.

    height_um (rows, columns) float64, rows = y across the weld, columns = x along it, levelled, lost points
    filled; `lost` is the fraction of points without a height in the file, `turned_deg` the angle by which the
    map was turned.
    """

    height_um: Array
    step_um: float
    lost: float
    turned_deg: float
    sha256: str


def read_measurement(path: Path, step_um: float | None = None) -> Measurement:
    """Read, level, fill and turn a measurement. `step_um` is needed for npy, and refused for other files.

    Raises SynthError naming the wrong value and what is allowed.
    """
    raw_um, step = _read(path, step_um)
    valid = np.isfinite(raw_um)
    fraction = float(valid.mean()) if raw_um.size else 0.0
    if fraction < MIN_VALID:
        raise SynthError(
            f"{path}: {fraction:.0%} of the points carry a height; at least {MIN_VALID:.0%} are needed"
        )
    if not STEP_UM[0] <= step <= STEP_UM[1]:
        raise SynthError(f"{path}: the step is {step:g} um; {STEP_UM[0]:g} to {STEP_UM[1]:g} um is allowed")
    size_mm = np.array(raw_um.shape) * step / 1000
    if size_mm.min() < SIZE_MM[0] or size_mm.max() > SIZE_MM[1]:
        size = f"{size_mm[1]:.3g} x {size_mm[0]:.3g} mm"
        raise SynthError(f"{path}: the map is {size}; {SIZE_MM[0]:g} to {SIZE_MM[1]:g} mm a side is allowed")
    height_um = _fill(_level(raw_um, valid), valid)
    span = float(np.ptp(np.percentile(height_um[valid], [1, 99])))
    if not RANGE_UM[0] <= span <= RANGE_UM[1]:
        allowed = f"{RANGE_UM[0]:g} to {RANGE_UM[1]:g} um is allowed"
        raise SynthError(f"{path}: heights span {span:.3g} um; {allowed} (is the unit right?)")
    angle = weld_direction_deg(height_um)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    return Measurement(_turn(height_um, angle), step, 1.0 - fraction, angle, digest)


def _read(path: Path, step_um: float | None) -> tuple[Array, float]:
    if not path.is_file():
        raise SynthError(f"{path}: no such file")
    if path.stat().st_size == 0:
        raise SynthError(f"{path}: the file is empty")
    if path.suffix.lower() == ".npy":
        if step_um is None:
            raise SynthError(f"{path}: an npy file holds no step; state it with --step-um")
        try:
            heights = np.load(path, allow_pickle=False)
        except (ValueError, EOFError, OSError) as error:
            raise SynthError(f"{path}: not a readable npy file: {error}") from None
        if heights.ndim != 2 or heights.dtype.kind not in "fiu":
            held = f"{heights.dtype} of shape {heights.shape}"
            raise SynthError(f"{path}: holds {held}; a map of numbers (rows, columns) is needed")
        return np.asarray(heights, np.float64), step_um
    if step_um is not None:
        raise SynthError(f"{path}: the file states its own step; leave out --step-um")
    return _read_with_library(path)


def _read_with_library(path: Path) -> tuple[Array, float]:
    from SurfaceTopography import read_topography

    try:
        topography = read_topography(str(path)).to_unit("um")
        heights = np.ma.filled(np.ma.asarray(topography.heights(), np.float64), np.nan).T
        step_x, step_y = (float(v) for v in topography.pixel_size)
    except Exception as error:  # noqa: BLE001 - its readers raise whatever the file's bytes provoke
        reason = (str(error).strip() or type(error).__name__).splitlines()[0]
        raise SynthError(f"{path}: not a readable surface measurement: {reason}") from None
    if abs(step_x / step_y - 1) > 0.01:
        rows = round(heights.shape[0] * step_y / step_x)
        heights = np.asarray(
            cv2.resize(heights, (heights.shape[1], rows), interpolation=cv2.INTER_LINEAR), np.float64
        )
    return heights, float(step_x)


def _level(height_um: Array, valid: NDArray[np.bool_]) -> Array:
    """Subtract the best plane, fitted a second time without the points far from it."""
    y, x = (np.asarray(axis, np.float64) for axis in np.indices(height_um.shape))
    keep = valid
    residual: Array = height_um
    for _ in range(2):
        terms = np.stack([np.ones(int(keep.sum())), x[keep], y[keep]], axis=1)
        a, b, c = np.linalg.lstsq(terms, height_um[keep], rcond=None)[0]
        residual = height_um - (a + b * x + c * y)
        spread = float(np.median(np.abs(residual[valid]))) * 4.45 + 1e-12
        keep = valid & (np.abs(np.where(valid, residual, np.inf)) <= spread)
    return residual


def _fill(height_um: Array, valid: NDArray[np.bool_]) -> Array:
    """Fill lost points from their neighbours: the mean over the narrowest window that holds a height."""
    filled = np.where(valid, height_um, 0.0)
    known = valid.astype(np.float64)
    result, missing = filled.copy(), ~valid
    size = 3
    while missing.any():
        weight = cv2.blur(known, (size, size), borderType=cv2.BORDER_CONSTANT)
        mean = cv2.blur(filled, (size, size), borderType=cv2.BORDER_CONSTANT) / np.maximum(weight, 1e-9)
        found = missing & (weight > 1e-6)
        result[found] = mean[found]
        missing &= ~found
        size = size * 2 + 1
    return result


def weld_direction_deg(height_um: Array) -> float:
    """Return the angle from the columns' axis to the weld, -90 to 90 degrees, towards growing rows.

    The weld is a band: smoothed along its own direction, the map's local roughness varies most across it.
    """
    rows = max(32, round(256 * height_um.shape[0] / height_um.shape[1]))
    small = cv2.resize(height_um, (256, rows), interpolation=cv2.INTER_AREA)
    rough = np.abs(small - cv2.GaussianBlur(small, (0, 0), 6))
    rough = np.minimum(rough, np.percentile(rough, 98))
    side = min(small.shape)
    best, best_angle = -1.0, 0.0
    for angle in np.arange(-90.0, 90.0, 1.0):
        turned = _turn(rough, angle)
        top, left = (turned.shape[0] - side // 2) // 2, (turned.shape[1] - side // 2) // 2
        contrast = float(turned[top : top + side // 2, left : left + side // 2].mean(axis=1).var())
        if contrast > best * 1.001:
            best, best_angle = contrast, float(angle)
    return best_angle


def _turn(height_um: Array, angle_deg: float) -> Array:
    """Turn the map so that what runs at `angle_deg` runs along x; keep a square without empty corners."""
    if abs(angle_deg) < 0.75:
        return height_um
    rows, columns = height_um.shape
    if abs(abs(angle_deg) - 90) < 0.75:
        return np.ascontiguousarray(np.rot90(height_um))
    a = np.deg2rad(angle_deg)
    scale = min(rows, columns) / (abs(np.cos(a)) + abs(np.sin(a)))
    side = int(scale)
    matrix = cv2.getRotationMatrix2D(((columns - 1) / 2, (rows - 1) / 2), angle_deg, 1.0)
    matrix[:, 2] += (side - columns) / 2, (side - rows) / 2
    turned = cv2.warpAffine(
        height_um, matrix, (side, side), flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT
    )
    return np.asarray(turned)
