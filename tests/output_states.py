"""What lies in a folder of results at every moment a program could be killed: `python -m tests.output_states`.

A folder is copied before and after each unlink, rename and fsync while commands write into it. In every copy each file
must be whole, and results must belong to what they rest on: by the ids they carry, and because a command that was not
disturbed has left the two side by side.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from core.files.folder_lock import LEFTOVER
from core.files.reading import file_hash
from core.files.results.camera_file import read_camera
from core.files.results.check_file import read_check
from core.files.results.gauge_file import read_gauge, read_thickness
from core.files.results.inspection_file import read_inspection
from core.files.results.ply import read_cloud, read_mesh
from core.files.results.profile_file import read_profiles_file
from core.files.results.run_file import read_run
from core.files.results.scan_file import read_scan
from core.files.step_graph import FILES
from core.pipeline.steps.workspace import check_calibration, read_calibration
from core.simulate.recording import simulate_set
from tests.simulated import TINY, trisect

_CALLS = ("unlink", "remove", "replace", "rename", "rmdir", "link", "fsync")
_RESTS_ON: Mapping[str, tuple[str, ...]] = {
    "planes": ("camera",),
    "check": ("camera", "planes"),
    "scan": ("camera", "planes"),
    "cloud": ("camera", "planes", "scan"),
    "mesh": ("camera", "planes", "cloud"),
    "profile": ("camera", "planes", "profiles"),
    "profile_table": ("profiles",),
    "gauge": ("camera", "planes", "cloud", "profiles"),
    "inspection": ("camera", "planes", "cloud"),
}
"""Each result, and those it must belong to if they are there."""
_MADE_BY = {"camera": "camera", "planes": "planes", "scan": "cloud", "gauge": "gauge", "profile": "profile"}
"""Steps as run.json calls them, and a result that each of them makes."""
PLAN = '[[feature]]\nname = "table"\nkind = "plane"\n'
State = Mapping[str, str]
"""SHA-256 of results, by their names in FILES."""


@contextmanager
def every_state(folder: Path, copies: Path) -> Iterator[None]:
    """Copy `folder` into `copies/0`, `copies/1` … before and after every call that changes what lies in a folder."""
    real = {name: getattr(os, name) for name in _CALLS}
    last: list[tuple[tuple[str, int, int, int], ...]] = []
    copies.mkdir(parents=True)

    def look() -> None:
        now = _signature(folder)
        if last != [now]:
            last[:] = [now]
            shutil.copytree(folder, copies / str(sum(1 for _ in copies.iterdir())))

    def watched(call: Callable[..., Any]) -> Callable[..., Any]:
        def one(*given: Any, **named: Any) -> Any:
            look()
            try:
                return call(*given, **named)
            finally:
                look()

        return one

    try:
        for name, call in real.items():
            setattr(os, name, watched(call))
        yield
    finally:
        for name, call in real.items():
            setattr(os, name, call)
    look()


def _signature(folder: Path) -> tuple[tuple[str, int, int, int], ...]:
    found = [(path, path.stat()) for path in sorted(folder.rglob("*")) if path.is_file()]
    return tuple((path.relative_to(folder).as_posix(), one.st_ino, one.st_size, one.st_mtime_ns) for path, one in found)


def state_of(folder: Path) -> dict[str, str]:
    """The results in a folder."""
    return {name: file_hash(folder / file) for name, file in FILES.items() if (folder / file).exists()}


def problems(folder: Path, known: Mapping[str, tuple[State, Mapping[str, Any]]]) -> list[str]:
    """What is not whole in a folder of results, or does not belong together.

    `known` are the states that undisturbed commands left, with the settings in their run.json.
    """
    state, wrong = state_of(folder), []
    for path in folder.iterdir():
        ours = path.name in FILES.values() or path.name == "shown.npz"
        if not (ours or LEFTOVER.match(path.name) or path.name == ".new"):
            wrong.append(f"{path.name} is no result")
    try:
        _read(folder, state)
    except Exception as error:  # noqa: BLE001  whatever it is, the state is not whole
        wrong.append(f"{type(error).__name__}: {error}")
    left = [one for one, _ in known.values()]
    wrong += [
        f"{FILES[name]} does not belong to the {FILES[base]} beside it"
        for name, bases in _RESTS_ON.items()
        for base in bases
        if {name, base} <= state.keys()
        and not any(one.get(name) == state[name] and one.get(base) == state[base] for one in left)
    ]
    if "run" in state:
        told = json.loads((folder / FILES["run"]).read_text())["settings"]
        for step, name in _MADE_BY.items():
            made = [said.get(step) for one, said in known.values() if one.get(name) == state.get(name, "")]
            if step in told and name in state and told[step] not in made:
                wrong.append(f"run.json tells of another step {step} than that of {FILES[name]}")
    return wrong


def _read(folder: Path, state: State) -> None:
    """Read every result; raises for what is not whole, or not of the calibration beside it."""
    places = {name: folder / FILES[name] for name in state}
    readers: Mapping[str, Callable[[Path], object]] = {
        "camera": read_camera,
        "check": read_check,
        "mesh": read_mesh,
        "run": read_run,
        "gauge": read_thickness,
        "inspection": read_inspection,
        "profile": read_profiles_file,
    }
    for name in readers.keys() & places.keys():
        readers[name](places[name])
    if "report" in places:
        assert places["report"].read_bytes().rstrip().endswith(b"%%EOF"), "report.pdf is not whole"
    of: dict[str, str] = {}
    clouds = {name: read_cloud(places[name]) for name in ("cloud", "profiles") if name in places}
    of |= {name: file.calibration_id for name, file in clouds.items()}
    if "scan" in places:
        of["scan"] = read_scan(places["scan"]).calibration_id
    for name in ("gauge", "inspection", "profile", "check"):
        if name in places:
            of[name] = json.loads(places[name].read_text())["calibration_id"]
    if "gauge" in places:
        read_gauge(places["gauge"], next(iter(clouds.values())).cloud)
    if of or "planes" in places:
        calibration = read_calibration(folder)
        for name, found in of.items():
            check_calibration(places[name], found, calibration)


class Watched:
    """Commands that write into one folder, whose every state is kept, to be looked at in the end."""

    def __init__(self, out: Path, work: Path) -> None:
        self.out, self._work = out, work
        self._known: dict[str, tuple[State, Mapping[str, Any]]] = {}

    def do(self, name: str, command: Callable[[], object]) -> None:
        """Let a command write, and remember what it leaves."""
        self.out.mkdir(exist_ok=True)
        with every_state(self.out, self._work / name):
            command()
        self._known[name] = (state_of(self.out), json.loads((self.out / FILES["run"]).read_text())["settings"])

    def judged(self) -> tuple[int, list[str]]:
        """How many states there were, and what is wrong in them."""
        seen: set[str] = set()
        wrong: list[str] = []
        for name in self._known:
            for copy in sorted((self._work / name).iterdir(), key=lambda path: int(path.name)):
                text = "".join(f"{path.name}{file_hash(path)}" for path in sorted(copy.glob("*")) if path.is_file())
                digest = hashlib.sha256(text.encode()).hexdigest()
                if digest not in seen:
                    seen.add(digest)
                    wrong += [f"{name}, state {copy.name}: {one}" for one in problems(copy, self._known)]
        return len(seen), wrong


def commands(recording: Path, out: Path, plan: Path) -> dict[str, tuple[object, ...]]:
    """Command lines that make results of two kinds in turns: in one go, and step by step."""
    other = ("--exclude", "camera/view00.png")
    to = (recording, "--out", out)
    return {
        "run": ("run", *to, "--sigma-cut", "0.3"),
        "another run": ("run", *to, "--sigma-cut", "0.25", *other),
        "inspect": ("inspect", *to, "--plan", plan),
        "report": ("report", *to),
        "camera": ("camera", *to),
        "planes": ("planes", *to),
        "scan": ("scan", *to, "--sigma-cut", "0.25"),
        "gauge": ("gauge", *to),
        "inspect again": ("inspect", *to, "--plan", plan),
        "another scan": ("scan", *to, "--sigma-cut", "0.3"),
        "the same scan": ("scan", *to, "--sigma-cut", "0.3"),
        "gauge again": ("gauge", *to),
        "another camera": ("camera", *to, *other),
        "run again": ("run", *to, "--sigma-cut", "0.25"),
    }


def done(words: tuple[object, ...]) -> None:
    """Let a command line do its work."""
    said = trisect(*words)
    assert said.code in (0, 1), said.err


def main() -> int:
    """Every command on a simulated set; says how many states there were."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        simulate_set(TINY, folder / "set")
        (folder / "plan.toml").write_text(PLAN)
        watched = Watched(folder / "out", folder / "states")
        for what, words in commands(folder / "set", folder / "out", folder / "plan.toml").items():
            watched.do(what, partial(done, words))
        count, wrong = watched.judged()
    print("\n".join(wrong))
    print(f"{count} states of a folder of results, {len(wrong)} things wrong")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
