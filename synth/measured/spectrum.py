"""From a measurement to the model of its weld, and back to new surfaces (paper, section 3.3)."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import curve_fit

from synth.errors import SynthError
from synth.measured.measurement import Measurement

Array = NDArray[np.float64]

THRESHOLD = 0.10
"""Fraction of the largest amplitude below which a spatial frequency is dropped."""
VARIATION = 0.15
"""Random change of a kept amplitude, either way: factor s of eq. (2)."""


@dataclass(frozen=True, slots=True)
class Gaussian:
    """The curve height * exp(-(y - center)^2 / (2 sigma^2)), all in mm."""

    height_mm: float
    center_mm: float
    sigma_mm: float

    def __call__(self, y_mm: Array) -> Array:
        """Return the value at `y_mm`, same shape, mm."""
        return np.asarray(self.height_mm * np.exp(-0.5 * ((y_mm - self.center_mm) / self.sigma_mm) ** 2))


@dataclass(frozen=True, slots=True, eq=False)
class WeldModel:
    """Model of a weld, derived from one measurement.

    lines (K, 3) float64: row v across, column u along (numpy's fft order) and |F_f| in um of the kept spatial
    frequencies of eq. (1), of a map of `shape` points of the bead alone. The rows are shifted back by `shift`
    before: the paper bends its surfaces after eq. (2), and a spectrum of bent scales would bend them twice.
    """

    lines: Array
    shape: tuple[int, int]
    step_um: float
    sha256: str
    """Checksum of the measurement's file."""
    first_row: int
    """First row of the bead in the measurement."""
    phase_shift: Array
    """Shift (M,) of each row along x, mm: phase of the dominant amplitude by wavelength (Fig. 4b)."""
    profile_um: Array
    """Mean height over x of each row of the bead, (M,) (Fig. 4c)."""
    dominant_pitch_mm: float
    shift: Gaussian
    """Row shift that makes the scales; y from the bead's middle."""
    edge: Gaussian
    """Height of the bead over y, for the reduction of the edges."""

    @property
    def length_mm(self) -> float:
        """Extent along the weld."""
        return self.shape[1] * self.step_um / 1000

    @property
    def width_mm(self) -> float:
        """Extent across the weld."""
        return self.shape[0] * self.step_um / 1000

    @property
    def amplitude(self) -> Array:
        """|F_f| over all frequencies, (M, N), zero where dropped, um."""
        full = np.zeros(self.shape)
        full[self.lines[:, 0].astype(int), self.lines[:, 1].astype(int)] = self.lines[:, 2]
        return full


def derive(measurement: Measurement) -> WeldModel:
    """Find the bead in a measurement and derive its model. Raises SynthError if no bead stands out."""
    first, last = bead_rows(measurement)
    bead = measurement.height_um[first:last]
    y_mm = (np.arange(last - first) - (last - first - 1) / 2) * measurement.step_um / 1000
    profile = bead.mean(axis=1)
    relief = bead - profile[:, None]
    pitch_mm, shift_mm = row_shift(relief, measurement.step_um)
    shift = fit_gaussian(y_mm, shift_mm)
    kept = kept_amplitude(shift_rows(relief, -shift(y_mm) * 1000 / measurement.step_um))
    v, u = np.nonzero(kept)
    return WeldModel(
        lines=np.stack([v, u, kept[v, u]], axis=1),
        shape=kept.shape,
        step_um=measurement.step_um,
        sha256=measurement.sha256,
        first_row=first,
        phase_shift=shift_mm,
        profile_um=profile,
        dominant_pitch_mm=pitch_mm,
        shift=shift,
        edge=_fit_edge_of(measurement, first, last),
    )


def bead_rows(measurement: Measurement) -> tuple[int, int]:
    """Return the first and last row (exclusive) of the bead: where the map is rough along x."""
    z = measurement.height_um
    size = max(3, int(0.15 / (measurement.step_um / 1000)) | 1)
    kernel = np.ones(size) / size
    smooth = np.apply_along_axis(lambda row: np.convolve(row, kernel, mode="same"), 1, z)
    rough = np.abs(z - smooth)[:, size:-size].mean(axis=1)
    rough = np.convolve(np.pad(rough, size, mode="edge"), kernel, mode="same")[size:-size]
    low, high = np.percentile(rough, [10, 95])
    if high < 1.5 * low:
        raise SynthError(
            "no weld stands out in the measurement: its rows are equally rough; "
            "does the map hold a weld and its partners?"
        )
    rows = np.flatnonzero(rough > (low + high) / 2)
    runs = np.split(rows, np.flatnonzero(np.diff(rows) > size) + 1)
    longest = max(runs, key=len)
    first, last = int(longest[0]), int(longest[-1]) + 1
    if (last - first) * measurement.step_um < 100:
        width_um = (last - first) * measurement.step_um
        raise SynthError(
            f"the weld found in the measurement is {width_um:.0f} um wide; at least 100 are needed"
        )
    return first, last


def kept_amplitude(relief_um: Array) -> Array:
    """Return |F| of eq. (1) (M, N) in um, zero below `THRESHOLD` of its largest value and at the mean."""
    amplitude = np.abs(np.fft.fft2(relief_um))
    amplitude[0, 0] = 0.0
    return np.where(amplitude >= THRESHOLD * amplitude.max(), amplitude, 0.0)


def synthesize(rng: np.random.Generator, amplitude: Array) -> Array:
    """Return a new surface (M, N), um, by eq. (2): amplitudes changed by up to ±15 %, phases at random.

    It is the real part of a spectrum with free phases: each pair of conjugate frequencies shares one phase
    and one factor, so that the surface keeps the amplitudes exactly within the ±15 %.
    """
    rows, columns = amplitude.shape
    phase = rng.uniform(0, 2 * np.pi, (rows, columns))
    factor = rng.uniform(1 - VARIATION, 1 + VARIATION, (rows, columns))
    mirror_v, mirror_u = -np.arange(rows) % rows, -np.arange(columns) % columns
    own = np.arange(rows)[:, None] * columns + np.arange(columns)[None, :]
    other = mirror_v[:, None] * columns + mirror_u[None, :]
    lead = own < other
    phase = np.where(lead, phase, -phase[mirror_v[:, None], mirror_u[None, :]])
    phase = np.where(own == other, np.round(phase / np.pi) * np.pi, phase)
    factor = np.where(lead | (own == other), factor, factor[mirror_v[:, None], mirror_u[None, :]])
    return np.asarray(np.fft.ifft2(factor * amplitude * np.exp(1j * phase)).real)


def resample(model: WeldModel, length_mm: float, shape: tuple[int, int]) -> Array:
    """Return the amplitudes in um of a map `length_mm` long, as wide as the measured one, for a grid `shape`.

    Along the weld the spectrum's lines are spread over the finer lines of the longer map with the same power,
    so that a surface made from them closes round the ring and does not repeat at the measurement's length.
    """
    rows, columns = shape
    old_rows, old_columns = model.shape
    u = np.fft.fftfreq(columns, 1.0 / columns) * model.length_mm / length_mm
    v = np.fft.fftfreq(rows, 1.0 / rows).astype(int)
    column = np.round(u).astype(int)
    row_fits = np.abs(v) <= (old_rows - 1) // 2
    column_fits = np.abs(column) <= (old_columns - 1) // 2
    amplitude = model.amplitude
    picked = amplitude[(v % old_rows)[:, None], (column % old_columns)[None, :]]
    picked = picked * (row_fits[:, None] & column_fits[None, :])
    lines = length_mm / model.length_mm
    return np.asarray(picked * (rows * columns) / (old_rows * old_columns) / np.sqrt(lines))


def shift_rows(surface: Array, shift_columns: Array) -> Array:
    """Move each row of (M, N) along x by its own number of columns, round the ends (Fourier shifts)."""
    frequency = np.fft.rfftfreq(surface.shape[1])
    turned = np.fft.rfft(surface, axis=1) * np.exp(-2j * np.pi * frequency[None, :] * shift_columns[:, None])
    return np.asarray(np.fft.irfft(turned, n=surface.shape[1], axis=1))


def row_shift(relief_um: Array, step_um: float) -> tuple[float, Array]:
    """Return the dominant pitch and the shift (M,) of each row along x at that pitch, mm (Fig. 4b).

    Each row's phase is taken against its neighbour over the lines round the dominant one, weighted by their
    amplitudes, and added up: a single line's phase is lost where its amplitude fades.
    """
    spectrum = np.fft.rfft(relief_um, axis=1)
    power = (np.abs(spectrum) ** 2).sum(axis=0)
    shortest = math.ceil(relief_um.shape[1] / relief_um.shape[0])  # ripples are shorter than the bead is wide
    power[: max(2, shortest)] = 0.0
    smooth = np.convolve(power, np.ones(5) / 5, mode="same")
    peak = int(smooth.argmax())
    near = np.arange(max(1, peak - 3), min(power.size, peak + 4))
    center = float((near * power[near]).sum() / power[near].sum())
    low, high = max(2, int(peak * 0.7)), int(peak * 1.3) + 2
    length_mm = relief_um.shape[1] * step_um / 1000
    lag = max(1, round(0.02 / (step_um / 1000)))
    cross = spectrum[lag:, low:high] * np.conj(spectrum[:-lag, low:high])
    lines = np.arange(low, high)
    weight = np.abs(cross)
    slope = (weight * np.angle(cross) * lines).sum(axis=1) / np.maximum(
        (weight * lines**2).sum(axis=1), 1e-12
    )
    step_shift = -slope * length_mm / (2 * np.pi) / lag
    before, after = np.repeat(step_shift[:1], lag // 2), np.repeat(step_shift[-1:], lag - lag // 2)
    step_shift = np.concatenate([before, step_shift, after])
    shift = np.cumsum(step_shift)[: relief_um.shape[0]]
    return length_mm / center, shift - shift[[0, -1]].mean()


def _fit_edge_of(measurement: Measurement, first: int, last: int) -> Gaussian:
    """Fit the bead's height over y, with some of the partners on either side in view."""
    margin = (last - first) // 3
    low, high = max(0, first - margin), min(measurement.height_um.shape[0], last + margin)
    y_mm = (np.arange(low, high) - (first + last - 1) / 2) * measurement.step_um / 1000
    return fit_edge(y_mm, measurement.height_um[low:high].mean(axis=1) / 1000)


def fit_gaussian(y_mm: Array, value_mm: Array) -> Gaussian:
    """Fit a least-squares Gaussian over a constant. Raises SynthError if none fits."""
    return _fit(y_mm, value_mm, 0)


def fit_edge(y_mm: Array, profile_mm: Array) -> Gaussian:
    """Fit a Gaussian over a sloped line: one partner may lie higher than the other (paper, Fig. 4c)."""
    return _fit(y_mm, profile_mm, 1)


def _fit(y_mm: Array, value_mm: Array, order: int) -> Gaussian:
    half = float(np.ptp(y_mm)) / 2
    span = float(np.ptp(value_mm)) + 1e-9

    def curve(y: Array, height: float, center: float, sigma: float, *base: float) -> Array:
        return np.asarray(height * np.exp(-0.5 * ((y - center) / sigma) ** 2) + np.polyval(base, y))

    edges, middle = (value_mm[0] + value_mm[-1]) / 2, value_mm[value_mm.size // 2]
    start = [float(middle - edges), 0.0, half / 2] + [0.0] * order + [float(edges)]
    low = [-10 * span, -half / 2, half / 10] + [-np.inf] * (order + 1)
    high = [10 * span, half / 2, half] + [np.inf] * (order + 1)
    try:
        (height, center, sigma, *_), _ = curve_fit(curve, y_mm, value_mm, start, bounds=(low, high))
    except (RuntimeError, ValueError) as error:
        raise SynthError(f"no Gaussian fits the measured profile: {error}") from None
    return Gaussian(float(height), float(center), float(sigma))
