"""Layers of lines and arrows over a picture, drawn by a few calls however many pieces they have."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pyqtgraph.Qt import internals
from PySide6.QtCore import QLineF, QPointF
from PySide6.QtGui import QPainter
from PySide6.QtWidgets import QStyleOptionGraphicsItem, QWidget

from workbench.views.colours import EXCLUDED, ColourLike, KeySign, sigma_table, to_colour, to_rgba
from workbench.views.labels import draw_label
from workbench.views.overlays import Layer, Points, as_points, cosmetic

_VALUE_COLOURS = 16


class LinesLayer(Layer):
    """Polylines: in one colour, in one each, or coloured by a value at each point."""

    def __init__(
        self,
        lines: Sequence[ArrayLike],
        colours: Sequence[ColourLike],
        values: Sequence[ArrayLike] | None,
        limits: tuple[float, float],
        width: float,
        labels: Sequence[str] | None,
        title: str,
    ) -> None:
        super().__init__(title)
        points = [as_points(line) for line in lines]
        self._width, self._colours = width, list(colours)
        self._sign: KeySign = "line" if values is None else "scale"
        self._batches = _coloured(points, self._colours) if values is None else _valued(points, values, limits)
        self._labels = []
        for line, text, colour in zip(points, labels or [""] * len(points), self._colours, strict=True):
            known = line[np.isfinite(line).all(axis=1)]
            if text and len(known):
                self._labels.append((QPointF(*known[0]), text, to_colour(colour)))

    @property
    def key(self) -> tuple[KeySign, ColourLike]:
        return self._sign, self._colours[0] if self._colours else EXCLUDED

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for rgba, lines in self._batches:
            painter.setPen(cosmetic(rgba, self._width, widget))
            painter.drawLines(*lines.drawargs())
        if self._labels:
            transform = painter.worldTransform()
            painter.resetTransform()
            for start, text, colour in self._labels:
                draw_label(painter, transform.map(start) + QPointF(0, -12), text, colour, within=widget)


class VectorsLayer(Layer):
    """Arrows."""

    def __init__(self, uv: ArrayLike, d_uv: ArrayLike, factor: float, colour: ColourLike, title: str) -> None:
        super().__init__(title)
        self._colour = colour
        start, along = as_points(uv), as_points(d_uv) * factor
        tip = start + along
        side = np.column_stack([-along[:, 1], along[:, 0]])
        barbs = [tip - 0.28 * along + turn * 0.14 * side for turn in (-1, 1)]
        self._lines = _primitive(np.vstack([np.hstack([start, tip]), *(np.hstack([tip, barb]) for barb in barbs)]))

    @property
    def key(self) -> tuple[KeySign, ColourLike]:
        return "line", self._colour

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(cosmetic(to_rgba(self._colour), 1.4, widget))
        painter.drawLines(*self._lines.drawargs())


def _coloured(lines: Sequence[Points], colours: Sequence[ColourLike]) -> list[tuple[tuple[int, int, int, int], Any]]:
    grouped: dict[tuple[int, int, int, int], list[Points]] = {}
    for line, colour in zip(lines, colours, strict=True):
        grouped.setdefault(to_rgba(colour), []).append(line)
    return [(rgba, _primitive(_segments(group)[0])) for rgba, group in grouped.items()]


def _valued(
    lines: Sequence[Points], values: Sequence[ArrayLike], limits: tuple[float, float]
) -> list[tuple[tuple[int, int, int, int], Any]]:
    """Pieces of line in a few colours: drawing one colour is fast, changing it is not."""
    segments, owner = _segments(lines)
    all_values = (
        np.concatenate([np.asarray(v, dtype=np.float64).reshape(-1) for v in values]) if values else np.zeros(0)
    )
    low, high = limits
    with np.errstate(invalid="ignore"):
        mean = 0.5 * (all_values[owner] + all_values[owner + 1])
        step = np.floor((mean - low) * (_VALUE_COLOURS / (high - low)))
        known = np.isfinite(mean) & (mean <= high)
    step = np.where(known, np.clip(step, 0, _VALUE_COLOURS - 1), _VALUE_COLOURS).astype(np.intp)
    table = sigma_table()
    shades = [table[round((k + 0.5) * 255 / _VALUE_COLOURS)] for k in range(_VALUE_COLOURS)]
    palette = [(int(r), int(g), int(b), 255) for r, g, b, _ in shades] + [to_rgba(EXCLUDED)]
    return [(palette[k], _primitive(segments[step == k])) for k in np.unique(step)]


def _segments(lines: Sequence[Points]) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """The pieces (M, 4) between neighbouring points of each line, and the number of the point each starts at."""
    if not lines:
        return np.zeros((0, 4)), np.zeros(0, dtype=np.intp)
    points = np.concatenate(lines)
    last = np.cumsum([len(line) for line in lines]) - 1
    starts = np.ones(len(points), dtype=bool)
    starts[last[last >= 0]] = False
    owner = np.flatnonzero(starts)
    segments = np.hstack([points[owner], points[owner + 1]])
    finite = np.isfinite(segments).all(axis=1)
    return segments[finite], owner[finite]


def _primitive(segments: NDArray[np.float64]) -> Any:
    """Pieces of line as Qt draws them at one go."""
    segments = segments[np.isfinite(segments).all(axis=1)]
    lines = internals.PrimitiveArray(QLineF, 4)
    lines.resize(len(segments))
    lines.ndarray()[:] = segments
    return lines
