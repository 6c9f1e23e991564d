"""Figures of a measurement and of a calibration (paper, Figs. 4, 5, 7); only this file imports matplotlib."""

from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from station.files.durable import write_whole
from synth.errors import SynthError
from synth.measured.measurement import Measurement
from synth.measured.spectrum import WeldModel, shift_rows, synthesize
from synth.output.calibrate import ALPHAS, Calibration
from synth.part.streams import Stream, stream


def measurement_figure(measurement: Measurement, model: WeldModel, out: Path) -> None:
    """Draw what was read and what was derived: map, row shift, profile; and a new surface in three steps."""
    figure = Figure(figsize=(13, 10), layout="constrained")
    axes = figure.subplot_mosaic([["map", "shift", "profile"], ["a", "b", "c"]], height_ratios=[1.5, 1])
    z, step = measurement.height_um, measurement.step_um / 1000
    extent = (0.0, z.shape[1] * step, z.shape[0] * step, 0.0)
    low, high = np.percentile(z, [0.5, 99.5])
    shown = axes["map"].imshow(z, extent=extent, vmin=low, vmax=high, cmap="viridis")
    figure.colorbar(shown, ax=axes["map"], label="height in um", shrink=0.7)
    for row in (model.first_row, model.first_row + model.shape[0]):
        axes["map"].axhline(row * step, color="white", linewidth=1, linestyle="--")
    lost = f"{measurement.lost:.1%} lost points filled, turned by {measurement.turned_deg:.0f}°"
    _title(axes["map"], f"levelled map, {measurement.step_um:g} um step\n{lost}", "x in mm", "y in mm")

    y = np.asarray((np.arange(model.shape[0]) - (model.shape[0] - 1) / 2) * step, np.float64)
    fitted = model.shift(y)
    axes["shift"].plot(y, model.phase_shift, label="measured")
    level = model.phase_shift.mean() - fitted.mean()
    axes["shift"].plot(y, fitted + level, label=f"Gaussian, sigma {model.shift.sigma_mm:.2f} mm")
    pitch = f"shift of the rows at the dominant pitch, {model.dominant_pitch_mm * 1000:.0f} um"
    _title(axes["shift"], pitch, "y in mm", "shift in mm")
    axes["profile"].plot(y, model.profile_um, label="measured")
    fitted = model.edge(y) * 1000
    level = model.profile_um.mean() - fitted.mean()
    axes["profile"].plot(y, fitted + level, label=f"Gaussian, sigma {model.edge.sigma_mm:.2f} mm")
    _title(axes["profile"], "mean height over x", "y in mm", "height in um")
    for name in ("shift", "profile"):
        axes[name].legend()
        axes[name].grid(alpha=0.3)

    surface = synthesize(stream(1, Stream.FIGURE), model.amplitude)
    bent = shift_rows(surface, model.shift(y) / step)
    weight = np.exp(-0.5 * ((y - model.edge.center_mm) / model.edge.sigma_mm) ** 2)[:, None]
    columns = min(surface.shape[1], 2 * surface.shape[0])
    made = f"new surface, eq. (2), {len(model.lines)} kept frequencies"
    steps = {"a": (surface, made), "b": (bent, "rows shifted"), "c": (bent * weight, "edges reduced")}
    limit = float(np.abs(surface).max())
    for name, (values, title) in steps.items():
        extent = (0.0, columns * step, float(y[-1]), float(y[0]))
        axes[name].imshow(values[:, :columns], extent=extent, vmin=-limit, vmax=limit, cmap="viridis")
        _title(axes[name], title, "x in mm", "y in mm")
    _save(figure, out)


def calibration_figure(calibration: Calibration, out: Path) -> None:
    """Draw the chi-square distance over alpha, with the minima marked."""
    figure = Figure(figsize=(8, 5), layout="constrained")
    axes = figure.subplots()
    for name, values, best in (
        ("weld", calibration.weld, calibration.alpha_weld),
        ("partners", calibration.partner, calibration.alpha_partner),
    ):
        (line,) = axes.plot(ALPHAS, values, marker="o", markersize=3, label=f"{name}: {best:.2f}")
        axes.axvline(best, color=line.get_color(), linestyle="--", linewidth=1)
    axes.legend()
    axes.grid(alpha=0.3)
    _title(axes, "distance of rendered from given images", "alpha", "chi-square distance")
    _save(figure, out)


def _title(axes: Any, title: str, x: str, y: str) -> None:
    axes.set_title(title, fontsize=10)
    axes.set_xlabel(x)
    axes.set_ylabel(y)


def _save(figure: Figure, out: Path) -> None:
    content = BytesIO()
    try:
        figure.savefig(content, format=out.suffix[1:] or "png", dpi=110)
        write_whole(out, content.getvalue())
    except (OSError, ValueError) as error:
        raise SynthError(f"{out}: the figure could not be written: {error}") from None
