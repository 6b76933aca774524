"""The camera of the soak: pylon's emulator, a real driver, replaying a rendered scan; and what it and the disk count.

`python -m tests.soak_camera FOLDER SCALE` renders the pictures into FOLDER and compiles what a preview needs, so that
neither is in the memory of the process that is measured.
"""

from __future__ import annotations

import json
import os
import pickle
import sys
import time
from collections import deque
from functools import partial
from pathlib import Path
from unittest import mock

import cv2
import numpy as np

from core.acquire.drivers import basler as basler_driver
from core.acquire.drivers.genicam import GenICamSource
from core.acquire.source import Region, SourceSettings
from core.files.recording.recorder import Recorder
from core.files.recording.rig import Rig
from core.image.targets import BlackSquare, Checkerboard
from core.model import Camera, Fan
from core.pipeline.live import session as live
from core.pipeline.live.commands import LiveRequest
from core.pipeline.live.events import LiveEnded
from core.pipeline.live.preview import ScanPreviewer
from core.progress import Progress
from workbench.work.worker import run_live_job

SERIAL = "0815-0000"
RENDERED = 6
FOLDER = "TRISECT_SOAK"
"""Environment variable: where the pictures are, for the process that records."""

RIG = Rig(Checkerboard(17, 12, 10.0), BlackSquare(60.0), 3, float(np.radians(5.0)))
KEPT = 10
"""So many of the newest frames stay on the disk: ten minutes of all are 90 GB."""


def prepare(folder: Path, scale: float) -> None:
    """Frames and reference of a scan, as the emulator reads them quickly, and the rig they were seen with."""
    from core.pipeline.live.warm_up import stages
    from core.simulate.recording import scan_of
    from core.simulate.scenario import Scenario

    stage, sheets, _ = scan_of(Scenario(scale=scale, frames=RENDERED))
    for name in ("frames", "reference"):
        (folder / name).mkdir()
    uncompressed = [cv2.IMWRITE_TIFF_COMPRESSION, 1]
    cv2.imwrite(str(folder / "reference" / "reference.tiff"), stage.reference(), uncompressed)
    for number, sheet in enumerate(sheets):
        cv2.imwrite(str(folder / "frames" / f"{number}.tiff"), stage.frame(number, sheet), uncompressed)
    (folder / "rig.pickle").write_bytes(pickle.dumps((stage.rig.camera, stage.rig.fan)))
    for compile_one in stages():
        compile_one()


def calibration(folder: Path) -> tuple[Camera, Fan]:
    """The rig the pictures were rendered with."""
    camera, fan = pickle.loads((folder / "rig.pickle").read_bytes())
    return camera, fan


def settings_for(camera: Camera, rate_hz: float) -> SourceSettings:
    """What the emulator is told."""
    width, height = camera.image_size
    return SourceSettings(rate_hz=rate_hz, region=Region(0, 0, width, height), pixel_format="Mono8")


def sweep(folder: Path) -> None:
    """From now on the camera shows the frames instead of the reference."""
    (folder / "swept").touch()


class EmulatedCamera(GenICamSource):
    """Pylon's emulator; counts its frames and notes when each one arrived."""

    def __init__(self, folder: Path) -> None:
        super().__init__("emulated camera", partial(basler_driver.connect, SERIAL, partial(_show, folder)))
        self._folder, self._swept = folder, False
        self.arrived_s: deque[tuple[int, float]] = deque(maxlen=100)
        self.delivered, self.lost, self.last = 0, 0, -1

    def read(self, timeout_s: float):
        if not self._swept and (self._folder / "swept").exists():
            self._swept = True
            driver = self._driver
            assert isinstance(driver, basler_driver.PylonDriver)
            driver.stop()
            driver.camera.ImageFilename.SetValue(str(self._folder / "frames"))
            self._start(driver)
        frame = super().read(timeout_s)
        if frame is not None:
            self.arrived_s.append((frame.index, time.monotonic()))
            self.delivered, self.last, self.lost = self.delivered + 1, frame.index, frame.dropped
        return frame


def _show(folder: Path, camera) -> None:
    camera.TestImageSelector.SetValue("Off")
    camera.ImageFilename.SetValue(str(folder / "reference"))
    camera.ImageFileMode.SetValue("On")


class SweepingRecorder(Recorder):
    """Removes files that are on the disk, all but the last ones; notes when each frame arrived and what waited."""

    def __init__(self, camera: EmulatedCamera, folder: Path, **how) -> None:
        self._there: deque[Path] = deque()
        super().__init__(folder, **how, put=self._put_and_sweep)
        self._camera = camera
        self.arrived: dict[str, float] = {}
        self.waiting_mb: list[tuple[float, float]] = []

    def write(self, name, picture, frame=None, camera=""):
        taken = super().write(name, picture, frame)
        if taken and frame is not None:
            self.arrived[name] = dict(self._camera.arrived_s)[frame.index]
            self.waiting_mb.append((time.monotonic(), self.waiting * picture.nbytes / 1e6))
        return taken

    def _put_and_sweep(self, path: Path, picture) -> None:
        self._put_direct(path, picture)
        self._there.append(path)
        if len(self._there) > KEPT:
            self._there.popleft().unlink()


class Tally:
    """Inside, a live recording has the emulated camera; `figures` are what it and the recorder counted."""

    def __init__(self, folder: Path) -> None:
        self.camera = EmulatedCamera(folder)
        self._recorders: list[SweepingRecorder] = []
        self.looked: dict[str, float] = {}
        self.sent: dict[str, float] = {}

    def __enter__(self) -> Tally:
        self._patches = (
            mock.patch.object(live, "make_source", lambda choice, rig: self.camera),
            mock.patch.object(live, "Recorder", self._recorder),
            mock.patch.object(ScanPreviewer, "look", self._timed(ScanPreviewer.look)),
        )
        for patch in self._patches:
            patch.start()
        return self

    def __exit__(self, *_) -> None:
        for patch in self._patches:
            patch.stop()

    def _recorder(self, folder: Path, **how) -> SweepingRecorder:
        self._recorders.append(SweepingRecorder(self.camera, folder, **how))
        return self._recorders[-1]

    def _timed(self, look):
        def timed(previewer, index, name, frame):
            seen = look(previewer, index, name, frame)
            self.looked[name] = time.monotonic()
            return seen

        return timed

    @property
    def figures(self) -> dict:
        camera, (recorder,) = self.camera, self._recorders
        return {
            "sent": camera.last + 1,
            "delivered": camera.delivered,
            "lost_by_driver": camera.lost,
            "lost_by_disk": recorder.dropped,
            "arrived": recorder.arrived,
            "looked_s": self.looked,
            "sent_s": self.sent,
            "waiting_mb": recorder.waiting_mb,
        }


def run_live(request: LiveRequest, channel) -> LiveEnded:
    """The window's live job, with the emulated camera; its figures are left in the folder."""
    folder = Path(os.environ[FOLDER])
    offer = channel.offer
    with Tally(folder) as tally:

        def timed(view):
            offer(view)
            if view.detail is not None and view.detail.preview is not None:
                tally.sent.setdefault(view.detail.preview.name, time.monotonic())

        channel.offer = timed
        ended = run_live_job(request, channel)
    (folder / "figures.json").write_text(json.dumps(tally.figures))
    return ended


def true_calibration(folder: Path, project, progress: Progress) -> tuple[Camera, Fan, None]:
    """The window's job that reads the accepted calibrations."""
    return *calibration(Path(os.environ[FOLDER])), None


if __name__ == "__main__":
    prepare(Path(sys.argv[1]), float(sys.argv[2]))
