"""Windows in tests: offscreen unless there is a screen, everything in a temporary folder, nothing left behind."""

from __future__ import annotations

import faulthandler
import gc
import logging
import os
import shutil
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

if not os.environ.get("DISPLAY"):
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

import pytest
import shiboken6
from PySide6.QtCore import QCoreApplication, QEvent, QEventLoop, QObject, QTimer
from PySide6.QtWidgets import QApplication, QWidget

from tests.shared import SAID_ALOUD
from tests.workbench import screen
from tests.workbench.hand_lane import HandLane
from tests.workbench.technician import Technician
from workbench.app import build_window
from workbench.bench import Bench
from workbench.main_window import MainWindow
from workbench.notices import Notices
from workbench.project_model import ProjectModel
from workbench.settings import AppSettings
from workbench.views import ask
from workbench.views.scene.ready import Readiness
from workbench.work import jobs
from workbench.work.tasks import Lane

HANGS_AFTER_S = 180
"""A test that takes so long hangs: where every thread stands is told, and the test process ends."""
PROOF_HANGS_AFTER_S = 1500
"""The same for one that is marked `accuracy`."""
STOPS_WITHIN_S = 5.0
"""A job that is cancelled has stopped by then, unless others begin again and again."""


def pytest_configure(config: pytest.Config) -> None:
    """A screen of its own for every process that runs tests, if asked for; the one that hands them out needs none."""
    runs_tests = hasattr(config, "workerinput") or config.getoption("dist", "no") == "no"
    if os.environ.get(screen.WANTED) == "1" and runs_tests:
        server = screen.open_screen()
        config.add_cleanup(server.terminate)


class SharedBench(Bench):
    """A bench whose processes outlive its window: they serve the next test, too."""

    def close(self) -> None:
        """End what still runs, with its process only where it does not stop: starting another one takes seconds."""
        lanes, end = (self.measuring, self.quick, self.live), time.monotonic() + STOPS_WITHIN_S
        for lane in lanes:
            lane.cancel_all()
        while any(lane.busy and (time.monotonic() < end or is_importing(lane)) for lane in lanes):
            QCoreApplication.processEvents(QEventLoop.ProcessEventsFlag.WaitForMoreEvents)  # a lane has a timer, too
        for lane in lanes:
            if lane.busy:
                lane.close()


class SharedLane(Lane):
    """Its process is not ended while it still imports: the next test's job would have to begin with that again."""

    _answering: object = None

    def _received(self, kind: int, number: int, body: bytes) -> None:
        self._answering = self._process
        super()._received(kind, number, body)

    def _end_stubborn(self) -> None:
        if is_importing(self):
            self._stop_timer.start()
        else:
            super()._end_stubborn()


def is_importing(lane: Lane) -> bool:
    """Whether its process has been started and has not answered yet."""
    return isinstance(lane, SharedLane) and lane._process is not None and lane._answering is not lane._process


@pytest.fixture(autouse=True)
def nothing_hangs(pytestconfig: pytest.Config, request: pytest.FixtureRequest) -> Iterator[None]:
    """Ends the test process where a test never comes back: a question nobody answers, a lock."""
    is_proof = request.node.get_closest_marker("accuracy") is not None
    after_s = PROOF_HANGS_AFTER_S if is_proof else HANGS_AFTER_S
    faulthandler.dump_traceback_later(after_s, exit=True, file=pytestconfig.stash[SAID_ALOUD])
    yield
    faulthandler.cancel_dump_traceback_later()


@pytest.fixture(scope="module", autouse=True)
def garbage_stays_here() -> Iterator[None]:
    """No thread but this one collects windows of tests that are over: tests leave pages that the program never leaves.

    In the program the collector runs as it does, and so it does while the window is played with at random.
    What outlives its test does so until the module's end: a page without a window may leave its clock running, which
    would be counted against the first test with a window of whichever module came next.
    """
    gc.disable()
    yield
    gc.collect()
    for timer in _running_timers():
        timer.stop()
    gc.freeze()  # what is left stays, and need not be gone through at the end of each test and module from now on
    gc.enable()


@pytest.fixture(scope="session")
def lanes() -> Iterator[dict[str, SharedLane]]:
    """Processes shared by all tests of this worker: starting one takes seconds."""
    made: dict[str, SharedLane] = {}
    yield made
    for lane in made.values():
        lane.close()
        lane.wait_until_closed()


@pytest.fixture
def bench(qapp: QApplication, lanes: dict[str, SharedLane], tmp_path: Path) -> Iterator[Bench]:
    """A bench as the program makes it, with settings and projects in a temporary folder."""
    for name in ("measuring", "quick", "live"):
        if name not in lanes:
            # that of the live source is often started and seldom used
            lanes[name] = SharedLane(name, warm=() if name == "live" else (jobs.MEASURE_SCAN,))
    settings = AppSettings(tmp_path / "settings.ini")
    settings.projects_folder = tmp_path / "projects"
    made = SharedBench(ProjectModel(), Notices(), settings, lanes["measuring"], lanes["quick"], lanes["live"])
    yield made
    made.close()
    made.model.blockSignals(True)  # whoever listened may be gone
    made.model.close()  # else what was changed is still to be autosaved, in the midst of the next test


@pytest.fixture
def hand_bench(qapp: QApplication, tmp_path: Path) -> Iterator[Bench]:
    """Jobs run in this process, a moment later; those of the live lane wait for the test."""
    settings = AppSettings(tmp_path / "settings.ini")
    settings.projects_folder = tmp_path / "projects"
    lanes = [HandLane(name) for name in ("measuring", "quick", "live")]
    lanes[2].held = {jobs.RUN_LIVE}
    measuring, quick, live = (cast(Lane, lane) for lane in lanes)
    bench = Bench(ProjectModel(), Notices(), settings, measuring, quick, live)
    yield bench
    bench.model.blockSignals(True)  # whoever listened may be gone
    bench.model.close()


@pytest.fixture
def window(bench: Bench, qapp: QApplication, monkeypatch: pytest.MonkeyPatch) -> Iterator[MainWindow]:
    """The program's window as it starts, shown at its smallest usual size."""
    style, palette, sheet = qapp.style().objectName(), qapp.palette(), qapp.styleSheet()
    made = build_window(qapp, bench, "light")
    made.resize(1280, 800)
    made.show()
    qapp.processEvents()
    yield made
    bench.close()  # whatever a failed test left running is not asked about
    with monkeypatch.context() as patch:
        patch.setattr(ask, "ask", lambda *_, **__: 0)
        made.leave()
    made.deleteLater()
    del made
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    gc.collect(1)
    qapp.setStyleSheet(sheet)
    qapp.setStyle(style)
    qapp.setPalette(palette)


@pytest.fixture
def usual_log() -> Iterator[None]:
    """The program's log is afterwards as it was: a test may have it written to a file."""
    log = logging.getLogger("trisect")
    before, propagate, level = list(log.handlers), log.propagate, log.level
    yield
    for handler in [one for one in log.handlers if one not in before]:
        log.removeHandler(handler)
        handler.close()
    log.propagate = propagate
    log.setLevel(level)


@pytest.fixture
def technician(window: MainWindow, qtbot: Any, monkeypatch: pytest.MonkeyPatch) -> Technician:
    """Somebody at the window."""
    return Technician(window, qtbot, monkeypatch)


@pytest.fixture
def measured_project(finished_project_folder: Path, tmp_path: Path) -> Path:
    """A copy of a finished project on a small simulated set, to be opened and changed."""
    return Path(shutil.copytree(finished_project_folder, tmp_path / "measured"))


# ---- nothing is left behind


@pytest.fixture(autouse=True)
def nothing_left_behind(request: pytest.FixtureRequest) -> Iterator[None]:
    """Fails a test that leaves a thread, a process, a running timer, or a window behind."""
    before = set(threading.enumerate())
    yield
    app = QApplication.instance()
    if app is None:
        return
    assert isinstance(app, QApplication)
    app.processEvents()
    app.sendPostedEvents(None, QEvent.Type.DeferredDelete)  # what is closed is gone: no later test's theme shows it
    shown = [w for w in app.topLevelWidgets() if isinstance(w, QWidget) and w.isVisible()]
    assert not shown, f"windows left open: {shown}"
    threads = [t for t in threading.enumerate() if t not in before and not t.name.startswith("pyvista")]
    for thread in threads:
        thread.join(2)
    threads = [thread for thread in threads if thread.is_alive()]
    assert not threads, f"threads left behind: {threads}"
    if "window" in request.fixturenames:
        running = [f"every {timer.interval()} ms of {timer.parent()}" for timer in _running_timers()]
        assert not running, f"timers left running: {running}"
    children = _foreign_children(request)
    assert not children, f"processes left behind: {children}"


def _running_timers() -> list[QTimer]:
    """Timers that would fire again although their window is closed, whoever holds them.

    How 3D can be drawn is found out once for the program, and may take longer than the window that asked.
    """
    there = gc.get_objects()
    kinds = {kind for kind in set(map(type, there)) if issubclass(kind, QTimer)}  # asking each object takes a second
    running = [each for each in there if type(each) in kinds and shiboken6.isValid(each) and each.isActive()]
    return [each for each in running if not _of_readiness(each)]


def _of_readiness(thing: QObject | None) -> bool:
    return thing is not None and (isinstance(thing, Readiness) or _of_readiness(thing.parent()))


def _foreign_children(request: pytest.FixtureRequest) -> list[str]:
    """Processes of this one that are neither lanes nor of Python's own making."""
    listing = Path("/proc/self/task")
    if not listing.is_dir():
        return []
    end = time.monotonic() + 3
    while left := [line for line in _children(listing) if not _is_known(line)]:
        if time.monotonic() > end:
            return left
        time.sleep(0.05)
    return []


def _children(listing: Path) -> Iterator[str]:
    for task in listing.glob("*/children"):
        try:
            children = task.read_text().split()
        except OSError:  # the thread has ended
            continue
        for pid in children:
            try:
                command = Path(f"/proc/{pid}/cmdline").read_text().replace("\0", " ").strip()
            except OSError:
                continue
            if command:  # else it has ended
                yield f"{pid}: {command}"


def _is_known(line: str) -> bool:
    own = ("multiprocessing", "workbench.work.worker", "workbench.views.scene.surfaces", "from execnet", "Xvfb")
    return any(known in line for known in own)
