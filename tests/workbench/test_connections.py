"""What crashes a window is not written: loose connections, threads beside Qt's, event loops within others, items.

Lambdas, and functions within functions, are connected only to signals of what the same object has made, and what is
gone with it.

They have no receiver that Qt knows: the connection stays until the sender goes. On a sender that outlives the page
it would be called for a page that is deleted, and the program would crash. So a sender is either the object itself, an
attribute that its class makes, or made in the same function; for any other, a method of a QObject is connected. A task
outlives its page, but tells nothing once the receiver it was run for is gone: that is to be the object itself.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import workbench
from tests.code import nodes, syntax_tree

pytestmark = pytest.mark.usefixtures("syntax_trees")

ROOT = Path(workbench.__file__).parent
ROOMS = {path.relative_to(ROOT).as_posix(): path for path in sorted(ROOT.rglob("*.py"))}
"""Every module of the workbench by its place in it."""

ADOPTED = {("form.py", "editor"), ("import_dialog.py", "task")}
"""Given by the caller, and made the object's own child in the same function."""


def functions(tree: ast.AST) -> Iterator[tuple[ast.ClassDef | None, ast.FunctionDef]]:
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef):
            yield from ((node, one) for one in node.body if isinstance(one, ast.FunctionDef))
    if isinstance(tree, ast.Module):
        yield from ((None, one) for one in tree.body if isinstance(one, ast.FunctionDef))


def assigned(node: ast.AST) -> Iterator[tuple[str, ast.expr]]:
    """Names and attributes of self that are given a value, with the value."""
    for part in ast.walk(node):
        if isinstance(part, ast.Assign):
            for target in part.targets:
                pairs = (
                    zip(target.elts, part.value.elts, strict=True)
                    if isinstance(target, ast.Tuple) and isinstance(part.value, ast.Tuple)
                    else [(one, part.value) for one in (target.elts if isinstance(target, ast.Tuple) else [target])]
                )
                yield from ((ast.unparse(name), value) for name, value in pairs)
        elif isinstance(part, (ast.AnnAssign, ast.NamedExpr)) and part.value is not None:
            yield ast.unparse(part.target), part.value
        elif isinstance(part, (ast.For, ast.comprehension)):
            names = part.target.elts if isinstance(part.target, ast.Tuple) else [part.target]
            yield from ((ast.unparse(name), part.iter) for name in names)


RUNS = {"run", "run_quick", "run_long"}
"""Methods of lanes and of the bench that begin a task for the receiver that is given first."""


def makes(value: ast.expr) -> bool:
    """Whether the expression makes something of the object's own, alone or many of them."""
    calls = [part for part in ast.walk(value) if isinstance(part, ast.Call)]
    tasks = [one for one in calls if isinstance(one.func, ast.Attribute) and one.func.attr in RUNS]
    return bool(calls) and all(one.args and ast.unparse(one.args[0]) == "self" for one in tasks)


def holds_own(cls: ast.ClassDef | None, function: ast.FunctionDef, value: ast.expr) -> bool:
    """Whether the value is, or is a list of, what the object has made."""
    found = [ast.unparse(part) for part in ast.walk(value) if isinstance(part, ast.Attribute)]
    return any(one.startswith("self.") and owner(cls, function, one) for one in found)


def owner(cls: ast.ClassDef | None, function: ast.FunctionDef, sender: str) -> bool:
    """Whether the function or its class has made `sender`, like "self.table.selectionModel()" or "button"."""
    parts = sender.split(".")
    if parts[0] != "self":
        made = [value for name, value in assigned(function) if name == parts[0].split("(")[0].split("[")[0]]
        return any(makes(value) or holds_own(cls, function, value) for value in made)
    if len(parts) == 1 or "(" in parts[1]:
        return True
    name = ".".join(parts[:2]).split("[")[0]
    made = [value for known, value in assigned(cls) if known == name] if cls is not None else []
    return any(makes(value) or owner(cls, function, ast.unparse(value)) for value in made if ast.unparse(value) != name)


def connections(path: Path) -> Iterator[tuple[int, str]]:
    """Line and sender of each lambda or partial that is connected to something another object made."""
    for cls, function in functions(syntax_tree(path)):
        for node in ast.walk(function):
            if not (
                isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "connect"
            ):
                continue
            slot = node.args[0] if node.args else None
            within = {one.name for one in ast.walk(function) if isinstance(one, ast.FunctionDef)} - {function.name}
            loose = isinstance(slot, ast.Lambda) or (isinstance(slot, ast.Call) and "partial" in ast.unparse(slot.func))
            loose = loose or (isinstance(slot, ast.Name) and slot.id in within)
            if not loose or not isinstance(node.func.value, ast.Attribute):
                continue
            sender = ast.unparse(node.func.value.value)
            if not owner(cls, function, sender) and (path.name, sender) not in ADOPTED:
                yield node.lineno, sender


def test_lambdas_are_connected_only_to_what_goes_with_their_object() -> None:
    assert [(room, *found) for room, path in ROOMS.items() for found in connections(path)] == []


def test_the_rule_sees_a_sender_that_outlives_its_receiver(tmp_path: Path) -> None:
    source = tmp_path / "page.py"
    source.write_text(
        "class Page:\n"
        "    def __init__(self, presenter, model):\n"
        "        self.model, self.button = model, Button()\n"
        "        self.button.clicked.connect(lambda: 1)\n"
        "        self.model.changed.connect(lambda: 2)\n"
        "        presenter.changed.connect(lambda: 3)\n"
        "        for text in 'ab':\n"
        "            action = Action(text)\n"
        "            action.triggered.connect(lambda _=False: 4)\n"
        "        presenter.live.started.connect(partial(print, 5))\n"
        "        def ended():\n"
        "            pass\n"
        "        model.ended.connect(ended)\n"
        "        mine = presenter.lane.run(self, 'job')\n"
        "        mine.ended.connect(ended)\n"
        "        others = presenter.lane.run(presenter, 'job')\n"
        "        others.ended.connect(ended)\n"
    )
    assert list(connections(source)) == [
        (5, "self.model"),
        (6, "presenter"),
        (10, "presenter.live"),
        (13, "model"),
        (17, "others"),
    ]


EXPLAINED = {
    "work/worker.py": ("threading", "a process of its own, without Qt: it listens to the window while it computes"),
    "work/console_kernel.py": ("threading", "the console's process, without Qt: it listens for its end"),
    "views/scene/ready.py": ("threading", "imports the 3D libraries; it holds no object of Qt's"),
    "notices.py": ("threading", "starts none: its hook tells of errors of other libraries' threads"),
    "theme.py": ("gc.disable", "a guard only while Qt goes through its list of all widgets"),
}
"""The modules that touch what no other may, and why."""
THREADS = ("threading", "_thread", "concurrent.futures", "multiprocessing")
"""Modules that start threads, or processes that Qt does not know."""
NESTED = ("exec", "exec_", "processEvents")
"""What runs an event loop within another."""


def hazards(tree: ast.AST) -> set[str]:
    """What a module has of threads, and of turning the collection of garbage off."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {one.name for one in node.names}
        elif isinstance(node, ast.ImportFrom):
            found |= {node.module or "", *(f"{node.module}.{one.name}" for one in node.names)}
        elif isinstance(node, ast.Name | ast.Attribute):
            found.add(ast.unparse(node))
    qt = {name for name in found if "QThread" in name or name.rpartition(".")[2] == "QRunnable"}
    return qt | (found & {*THREADS, "gc.disable", "gc.set_threshold"})


def test_threads_and_garbage_are_touched_only_where_it_is_explained() -> None:
    touched = {room: found for room, path in ROOMS.items() if (found := hazards(syntax_tree(path)))}
    assert touched == {room: {what} for room, (what, _) in EXPLAINED.items()}


def test_lists_are_models_not_items_that_are_made_anew() -> None:
    made_of_items = {"QListWidget", "QTreeWidget", "QTableWidget"}
    named = ((room, node) for room, path in ROOMS.items() for node in nodes(path) if isinstance(node, ast.Name))
    assert [(room, node.lineno) for room, node in named if node.id in made_of_items] == []


def loops_at_close(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Line and source of each event loop that runs within a closeEvent, or within what it calls of its own class."""
    for cls in (node for node in ast.walk(tree) if isinstance(node, ast.ClassDef)):
        methods = {one.name: one for one in cls.body if isinstance(one, ast.FunctionDef)}
        wanted = ["closeEvent"] if "closeEvent" in methods else []
        for name in wanted:  # it grows
            for node in ast.walk(methods[name]):
                if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute):
                    continue
                called, of = node.func.attr, ast.unparse(node.func.value)
                if called in NESTED or of == "ask":
                    yield node.lineno, ast.unparse(node.func)
                if of == "self" and called in methods and called not in wanted:
                    wanted.append(called)


def test_no_event_loop_runs_while_a_window_closes() -> None:
    assert [(room, *found) for room, path in ROOMS.items() for found in loops_at_close(syntax_tree(path))] == []


def test_threads_and_loops_at_close_are_seen() -> None:
    assert hazards(ast.parse("from threading import Thread\nfrom PySide6.QtCore import QThreadPool\ngc.disable()")) == {
        "threading", "PySide6.QtCore.QThreadPool", "gc.disable",
    }  # fmt: skip
    source = (
        "class Window:\n"
        "    def closeEvent(self, event):\n"
        "        QTimer.singleShot(0, self, self._later)\n"
        "        self._ask()\n"
        "    def _ask(self):\n"
        "        ask.confirm(self)\n"
        "        QDialog(self).exec()\n"
        "    def _later(self):\n"
        "        QDialog(self).exec()\n"
    )
    assert list(loops_at_close(ast.parse(source))) == [(6, "ask.confirm"), (7, "QDialog(self).exec")]
