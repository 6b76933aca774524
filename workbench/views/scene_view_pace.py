"""When the scene is drawn, and how much of it: something at once while it moves, everything when it is still.

Nothing here takes longer than a fraction of a frame. While the camera moves, a fair part of the points is drawn, as
many as the computer has shown to manage in `BUDGET_MS`. When nothing has moved for `STILL_MS`, everything is drawn,
in passes of the same size, and shown with smooth edges when it is complete. A growing cloud is drawn over what is
there. Nothing is drawn while nobody sees it.
"""

from __future__ import annotations

import time
from collections.abc import Callable

from PySide6.QtCore import QObject, QTimer, Signal

from workbench.views.scene_view_camera import SceneCamera
from workbench.views.scene_view_contents import Lines, Patches, Scene
from workbench.views.scene_view_pieces import Key, Version, elements, fair_part, version, whole
from workbench.views.scene_view_surface import SceneSurface

BUDGET_MS = 22.0
"""For one pass. What Qt needs to put the window together comes on top."""

STILL_MS = 200
GROW_MS = 100
"""A growing cloud is shown no more often."""

FRESH = 3
"""So many pieces may be gathered and sent to the graphics card in one pass."""

FEWEST, MOST, FIRST = 10_000, 50_000_000, 60_000
"""Points and triangles in a pass: at least, at most, and before anything has been measured."""

SOON_ENOUGH = 12
"""A changed scene of up to so many passes is shown complete; a larger one in part first."""


class ScenePace(QObject):
    """Draws `scene` on `surface` from where `camera` says."""

    presented = Signal()

    def __init__(
        self, scene: Scene, surface: SceneSurface, camera: Callable[[], SceneCamera], parent: QObject | None = None
    ) -> None:
        super().__init__(parent)
        self._scene, self._surface, self._camera = scene, surface, camera
        self._allowance = float(FIRST)
        self._soon, self._still = single_shot(self, 0, self.draw_now), single_shot(self, STILL_MS, self._start_whole)
        self._next, self._growth = single_shot(self, 0, self._step), single_shot(self, GROW_MS, self._grow)
        self._left: list[Key] = []
        self._first = self._again = False
        self._drawn: dict[Key, Version | None] = {}
        self._complete = False
        self.moving_elements = 0
        self.pass_ms: list[float] = []

    @property
    def complete(self) -> bool:
        """Whether everything is shown as it is."""
        return self._complete and not self._stale()

    def moved(self) -> None:
        """The camera moved: show something very soon."""
        self._complete = False
        self._stop_whole()
        self._still.stop()
        if self._can_draw() and not self._soon.isActive():
            self._soon.start()

    def changed(self) -> None:
        """The scene changed: show it soon."""
        total = sum(elements(self._scene, key) for key in whole(self._scene))
        if self._allowance < total <= SOON_ENOUGH * self._allowance and not self._soon.isActive():
            if self._next.isActive() and not self._first:
                self._again = True  # finish that picture first: a scene that changes all the time is seen, too
            else:
                self._still.stop()
                self._start_whole()
            return
        self.moved()

    def grown(self) -> None:
        """The cloud grew: show the new points, some time soon."""
        if self._can_draw() and not self._growth.isActive():
            self._growth.start()

    def draw_now(self) -> None:
        """Draw as much as there is time for, and everything, with smooth edges, when it is still."""
        if not self._can_draw():
            return
        self._soon.stop()
        self._stop_whole()
        keys = self._affordable(fair_part(self._scene, int(self._allowance)))
        self.moving_elements = sum(elements(self._scene, key) for key in keys)
        self._draw(keys, first=True, last=True)
        self._complete = set(keys) == set(whole(self._scene))
        if not self._complete or self._has_edges():
            self._still.start()
        self.presented.emit()

    def finish_now(self) -> None:
        """Draw everything at once, however long it takes."""
        if not self._can_draw():
            return
        self._soon.stop()
        self._still.stop()
        self._start_whole()
        while self._left or self._first:
            self._step()
        self._next.stop()

    def stop(self) -> None:
        """Draw no more, until something moves or changes."""
        for timer in (self._soon, self._still, self._next, self._growth):
            timer.stop()
        self._left, self._first = [], False

    # ---- the whole picture, in passes

    def _start_whole(self) -> None:
        if not self._can_draw():
            return
        self._left, self._first, self._complete, self._again = whole(self._scene), True, False, False
        self._next.start()

    def _step(self) -> None:
        if not self._can_draw() or not (self._left or self._first):
            self._stop_whole()
            return
        batch = self._next_batch()
        solid = all(key.kind != "cloud" for key in batch)
        last = not self._left
        smooth = solid and self._has_edges() and (last or self._left[0].kind == "cloud")
        self._draw(batch, first=self._first, last=last, smooth=smooth)
        self._first = False
        if not last:
            self._next.start()
            return
        self._complete = True
        self.presented.emit()
        if self._again:
            self._start_whole()
        elif self._stale():
            self.grown()

    def _next_batch(self) -> list[Key]:
        """Take from what is left as much as there is time for, and never cloud and mesh together.

        Lines go with the mesh, or alone before the cloud: their edges are smoothed, a cloud's points are not.
        """
        self._left = [key for key in self._left if version(self._scene, key) is not None]
        if self._first and self._has_edges() and self._left and self._left[0].kind == "cloud":
            return []
        batch: list[Key] = []
        size = fresh = 0
        for key in self._left:
            new = not self._surface.is_made(self._scene, key)
            if batch and (size >= self._allowance or fresh + new > FRESH or key.kind != batch[0].kind):
                break
            batch.append(key)
            size += elements(self._scene, key)
            fresh += new
        self._left = self._left[len(batch) :]
        return batch

    def _has_edges(self) -> bool:
        return self._scene.visible_mesh is not None or bool(self._scene.of_kind(Lines))

    def _stop_whole(self) -> None:
        self._next.stop()
        self._left, self._first, self._again = [], False, False

    # ---- growing

    def _grow(self) -> None:
        if not self._can_draw() or self._soon.isActive() or self._still.isActive() or self._next.isActive():
            return  # what is on its way will hold the new points
        stale = self._stale()
        if not stale and self._complete:
            return
        seen_before = all(_same(self._drawn.get(key), version(self._scene, key)) for key in self._drawn)
        if not self._complete or not seen_before or self._scene.of_kind(Patches):
            self.changed()
            return
        keys = self._affordable(stale)
        self._draw(keys, first=False, last=True)
        self.presented.emit()
        if self._stale():
            self._growth.start()

    def _stale(self) -> list[Key]:
        """Pieces that are not in the picture as they are in the scene."""
        return [key for key in whole(self._scene) if self._drawn.get(key) != version(self._scene, key)]

    # ---- one pass

    def _affordable(self, keys: list[Key]) -> list[Key]:
        """Without those there is no time to gather now."""
        fresh = [key for key in keys if not self._surface.is_made(self._scene, key)]
        dropped = set(fresh[FRESH:])
        return [key for key in keys if key not in dropped]

    def _draw(self, keys: list[Key], *, first: bool, last: bool, smooth: bool = False) -> None:
        """Draw a pass, and learn from the time it took."""
        if first:
            self._drawn = {}
        fresh = any(not self._surface.is_made(self._scene, key) for key in keys)
        start = time.perf_counter()
        self._surface.draw(self._scene, self._camera(), keys, first=first, last=last, smooth=smooth)
        took = (time.perf_counter() - start) * 1e3
        self._drawn.update({key: version(self._scene, key) for key in keys})
        self.pass_ms = [*self.pass_ms[-199:], took]
        if not fresh:
            self._learn(took, sum(elements(self._scene, key) for key in keys))

    def _learn(self, took: float, count: int) -> None:
        """Draw more or less next time, if that is what took the time."""
        if took > BUDGET_MS or count >= 0.5 * self._allowance:
            factor = min(max(BUDGET_MS / max(took, 0.1), 0.5), 1.5)
            self._allowance = min(max(self._allowance * factor, FEWEST), MOST)

    def _can_draw(self) -> bool:
        widget = self._surface.widget
        return self._surface.ready and widget.isVisible() and widget.width() > 1 and widget.height() > 1


def single_shot(owner: QObject, interval_ms: int, slot: Callable[[], None]) -> QTimer:
    """A timer of `owner` that calls once for each start."""
    timer = QTimer(owner)
    timer.setSingleShot(True)
    timer.setInterval(interval_ms)
    timer.timeout.connect(slot)
    return timer


def _same(drawn: Version | None, current: Version | None) -> bool:
    """Whether a piece only grew."""
    return drawn is not None and current is not None and drawn[:2] == current[:2]
