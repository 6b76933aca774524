"""kill -9 at any moment of saving, autosaving and recording: `python -m tests.soak_kills --kills 100`.

A child says on standard output what it was told is on the disk; it is killed at a random moment, seeded. Afterwards the
next program must have the project at once, every state must be whole and no older than what was acknowledged, and the
audit trail must hold.
"""

from __future__ import annotations

import argparse
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from core.files.pictures import read_picture
from core.files.project.audit import read_trail
from core.files.project.data import ProjectFile, new_project
from core.files.project.folder import backups, create_project, read_project, recoverable, write_autosave, write_project
from core.files.project.lock import take_lock
from core.files.recording.recorder import Recorder
from core.pipeline.project.verify import verify

ROOT = Path(__file__).parents[1]
START_S = 60.0


def numbered(number: int) -> ProjectFile:
    """A project that says its number."""
    made = new_project("Soak")
    return ProjectFile(replace(made, info=replace(made.info, serial=str(number))))


def save(folder: Path) -> None:
    """Save one state after another."""
    first = int(read_project(folder).project.info.serial) + 1
    for number in range(first, first + 1_000_000):
        write_project(folder, numbered(number))
        print(number, flush=True)


def autosave(folder: Path) -> None:
    """Autosave one state after another."""
    for number in range(1, 1_000_000):
        write_autosave(folder, numbered(number))
        print(number, flush=True)


def record(folder: Path) -> None:
    """Record one frame after another, as fast as the disk takes them."""
    recorder = Recorder(folder / "recordings" / f"scan-{time.time_ns()}")
    frame = np.full((120, 160), 90, np.uint8)
    written = 0
    for number in range(1_000_000):
        recorder.write(f"frame{number:06d}", frame)
        while recorder.written < number + 1 - 8:
            time.sleep(0.001)
        if recorder.written > written:
            written = recorder.written
            print(written, flush=True)


def saved_is_whole(folder: Path, acknowledged: int) -> None:
    """What was saved is there; every version of it, too."""
    assert int(read_project(folder).project.info.serial) >= acknowledged
    for path in backups(folder):
        read_project(path)


def autosaved_is_whole(folder: Path, acknowledged: int) -> None:
    """What was autosaved last can be recovered."""
    found = recoverable(folder)
    assert acknowledged == 0 or (found is not None and int(found.project.info.serial) >= acknowledged)


def recorded_is_whole(folder: Path, acknowledged: int) -> None:
    """Every frame that was told as written can be read."""
    recordings = sorted((folder / "recordings").glob("scan-*"))
    names = sorted(recordings[-1].glob("frame*")) if recordings else []
    assert len(names) >= acknowledged
    for path in names:
        assert read_picture(path).shape == (120, 160)


KINDS: dict[str, tuple[Callable[[Path], None], Callable[[Path, int], None]]] = {
    "saving": (save, saved_is_whole),
    "autosave": (autosave, autosaved_is_whole),
    "recording": (record, recorded_is_whole),
}


def killed(kind: str, folder: Path, after_s: float) -> int:
    """Start the child, kill it so long after it first acknowledged something; what it acknowledged last."""
    words = [sys.executable, "-m", "tests.soak_kills", "--child", kind, str(folder)]
    with subprocess.Popen(words, cwd=ROOT, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None
        first = child.stdout.readline()
        time.sleep(after_s)
        child.kill()
        told = [first, *child.stdout]
    whole = [line for line in told if line.endswith("\n")]
    return int(whole[-1]) if whole else 0


def soak(kind: str, kills: int, seed: int, work: Path) -> int:
    """Kill so many children; how many acknowledgements were held to. AssertionError where one was not."""
    chance = random.Random(f"{kind} {seed}")
    folder = work / kind
    create_project(folder, numbered(0))
    held = 0
    for _ in range(kills):
        acknowledged = killed(kind, folder, chance.uniform(0.0, 0.25))
        held += acknowledged
        take_lock(folder).release()
        KINDS[kind][1](folder, acknowledged)
        found = verify(folder)
        assert found.problems == ()
        assert read_trail(folder).problems == ()
    return held


def main() -> int:
    """Kill, and say what was held to."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=100, help="of each kind")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--child", nargs=2, metavar=("KIND", "FOLDER"), help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.child:
        KINDS[given.child[0]][0](Path(given.child[1]))
        return 0
    for kind in KINDS:
        with tempfile.TemporaryDirectory() as work:
            held = soak(kind, given.kills, given.seed, Path(work))
        print(f"{kind}: {given.kills} kills, the last of {held} acknowledged was there each time")
    return 0


if __name__ == "__main__":
    sys.exit(main())
