"""Figures of reports, drawn with matplotlib; the only file of models that imports it."""

from collections.abc import Mapping, Sequence
from io import BytesIO

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray
from sklearn.metrics import auc, precision_recall_curve, roc_curve

Array = NDArray[np.float64]
BLUE, RED, GREY = "#1f5fa8", "#b3261e", "#777777"


def curves(nok: Array, truth: NDArray[np.bool_], escape_cost: float) -> bytes:
    """Draw ROC, precision and recall, scores and calibration for scores of NOK (N,) and truths (N,), as PNG.

    The scores are calibrated for crops of which a NOK one counts `escape_cost` times.
    """
    figure, axes = _canvas(2, 2, (9.0, 7.2))
    fpr, tpr, _ = roc_curve(truth, nok)
    axes[0].plot(fpr, tpr, color=BLUE)
    axes[0].set(
        xlabel="false rejects, fraction of OK crops",
        ylabel="recall",
        title=f"ROC, area {auc(fpr, tpr):.4f}",
        xlim=(-0.005, 0.3),
    )
    precision, recall, _ = precision_recall_curve(truth, nok)
    axes[1].plot(recall, precision, color=BLUE)
    axes[1].set(
        xlabel="recall",
        ylabel="precision",
        title=f"precision and recall, area {auc(recall, precision):.4f}",
        ylim=(0.5, 1.02),
    )
    bins = np.linspace(0, 1, 31)
    axes[2].hist(nok[~truth], bins, color=BLUE, alpha=0.8, label=f"{int((~truth).sum())} OK")
    axes[2].hist(nok[truth], bins, color=RED, alpha=0.7, label=f"{int(truth.sum())} NOK")
    axes[2].set(xlabel="score of NOK", ylabel="crops", yscale="log", title="scores")
    axes[2].legend()
    at = np.minimum((nok * 10).astype(int), 9)
    filled = [b for b in range(10) if (at == b).any()]
    axes[3].plot([0, 1], [0, 1], color=GREY, linewidth=1)
    weights = np.where(truth, escape_cost, 1.0)
    fractions = [np.average(truth[at == b], weights=weights[at == b]) for b in filled]
    axes[3].plot(
        [np.average(nok[at == b], weights=weights[at == b]) for b in filled], fractions, "o-", color=BLUE
    )
    axes[3].set(
        xlabel="score of NOK", ylabel=f"fraction that is NOK, each x {escape_cost:g}", title="calibration"
    )
    return _png(figure)


def drift_curves(
    strength: Sequence[float], named: Mapping[str, tuple[Sequence[float], Sequence[float]]]
) -> bytes:
    """Draw F2 and the fraction of parts with the alarm over the strength of each drift, as PNG."""
    columns = min(3, len(named))
    figure, axes = _canvas(
        -(-len(named) // columns), columns, (4.2 * columns, 3.4 * -(-len(named) // columns))
    )
    for axis, (name, (f2, alarm)) in zip(axes, named.items(), strict=False):
        axis.plot(strength, f2, "o-", color=BLUE, label="F2 of the segments")
        axis.plot(strength, alarm, "s--", color=RED, label="parts with the alarm")
        axis.set(title=name, xlabel="strength of the drift", ylim=(-0.03, 1.05))
    axes[0].legend(loc="lower left")
    for axis in axes[len(named) :]:
        axis.set_axis_off()
    return _png(figure)


def sheet(images: Sequence[NDArray[np.uint8]], titles: Sequence[str]) -> bytes:
    """Draw a contact sheet of crops (128, 128) uint8, each with its title, as PNG."""
    columns = min(6, max(1, len(images)))
    rows = -(-len(images) // columns)
    figure, axes = _canvas(rows, columns, (2.1 * columns, 2.35 * rows))
    for axis in axes:
        axis.set_axis_off()
    for axis, image, title in zip(axes, images, titles, strict=False):
        axis.imshow(image, cmap="gray", vmin=0, vmax=255)
        axis.set_title(title, fontsize=7)
    return _png(figure)


def _canvas(rows: int, columns: int, size: tuple[float, float]) -> tuple[Figure, list]:  # type: ignore[type-arg]
    figure = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    return figure, list(np.atleast_1d(figure.subplots(rows, columns)).ravel())


def _png(figure: Figure) -> bytes:
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=110)
    return buffer.getvalue()
