"""What the middle of the camera page shows of all views together: coverage, residuals, expected error, history."""

from __future__ import annotations

from typing import Any

import numpy as np
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QPushButton, QVBoxLayout, QWidget

from workbench.pages.camera import words
from workbench.pages.camera.presenter import CameraPresenter
from workbench.pages.step_page import heading, muted
from workbench.theme import icon
from workbench.views.colours import CORNER
from workbench.views.image.view import ImageView
from workbench.views.lists.data_table import DataTable
from workbench.views.plots.map import HeatMap
from workbench.views.plots.residuals import ResidualPlot


class CoverageTab(QWidget):
    """Which parts of the picture the views cover, and what is missing in words."""

    def __init__(self, presenter: CameraPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._drawn: Any = None
        self.image, self.missing = ImageView(), muted()
        column = QVBoxLayout(self)
        column.setContentsMargins(6, 6, 6, 6)
        column.addWidget(heading(self.tr("What is missing")))
        column.addWidget(self.missing)
        column.addWidget(self.image, 1)
        self.refresh()

    def refresh(self) -> None:
        """Show what the presenter says now."""
        work = self._presenter.work
        self.missing.setText(words.missing_sentence(work.judgement) or self.tr("Nothing is known yet."))
        if work.judgement is self._drawn and work.judgement is not None:
            return
        self._drawn = work.judgement
        if work.judgement is None or work.seen is None or work.seen.size is None:
            self.image.clear(self.tr("Once the pictures are searched, this shows which parts of them the views cover."))
            return
        width, height = work.seen.size
        self.image.set_picture(np.full((8, round(8 * width / height)), 24, np.uint8), scale=height / 8)
        self.image.set_cells("covered", work.judgement.cells, title=self.tr("covered"))
        excluded = self._presenter.project.options.excluded
        used = [view.uv for view in work.seen.found if view.name not in excluded]
        self.image.set_points(
            "corners", np.concatenate([np.zeros((0, 2)), *used]), colour=CORNER.colour, symbol=".", size=3,
            title=self.tr("corners of all views"),
        )  # fmt: skip


class ResidualTab(QWidget):
    """All residuals that count, over the picture and as a scatter."""

    def __init__(self, presenter: CameraPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._drawn: Any = None
        self.plot, self.words = ResidualPlot(), muted()
        column = QVBoxLayout(self)
        column.setContentsMargins(6, 6, 6, 6)
        column.addWidget(self.words)
        column.addWidget(self.plot, 1)
        self.refresh()

    def refresh(self) -> None:
        """Show what the presenter says now."""
        work = self._presenter.work
        residuals = work.judgement.residuals if work.judgement is not None else None
        self.plot.setVisible(residuals is not None)
        if residuals is None or work.calibration is None:
            self.words.setText(
                self.tr("Once the camera is solved, this shows how far the corners are from their places.")
            )
            return
        text = self.tr("Observed − predicted of {0} corners; a pattern in the arrows: the lens is not fully described.")
        self.words.setText(text.format(len(residuals.uv)))
        if work.judgement is not self._drawn:
            self._drawn = work.judgement
            self.plot.set_residuals(
                residuals.uv,
                residuals.residual,
                size=work.calibration.camera.image_size,
                rms=work.calibration.rms_px,
            )


class ExpectedTab(QWidget):
    """The error to be expected in mm over the picture."""

    def __init__(self, presenter: CameraPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._drawn: Any = None
        self.map, self.words, self.at_depth = HeatMap(), muted(), QComboBox()
        for title in (self.tr("nearest depth"), self.tr("middle depth"), self.tr("farthest depth")):
            self.at_depth.addItem(title)
        self.at_depth.setCurrentIndex(1)
        self.at_depth.setToolTip(self.tr("Depth in the work volume: from the nearest to the farthest corner seen"))
        self.at_depth.setAccessibleName(self.tr("Depth"))
        self.at_depth.currentIndexChanged.connect(lambda _: self.refresh())
        row = QHBoxLayout()
        row.addWidget(self.words, 1)
        row.addWidget(self.at_depth)
        column = QVBoxLayout(self)
        column.setContentsMargins(6, 6, 6, 6)
        column.addLayout(row)
        column.addWidget(self.map, 1)
        self.refresh()

    def refresh(self) -> None:
        """Show what the presenter says now."""
        work = self._presenter.work
        depths = work.judgement.expected if work.judgement is not None else ()
        self.map.setVisible(bool(depths))
        self.at_depth.setVisible(bool(depths))
        if not depths or work.calibration is None:
            self.words.setText(self.tr("Once the camera is solved, this shows how far off it may see a point, in mm."))
            return
        expected = depths[self.at_depth.currentIndex()]
        self.words.setText(words.expected_sentence(expected))
        if expected is not self._drawn:
            self._drawn = expected
            self.map.set_map(
                expected.error_mm,
                size=work.calibration.camera.image_size,
                label=self.tr("expected error (k = 1)"),
                unit="mm",
            )


class HistoryTab(QWidget):
    """The calibrations that were accepted, compared with the one shown; any can be restored."""

    def __init__(self, presenter: CameraPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self.table, self.changes = DataTable(), DataTable()
        self.table.set_headers(
            [(self.tr("Accepted"), ""), (self.tr("RMS"), "px"), (self.tr("Views"), ""), (self.tr("Id"), ""), ("", "")]
        )
        self.changes.set_headers(
            [
                (title, "")
                for title in (self.tr("Parameter"), self.tr("Chosen"), self.tr("Shown"), self.tr("Change"), "sd")
            ]
        )
        self.restore, self.words = QPushButton(self.tr("Restore")), muted()
        self.restore.clicked.connect(lambda: presenter.history.restore())
        self.table.current_row_changed.connect(self._chosen)
        row = QHBoxLayout()
        row.addWidget(self.words, 1)
        row.addWidget(self.restore)
        column = QVBoxLayout(self)
        column.setContentsMargins(6, 6, 6, 6)
        column.addWidget(self.table, 1)
        column.addLayout(row)
        column.addWidget(self.changes, 1)
        self._rows: Any = None
        self.refresh()

    def refresh(self) -> None:
        """Show what the presenter says now."""
        history, accepted = self._presenter.history, self._presenter.project.accepted.camera
        rows = words.history_rows(history.entries, accepted)
        if rows != self._rows:
            self._rows = rows
            self.table.set_rows(rows)
        self.changes.set_rows(words.change_rows(history.changes))
        self.changes.setVisible(history.changes is not None)
        self.restore.setIcon(icon("mdi6.backup-restore"))
        if not rows:
            why = self.tr("No calibration has been accepted yet; accepted ones are listed here.")
        elif not history.chosen:
            why = self.tr("Choose a calibration above to compare it with the one shown.")
        elif history.chosen == accepted:
            why = self.tr("This calibration is in use.")
        else:
            why = ""
        self.words.setText(
            why or self.tr("Change: shown − chosen. ▲: more than three of its standard deviations (sd).")
        )
        self.restore.setEnabled(not why)
        self.restore.setToolTip(why or self.tr("Measure with the chosen calibration again"))

    def _chosen(self, row: int) -> None:
        entries = self._presenter.history.entries
        if 0 <= row < len(entries):
            self._presenter.history.choose(entries[row].id)
