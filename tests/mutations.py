"""Whether tests notice a change: `python -m tests.mutations --seed N --count 60`.

Draws so many module constants and so many comparisons of `core` at random, by the syntax tree, changes one at a time in
a copy of the checkout, and runs the tests that import its module until one fails: the nearest first, for so many
seconds at most. A constant is doubled (0 becomes 1), a comparison turned into its opposite.

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
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tests.changed import ROOT, files_of_tests
from tests.rests_on import PACKAGES, Tree

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
            found[kind].append(Change(path.relative_to(root), line, kind, before, after))
    return found


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


def tests_of(tree: Tree, closures: dict[Path, set[str]], module: str) -> list[Path]:
    """Files of tests that import a module: first those that name it, then its room's, then those that import least."""
    room = Path("tests", *module.split(".")[1:-1])

    def distance(path: Path) -> tuple[bool, bool, int, Path]:
        named = module in tree.names_in(".".join(path.with_suffix("").parts))
        return not named, path.parent != room, len(closures[path]), path

    return sorted((path for path, closure in closures.items() if module in closure), key=distance)


def noticed(root: Path, change: Change, tests: list[Path], seconds: float) -> str | None:
    """The first test that fails by a change, which is made in `root` and taken back; None where none does.

    Raises
    ------
    subprocess.TimeoutExpired
        If that takes longer.
    """
    path, end = root / change.path, time.monotonic() + seconds
    text = path.read_text(encoding="utf-8")
    lines = text.split("\n")
    lines[change.line - 1] = change.after
    path.write_text("\n".join(lines), encoding="utf-8")
    try:
        for files in (tests[:NEAREST], tests[NEAREST:]):
            failed = _first_failure(root, files, end - time.monotonic()) if files else None
            if failed:
                return failed
        return None
    finally:
        path.write_text(text, encoding="utf-8")


def _first_failure(root: Path, files: list[Path], seconds: float) -> str | None:
    words = (sys.executable, "-m", "pytest", "-x", "-q", "--tb=no", "-p", "no:cacheprovider", *map(str, files))
    around = {**os.environ, "PYTHONPATH": str(root), "QT_QPA_PLATFORM": "offscreen"}
    run = subprocess.run(words, cwd=root, env=around, capture_output=True, text=True, timeout=max(seconds, 0.1))
    if run.returncode in (PASSED, NO_TESTS):
        return None
    said = re.search(r"^(?:FAILED|ERROR) (\S+)", run.stdout, re.MULTILINE)
    return said[1] if said else f"pytest ends with {run.returncode}"


def main() -> None:
    """Change what is drawn, one after another, and tell what is noticed by which test."""
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("--seed", type=int, required=True)
    asked.add_argument("--count", type=int, default=60, help="of constants and of comparisons")
    asked.add_argument("--seconds", type=float, default=120.0, help="for the tests of one change")
    asked.add_argument("--root", type=Path, default=ROOT, help="the checkout")
    given = asked.parse_args()
    found, late = {"constant": 0, "comparison": 0}, 0
    of = drawn(given.root, given.seed, given.count)
    with tempfile.TemporaryDirectory(prefix="trisect-mutations-") as folder:
        copy = Path(folder)
        for name in (*PACKAGES, "bundle", "locks", ".ci"):
            shutil.copytree(given.root / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
        for path in given.root.iterdir():
            if path.is_file():
                shutil.copy(path, copy / path.name)
        tree = Tree(copy)
        closures = {path: tree.proof(path) for path in files_of_tests(copy)}
        for change in of:
            module = ".".join(change.path.with_suffix("").parts).removesuffix(".__init__")
            try:
                by = noticed(copy, change, tests_of(tree, closures, module), given.seconds)
            except subprocess.TimeoutExpired:
                late += 1
                print(f"NO ANSWER IN TIME {change}", flush=True)
                continue
            found[change.kind] += by is not None
            print(f"{'noticed' if by else 'NOT NOTICED'} {change}" + (f"  by {by}" if by else ""), flush=True)
    for kind, count in found.items():
        print(f"{kind}s: {count} of {sum(one.kind == kind for one in of)} noticed")
    print(f"no answer in {given.seconds:.0f} s: {late}")


if __name__ == "__main__":
    main()
