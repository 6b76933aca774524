"""Points picked in 3D and distances between them: marks on what is shown, nothing of the project."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from PySide6.QtCore import QObject, Signal

from core.inspect.distance import PointDistance, point_distance
from core.model.arrays import Array
from workbench.language import tr
from workbench.pages.inspect.scan import InspectScan

Mode = Literal["", "point", "distance"]


@dataclass(frozen=True, eq=False, slots=True)
class Pick:
    """Picked point: place (3,) in mm, σ of its depth in mm, the frame and pixel it was seen at."""

    name: str
    point: int
    place: Array
    sigma_mm: float
    frame: str
    uv: tuple[float, float]


@dataclass(frozen=True, eq=False, slots=True)
class Span:
    """Distance of two picked points."""

    name: str
    a: Pick
    b: Pick
    result: PointDistance


class InspectPicks(QObject):
    """List of picked points and distances."""

    changed = Signal()

    def __init__(self, scan: InspectScan) -> None:
        super().__init__()
        self._scan = scan
        self.mode: Mode = ""
        self.first: Pick | None = None
        self.items: list[Pick | Span] = []
        self._numbers = {"P": 0, "D": 0}

    def start(self, mode: Mode) -> None:
        """Start picking a point, or the ends of a distance, by clicks in 3D; the mode "" ends it."""
        if mode != self.mode:
            self.mode, self.first = mode, None
            self.changed.emit()

    def stop(self) -> None:
        """End picking; points and distances stay in the list."""
        self.start("")

    def pick(self, point: int) -> None:
        """Pick point number `point` of the view: into the list, or as one end of a distance."""
        view = self._scan.view
        if view is None or not self.mode or not 0 <= point < len(view):
            return
        if self.mode == "point":
            self.items.append(self._picked(point, self._next("P")))
        elif self.first is None:
            self.first = self._picked(point, "")
        elif self.first.point == point:
            return  # a double click
        else:
            a, b = self.first, self._picked(point, "")
            result = point_distance(a.place, b.place, a.sigma_mm, b.sigma_mm)
            self.items.append(Span(self._next("D"), a, b, result))
            self.first = None
        self.changed.emit()

    def remove(self, name: str) -> None:
        """Remove the point or distance called `name` from the list."""
        self.items = [item for item in self.items if item.name != name]
        self.changed.emit()

    def clear(self) -> None:
        """Remove all points and distances from the list."""
        if self.items or self.first is not None or self.mode:
            self.items, self.first, self.mode = [], None, ""
            self._numbers = {"P": 0, "D": 0}
            self.changed.emit()

    def hint(self) -> str:
        """Write what the next click picks."""
        if self.mode == "point":
            return tr("Click points of the surface; each is added to the list.")
        if self.mode == "distance":
            if self.first is None:
                return tr("Click the first end of the distance.")
            return tr("Click the second end of the distance.")
        return ""

    def _picked(self, point: int, name: str) -> Pick:
        view = self._scan.view
        assert view is not None
        u, v = (float(value) for value in view.uv[point])
        return Pick(name, point, view.points[point], float(view.sigma[point]), view.frame_name(point), (u, v))

    def _next(self, letter: str) -> str:
        self._numbers[letter] += 1
        return f"{letter}{self._numbers[letter]}"
