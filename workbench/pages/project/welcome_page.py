"""The first thing one sees: the ways in."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QModelIndex, QSize, Qt, QTimer
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import (
    QApplication,
    QCommandLinkButton,
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QListView,
    QPushButton,
    QSizePolicy,
    QWidget,
)

from workbench.language import tr
from workbench.pages.project.actions import ProjectActions
from workbench.refresh import Refresh
from workbench.theme import icon
from workbench.views.layouts import STRETCH, in_column, in_row
from workbench.views.lists.notice_list import Banner
from workbench.views.lists.tree_model import Cell, TreeModel, TreeRow


class WelcomePage(QWidget):
    """Page with new, open, recent, sample and simulated rig."""

    def __init__(self, projects: ProjectActions, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._projects = projects
        self._listed = TreeModel(self)
        self._refreshing = Refresh(self.refresh, self)  # a project may be forgotten by an action of the list itself
        title = QLabel("Trisect")
        title.setStyleSheet("font-size: 34px; font-weight: 300;")
        claim = QLabel(tr("Measure a part with one camera and two lasers, and know how far to trust the number."))
        claim.setObjectName("muted")
        grid = QGridLayout()
        grid.setSpacing(10)
        self.sample = self._link(
            "mdi6.cube-scan",
            tr("Open sample"),
            tr(
                "A finished measurement of a 50 mm gauge block, to look around in. The first time it is rendered "
                "and measured, in about a minute."
            ),
            projects.open_sample,
        )
        self.simulated = self._link(
            "mdi6.laser-pointer",
            tr("Try with the simulated rig"),
            tr("Calibrate, scan and measure live, without any hardware."),
            projects.try_simulated,
        )
        self.new = self._link(
            "mdi6.file-plus-outline",
            tr("New project"),
            tr("Start an empty project for your own rig."),
            projects.new_project,
        )
        self.open = self._link(
            "mdi6.folder-open-outline",
            tr("Open project"),
            tr("Go on with a project, or drop its folder here."),
            projects.choose_project,
        )
        self.from_set = self._link(
            "mdi6.folder-multiple-image",
            tr("Project from a recording set"),
            tr("Measure pictures that are there already: a folder with rig.toml."),
            projects.choose_set,
        )
        self.from_pictures = self._link(
            "mdi6.image-multiple-outline",
            tr("Import pictures"),
            tr("Make a recording set of folders of another program; nothing is copied where it can be linked."),
            projects.import_pictures,
        )
        ways = (self.sample, self.simulated, self.new, self.open, self.from_set, self.from_pictures)
        for place, link in enumerate(ways):
            grid.addWidget(link, place, 0)
        self.recent = self._recent_list()
        heading = QLabel(tr("Recent projects"))
        heading.setObjectName("heading")
        heading.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        self._none = QLabel(tr("Projects you open appear here."))
        self._none.setObjectName("muted")
        self._none.setAlignment(Qt.AlignmentFlag.AlignTop)
        right = in_column(heading, (self._none, 1), (self.recent, 1), spacing=6)
        card = QFrame()
        card.setObjectName("card")
        card.setMaximumWidth(1080)
        card.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        self.first = QPushButton(tr("First measurement, step by step"))
        self.first.setIcon(icon("mdi6.school-outline"))
        self.first.setToolTip(tr("Measure the pictures of a gauge block; each step is explained and waits for you."))
        self.first.clicked.connect(projects.begin_first_measurement)
        self.first_without_fan = QPushButton(tr("… with a line laser and two sheets"))
        self.first_without_fan.setToolTip(
            tr("The same block without a three-line laser: two printed boards behind it stand in for that.")
        )
        self.first_without_fan.clicked.connect(projects.begin_first_measurement_without_fan)
        head = in_row((_with_mark(title), 1), self.first, self.first_without_fan)
        inside = in_column(head, claim, on=card, margins=(36, 28, 36, 28))
        inside.addSpacing(18)
        columns = QHBoxLayout()
        columns.setSpacing(28)
        left = in_column(grid, STRETCH)
        columns.addLayout(left, 3)
        columns.addLayout(right, 2)
        inside.addLayout(columns, 1)
        layout = in_column(STRETCH, on=self, margins=(24, 12, 24, 24))
        row = in_row(STRETCH, (card, 20), STRETCH)
        layout.addLayout(row)
        layout.addStretch(1)
        self.banner = Banner(self)
        projects.sample.changed.connect(self._show_sample)
        projects.bench.settings.recent_changed.connect(self._refreshing.soon)
        self._show_sample()
        self.refresh()

    def refresh(self) -> None:
        """Show the list of recent projects."""
        recent = self._projects.bench.settings.recent
        self._listed.set_rows(
            [
                TreeRow(str(path), (Cell(f"{path.name}\n{path.parent}", tr("Open {path}", path=path)),))
                for path in recent
            ]
        )
        self.recent.setVisible(bool(recent))
        self._none.setVisible(not recent)

    def _show_sample(self) -> None:
        preparing = self._projects.sample.preparing
        self.sample.setEnabled(not preparing)
        self.sample.setText(tr("Preparing the sample …") if preparing else tr("Open sample"))
        self.sample.setToolTip(tr("It is being prepared; the status bar says how far it is.") if preparing else "")

    def _recent_list(self) -> QListView:
        """One click or Enter opens; Delete or the menu leaves a project out of the list."""
        listed = QListView()
        listed.setModel(self._listed)
        listed.setAccessibleName(tr("Recent projects"))
        listed.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        listed.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        listed.setSpacing(2)
        listed.setFrameShape(QFrame.Shape.NoFrame)
        listed.activated.connect(self._open_recent)
        listed.clicked.connect(self._open_recent)
        forget = QAction(tr("Leave out of this list"), listed)
        forget.setShortcut(QKeySequence(QKeySequence.StandardKey.Delete))
        forget.setShortcutContext(Qt.ShortcutContext.WidgetShortcut)
        forget.triggered.connect(self._forget)
        listed.addAction(forget)
        listed.setContextMenuPolicy(Qt.ContextMenuPolicy.ActionsContextMenu)
        return listed

    def _open_recent(self, index: QModelIndex) -> None:
        """Once the click is over: opening a project changes this list."""
        path = Path(self._listed.key(index))
        QTimer.singleShot(0, self, lambda: self._projects.open_project(path))

    def _forget(self) -> None:
        path = self._listed.key(self.recent.currentIndex())
        if path:
            self._projects.bench.settings.forget(Path(path))

    def _link(self, symbol: str, text: str, help_text: str, do: Callable[[], object]) -> QCommandLinkButton:
        link = QCommandLinkButton(text, help_text)
        link.setIcon(icon(symbol, colour="accent"))
        link.setIconSize(QSize(26, 26))
        link.clicked.connect(lambda: do())
        return link


def _with_mark(title: QLabel) -> QHBoxLayout:
    """The program's name after its icon."""
    mark = QLabel()
    mark.setPixmap(QApplication.windowIcon().pixmap(QSize(40, 40)))
    return in_row(mark, (title, 1), spacing=14)
