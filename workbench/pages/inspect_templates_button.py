"""The button of templates: save the plan as one, take one from a file, or one of those used last."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QEvent
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu, QPushButton, QWidget

from workbench.pages.inspect_templates import InspectTemplates
from workbench.theme import icon
from workbench.views import ask


class TemplatesButton(QPushButton):
    """A menu."""

    def __init__(self, templates: InspectTemplates, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._templates = templates
        self._paths: list[Path] | None = None
        self.setText(self.tr("Templates"))
        self.setToolTip(self.tr("Keep these features for the next part, or take those of another"))
        menu = QMenu(self)
        menu.setToolTipsVisible(True)
        self.save = menu.addAction(self.tr("Save as template …"))
        self.open = menu.addAction(self.tr("Take from file …"))
        self.open.setToolTip(self.tr("Measure the features of a plan.toml from now on, instead of these"))
        self._line = menu.addSeparator()
        self.recent: list[QAction] = []
        self.save.triggered.connect(lambda: self._save())
        self.open.triggered.connect(lambda: self._open())
        self.setMenu(menu)
        self._dress()

    def refresh(self) -> None:
        """Show what the presenter says now."""
        why_not, paths = self._templates.cannot_save, self._templates.recent
        self.save.setEnabled(not why_not)
        self.save.setToolTip(why_not or self.tr("Write these features, their regions and limits to a file"))
        if paths == self._paths:
            return
        self._paths = paths
        menu = self.menu()
        for action in self.recent:
            menu.removeAction(action)
            action.deleteLater()
        self.recent = []
        for path in paths:
            action = menu.addAction(path.stem)
            action.setToolTip(self.tr("Measure these features on this part: {0}").format(path))
            action.triggered.connect(lambda _=False, path=path: self._templates.take(path))
            self.recent.append(action)
        self._line.setVisible(bool(paths))

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "recent"):
            self._dress()

    def _save(self) -> None:
        path = ask.choose_file_to_save(
            self, self.tr("Save as template"), self._templates.place(), self.tr("Plan (*.toml)")
        )
        if path is not None:
            self._templates.save(path)

    def _open(self) -> None:
        path = ask.choose_file_to_open(
            self, self.tr("Take the features of a template"), self._templates.place().parent, self.tr("Plan (*.toml)")
        )
        if path is not None:
            self._templates.take(path)

    def _dress(self) -> None:
        self.setIcon(icon("mdi6.playlist-plus"))
        self.save.setIcon(icon("mdi6.content-save-outline"))
        self.open.setIcon(icon("mdi6.folder-open-outline"))
