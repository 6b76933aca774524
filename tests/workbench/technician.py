"""Somebody at the window: presses what can be pressed, types, answers questions, and waits no longer than told."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import QPoint, Qt, QTimer
from PySide6.QtWidgets import (
    QAbstractButton,
    QApplication,
    QCheckBox,
    QDialog,
    QLineEdit,
    QMessageBox,
    QScrollArea,
    QTabWidget,
    QWidget,
)
from superqt import QCollapsible

from workbench.main_window import MainWindow
from workbench.views import ask
from workbench.views.lists.view_list import CHECK_WIDTH, ViewList
from workbench.views.scene.view import SceneView

PATIENCE_S = 120.0


class Technician:
    """Works at `window` with mouse and keys as a person would."""

    def __init__(self, window: MainWindow, qtbot: Any, monkeypatch: pytest.MonkeyPatch) -> None:
        self.window, self.bench, self.model = window, window.bench, window.model
        self._qtbot, self._patch = qtbot, monkeypatch
        self.clicks = 0
        """So many buttons were pressed."""

    # ---- waiting

    def until(self, true: Callable[[], Any], what: str, seconds: float = PATIENCE_S) -> None:
        """Wait until `true()`; what was waited for and every message so far are told if it does not come."""
        try:
            self._qtbot.waitUntil(lambda: bool(true()), timeout=int(1e3 * seconds))
        except Exception as error:
            raise AssertionError(f"waited {seconds:.0f} s for: {what}; {self.whereabouts()}") from error

    def idle(self, seconds: float = PATIENCE_S) -> None:
        """Wait until nothing is measured and nothing is read."""
        busy = self.bench
        self.until(lambda: not (busy.measuring.busy or busy.quick.busy), "the lanes to be idle", seconds)
        QApplication.processEvents()

    def whereabouts(self) -> str:
        """Where the window stands, in one line."""
        said = [f"{notice.level}: {notice.text}" for notice in self.bench.notices.all]
        page = self.window.current
        stage = getattr(self.window.presenters.get(page), "stage", "")
        lanes = [lane.current.label for lane in self._lanes() if lane.current is not None]
        return f"on page {page!r} ({stage}), running {lanes}, messages {said}"

    def doing(self) -> str:
        """Page and stage, for a report."""
        page = self.window.current
        return f"{page} {getattr(self.window.presenters.get(page), 'stage', '')}"

    def _lanes(self) -> Sequence[Any]:
        return self.bench.measuring, self.bench.quick, self.bench.live

    # ---- mouse and keys

    def activate(self) -> None:
        """Have the window in front: only there widgets get and lose the focus."""
        self.window.activateWindow()
        self.until(self.window.isActiveWindow, "the window to be in front")

    def press(self, button: QAbstractButton | str, seconds: float = PATIENCE_S) -> None:
        """Click a button, or the one of the page that says this, as soon as it is seen and can be clicked."""
        if isinstance(button, str):
            text = button
            self.until(lambda: any(one.isEnabled() for one in self.buttons(text)), f"a button {text!r}", seconds)
            button = next(one for one in self.buttons(text) if one.isEnabled())
        self.until(
            lambda: button.isVisible() and button.isEnabled(), f"{button.text()!r} ({button.toolTip()})", seconds
        )
        self.scroll_to(button)
        self.until(lambda: not button.visibleRegion().isEmpty(), f"{button.text()!r} to be in sight", 5)
        where = button.rect().center()
        if isinstance(button, QCheckBox):
            where.setX(min(10, where.x()))
        self._qtbot.mouseClick(button, Qt.MouseButton.LeftButton, pos=where)
        self.clicks += 1

    def buttons(self, text: str) -> list[QAbstractButton]:
        """The buttons of the page that are seen and say or are called this."""
        found = self.page().findChildren(QAbstractButton)
        return [
            one
            for one in found
            if one.isVisible() and text in (one.text().replace("&", ""), one.accessibleName(), one.toolTip())
        ]

    def field(self, label: str) -> Any:
        """The editor of the page that is called so."""
        found = [one for one in self.page().findChildren(QWidget) if one.accessibleName() == label]
        assert found, f"no field {label!r}; {self.whereabouts()}"
        return found[0]

    def choose(self, label: str, text: str) -> None:
        """Choose an entry of a list that folds out, by the keys."""
        box = self.field(label)
        self.scroll_to(box)
        place = next(place for place in range(box.count()) if box.itemText(place).startswith(text))
        box.setFocus()
        while box.currentIndex() != place:
            self.keys(box, Qt.Key.Key_Down if place > box.currentIndex() else Qt.Key.Key_Up)
        QApplication.processEvents()

    def uncheck(self, title: str) -> None:
        """Take the tick of a row of the page's list away by clicking it."""
        views = next(views for views in self.page().findChildren(ViewList) if views.isVisible())
        row = next(place for place, row in enumerate(views.model.rows) if title in (row.title, row.name))
        assert views.model.rows[row].used
        self.scroll_to(views)
        index = views.model.index(row, 0)
        views.table.scrollTo(index)
        where = views.table.visualRect(index)
        spot = QPoint(where.left() + CHECK_WIDTH // 2, where.center().y())
        self._qtbot.mouseClick(views.table.viewport(), Qt.MouseButton.LeftButton, pos=spot)

    def unfold(self, title: str) -> None:
        """Open a panel at the side."""
        panel = next(one for one in self.page().findChildren(QCollapsible) if one.text() == title)
        panel.expand(animate=False)
        QApplication.processEvents()

    def tab(self, title: str) -> None:
        """Go to a tab of the page by clicking it."""
        for tabs in self.page().findChildren(QTabWidget):
            for place in range(tabs.count()):
                if tabs.tabText(place).startswith(title):
                    bar = tabs.tabBar()
                    self._qtbot.mouseClick(bar, Qt.MouseButton.LeftButton, pos=bar.tabRect(place).center())
                    QApplication.processEvents()
                    assert tabs.currentIndex() == place
                    return
        raise AssertionError(f"no tab {title!r}; {self.whereabouts()}")

    def scroll_to(self, widget: QWidget) -> None:
        """Have a widget of the side panel in sight."""
        above: QWidget | None = widget.parentWidget()
        while above is not None:
            if isinstance(above, QScrollArea):
                above.ensureWidgetVisible(widget)
            above = above.parentWidget()

    def type_in(self, editor: Any, text: str) -> None:
        """Replace what stands in an editor and leave it by Tab."""
        self.activate()
        self.scroll_to(editor)
        editor.setFocus()
        self.until(lambda: self._typing_in(editor) is not None, f"{editor} to take the focus")
        typed = self._typing_in(editor)
        assert typed is not None
        self.keys(typed, "a", Qt.KeyboardModifier.ControlModifier)
        self._qtbot.keyClicks(typed, text)
        self._qtbot.keyClick(typed, Qt.Key.Key_Tab)
        QApplication.processEvents()

    @staticmethod
    def _typing_in(editor: QWidget) -> QWidget | None:
        """The widget of an editor that has the focus."""
        typed = QApplication.focusWidget()
        return typed if typed is not None and (editor is typed or editor.isAncestorOf(typed)) else None

    def write(self, text: str) -> None:
        """Type where the cursor is."""
        self._qtbot.keyClicks(QApplication.focusWidget(), text)

    def keys(self, widget: QWidget, key: Any, modifier: Any = Qt.KeyboardModifier.NoModifier) -> None:
        """One key."""
        self._qtbot.keyClick(widget, key, modifier)

    def shortcut(self, key: Any, modifier: Any = Qt.KeyboardModifier.ControlModifier) -> None:
        """A key of the window, given to whatever has the focus."""
        if QApplication.activeWindow() is None:
            self.activate()
        self._qtbot.keyClick(QApplication.focusWidget() or self.window, key, modifier)
        QApplication.processEvents()

    # ---- windows in between

    @contextmanager
    def meets(self, act: Callable[[Any], None], seconds: float = 10.0) -> Iterator[None]:
        """Inside, one modal window comes up and is dealt with by `act`."""
        met: list[QWidget] = []
        wrong: list[BaseException] = []
        timer = QTimer()
        timer.setInterval(20)

        def look() -> None:
            modal = QApplication.activeModalWidget()
            if modal is None or not modal.isVisible() or met:
                return
            met.append(modal)
            try:
                act(modal)
            except BaseException as error:  # noqa: BLE001  told below; the dialog must not stay open
                wrong.append(error)
            finally:
                if modal.isVisible():
                    modal.close()

        timer.timeout.connect(look)
        timer.start()
        try:
            yield
            self.until(lambda: met, "a question", seconds)
        finally:
            timer.stop()
        if wrong:
            raise wrong[0]
        if self.window.isVisible():
            self.activate()

    @contextmanager
    def answers(self, *answers: str) -> Iterator[list[str]]:
        """Inside, questions come up one after another, each answered by the button of that text; gives the questions.

        All of them must come, and no other.
        """
        asked: list[str] = []
        wrong: list[BaseException] = []
        timer = QTimer()
        timer.setInterval(20)

        def look() -> None:
            box = QApplication.activeModalWidget()
            if not isinstance(box, QMessageBox) or not box.isVisible() or box.property("answered"):
                return
            box.setProperty("answered", True)
            asked.append(box.text())
            try:
                wanted = answers[len(asked) - 1]
                button = next(button for button in box.buttons() if button.text().replace("&", "") == wanted)
                self._qtbot.mouseClick(button, Qt.MouseButton.LeftButton)
            except (IndexError, StopIteration):
                offered = [button.text() for button in box.buttons()]
                wrong.append(AssertionError(f"asked {box.text()!r}, offered {offered}, expected {answers}"))
            finally:
                if box.isVisible():
                    box.close()

        timer.timeout.connect(look)
        timer.start()
        try:
            yield asked
            self.until(lambda: wrong or len(asked) == len(answers), f"questions to be answered with {answers}", 10)
        finally:
            timer.stop()
        if wrong:
            raise wrong[0]
        if self.window.isVisible():
            self.activate()

    @contextmanager
    def names_project(self, name: str) -> Iterator[None]:
        """Inside, the name of a new project is asked for."""

        def act(dialog: QDialog) -> None:
            field = dialog.findChildren(QLineEdit)[0]
            self.keys(field, "a", Qt.KeyboardModifier.ControlModifier)
            self._qtbot.keyClicks(field, name)
            self._qtbot.keyClick(field, Qt.Key.Key_Return)

        with self.meets(act):
            yield

    def will_choose(self, path: Path) -> None:
        """The system's own window for folders and files gives this path from now on."""
        self._patch.setattr(ask, "choose_folder", lambda *_: path)
        self._patch.setattr(ask, "choose_file_to_save", lambda *_: path)

    # ---- steps

    def new_project(self, name: str) -> Path:
        """Make a project from the welcome page; its folder."""
        with self.names_project(name):
            self.press(self.window.welcome.new)
        self.until(lambda: self.model.is_open, "the new project to be open")
        assert self.model.folder is not None
        return self.model.folder

    def next(self, seconds: float = PATIENCE_S) -> None:
        """Go on to the next page by its button, as soon as it can be pressed."""
        before = self.window.current
        self.until(self.window.next.isEnabled, f"Next: {self.window.next.toolTip()}", seconds)
        self.press(self.window.next)
        assert self.window.current != before
        QApplication.processEvents()

    def page(self) -> Any:
        """The page that is shown."""
        return self.window.pages[self.window.current]

    def presenter(self) -> Any:
        """Its presenter."""
        return self.window.presenters[self.window.current]

    def scenes(self) -> list[SceneView]:
        """The 3D views of the page."""
        return self.page().findChildren(SceneView)

    def told(self) -> list[str]:
        """All messages."""
        return [notice.text for notice in self.bench.notices.all]

    def errors(self) -> list[str]:
        """Messages that are not good to hear, but for what only this machine is to blame for."""
        said = [notice.text for notice in self.bench.notices.all if notice.level != "info"]
        return [text for text in said if "OpenGL" not in text and "pictures were lost on the way" not in text]
