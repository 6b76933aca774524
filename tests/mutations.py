"""Whether tests notice a change: `python -m tests.mutations --seed N --count 60`.

Draws so many module constants and so many comparisons of `core` at random, by the syntax tree, changes one at a time in
a copy of the checkout, and runs the tests that reach its definition (`tests/rests_on.py`) until one fails: the nearest
first, for so many processor seconds at most. A constant is doubled (0 becomes 1), a comparison becomes its opposite.

One seed draws the same from two checkouts whose `core` is the same, so `--root` compares their tests. Where time was
not enough for all of them, that is told apart from a change that they do not notice.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from resource import RLIMIT_CPU, RUSAGE_CHILDREN, getrusage, setrlimit

from tests.changed import ROOT, files_of_tests
from tests.rests_on import PACKAGES, Tree, definitions, module_name

NEAREST = 6
"""Files of tests that are tried first, by themselves: most changes are noticed by these, without collecting all."""
OPPOSITE = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}
PASSED, NO_TESTS = 0, 5
"""What pytest ends with."""


@dataclass(frozen=True)
class Change:
    """A line of a module, and what it is changed into."""

    path: Path
    line: int
    kind: str
    before: str
    after: str
    definition: str = ""
    """What it changes, as in `tests.rests_on`."""

    def __str__(self) -> str:
        return f"{self.path}:{self.line} {self.kind}: {self.before.strip()}  ->  {self.after.strip()}"


def changes(root: Path) -> dict[str, list[Change]]:
    """Every change that could be drawn, by kind: constants of modules, and comparisons."""
    found: dict[str, list[Change]] = {"constant": [], "comparison": []}
    for path in sorted((root / "core").rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        tree, lines = ast.parse(text), text.split("\n")
        for kind, line, start, end, new in [*_constants(tree), *_comparisons(tree, lines)]:
            before = lines[line - 1]
            raw = before.encode()  # a syntax tree counts bytes
            after = (raw[:start] + new.encode() + raw[end:]).decode()
            definition = _definition(path.relative_to(root), tree, line)
            found[kind].append(Change(path.relative_to(root), line, kind, before, after, definition))
    return found


def _definition(path: Path, tree: ast.Module, line: int) -> str:
    """The name of what stands at a line of a module, as in `tests.rests_on`."""
    names = (
        name
        for name, nodes in definitions(tree).items()
        if name and any(node.lineno <= line <= (node.end_lineno or 0) for node in nodes)
    )
    return ":".join(filter(None, [module_name(path), next(names, "")]))


def _constants(tree: ast.Module) -> Iterator[tuple[str, int, int, int, str]]:
    """Numbers that a module gives to names in capitals."""
    for node in tree.body:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            if not all(isinstance(one, ast.Name) and one.id.isupper() for one in targets):
                continue
            value = node.value
            if not isinstance(value, ast.Constant) or isinstance(value.value, bool):
                continue
            if isinstance(value.value, int | float) and value.end_col_offset:
                new = repr(2 * value.value) if value.value else "1"
                yield "constant", value.lineno, value.col_offset, value.end_col_offset, new


def _comparisons(tree: ast.Module, lines: list[str]) -> Iterator[tuple[str, int, int, int, str]]:
    """Comparisons of two by size or equality whose sign stands in a line with what is left and right of it."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Compare) or len(node.ops) > 1:
            continue
        left, right = node.left, node.comparators[0]
        if left.end_lineno != right.lineno or left.end_col_offset is None:
            continue
        between = lines[right.lineno - 1].encode()[left.end_col_offset : right.col_offset]
        sign = re.fullmatch(rb"([\s)]*)(<=|>=|==|!=|<|>)[\s(]*", between)
        if sign:
            start = left.end_col_offset + len(sign[1])
            yield "comparison", right.lineno, start, start + len(sign[2]), OPPOSITE[sign[2].decode()]


def drawn(root: Path, seed: int, count: int) -> list[Change]:
    """So many of each kind, one of either in turn, the same for the same seed."""
    chance = random.Random(seed)
    of_each = [chance.sample(found, count) for found in changes(root).values()]
    return [one for pair in zip(*of_each, strict=True) for one in pair]


def nearest_first(tree: Tree, paths: list[Path], definition: str) -> list[Path]:
    """Files of tests that reach a definition: those that name its module, its room's, those that name fewer others."""
    module = definition.partition(":")[0]
    room = Path("tests", *module.split(".")[1:-1])

    def distance(path: Path) -> tuple[bool, bool, int, Path]:
        named = tree.named_by(path)
        return module not in named, path.parent != room, len(named), path

    return sorted(paths, key=distance)


def noticed(root: Path, change: Change, tests: list[Path], seconds: float) -> str | None:
    """The first test that fails by a change, which is made in `root` and taken back; None where none does.

    Raises
    ------
    TimeoutError
        If that takes more processor time.
    """
    path, end = root / change.path, _taken() + seconds
    text = path.read_text(encoding="utf-8")
    lines = text.split("\n")
    lines[change.line - 1] = change.after
    path.write_text("\n".join(lines), encoding="utf-8")
    try:
        for files in (tests[:NEAREST], tests[NEAREST:]):
            failed = _first_failure(root, files, end - _taken()) if files else None
            if failed:
                return failed
        return None
    finally:
        path.write_text(text, encoding="utf-8")


def _first_failure(root: Path, files: list[Path], seconds: float) -> str | None:
    words = (sys.executable, "-m", "pytest", "-x", "-q", "--tb=no", "-p", "no:cacheprovider", *map(str, files))
    around = {**os.environ, "PYTHONPATH": str(root), "QT_QPA_PLATFORM": "offscreen"}
    limit = max(int(seconds), 1)
    run = subprocess.run(
        words,
        cwd=root,
        env=around,
        capture_output=True,
        text=True,
        preexec_fn=lambda: setrlimit(RLIMIT_CPU, (limit, limit)),
    )
    if run.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        raise TimeoutError
    if run.returncode in (PASSED, NO_TESTS):
        return None
    said = re.search(r"^(?:FAILED|ERROR) (\S+)", run.stdout, re.MULTILINE)
    return said[1] if said else f"pytest ends with {run.returncode}"


def _taken() -> float:
    """Processor seconds of all tests that have been run."""
    usage = getrusage(RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def main() -> None:
    """Change what is drawn, one after another, and tell what is noticed by which test."""
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("--seed", type=int, required=True)
    asked.add_argument("--count", type=int, default=60, help="of constants and of comparisons")
    asked.add_argument("--seconds", type=float, default=60.0, help="of the processor, for the tests of one change")
    asked.add_argument("--minutes", type=float, default=60.0, help="of the processor, for all: what is left is said")
    asked.add_argument("--root", type=Path, default=ROOT, help="the checkout")
    given = asked.parse_args()
    found, tried = Counter[str](), Counter[str]()
    of = drawn(given.root, given.seed, given.count)
    with tempfile.TemporaryDirectory(prefix="trisect-mutations-") as folder:
        copy = Path(folder)
        for name in (*PACKAGES, "bundle", "locks", ".ci"):
            shutil.copytree(given.root / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
        for path in given.root.iterdir():
            if path.is_file():
                shutil.copy(path, copy / path.name)
        tree = Tree(copy)
        reach = tree.who_reach({change.definition for change in of}, files_of_tests(copy))
        for change in of:
            if _taken() > 60 * given.minutes:
                break
            tried[change.kind] += 1
            try:
                by = noticed(
                    copy, change, nearest_first(tree, reach[change.definition], change.definition), given.seconds
                )
            except TimeoutError:
                tried["late"] += 1
                print(f"NO ANSWER IN TIME {change}", flush=True)
                continue
            found[change.kind] += by is not None
            print(f"{'noticed' if by else 'NOT NOTICED'} {change}" + (f"  by {by}" if by else ""), flush=True)
    for kind in ("constant", "comparison"):
        print(f"{kind}s: {found[kind]} of {tried[kind]} noticed")
    print(
        f"no answer in {given.seconds:.0f} processor seconds: {tried['late']}; in all {_taken():.0f} processor seconds"
    )
    if (left := len(of) - tried["constant"] - tried["comparison"]) > 0:
        print(f"NOT TRIED for want of time: {left}")


if __name__ == "__main__":
    main()
