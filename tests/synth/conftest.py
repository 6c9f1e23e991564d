from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from synth.measured.measurement import SHIPPED, Measurement, read_measurement
from synth.measured.spectrum import WeldModel, derive


@pytest.fixture(scope="session")
def measurement() -> Measurement:
    """The shipped measurement."""
    return read_measurement(SHIPPED)


@pytest.fixture(scope="session")
def model(measurement: Measurement) -> WeldModel:
    """What is derived from it."""
    return derive(measurement)


@pytest.fixture
def planted() -> NDArray[np.float64]:
    """A map (600, 900) in um, 5 um step: a band of ripples bent by a Gaussian, a crown, and calm partners."""
    rng = np.random.default_rng(2)
    y_mm, x_mm = (np.arange(600) - 300) * 0.005, np.arange(900) * 0.005
    bead = np.abs(y_mm) < 0.5
    shift = 0.2 * np.exp(-0.5 * (y_mm / 0.25) ** 2)
    crown = 40 * np.exp(-0.5 * (y_mm / 0.3) ** 2)
    ripple = 4 * np.sin(2 * np.pi * (x_mm[None, :] - shift[:, None]) / 0.15) * bead[:, None]
    return np.asarray(crown[:, None] + ripple + 0.05 * rng.normal(size=(600, 900)))


@pytest.fixture
def planted_file(planted: NDArray[np.float64], tmp_path: Path) -> Path:
    path = tmp_path / "planted.npy"
    np.save(path, planted)
    return path
