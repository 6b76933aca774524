"""The soak through the window: the workbench with its live scan page, recording in a process of its own.

The page is used by its buttons. A frame counts as shown when the picture has been drawn with what was found in it.
"""

from __future__ import annotations

import json
import os
import signal
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest import mock

if not os.environ.get("DISPLAY"):
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from PySide6.QtCore import QEvent, QEventLoop, QObject, QTimer
from PySide6.QtWidgets import QAbstractButton, QApplication

from core.files.project.data import Accepted, new_project
from core.files.recording.recorder import Ending
from core.pipeline.live.events import LiveEnded, LiveView, ScanDetail
from tests.soak import LOOK_EVERY_S, Memory, Soaked, prepared
from tests.soak_camera import FOLDER, RIG, SERIAL, calibration, settings_for, sweep
from tests.workbench.watchdog import Watchdog, slowness, too_long
from workbench.app import build_window
from workbench.bench import make_bench
from workbench.main_window import MainWindow
from workbench.settings import AppSettings
from workbench.work import jobs

SWEPT_MS = 500
"""The camera shows the hand-held laser so long before Start is pressed."""

SETTLED_S = 10.0
"""Freezes count from so long after the start: before, the page is laid out for the first time."""

PATIENCE_S = 180.0
"""What is waited for in the window comes within this time."""


class Shown(QObject):
    """When each frame's overlay had been drawn, by the frame's name."""

    def __init__(self, page: Any, live: Any) -> None:
        super().__init__()
        self.at: dict[str, float] = {}
        self.views = 0
        self._next: list[str] = []
        live.view.connect(self._put)
        page.picture.image.canvas.installEventFilter(self)

    def _put(self, view: LiveView) -> None:
        self.views += 1
        if isinstance(view.detail, ScanDetail) and view.detail.preview is not None:
            self._next.append(view.detail.preview.name)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() == QEvent.Type.Paint and self._next:
            names, self._next = self._next, []
            QTimer.singleShot(0, self, lambda: self._drawn(names))
        return False

    def _drawn(self, names: list[str]) -> None:
        for name in names:
            self.at.setdefault(name, time.monotonic())


class Soak(QObject):
    """Goes through one recording on the scan page."""

    def __init__(self, window: MainWindow, folder: Path, seconds: float) -> None:
        super().__init__()
        self.window, self.folder, self.seconds = window, folder, seconds
        self.page: Any = window.pages["scan"]
        self.live: Any = window.presenters["scan"].live  # type: ignore[attr-defined]
        self.shown = Shown(self.page, self.live)
        self.ended: LiveEnded | None = None
        self.recording: Path | None = None
        self.memory = {"window": Memory(), "recording": Memory()}
        self.told_before = 0
        self._look = QTimer(self)
        self._look.setInterval(int(1000 * LOOK_EVERY_S))
        self._look.timeout.connect(self._measure)
        self.live.ended.connect(self._take_end)

    def run(self, watch: Watchdog) -> float:
        """From the start of the recording to its end; how long frames were recorded, in s."""
        self.until(lambda: not self.live.cannot_start(), "the page to be ready")
        self.press("Start live")
        self.press("Take the reference")
        self.until(lambda: "Start" in self.live.question, "the reference to be taken")
        sweep(self.folder)
        self.wait(SWEPT_MS / 1000)
        self.press("Start")
        self.until(lambda: self.live.recorded > 0, "the first frame")
        self.recording = self.live._ending.folder
        self.told_before = len(self.window.bench.notices.all)
        began = time.monotonic()
        self._look.start()
        settled = min(SETTLED_S, self.seconds / 4)
        self.wait(settled)
        with watch:
            self.wait(self.seconds - settled)
        seconds = time.monotonic() - began
        self._look.stop()
        self.press("Stop")
        self.until(lambda: self.ended is not None, "the end")
        return seconds

    def press(self, text: str) -> None:
        """Click the button of the page that says this, as soon as it can be clicked."""

        def found() -> QAbstractButton | None:
            buttons = self.page.findChildren(QAbstractButton)
            return next(
                (one for one in buttons if one.isVisible() and one.isEnabled() and text == one.text().replace("&", "")),
                None,
            )

        self.until(lambda: found() is not None, f"a button {text!r}")
        button = found()
        assert button is not None
        button.click()

    def until(self, true: Any, what: str) -> None:
        """Let events come until `true()`."""
        end = time.monotonic() + PATIENCE_S
        while not true():
            if time.monotonic() > end or (self.ended is not None and self.ended.error):
                said = [notice.text for notice in self.window.bench.notices.all]
                raise SystemExit(f"waited for {what}; {self.live.state_text()}; {said}")
            self.wait(0.05)

    def wait(self, seconds: float) -> None:
        """Let events come for so long; in a loop of its own, for the end of the program's own one ends the program."""
        loop = QEventLoop()
        QTimer.singleShot(int(1000 * seconds), loop, loop.quit)
        loop.exec()

    def _measure(self) -> None:
        with suppress(OSError, AttributeError):  # the process may be about to end
            self.memory["recording"].look(self.window.bench.live.pid)
            self.memory["window"].look()

    def _take_end(self, ended: LiveEnded) -> None:
        self.ended = ended


def soak_window(seconds: float, scale: float = 1.0, rate_hz: float = 14.0, ending: Ending = ".pgm") -> Soaked:
    """Run the recording on the page; what is measured afterwards by itself is left out."""
    with tempfile.TemporaryDirectory(prefix="trisect-soak-") as name, _environment(Path(name)):
        folder = Path(name)
        prepared(folder, scale)
        settings = AppSettings(folder / "settings.ini")
        app = QApplication.instance()
        if not isinstance(app, QApplication):
            app = QApplication(["trisect"])
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        bench = make_bench(settings)
        window = build_window(app, bench, "light")
        try:
            window.resize(1280, 800)
            window.show()
            bench.model.create(folder / "project", replace(new_project("Soak"), rig=RIG, accepted=Accepted("a", "b")))
            window.go_to("scan")
            job = Soak(window, folder, seconds)
            window.presenters["scan"].run.start = lambda **_: None  # type: ignore[attr-defined]
            _choose_camera(job.live.settings, folder, rate_hz, ending)
            watch = Watchdog(window.presenters["scan"].live.state_text, keep_ms=10.0)  # type: ignore[attr-defined]
            result = Soaked(seconds=job.run(watch), latency_to="its overlay on the screen", views=job.shown.views)
            assert job.ended is not None and job.recording is not None
            if job.ended.error:
                raise SystemExit(job.ended.error)
            figures = json.loads((folder / "figures.json").read_text())
            result.count(figures, job.recording, job.ended.recorded, job.ended.dropped)
            result.memory = {
                "window": job.memory["window"],
                "recording": job.memory["recording"].without(figures["waiting_mb"]),
            }
            result.late(job.shown.at, figures)
            result.freezes = too_long(watch, slowness())
            result.busiest = [str(one) for one in watch.worst(3)]
            result.notices = [notice.text for notice in bench.notices.all[job.told_before :]]
            return result
        finally:
            bench.close()
            window.leave()
            bench.wait_until_closed()


def _choose_camera(settings: Any, folder: Path, rate_hz: float, ending: Ending) -> None:
    told = settings_for(calibration(folder)[0], rate_hz)
    settings.set_kind("basler")
    settings.set_id(SERIAL)
    settings.take(told)
    settings.set_ending(ending)


@contextmanager
def _environment(folder: Path) -> Iterator[None]:
    """The emulated camera for the process that records, and the true calibrations for the page."""
    with (
        mock.patch.dict(os.environ, {FOLDER: str(folder), "PYLON_CAMEMU": "1"}),
        mock.patch.object(jobs, "RUN_LIVE", jobs.Job("tests.soak_camera:run_live")),
        mock.patch.object(jobs, "ACCEPTED_CALIBRATION", jobs.Job("tests.soak_camera:true_calibration")),
    ):
        yield
