"""What the middle of the camera page shows: one view, coverage, residuals, expected error, history."""

from __future__ import annotations

from typing import Any

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QPushButton, QSplitter, QVBoxLayout, QWidget

from core.live.events import CameraDetail, LiveView
from workbench.pages import camera_words as words
from workbench.pages.camera_presenter import CameraPresenter, short
from workbench.pages.step_page import heading, muted
from workbench.theme import icon
from workbench.views.colours import CORNER, CORNER_LEFT_OUT
from workbench.views.image_view import ImageView
from workbench.views.meters import HintBar
from workbench.views.plots import HeatMap, ResidualPlot
from workbench.views.tables import DataTable

FACTORS = (1, 30, 100, 300, 1000)


class PictureTab(QWidget):
    """One view with its corners and residuals, or the live picture."""

    def __init__(self, presenter: CameraPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
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
        presenter.live.view.connect(self._show_live)
        presenter.live.started.connect(lambda _: self.image.clear_layers())
        self._empty()

    def refresh(self) -> None:
        """Show what the presenter says now."""
        live = self._presenter.live.running
        self.hints.setVisible(live)
        self.factor.setVisible(not live)
        if live:
            if not self._presenter.live.live:
                self.line.setText(self._presenter.live.state_text())
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
            self.tr("Choose a folder of pictures of the target at the right, or drop one here; or start a live source.")
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

    def _show_live(self, view: LiveView) -> None:
        try:
            self._draw_live(view)
        finally:
            self._presenter.live.shown()

    def _draw_live(self, view: LiveView) -> None:
        if not self._presenter.live.running:
            return
        if self._name != "live":
            self.image.clear_layers()
            self._name = "live"
        self.image.set_picture(view.picture, scale=view.scale)
        self.line.setText(f"{self._presenter.live.state_text()}   {self._presenter.live.counts_text()}")
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
        self.hints.set_hints([sentence for sentence in (detail.sentence, *detail.missing[:2]) if sentence])


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
        self.map, self.words = HeatMap(), muted()
        column = QVBoxLayout(self)
        column.setContentsMargins(6, 6, 6, 6)
        column.addWidget(self.words)
        column.addWidget(self.map, 1)
        self.refresh()

    def refresh(self) -> None:
        """Show what the presenter says now."""
        work = self._presenter.work
        expected = work.judgement.expected if work.judgement is not None else None
        self.map.setVisible(expected is not None)
        if expected is None or work.calibration is None:
            self.words.setText(self.tr("Once the camera is solved, this shows how far off it may see a point, in mm."))
            return
        self.words.setText(words.expected_sentence(work.judgement))
        if work.judgement is not self._drawn:
            self._drawn = work.judgement
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
            [(self.tr("Kept"), ""), (self.tr("RMS"), "px"), (self.tr("Views"), ""), (self.tr("Id"), ""), ("", "")]
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
        lower = QWidget()
        below = QVBoxLayout(lower)
        below.setContentsMargins(0, 4, 0, 0)
        below.addLayout(row)
        below.addWidget(self.changes, 1)
        split = QSplitter(Qt.Orientation.Vertical)
        split.addWidget(self.table)
        split.addWidget(lower)
        column = QVBoxLayout(self)
        column.setContentsMargins(6, 6, 6, 6)
        column.addWidget(split)
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
