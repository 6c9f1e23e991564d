"""Border lines of a part's bead and of the joint below it, numpy only. Lengths in mm."""

import numpy as np
from numpy.typing import NDArray

from synth.part.borders import Borders
from synth.part.part import Part
from synth.part.streams import Stream, stream
from synth.part.switches import Switch
from synth.surface.noise import harmonics

Array = NDArray[np.float64]


def contour(part: Part, theta_rad: Array) -> Borders:
    """Return the borders of the bead, random if so switched, and the wavy joint (paper, eq. 4)."""
    rng = stream(part.seed, Stream.CONTOUR)
    bead, joint = part.bead, part.joint
    center_mm = bead.radius_mm + bead.offset_mm + bead.wobble_mm * 0.6 * harmonics(rng, theta_rad, 2, 9)
    rough = [
        bead.wobble_mm * (0.5 * harmonics(rng, theta_rad, 2, 30) + 0.4 * harmonics(rng, theta_rad, 40, 400))
        for _ in range(2)
    ]
    if Switch.RANDOM_CONTOUR not in part.switches:
        center_mm = np.full_like(theta_rad, bead.radius_mm + bead.offset_mm)
        rough = [np.zeros_like(theta_rad)] * 2
    joint_mm = bead.radius_mm + joint.wave_mm * harmonics(rng, theta_rad, 2, 40)
    gap_mm = joint.gap_mm * (1.0 + 0.15 * harmonics(rng, theta_rad, 2, 60).clip(-2, 2))
    width = bead_width(part, theta_rad)
    present = width > 0
    half_mm = bead.half_width_mm * (1.0 + bead.overlap_width * overlap_weight(part, theta_rad))
    joint_inner_mm, joint_outer_mm = joint_mm - gap_mm / 2, joint_mm + gap_mm / 2
    inner_mm = np.minimum(center_mm - (half_mm + rough[0]) * width, joint_inner_mm)
    outer_mm = np.maximum(center_mm + (half_mm + rough[1]) * width, joint_outer_mm)
    return Borders(
        geometry=part.geometry,
        theta_rad=theta_rad,
        center_mm=center_mm,
        inner_mm=np.where(present, inner_mm, joint_inner_mm),
        outer_mm=np.where(present, outer_mm, joint_outer_mm),
        joint_inner_mm=joint_inner_mm,
        joint_outer_mm=joint_outer_mm,
        present=present,
    )


def bead_width(part: Part, theta_rad: Array) -> Array:
    """Return the factor 0 to 1 of the bead's width at some angles that the part's defects leave of it."""
    factor = np.ones_like(theta_rad)
    for defect in part.defects:
        left = defect.shape(theta_rad, part.bead)
        if left is not None:
            factor = np.minimum(factor, left)
    return factor


def from_end_mm(part: Part, theta_rad: Array) -> Array:
    """Return the distance (M,) from the weld's end in welding direction, -half to +half of the ring."""
    bead = part.bead
    away_rad = (bead.direction * (theta_rad - np.deg2rad(bead.start_deg)) + np.pi) % (2 * np.pi) - np.pi
    return np.asarray(away_rad * bead.radius_mm)


def overlap_weight(part: Part, theta_rad: Array) -> Array:
    """Return 0 to 1 (M,): 1 where the weld ran twice, from its start to its end `overlap_mm` further on."""
    if part.bead.overlap_mm <= 0:
        return np.zeros_like(theta_rad)
    at_mm = from_end_mm(part, theta_rad)
    rise_mm = 0.15
    start_mm, end_mm = -part.bead.overlap_mm, 0.0
    begun = 1.0 / (1.0 + np.exp(-(at_mm - start_mm) / (rise_mm / 4)))
    return np.asarray(begun / (1.0 + np.exp((at_mm - end_mm) / (rise_mm / 4))))
