"""Which numbers for tuning matter: `python -m tests.sensitivity`, in the rooms from pictures to a verdict.

Each number that a module of these rooms gives to a name in capitals is halved and doubled, many at once: a group by
which no set's result becomes another is done with, others are split until one number is left. A result is another where
the verdict or the notes are, the thickness by a tenth of its U, U by a tenth, or the points by a twentieth.

What was tried is kept in `build/sensitivity`, by what the program and this module are, so that it goes on where it was
cut off. Numbers within compiled loops, and those of which another is made when its module is imported, are not reached
in this way: they are listed apart, as are those of modules that no set uses.
"""

from __future__ import annotations

import argparse
import ast
import hashlib
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from resource import RLIMIT_CPU, setrlimit
from types import ModuleType
from typing import Any

from core.simulate.recording import simulate_set
from core.simulate.scenario import Scenario
from tests.changed import ROOT
from tests.rests_on import Tree, parsed
from tests.simulated import CUT, TINY, trisect

ROOMS = ("core.model", "core.image", "core.calibrate", "core.scan", "core.inspect", "core.checks")
TIMES = (0.5, 2.0)
AT_MOST_S = 30
"""Processor seconds of one measurement; it takes two. What takes longer has another result."""
SETS: Mapping[str, Scenario] = {
    "block": TINY,
    "steps, checked": replace(TINY, object="steps", seed=4, check_poses=2),
    "moving hand, speckle": replace(TINY, seed=5, frames=12, speckle=0.3, readout_ms=71.0, hand_mm_s=14.0),
}
STEPS = ("camera", "planes", "check", "scan", "gauge")


@dataclass(frozen=True)
class Number:
    """A number that a module gives to a name."""

    module: str
    name: str
    value: float

    def __str__(self) -> str:
        return f"{self.module}:{self.name}"

    def times(self, factor: float) -> float:
        """The number changed; a whole one stays whole, and 1 or more."""
        return max(1, round(self.value * factor)) if isinstance(self.value, int) else self.value * factor


def numbers(tree: Tree, rooms: Sequence[str] = ROOMS) -> list[Number]:
    """Every number but 0 and truth values that a module of these rooms gives to a name in capitals, in order."""
    found = []
    for module, path in sorted(tree.files.items()):
        if module.startswith(tuple(f"{room}." for room in rooms)):
            for node in parsed(path).body:
                found += [Number(module, name, value) for name, value in _given(node)]
    return found


def _given(node: ast.stmt) -> Iterator[tuple[str, float]]:
    if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
        return
    for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
        both = isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple)
        pairs = zip(target.elts, node.value.elts, strict=False) if both else [(target, node.value)]  # type: ignore[attr-defined]
        for one, value in pairs:
            number = value.value if isinstance(value, ast.Constant) else None
            counts = isinstance(one, ast.Name) and one.id.isupper() and number and not isinstance(number, bool)
            if counts and isinstance(one, ast.Name) and isinstance(number, int | float):
                yield one.id, number


def out_of_reach(tree: Tree, all_numbers: Iterable[Number]) -> set[str]:
    """Numbers that are taken into a compiled loop, or into another value when a module is imported."""
    own = {str(one) for one in all_numbers}
    taken: set[str] = set()
    for module in tree.files:
        if module.startswith("core."):
            fixed = [part for node in parsed(tree.files[module]).body for part in _fixed_parts(node)]
            reached = tree.named_in(fixed, module)
            taken |= own & (reached | {far for one in reached if ":" in one for far in tree.reached(one)})
    return taken


def _fixed_parts(node: ast.stmt) -> Iterator[ast.AST]:
    """What of a statement keeps the numbers that it was made with: compiled loops, values, defaults."""
    if isinstance(node, ast.FunctionDef):
        if any(ast.unparse(one).startswith(("compiled", "inlined")) for one in node.decorator_list):
            yield node
        yield from (one for one in [*node.args.defaults, *node.args.kw_defaults] if one)
    elif isinstance(node, ast.ClassDef):
        for one in node.body:
            yield from _fixed_parts(one)
    elif isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
        yield node.value


class Trial:
    """A program that is imported once, and measures sets with numbers changed in a process of its own each time."""

    def __init__(self, work: Path, kept: Path, places: Mapping[str, set[str]]) -> None:
        self.work, self.kept, self.places = work, kept, places
        self.known: dict[str, Any] = {}
        if kept.exists():
            self.known = dict(map(json.loads, kept.read_text(encoding="utf-8").splitlines()))
        for name, scenario in SETS.items():
            simulate_set(scenario, work / name / "set")
            self._measured(name, work / name / "first")  # imports, loads and compiles what the others then have
        self.usual = {name: self.of(name, (), 1.0) for name in SETS}

    def of(self, name: str, group: Sequence[Number], factor: float) -> Any:
        """What a set's result is with a group of numbers changed: kept, or measured."""
        key = hashlib.sha256(repr((name, factor, [str(one) for one in group])).encode()).hexdigest()[:20]
        if key not in self.known:
            self.known[key] = self._in_a_process(name, group, factor)
            with self.kept.open("a", encoding="utf-8") as file:
                file.write(json.dumps([key, self.known[key]]) + "\n")
        return self.known[key]

    def differs(self, group: Sequence[Number], factor: float) -> str:
        """The first set whose result is another with a group changed; empty where none is."""
        return next((name for name in SETS if is_another(self.usual[name], self.of(name, group, factor))), "")

    def _in_a_process(self, name: str, group: Sequence[Number], factor: float) -> Any:
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                setrlimit(RLIMIT_CPU, (AT_MOST_S + 60, AT_MOST_S + 60))
                _forget()
                for one in group:
                    change(self.places[str(one)], one.times(factor))
                with tempfile.TemporaryDirectory() as folder:
                    begun = time.process_time()
                    found = self._measured(name, Path(folder))
                    slow = time.process_time() - begun > AT_MOST_S
                    os.write(writing, json.dumps("slow" if slow else found).encode())
            finally:
                os._exit(0)
        os.close(writing)
        with os.fdopen(reading, "rb") as file:
            text = file.read()
        os.waitpid(child, 0)
        return json.loads(text) if text else "nothing"

    def _measured(self, name: str, out: Path) -> Any:
        for step in STEPS:
            words = CUT if step == "scan" else ()
            if step != "check" or SETS[name].check_poses:
                said = trisect(step, self.work / name / "set", "--out", out, *words)
                if said.code not in (0, 1):
                    return f"{step} refused"
        return _summary(out)


def _summary(out: Path) -> dict[str, Any]:
    gauge = json.loads((out / "gauge.json").read_text(encoding="utf-8"))
    run = json.loads((out / "run.json").read_text(encoding="utf-8")) if (out / "run.json").exists() else {}
    notes = sorted({note["code"] for notes in run.get("notes", {}).values() for note in notes if "code" in note})
    points = (out / "cloud.ply").read_bytes()[:2000].partition(b"element vertex ")[2].split()[0]
    found = {name: gauge.get(name) for name in ("thickness_mm", "U_mm", "verdict")}
    return found | {"notes": notes, "points": int(points)}


def is_another(usual: Any, found: Any) -> bool:
    """Whether a result is another one for who reads it."""
    if not (isinstance(usual, dict) and isinstance(found, dict)):
        return bool(usual != found)
    if (usual["verdict"], usual["notes"]) != (found["verdict"], found["notes"]):
        return True
    grown = abs(found["U_mm"] / usual["U_mm"] - 1)
    moved = abs(found["thickness_mm"] - usual["thickness_mm"]) / usual["U_mm"]
    return bool(max(grown, moved) > 0.1 or abs(found["points"] / usual["points"] - 1) > 0.05)


def _forget() -> None:
    """What functions of ours have kept may rest on a number."""
    for module in _ours():
        for one in vars(module).values():
            clear = getattr(one, "cache_clear", None)
            if callable(clear):
                clear()


def _ours() -> list[ModuleType]:
    return [module for name, module in list(sys.modules.items()) if name.partition(".")[0] == "core" and module]


def takers(tree: Tree, taken: Iterable[Number]) -> dict[str, set[str]]:
    """By number the places that have it under a name: its module, and those that import it from there, however far."""
    found = {str(one): {str(one)} for one in taken}
    back: dict[str, set[str]] = {}
    for module in tree.files:
        if module.startswith("core"):
            for name, target in tree.imported_names(module).items():
                back.setdefault(target, set()).add(f"{module}:{name}")
    for places in found.values():
        waiting = {*places}
        while waiting:
            waiting = set().union(*(back.get(one, ()) for one in waiting)) - places
            places |= waiting
    return found


def change(places: Iterable[str], value: float) -> None:
    """Give names of modules another value, where these are imported and have them."""
    for module, _, name in (one.partition(":") for one in places):
        of = sys.modules.get(module)
        if of is not None and name in vars(of):
            setattr(of, name, value)


def those_that_matter(
    group: Sequence[Number], differs: Callable[[Sequence[Number]], str], until: Callable[[], bool]
) -> Iterator[tuple[Sequence[Number], str]]:
    """The numbers of a group that make another result, one by one, each with its set.

    A group that makes none is not split; one that does while neither of its halves does comes as a whole.
    """
    if until() or not group:
        return
    by = differs(group)
    if by and len(group) == 1:
        yield group, by
    elif by:
        half = len(group) // 2
        found = [one for part in (group[:half], group[half:]) for one in those_that_matter(part, differs, until)]
        yield from found or ([] if until() else [(group, by)])


def main() -> None:
    """Tell which numbers matter, as far as the time goes."""
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("--minutes", type=float, default=60.0, help="of the processor; what is left is said")
    asked.add_argument("--at-once", type=int, default=16, help="numbers that are changed together at first")
    asked.add_argument("--rooms", nargs="+", default=ROOMS)
    given = asked.parse_args()
    tree = Tree(ROOT)
    every = numbers(tree, given.rooms)
    fixed = out_of_reach(tree, every)
    files = (path for name, path in sorted(tree.files.items()) if name.startswith("core"))
    version = hashlib.sha256("".join(path.read_text("utf-8") for path in (*files, Path(__file__))).encode())
    kept = ROOT / "build" / "sensitivity" / f"{version.hexdigest()[:16]}.jsonl"
    kept.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="trisect-sensitivity-") as folder:
        trial = Trial(Path(folder), kept, takers(tree, every))
        print(*(f"{name}: {found}" for name, found in trial.usual.items()), sep="\n", flush=True)
        unused = {str(one) for one in every if one.module not in sys.modules}
        tried = [one for one in every if str(one) not in fixed | unused]
        groups = [tried[i : i + given.at_once] for i in range(0, len(tried), given.at_once)]
        done, matter = 0, set()
        for group in groups:
            for factor in TIMES:
                differs = lambda some, factor=factor: trial.differs(some, factor)  # noqa: E731
                for some, by in those_that_matter(group, differs, lambda: _late(given.minutes)):
                    matter |= {str(one) for one in some}
                    together = "" if len(some) == 1 else "ONLY TOGETHER "
                    told = ", ".join(f"{one} = {one.value:g}" for one in some)
                    print(f"{together}{told}, times {factor:g}: {by}", flush=True)
            if _late(given.minutes):
                break
            done += len(group)
    still = [str(one) for one in tried[:done] if str(one) not in matter]
    print(f"{len(matter)} matter, {len(still)} do not, {len(tried) - done} NOT TRIED for want of time")
    print(f"in compiled loops or made into others {len(fixed)}, of modules that no set uses {len(unused - fixed)}")
    print("Neither half nor twice these makes another result:", *still, sep="\n  ")


def _late(minutes: float) -> bool:
    used = os.times()
    return sum(used[:4]) > 60 * minutes


if __name__ == "__main__":
    main()
