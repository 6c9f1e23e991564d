"""Equations (1) and (2), the row shift and the edges, against planted values."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from synth.errors import SynthError
from synth.measured.measurement import Measurement, read_measurement
from synth.measured.spectrum import (
    THRESHOLD,
    VARIATION,
    Gaussian,
    WeldModel,
    derive,
    fit_edge,
    kept_amplitude,
    resample,
    row_shift,
    shift_rows,
    synthesize,
)


@given(st.integers(0, 10**6), st.integers(5, 24), st.integers(5, 24))
def test_a_new_surface_keeps_the_amplitudes_within_the_variation(seed: int, rows: int, columns: int) -> None:
    rng = np.random.default_rng(seed)
    kept = kept_amplitude(rng.normal(size=(rows, columns)))
    surface = synthesize(rng, kept)
    found = np.abs(np.fft.fft2(surface))
    assert surface.dtype == np.float64
    assert (found <= (1 + VARIATION) * kept + 1e-9).all()
    assert (found >= (1 - VARIATION) * kept - 1e-9).all()


def test_synthetic_surfaces_keep_the_measured_spectrum(model: WeldModel) -> None:
    amplitude = model.amplitude
    kept = amplitude > 0
    assert amplitude[kept].min() >= THRESHOLD * amplitude.max()
    first, second = (
        np.abs(np.fft.fft2(synthesize(np.random.default_rng(seed), amplitude))) for seed in (1, 2)
    )
    for found in (first, second):
        assert np.abs(found[kept] / amplitude[kept] - 1).max() <= VARIATION + 1e-6
        assert found[~kept].max() < 1e-6 * amplitude.max()
    assert np.abs(first - second).max() > 0.01 * amplitude.max()


def test_the_ring_has_the_measured_roughness_and_closes(model: WeldModel) -> None:
    surface = synthesize(np.random.default_rng(3), resample(model, 35.0, (128, 3072)))
    crop = synthesize(np.random.default_rng(4), model.amplitude)
    assert surface.std() == pytest.approx(crop.std(), rel=0.2)
    step = np.abs(np.diff(surface, axis=1))
    assert np.abs(surface[:, 0] - surface[:, -1]).mean() < 2 * step.mean()
    pieces = surface[:, : 3072 // 35 * 30].reshape(128, 5, -1)
    likeness = np.corrcoef([piece.ravel() for piece in pieces.transpose(1, 0, 2)])
    assert np.abs(likeness - np.eye(5)).max() < 0.9  # does not repeat at the measurement's length


def test_planted_shift_pitch_and_edge_are_found(planted_file: Path) -> None:
    model = derive(read_measurement(planted_file, 5.0))
    assert model.dominant_pitch_mm == pytest.approx(0.15, rel=0.02)
    assert model.shift.height_mm == pytest.approx(0.2, rel=0.1)
    assert model.shift.sigma_mm == pytest.approx(0.25, rel=0.1)
    assert model.edge.height_mm == pytest.approx(0.040, rel=0.05)
    assert model.edge.sigma_mm == pytest.approx(0.3, rel=0.05)
    assert model.width_mm == pytest.approx(1.0, abs=0.1)


@given(st.floats(0.05, 0.4), st.floats(0.15, 0.4), st.floats(0.1, 0.25))
def test_any_planted_row_shift_is_found(height: float, sigma: float, pitch: float) -> None:
    y = (np.arange(200) - 99.5) * 0.005
    shift = height * np.exp(-0.5 * (y / sigma) ** 2)
    x = np.arange(1200) * 0.005
    waves = np.sin(2 * np.pi * (x[None, :] - shift[:, None]) / pitch)
    found_pitch, found = row_shift(waves, 5.0)
    assert found_pitch == pytest.approx(pitch, rel=0.05)
    assert np.abs((found - found[0]) - (shift - shift[0])).max() < 0.12 * height + 0.004


@given(st.floats(0.01, 0.1), st.floats(-0.1, 0.1), st.floats(0.15, 0.35), st.floats(-0.05, 0.05))
def test_any_planted_edge_over_a_partner_step_is_found(
    height: float, center: float, sigma: float, slope: float
) -> None:
    y = np.linspace(-0.8, 0.8, 300)
    found = fit_edge(y, Gaussian(height, center, sigma)(y) + slope * y * height + 0.003)
    assert found.sigma_mm == pytest.approx(sigma, rel=0.05)
    assert found.center_mm == pytest.approx(center, abs=0.02)


def test_rows_shift_by_what_is_asked() -> None:
    surface = np.random.default_rng(0).normal(size=(4, 64))
    moved = shift_rows(surface, np.array([0.0, 1.0, 5.0, -3.0]))
    for row, by in enumerate((0, 1, 5, -3)):
        assert moved[row] == pytest.approx(np.roll(surface[row], by))


def test_a_map_without_a_weld_is_refused() -> None:
    even = Measurement(np.random.default_rng(0).normal(size=(300, 400)), 5.0, 0.0, 0.0, "x")
    with pytest.raises(SynthError, match="no weld stands out"):
        derive(even)
