"""Menus and keys of the window, made from the table of shortcuts."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QCoreApplication, QUrl
from PySide6.QtGui import QAction, QDesktopServices, QKeySequence
from PySide6.QtWidgets import QMenu, QMessageBox

from core import __version__
from workbench.pages.double_click import choose_double_click
from workbench.settings import THEMES
from workbench.shortcuts import KEYS, SHORTCUTS
from workbench.steps import STEPS
from workbench.views.shortcut_list import ShortcutList

if TYPE_CHECKING:
    from workbench.main_window import MainWindow


class Menus:
    """Builds the menu bar of `window` and keeps its entries true."""

    def __init__(self, window: MainWindow) -> None:
        self._window = window
        self.actions: dict[str, QAction] = {}
        self._recent = QMenu(window.tr("Open &recent"), window)
        self._build()
        window.bench.settings.recent_changed.connect(self._fill_recent)
        self._fill_recent()
        self.refresh()

    def refresh(self) -> None:
        """Grey what makes no sense now."""
        window = self._window
        is_open = window.model.is_open
        for name in ("save", "copy", "close", "back", "next", "run", "accept", "live", "capture"):
            self.actions[name].setEnabled(is_open)
        for step in STEPS:
            self.actions[f"step {step.name}"].setEnabled(is_open)

    def _build(self) -> None:
        w = self._window
        bar = w.menuBar()
        file = bar.addMenu(w.tr("&File"))
        self._add(file, "new", w.tr("&New project …"), w.doors.new_project)
        self._add(file, "open", w.tr("&Open project …"), w.doors.choose_project)
        file.addMenu(self._recent)
        self._add(file, "open set", w.tr("New project from a recording &set …"), w.doors.choose_set)
        file.addSeparator()
        self._add(file, "sample", w.tr("Open sam&ple"), w.doors.open_sample)
        self._add(file, "simulated", w.tr("&Try with the simulated rig"), w.doors.try_simulated)
        file.addSeparator()
        self._add(file, "save", w.tr("&Save"), w.doors.save)
        self._add(file, "copy", w.tr("Save a c&opy …"), w.doors.copy.save_copy)
        self._add(file, "close", w.tr("&Close project"), w.doors.close_project)
        self._add(file, "quit", w.tr("&Quit"), w.close)

        edit = bar.addMenu(w.tr("&Edit"))
        stack = w.model.undo_stack
        for name, action in (
            ("undo", stack.createUndoAction(w, w.tr("Undo"))),
            ("redo", stack.createRedoAction(w, w.tr("Redo"))),
        ):
            action.setShortcut(QKeySequence(KEYS[name]))
            edit.addAction(action)
            self.actions[name] = action

        step = bar.addMenu(w.tr("&Step"))
        self._add(step, "run", w.tr("&Do this step"), lambda: w.presenter_action("run"))
        self._add(step, "accept", w.tr("&Accept"), lambda: w.presenter_action("accept"))
        self._add(step, "live", w.tr("&Live source on or off"), lambda: w.presenter_action("live"))
        self._add(step, "capture", w.tr("Take a &picture"), lambda: w.presenter_action("capture"))
        self._add(step, "cancel", w.tr("&Cancel the running job"), w.cancel_task)
        step.addSeparator()
        self._add(step, "back", w.tr("&Back"), lambda: w.go(-1))
        self._add(step, "next", w.tr("&Next"), lambda: w.go(1))
        for number, entry in enumerate(STEPS, start=1):
            title = QCoreApplication.translate("Steps", entry.title)
            action = self._add(step, f"step {entry.name}", title, partial(w.go_to, entry.name))
            action.setShortcut(QKeySequence(f"Ctrl+{number}"))

        view = bar.addMenu(w.tr("&View"))
        self._add(view, "messages", w.tr("&Messages"), lambda: w.messages.setVisible(not w.messages.isVisible()))
        self._add(view, "theme", w.tr("Light or dark &theme"), self._next_theme)
        self._add(view, "full", w.tr("&Full screen"), self._full_screen)

        help_menu = bar.addMenu(w.tr("&Help"))
        keys = self._add(help_menu, "help", w.tr("&Keys"), self._show_keys)
        keys.setShortcuts([QKeySequence("F1"), QKeySequence("?")])
        self._add(
            help_menu,
            "double click",
            w.tr("Open projects by &double click …"),
            lambda: choose_double_click(w, w.bench.notices),
        )
        self._add(help_menu, "log", w.tr("Open the &log folder"), self._open_log)
        self._add(help_menu, "about", w.tr("&About Trisect"), self._about)

    def _add(self, menu: QMenu, name: str, text: str, do: Callable[[], object]) -> QAction:
        action = QAction(text, self._window)
        if name in KEYS:
            action.setShortcut(QKeySequence(KEYS[name]))
        action.triggered.connect(lambda: do())
        menu.addAction(action)
        self.actions[name] = action
        return action

    def _fill_recent(self) -> None:
        self._recent.clear()
        for path in self._window.bench.settings.recent:
            action = self._recent.addAction(path.name)
            action.setToolTip(str(path))
            action.triggered.connect(lambda _=False, p=path: self._window.doors.open_project(p))
        self._recent.setEnabled(not self._recent.isEmpty())

    def _next_theme(self) -> None:
        settings = self._window.bench.settings
        settings.theme = THEMES[2] if settings.theme != THEMES[2] else THEMES[1]

    def _full_screen(self) -> None:
        w = self._window
        w.showNormal() if w.isFullScreen() else w.showFullScreen()

    def _show_keys(self) -> None:
        ShortcutList(
            [(key, QCoreApplication.translate("Shortcuts", meaning)) for _, key, meaning in SHORTCUTS], self._window
        ).exec()

    def _open_log(self) -> None:
        path = self._window.log_file
        if path is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(path.parent)))

    def _about(self) -> None:
        w = self._window
        text = w.tr(
            "<b>Trisect {0}</b><p>Measures parts with one camera, a fixed three-line laser and a single line moved by "
            "hand.</p><p>Method: Sun et al., Sensors 2023, 23, 13, "
            "<a href='https://doi.org/10.3390/s23010013'>doi:10.3390/s23010013</a>.</p><p>MIT licence.</p>"
        ).format(__version__)
        QMessageBox.about(w, w.tr("About Trisect"), text)
