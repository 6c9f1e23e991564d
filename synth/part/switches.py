"""The paper's eight switches (section 3.4), each on or off on its own: 256 combinations."""

from collections.abc import Iterable
from enum import StrEnum

from synth.errors import SynthError


class Switch(StrEnum):
    """Feature of a rendered weld; the four geometric ones first."""

    TOPOGRAPHY = "topography"
    """Ripples of the weld (eqs. 1 and 2); off: a flat bead."""
    REDUCED_EDGES = "reduced-edges"
    """Gaussian reduction of the height towards the bead's edges."""
    RANDOM_CONTOUR = "random-contour"
    """Irregular border between bead and partners; off: straight."""
    PERLIN = "perlin"
    """Perlin noise on the bead: the discontinuities that the spectrum lacks."""
    PARTNER_STRIPES = "partner-stripes"
    """Vertical stripes on the weld partners."""
    SOOT_ON_WELD = "soot-on-weld"
    """Dark patches on the bead."""
    SOOT_AT_EDGES = "soot-at-edges"
    """A less reflective BSDF blended in along the bead's edges."""
    MODELLED_ILLUMINATION = "modelled-illumination"
    """33 spots with Gaussian falloff; off: a Lambertian area emitter of the same shape."""


ALL = frozenset(Switch)
"""All switches on."""


def without(names: Iterable[str]) -> frozenset[Switch]:
    """Return all switches except the named ones. Raises SynthError naming an unknown one."""
    off = set()
    for name in names:
        try:
            off.add(Switch(name))
        except ValueError:
            raise SynthError(f"--off {name}: no such switch; known: {', '.join(Switch)}") from None
    return ALL - off
