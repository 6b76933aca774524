"""Somebody who plays with the window: random clicks, keys, pages, themes, sizes, cancels, undo, close and open.

`python -m tests.workbench.monkey --seconds 1800 --seed 1` plays on a copy of the sample project; the same seed does the
same as far as the machine's pace lets it. Python's fault handler tells where a crash was, the last deeds are told with
whatever went wrong. Nothing may: no exception, no Qt warning, no widget without a parent, nothing left behind at the
end. All deeds stand in FOLDER/deeds.txt, where a program that crashed or hangs leaves them.
"""

from __future__ import annotations

import argparse
import faulthandler
import gc
import os
import random
import shutil
import sys
import tempfile
import threading
import time
import traceback
import uuid
from collections import Counter, deque
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TextIO
from unittest import mock

if not os.environ.get("DISPLAY"):
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

import shiboken6
from PySide6.QtCore import (
    QCoreApplication,
    QEvent,
    QMessageLogContext,
    QObject,
    QPoint,
    Qt,
    QTimer,
    QtMsgType,
    qInstallMessageHandler,
)
from PySide6.QtGui import QDesktopServices, QDrag
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QApplication, QDialog, QMenu, QMessageBox, QTabBar, QWidget

from tests.workbench import screen
from tests.workbench.parentless import parentless
from workbench.app import build_window
from workbench.bench import Bench, make_bench
from workbench.main_window import MainWindow
from workbench.settings import AppSettings
from workbench.steps import STEPS
from workbench.views import ask
from workbench.views.stage_card import StageCard
from workbench.wing import window_wings
from workbench.work.process import WorkerProcess

KEYS = (
    Qt.Key.Key_Tab, Qt.Key.Key_Return, Qt.Key.Key_Escape, Qt.Key.Key_Space, Qt.Key.Key_Delete, Qt.Key.Key_Left,
    Qt.Key.Key_Right, Qt.Key.Key_Up, Qt.Key.Key_Down, Qt.Key.Key_F, Qt.Key.Key_R, Qt.Key.Key_1, Qt.Key.Key_7,
)  # fmt: skip

DIALOGS = (
    "new", "import", "next part", "copy", "keys", "double click", "many sets", "manual",
    *(entry.name for wing in window_wings() for entry in wing.entries),
)  # fmt: skip
"""Entries of the menus that open a window of their own, those of the wings among them."""

HARMLESS = ("This plugin does not support", "propagateSizeHints", "raise()", "OpenGL", "libGL", "MESA", "QXcbClipboard")
"""What platforms without a screen or a graphics card say, whatever is shown."""

TURN_MS = 15
"""A deed every so many milliseconds."""

PARENTS_EVERY = 20
"""After so many deeds each widget is asked whether it has a parent."""

LAST_DEEDS = 25
"""So many are told with what went wrong."""

SLOWEST_S = 60.0
"""The window must answer within this time; else where it hangs is told, and the program ends."""


LEFT_WITHIN_S = 20.0
"""A recording that is still being written when the window is closed ends within this time, and so do processes."""

MARK = "TRISECT_MONKEY"
"""Variable of the environment by which processes are known that were started while the window was played with."""

TRACKER = "multiprocessing.resource_tracker"
"""Python's own process, which ends with the one that started it."""


@dataclass
class Played:
    """What came of it."""

    seed: int
    deeds: Counter[str] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        what = ", ".join(f"{count} {name}" for name, count in self.deeds.most_common())
        return f"seed {self.seed}: {sum(self.deeds.values())} deeds ({what}); wrong: {len(self.wrong)}"


class Monkey(QObject):
    """Does one random thing after another at a window, each in a turn of its own of the event loop."""

    def __init__(self, window: MainWindow, project: Path, played: Played, diary: TextIO) -> None:
        super().__init__()
        self.window, self.project, self.played, self._diary = window, project, played, diary
        self.random = random.Random(played.seed)
        self.last: deque[str] = deque(maxlen=LAST_DEEDS)
        self._depth, self._leaving_since = 0, 0.0
        self._playing = self._ended = False
        self._parentless: set[str] = set()

    def play(self, seconds: float) -> None:
        """Let it play for so long, from the event loop as in the program."""
        self._playing = True
        QTimer.singleShot(TURN_MS, self, self._turn)
        QTimer.singleShot(int(1000 * seconds), self, self._stop)
        QApplication.exec()
        self._playing, self._ended = False, True

    def note(self, wrong: str) -> None:
        """Something went wrong: remember it with the last deeds."""
        self.played.wrong.append(f"{wrong}\n  after: " + "; ".join(self.last))

    def _stop(self) -> None:
        """Close what blocks first: the program's loop ends only after those within it."""
        if self._ended:
            return
        self._playing = False
        QTimer.singleShot(TURN_MS, self, self._stop)  # again: a question may just be about to come up
        blocking = QApplication.activePopupWidget() or QApplication.activeModalWidget()
        if blocking is not None:
            blocking.close()
        elif self._depth:
            QDrag.cancel()
        else:
            QApplication.exit()  # not `quit`: a window that asks what becomes of a recording would refuse it

    def _turn(self) -> None:
        if not self._playing:
            return
        # A timer of its own for each turn: one that fires does not fire again while a question is asked within it.
        QTimer.singleShot(TURN_MS, self, self._turn)
        _watch_for_a_hang()
        blocking = QApplication.activePopupWidget() or QApplication.activeModalWidget()
        if blocking is not None:
            self._answer(blocking)
            return
        if self._depth:
            QDrag.cancel()  # a drag of text ends with the mouse of a person, which nobody moves here
            return  # a question is about to come up, or about to go
        if not self.window.isEnabled():
            self._wait_until_left()
            return
        self._leaving_since = 0.0
        deeds = {
            self._click: 40, self._key: 12, self._go: 8, self._drag: 5, self._tab: 5, self._undo: 5, self._wheel: 4,
            self._resize: 2, self._theme: 1, self._cancel: 4, self._menu: 3, self._close_and_open: 1, self._type: 3,
            self._console: 1, self._dialog: 2, self._pull_down: 1, self._delete_and_theme: 2,
        }  # fmt: skip
        self._look_at_the_cards()
        if self.played.deeds.total() % PARENTS_EVERY == 0:
            self._look_for_parents()
        deed = self.random.choices(list(deeds), list(deeds.values()))[0]
        self.played.deeds[deed.__name__.strip("_")] += 1
        self._depth += 1
        try:
            deed()
        finally:
            self._depth -= 1

    def _look_at_the_cards(self) -> None:
        """A grey button says why; the one that is the next thing to do can be pressed, and is the only one."""
        for card in self.window.findChildren(StageCard):
            if not card.isVisible():
                continue
            buttons = [button for button in card.buttons.values() if button.isVisible()]
            silent = [button.text() for button in buttons if not button.isEnabled() and not button.toolTip()]
            if silent:
                self.note(f"on the page {self.window.current} {silent} are grey and do not say why")
            primary = [button for button in buttons if button.property("primary")]
            if len(primary) > 1:
                self.note(f"on the page {self.window.current} two buttons are the next thing to do")

    def _look_for_parents(self) -> None:
        """Each widget has a parent, which deletes it; one without is told once."""
        app = QApplication.instance()
        assert isinstance(app, QApplication)
        if new := set(parentless(app)) - self._parentless:
            self._parentless |= new
            self.note(f"without a parent: {sorted(new)}")

    def _wait_until_left(self) -> None:
        """A recording is being ended: the window takes no input, for a moment."""
        self._leaving_since = self._leaving_since or time.monotonic()
        if time.monotonic() - self._leaving_since > LEFT_WITHIN_S:
            self.note("the project is never left")
            self._leaving_since = time.monotonic()

    def _did(self, what: str) -> None:
        self.last.append(what)
        self._diary.write(f"{time.monotonic():.1f} {what}\n")

    def _answer(self, widget: QWidget) -> None:
        self.played.deeds["answer"] += 1
        self._did(f"answer {type(widget).__name__} {widget.windowTitle()!r}")
        if isinstance(widget, QMenu):
            actions = [one for one in widget.actions() if one.isEnabled() and not one.menu() and not one.isSeparator()]
            if actions and self.random.random() < 0.5:
                QTest.mouseClick(widget, Qt.MouseButton.LeftButton, pos=widget.actionGeometry(actions[0]).center())
            else:
                widget.close()
        elif isinstance(widget, QMessageBox) and widget.buttons() and self.random.random() < 0.8:
            self.random.choice(widget.buttons()).click()
        elif isinstance(widget, QDialog):
            widget.done(self.random.choice((0, 0, 1)))
        else:
            widget.close()

    def _widgets(self, kind: type[QWidget] = QWidget) -> list[Any]:
        return [one for one in self.window.findChildren(kind) if one.isVisible() and not one.visibleRegion().isEmpty()]

    def _point(self, widget: QWidget) -> QPoint:
        return QPoint(self.random.randrange(max(1, widget.width())), self.random.randrange(max(1, widget.height())))

    def _click(self) -> None:
        kind = QAbstractButton if self.random.random() < 0.6 else QWidget
        if found := self._widgets(kind):
            widget = self.random.choice(found)
            text = getattr(widget, "text", None)  # some widgets call something else so
            self._did(f"click {type(widget).__name__} {text() if callable(text) else ''!r:.40}")
            at = widget.rect().center() if kind is QAbstractButton else self._point(widget)
            button = Qt.MouseButton.RightButton if self.random.random() < 0.05 else Qt.MouseButton.LeftButton
            if self.random.random() < 0.06:
                QTest.mouseDClick(widget, button, pos=at)
            else:
                QTest.mouseClick(widget, button, pos=at)

    def _drag(self) -> None:
        if found := self._widgets():
            widget = self.random.choice(found)
            self._did(f"drag {type(widget).__name__}")
            QTest.mousePress(widget, Qt.MouseButton.LeftButton, pos=self._point(widget))
            for _ in range(3):
                if not shiboken6.isValid(widget):
                    return
                QTest.mouseMove(widget, self._point(widget))
            QTest.mouseRelease(widget, Qt.MouseButton.LeftButton, pos=self._point(widget))

    def _wheel(self) -> None:
        from PySide6.QtCore import QPointF
        from PySide6.QtGui import QWheelEvent

        if found := self._widgets():
            widget = self.random.choice(found)
            at, by = QPointF(self._point(widget)), QPoint(0, self.random.choice((-240, -120, 120, 240)))
            self._did(f"wheel {type(widget).__name__}")
            QCoreApplication.postEvent(
                widget,
                QWheelEvent(
                    at, QPointF(widget.mapToGlobal(at.toPoint())), QPoint(), by, Qt.MouseButton.NoButton,
                    Qt.KeyboardModifier.NoModifier, Qt.ScrollPhase.NoScrollPhase, False,
                ),
            )  # fmt: skip

    def _key(self) -> None:
        widget = QApplication.focusWidget() or self.window
        key = self.random.choice(KEYS)
        self._did(f"key {key.name} in {type(widget).__name__}")
        QTest.keyClick(widget, key)

    def _type(self) -> None:
        widget = QApplication.focusWidget()
        if widget is not None:
            text = self.random.choice(("12.5", "-1", "Block", "0", "1e9", "a;b"))
            self._did(f"type {text!r} in {type(widget).__name__}")
            QTest.keyClicks(widget, text)

    def _go(self) -> None:
        step = self.random.choice(STEPS).name
        self._did(f"go to {step}")
        self.window.go_to(step)

    def _tab(self) -> None:
        if bars := self._widgets(QTabBar):
            bar = self.random.choice(bars)
            self._did("tab")
            bar.setCurrentIndex(self.random.randrange(max(1, bar.count())))

    def _undo(self) -> None:
        self._did("undo or redo")
        stack = self.window.model.undo_stack
        (stack.undo if self.random.random() < 0.6 else stack.redo)()

    def _resize(self) -> None:
        self._did("resize")
        self.window.resize(self.random.randrange(900, 1800), self.random.randrange(680, 1040))

    def _theme(self) -> None:
        self._did("theme")
        self.window.bench.settings.theme = self.random.choice(("light", "dark"))

    def _cancel(self) -> None:
        self._did("cancel")
        if self.random.random() < 0.5:
            self.window.cancel_task()
        else:
            self.window.bench.quick.cancel_all()

    def _menu(self) -> None:
        names = [name for name in self.window.menus.actions if name not in ("quit", "log", "about", "double click")]
        name = self.random.choice(names)
        self._did(f"menu {name}")
        self.window.menus.actions[name].trigger()

    def _pull_down(self) -> None:
        """Pull a menu down; what comes of it is chosen or closed in the next turn."""
        if menus := [one for one in self.window.menuBar().findChildren(QMenu) if not one.isEmpty()]:
            menu = self.random.choice(menus)
            self._did(f"pull down {menu.title()!r}")
            menu.popup(self.window.mapToGlobal(QPoint(60, 60)))

    def _dialog(self) -> None:
        """Open one of the windows over this one; it is answered, mostly rejected, in the next turn, or closed later."""
        action = self.window.menus.actions[self.random.choice(DIALOGS)]
        if action.isEnabled():
            self._did(f"dialog {action.text()!r}")
            action.trigger()

    def _console(self) -> None:
        """Open the console, or close it: before it has begun, while it starts, or while it is used."""
        console = self.window.console
        if console.window is not None:
            self._did("close the console")
            console.window.close()
        elif self.window.menus.actions["console"].isEnabled():
            self._did("open the console")
            console.open()

    def _delete_and_theme(self) -> None:
        """Close other windows, delete at once or later what is to be deleted, and change the theme in that state."""
        self._did("delete, then theme")
        for other in QApplication.topLevelWidgets():
            if other is not self.window and other.isVisible() and other.isWindow():
                other.close()
        if self.random.random() < 0.5:
            QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
        if self.random.random() < 0.5:
            gc.collect()
        settings = self.window.bench.settings
        settings.theme = "light" if settings.theme == "dark" else "dark"

    def _close_and_open(self) -> None:
        self._did("close and open")
        self.window.projects.close_project(lambda: self.window.projects.open_project(self.project))


def play(seconds: float, seed: int, folder: Path, sample: Path | None = None) -> Played:
    """Play on a copy of `sample` in `folder`, and look at the end whether anything is left.

    Without a `sample` the program's own is made, which takes a minute.
    """
    played = Played(seed)
    app = QApplication.instance() or QApplication(["trisect"])
    assert isinstance(app, QApplication)
    threads, widgets = set(threading.enumerate()), set(map(id, app.topLevelWidgets()))
    mark = mark_processes()
    project = folder / "sample"
    if sample is None:
        from core.pipeline.project.sample_project import sample_project

        sample_project(project)
    else:
        shutil.copytree(sample, project)
    settings = AppSettings(folder / "settings.ini")
    settings.projects_folder = folder / "projects"
    bench = make_bench(settings)
    window = build_window(app, bench, "light")
    diary = (folder / "deeds.txt").open("w", buffering=1, encoding="utf-8")
    monkey = Monkey(window, project, played, diary)

    def raised(kind: type[BaseException], value: BaseException | None, trace: Any) -> None:
        monkey.note("".join(traceback.format_exception(kind, value, trace)))

    def qt_says(kind: QtMsgType, context: QMessageLogContext, text: str | None) -> None:
        if kind not in (QtMsgType.QtDebugMsg, QtMsgType.QtInfoMsg) and not any(one in str(text) for one in HARMLESS):
            monkey.note(f"Qt: {text}")

    before = sys.excepthook, sys.unraisablehook, qInstallMessageHandler(qt_says)
    sys.excepthook, sys.unraisablehook = raised, lambda it: raised(it.exc_type, it.exc_value, it.exc_traceback)
    try:
        with _nobody_else_asks(folder):
            window.resize(1280, 800)
            window.show()
            window.projects.open_project(project)
            monkey.play(seconds)
            _end(window, bench, monkey)
        _look_for_leftovers(app, monkey, threads, widgets)
        _look_for_processes(app, monkey, mark)
    finally:
        os.environ.pop(MARK)
        faulthandler.cancel_dump_traceback_later()
        diary.close()
        sys.excepthook, sys.unraisablehook = before[:2]
        qInstallMessageHandler(before[2])
    return played


def _watch_for_a_hang() -> None:
    """What comes next must be over within SLOWEST_S."""
    faulthandler.dump_traceback_later(SLOWEST_S, exit=True)


def _end(window: MainWindow, bench: Bench, monkey: Monkey) -> None:
    _watch_for_a_hang()
    while (blocking := QApplication.activePopupWidget() or QApplication.activeModalWidget()) is not None:
        blocking.close()
        QCoreApplication.processEvents()
    with mock.patch.object(ask, "ask", lambda *_, **__: 0):
        deadline = time.monotonic() + LEFT_WITHIN_S
        while not window.leave() and time.monotonic() < deadline:
            QCoreApplication.processEvents()
            time.sleep(0.01)
        if not window.leave():
            monkey.note("the window cannot be left")
    bench.close()
    bench.wait_until_closed()
    for lane in (bench.measuring, bench.quick, bench.live):
        QCoreApplication.processEvents()
        QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
        left = [each for each in lane.findChildren(QObject) if not isinstance(each, QTimer)]
        if left:
            monkey.note(f"left in lane {lane.name}: {left}")
        if lane.findChildren(WorkerProcess):
            monkey.note(f"a process of lane {lane.name} is left")
    window.deleteLater()
    window.bench.settings.theme_changed.disconnect()


def _look_for_leftovers(app: QApplication, monkey: Monkey, threads: set[Any], widgets: set[int]) -> None:
    monkey.window = None  # type: ignore[assignment]
    for _ in range(3):
        _watch_for_a_hang()
        app.processEvents()
        app.sendPostedEvents(None, QEvent.Type.DeferredDelete)
        gc.collect()
    there = [one for one in app.topLevelWidgets() if id(one) not in widgets and shiboken6.isValid(one)]
    shown = Counter(type(one).__name__ for one in there if one.isVisible() or isinstance(one, (MainWindow, QDialog)))
    if shown:
        monkey.note(f"windows left: {dict(shown)}")
    late = [thread for thread in threading.enumerate() if thread not in threads and thread.name != "pyvista import"]
    if late:
        monkey.note(f"threads left: {late}")


def mark_processes() -> str:
    """Have every process that is started from now on, and those it starts, bear a mark."""
    os.environ[MARK] = mark = uuid.uuid4().hex
    return mark


def marked_processes(mark: str) -> list[str]:
    """Number and command of each process with the mark that runs, or that nobody has waited for; on Linux only."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            state, parent = (folder / "stat").read_text().rpartition(")")[2].split()[:2]
            given = (folder / "environ").read_bytes() if state != "Z" else b""
            command = (folder / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace").strip()
        except OSError:
            continue  # it has ended, or is another user's
        if f"{MARK}={mark}".encode() in given.split(b"\0") or (state == "Z" and int(parent) == os.getpid()):
            found.append(f"{folder.name}: {command or 'has ended, but nobody has waited for it'}")
    return found


def _look_for_processes(app: QApplication, monkey: Monkey, mark: str) -> None:
    """Lanes, console, trials of drawing: whatever was started, and what that started, is gone with the window."""
    deadline = time.monotonic() + LEFT_WITHIN_S
    while (left := [one for one in marked_processes(mark) if TRACKER not in one]) and time.monotonic() < deadline:
        _watch_for_a_hang()
        app.processEvents()
        time.sleep(0.05)
    if left:
        monkey.note(f"processes left: {left}")


def _nobody_else_asks(folder: Path) -> Any:
    """The system's own dialogs do not come up: nobody could answer them."""
    from contextlib import ExitStack

    stack = ExitStack()
    for name in ("choose_folder", "choose_file_to_open", "choose_file_to_save"):
        if hasattr(ask, name):
            stack.enter_context(mock.patch.object(ask, name, lambda *_, **__: None))
    stack.enter_context(mock.patch.object(QDesktopServices, "openUrl", lambda *_: True))
    return stack


def main() -> int:
    """Play as long as the arguments say; 1 if anything went wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--project", type=Path, help="a project to play on a copy of; else the sample")
    given = parser.parse_args()
    faulthandler.enable()
    server = screen.open_screen() if os.environ.get(screen.WANTED) == "1" else None
    begun = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="trisect-monkey-", ignore_cleanup_errors=True) as folder:
        print(f"deeds: {folder}/deeds.txt", file=sys.stderr, flush=True)
        project = given.project.resolve() if given.project is not None else None
        os.chdir(folder)  # what is saved under a name alone goes there
        played = play(given.seconds, given.seed, Path(folder), project)
    print(*(f"WRONG: {one}" for one in played.wrong), sep="\n")
    print(played, f"in {time.monotonic() - begun:.0f} s")
    if server is not None:
        server.terminate()
    return 1 if played.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
