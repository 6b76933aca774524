"""Menus and keys of the window, made from the table of shortcuts and from what the window can do."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple

from PySide6.QtCore import QObject
from PySide6.QtGui import QAction, QActionGroup, QKeySequence, QUndoStack
from PySide6.QtWidgets import QMainWindow, QMenu, QMessageBox

from core import __version__
from core.extras import install
from core.messages import label
from core.translations import languages, own_name
from workbench.language import language_name, text_of, tr
from workbench.refresh import Refresh
from workbench.settings import THEMES, AppSettings
from workbench.steps import STEPS
from workbench.views.layouts import enable
from workbench.views.lists.shortcut_list import ShortcutList
from workbench.wing import MenuEntry

SHORTCUTS: tuple[tuple[str, str, str], ...] = (
    ("new", "Ctrl+N", label("New project")),
    ("open", "Ctrl+O", label("Open project")),
    ("save", "Ctrl+S", label("Save project")),
    ("next part", "Ctrl+Shift+N", label("Next part of the series")),
    ("close", "Ctrl+W", label("Close project")),
    ("quit", "Ctrl+Q", label("Quit")),
    ("undo", "Ctrl+Z", label("Undo")),
    ("redo", "Ctrl+Shift+Z, Ctrl+Y", label("Redo")),
    ("back", "Alt+Left", label("Back")),
    ("next", "Alt+Right", label("Next")),
    ("step", "Ctrl+1 … Ctrl+6", label("Go to a step")),
    ("run", "Ctrl+R", label("Do this step: calibrate, measure, make the report")),
    ("whole", "Ctrl+Shift+R", label("Measure everything: from the pictures to the report")),
    ("accept", "Ctrl+Return", label("Accept a calibration")),
    ("live", "Ctrl+L", label("Start or stop the live source")),
    ("capture", "Ctrl+Space", label("Take a picture from the live source")),
    ("presenter", "PgDown, PgUp", label("Live, by presenter or foot switch: take or go on; pause")),
    ("cancel", "Ctrl+.", label("Cancel the running job")),
    ("messages", "Ctrl+M", label("Show or hide the messages")),
    ("theme", "Ctrl+T", label("Light or dark theme")),
    ("full", "F11", label("Full screen")),
    ("operator mode", "F10", label("Operator mode: four buttons in big type; the plan cannot be changed")),
    ("manual", "F1", label("The manual, at the page of this step")),
    ("keys", "?", label("This list")),
    ("fit", "F", label("Picture: show the whole picture")),
    ("one", "1", label("Picture: one screen pixel a picture pixel")),
    ("views", "1 … 7, R", label("3D view: standard views, fit")),
    ("frame", "Z", label("3D view: the part's frame with z up, or the camera's")),
    ("cut", "X", label("Inspect, 3D view: lay a plane through the surface")),
    ("click", "C, Shift+C", label("Inspect, 3D view: click a face, or two, to measure them")),
    ("frames", "Left, Right", label("Scan: go through the frames")),
    ("polygon", "Return, Esc", label("Drawing a region, clicking a face: take it, give it up")),
)
"""Every key the window knows: name, key and meaning. The list under ? shows them, the actions are made from them."""

KEYS = {name: key for name, key, _ in SHORTCUTS}

UNDOING = ("undo", "redo")
OF_A_PAGE = ("run", "accept", "live", "capture")
"""Entries that mean something on some pages only."""

NEED_A_PROJECT = (
    "save",
    "next part",
    "copy",
    "pack",
    "export",
    "operator mode",
    "console",
    "script",
    "close",
    "back",
    "next",
    "whole",
    *OF_A_PAGE,
)


OPERATOR_MAY = ("next part", "cancel", "quit", "messages", "theme", "full", "manual", "keys", "log", "about")
"""Entries that operators have: none changes the plan, the settings or the project that is open."""


class MenuFacts(NamedTuple):
    """Facts from which the state of the menu entries follows."""

    page: str
    """The step whose page is shown; "" without a project."""
    does: frozenset[str]
    """Those of OF_A_PAGE that mean something on it."""
    job: bool
    """A long job runs."""
    operator: bool = False
    """The operator mode is on: nothing but the part is to be changed."""
    no_console: bool = False
    """What the Python console needs is not installed."""


def why_not(name: str, facts: MenuFacts, *, needs_project: bool = False) -> str:
    """Return the reason why the menu entry called `name` cannot be chosen now; "" if it can.

    `needs_project`: also where it is none of NEED_A_PROJECT.
    """
    if facts.operator and name not in OPERATOR_MAY:
        return tr("Leave operator mode first.")
    if name == "cancel":
        return "" if facts.job else tr("No job is running.")
    if name not in NEED_A_PROJECT and not name.startswith("step ") and not needs_project:
        return ""
    if not facts.page:
        return tr("Open a project first.")
    if name == "console" and facts.no_console:
        return tr("The console needs an extra: install it with {command}.", command=text_of(install("console")))
    if name in OF_A_PAGE and name not in facts.does:
        return tr("There is nothing of the kind on this page.")
    if name == "back" and facts.page == STEPS[0].name:
        return tr("This is the first step.")
    return tr("This is the last step.") if name == "next" and facts.page == STEPS[-1].name else ""


class Menus(QObject):
    """Menu bar of a window, and the keys of its entries.

    Parameters
    ----------
    window
        Has the menu bar.
    commands
        What the window does, by the name of the entry: "new", "open", … as in `_fill`; "step NAME" goes to a step.
    open_project
        Opens one of the recent projects.
    exports
        What the open project has to hand over.
    brought
        What the entries of the wings do.
    """

    def __init__(
        self,
        window: QMainWindow,
        settings: AppSettings,
        undo_stack: QUndoStack,
        commands: Mapping[str, Callable[[], object]],
        open_project: Callable[[Path], object],
        exports: QMenu,
        brought: Mapping[MenuEntry, Callable[[], object]],
    ) -> None:
        super().__init__(window)
        self._brought = brought
        self._window, self._settings, self._commands, self._open_project = window, settings, commands, open_project
        self.actions: dict[str, QAction] = {}
        self._tips = {name: tr(meaning) for name, _, meaning in SHORTCUTS}
        self._recent = QMenu(tr("Open &recent"), window)
        self._fill(undo_stack, exports)
        # In the next turn: the entry that opens a project is deleted when that project goes to the top of the list.
        self._recent_changed = Refresh(self._fill_recent, self)
        settings.recent_changed.connect(self._recent_changed.soon)
        self._fill_recent()
        self.refresh(MenuFacts("", frozenset(), job=False))

    def refresh(self, facts: MenuFacts) -> None:
        """Enable each menu entry, or disable it with the reason in its tooltip."""
        needing = {entry.name for entry in self._brought if entry.needs_project}
        for name, action in self.actions.items():
            if name in UNDOING:  # greyed by the stack; hidden, its key means nothing
                action.setVisible(not facts.operator)
            else:
                enable(action, why_not(name, facts, needs_project=name in needing), self._tips.get(name, ""))
        self._recent.setEnabled(not facts.operator and not self._recent.isEmpty())
        self._window.menuBar().setVisible(not facts.operator)

    def _fill(self, undo_stack: QUndoStack, exports: QMenu) -> None:
        bar = self._window.menuBar()
        file = bar.addMenu(tr("&File"))
        self._add(file, "new", tr("&New project …"))
        self._add(file, "open", tr("&Open project …"))
        file.addMenu(self._recent)
        self._add(file, "open set", tr("New project from a recording &set …"))
        self._add(file, "import", tr("&Import pictures …"))
        file.addSeparator()
        self._add(file, "sample", tr("Open sam&ple"))
        self._add(file, "simulated", tr("&Try with the simulated rig"))
        self._add(file, "simulated without fan", tr("Try it with a &line laser and two sheets"))
        file.addSeparator()
        self._add(file, "save", tr("&Save"))
        self._add(file, "next part", tr("Next pa&rt …"))
        self._add(file, "copy", tr("Save a c&opy …"))
        self._add(file, "pack", tr("Pac&k into one file …"))
        self._add(file, "unpack", tr("&Unpack a project …"))
        self.actions["export"] = file.addMenu(exports)
        self._add_brought(file, "export")
        self._add(file, "close", tr("&Close project"))
        self._add(file, "quit", tr("&Quit"))

        edit = bar.addMenu(tr("&Edit"))
        for name, action in (
            ("undo", undo_stack.createUndoAction(self, tr("Undo"))),
            ("redo", undo_stack.createRedoAction(self, tr("Redo"))),
        ):
            action.setShortcuts([QKeySequence(key) for key in KEYS[name].split(", ")])
            edit.addAction(action)
            self.actions[name] = action

        step = bar.addMenu(tr("&Step"))
        step.setToolTipsVisible(True)
        self._add(step, "run", tr("&Do this step"))
        self._add(step, "whole", tr("Measure &everything"))
        self._add(step, "accept", tr("&Accept"))
        self._add(step, "live", tr("&Live source on or off"))
        self._add(step, "capture", tr("Take a &picture"))
        self._add(step, "cancel", tr("&Cancel the running job"))
        step.addSeparator()
        self._add(step, "back", tr("&Back"))
        self._add(step, "next", tr("&Next"))
        for number, entry in enumerate(STEPS, start=1):
            self._add(step, f"step {entry.name}", tr(entry.title)).setShortcut(QKeySequence(f"Ctrl+{number}"))

        view = bar.addMenu(tr("&View"))
        self._add(view, "messages", tr("&Messages"))
        self._add(view, "theme", tr("Light or dark &theme"), self._next_theme)
        self._add(view, "full", tr("&Full screen"), self._full_screen)
        self._add(view, "operator mode", tr("&Operator mode"))
        view.addMenu(self._languages())

        tools = bar.addMenu(tr("&Tools"))
        tools.setToolTipsVisible(True)
        self._add(tools, "console", tr("Python &console"))
        self._add(tools, "many sets", tr("&Measure many sets …"))
        self._add(tools, "script", tr("Save what was done as a &script …"))

        help_menu = bar.addMenu(tr("&Help"))
        self._add(help_menu, "manual", tr("&Manual"))
        self._add(help_menu, "first measurement", tr("&First measurement, step by step"))
        self._add(help_menu, "first measurement, no fan", tr("The same &with a line laser and two sheets"))
        self._add(help_menu, "quick card", tr("&Quick card to print …"))
        self._add(help_menu, "keys", tr("&Keys"), self._show_keys)
        self._add(help_menu, "double click", tr("Open projects by &double click …"))
        self._add(help_menu, "log", tr("Open the &log folder"))
        self._add(help_menu, "about", tr("&About Trisect"), self._about)

    def _add(self, menu: QMenu, name: str, text: str, do: Callable[[], object] | None = None) -> QAction:
        action = QAction(text, self)
        if name in KEYS:
            action.setShortcut(QKeySequence(KEYS[name]))
        do = do or self._commands[name]
        action.triggered.connect(lambda: do())
        menu.addAction(action)
        self.actions[name] = action
        self._add_brought(menu, name)
        return action

    def _add_brought(self, menu: QMenu, after: str) -> None:
        """Add the entries of wings that stand behind the entry `after`."""
        for entry, opens in self._brought.items():
            if entry.after == after and entry.name not in self.actions:
                self._add(menu, entry.name, tr(entry.text), opens)

    def _languages(self) -> QMenu:
        """Each language by its own name, so that it is found in any language."""
        menu, group = QMenu(tr("&Language"), self._window), QActionGroup(self)
        for name in languages():
            action = QAction(own_name(name), group)
            action.setCheckable(True)
            action.setChecked(name == language_name())
            action.triggered.connect(lambda _=False, name=name: setattr(self._settings, "language", name))
            menu.addAction(action)
            self.actions[f"language {name}"] = action
        return menu

    def _fill_recent(self) -> None:
        self._recent.clear()
        for path in self._settings.recent:
            action = self._recent.addAction(path.name)
            action.setToolTip(str(path))
            action.triggered.connect(lambda _=False, path=path: self._open_project(path))
        self._recent.setEnabled(not self._recent.isEmpty())

    def _next_theme(self) -> None:
        self._settings.theme = THEMES[2] if self._settings.theme != THEMES[2] else THEMES[1]

    def _full_screen(self) -> None:
        if self._window.isFullScreen():
            self._window.showNormal()
        else:
            self._window.showFullScreen()

    def _show_keys(self) -> None:
        ShortcutList([(key, tr(meaning)) for _, key, meaning in SHORTCUTS], self._window).exec()

    def _about(self) -> None:
        text = tr(
            "<b>Trisect {version}</b><p>Measures parts with one camera, a fixed three-line laser and a single line "
            "moved by hand.</p><p>Method: Sun et al., Sensors 2023, 23, 13, "
            "<a href='https://doi.org/10.3390/s23010013'>doi:10.3390/s23010013</a>.</p><p>MIT licence.</p>",
            version=__version__,
        )
        QMessageBox.about(self._window, tr("About Trisect"), text)
