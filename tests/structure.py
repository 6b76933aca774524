"""`make structure`: how the house stood before its rooms were made by subject, and how it stands now.

Both columns are measured in the same way, from the trees themselves: modules, lines, folders, the arrows of imports
between them, circles, and how many files one opens to follow a measurement or to add something. The table stands in the
manual, on the page on architecture.
"""

from __future__ import annotations

import argparse
import ast
import json
import re
import subprocess
import sys
import tarfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cached_property
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

import networkx as nx

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "resources" / "manual" / "architecture.md"
BEFORE = "f521b28"
"""The last commit with flat folders: 671 modules."""
PACKAGES = ("core", "workbench")
HEAD = """## Before and after

Written by `make structure`, which measures both trees in the same way: the last one with flat folders, and this one,
which does more by now. Modules to open are those on the shortest ways of imports from the command, or the live page, to
each stage of the data flow above. Files to open for something new are those that name its neighbour in their code: of a
cylinder, also those that simulate one or grow a face from a click. The [recipe](recipes.md) for a cone opens fewer: a
new module, the shape, the entry among the kinds, a test, and the catalogues. An arrow leads to another folder; a room
is a folder with modules.

"""
"""How the last section of the page begins; the rest of it is the table."""

SET_TO_GAUGE = (
    ("core.cli.measuring_commands", (
        "open_set", "camera_step", "calibrate_camera", "planes_step", "scan_step", "extract_centrelines", "reconstruct",
        "solve_network", "fuse", "gauge_step", "write_gauge",
    )),
)  # fmt: skip
"""Where one begins, and the functions or classes that one follows from there."""
LIVE_TO_OVERLAY = (
    ("LivePresenter", ("LiveLoop", "FrameSource", "extract_centrelines", "Preview")),
    ("ScanPage", ("ImageView",)),
)
NEIGHBOURS = {"a cone": ("cylinder",), "a camera": ("basler", "pypylon"), "a language": ("german", "de")}
"""What one adds, and the words of a neighbour of it: a file that has one of them is opened to add the new one."""

CONE = "Add a kind of feature: a cone"
"""The recipe for it."""

_ARROWS = """
import json, sys, grimp
graph = grimp.build_graph(*sys.argv[1:], cache_dir=None)
print(json.dumps([(one, other) for one in graph.modules for other in graph.find_modules_directly_imported_by(one)]))
"""
"""In a process of its own, in whose folder the tree lies: this one has `core` already, of the tree as it is now."""


@dataclass(frozen=True)
class House:
    """One tree of the program."""

    root: Path

    @cached_property
    def modules(self) -> dict[str, Path]:
        """The path of every module by its name; a package is called by its folder."""
        paths = [path for name in PACKAGES for path in sorted((self.root / name).rglob("*.py"))]
        named = {path.relative_to(self.root).with_suffix("").as_posix().replace("/", "."): path for path in paths}
        return {name.removesuffix(".__init__"): path for name, path in named.items()}

    @cached_property
    def trees(self) -> dict[str, ast.Module]:
        """The syntax tree of every module."""
        return {name: ast.parse(path.read_text(encoding="utf-8")) for name, path in self.modules.items()}

    @cached_property
    def imports(self) -> nx.DiGraph[str]:
        """Every module, with an arrow to each that it imports, wherever in it."""
        done = subprocess.run(
            [sys.executable, "-c", _ARROWS, *PACKAGES], cwd=self.root, capture_output=True, check=True, text=True
        )
        found: nx.DiGraph[str] = nx.DiGraph(sorted(json.loads(done.stdout)))  # in order: of equal ways the same one
        found.add_nodes_from(self.modules)
        return found

    @property
    def lines(self) -> int:
        """Lines of all modules, empty ones too."""
        return sum(_lines(path) for path in self.modules.values())

    @property
    def rooms(self) -> dict[str, list[str]]:
        """The modules of each folder, by its name, `__init__` left out."""
        found: dict[str, list[str]] = {}
        for name, path in self.modules.items():
            if path.name != "__init__.py":
                found.setdefault(name.rpartition(".")[0], []).append(name)
        return found

    def arrows(self, folder: str) -> int:
        """How many other folders the modules of one, and of those within it, import from."""
        rooms = {name: room for room, names in self.rooms.items() for name in names}
        inside = {name for name in self.modules if f"{name}.".startswith(f"{folder}.")}
        met = {rooms.get(other, other) for name in inside for other in self.imports.successors(name)}
        return len({room for room in met if not f"{room}.".startswith(f"{folder}.")})

    @property
    def circles(self) -> int:
        """Knots of modules that import each other round about, and knots of folders within one folder that do."""
        return _knots(self.imports) + sum(_knots(graph) for graph in self._siblings())

    def _siblings(self) -> Iterator[nx.DiGraph[str]]:
        for folder in {name.rpartition(".")[0] for name in self.modules} - {""}:
            depth = folder.count(".") + 2
            within: nx.DiGraph[str] = nx.DiGraph()
            for one, other in self.imports.edges:
                if one.startswith(f"{folder}.") and other.startswith(f"{folder}."):
                    pair = [".".join(name.split(".")[:depth]) for name in (one, other)]
                    if pair[0] != pair[1] and not set(pair) <= self.leaves:
                        within.add_edge(*pair)
            yield within

    @cached_property
    def leaves(self) -> set[str]:
        """The modules that are no folder."""
        return {name for name, path in self.modules.items() if path.name != "__init__.py"}

    def opened(self, journey: Sequence[tuple[str, Sequence[str]]]) -> int:
        """How many modules lie on the shortest ways of imports from where one begins to all that one follows."""
        met: set[str] = set()
        for start, ends in journey:
            for end in ends:
                met |= set(nx.shortest_path(self.imports, self._home(start), self._home(end)))
        return len(met)

    def _home(self, name: str) -> str:
        """The module that defines a function or a class."""
        if name in self.modules:
            return name
        for module, tree in self.trees.items():
            if any(getattr(node, "name", "") == name for node in tree.body):
                return module
        raise LookupError(name)

    def naming(self, words: Sequence[str]) -> int:
        """How many modules have one of the words in a name or a text of their code, and resources in their own name."""
        modules = sum(any(_has(text, words) for text in _texts(self.trees[name])) for name in self.leaves)
        resources = [path for path in (self.root / "resources").rglob("*") if "manual" not in path.parts]
        return modules + sum(path.stem in words for path in resources)

    def recipe(self, title: str) -> int | None:
        """How many files the manual's recipe has one open, each catalogue counted; None without a recipe."""
        page = self.root / "resources" / "manual" / "recipes.md"
        text = page.read_text(encoding="utf-8") if page.exists() else ""
        section = re.search(rf"^## {re.escape(title)}\n+((?:(?:\d\. |   ).*\n)+)", text, re.MULTILINE)
        if section is None:
            return None
        catalogues = len(list((self.root / "resources" / "translations").glob("*.po")))
        places = set(re.findall(r"`((?:core|tests|workbench)/[^`]+)`", section[1]))
        return len(places) + (catalogues if "make translations" in section[1] else 0)


def _has(text: str, words: Sequence[str]) -> bool:
    """Whether one of the words is in a text; one of two letters only as the whole of it."""
    return any(word == text if len(word) == 2 else word in text.lower() for word in words)


def _texts(tree: ast.Module) -> Iterator[str]:
    """Names and texts in the code of a module, not what its docstrings say."""
    said = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        for field in ("id", "attr", "name", "asname", "arg", "module"):
            if isinstance(name := getattr(node, field, None), str):
                yield name
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in said:
            yield node.value


def _knots(graph: nx.DiGraph[str]) -> int:
    return sum(len(knot) > 1 for knot in nx.strongly_connected_components(graph))


def _lines(path: Path) -> int:
    return path.read_bytes().count(b"\n")


def table(before: House, now: House, date: str = "") -> str:
    """What stands in the manual."""
    both = (before, now)
    rows = [["", f"before ({BEFORE})", f"now ({date})"], ["---"] * 3]
    rows.append(["modules, lines", *(f"{len(house.modules)}, {house.lines:,}" for house in both)])
    rows.append(["folders", *(f"{len(house.rooms)}" for house in both)])
    rows.append(["modules in the largest folder", *(_largest(house) for house in both)])
    rows.append(["circles of modules or folders", *(f"{house.circles}" for house in both)])
    for title, journey in (("SET → gauge.json", SET_TO_GAUGE), ("live frame → overlay", LIVE_TO_OVERLAY)):
        rows.append([f"modules to open for {title}", *(f"{house.opened(journey)}" for house in both)])
    for title, words in NEIGHBOURS.items():
        named = " or ".join(f"`{word}`" for word in words)
        rows.append([f"files to open for {title}: those that name {named}", *(f"{one.naming(words)}" for one in both)])
    steps = (house.recipe(CONE) for house in both)
    rows.append(["files to open for a cone by its recipe", *("" if count is None else f"{count}" for count in steps)])
    folders = [["folder", *(f"{when}: {what}" for when in ("before", "now") for what in _OF_A_FOLDER)], ["---"] * 7]
    names = sorted({".".join(room.split(".")[:2]) for house in both for room in house.rooms} - set(PACKAGES))
    folders += [[name.replace(".", "/"), *(cell for house in both for cell in _folder(house, name))] for name in names]
    return "\n\n".join("\n".join(f"| {' | '.join(row)} |" for row in rows) for rows in (rows, folders)) + "\n"


_OF_A_FOLDER = ("modules, lines", "rooms", "arrows")


def _largest(house: House) -> str:
    room = max(house.rooms, key=lambda room: len(house.rooms[room]))
    return f"{len(house.rooms[room])}: {room.replace('.', '/')}"


def _folder(house: House, folder: str) -> tuple[str, str, str]:
    rooms = {room: names for room, names in house.rooms.items() if f"{room}.".startswith(f"{folder}.")}
    names = [name for names in rooms.values() for name in names]
    if not names:
        return "", "", ""
    lines = sum(_lines(house.modules[name]) for name in names)
    return f"{len(names)}, {lines:,}", f"{len(rooms)}", f"{house.arrows(folder)}"


def tree_of(commit: str, folder: Path) -> House:
    """The program as it was at a commit, unpacked into a folder."""
    packed = subprocess.run(["git", "archive", commit], cwd=ROOT, capture_output=True, check=True).stdout
    with tarfile.open(fileobj=BytesIO(packed)) as files:
        files.extractall(folder, filter="data")
    return House(folder)


def main() -> None:
    """Write the table into the manual."""
    argparse.ArgumentParser(prog="python -m tests.structure", description=__doc__).parse_args()
    with TemporaryDirectory() as folder:
        written = table(tree_of(BEFORE, Path(folder)), House(ROOT), f"{datetime.now(tz=UTC):%Y-%m-%d}")
    page = PAGE.read_text(encoding="utf-8").partition(HEAD.partition("\n")[0])[0]
    PAGE.write_text(page.rstrip() + "\n\n" + HEAD + written, encoding="utf-8")


if __name__ == "__main__":
    main()
