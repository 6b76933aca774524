"""Windows in tests: offscreen unless there is a screen, everything in a temporary folder, nothing left behind."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from pathlib import Path

if not os.environ.get("DISPLAY"):
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

import pytest
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication, QWidget

from workbench import jobs
from workbench.bench import Bench
from workbench.notices import Notices
from workbench.project_model import ProjectModel
from workbench.settings import AppSettings
from workbench.tasks import Lane


@pytest.fixture(scope="session")
def lanes() -> Iterator[dict[str, Lane]]:
    """Processes shared by all tests of this worker: starting one takes seconds."""
    made: dict[str, Lane] = {}
    yield made
    for lane in made.values():
        lane.close()


@pytest.fixture
def bench(qapp: QApplication, lanes: dict[str, Lane], tmp_path: Path) -> Iterator[Bench]:
    """A bench as the program makes it, with settings and projects in a temporary folder."""
    for name in ("measuring", "quick", "live"):
        if name not in lanes:
            lanes[name] = Lane(name, warm=(jobs.MEASURE_SCAN,))
    settings = AppSettings(tmp_path / "settings.ini")
    settings.projects_folder = tmp_path / "projects"
    made = Bench(ProjectModel(), Notices(), settings, lanes["measuring"], lanes["quick"], lanes["live"])
    yield made
    for lane in lanes.values():
        if lane.busy:
            lane.close()


@pytest.fixture(autouse=True)
def nothing_left_behind(request: pytest.FixtureRequest) -> Iterator[None]:
    """Fails a test that leaves a thread, a running timer of a window, or a window behind."""
    before = set(threading.enumerate())
    yield
    app = QApplication.instance()
    if app is None:
        return
    app.processEvents()
    left = [
        t
        for t in threading.enumerate()
        if t not in before and t.is_alive() and not t.name.startswith(("lane-", "pyvista"))
    ]
    for thread in left:
        thread.join(2)
    left = [thread for thread in left if thread.is_alive()]
    assert not left, f"threads left behind: {left}"
    assert isinstance(app, QApplication)
    shown = [w for w in app.topLevelWidgets() if isinstance(w, QWidget) and w.isVisible()]
    assert not shown, f"windows left open: {shown}"
    running = [t for w in app.topLevelWidgets() for t in w.findChildren(QTimer) if t.isActive()]
    assert not running, f"timers left running: {[(t.parent(), t.interval()) for t in running]}"
