"""What the training images look like to the network's first layers, so that the station can tell when its own begin to differ."""

import numpy as np
from numpy.typing import NDArray
from sklearn.covariance import LedoitWolf

Array = NDArray[np.float64]

MIN_CROPS = 8
"""A ring with fewer crops says little of a whole part."""
KNOWN_SHARE = 0.995
"""Share of the held-out parts that lie within the limit."""
MARGIN = 1.1
"""The limit lies this factor above them: a line's parts are alike, and one alarm for each is of no use."""


def describe(statistics: Array) -> tuple[Array, Array]:
    """Mean (D,) and whitening (D, D) of statistics (N, D): `(statistics - mean) @ whitening` has about unit covariance.

    The covariance is shrunk after Ledoit and Wolf (2004), so that statistics that hardly vary do not rule the distance.
    """
    found = LedoitWolf().fit(statistics)
    values, vectors = np.linalg.eigh(found.covariance_)
    return np.asarray(found.location_), np.asarray(vectors / np.sqrt(np.maximum(values, 1e-9)) @ vectors.T)


def distances(statistics: Array, mean: Array, whitening: Array) -> Array:
    """Mean squared distance (N,) of statistics to those of the training crops; about 1 for these."""
    away = (statistics - mean) @ whitening
    return np.asarray((away * away).mean(axis=1))


def part_distances(crop_distances: Array, parts: NDArray[np.str_]) -> Array:
    """Root of the mean over each part's crops, of parts with at least 8 crops; of single crops if there is no such part."""
    names, at, counts = np.unique(parts, return_inverse=True, return_counts=True)
    mean = np.bincount(at, crop_distances, len(names)) / counts
    whole = counts >= MIN_CROPS
    return np.sqrt(mean[whole] if whole.any() else crop_distances)


def limit(held_out: Array) -> float:
    """Limit of a part's distance, from those of held-out parts."""
    return round(float(np.quantile(held_out, KNOWN_SHARE)) * MARGIN, 3)
