"""One view of the camera's target with its corners and residuals, or the live picture."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from PySide6.QtWidgets import QWidget

from core.messages import NO_BREAK_SPACE
from core.pipeline.live.events import CameraDetail
from workbench.language import tr
from workbench.pages.calibration.picture import PictureTab
from workbench.pages.camera import words
from workbench.pages.camera.presenter import CameraPresenter
from workbench.views.colours import CORNER_LEFT_OUT
from workbench.views.common import Choice
from workbench.views.forms.source_chooser import NextAction

FACTORS = (1, 30, 100, 300, 1000)
"""How many times longer than true the residuals can be drawn: they are tenths and hundredths of a pixel."""


class ViewTab(PictureTab):
    """Tab with one view, its corners and residuals, or with the live picture."""

    DETAIL, CORNER_SIZE = CameraDetail, 9

    def __init__(
        self, presenter: CameraPresenter, next_action: Callable[[], NextAction], parent: QWidget | None = None
    ) -> None:
        self._drawn: Any = None
        super().__init__(presenter, next_action, parent)
        self.factor = Choice()
        for factor in FACTORS:
            self.factor.addItem(tr("residuals × {factor}", factor=factor), factor)
        self.factor.setCurrentIndex(FACTORS.index(300))
        self.factor.setToolTip(tr("How many times longer than true the residuals are drawn"))
        self.factor.setAccessibleName(tr("Enlargement of the residuals"))
        self.factor.currentIndexChanged.connect(lambda _: self._draw(anew=True))
        self.image.add_tool(self.factor)

    def refresh(self) -> None:
        p = self._presenter
        self.factor.setVisible(not p.live.running and p.work.calibration is not None)
        super().refresh()
        self._offer_counted()

    def _offer_counted(self) -> None:
        """Offer the columns and rows that are seen where others were entered."""
        p = self._presenter
        if p.counted is None:
            self.image.offer("")
            return
        values = p.target.target_values()
        seen, entered = (
            f"{columns}{NO_BREAK_SPACE}×{NO_BREAK_SPACE}{rows}"
            for columns, rows in (p.counted, (values["columns"], values["rows"]))
        )
        self.image.offer(
            tr("{seen} is seen, {entered} is entered.", seen=seen, entered=entered),
            tr("Take over {seen}", seen=seen),
            p.take_counted,
        )

    def _sentence(self) -> str:
        return words.view_sentence(self._presenter.short(self._presenter.current), self._quality())

    def _invitation(self) -> str:
        return tr("Take pictures of the target with a live source, or choose a folder of them (or drop one here).")

    def _words(self) -> tuple[str, str, str]:
        return tr("corners"), tr("covered by views taken"), tr("Looking for the target …")

    def _quality(self) -> Any:
        return self._presenter.quality_of(self._presenter.current)

    def _draw(self, *, anew: bool = False) -> None:
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
        self._draw_corners(seen[use])
        if use.all():
            self.image.remove_layer("left out")
        else:
            self.image.set_points(
                "left out", seen[~use], colour=CORNER_LEFT_OUT.colour, symbol=CORNER_LEFT_OUT.symbol, size=11,
                title=tr("corners left out"),
            )  # fmt: skip
        if quality is None or not len(quality.residuals) or np.isnan(quality.residuals).all():
            self.image.remove_layer("residuals")
            return
        factor = float(self.factor.currentData())
        self.image.set_vectors(
            "residuals", seen, quality.residuals, factor=factor, title=tr("residuals × {factor:g}", factor=factor)
        )
