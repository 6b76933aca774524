"""An emulated camera through a live scan for a long time: `python -m tests.soak --seconds 600`.

The camera is pylon's emulator, a real driver: it replays rendered frames at the paper's size and rate. Counted are the
frames it sends, those recorded and those lost; measured are the memory of the process, and the time from a frame's
arrival to the event that shows what was found in it. Recorded frames are removed once they are acknowledged: ten
minutes of them are 90 GB.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import threading
import time
from collections import deque
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise
from pathlib import Path
from unittest import mock

import cv2
import numpy as np

from core.acquire import basler_driver
from core.acquire.genicam import GenICamSource
from core.acquire.source import Region, SourceChoice, SourceSettings
from core.files.recorder import Recorder
from core.files.recording_log import lost_frames, read_log
from core.files.rig import Rig
from core.image.targets import BlackSquare, Checkerboard
from core.live.events import LiveAsk, LiveNotice, LiveRequest, LiveView, Resume, Stop, TakeReference
from core.pipeline import live
from core.simulate.recording import scan_of
from core.simulate.scenario import Scenario

SERIAL = "0815-0000"
RENDERED = 6
FLAT = 0.05
"""Memory that changes by no larger share after the first third is flat."""


class EmulatedCamera(GenICamSource):
    """Pylon's emulator, showing the pictures of a folder; notes when each frame arrived."""

    def __init__(self, folder: Path) -> None:
        super().__init__("emulated camera", partial(basler_driver.connect, SERIAL, partial(_show, folder)))
        self.arrived_s: deque[tuple[int, float]] = deque(maxlen=500)
        self.delivered = 0
        self.last = -1

    def show(self, folder: Path) -> None:
        """Show other pictures from now on."""
        self._driver.stop()
        self._driver.camera.ImageFilename.SetValue(str(folder))
        self._start(self._driver)

    def read(self, timeout_s: float):
        frame = super().read(timeout_s)
        if frame is not None:
            self.arrived_s.append((frame.index, time.monotonic()))
            self.delivered, self.last, self.dropped = self.delivered + 1, frame.index, frame.dropped
        return frame


def _show(folder: Path, camera) -> None:
    camera.TestImageSelector.SetValue("Off")
    camera.ImageFilename.SetValue(str(folder))
    camera.ImageFileMode.SetValue("On")


class SweepingRecorder(Recorder):
    """Remembers which frame has which name, and removes files that are on the disk, all but the last ones."""

    KEPT = 10

    def __init__(self, folder: Path, **how) -> None:
        super().__init__(folder, **how)
        self.index_of: dict[str, int] = {}
        self._names: deque[Path] = deque()
        self.frame_mb = 0.0

    def write(self, name, picture, frame=None):
        taken = super().write(name, picture, frame)
        self.frame_mb = picture.nbytes / 1e6
        if taken and frame is not None:
            self.index_of = {**dict(list(self.index_of.items())[-200:]), name: frame.index}
            self._names.append(self._folder / f"{name}{self._ending}")
        while len(self._names) > self.waiting + self.KEPT:
            self._names.popleft().unlink()
        return taken


@dataclass
class Soaked:
    """What was counted and measured."""

    sent: int = 0
    recorded: int = 0
    lost_by_driver: int = 0
    lost_by_disk: int = 0
    delivered: int = 0
    span: int = 0
    lost_in_span: int = 0
    seconds: float = 0.0
    memory_mb: list[tuple[float, float]] = field(default_factory=list)
    waiting_mb: float = 0.0
    latency_ms: list[float] = field(default_factory=list)
    overlays: int = 0
    views: int = 0
    notices: list[str] = field(default_factory=list)
    log_is_whole: bool = False

    @property
    def adds_up(self) -> bool:
        """Whether every frame the camera numbered came or is counted as lost, and from the first recorded one on every
        frame is recorded or counted as lost.
        """
        came = self.sent == self.delivered + self.lost_by_driver
        return came and self.span == self.recorded + self.lost_in_span

    @property
    def drift(self) -> float:
        """Change of the memory from the second third to the last, as a share of it."""
        third = self.seconds / 3
        early = [mb for at, mb in self.memory_mb if third <= at < 2 * third]
        late = [mb for at, mb in self.memory_mb if at >= 2 * third]
        return float(np.median(late) / np.median(early) - 1) if early and late else float("nan")

    def lines(self) -> list[str]:
        """The figures, for people."""
        memory = [mb for _, mb in self.memory_mb]
        latency = np.quantile(self.latency_ms, [0.5, 0.95, 1.0]) if self.latency_ms else [float("nan")] * 3
        return [
            f"frames      {self.span} sent in {self.seconds:.0f} s ({self.span / self.seconds:.1f}/s): {self.recorded} "
            f"recorded, {self.lost_in_span} lost, {self.lost_by_disk} of them because of the disk; "
            f"{'adds up' if self.adds_up else 'DOES NOT ADD UP'}",
            f"log         {'names every recorded frame' if self.log_is_whole else 'IS NOT WHOLE'}",
            f"memory      {memory[0]:.0f} MB at first, {max(memory):.0f} MB at most, {memory[-1]:.0f} MB at the end; "
            f"{self.drift:+.1%} from the second third to the last; besides, frames that wait for the disk: "
            f"{self.waiting_mb:.0f} MB at most",
            f"latency     {latency[0]:.0f} ms median, {latency[1]:.0f} ms 95 %, {latency[2]:.0f} ms at most, "
            f"from a frame's arrival to its overlay ({self.overlays} overlays, {self.views} views)",
            *(f"notice      {sentence}" for sentence in self.notices),
        ]


def render(scale: float, folder: Path) -> tuple[Scenario, Rig, object]:
    """Frames and reference of a scan into folder/frames and folder/reference, as the emulator reads them quickly."""
    scenario = Scenario(scale=scale, frames=RENDERED)
    stage, sheets, _ = scan_of(scenario)
    for name in ("frames", "reference"):
        (folder / name).mkdir()
    uncompressed = [cv2.IMWRITE_TIFF_COMPRESSION, 1]
    cv2.imwrite(str(folder / "reference" / "reference.tiff"), stage.reference(), uncompressed)
    for number, sheet in enumerate(sheets):
        cv2.imwrite(str(folder / "frames" / f"{number}.tiff"), stage.frame(number, sheet), uncompressed)
    rig = Rig(Checkerboard(17, 12, 10.0), BlackSquare(60.0), 3, float(np.radians(5.0)))
    return scenario, rig, stage.rig


def soak(seconds: float, scale: float = 1.0, rate_hz: float = 14.0, ending: str = ".pgm") -> Soaked:
    """Run it."""
    os.environ["PYLON_CAMEMU"] = "1"
    with tempfile.TemporaryDirectory(prefix="trisect-soak-") as name:
        folder = Path(name)
        _, rig, simulated = render(scale, folder)
        width, height = simulated.camera.image_size
        camera = EmulatedCamera(folder / "reference")
        settings = SourceSettings(rate_hz=rate_hz, region=Region(0, 0, width, height), pixel_format="Mono8")
        camera.configure(settings)
        request = LiveRequest(
            "scan",
            SourceChoice("basler", SERIAL),
            settings,
            rig,
            folder / "scan",
            camera=simulated.camera,
            fan=simulated.fan,
            ending=ending,
        )
        return _record(request, camera, folder, seconds)


def _record(request: LiveRequest, camera: EmulatedCamera, folder: Path, seconds: float) -> Soaked:
    result, recorders, commands = Soaked(), [], deque()
    began: list[float] = []
    shown = [""]

    def recorder(path, **how):
        recorders.append(SweepingRecorder(path, **how))
        return recorders[0]

    def hear(event) -> None:
        match event:
            case LiveAsk(answer=TakeReference()):
                commands.append(TakeReference())
            case LiveAsk(answer=Resume()) if not began:
                camera.show(folder / "frames")
                began.append(time.monotonic())
                commands.append(Resume())
            case LiveAsk():
                commands.append(Resume())
            case LiveNotice(sentence):
                result.notices.append(sentence)
            case LiveView(detail=detail):
                result.views += 1
                preview = None if detail is None else detail.preview
                if preview is None or preview.name == shown[0]:
                    return
                shown[0] = preview.name
                result.overlays += 1
                arrived = dict(camera.arrived_s).get(recorders[0].index_of.get(preview.name, -1))
                if arrived is not None:
                    result.latency_ms.append(1000 * (time.monotonic() - arrived))

    def next_command():
        if commands:
            return commands.popleft()
        return Stop() if began and time.monotonic() - began[0] > seconds else None

    done = threading.Event()

    def watch_memory() -> None:
        while not done.wait(0.5):
            if began:
                waiting = recorders[0].waiting * recorders[0].frame_mb
                result.memory_mb.append((time.monotonic() - began[0], _resident_mb() - waiting))
                result.waiting_mb = max(result.waiting_mb, waiting)

    watcher = threading.Thread(target=watch_memory)
    watcher.start()
    try:
        with (
            mock.patch.object(live, "make_source", lambda choice, rig: camera),
            mock.patch.object(live, "Recorder", recorder),
        ):
            ended = live.run_live(request, next_command, hear, lambda: True)
    finally:
        done.set()
        watcher.join()
    if ended.error:
        raise SystemExit(ended.error)
    log = read_log(folder / "scan")
    result.seconds = time.monotonic() - began[0]
    result.sent, result.delivered = camera.last + 1, camera.delivered
    result.recorded, result.lost_by_driver = ended.recorded, camera.dropped
    result.lost_by_disk = ended.dropped - camera.dropped
    result.span = log[-1].index - log[0].index + 1
    result.lost_in_span = lost_frames(log)
    result.log_is_whole = len(log) == ended.recorded and all(
        later.index > earlier.index for earlier, later in pairwise(log)
    )
    return result


def _resident_mb() -> float:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--scale", type=float, default=1.0, help="picture size over 3840 × 2748")
    parser.add_argument("--rate", type=float, default=14.0, help="frames per second")
    parser.add_argument("--ending", choices=(".png", ".pgm"), default=".pgm")
    chosen = parser.parse_args()
    result = soak(chosen.seconds, chosen.scale, chosen.rate, chosen.ending)
    print("\n".join(result.lines()))
    sys.exit(0 if result.adds_up and result.log_is_whole and abs(result.drift) <= FLAT else 1)


if __name__ == "__main__":
    main()
