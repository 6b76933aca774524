"""An emulated camera through a live scan for a long time: `python -m tests.soak --window --seconds 600`.

The camera is pylon's emulator, a real driver: it replays rendered frames at the paper's size and rate. Counted are the
frames it sends, those recorded and those lost; measured are the memory of each process, and the time from a frame's
arrival to the event that shows what was found in it. With --window the workbench is opened and its live scan page
records: the time goes on until the picture is drawn, and its thread is watched for freezes. Recorded frames are removed
once they are acknowledged.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections import deque
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np

from core.acquire.source import SourceChoice
from core.files.recording.recorder import Ending
from core.files.recording.recording_log import lost_frames, read_log
from core.pipeline.live.commands import LiveRequest, Resume, Stop, TakeReference
from core.pipeline.live.events import LiveAsk, LiveNotice, LiveView, ScanDetail
from core.pipeline.live.session import run_live
from tests.soak_camera import RIG, SERIAL, Tally, calibration, settings_for, sweep

FLAT = 0.05
"""Memory that changes by no larger share after the first third is flat."""

JUDGED_FROM_S = 60.0
"""In less time than this caches still fill, and memory is told, but not judged."""

LOOK_EVERY_S = 0.5

TOLD_AFTER = (0.0, 0.1, 0.5, 1.0)
"""Shares of the time after which memory is told."""

QUANTILES = (0.5, 0.9, 0.95, 0.99, 1.0)

UNDER_WAY_S = 1.0
"""From so long after the first frame on a recording is under way."""


@dataclass
class Memory:
    """What one process takes, looked at now and then; its own, without the frames that wait for the disk."""

    mb: list[tuple[float, float]] = field(default_factory=list)

    def look(self, pid: int | str = "self") -> None:
        """Note it."""
        pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
        self.mb.append((time.monotonic(), pages * os.sysconf("SC_PAGE_SIZE") / 1e6))

    def without(self, waiting: list[tuple[float, float]]) -> Memory:
        """The same less what waited at the time."""
        if not waiting:
            return self
        at, mb = np.transpose(waiting)
        return Memory([(t, total - float(np.interp(t, at, mb))) for t, total in self.mb])

    @property
    def drift(self) -> float:
        """Change from the second third of the time to the last, as a share of it."""
        if not self.mb:
            return float("nan")
        first, last = self.mb[0][0], self.mb[-1][0]
        third = (last - first) / 3
        early = [mb for at, mb in self.mb if third <= at - first < 2 * third]
        late = [mb for at, mb in self.mb if at - first >= 2 * third]
        return float(np.median(late) / np.median(early) - 1) if early and late else float("nan")

    def after(self, share: float) -> float:
        """MB when this share of the time was over."""
        at, mb = np.transpose(self.mb)
        return float(np.interp(at[0] + share * (at[-1] - at[0]), at, mb))

    def __str__(self) -> str:
        at_times = ", ".join(f"{self.after(share):.0f} MB after {share:.0%}" for share in TOLD_AFTER)
        return (
            f"{at_times} of the time, {max(mb for _, mb in self.mb):.0f} MB at most; "
            f"{self.drift:+.1%} from the second third to the last"
        )


@dataclass
class Soaked:
    """What was counted and measured."""

    seconds: float = 0.0
    sent: int = 0
    delivered: int = 0
    recorded: int = 0
    lost_by_driver: int = 0
    lost_by_disk: int = 0
    span: int = 0
    lost_in_span: int = 0
    told_lost: int = 0
    memory: dict[str, Memory] = field(default_factory=dict)
    waiting_mb: float = 0.0
    latency_ms: dict[str, list[float]] = field(default_factory=dict)
    latency_to: str = "the event with its overlay"
    views: int = 0
    notices: list[str] = field(default_factory=list)
    freezes: list[str] = field(default_factory=list)
    busiest: list[str] = field(default_factory=list)
    log_is_whole: bool = False

    @property
    def adds_up(self) -> bool:
        """Whether every frame the camera numbered came or is counted as lost, and from the first recorded one on every
        frame is recorded or counted as lost; and whether as many were told as lost as the log says, but for those that
        were lost after the last one recorded.
        """
        came = self.sent == self.delivered + self.lost_by_driver
        told = self.lost_in_span <= self.told_lost <= self.sent - self.recorded
        return came and told and self.span == self.recorded + self.lost_in_span

    @property
    def is_flat(self) -> bool:
        """Whether no process grows or shrinks, as far as the time was long enough to tell."""
        return self.seconds < JUDGED_FROM_S or all(abs(memory.drift) <= FLAT for memory in self.memory.values())

    def count(self, figures: dict, folder: Path, recorded: int, dropped: int) -> None:
        """Take what camera and recorder counted, and what the log in the recording's `folder` says."""
        log = read_log(folder)
        self.sent, self.delivered, self.lost_by_driver, self.lost_by_disk = (
            figures[name] for name in ("sent", "delivered", "lost_by_driver", "lost_by_disk")
        )
        self.recorded, self.told_lost = recorded, dropped
        self.span, self.lost_in_span = log[-1].index - log[0].index + 1, lost_frames(log)
        self.log_is_whole = len(log) == recorded and all(b.index > a.index for a, b in pairwise(log))
        self.waiting_mb = max(mb for _, mb in figures["waiting_mb"])

    def late(self, shown: dict[str, float], figures: dict) -> None:
        """Overlays: when each frame's was there; `figures` say when the frame had arrived, was looked at and sent."""
        arrived = figures["arrived"]
        began = min(arrived.values(), default=0.0) + UNDER_WAY_S
        names = [name for name in shown if name in arrived]
        self.latency_ms = {
            "in all": _ms_between(arrived, shown, names),
            "after the first second": _ms_between(arrived, shown, [name for name in names if arrived[name] >= began]),
        }
        steps = {"arrived": arrived, "looked at": figures["looked_s"], "sent": figures["sent_s"], "shown": shown}
        for (before, start), (after, end) in pairwise((name, when) for name, when in steps.items() if when):
            self.latency_ms[f"of that from {before} to {after}"] = _ms_between(
                start, end, [name for name in names if name in start and name in end and arrived[name] >= began]
            )

    def lines(self) -> list[str]:
        """The figures, for people."""
        return [
            f"frames      {self.span} sent in {self.seconds:.0f} s ({self.span / self.seconds:.1f}/s): {self.recorded} "
            f"recorded, {self.lost_in_span} lost, {self.lost_by_disk} of them because of the disk; "
            f"{'adds up' if self.adds_up else 'DOES NOT ADD UP'}",
            f"machine     {os.cpu_count()} cores, on average {os.getloadavg()[0]:.1f} processes wanted one",
            f"log         {'names every recorded frame' if self.log_is_whole else 'IS NOT WHOLE'}",
            *(f"memory      {who}: {memory}" for who, memory in self.memory.items()),
            f"            besides, frames that wait for the disk: {self.waiting_mb:.0f} MB at most",
            f"latency     from a frame's arrival to {self.latency_to}; {self.views} views",
            *(f"            {what}: {_told(ms)}" for what, ms in self.latency_ms.items() if ms),
            *(f"window      busy in one go for {one}" for one in self.busiest),
            *(f"freeze      {freeze}" for freeze in self.freezes),
            *(f"notice      {sentence}" for sentence in self.notices),
        ]


def _ms_between(start: dict[str, float], end: dict[str, float], names: list[str]) -> list[float]:
    return [1000 * (end[name] - start[name]) for name in names]


def _told(ms: list[float]) -> str:
    quantiles = zip(QUANTILES, np.quantile(ms, QUANTILES), strict=True)
    return ", ".join(f"{value:.0f} ms {share:.0%}" for share, value in quantiles) + f" ({len(ms)} overlays)"


def prepared(folder: Path, scale: float) -> None:
    """Have the pictures made by another process."""
    subprocess.run([sys.executable, "-m", "tests.soak_camera", str(folder), str(scale)], check=True)


def soak(seconds: float, scale: float = 1.0, rate_hz: float = 14.0, ending: Ending = ".pgm") -> Soaked:
    """Run the recording alone, in this process."""
    os.environ["PYLON_CAMEMU"] = "1"
    with tempfile.TemporaryDirectory(prefix="trisect-soak-") as name:
        folder = Path(name)
        prepared(folder, scale)
        camera, fan = calibration(folder)
        source, settings = SourceChoice("basler", SERIAL), settings_for(camera, rate_hz)
        request = LiveRequest("scan", source, settings, RIG, folder / "scan", camera=camera, fan=fan, ending=ending)
        return _record(request, folder, seconds)


def _record(request: LiveRequest, folder: Path, seconds: float) -> Soaked:
    result, memory = Soaked(), Memory()
    commands: deque[Resume | TakeReference] = deque()
    began: list[float] = []
    shown: dict[str, float] = {}

    def hear(event) -> None:
        match event:
            case LiveAsk(answer=Resume()) if not began:
                sweep(folder)
                began.append(time.monotonic())
                commands.append(Resume())
            case LiveAsk(answer=TakeReference() | Resume() as answer):
                commands.append(answer)
            case LiveNotice(sentence):
                result.notices.append(str(sentence))
            case LiveView(detail=detail):
                result.views += 1
                if isinstance(detail, ScanDetail) and detail.preview is not None:
                    shown.setdefault(detail.preview.name, time.monotonic())

    def next_command():
        if commands:
            return commands.popleft()
        return Stop() if began and time.monotonic() - began[0] > seconds else None

    done = threading.Event()

    def watch_memory() -> None:
        while not done.wait(LOOK_EVERY_S):
            if began:
                memory.look()

    watcher = threading.Thread(target=watch_memory)
    watcher.start()
    try:
        with Tally(folder) as tally:
            ended = run_live(request, next_command, hear, lambda: True)
    finally:
        done.set()
        watcher.join()
    if ended.error is not None:
        raise SystemExit(str(ended.error))
    figures = tally.figures
    result.seconds = time.monotonic() - began[0]
    result.count(figures, request.folder, ended.recorded, ended.dropped)
    result.memory["recording"] = memory.without(figures["waiting_mb"])
    result.late(shown, figures)
    return result


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--window", action="store_true", help="through the workbench's live scan page")
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--scale", type=float, default=1.0, help="picture size over 3840 × 2748")
    parser.add_argument("--rate", type=float, default=14.0, help="frames per second")
    parser.add_argument("--ending", choices=(".png", ".pgm"), default=".pgm")
    chosen = parser.parse_args()
    if chosen.window:
        from tests.workbench.soak_window import soak_window as run
    else:
        run = soak
    result = run(chosen.seconds, chosen.scale, chosen.rate, chosen.ending)
    print("\n".join(result.lines()))
    sys.exit(0 if result.adds_up and result.log_is_whole and result.is_flat and not result.freezes else 1)


if __name__ == "__main__":
    main()
