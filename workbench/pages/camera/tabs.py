"""What the middle of the camera page shows of all views together: coverage, residuals, expected error, history."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from PySide6.QtWidgets import QPushButton, QWidget

from core.messages import capital
from core.report.facts.of_kept import CHANGE_HEADS, stored_cameras
from core.report.facts.table import FactTable
from core.report.wording import grouped
from workbench.language import tr
from workbench.pages.calibration.history_tab import HistoryTab
from workbench.pages.camera import words
from workbench.pages.camera.presenter import CameraPresenter
from workbench.theme import icon
from workbench.views import ask
from workbench.views.colours import CORNER
from workbench.views.common import Choice
from workbench.views.image.view import ImageView
from workbench.views.layouts import enable, heading, in_column, in_row, muted
from workbench.views.lists.data_table import DataTable
from workbench.views.plots.map import HeatMap
from workbench.views.plots.residuals import ResidualPlot


class CoverageTab(QWidget):
    """Tab with the parts of the picture that the views cover, and what is missing in words."""

    def __init__(self, presenter: CameraPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._drawn: Any = None
        self.image, self.missing = ImageView(), muted()
        in_column(heading(tr("What is missing")), self.missing, (self.image, 1), on=self, margins=(6, 6, 6, 6))
        self.refresh()

    def refresh(self) -> None:
        """Show which parts of the picture the views cover, and a sentence on what is missing."""
        work = self._presenter.work
        self.missing.setText(words.missing_sentence(work.judgement) or tr("Nothing is known yet."))
        if work.judgement is self._drawn and work.judgement is not None:
            return
        self._drawn = work.judgement
        if work.judgement is None or work.seen is None or work.seen.size is None:
            self.image.clear(tr("Once the pictures are searched, this shows which parts of them the views cover."))
            return
        width, height = work.seen.size
        self.image.set_picture(np.full((8, round(8 * width / height)), 24, np.uint8), scale=height / 8)
        self.image.set_cells("covered", work.judgement.cells, title=tr("covered"))
        excluded = self._presenter.project.options.excluded
        used = [view.uv for view in work.seen.found if view.name not in excluded]
        self.image.set_points(
            "corners", np.concatenate([np.zeros((0, 2)), *used]), colour=CORNER.colour, symbol=".", size=3,
            title=tr("corners of all views"),
        )  # fmt: skip


class ResidualTab(QWidget):
    """Tab with all residuals that count, over the picture and as a scatter."""

    def __init__(self, presenter: CameraPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._drawn: Any = None
        self.plot, self.words = ResidualPlot(), muted()
        in_column(self.words, (self.plot, 1), on=self, margins=(6, 6, 6, 6))
        self.refresh()

    def refresh(self) -> None:
        """Show the residuals of all corners that count, and a sentence on them."""
        work = self._presenter.work
        residuals = work.judgement.residuals if work.judgement is not None else None
        self.plot.setVisible(residuals is not None)
        if residuals is None or work.calibration is None:
            self.words.setText(tr("Once the camera is solved, this shows how far the corners are from their places."))
            return
        self.words.setText(
            tr(
                "Observed − predicted of {count} corners; a pattern in the arrows: the lens is not fully described.",
                count=grouped(len(residuals.uv)),
            )
        )
        if work.judgement is not self._drawn:
            self._drawn = work.judgement
            self.plot.set_residuals(
                residuals.uv,
                residuals.residual,
                size=work.calibration.camera.image_size,
                rms=work.calibration.rms_px,
            )


class ExpectedTab(QWidget):
    """Tab with the expected error in mm over the picture."""

    def __init__(self, presenter: CameraPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._drawn: Any = None
        self.map, self.words, self.at_depth = HeatMap(), muted(), Choice()
        for title in (tr("nearest depth"), tr("middle depth"), tr("farthest depth")):
            self.at_depth.addItem(title)
        self.at_depth.setCurrentIndex(1)
        self.at_depth.setToolTip(tr("Depth in the work volume: from the nearest to the farthest corner seen"))
        self.at_depth.setAccessibleName(tr("Depth"))
        self.at_depth.currentIndexChanged.connect(lambda _: self.refresh())
        row = in_row((self.words, 1), self.at_depth)
        in_column(row, (self.map, 1), on=self, margins=(6, 6, 6, 6))
        self.refresh()

    def refresh(self) -> None:
        """Show the map of the expected error in mm at the chosen depth, and a sentence on it."""
        work = self._presenter.work
        depths = work.judgement.expected if work.judgement is not None else ()
        self.map.setVisible(bool(depths))
        self.at_depth.setVisible(bool(depths))
        if not depths or work.calibration is None:
            self.words.setText(tr("Once the camera is solved, this shows how far off it may see a point, in mm."))
            return
        expected = depths[self.at_depth.currentIndex()]
        self.words.setText(words.expected_sentence(expected))
        if expected is not self._drawn:
            self._drawn = expected
            self.map.set_map(
                expected.error_mm,
                size=work.calibration.camera.image_size,
                label=tr("expected error (k = 1)"),
                unit="mm",
            )


class CameraHistoryTab(HistoryTab):
    """Tab with the calibrations accepted before, compared with the one shown."""

    def __init__(self, presenter: CameraPresenter, parent: QWidget | None = None) -> None:
        super().__init__(presenter, parent)
        self.changes = DataTable()
        self.changes.set_headers([(capital(tr(title)), "") for title in CHANGE_HEADS])
        self.column.addWidget(self.changes, 1)
        self.take = QPushButton(icon("mdi6.file-import-outline"), tr("From a file …"))
        self.take.clicked.connect(self._take)
        self.row.addWidget(self.take)
        self.refresh()

    def refresh(self) -> None:
        super().refresh()
        changes = self._presenter.history.changes
        self.changes.set_rows(words.change_rows(changes))
        self.changes.setVisible(changes is not None)
        enable(
            self.take, self._presenter.history.why_not_import(), tr("Take a camera that OpenCV or ROS has calibrated")
        )

    def _take(self) -> None:
        kinds = tr("Calibrations of OpenCV or ROS (*.yaml *.yml *.json *.xml)")
        path = ask.choose_file_to_open(self, tr("Camera calibration from a file"), None, kinds)
        if path is not None:
            self._presenter.history.take(path)

    def _listed(self, entries: Sequence[Any], in_use: str) -> FactTable:
        return stored_cameras(entries, in_use)

    def _tip(self) -> str:
        return tr("Measure with the chosen calibration again")

    def _sentence(self) -> str:
        return tr("Change: shown − chosen. ▲: more than three of its standard deviations (sd).")
