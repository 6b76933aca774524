"""One pose with its target, stripes and line numbers, or the live picture."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget

from core.pipeline.live.events import LiveView, PlanesDetail
from workbench.language import text_of
from workbench.pages.calibration.stage import Stage
from workbench.pages.planes import words
from workbench.pages.planes.presenter import PlanesPresenter
from workbench.views.colours import CORNER, EXCLUDED, fan_colour
from workbench.views.image.view import ImageView
from workbench.views.plots.meters import HintBar

LIVE = "live"


class PoseTab(QWidget):
    """One pose with corners, stripes and line numbers, or the live picture."""

    def __init__(
        self, presenter: PlanesPresenter, choose_folder: Callable[[], None], parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._presenter, self._choose_folder = presenter, choose_folder
        self._name = ""
        self.image, self.line, self.hints = ImageView(), QLabel(), HintBar()
        self.line.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.line.setWordWrap(True)
        column = QVBoxLayout(self)
        column.setContentsMargins(6, 6, 6, 6)
        column.addWidget(self.line)
        column.addWidget(self.image, 1)
        column.addWidget(self.hints)
        presenter.look.measured.connect(self._show_pose)
        presenter.look.picture.connect(self._show_picture)
        presenter.live.show_by(self._draw_live)
        presenter.live.started.connect(self._live_started)
        self._empty()

    def _live_started(self, _: object) -> None:
        self.image.clear_layers()

    def refresh(self) -> None:
        """Show what the presenter says now."""
        p, live = self._presenter, self._presenter.live
        self.hints.setVisible(live.running)
        self.line.setVisible(not live.running and bool(p.current))
        if live.running:
            if self._name != LIVE and not live.live:
                self.image.clear(live.state_text())
            return
        if self._name == LIVE:
            self._name = ""
            self.image.clear_layers()
            p.look.again()
        if not p.current:
            self._empty()
            return
        features = p.look.features_of(p.current)
        notes = " ".join(map(text_of, features.notes)) if features is not None else ""
        reason = text_of(features.reason or "") if features is not None else ""
        said = words.pose_sentence(p.current, p.pose_of(p.current), reason)
        self.line.setText(f"{said} {notes}".strip())

    def _empty(self) -> None:
        if self._name:
            self.image.clear_layers()
        self._name = ""
        self.line.setText("")
        if self._presenter.stage is Stage.NO_CAMERA:
            self.image.clear(
                self.tr("The planes are seen through the camera: calibrate and accept it first."),
                self.tr("Go to Camera"),
                lambda: self._presenter.go_to.emit("camera"),
            )
            return
        self.image.clear(
            self.tr(
                "Take pictures of the plate under the laser with a live source, "
                "or choose a folder of them (or drop one here)."
            ),
            self.tr("Choose folder …"),
            self._choose_folder,
        )

    def _show_picture(self, name: str, picture: Any) -> None:
        """The picture alone: it has not been measured."""
        if not self._presenter.live.running:
            self.image.clear_layers()
            self.image.set_picture(picture)
            self._name = name

    def _show_pose(self, stages: Any) -> None:
        if self._presenter.live.running:
            return
        self.image.clear_layers()
        self.image.set_picture(stages.picture)
        self._name = stages.name
        if len(stages.corners):
            self._draw_target(stages.corners)
        self._draw_stripes([(stripe.uv, stripe.line) for stripe in stages.stripes])

    def _draw_target(self, corners: Any) -> None:
        self.image.set_points(
            "corners", corners, colour=CORNER.colour, symbol=CORNER.symbol, size=10, title=self.tr("target")
        )

    def _draw_stripes(self, stripes: list[tuple[Any, int]]) -> None:
        """One layer a fan line, with its number at its start; what no line drew is grey."""
        wanted = {f"stripe {line}" for _, line in stripes}
        for name in self.image.layer_names():
            if name.startswith("stripe") and name not in wanted:
                self.image.remove_layer(name)
        for line in sorted({line for _, line in stripes}):
            mine = [uv for uv, of in stripes if of == line]
            name = self.tr("line {0}").format(line + 1) if line >= 0 else self.tr("no line of the fan")
            colour = fan_colour(line + 1) if line >= 0 else EXCLUDED
            labels = [str(line + 1)] * len(mine) if line >= 0 else None
            self.image.set_lines(f"stripe {line}", mine, colour=colour, width=2.0, labels=labels, title=name)

    def _draw_live(self, view: LiveView) -> None:
        if self._name != LIVE:
            self.image.clear_layers()
            self._name = LIVE
        self.image.set_picture(view.picture, scale=view.scale)
        detail = view.detail
        if not isinstance(detail, PlanesDetail):
            self.hints.set_hints([self.tr("Looking for the plate …")])
            return
        self.image.set_cells("covered", detail.cells, title=self.tr("covered by poses taken"))
        if detail.uv is None:
            self.image.remove_layer("corners")
        else:
            self._draw_target(detail.uv)
        self._draw_stripes(list(zip(detail.stripes, detail.line, strict=True)))
        enough = () if detail.missing else (self.tr("Nothing is missing: press Stop, and it is calibrated."),)
        seen = () if detail.sentence is None else (detail.sentence,)
        self.hints.set_hints([*map(text_of, (*seen, *detail.missing[:2])), *enough])
