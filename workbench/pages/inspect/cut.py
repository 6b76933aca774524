"""A plane laid through the surface by hand: where it is, what it shows, and how it becomes a cross-section."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, Signal

from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.shown.cut_plane import UPRIGHT, CutPlane, turned_for
from core.inspect.shown.shown_features import ShownProfile
from core.inspect.shown.view_frame import ViewFrame
from core.model.arrays import Array
from workbench.language import tr
from workbench.pages.inspect.features.plan import InspectFeatures
from workbench.pages.inspect.scan import InspectScan

SECTION = "section"
"""The kind of feature that measures it."""


class InspectCut(QObject):
    """Cutting plane in the frame of the view; it is no edit before `keep`."""

    changed = Signal()

    hides: int
    """The side of the plane that is hidden: 1 that of larger coordinates, −1 that of smaller ones, 0 none."""

    def __init__(self, features: InspectFeatures, scan: InspectScan, frame: Callable[[], ViewFrame]) -> None:
        super().__init__()
        self._features, self._scan, self._frame = features, scan, frame
        self._on, self._axis, self.hides = False, 0, 0
        self.turned_deg = self.tilted_deg = 0.0
        """How far it is turned and tilted out of being square to its axis."""
        self._plane: CutPlane | None = None
        self._points: Array | None = None
        self._coordinates: Array = np.empty((0, 3))

    @property
    def plane(self) -> CutPlane | None:
        """Cutting plane through the surface; None if none is shown."""
        view = self._scan.view
        if not self._on or view is None or not len(view):
            return None
        frame = turned_for(self._frame(), self._axis, self.turned_deg, self.tilted_deg)
        if self._plane is not None and self._points is view.points and frame.same_as(self._plane.frame):
            return self._plane
        before, self._points, self._coordinates = self._plane, view.points, frame.coordinates(view.points)
        if before is not None and before.frame.kind is frame.kind:
            self._plane = replace(before, frame=frame, at_mm=self._within_reach(before.at_mm))
        else:
            part = slice(None) if view.gauge is None else view.gauge.upper.indices
            middle = float(np.median(self._coordinates[part, self._axis]))
            if self._axis >= UPRIGHT:  # not on the face that most points lie on
                middle = float(np.mean(np.quantile(self._coordinates[:, self._axis], [0.01, 0.99])))
            self._plane = CutPlane(frame, self._axis, middle)
        return self._plane

    @property
    def reach(self) -> tuple[float, float]:
        """Smallest and largest coordinate in mm that the cutting plane can have."""
        along = self._coordinates[:, self._axis]
        return float(along.min()), float(along.max())

    def corners(self) -> Array:
        """Return the corners (4, 3) of the cutting plane in mm in the camera frame."""
        assert self.plane is not None
        return self.plane.corners(self._coordinates)

    def profile(self, count: int) -> ShownProfile:
        """Compute the profile of the first `count` points in the cutting plane."""
        assert self.plane is not None
        return self.plane.profile(self._coordinates[:count])

    def count_shown(self, points: Array, triangles: NDArray[np.integer] | None = None) -> int:
        """Count the `points` (N, 3) in mm in the camera frame that the cutting plane does not hide.

        With `triangles`, indices (M, 3) of points: how many of these it does not hide whole.
        """
        clip = self.clip
        if clip is None:
            return len(points if triangles is None else triangles)
        place, away = clip
        seen = points @ away <= place @ away
        return int(np.count_nonzero(seen if triangles is None else seen[triangles].any(axis=1)))

    def show(self, shown: bool) -> None:
        """Show the cutting plane, or, with False, remove it."""
        if shown != self._on:
            self._on, self._plane = shown, None
            self.turned_deg = self.tilted_deg = 0.0
            self.changed.emit()

    @property
    def clip(self) -> tuple[Array, Array] | None:
        """Place (3,) on the cutting plane and unit vector (3,) to its hidden side; None if nothing is hidden."""
        plane = self.plane
        if plane is None or not self.hides:
            return None
        return self.corners()[0], self.hides * plane.normal

    def hide(self, side: int) -> None:
        """Hide the surface on one side of the cutting plane (1 or −1), or, with 0, nothing."""
        if side != self.hides:
            self.hides = side
            self.changed.emit()

    def square_to(self, axis: int) -> None:
        """Turn the cutting plane square to axis number `axis`, through the middle of the part."""
        if axis != self._axis:
            self._axis, self._plane = axis, None
            self.turned_deg = self.tilted_deg = 0.0
            self.changed.emit()

    def turn_to(self, turned_deg: float, tilted_deg: float) -> None:
        """Turn and tilt the cutting plane, about its own middle, to two angles in degrees."""
        if self.plane is None or (turned_deg, tilted_deg) == (self.turned_deg, self.tilted_deg):
            return
        middle = self.corners().mean(axis=0)
        self.turned_deg, self.tilted_deg = turned_deg, tilted_deg
        plane = self.plane
        self._plane = replace(plane, at_mm=self._within_reach(float(plane.frame.coordinates(middle)[self._axis])))
        self.changed.emit()

    def move_to(self, at_mm: float) -> None:
        """Move the cutting plane to a coordinate in mm, as far as the points reach."""
        plane = self.plane
        if plane is not None:
            self._plane = replace(plane, at_mm=self._within_reach(at_mm))
            self.changed.emit()

    def pull(self, by_mm: float) -> None:
        """Move the cutting plane by `by_mm` along its axis."""
        if self.plane is not None:
            self.move_to(self.plane.at_mm + by_mm)

    def _within_reach(self, at_mm: float) -> float:
        low, high = self.reach
        return min(max(at_mm, low), high)

    @property
    def cannot_keep(self) -> str:
        """Reason why the cutting plane cannot become a feature of the plan now; "" if it can."""
        if self._axis >= UPRIGHT:
            return tr("A cut square to z is to look at: cross-sections that are measured stand upright.")
        if self.tilted_deg:
            return tr("A tilted cut is to look at: cross-sections that are measured stand upright.")
        if self._features.plan.frame is not None and self._features.pose_camera_part is None:
            return tr("Measure the features first: the plan's part coordinates are not known.")
        return ""

    def keep(self) -> None:
        """Add the cutting plane to the plan as a cross-section; one edit, undoable."""
        plane, features = self.plane, self._features
        if plane is not None and not self.cannot_keep:
            section = plane.section(features.pose_camera_part)
            features.put(FeatureSpec(features.free_name(SECTION), SECTION, section=section))
