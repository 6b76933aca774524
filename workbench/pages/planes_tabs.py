"""What the middle of the laser planes page shows: one pose or the live picture, the rig in 3D, the history."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from core.live.events import LiveView, PlanesDetail
from workbench.pages import planes_words as words
from workbench.pages.planes_presenter import PlanesPresenter
from workbench.theme import icon
from workbench.views import scene_shapes
from workbench.views.colours import CORNER, EXCLUDED, fan_colour
from workbench.views.image_view import ImageView
from workbench.views.meters import HintBar
from workbench.views.scene_view import SceneView
from workbench.views.tables import DataTable

NEAR, FAR = 0.85, 1.15
"""The planes are drawn from a little before the nearest pose to a little behind the farthest."""


class PoseTab(QWidget):
    """One pose with corners, stripes and line numbers, or the live picture."""

    def __init__(self, presenter: PlanesPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._name = ""
        self.image, self.line, self.hints = ImageView(), QLabel(), HintBar()
        self.line.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.line.setWordWrap(True)
        column = QVBoxLayout(self)
        column.setContentsMargins(6, 6, 6, 6)
        column.addWidget(self.line)
        column.addWidget(self.image, 1)
        column.addWidget(self.hints)
        presenter.pose_ready.connect(self._show_pose)
        presenter.live.view.connect(self._show_live)
        presenter.live.started.connect(lambda _: self.image.clear_layers())
        self._empty()

    def refresh(self) -> None:
        """Show what the presenter says now."""
        p, live = self._presenter, self._presenter.live.running
        self.hints.setVisible(live)
        if live:
            if not p.live.live:
                self.line.setText(p.live.state_text())
            return
        if self._name == "live":
            self._name = ""
            self.image.clear_layers()
            p.look_again()
        if not p.current or p.features_of(p.current) is None:
            self._empty()
            return
        features = p.features_of(p.current)
        notes = " ".join(features.notes) if features is not None else ""
        reason = features.reason if features is not None else ""
        self.line.setText(f"{words.pose_sentence(p.current, p.pose_of(p.current), reason)} {notes}".strip())

    def _empty(self) -> None:
        if self._name:
            self.image.clear_layers()
        self._name = ""
        self.line.setText("")
        waiting = bool(self._presenter.work.pictures)
        self.image.clear(
            self.tr("Press Calibrate to measure the pictures.")
            if waiting
            else self.tr(
                "Choose a folder of pictures of the plate under the laser at the right, or drop one here; "
                "or start a live source."
            )
        )

    def _show_pose(self, stages: Any) -> None:
        if self._presenter.live.running:
            return
        self.image.clear_layers()
        self.image.set_picture(stages.picture)
        self._name = stages.name
        if len(stages.corners):
            self.image.set_points(
                "corners", stages.corners, colour=CORNER.colour, symbol=CORNER.symbol, size=10, title=self.tr("target")
            )
        self._draw_stripes([(stripe.uv, stripe.line) for stripe in stages.stripes])

    def _draw_stripes(self, stripes: list[tuple[Any, int]]) -> None:
        """One layer a fan line, with its number at its start; what no line drew is grey."""
        for line in sorted({line for _, line in stripes}):
            mine = [uv for uv, of in stripes if of == line]
            name = self.tr("line {0}").format(line + 1) if line >= 0 else self.tr("no line of the fan")
            colour = fan_colour(line + 1) if line >= 0 else EXCLUDED
            labels = [str(line + 1)] * len(mine) if line >= 0 else None
            self.image.set_lines(f"stripe {line}", mine, colour=colour, width=2.0, labels=labels, title=name)

    def _show_live(self, view: LiveView) -> None:
        try:
            self._draw_live(view)
        finally:
            self._presenter.live.shown()

    def _draw_live(self, view: LiveView) -> None:
        live = self._presenter.live
        if not live.running:
            return
        if self._name != "live":
            self.image.clear_layers()
            self._name = "live"
        self.image.set_picture(view.picture, scale=view.scale)
        self.line.setText(f"{live.state_text()}   {live.counts_text()}")
        detail = view.detail
        if not isinstance(detail, PlanesDetail):
            self.hints.set_hints([self.tr("Looking for the plate …")])
            return
        self.image.set_cells("covered", detail.cells, title=self.tr("covered by poses taken"))
        if detail.uv is None:
            self.image.remove_layer("corners")
        else:
            self.image.set_points(
                "corners", detail.uv, colour=CORNER.colour, symbol=CORNER.symbol, size=10, title=self.tr("target")
            )
        for name in self.image.layer_names():
            if name.startswith("stripe"):
                self.image.remove_layer(name)
        self._draw_stripes(list(zip(detail.stripes, detail.line, strict=True)))
        self.hints.set_hints([sentence for sentence in (detail.sentence, *detail.missing[:2]) if sentence])


class RigTab(QWidget):
    """Camera, light planes, target poses and the stripes on them, in 3D."""

    def __init__(self, presenter: PlanesPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._drawn: Any = None
        self.scene = SceneView()
        self.scene.notice.connect(presenter.bench.notices.info)
        column = QVBoxLayout(self)
        column.setContentsMargins(6, 6, 6, 6)
        column.addWidget(self.scene)
        self.scene.clear(self.tr("Calibrate the laser planes: then camera, planes and poses are drawn here."))

    def refresh(self) -> None:
        """Draw the calibration that is shown."""
        calibration, camera = self._presenter.work.calibration, self._presenter.camera
        if (calibration, camera) == self._drawn:
            return
        self._drawn = (calibration, camera)
        if calibration is None or camera is None:
            self.scene.clear(self.tr("Calibrate the laser planes: then camera, planes and poses are drawn here."))
            return
        poses = [pose for pose in calibration.poses if any(len(points) for points in pose.points)]
        depths = [float(pose.pose.translation[2]) for pose in poses] or [500.0]
        near, far = NEAR * min(depths), FAR * max(depths)
        planes = calibration.fan.planes
        colours = [fan_colour(line) for line in range(1, len(planes) + 1)]
        self.scene.set_camera_frustum(scene_shapes.frustum(camera, 0.2 * near))
        self.scene.set_planes(
            "planes", [scene_shapes.plane_patch(plane, camera, (near, far)) for plane in planes], colours
        )
        views = {pose.name: pose.view for pose in self._presenter.work.poses or ()}
        outlines = [
            (scene_shapes.target_outline(pose.pose, view.points), pose.used)
            for pose in poses
            for view in [views.get(pose.name)]
            if view is not None
        ]
        self.scene.set_polylines(
            "targets", [line for line, _ in outlines], ["#7FB3D5" if used else EXCLUDED for _, used in outlines], 1.5
        )
        stripes = [(points, line) for pose in poses for line, points in enumerate(pose.points, start=1) if len(points)]
        self.scene.set_polylines("stripes", [p for p, _ in stripes], [fan_colour(line) for _, line in stripes], 2.5)
        self.scene.set_labels("poses", [(pose.pose.translation, pose.name) for pose in poses])
        self.scene.view("iso")
        self.scene.fit()


class HistoryTab(QWidget):
    """Laser planes accepted before; any can be restored."""

    def __init__(self, presenter: PlanesPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._row = -1
        self.table, self.restore = DataTable(), QPushButton(self.tr("Restore"))
        self.table.set_headers(
            [
                (self.tr("Accepted"), ""),
                (self.tr("RMS of each line"), "mm"),
                (self.tr("Poses"), ""),
                (self.tr("Id"), ""),
                (self.tr("Camera"), ""),
                ("", ""),
            ]
        )
        self.table.current_row_changed.connect(self._chosen)
        self.restore.clicked.connect(lambda: presenter.restore(self._id()))
        row = QHBoxLayout()
        row.addStretch(1)
        row.addWidget(self.restore)
        column = QVBoxLayout(self)
        column.setContentsMargins(6, 6, 6, 6)
        column.addWidget(self.table, 1)
        column.addLayout(row)

    def refresh(self) -> None:
        """Show the list."""
        p = self._presenter
        self.table.set_rows(words.history_rows(p.history, p.project.accepted.fan))
        self._refresh_button()

    def _chosen(self, row: int) -> None:
        self._row = row
        self._refresh_button()

    def _refresh_button(self) -> None:
        p, id_ = self._presenter, self._id()
        entry = next((entry for entry in p.history if entry.id == id_), None)
        why = ""
        if entry is None:
            why = self.tr("Choose a calibration in the list first.")
        elif id_ == p.project.accepted.fan:
            why = self.tr("These laser planes are accepted already.")
        elif entry.camera_id != p.project.accepted.camera:
            why = self.tr("They rest on another camera calibration; restore that one first.")
        self.restore.setEnabled(not why)
        self.restore.setIcon(icon("mdi6.restore"))
        self.restore.setToolTip(why or self.tr("Measure with these laser planes again; undoable"))

    def _id(self) -> str:
        history = self._presenter.history
        return history[self._row].id if 0 <= self._row < len(history) else ""
