"""The Python console: it reads the open project, calculates elsewhere, tells of changes, and leaves nothing behind."""

from __future__ import annotations

import itertools
import os
import signal
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QCoreApplication, QEvent, QTimer
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QApplication

from core.files.project.data import new_project
from core.files.results.rig_history import DATA
from tests.workbench.technician import Technician
from workbench.main_window import MainWindow
from workbench.menus import MenuFacts, why_not
from workbench.views import console as console_view
from workbench.views.console import ConsoleWindow

LONGEST_TURN_S = 0.5
"""Of processor time between two turns of the event loop: drawing 500 new lines takes a tenth of a second."""


def opened(t: Technician) -> ConsoleWindow:
    """The console, from the menu."""
    t.window.menus.actions["console"].trigger()
    assert t.window.console.window is not None
    return t.window.console.window


def ready(console: ConsoleWindow) -> bool:
    return console.console is not None and bool(console.console.isEnabled())


@pytest.fixture
def threads() -> set[threading.Thread]:
    """Those that were there before the console."""
    return set(threading.enumerate())


@pytest.fixture
def console(technician: Technician, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ConsoleWindow]:
    """The console of a project, ready to be typed into."""
    pytest.importorskip("qtconsole", reason="of the extra `console`, which is not installed")
    monkeypatch.setenv(DATA, str(tmp_path / "data"))
    technician.model.create(tmp_path / "block", new_project("block"))
    shown = opened(technician)
    technician.until(lambda: ready(shown), "the console to be ready")
    yield shown
    technician.window.console.end(wait=True)


def answer(t: Technician, console: ConsoleWindow, code: str, awaited: str) -> None:
    """Have it calculated; ends when `awaited` is shown."""
    console.console.execute(code)
    t.until(lambda: awaited in console.console._control.toPlainText(), f"{awaited} as the answer to {code}", 30)
    t.until(lambda: not console.interrupt.isEnabled(), "its end to be told")


def test_the_console_has_the_project_calculates_elsewhere_and_gets_another_process_where_its_own_dies(
    technician: Technician, threads: set[threading.Thread], console: ConsoleWindow
) -> None:
    """One console for all of it: its process takes seconds to start."""
    tells_what_is_written_meanwhile_and_reads_it_when_it_is_opened_anew(technician, console)
    has_the_project_and_numpy_and_no_thread_in_the_window(technician, threads, console)
    is_calculating_while_a_line_begins_before_the_answer_to_the_last_has_come(console)
    for code in ("for i in range(10**12): print(i)", "import time; time.sleep(1000)"):
        calculate_and_stop(technician, console, code)
    starts_another_process_when_its_own_dies(technician, console)


def has_the_project_and_numpy_and_no_thread_in_the_window(
    technician: Technician, threads: set[threading.Thread], console: ConsoleWindow
) -> None:
    answer(technician, console, "project.settings.info.name, np.pi > 3", "('other', True)")
    assert set(threading.enumerate()) <= threads


def tells_what_is_written_meanwhile_and_reads_it_when_it_is_opened_anew(
    technician: Technician, console: ConsoleWindow
) -> None:
    answer(technician, console, "project.changed", "Out[1]: False")
    assert not console.anew.isEnabled()
    project = technician.model.project
    technician.model.edit("name", replace(project, info=replace(project.info, name="other")))
    assert console.anew.isEnabled() and "has changed" in console.state.text()
    technician.model.save()
    answer(technician, console, "project.settings.info.name", "open it again: project = project.opened_again()")
    console.anew.click()
    technician.until(lambda: not console.interrupt.isEnabled(), "the project to be opened")
    answer(technician, console, "project.settings.info.name", "'other'")
    assert not console.anew.isEnabled()


def is_calculating_while_a_line_begins_before_the_answer_to_the_last_has_come(console: ConsoleWindow) -> None:
    console.console.executing.emit("first")
    console.console.executing.emit("second")
    console.console.executed.emit({"content": {}})
    assert console.interrupt.isEnabled()
    console.console.executed.emit({"content": {}})
    assert not console.interrupt.isEnabled()


def calculate_and_stop(technician: Technician, console: ConsoleWindow, code: str) -> None:
    turns: list[float] = []
    clock = QTimer(interval=1)
    clock.timeout.connect(lambda: turns.append(time.thread_time()))
    clock.start()
    console.console.execute(code)
    technician.until(lambda: console.interrupt.isEnabled(), "the calculation to begin")
    begun = time.perf_counter()
    technician.until(lambda: time.perf_counter() > begun + 1, "a second")
    clock.stop()
    longest = max(later - sooner for sooner, later in itertools.pairwise(turns))
    assert longest < LONGEST_TURN_S
    console.interrupt.click()
    technician.until(lambda: "KeyboardInterrupt" in console.console._control.toPlainText(), "the calculation to stop")
    technician.until(lambda: not console.interrupt.isEnabled(), "its end to be told")
    console.console.clear()
    answer(technician, console, "6 * 7", "42")


def starts_another_process_when_its_own_dies(technician: Technician, console: ConsoleWindow) -> None:
    assert console.kernel is not None
    os.kill(console.kernel.pid, signal.SIGKILL)
    technician.until(lambda: "has ended" in console.state.text(), "its end to be told")
    assert not console.interrupt.isEnabled() and not console.console.isEnabled()
    console.restart.click()
    technician.until(lambda: ready(console), "another process")
    answer(technician, console, "1 + 41", "42")


def gone(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    return False


def test_process_and_windows_end_with_the_console_and_with_the_project(
    technician: Technician, console: ConsoleWindow
) -> None:
    assert console.kernel is not None
    first = console.kernel.pid
    console.close()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    left = [one for one in QApplication.topLevelWidgets() if type(one).__module__.startswith("qtconsole")]
    assert not left, f"{left}: gone with it, not when garbage is collected"
    technician.until(lambda: gone(first), "the process to end")
    assert technician.window.console.window is None
    other = opened(technician)
    technician.until(lambda: other.kernel is not None, "the next process")
    assert other.kernel is not None
    second = other.kernel.pid
    technician.window.projects.close_project()
    technician.until(lambda: gone(second), "the process to end")
    assert technician.window.console.window is None


def test_the_program_ends_after_the_process_of_a_console_closed_just_before_and_its_folder(
    technician: Technician, console: ConsoleWindow
) -> None:
    assert console.kernel is not None
    pid, folder = console.kernel.pid, Path(console.kernel._folder.name)
    assert folder.is_dir()
    console.close()
    technician.window.console.end(wait=True)
    assert gone(pid) and not folder.exists()


def test_without_its_extra_the_entry_is_grey_and_says_what_to_install(window: MainWindow, tmp_path: Path) -> None:
    assert why_not("console", MenuFacts("", frozenset(), job=False)) == "Open a project first."
    facts = MenuFacts("scan", frozenset(), job=False)
    assert why_not("console", facts) == ""
    assert "pip install -e '.[console]'" in why_not("console", facts._replace(no_console=True))
    assert not window.menus.actions["console"].isEnabled()


def test_a_window_closed_while_the_libraries_are_imported_starts_nothing(
    technician: Technician, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(console_view, "import_module", lambda name: None)
    technician.model.create(tmp_path / "block", new_project("block"))
    technician.window.console.open()
    shown = technician.window.console.window
    assert shown is not None
    shown.closeEvent(QCloseEvent())
    technician.until(lambda: technician.window.console.window is None, "it to be gone")
    assert shown.kernel is None
