"""Random streams by name: each thing that is drawn has its own, so that a new one changes none of the others.

Within one stream the order of the draws matters: a new draw of a group comes last.
"""

from enum import IntEnum, unique
from zlib import crc32

import numpy as np


@unique
class Stream(IntEnum):
    """What a random stream is for. Numbers never change: they are part of what a seed means."""

    LOT = 0
    """Order of the kinds of defect in a lot."""
    CONTOUR = 2
    """Border lines of bead and joint."""
    SPECTRUM = 3
    """Phases and amplitudes of the relief from the measured spectrum."""
    PLATE_TEXTURE = 5
    BEAD_TEXTURE = 6
    SENSOR_NOISE = 7
    UNDERCUT = 9
    BEAD_SCRATCHES = 10
    PERLIN = 11
    """Perlin noise on the bead."""
    SPATTER = 12
    FIBRES = 13
    RING_ERROR = 14
    """Error of the ring that a dataset's crops are cut with."""
    FLOOR_TEXTURE = 15
    RIPPLES = 16
    """Ripples that are drawn directly."""
    ARTIFICIAL_MEASUREMENT = 20
    FIGURE = 21
    """Example surface in the figure of a measurement."""
    PIECE_PLAN = 30
    """Order of the kinds of defect in a dataset of straight pieces."""
    PIECE_SEAM = 31
    """Place of the weld's ends on a straight piece."""
    RING_PLAN = 32
    """Which segments of a ring a dataset uses."""
    POSE = 40
    BEAD = 41
    JOINT = 42
    RELIEF = 43
    SURFACE = 44
    DIRT = 45
    LIGHT = 46
    SENSOR = 47
    DEFECTS = 48
    """Defects; each kind has its own stream by its name."""
    HEIGHTFIELD = 60
    """Everything on a picture of the second renderer."""


def stream(seed: int, name: Stream, *more: int | str) -> np.random.Generator:
    """Return the generator of one stream of a seed; `more` splits it into streams of their own."""
    keys = [crc32(key.encode()) if isinstance(key, str) else key for key in more]
    return np.random.default_rng([seed, name, *keys])
