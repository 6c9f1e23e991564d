"""Random fields and curves, periodic, from a given generator; numpy only.

No library is used for Perlin noise: the available ones draw from numpy's global state, and a part must grow
from its seed alone.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def harmonics(rng: np.random.Generator, theta_rad: Array, low: int, high: int) -> Array:
    """Return a sum of sine waves of normal amplitude and random phase (paper, eq. 4).

    Its standard deviation over a turn is 1. Harmonics start at `low`: from 2 on, the best circle through the
    curve stays where it is.
    """
    k = np.arange(low, high + 1)[:, None]
    amplitude = rng.normal(size=k.shape) / np.sqrt(k)
    phase = rng.uniform(0, 2 * np.pi, size=k.shape)
    wave = (amplitude * np.sin(k * theta_rad + phase)).sum(axis=0)
    return np.asarray(wave / max(float(np.sqrt((amplitude**2).sum() / 2)), 1e-9))


def gaussian(rng: np.random.Generator, shape: tuple[int, int], cells: tuple[float, float]) -> Array:
    """Return band-limited Gaussian noise, periodic along both axes, of standard deviation 1.

    `cells` is its grain in grid cells.
    """
    f0 = np.fft.fftfreq(shape[0])[:, None] * cells[0]
    f1 = np.fft.rfftfreq(shape[1])[None, :] * cells[1]
    spectrum = np.fft.rfft2(rng.normal(size=shape)) * np.exp(-2.0 * (f0**2 + f1**2))
    field = np.fft.irfft2(spectrum, s=shape)
    return np.asarray(field / max(float(field.std()), 1e-9))


def perlin(rng: np.random.Generator, shape: tuple[int, int], nodes: tuple[int, int]) -> Array:
    """Return Perlin gradient noise, periodic along both axes, about -1 to 1.

    There are `nodes` gradients along each axis.     Source: K. Perlin, "Improving noise", SIGGRAPH 2002
    (quintic fade).
    """
    angle = rng.uniform(0, 2 * np.pi, nodes)
    gradient = np.stack([np.cos(angle), np.sin(angle)])
    at = [np.arange(shape[axis]) * nodes[axis] / shape[axis] for axis in (0, 1)]
    low = [np.floor(a).astype(int) for a in at]
    frac = [a - b for a, b in zip(at, low, strict=True)]
    fade = [f**3 * (f * (f * 6 - 15) + 10) for f in frac]
    total = np.zeros(shape)
    for i in (0, 1):
        for j in (0, 1):
            rows, columns = (low[0] + i) % nodes[0], (low[1] + j) % nodes[1]
            weight = (fade[0] if i else 1 - fade[0])[:, None] * (fade[1] if j else 1 - fade[1])[None, :]
            slope = gradient[:, rows[:, None], columns[None, :]]
            total += weight * (slope[0] * (frac[0] - i)[:, None] + slope[1] * (frac[1] - j)[None, :])
    return np.asarray(np.sqrt(2.0) * total)
