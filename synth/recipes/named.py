"""The named generator recipes; the ranges of each kind of defect are in its module in `synth.defects`."""

from dataclasses import replace

from synth.defects.kinds import ranges_of
from synth.part.bead import BeadRanges
from synth.part.dirt import DirtRanges
from synth.part.joint import JointRanges
from synth.part.light import LightRanges
from synth.part.pose import PoseRanges
from synth.part.recipe import Recipe
from synth.part.relief import ReliefRanges
from synth.part.sensor import SensorRanges
from synth.part.surface import SurfaceRanges

LINE = Recipe(ok_weight=0.4, defects=ranges_of("line"))
"""A production line."""

DENSE = replace(LINE, ok_weight=0.25, defects=ranges_of("dense"))
"""The line's surfaces with many defects per part: more defective crops for each rendering."""

WIDE = Recipe(
    ok_weight=0.25,
    bead=BeadRanges(
        half_width_mm=(0.30, 0.58),
        offset_mm=(-0.12, 0.12),
        crown_mm=(0.005, 0.08),
        wobble_mm=(0.0, 0.04),
        undercut_mm=(0.0, 0.04),
        overlap_mm=(0.3, 6.0),
        overlap_width=(-0.05, 0.15),
        overlap_height_mm=(0.0, 0.04),
        crater_mm=(0.005, 0.10),
    ),
    joint=JointRanges(step_mm=0.22, gap_mm=(0.05, 0.22)),
    relief=ReliefRanges(
        height_scale=(0.3, 3.0),
        shift_scale=(0.0, 3.0),
        ripple_pitch_mm=(0.08, 0.38),
        ripple_slope=(0.015, 0.36),
        sparsity=(0.0, 0.95),
        chevron=(0.0, 1.0),
        rough_slope=(0.01, 0.11),
    ),
    surface=SurfaceRanges(
        bead_reflectance=(0.55, 0.95),
        partner_reflectance=(0.50, 0.90),
        alpha_weld=(0.10, 0.28),
        alpha_partner=(0.12, 0.30),
        floor_reflectance=(0.01, 0.08),
        floor_texture=(0.0, 1.0),
    ),
    dirt=DirtRanges(
        soot=(0.0, 1.0),
        soot_softness=(0.0, 1.0),
        heat_tint=(0.0, 0.8),
        spatter=(0, 60),
        bead_scratches=(0, 4),
        fibres=(0, 3),
    ),
    light=LightRanges(scale=(0.7, 1.3), lean=(0.0, 0.9), second_fraction=0.4),
    sensor=SensorRanges(veil=(0.0, 0.08), exposure=(0.5, 2.2), defocus_px=(0.3, 1.9)),
    defects=ranges_of("wide"),
)
"""As dense, with wider surfaces and lights, so that a network does not depend on the images of one line."""

PAPER = Recipe(
    ok_weight=0.5,
    pose=PoseRanges(shift_mm=0.0, tilt_deg=0.0),
    bead=BeadRanges(
        offset_mm=(0.0, 0.0),
        undercut_mm=(0.0, 0.0),
        overlap_mm=(0.0, 0.0),
        overlap_width=(0.0, 0.0),
        overlap_height_mm=(0.0, 0.0),
        crater_mm=(0.0, 0.0),
    ),
    joint=JointRanges(step_mm=0.0),
    relief=ReliefRanges(spectral_fraction=1.0, height_scale=(1.0, 1.0), shift_scale=(1.0, 1.0)),
    surface=SurfaceRanges(bead_reflectance=(0.86, 0.86), partner_reflectance=(0.72, 0.72), circles=False),
    dirt=DirtRanges(
        heat_tint=(0.0, 0.0),
        spatter=(0, 0),
        bead_scratches=(0, 0),
        scratches=(0, 0),
        dust=(0, 0),
        fibres=(0, 0),
    ),
    light=LightRanges(lean=(0.0, 0.0)),
    sensor=SensorRanges(veil=(0.0, 0.0), exposure=(0.9, 1.1)),
    defects=ranges_of("paper"),
)
"""The paper's protocol: what varies there and nothing else."""

RECIPES = {"line": LINE, "dense": DENSE, "wide": WIDE, "paper": PAPER}
"""Generator recipes by name."""
