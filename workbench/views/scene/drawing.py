"""When the scene is drawn, and how much of it: something at once while it moves, everything when it is still.

Software OpenGL draws some 25,000 points within a frame, so a cloud of millions would stop the window for seconds.
While the camera moves, a fair part of the scene is drawn, as much as this computer has shown to manage in
`BUDGET_MS`. When nothing has moved for `STILL_MS`, everything is drawn, in passes of the same size, with smooth edges.
A graphics card draws everything at once. Nothing is drawn while nobody sees it.
"""

from __future__ import annotations

import importlib
import logging
import math
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QCoreApplication, QObject, QTimer
from PySide6.QtGui import QPalette

from workbench.views.scene.camera import SceneCamera
from workbench.views.scene.canvas import Canvas, as_lines
from workbench.views.scene.colours import Rgb
from workbench.views.scene.contents import Lines, Scene
from workbench.views.scene.edges import edge_opacity
from workbench.views.scene.passes import Part, Pass, all_parts, quick_pass, size, whole_passes
from workbench.views.scene.ready import SURFACES, Kind, readiness

if TYPE_CHECKING:
    from workbench.views.scene.renderer import Renderer
    from workbench.views.scene.surfaces import EmbeddedSurface, PictureSurface

BUDGET_MS = 22.0
"""For one pass: with what Qt needs to put the window together, 30 pictures a second."""

STILL_MS = 200
"""A pause between two drags of the mouse is shorter."""

GROW_MS = 100
"""A growing cloud is shown no more often."""

FEWEST, MOST, FIRST = 10_000, 50_000_000, 60_000
"""Points and triangles in a pass: at least, at most, and before anything has been measured."""

FEW_PASSES = 12
"""A changed scene of up to so many passes (a quarter of a second) is shown complete; a larger one in part first."""

DOUBT_MS = 5000
"""An OpenGL widget that has shown nothing for so long never will."""

_log = logging.getLogger(__name__)


class Drawing(QObject):
    """Scheduler that draws `scene` as `camera` sees it, and shows the pictures on `canvas`."""

    def __init__(self, scene: Scene, camera: Callable[[], SceneCamera], canvas: Canvas) -> None:
        super().__init__(canvas)
        self._scene, self._camera, self._canvas = scene, camera, canvas
        self._surface: EmbeddedSurface | PictureSurface | None = None
        self.kind: Kind = "none"
        """How the scene is drawn; "none" before anything of OpenGL has been made."""
        self._allowance = float(FIRST)
        self._soon, self._still = self._timer(0, self._draw_part), self._timer(STILL_MS, self._start_whole)
        self._next, self._growth = self._timer(0, self._draw_next), self._timer(GROW_MS, self.moved)
        self._doubt = self._timer(DOUBT_MS, self._give_up)
        self._passes: list[Pass] = []
        self._again = False
        self.point_size = 2.0
        self.complete = False
        """Whether everything is shown as it is."""
        self.moving_elements = 0
        """Points and triangles in the last quick picture."""
        self.pass_ms: list[float] = []
        """How long the last passes took."""
        app = QCoreApplication.instance()
        if app is not None:
            app.aboutToQuit.connect(self.finish)

    def moved(self) -> None:
        """Request a drawing very soon, as the camera moved or the theme changed."""
        self.complete = False
        self._passes = []
        self._canvas.edges = None
        for timer in (self._still, self._next, self._growth):
            timer.stop()
        if self._surface is not None:
            self._surface.fit(self._ground())
        self._soon.start()

    def changed(self) -> None:
        """Request a drawing soon, as the content of the scene changed."""
        self.complete = False
        cost = sum(size(self._scene, part) for part in all_parts(self._scene))
        if self._passes:
            self._again = True  # finish that picture first: a scene that changes all the time is seen, too
        elif self._allowance < cost <= FEW_PASSES * self._allowance:
            self._start_whole()
        else:
            self.moved()

    def grown(self) -> None:
        """Request a drawing of new points when there is time, as the cloud grew."""
        self.complete = False
        if not self._growth.isActive():
            self._growth.start()

    def stop(self) -> None:
        """Stop drawing until the camera moves or the scene changes."""
        for timer in (self._soon, self._still, self._next, self._growth):
            timer.stop()
        self._passes, self._again = [], False

    def finish(self) -> None:
        """End all drawing and release its resources."""
        self.stop()
        self.complete = False
        self._doubt.stop()
        if self._surface is not None:
            self._surface.close()
            self._surface, self.kind = None, "none"

    def whole_picture(self) -> NDArray[np.uint8] | None:
        """Draw the whole scene at once and return its picture (h, w, 3) in device pixels; None without 3D."""
        renderer = self._ready_renderer() if self._canvas.isVisible() else None
        if renderer is not None:
            self.stop()
            for one in whole_passes(self._scene, self._allowance, self._is_made):
                self._draw(renderer, one)
            self.complete = True
            self._show()
            return renderer.pixels()
        if self._scene.empty or readiness().kind not in ("embedded", "pictures"):
            return None
        unseen = importlib.import_module(SURFACES).PictureSurface()
        for one in whole_passes(self._scene, self._allowance, lambda _: True):
            self._draw(unseen.renderer, one)
        pixels: NDArray[np.uint8] = unseen.renderer.pixels()
        unseen.close()
        return pixels

    def _draw_part(self) -> None:
        """As much as there is time for."""
        renderer = self._ready_renderer() if self._canvas.isVisible() else None
        if renderer is None:
            return
        quick = quick_pass(self._scene, self._allowance, self._is_made)
        self.moving_elements = sum(size(self._scene, part) for part in quick.parts)
        self._draw(renderer, quick)
        self._show()
        self.complete = set(quick.parts) == set(all_parts(self._scene)) and not self._scene.has_edges
        if not self.complete:
            self._still.start()

    def _start_whole(self) -> None:
        if self._canvas.isVisible() and self._ready_renderer() is not None:
            self._soon.stop()
            self._still.stop()
            self._again = False
            self._passes = whole_passes(self._scene, self._allowance, self._is_made)
            self._next.start()

    def _draw_next(self) -> None:
        """The next pass of the whole picture."""
        renderer = self._ready_renderer() if self._canvas.isVisible() else None
        if renderer is None or not self._passes:
            self._passes = []
            return
        one = self._passes.pop(0)
        self._draw(renderer, one)
        if not one.last:
            self._next.start()
            return
        self._show()
        self.complete = not self._again
        if self._again:
            self._start_whole()

    def _draw(self, renderer: Renderer, one: Pass) -> None:
        """Draw a pass, and learn from the time it took."""
        fresh = not all(map(self._is_made, one.parts))
        renderer.set_background(self._ground())
        if one.first and self._surface is not None:
            self._surface.fit(self._ground())
        renderer.point_size = self.point_size
        start = time.perf_counter()
        renderer.draw(self._scene, self._camera(), one, self._canvas.device_size, self._canvas.devicePixelRatioF())
        if one.first:
            self._canvas.edges = None
        took = (time.perf_counter() - start) * 1e3
        self.pass_ms = [*self.pass_ms[-199:], took]
        if one.smooth and self._scene.is_mesh_alone:  # the solid is whole now, and nothing else is drawn yet but lines
            self._canvas.edges = as_lines(edge_opacity(renderer.depths(), self._camera(), self._line_px()))
        count = sum(size(self._scene, part) for part in one.parts)
        if not fresh and (took > BUDGET_MS or count >= 0.5 * self._allowance):
            factor = min(max(BUDGET_MS / max(took, 0.1), 0.5), 1.5)
            self._allowance = min(max(self._allowance * factor, FEWEST), MOST)

    def _line_px(self) -> int:
        """Device pixels of the widest lines in the scene; 0 without any."""
        widths = [item.width for item in self._scene.items.values() if isinstance(item, Lines)]
        return math.ceil(max(widths) * self._canvas.devicePixelRatioF()) if widths else 0

    def _is_made(self, part: Part) -> bool:
        return self._surface is not None and self._surface.renderer.is_made(self._scene, part)

    def _ready_renderer(self) -> Renderer | None:
        """What draws; made when there is something to see for the first time, as soon as that can be done."""
        if self._scene.empty:
            return None
        kind = readiness().kind
        if kind is None:
            readiness().find_out()
        if self._surface is None and kind in ("embedded", "pictures"):
            self._make(kind)
        return self._surface.renderer if self._surface is not None and self._surface.ready else None

    def _make(self, kind: Kind) -> None:
        surfaces = importlib.import_module(SURFACES)
        try:
            if kind == "embedded":
                made = surfaces.EmbeddedSurface(self._canvas, self._draw_part)
            else:
                made = surfaces.PictureSurface()
                self._canvas.destroyed.connect(made.close)  # a view within a page is never closed itself
        except Exception:  # noqa: BLE001  whatever the driver does, the program goes on
            _log.exception("the 3D view cannot be made as %s", kind)
            readiness().give_up(kind)
            return
        self._surface, self.kind = made, kind
        made.fit(self._ground())
        self._canvas.embedded = kind == "embedded"
        if not made.ready:
            self._doubt.start()

    def _give_up(self) -> None:
        """A driver that promised OpenGL and shows nothing is not asked again."""
        if self._surface is None or self._surface.ready or not self._canvas.isVisible():
            return
        _log.warning("the 3D view shows nothing as %s", self.kind)
        kind = self.kind
        self.finish()
        readiness().give_up(kind)

    def _ground(self) -> Rgb:
        ground = self._canvas.palette().color(QPalette.ColorRole.Window)
        return ground.red(), ground.green(), ground.blue()

    def _show(self) -> None:
        """Let what was drawn be seen."""
        self._doubt.stop()
        pixels = self._surface.picture() if self._surface is not None else None
        if pixels is not None:
            self._canvas.show_picture(pixels)
        self._canvas.update()

    def _timer(self, interval_ms: int, slot: Callable[[], None]) -> QTimer:
        timer = QTimer(self)
        timer.setSingleShot(True)
        timer.setInterval(interval_ms)
        timer.timeout.connect(slot)
        return timer
