"""Borders of the bead and of the joint below it over the angle, numpy only. Lengths in mm."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from synth.part.part import Part
from synth.part.streams import Stream, stream
from synth.part.switches import Switch
from synth.surface.noise import harmonics

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Contour:
    """Centre line, borders and joint of a weld over the angle; arrays of shape (M,), mm."""

    center_mm: Array
    inner_mm: Array
    """Radius of the bead's inner border; equals `joint_inner_mm` where the weld is missing."""
    outer_mm: Array
    joint_inner_mm: Array
    joint_outer_mm: Array
    present: NDArray[np.bool_]
    """Where there is a bead."""


def contour(part: Part, theta_rad: Array) -> Contour:
    """Borders of the bead, random if so switched, and the wavy joint (paper, eq. 4)."""
    rng = stream(part.seed, Stream.CONTOUR)
    center_mm = part.radius_mm + part.bead_offset_mm + part.wobble_mm * 0.6 * harmonics(rng, theta_rad, 2, 9)
    rough = [part.wobble_mm * (0.5 * harmonics(rng, theta_rad, 2, 30) + 0.4 * harmonics(rng, theta_rad, 40, 400)) for _ in range(2)]
    if Switch.RANDOM_CONTOUR not in part.switches:
        center_mm, rough = np.full_like(theta_rad, part.radius_mm + part.bead_offset_mm), [np.zeros_like(theta_rad)] * 2
    joint_mm = part.radius_mm + part.joint_wave_mm * harmonics(rng, theta_rad, 2, 40)
    gap_mm = part.gap_mm * (1.0 + 0.15 * harmonics(rng, theta_rad, 2, 60).clip(-2, 2))
    cap = _caps(part, theta_rad)
    present = cap > 0
    half_mm = part.half_width_mm * (1.0 + part.overlap_width * overlap_weight(part, theta_rad))
    joint_inner_mm, joint_outer_mm = joint_mm - gap_mm / 2, joint_mm + gap_mm / 2
    inner_mm = np.where(present, np.minimum(center_mm - (half_mm + rough[0]) * cap, joint_inner_mm), joint_inner_mm)
    outer_mm = np.where(present, np.maximum(center_mm + (half_mm + rough[1]) * cap, joint_outer_mm), joint_outer_mm)
    return Contour(center_mm, inner_mm, outer_mm, joint_inner_mm, joint_outer_mm, present)


def from_start_mm(part: Part, theta_rad: Array) -> Array:
    """Distance along the weld from its end point, welding direction positive, (M,), -half to +half of the circumference."""
    e = (part.direction * (theta_rad - np.deg2rad(part.start_deg)) + np.pi) % (2 * np.pi) - np.pi
    return np.asarray(e * part.radius_mm)


def overlap_weight(part: Part, theta_rad: Array) -> Array:
    """0 to 1 where the weld ran twice: from its start to `overlap_mm` before its end point."""
    e_mm = from_start_mm(part, theta_rad)
    rise = 0.15
    start, end = -part.overlap_mm, 0.0
    weight = 1.0 / (1.0 + np.exp(-(e_mm - start) / (rise / 4))) * 1.0 / (1.0 + np.exp((e_mm - end) / (rise / 4)))
    return np.asarray(weight if part.overlap_mm > 0 else np.zeros_like(theta_rad))


def _caps(part: Part, theta_rad: Array) -> Array:
    """Width factor 0 to 1: rounded ends at each missing arc."""
    factor = np.ones_like(theta_rad)
    for arc in part.missing:
        if arc.end_deg - arc.start_deg >= 360:
            return np.zeros_like(theta_rad)
        middle = np.deg2rad((arc.start_deg + arc.end_deg) / 2)
        half = np.deg2rad((arc.end_deg - arc.start_deg) / 2)
        away_rad = np.abs((theta_rad - middle + np.pi) % (2 * np.pi) - np.pi) - half
        e = np.clip(away_rad * part.radius_mm / (0.7 * part.half_width_mm), 0.0, 1.0)
        factor = np.minimum(factor, np.sqrt(1.0 - (1.0 - e) ** 2))
    return factor
