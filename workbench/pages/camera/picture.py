"""One view of the camera's target with its corners and residuals, or the live picture."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QComboBox, QLabel, QVBoxLayout, QWidget

from core.pipeline.live.events import CameraDetail, LiveView
from workbench.language import text_of
from workbench.pages.camera import words
from workbench.pages.camera.presenter import CameraPresenter, short
from workbench.views.colours import CORNER, CORNER_LEFT_OUT
from workbench.views.image.view import ImageView
from workbench.views.plots.meters import HintBar

FACTORS = (1, 30, 100, 300, 1000)


class PictureTab(QWidget):
    """One view with its corners and residuals, or the live picture."""

    def __init__(
        self, presenter: CameraPresenter, choose_folder: Callable[[], None], parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._presenter, self._choose_folder = presenter, choose_folder
        self._name, self._drawn = "", None
        self.image, self.line, self.hints = ImageView(), QLabel(), HintBar()
        self.factor = QComboBox()
        for factor in FACTORS:
            self.factor.addItem(self.tr("residuals × {0}").format(factor), factor)
        self.factor.setCurrentIndex(FACTORS.index(300))
        self.factor.setToolTip(self.tr("How many times longer than true the residuals are drawn"))
        self.factor.setAccessibleName(self.tr("Enlargement of the residuals"))
        self.factor.currentIndexChanged.connect(lambda _: self._draw_view(anew=True))
        self.image.add_tool(self.factor)
        self.line.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        column = QVBoxLayout(self)
        column.setContentsMargins(6, 6, 6, 6)
        column.addWidget(self.line)
        column.addWidget(self.image, 1)
        column.addWidget(self.hints)
        presenter.picture_ready.connect(self._show_picture)
        presenter.live.show_by(self._draw_live)
        presenter.live.started.connect(self._live_started)
        self._empty()

    def _live_started(self, _: object) -> None:
        self.image.clear_layers()

    def refresh(self) -> None:
        """Show what the presenter says now."""
        live = self._presenter.live
        self.hints.setVisible(live.running)
        self.line.setVisible(not live.running and bool(self._presenter.current))
        self.factor.setVisible(not live.running and self._presenter.work.calibration is not None)
        if live.running:
            if self._name != "live" and not live.live:
                self.image.clear(live.state_text())
            return
        if self._name == "live":
            self._name = ""
            self.image.clear_layers()
            self._presenter.read_again()
        if not self._presenter.current:
            self._empty()
            return
        self.line.setText(words.view_sentence(short(self._presenter.current), self._quality()))
        self._draw_view()

    def _empty(self) -> None:
        self._name, self._drawn = "", None
        self.line.setText("")
        self.image.clear(
            self.tr("Take pictures of the target with a live source, or choose a folder of them (or drop one here)."),
            self.tr("Choose folder …"),
            self._choose_folder,
        )

    def _show_picture(self, name: str, picture: Any) -> None:
        if self._presenter.live.running:
            return
        if self._name != name:
            self.image.clear_layers()
        self.image.set_picture(picture)
        self._name = name
        self._draw_view(anew=True)

    def _quality(self) -> Any:
        return self._presenter.quality_of(self._presenter.current)

    def _draw_view(self, *, anew: bool = False) -> None:
        quality = self._quality()
        if self._name != self._presenter.current or (quality is self._drawn and not anew):
            return
        self._drawn = quality
        seen = self._presenter.corners_of(self._name)
        if seen is None:
            self.image.clear_layers()
            return
        counted = quality.counted if quality is not None and len(quality.counted) == len(seen) else None
        use = np.ones(len(seen), dtype=bool) if counted is None else counted
        self.image.set_points(
            "corners", seen[use], colour=CORNER.colour, symbol=CORNER.symbol, size=9, title=self.tr("corners")
        )
        if use.all():
            self.image.remove_layer("left out")
        else:
            self.image.set_points(
                "left out", seen[~use], colour=CORNER_LEFT_OUT.colour, symbol=CORNER_LEFT_OUT.symbol, size=11,
                title=self.tr("corners left out"),
            )  # fmt: skip
        if quality is None or not len(quality.residuals) or np.isnan(quality.residuals).all():
            self.image.remove_layer("residuals")
            return
        factor = float(self.factor.currentData())
        self.image.set_vectors(
            "residuals", seen, quality.residuals, factor=factor, title=self.tr("residuals × {0:g}").format(factor)
        )

    def _draw_live(self, view: LiveView) -> None:
        if self._name != "live":
            self.image.clear_layers()
            self._name = "live"
        self.image.set_picture(view.picture, scale=view.scale)
        detail = view.detail
        if not isinstance(detail, CameraDetail):
            self.hints.set_hints([self.tr("Looking for the target …")])
            return
        self.image.set_cells("covered", detail.cells, title=self.tr("covered by views taken"))
        if detail.uv is None:
            self.image.remove_layer("corners")
        else:
            self.image.set_points(
                "corners", detail.uv, colour=CORNER.colour, symbol=CORNER.symbol, size=9, title=self.tr("corners")
            )
        enough = () if detail.missing else (self.tr("Nothing is missing: press Stop, and it is calibrated."),)
        seen = () if detail.sentence is None else (detail.sentence,)
        self.hints.set_hints([*map(text_of, (*seen, *detail.missing[:2])), *enough])
