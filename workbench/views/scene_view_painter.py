"""The scene where not even pictures can be rendered: numpy paints points into a depth buffer.

A mesh is painted as points spread over its triangles, shaded by the normals, a line as points along it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPolygonF
from PySide6.QtWidgets import QWidget

from core.model.arrays import Array
from workbench.views.scene_view_camera import SceneCamera
from workbench.views.scene_view_colours import Rgb
from workbench.views.scene_view_contents import MARKS_NEARER, Lines, Marks, Patches, Scene
from workbench.views.scene_view_picture_widget import PictureWidget, image_pixels
from workbench.views.scene_view_pieces import Key, Piece, Version, make, version

LAMP = np.array([-0.30, 0.39, 0.87])
"""Direction to the lamp: right, up, towards the viewer."""

AT_MOST, AT_MOST_MOVING = 60_000, 20_000
"""Points spread over one piece of a mesh, and over the coarse mesh in motion."""

WIDEST, WIDEST_MOVING = 6, 3
"""So many pixels wide they may become where they have to stand for more."""


class PainterSurface:
    """The scene as pictures painted by numpy; see `SceneSurface`."""

    kind = "painter"

    def __init__(self, parent: QWidget, draw_now: Callable[[], None]) -> None:
        self._widget = PictureWidget(parent, draw_now)
        self._background: Rgb = (255, 255, 255)
        self._point_size = 2.0
        self._pieces: dict[Key, tuple[Version | None, Piece]] = {}
        self._canvas = _Canvas((1, 1), self._background)

    @property
    def widget(self) -> QWidget:
        return self._widget

    @property
    def ready(self) -> bool:
        return True

    def set_look(self, background: Rgb, point_size: float) -> None:
        self._background, self._point_size = background, point_size

    def is_made(self, scene: Scene, key: Key) -> bool:
        return key in self._pieces and self._pieces[key][0] == version(scene, key)

    def draw(
        self, scene: Scene, camera: SceneCamera, keys: Iterable[Key], *, first: bool, last: bool, smooth: bool
    ) -> None:
        ratio = self._widget.devicePixelRatioF()
        if first:
            self._canvas = _Canvas(self._widget.device_size, self._background)
            self._pieces = {key: held for key, held in self._pieces.items() if self.is_made(scene, key)}
            for item in scene.items.values():
                if isinstance(item, Lines):
                    self._canvas.draw_lines(camera, item, ratio)
        for key in keys:
            if not self.is_made(scene, key):
                self._pieces[key] = version(scene, key), make(scene, key)
            piece = self._pieces[key][1]
            if piece.triangles is None:
                self._canvas.splat(camera, piece.points, piece.colours, self._point_size * ratio)
            else:
                self._canvas.draw_mesh(camera, piece, moving=key.kind == "coarse")
        if last:
            for item in scene.items.values():
                if isinstance(item, Marks):
                    colours = np.tile(np.array(item.colour, dtype=np.uint8), (len(item.points), 1))
                    self._canvas.splat(camera, item.points, colours, item.size * ratio, nearer=MARKS_NEARER)
            self._widget.show_pixels(_with_patches(self._canvas, camera, scene))

    def pixels(self) -> NDArray[np.uint8]:
        return self._widget.pixels

    def finish(self) -> None:
        self._pieces = {}
        self._widget.setParent(None)
        self._widget.deleteLater()


class _Canvas:
    """Colours and depths of one picture."""

    def __init__(self, size: tuple[int, int], background: Rgb) -> None:
        self.size = size
        self.colours = np.empty((size[1] * size[0], 3), dtype=np.uint8)
        self.colours[:] = background
        self._depths = np.full(size[1] * size[0], np.inf, dtype=np.float32)

    def splat(
        self,
        camera: SceneCamera,
        points: Array | NDArray[np.float32],
        colours: NDArray[np.uint8],
        width: float,
        nearer: float = 0.0,
    ) -> None:
        """Each point as a square of `width` pixels; the nearest wins."""
        screen, depth = camera.project(points, self.size)
        columns, rows = self.size
        with np.errstate(invalid="ignore"):
            seen = np.flatnonzero(
                (depth > 0) & (screen > -10).all(axis=1) & (screen < np.array(self.size) + 10).all(axis=1)
            )
        order = seen[np.argsort(-depth[seen])]  # of equal pixels the one written last stays: the nearest
        side = max(round(width), 1)
        left, top = np.floor(screen[order] - (side - 1) / 2).astype(np.int64).T
        depth = (depth[order] * (1 - nearer)).astype(np.float32)
        colours = colours[order]
        for dy in range(side):
            for dx in range(side):
                x, y = left + dx, top + dy
                inside = np.flatnonzero((x >= 0) & (x < columns) & (y >= 0) & (y < rows))
                pixel = y[inside] * columns + x[inside]
                wins = depth[inside] < self._depths[pixel]
                self._depths[pixel[wins]] = depth[inside][wins]
                self.colours[pixel[wins]] = colours[inside][wins]

    def draw_lines(self, camera: SceneCamera, lines: Lines, ratio: float) -> None:
        """Points along lines, one a pixel."""
        for line, colour in zip(lines.lines, lines.colours, strict=True):
            screen, _ = camera.project(line, self.size)
            steps = np.nan_to_num(np.abs(np.diff(screen, axis=0)).max(axis=1), nan=100.0) if len(line) > 1 else []
            dense = [line[:1]]
            for a, b, step in zip(line[:-1], line[1:], steps, strict=True):
                t = np.linspace(0, 1, int(np.clip(step, 2, 4000)) + 1)[1:, None]
                dense.append(a + (b - a) * t)
            points = np.vstack(dense)
            self.splat(
                camera,
                points,
                np.tile(np.array(colour, dtype=np.uint8), (len(points), 1)),
                lines.width * ratio,
                nearer=MARKS_NEARER,
            )

    def draw_mesh(self, camera: SceneCamera, piece: Piece, *, moving: bool) -> None:
        """Points spread over triangles, two a pixel or wider ones."""
        assert piece.triangles is not None and piece.normals is not None
        if not len(piece.triangles):
            return
        most, widest = (AT_MOST_MOVING, WIDEST_MOVING) if moving else (AT_MOST, WIDEST)
        screen, _ = camera.project(piece.points, self.size)
        a, b, c = (screen[piece.triangles[:, i]] for i in range(3))
        area = np.abs((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])) / 2
        seen = float(self.size[0] * self.size[1])
        wanted = 1 + 2 * np.clip(np.nan_to_num(area), 0, seen)
        width = int(np.clip(np.ceil(np.sqrt(min(wanted.sum(), 2 * seen) / most)), 1, widest))
        count = np.ceil(wanted * min(1.0, most / wanted.sum())).astype(np.int64)
        of = np.repeat(np.arange(len(count)), count)
        t = np.arange(len(of), dtype=np.float32)
        u, v = (0.7548777 * t) % 1, (0.5698403 * t) % 1  # Roberts' R2 sequence
        over = u + v > 1
        u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
        weights = np.column_stack([1 - u - v, u, v])[:, :, None]
        corners = piece.triangles[of]
        points = (piece.points[corners] * weights).sum(axis=1)
        shade = 0.3 + 0.7 * np.abs(piece.normals @ (LAMP @ camera.axes))
        lit = piece.colours * shade[:, None]
        self.splat(camera, points, (lit[corners] * weights).sum(axis=1).clip(0, 255).astype(np.uint8), width)


def _with_patches(canvas: _Canvas, camera: SceneCamera, scene: Scene) -> NDArray[np.uint8]:
    """The picture with transparent patches over everything: their place in depth is not looked at."""
    width, height = canvas.size
    patches = scene.of_kind(Patches)
    if not patches:
        return canvas.colours.reshape(height, width, 3).copy()
    image = QImage(canvas.colours.tobytes(), width, height, 3 * width, QImage.Format.Format_RGB888)
    image = image.convertToFormat(QImage.Format.Format_RGB32)
    painter = QPainter(image)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(Qt.PenStyle.NoPen)
    for item in patches:
        assert isinstance(item, Patches)
        for corners, colour in zip(item.corners, item.colours, strict=True):
            screen, depth = camera.project(corners, canvas.size)
            if (depth > 0).all():
                painter.setBrush(QColor(*colour, round(255 * item.opacity)))
                painter.drawPolygon(QPolygonF([QPointF(float(x), float(y)) for x, y in screen]))
    painter.end()
    return image_pixels(image)
