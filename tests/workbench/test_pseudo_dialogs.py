"""Pages, menus and dialogs, each opened as a user opens it: no text past the catalogues, and none that is cut."""

from __future__ import annotations

import re
from itertools import filterfalse
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import QTimer
from PySide6.QtGui import QContextMenuEvent, QKeySequence
from PySide6.QtWidgets import (
    QAbstractButton,
    QApplication,
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QMenu,
    QTableView,
    QWidget,
)
from superqt import QCollapsible

from core.files.project.data import new_project
from core.translations import PSEUDO
from tests.translations import catalogue
from tests.workbench.clipped import clipped
from tests.workbench.pseudo import FOREIGN, english, is_never_shown, texts_of, told_past_the_catalogues
from tests.workbench.test_fit import SCREEN, window_in
from workbench.bench import Bench
from workbench.main_window import MainWindow
from workbench.steps import STEPS
from workbench.views.image.view import ImageView
from workbench.views.lists.shortcut_list import native
from workbench.views.plots.base import Plot
from workbench.wing import window_wings

OPENED = (
    "new", "open", "open set", "import", "next part", "copy", "pack", "unpack", "quick card",
    *(entry.name for wing in window_wings() for entry in wing.entries), "script", "keys", "double click", "about",
)  # fmt: skip
"""The entries of the menus that open a dialog."""
ALIKE = (
    "CSV", "PĎF", "All Files",  # kinds of files; the last one is Qt's, in Qt's own words
    "Alt", "Left", "Right", "Return", "Space", "PgDown", "PgUp", "Esc",  # keys, which Qt translates into real languages
)  # fmt: skip


class Opened:
    """Looks at each menu and dialog that is open, presses what opens another one in it, and closes it.

    Parameters
    ----------
    foreign
        What is called the same in every language.
    """

    def __init__(self, foreign: re.Pattern[str]) -> None:
        self.seen: list[str] = []
        self.past: dict[str, str] = {}
        self.cut: dict[str, dict[str, str]] = {}
        self.pressed: list[QAbstractButton] = []
        self.strange = 0
        """Texts in the pseudo-language on the page that has the most."""
        self._done: list[QDialog] = []
        self._foreign, self._open = foreign, True
        self._again()

    def stop(self) -> None:
        self._open = False

    def page(self, window: QWidget, name: str) -> None:
        """Note what is past the catalogues on a page; test_fit looks at what is cut."""
        self._note_past(window, name)
        strange = sum("⟦" in text for one in window.findChildren(QWidget) for text in texts_of(one))
        self.strange = max(self.strange, strange)

    def menu(self, menu: QMenu) -> None:
        """Look at a menu as it is when it opens."""
        menu.aboutToShow.emit()
        self.note(menu, f"menu {menu.title() or type(menu.parent()).__name__}")

    def _again(self) -> None:
        QTimer.singleShot(10, self._look)

    def _look(self) -> None:
        if not self._open:
            return
        self._again()  # first: what is pressed below may open a dialog, and comes back when that is closed
        popup, dialog = QApplication.activePopupWidget(), QApplication.activeModalWidget()
        if isinstance(popup, QMenu):
            self.note(popup, f"menu of {type(popup.parent()).__name__}")
            popup.close()
        elif isinstance(dialog, QDialog) and dialog not in self._done:
            self._done.append(dialog)
            self.note(dialog, f"{type(dialog).__name__} {dialog.windowTitle()}")
            for button in () if isinstance(dialog, QFileDialog) else opening_buttons(dialog):
                button.click()
            dialog.reject()

    def note(self, window: QWidget, name: str) -> None:
        """Note what is past the catalogues in it, and what is cut."""
        self.seen.append(name)
        if isinstance(window, QFileDialog):  # the rest of it is Qt's, or the system's
            told = [window.windowTitle(), *(re.sub(r"\(\*[^)]*\)", "", kind) for kind in window.nameFilters())]
            self.past |= {text: name for text in told if english(self._foreign.sub(" ", text))}
            return
        self._note_past(window, name)
        if isinstance(window, QMenu):
            if window.sizeHint().height() > SCREEN.height() or window.sizeHint().width() > SCREEN.width():
                self.cut[name] = {window.title(): f"needs {window.sizeHint().toTuple()}"}
        elif cut := clipped(window):
            self.cut[name] = cut

    def _note_past(self, window: QWidget, name: str) -> None:
        qts = of_qt(window)
        self.past |= {
            text: f"{name}: {where}"
            for text, where in told_past_the_catalogues(window, self._foreign).items()
            if text.replace("&", "") not in qts
        }


def of_qt(window: QWidget) -> set[str]:
    """What the standard buttons of a dialog say, which Qt translates itself, into real languages only."""
    boxes = window.findChildren(QDialogButtonBox)
    return {
        button.text().replace("&", "")
        for box in boxes
        for button in box.buttons()
        if box.standardButton(button) is not QDialogButtonBox.StandardButton.NoButton
    }


def opening_buttons(window: QWidget) -> list[QAbstractButton]:
    """Buttons that are seen, can be pressed, and open a dialog: an ellipsis says so."""
    buttons = window.findChildren(QAbstractButton)
    return [one for one in buttons if one.isVisible() and one.isEnabled() and "…" in one.text()]


def ask_for_its_menu(widget: QWidget) -> None:
    """What the right button of the mouse does on a widget."""
    where = widget.rect().center()
    if isinstance(widget, QTableView):
        widget.customContextMenuRequested.emit(where)
    else:
        event = QContextMenuEvent(QContextMenuEvent.Reason.Mouse, where, widget.mapToGlobal(where))
        widget.contextMenuEvent(event)


def open_all(window: MainWindow, opened: Opened, bench: Bench, qtbot: Any) -> None:
    """Everything of the pages that opens, their panels unfolded."""
    for step in STEPS:
        window.go_to(step.name)
        page: Any = window.pages[step.name]
        for panel in page.findChildren(QCollapsible):
            panel.expand(animate=False)
        tabs: Any = getattr(page, "tabs", None)
        for tab in range(tabs.count()) if tabs is not None else (0,):
            if tabs is not None:
                tabs.setCurrentIndex(tab)
            qtbot.wait(20)
            qtbot.waitUntil(lambda: not bench.quick.busy, timeout=60_000)
            for button in opening_buttons(page):
                if button not in opened.pressed:
                    opened.pressed.append(button)
                    button.click()
                    qtbot.wait(20)
                    opened.note(window, f"{step.name} after {button.text()}")  # an editor opens within the page
            for kind in (ImageView, Plot, QTableView):
                for widget in filter(QWidget.isVisible, page.findChildren(kind)):
                    ask_for_its_menu(widget)
        for menu in filterfalse(is_never_shown, page.findChildren(QMenu)):
            opened.menu(menu)
        if bench.model.results:
            opened.page(window, step.name)


@pytest.mark.parametrize(
    "name", [PSEUDO, *(pytest.param(name, marks=pytest.mark.accuracy) for name in ("de", "zh_CN"))]
)
def test_no_text_of_a_page_menu_or_dialog_is_past_the_catalogues_and_none_of_these_is_cut(
    bench: Bench, qapp: QApplication, qtbot: Any, measured_project: Path, tmp_path: Path, name: str
) -> None:
    with window_in(name, bench, qapp, qtbot) as window:
        window.resize(1280, 800)
        bench.model.create(tmp_path / "empty", new_project("Block"))
        alike = ("Block", "Gauge block", "Somebody", measured_project.name, *FOREIGN, *ALIKE)
        opened = Opened(re.compile("|".join(rf"\b{one}\b" for one in alike)))
        for menu in filterfalse(is_never_shown, window.findChildren(QMenu)):
            opened.menu(menu)
        open_all(window, opened, bench, qtbot)
        bench.model.open(measured_project)
        for entry in OPENED:
            assert window.menus.actions[entry].isEnabled(), entry
            window.menus.actions[entry].trigger()
        open_all(window, opened, bench, qtbot)
        opened.stop()
    assert len(set(opened.seen)) > 35
    assert opened.cut == {}
    if name == PSEUDO:
        assert opened.past == {}
        assert opened.strange > 500, "the window does speak the pseudo-language"


@pytest.mark.parametrize("name", ["de", "zh_CN"])
def test_keys_are_called_in_texts_as_in_menus(bench: Bench, qapp: QApplication, qtbot: Any, name: str) -> None:
    with window_in(name, bench, qapp, qtbot) as window:
        shown = window.menus.actions["next part"].shortcut().toString(QKeySequence.SequenceFormat.NativeText)
        assert native("PgUp, Ctrl+Shift+N … ?").endswith(f", {shown} … ?")
        texts = [(text.id, str(text.string)) for text in catalogue(name) if isinstance(text.id, str)]
        keys = [(key, said) for text, said in texts for key in re.findall(r"(?:(?:Ctrl|Shift|Alt)\+)+(?:\w+|\.)", text)]
        assert len(keys) > 10
        assert [(key, said) for key, said in keys if native(key) not in said] == []
