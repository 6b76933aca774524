"""What is written over the scene: labels, dimension lines, axes, scale, colour bar. Drawn by Qt, so it is always sharp.

Every function paints in logical pixels; a picture for a file is painted with the same ones.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QImage, QPainter, QPalette, QPen, QPolygonF

from core.inspect.shown.view_frame import FRAME_NAMES, ViewFrame
from core.model.arrays import Array
from workbench.language import number, tr
from workbench.views.scene.camera import SceneCamera
from workbench.views.scene.colours import Colouring, Rgb, nice_step, table, ticks
from workbench.views.scene.contents import Labels, Measure, Scene

HANDLE_PX = 9.0
"""Radius of the ring that is dragged."""

MARGIN, BAR_WIDTH = 14.0, 14.0
"""Round the overlay, and of the colour bar; in logical pixels."""

LEAST_BAR, BELOW_BAR = 60.0, 14.0
"""Height of the colour bar, which is not shown where it would be less, and what stays free below it."""

LEAST_BARS = 2
"""So many times the bar's width with its numbers is a view at least that shows it: one beside the profile of a cut in
the smallest window is."""

NAME_TOP, HINT_TOP = 4.0, 38.0
"""Pixels above the name of the frame, which may be two lines, and above what the tool in hand does."""

NAME_ROOM = 26.0
"""Pixels at the top that a name of one line takes."""

AXES: tuple[tuple[str, Rgb, Rgb], ...] = (
    ("x", (200, 45, 45), (255, 110, 105)),
    ("y", (20, 115, 50), (95, 205, 115)),
    ("z", (35, 95, 210), (105, 165, 255)),
)
"""Name, colour on a light ground, colour on a dark one."""

AWAY = 0.72
"""An axis that points away is as opaque as this: fainter, but of 3 : 1 contrast to the ground, as WCAG 2.2 asks."""


@dataclass(frozen=True, slots=True)
class OverlayColours:
    """Colours of the theme for the overlay."""

    ground: QColor
    text: QColor
    accent: QColor

    @classmethod
    def of(cls, palette: QPalette) -> OverlayColours:
        """Make the overlay's colours from the palette of a widget."""
        role = QPalette.ColorRole
        return cls(palette.color(role.Window), palette.color(role.WindowText), palette.color(role.Highlight))

    @property
    def dark(self) -> bool:
        """Whether the background of the view is dark."""
        return self.ground.lightness() < 128

    @property
    def plate(self) -> QColor:
        """Colour of the plates behind texts over the scene."""
        plate = QColor(self.ground)
        plate.setAlpha(205)
        return plate


def paint_overlay(
    painter: QPainter,
    scene: Scene,
    camera: SceneCamera,
    size: tuple[int, int],
    colours: OverlayColours,
    *,
    axes: ViewFrame | None,
    grid_mm: float,
) -> None:
    """Paint labels, callouts, colour bar, axes and scale over the scene.

    `axes` is the frame whose axes are shown, if they are.
    """
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    for item in scene.items.values():
        if isinstance(item, Labels):
            _paint_labels(painter, item, camera, size, colours)
        elif isinstance(item, Measure):
            _paint_measure(painter, item, camera, size, colours)
    if axes is not None:
        room = size[0] - bar_width(scene.colouring, painter.font()) - 2 * MARGIN
        _paint_triad(painter, axes, camera, (room, size[1]), colours)
        _paint_scale(painter, camera, size, colours, grid_mm)
    if scene.colouring is not None:
        _paint_bar(painter, scene.colouring, size, colours)


def bar_width(colouring: Colouring | None, font: QFont) -> int:
    """Compute the width in px of the colour bar at the right; 0 without one."""
    if colouring is None:
        return 0
    metrics = QFontMetricsF(small_font(font))
    numbers = max(metrics.horizontalAdvance(text) for text in _ticks(colouring, 240)[1] or [""])
    lines = _wrapped(colouring.title, metrics)
    return round(max(BAR_WIDTH + 8 + numbers, *(metrics.horizontalAdvance(line) for line in lines)) + 2 * MARGIN)


def corner_rects(size: tuple[int, int]) -> list[QRectF]:
    """Return the rectangles at the lower left that the axes and the scale take."""
    return [QRectF(0, size[1] - MARGIN - 72, MARGIN + 70, MARGIN + 72), QRectF(84, size[1] - 44, 110, 44)]


def text_plate(
    painter: QPainter, at: QPointF, text: str, colours: OverlayColours, colour: QColor | None = None
) -> QRectF:
    """Paint a text on a plate whose middle is `at`, and return the plate's rectangle."""
    plate = _plate(painter, at, text)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(colours.plate)
    painter.drawRoundedRect(plate, 4, 4)
    painter.setPen(colour or colours.text)
    painter.drawText(plate, int(Qt.AlignmentFlag.AlignCenter), text)
    return plate


def _plate(painter: QPainter, at: QPointF, text: str) -> QRectF:
    """Of a text in small letters, which the painter has then, its middle at `at`."""
    painter.setFont(small_font(painter.font()))
    box = painter.fontMetrics().boundingRect(0, 0, 1000, 1000, int(Qt.AlignmentFlag.AlignLeft), text)
    plate = QRectF(0, 0, box.width() + 10, box.height() + 4)
    plate.moveCenter(at)
    return plate


def paint_hint(painter: QPainter, text: str, room: float, colours: OverlayColours) -> None:
    """Paint what the tool does as text at the top of the view, within `room` px of width."""
    painter.setFont(small_font(painter.font()))
    flags = int(Qt.AlignmentFlag.AlignHCenter) | int(Qt.TextFlag.TextWordWrap)
    box = painter.boundingRect(QRectF(MARGIN, HINT_TOP, room - 2 * MARGIN, 1000), flags, text)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(colours.plate)
    painter.drawRoundedRect(box.adjusted(-5, -2, 5, 2), 4, 4)
    painter.setPen(colours.text)
    painter.drawText(box, flags, text)


def small_font(font: QFont) -> QFont:
    """Make the font for texts over the scene."""
    small = QFont(font)
    small.setPixelSize(12)
    return small


def _paint_labels(
    painter: QPainter, labels: Labels, camera: SceneCamera, size: tuple[int, int], colours: OverlayColours
) -> None:
    """A dot at each place, and its text where that would cover no nearer one's."""
    screen, depth = camera.project(labels.places, size)
    colour = QColor(*labels.colour) if labels.colour is not None else None
    shown = [int(k) for k in np.argsort(depth) if depth[k] > 0 and np.isfinite(screen[k]).all()]
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(colour or colours.text)
    for k in shown:
        painter.drawEllipse(QPointF(*screen[k]), 2.2, 2.2)
    taken: list[QRectF] = []
    for k in shown:
        above = QPointF(*screen[k]) - QPointF(0, 14)
        if not any(_plate(painter, above, labels.texts[k]).intersects(other) for other in taken):
            taken.append(text_plate(painter, above, labels.texts[k], colours, colour))


def _paint_measure(
    painter: QPainter, measure: Measure, camera: SceneCamera, size: tuple[int, int], colours: OverlayColours
) -> None:
    """A line with a cross stroke at each end, rimmed so that it shows on any cloud."""
    screen, depth = camera.project(measure.ends, size)
    if not (depth > 0).all():
        return
    a, b = (QPointF(float(x), float(y)) for x, y in screen)
    along = screen[1] - screen[0]
    length = float(np.hypot(*along)) or 1.0
    across = QPointF(-along[1] / length * 6, along[0] / length * 6)
    for pen in (QPen(colours.ground, 5), QPen(colours.text, 2.0)):
        painter.setPen(pen)
        painter.drawLine(a, b)
        painter.drawLine(a - across, a + across)
        painter.drawLine(b - across, b + across)
    text_plate(painter, (a + b) / 2, measure.text, colours)


def _paint_triad(
    painter: QPainter, frame: ViewFrame, camera: SceneCamera, room: tuple[float, float], colours: OverlayColours
) -> None:
    """Directions of the frame's axes, those that point away first, and which frame it is.

    The axes stand at the lower left, its name at the upper left, where a fitted scene is seldom, of as much room in
    pixels as the colour bar leaves.
    """
    centre, length = QPointF(MARGIN + 30, room[1] - MARGIN - 30), 24.0
    painter.setFont(small_font(painter.font()))
    metrics = QFontMetricsF(painter.font())
    lines = _wrapped(tr(FRAME_NAMES[frame.kind]), metrics, room[0])
    middle = MARGIN + max(map(metrics.horizontalAdvance, lines)) / 2
    text_plate(painter, QPointF(middle, NAME_TOP + len(lines) * metrics.height() / 2), "\n".join(lines), colours)
    right, up, back = camera.axes @ frame.axes.T
    for k in np.argsort(back):
        colour = axis_colour(int(k), colours, away=back[k] < -0.05)
        direction = QPointF(float(right[k]), -float(up[k]))
        tip = centre + direction * length
        painter.setPen(QPen(colour, 2.4, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
        painter.drawLine(centre, tip)
        place = QRectF(0, 0, 16, 16)
        place.moveCenter(centre + direction * (length + 8) if abs(back[k]) < 0.97 else centre + QPointF(9, -9))
        painter.drawText(place, int(Qt.AlignmentFlag.AlignCenter), AXES[k][0])


def axis_colour(number: int, colours: OverlayColours, *, away: bool) -> QColor:
    """Return the colour of axis 0, 1 or 2; `away`: the axis points away from the viewer."""
    _, on_light, on_dark = AXES[number]
    part = AWAY if away else 1.0
    under_it = colours.ground
    axis, ground = on_dark if colours.dark else on_light, (under_it.red(), under_it.green(), under_it.blue())
    return QColor(*(round(part * one + (1 - part) * under) for one, under in zip(axis, ground, strict=True)))


def _paint_scale(
    painter: QPainter, camera: SceneCamera, size: tuple[int, int], colours: OverlayColours, grid_mm: float
) -> None:
    """A bar of a round number of mm, at the depth the view turns about."""
    scale = camera.pixels_per_mm(size)
    if not np.isfinite(scale) or scale <= 0:
        return
    length_mm = nice_step(60 / scale)
    length = length_mm * scale
    left, y = MARGIN + 84.0, size[1] - MARGIN - 10.0
    if left + length > size[0] - MARGIN:
        return
    for pen in (QPen(colours.ground, 5), QPen(colours.text, 1.6)):
        painter.setPen(pen)
        painter.drawPolyline(
            [QPointF(left, y - 5), QPointF(left, y), QPointF(left + length, y), QPointF(left + length, y - 5)]
        )
    length_text = f"{number(length_mm, 'g')} mm"
    text_plate(
        painter, QPointF(left + length / 2, y - 14), length_text if camera.parallel else f"≈ {length_text}", colours
    )
    if grid_mm:
        grid = tr("grid {step:g} mm", step=grid_mm)
        text_plate(painter, QPointF(left + length + 60, y - 5), grid, colours)


def _ticks(colouring: Colouring, height: float) -> tuple[list[float], list[str]]:
    assert colouring.limits is not None
    return ticks(*colouring.limits, at_most=max(int(height / 36), 2))


def _wrapped(title: str, metrics: QFontMetricsF, width: float = 92.0) -> list[str]:
    """The title in lines of at most `width`, unless a word is longer."""
    lines: list[str] = []
    for word in title.split():
        if lines and metrics.horizontalAdvance(f"{lines[-1]} {word}") <= width:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return lines or [""]


def _paint_bar(painter: QPainter, colouring: Colouring, size: tuple[int, int], colours: OverlayColours) -> None:
    """The colour bar at the right edge, half as high as the view; points of arrows say that values lie beyond."""
    assert colouring.limits is not None
    font = small_font(painter.font())
    metrics = QFontMetricsF(font)
    lines = _wrapped(colouring.title, metrics)
    width = bar_width(colouring, font)
    above = 20 + len(lines) * metrics.height()
    height = float(np.clip(size[1] * 0.5, LEAST_BAR, 300))
    top = max((size[1] - height) / 2, above)
    height = min(height, size[1] - top - BELOW_BAR)
    if height < LEAST_BAR or size[0] < LEAST_BARS * width:
        return
    left = size[0] - width + MARGIN
    low, high = colouring.limits
    painter.setFont(font)
    painter.setPen(colours.text)
    for k, line in enumerate(reversed(lines)):
        painter.drawText(QPointF(left, top - 16 - k * metrics.height()), line)
    bar = QRectF(left, top, BAR_WIDTH, height)
    shades = table(colouring.colour_map)
    column = np.ascontiguousarray(shades[::-1])
    painter.setPen(Qt.PenStyle.NoPen)
    for beyond, y, sign, colour in (
        (colouring.clipped[1], bar.top(), -1, shades[-1]),
        (colouring.clipped[0], bar.bottom(), 1, shades[0]),
    ):
        if beyond:
            painter.setBrush(QColor(*(int(c) for c in colour)))
            tip = QPointF(bar.center().x(), y + sign * 9)
            painter.drawPolygon(QPolygonF([QPointF(bar.left(), y), QPointF(bar.right(), y), tip]))
    painter.drawImage(bar, QImage(column.data, 1, len(column), 3, QImage.Format.Format_RGB888))
    values, texts = _ticks(colouring, height)
    for value, text in zip(values, texts, strict=True):
        y = bar.bottom() - (value - low) / (high - low) * height
        painter.setPen(QPen(colours.text, 1))
        painter.drawLine(QPointF(bar.right(), y), QPointF(bar.right() + 4, y))
        painter.drawText(QPointF(bar.right() + 8, y + metrics.ascent() / 2 - 1), text)


def paint_outline(painter: QPainter, corners: Sequence[QPointF], colours: OverlayColours, *, closed: bool) -> None:
    """Paint the outline of the region that is being drawn; `closed`: with its last side."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    inside = QColor(colours.accent)
    inside.setAlpha(45)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(inside)
    painter.drawPolygon(QPolygonF(list(corners)))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    draw: Callable[[QPolygonF], None] = painter.drawPolygon if closed else painter.drawPolyline
    for pen in (QPen(colours.ground, 4), QPen(colours.accent, 2)):
        painter.setPen(pen)
        draw(QPolygonF(list(corners)))


def paint_handle(painter: QPainter, at: QPointF, along: QPointF, colours: OverlayColours) -> None:
    """Paint a ring that can be dragged, with strokes along the unit vector `along`."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setBrush(colours.plate)
    for pen in (QPen(colours.ground, 6), QPen(colours.accent, 2.4)):
        painter.setPen(pen)
        for side in (-1, 1):
            painter.drawLine(at + along * (side * HANDLE_PX), at + along * (side * 2 * HANDLE_PX))
        painter.drawEllipse(at, HANDLE_PX, HANDLE_PX)


def paint_marker(painter: QPainter, at: QPointF, text: str, colours: OverlayColours) -> None:
    """Paint a ring around a chosen point, with its coordinates as text."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    for pen in (QPen(colours.ground, 6), QPen(colours.text, 2.4)):
        painter.setPen(pen)
        painter.drawEllipse(at, 8, 8)
    painter.setPen(QPen(colours.ground, 1))
    painter.setBrush(colours.accent)
    painter.drawEllipse(at, 3, 3)
    text_plate(painter, at - QPointF(0, 24), text, colours)


def paint_sentence(painter: QPainter, area: QRectF, text: str, colours: OverlayColours) -> None:
    """Paint a sentence in the middle of an empty view."""
    colour = QColor(colours.text)
    colour.setAlpha(170)
    painter.setPen(colour)
    flags = int(Qt.AlignmentFlag.AlignCenter) | int(Qt.TextFlag.TextWordWrap)
    painter.drawText(area.adjusted(24, 24, -24, -24), flags, text)


def place_text(point: Array) -> str:
    """Write the coordinates of a point (3,) in mm as text."""
    x, y, z = (number(c, ".3f") for c in point)
    return f"{x}   {y}   {z} mm"
