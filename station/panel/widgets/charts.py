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
    """One small plot in the colours of the theme; it is looked at, not moved."""

    def __init__(self, title: str, unit: str = "") -> None:
        c = theme.colors()
        super().__init__(background=c.surface)
        self.setMouseEnabled(False, False)
        self.setMenuEnabled(False)
        self.hideButtons()
        self.setTitle(title + (f" · {unit}" if unit else ""), color=c.text, size="11pt")
        for side in ("left", "bottom"):
            axis = self.getAxis(side)
            axis.setPen(c.line)
            axis.setTextPen(c.quiet)
        self.setMinimumHeight(150)

    def sizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        """Small: the layout gives it room."""
        return QSize(240, 160)

    def show_trend(
        self, values: Sequence[float | None], bad: Sequence[bool], limits: Sequence[float]
    ) -> None:
        """One dot a part, refused ones as red crosses; limits dashed."""
        c = theme.colors()
        self.clear()
        known = [(i, v, b) for i, (v, b) in enumerate(zip(values, bad, strict=True)) if v is not None]
        for red, symbol, color, size in ((False, "o", c.accent, 4), (True, "x", c.bad, 8)):
            chosen = [(i, v) for i, v, b in known if b is red]
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
            self.addLine(y=limit, pen=pg.mkPen(c.warn_text, width=1, style=Qt.PenStyle.DashLine))
        top = max([*(v for _, v, _ in known), *limits, 1e-6])
        self.setYRange(0, top * 1.05)

    def show_histogram(self, values: Sequence[float]) -> None:
        """Counts in classes of equal width."""
        self.clear()
        if values:
            counts, edges = np.histogram(np.asarray(values), BINS)
            self.addItem(_bars(edges[:-1], counts, float(edges[1] - edges[0])))

    def show_counts(self, counts: Sequence[int], first: float, width: float) -> None:
        """Counts of classes that are given."""
        self.clear()
        x = first + width * np.arange(len(counts))
        self.addItem(_bars(x, np.asarray(counts), width))

    def show_bars(self, named: Sequence[tuple[str, int]]) -> None:
        """One bar for each name."""
        self.clear()
        self.addItem(
            _bars(
                np.arange(len(named)) - 0.35,
                np.array([count for _, count in named], float),
                0.7,
                theme.colors().bad,
            )
        )
        self.getAxis("bottom").setTicks([[(i, f"{name} {count}") for i, (name, count) in enumerate(named)]])
        self.setXRange(-0.5, max(len(named), 3) - 0.5)
        self.setYRange(0, max([count for _, count in named] + [1]) * 1.05)


def _bars(x: NDArray[np.floating[Any]], heights: object, width: float, color: str = "") -> pg.BarGraphItem:
    brush = color or theme.colors().accent
    return pg.BarGraphItem(x0=x, height=heights, width=width, brush=brush, pen=theme.colors().surface)
