"""Where pictures come from: a recorded folder, chosen or dropped, or a live source."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import (
    QButtonGroup,
    QLabel,
    QPushButton,
    QWidget,
)

from workbench.language import tr
from workbench.theme import icon
from workbench.views import ask
from workbench.views.common import breakable
from workbench.views.layouts import in_column, in_row


class NextAction(NamedTuple):
    """Button of the next action where there are no pictures yet, as `EmptyState.set_text` takes it."""

    text: str
    do: Callable[[], None]
    why_not: str


class SourceChooser(QWidget):
    """Chooser of a recorded folder or a live source; `live_panel` is a LivePanel. A folder may be dropped anywhere on
    it.

    Also takes drops for another widget (the picture) by `accept_drops_on`.
    """

    folder_chosen = Signal(object)
    """Path of the folder."""

    mode_changed = Signal(str)
    """"folder" or "live"."""

    def __init__(self, live_panel: QWidget, *, what: str, parent: QWidget | None = None) -> None:
        """`what`: what the folder holds, as "Folder with pictures of the target"."""
        super().__init__(parent)
        self._what, self._folder = what, Path.home()
        self.recorded, self.live = QPushButton(tr("Recorded folder")), QPushButton(tr("Live source"))
        self.recorded.setToolTip(tr("Measure pictures that are there already"))
        self.live.setToolTip(tr("Take the pictures now, with a camera or the simulated rig"))
        self._modes = QButtonGroup(self)
        modes = in_row(spacing=0)
        for place, button in enumerate((self.recorded, self.live)):
            button.setCheckable(True)
            self._modes.addButton(button, place)
            modes.addWidget(button, 1)
        self.path, self.detail, self.browse = QLabel(), QLabel(), QPushButton(tr("Choose folder …"))
        self.browse.setToolTip(tr("Choose a folder of pictures, or drop one here"))
        self._parts = (self._folder_part(), live_panel)
        column = in_column(modes, on=self)
        for part in self._parts:  # no stack of widgets: that is always as high as the highest of them
            column.addWidget(part)
        live_panel.hide()
        self._modes.idToggled.connect(self._toggled)
        self.browse.clicked.connect(lambda: self.choose())
        self.recorded.setChecked(True)
        self.accept_drops_on(self)
        self.recorded.setIcon(icon("mdi6.folder-image"))
        self.live.setIcon(icon("mdi6.video-outline"))
        self.browse.setIcon(icon("mdi6.folder-open-outline"))
        self.set_folder(None)

    @property
    def mode(self) -> str:
        """Kind of source that is shown: "folder" or "live"."""
        return "live" if self.live.isChecked() else "folder"

    def set_mode(self, mode: str) -> None:
        """Show the fields for a folder, or for the live source."""
        self._modes.button(1 if mode == "live" else 0).setChecked(True)

    def set_folder(self, folder: Path | None, detail: str = "") -> None:
        """Show the folder in use (None: none) and a sentence about it, as "24 pictures"."""
        if folder is not None:
            self._folder = folder
        self.path.setText(breakable(str(folder)) if folder is not None else tr("No folder is chosen yet."))
        self.path.setToolTip(str(folder) if folder is not None else "")
        self.detail.setText(detail or ("" if folder is not None else tr("Choose a folder, or drop one here.")))

    def choose(self) -> None:
        """Ask for a folder, and emit the one chosen."""
        folder = ask.choose_folder(self, self._what, self._folder)
        if folder is not None:
            self.folder_chosen.emit(folder)

    def next_action(self, live: Any) -> NextAction:
        """Make the button to show where there are no pictures: start the live source, or choose a folder.

        `live` is its LivePresenter.
        """
        if self.mode == "live":
            return NextAction(tr("Start live"), live.start, live.buttons.start)
        return NextAction(tr("Choose folder …"), self.choose, "")

    def accept_drops_on(self, widget: QWidget) -> None:
        """Accept folders that are dropped on `widget` as if they were chosen."""
        widget.setAcceptDrops(True)
        widget.installEventFilter(self)

    def eventFilter(self, watched: Any, event: QEvent) -> bool:
        if isinstance(event, QDropEvent) and event.type() in (QEvent.Type.DragEnter, QEvent.Type.Drop):
            folder = dropped_folder(event)
            if folder is not None:
                event.acceptProposedAction()
                if event.type() == QEvent.Type.Drop:
                    self.set_mode("folder")
                    self.folder_chosen.emit(folder)
                return True
        return super().eventFilter(watched, event)

    def _folder_part(self) -> QWidget:
        self.path.setWordWrap(True)
        self.path.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.detail.setObjectName("muted")
        self.detail.setWordWrap(True)
        part = QWidget()
        in_column(self.path, self.detail, self.browse, on=part, margins=(0, 4, 0, 0))
        return part

    def _toggled(self, place: int, on: bool) -> None:
        if on:
            for number, part in enumerate(self._parts):
                part.setVisible(number == place)
            self.mode_changed.emit(self.mode)


def dropped_folder(event: QDropEvent | QDragEnterEvent) -> Path | None:
    """Return the folder that is dropped, or that of a dropped file; None for a project or recording set."""
    paths = [Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()]
    if not paths or (paths[0] / "project.json").exists() or (paths[0] / "rig.toml").exists():
        return None  # a project or a whole recording set: the window opens it
    return paths[0] if paths[0].is_dir() else paths[0].parent
