"""kill -9 at any moment of whatever writes: `python -m tests.soak_kills --kills 100 [--kinds run batch]`.

A child tells what is on the disk; it is killed at a random moment, seeded. Afterwards the next program must have the
project at once, every state must be whole and no older than what was acknowledged, what stands among results must
belong together, and the audit trail must hold. Children are forked from this process, which has imported and compiled
what they need, each with its own processes in a group that is killed as a whole; but for the window, which is begun as
its users begin it.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import count
from pathlib import Path

import numpy as np

from core.files.folder_lock import alone_in
from core.files.pictures import read_picture
from core.files.project.data import ProjectFile, new_project
from core.files.project.folder import backups, create_project, read_project, recoverable, write_autosave, write_project
from core.files.project.lock import take_lock
from core.files.recording.recorder import Recorder
from core.files.recording.set_listing import scan_frames
from core.files.recording.unfinished import unfinished_recording
from core.settings.options import Options
from tests.simulated import trisect

Tell = Callable[[int], None]
SET, OUT = "set", "out"
LETS_GO_S = 15.0
"""Workers of a window that was killed end within this time."""


def numbered(number: int) -> ProjectFile:
    """A project that says its number."""
    made = new_project("Soak")
    return ProjectFile(replace(made, info=replace(made.info, serial=str(number))))


def save(folder: Path, tell: Tell) -> None:
    """Save one state after another."""
    for number in count(int(read_project(folder).project.info.serial) + 1):
        write_project(folder, numbered(number))
        tell(number)


def autosave(folder: Path, tell: Tell) -> None:
    """Autosave one state after another."""
    for number in count(1):
        write_autosave(folder, numbered(number))
        tell(number)


def record(folder: Path, tell: Tell) -> None:
    """Record one frame after another, as fast as the disk takes them."""
    recorder = Recorder(folder / "recordings" / f"scan-{time.time_ns()}")
    frame = np.full((120, 160), 90, np.uint8)
    written = 0
    for number in count():
        recorder.write(f"frame{number:06d}", frame)
        while recorder.written < number + 1 - 8:
            time.sleep(0.001)
        if recorder.written > written:
            written = recorder.written
            tell(written)


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


CUTS = (0.3, 0.25)
"""Largest σ in mm of two runs in turns, whose results differ."""


def measurable(folder: Path) -> None:
    """A recording set, and what undisturbed runs make of it; everything that measuring needs is compiled then."""
    from core.pipeline.run import run
    from core.simulate.recording import simulate_set
    from tests.output_states import state_of
    from tests.simulated import TINY

    simulate_set(TINY, folder / SET)
    known = {}
    for number, cut in enumerate(CUTS):
        out = folder / f"undisturbed{number}"
        run(folder / SET, out, Options(sigma_cut_mm=cut))
        known[str(number)] = (state_of(out), json.loads((out / "run.json").read_text())["settings"])
    (folder / "known.json").write_text(json.dumps(known))


def measure(folder: Path, tell: Tell) -> None:
    """Run after run into one folder."""
    from core.pipeline.run import run

    tell(0)
    for number in count(1):
        run(folder / SET, folder / OUT / SET, Options(sigma_cut_mm=CUTS[number % len(CUTS)]))
        tell(number)


def measured_is_whole(folder: Path, acknowledged: int) -> None:
    """What stands among the results is whole and belongs together; the next program has the folder to itself."""
    from tests.output_states import problems

    known = json.loads((folder / "known.json").read_text())
    for out in sorted((folder / OUT).iterdir()):
        with alone_in(out):
            found = problems(out, known)
        assert not found, found


def measurable_batch(folder: Path) -> None:
    """The same, and the set once more by another name."""
    measurable(folder)
    shutil.copytree(folder / SET, folder / "second")


def batch(folder: Path, tell: Tell) -> None:
    """Batch after batch of two sets, each in a process of its own."""
    from core.pipeline.batch import run_batch

    sets = [folder / SET, folder / "second"]
    with ProcessPoolExecutor(2, multiprocessing.get_context("fork")) as pool:
        tell(0)
        for number in count(1):
            options = Options(sigma_cut_mm=CUTS[number % len(CUTS)])
            for one in run_batch(sets, folder / OUT, pool, options):
                assert one.error is None, str(one.error)
            tell(number)


def live_is_whole(folder: Path, acknowledged: int) -> None:
    """Every frame that the window was told of can be read, and is found as an interrupted recording; so is the edit."""
    latest = max((folder / "recordings").glob("scan-*"), key=lambda path: path.stat().st_mtime_ns)
    _, frames = scan_frames(latest)
    assert len(frames) >= acknowledged - 1, (len(frames), acknowledged)  # one may have been on its way to the disk
    for path in frames:
        read_picture(path)
    found = unfinished_recording(folder)
    assert found is not None and found.folder.name == latest.name
    autosaved = recoverable(folder)
    states = [read_project(folder), *([] if autosaved is None else [autosaved])]
    assert "Edited, not saved" in [state.project.info.part for state in states]


@dataclass(frozen=True)
class Kind:
    """What writes (nothing: the window), what must hold after a kill, what is there before, how long it lasts."""

    write: Callable[[Path, Tell], None] | None
    whole: Callable[[Path, int], None]
    prepare: Callable[[Path], None] = lambda folder: None
    longest_s: float = 0.25


KINDS = {
    "saving": Kind(save, saved_is_whole),
    "autosave": Kind(autosave, autosaved_is_whole),
    "recording": Kind(record, recorded_is_whole),
    "run": Kind(measure, measured_is_whole, measurable, 8.0),
    "batch": Kind(batch, measured_is_whole, measurable_batch, 10.0),
    "live": Kind(None, live_is_whole, longest_s=2.0),
}


def _tell(pipe: int, number: int) -> None:
    os.write(pipe, f"{number}\n".encode())


def killed(write: Callable[[Path, Tell], None], folder: Path, after_s: float) -> int:
    """Fork a child, kill it and its processes so long after it first told something; what it told last."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.setsid()
            write(folder, partial(_tell, writing))
        finally:
            os._exit(1)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        told = [pipe.readline()]
        time.sleep(after_s)
        with suppress(ProcessLookupError):
            os.killpg(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
        told += pipe.readlines()
    assert os.WIFSIGNALED(status), "the child ended by itself"
    whole = [line for line in told if line.endswith("\n")]
    return int(whole[-1]) if whole else 0


def killed_window(folder: Path, after_s: float, *, everything: bool) -> int:
    """Let the window record on its live page, and kill it, alone or with its workers; how many frames it had told."""
    from tests.workbench.running import Running

    shutil.rmtree(folder / "recordings", ignore_errors=True)
    scene = folder.with_name("scene.toml")
    scene.write_text("scale = 0.2\nseed = 3\n")
    running = Running(folder.with_name("home"), "record", str(folder), str(scene))
    told: list[str] = []

    def enough(line: str) -> bool:
        told.append(line)
        return "edited" in told and line.startswith("recorded") and line != "recorded 0"

    running.said(enough)
    time.sleep(after_s)
    running.kill(everything=everything)
    assert running.process.stdout is not None
    told += [line.strip() for line in running.process.stdout if line.endswith("\n")]
    end = time.monotonic() + LETS_GO_S
    while running.members():
        assert time.monotonic() < end, "processes of a killed window go on"
        time.sleep(0.05)
    return max(int(line.split()[1]) for line in told if line.startswith("recorded"))


def soak(kind: str, kills: int, seed: int, work: Path) -> int:
    """Kill so many children; how many acknowledgements were held to. AssertionError where one was not."""
    chance, does = random.Random(f"{kind} {seed}"), KINDS[kind]
    folder = work / kind
    create_project(folder, numbered(0))
    does.prepare(folder)
    held = 0
    for _ in range(kills):
        after_s = chance.uniform(0.0, does.longest_s)
        if does.write is not None:
            acknowledged = killed(does.write, folder, after_s)
        else:
            create_project(folder, numbered(0))
            acknowledged = killed_window(folder, after_s, everything=chance.random() < 0.5)
        held += acknowledged
        take_lock(folder).release()
        does.whole(folder, acknowledged)
        found = trisect("verify", folder)
        assert found.code == 0, found
    return held


def main() -> int:
    """Kill, and say what was held to."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=100, help="of each kind")
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS))
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    for kind in given.kinds:
        with tempfile.TemporaryDirectory() as work:
            held = soak(kind, given.kills, given.seed, Path(work))
        print(f"{kind}: {given.kills} kills, the last of {held} acknowledged was there each time", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
