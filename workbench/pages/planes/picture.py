"""One pose with its target, stripes and line numbers, or the live picture."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from PySide6.QtWidgets import QWidget

from core.pipeline.live.events import PlanesDetail
from workbench.language import sentences, text_of, tr
from workbench.pages.calibration.picture import PictureTab
from workbench.pages.calibration.stage import Stage
from workbench.pages.planes import words
from workbench.pages.planes.presenter import PlanesPresenter
from workbench.views.colours import EXCLUDED, fan_colour
from workbench.views.forms.source_chooser import NextAction


class PoseTab(PictureTab):
    """Tab with one pose, its corners, stripes and line numbers, or with the live picture."""

    DETAIL, CORNER_SIZE = PlanesDetail, 10

    def __init__(
        self, presenter: PlanesPresenter, next_action: Callable[[], NextAction], parent: QWidget | None = None
    ) -> None:
        super().__init__(presenter, next_action, parent)
        self._stages: Any = None
        """PoseStages of the pose that was looked at last."""
        presenter.look.measured.connect(self._show_pose)

    def _sentence(self) -> str:
        p = self._presenter
        features = p.look.features_of(p.current)
        notes = sentences(*map(text_of, features.notes)) if features is not None else ""
        looked_at = self._stages if self._stages is not None and self._stages.name == p.current else None
        reason = text_of((features and features.reason) or (looked_at and looked_at.reason) or "")
        said = words.pose_sentence(p.current, p.quality_of(p.current), reason)
        if looked_at is not None and looked_at.ridge is not None:
            notes = tr("Shown is how strongly each place looks like a stripe.")
        return f"{said} {notes}".strip()

    def _invitation(self) -> str:
        return tr(
            "Take pictures of the plate under the laser with a live source, "
            "or choose a folder of them (or drop one here)."
        )

    def _words(self) -> tuple[str, str, str]:
        return tr("target"), tr("covered by poses taken"), tr("Looking for the plate …")

    def refresh(self) -> None:
        if self._presenter.is_needed:
            super().refresh()
        else:
            self.line.hide()
            self.hints.hide()
            self.image.clear(self._presenter.state.sentence)

    def _empty(self) -> None:
        super()._empty()
        if self._presenter.stage is Stage.NO_CAMERA:
            self.image.clear(
                tr("The planes are seen through the camera: calibrate and accept it first."),
                tr("Go to Camera"),
                lambda: self._presenter.go_to.emit("camera"),
            )

    def _show_pose(self, stages: Any) -> None:
        self._stages = stages
        self._show_picture(stages.name, stages.picture if stages.ridge is None else stages.ridge)
        if self._presenter.live.running:
            return
        self.line.setText(self._sentence())
        if len(stages.corners):
            self._draw_corners(stages.corners)
        self._draw_stripes([(stripe.uv, stripe.line) for stripe in stages.stripes])

    def _draw_more(self, detail: PlanesDetail) -> None:
        self._draw_stripes(list(zip(detail.stripes, detail.line, strict=True)))

    def _draw_stripes(self, stripes: list[tuple[Any, int]]) -> None:
        """One layer a fan line, with its number; what no line drew is grey.

        The numbers stand at alternate ends: neighbours are close to each other where the picture is small.
        """
        wanted = {f"stripe {line}" for _, line in stripes}
        for name in self.image.layer_names():
            if name.startswith("stripe") and name not in wanted:
                self.image.remove_layer(name)
        for line in sorted({line for _, line in stripes}):
            mine = [uv[::-1] if line % 2 else uv for uv, of in stripes if of == line]
            title = tr("line {number}", number=line + 1) if line >= 0 else tr("no line of the fan")
            colour = fan_colour(line + 1) if line >= 0 else EXCLUDED
            labels = [str(line + 1)] * len(mine) if line >= 0 else None
            self.image.set_lines(f"stripe {line}", mine, colour=colour, width=2.0, labels=labels, title=title)
