"""Defects with plain values for tests."""

from typing import Any

from synth.defects.hole import Hole, Rim


def hole(angle_deg: float, **values: Any) -> Hole:
    """Return a hole in the middle of the bead, an ellipse unless stated otherwise."""
    usual: dict[str, Any] = {
        "offset_mm": 0.0,
        "length_mm": 1.0,
        "width_mm": 0.3,
        "deformation": 0.0,
        "a": 3,
        "b": 2,
    }
    return Hole(
        angle_deg=angle_deg, rim=Rim(sink_mm=0.03, width_mm=0.04, crest_mm=0.0), **{**usual, **values}
    )
