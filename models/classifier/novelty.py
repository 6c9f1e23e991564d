"""Appearance of the training images, so that the station notices when its own begin to differ."""

import numpy as np
from numpy.typing import NDArray
from sklearn.covariance import LedoitWolf

Array = NDArray[np.float64]

MIN_CROPS = 8
"""Number of crops from which a mean over them describes a part."""
KNOWN_FRACTION = 0.995
"""Fraction of the held-out parts whose distance is within the limit, before the margin."""
MARGIN = 1.1
"""Factor of the limit above that: a line's parts are alike, and an alarm for each of them is useless."""


def describe(features: Array) -> tuple[Array, Array]:
    """Return mean (D,) and whitening (D, D) of features (N, D).

    `(features - mean) @ whitening` has about unit covariance. The covariance is shrunk after Ledoit and Wolf
    (2004), so that features that hardly vary do not dominate the distance.
    """
    found = LedoitWolf().fit(features)
    values, vectors = np.linalg.eigh(found.covariance_)
    return np.asarray(found.location_), np.asarray(vectors / np.sqrt(np.maximum(values, 1e-9)) @ vectors.T)


def distances(features: Array, mean: Array, whitening: Array) -> Array:
    """Return the mean squared distance (N,) of features to those of the training crops; about 1 for these."""
    away = (features - mean) @ whitening
    return np.asarray((away * away).mean(axis=1))


def part_distances(crop_distances: Array, parts: NDArray[np.str_]) -> Array:
    """Return the root mean distance of each part with at least 8 crops; without such parts, of each crop."""
    names, at, counts = np.unique(parts, return_inverse=True, return_counts=True)
    mean = np.bincount(at, crop_distances, len(names)) / counts
    whole = counts >= MIN_CROPS
    return np.sqrt(mean[whole] if whole.any() else crop_distances)


def limit(held_out: Array) -> float:
    """Return the limit of a part's distance, from those of held-out parts."""
    return round(float(np.quantile(held_out, KNOWN_FRACTION)) * MARGIN, 3)
