"""What else the middle of the laser planes page shows: the rig in 3D, and the history."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from PySide6.QtWidgets import QWidget

from core.calibrate.results import FanCalibration, PlanePose
from core.model import Camera
from core.report.facts.of_kept import stored_planes
from core.report.facts.table import FactTable
from workbench.language import tr
from workbench.pages.calibration.history_tab import HistoryTab
from workbench.pages.planes import words
from workbench.pages.planes.presenter import PlanesPresenter
from workbench.views.colours import EXCLUDED, fan_colour
from workbench.views.layouts import in_column
from workbench.views.scene import shapes as scene_shapes
from workbench.views.scene.view import SceneView

NEAR, FAR = 0.85, 1.15
"""The planes are drawn from a little before the nearest pose to a little behind the farthest."""

SHOWN = 30
"""A stripe is a straight line: so many of its points, a few more at most, are drawn."""

TARGET, CHOSEN = "#7FB3D5", "#F2C14E"


class RigTab(QWidget):
    """Tab with camera, light planes, target poses and their stripes in 3D; the chosen pose is marked."""

    def __init__(self, presenter: PlanesPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._drawn: tuple[Any, Any] = (None, None)
        self._chosen = ""
        self.scene = SceneView()
        self.scene.notice.connect(presenter.bench.notices.info)
        in_column(self.scene, on=self, margins=(6, 6, 6, 6))
        self._empty()

    def refresh(self) -> None:
        """Draw camera, light planes and poses of the calibration shown in 3D, the chosen pose marked."""
        calibration, camera = self._presenter.work.calibration, self._presenter.seen_by.camera
        if calibration is None or camera is None:
            if self._drawn != (None, None):
                self._empty()
            return
        if calibration is not self._drawn[0] or camera is not self._drawn[1]:
            first = self._drawn == (None, None)
            self._drawn, self._chosen = (calibration, camera), ""
            self._draw(calibration, camera)
            if first:
                self.scene.view("iso")
            self.scene.fit()
        if self._presenter.current != self._chosen:
            self._chosen = self._presenter.current
            chosen = [line for pose, line in self._outlines(calibration) if pose.name == self._chosen]
            self.scene.set_polylines("chosen", chosen, [CHOSEN] * len(chosen), 4.0)

    def _empty(self) -> None:
        self._drawn, self._chosen = (None, None), ""
        self.scene.clear(tr("Calibrate the laser planes: then camera, planes and poses are drawn here."))

    def _draw(self, calibration: FanCalibration, camera: Camera) -> None:
        outlines = self._outlines(calibration)
        depths = [float(pose.pose.translation[2]) for pose, _ in outlines] or [500.0]
        near, far = NEAR * min(depths), FAR * max(depths)
        planes = calibration.fan.planes
        self.scene.set_camera_frustum(scene_shapes.frustum(camera, 0.2 * near))
        self.scene.set_planes(
            "planes",
            [scene_shapes.plane_patch(plane, camera, (near, far)) for plane in planes],
            [fan_colour(line) for line in range(1, len(planes) + 1)],
        )
        colours = [TARGET if pose.used else EXCLUDED for pose, _ in outlines]
        self.scene.set_polylines("targets", [line for _, line in outlines], colours, 1.5)
        stripes = [
            (points[:: max(len(points) // SHOWN, 1)], line)
            for pose, _ in outlines
            for line, points in enumerate(pose.points, start=1)
            if len(points) and pose.used
        ]
        self.scene.set_polylines("stripes", [p for p, _ in stripes], [fan_colour(line) for _, line in stripes], 2.5)
        names = words.short_names([pose.name for pose, _ in outlines])
        self.scene.set_labels("poses", [(line[0], name) for (_, line), name in zip(outlines, names, strict=True)])

    def _outlines(self, calibration: FanCalibration) -> list[tuple[PlanePose, Any]]:
        """The poses that could be located, each with the rectangle around its target."""
        seen = {pose.name: pose.view for pose in self._presenter.work.poses or () if pose.view is not None}
        return [
            (pose, scene_shapes.target_outline(pose.pose, seen[pose.name].points))
            for pose in calibration.poses
            if pose.name in seen and pose.pose.translation[2] > 0
        ]


class PlanesHistoryTab(HistoryTab):
    """Tab with the laser planes accepted before."""

    def _listed(self, entries: Sequence[Any], in_use: str) -> FactTable:
        return stored_planes(entries, in_use)

    def _tip(self) -> str:
        return tr("Measure with these laser planes again; undoable")
