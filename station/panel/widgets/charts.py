"""Trends and histograms; the only file that imports pyqtgraph."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import QSize, Qt

from station.panel.look import theme

BINS = 40


class Chart(pg.PlotWidget):  # type: ignore[misc]
    """A small plot in the colours of the theme; it cannot be moved or zoomed."""

    def __init__(self, title: str, unit: str = "") -> None:
        colors = theme.colors()
        super().__init__(background=colors.surface)
        self.setMouseEnabled(False, False)
        self.setMenuEnabled(False)
        self.hideButtons()
        self.setTitle(title + (f" · {unit}" if unit else ""), color=colors.text, size="11pt")
        for side in ("left", "bottom"):
            axis = self.getAxis(side)
            axis.setPen(colors.line)
            axis.setTextPen(colors.quiet)
        self.setMinimumHeight(150)

    def sizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        """Return a small size; the layout gives it more room."""
        return QSize(240, 160)

    def show_trend(
        self, values: Sequence[float | None], bad: Sequence[bool], limits: Sequence[float]
    ) -> None:
        """Show one dot for each part, NOK parts as red crosses, and limits as dashed lines.

        A value of None is left out.
        """
        colors = theme.colors()
        self.clear()
        known = [
            (index, value, is_bad)
            for index, (value, is_bad) in enumerate(zip(values, bad, strict=True))
            if value is not None
        ]
        for red, symbol, color, size in ((False, "o", colors.accent, 4), (True, "x", colors.bad, 8)):
            chosen = [(index, value) for index, value, is_bad in known if is_bad is red]
            if chosen:
                x, y = np.array(chosen, float).T
                self.plot(
                    x,
                    y,
                    pen=None,
                    symbol=symbol,
                    symbolSize=size,
                    symbolBrush=color,
                    symbolPen=pg.mkPen(color, width=2 if red else 0),
                )
        for limit in limits:
            self.addLine(y=limit, pen=pg.mkPen(colors.warn_text, width=1, style=Qt.PenStyle.DashLine))
        top = max([*(value for _, value, _ in known), *limits, 1e-6])
        self.setYRange(0, top * 1.05)

    def show_histogram(self, values: Sequence[float]) -> None:
        """Show how many values lie in each of `BINS` classes of equal width."""
        self.clear()
        if values:
            counts, edges = np.histogram(np.asarray(values), BINS)
            self.addItem(_bars(edges[:-1], counts, float(edges[1] - edges[0])))

    def show_counts(self, counts: Sequence[int], first: float, width: float) -> None:
        """Show counts by class; the first class begins at `first`, each is `width` wide."""
        self.clear()
        x = first + width * np.arange(len(counts))
        self.addItem(_bars(x, np.asarray(counts), width))

    def show_bars(self, named: Sequence[tuple[str, int]]) -> None:
        """Show one bar for each name."""
        self.clear()
        self.addItem(
            _bars(
                np.arange(len(named)) - 0.35,
                np.array([count for _, count in named], float),
                0.7,
                theme.colors().bad,
            )
        )
        self.getAxis("bottom").setTicks(
            [[(place, f"{name} {count}") for place, (name, count) in enumerate(named)]]
        )
        self.setXRange(-0.5, max(len(named), 3) - 0.5)
        self.setYRange(0, max([count for _, count in named] + [1]) * 1.05)


def _bars(x: NDArray[np.floating[Any]], heights: object, width: float, color: str = "") -> pg.BarGraphItem:
    brush = color or theme.colors().accent
    return pg.BarGraphItem(x0=x, height=heights, width=width, brush=brush, pen=theme.colors().surface)
