"""Lambdas are connected only to signals of what the same object has made, and what is gone with it.

A lambda has no receiver that Qt knows: the connection stays until the sender goes. On a sender that outlives the page
it would be called for a page that is deleted, and the program would crash. So a sender is either the object itself, an
attribute that its class makes, or made in the same function; for any other, a method of a QObject is connected.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import workbench

ROOT = Path(workbench.__file__).parent

ADOPTED = {("form.py", "editor")}
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


def makes(value: ast.expr) -> bool:
    """Whether the expression makes something, alone or many of them."""
    return any(isinstance(part, ast.Call) for part in ast.walk(value))


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
    for cls, function in functions(ast.parse(path.read_text(encoding="utf-8"))):
        for node in ast.walk(function):
            if not (
                isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "connect"
            ):
                continue
            slot = node.args[0] if node.args else None
            loose = isinstance(slot, ast.Lambda) or (isinstance(slot, ast.Call) and "partial" in ast.unparse(slot.func))
            if not loose or not isinstance(node.func.value, ast.Attribute):
                continue
            sender = ast.unparse(node.func.value.value)
            if not owner(cls, function, sender) and (path.name, sender) not in ADOPTED:
                yield node.lineno, sender


@pytest.mark.parametrize("path", sorted(ROOT.rglob("*.py")), ids=lambda path: path.relative_to(ROOT).as_posix())
def test_lambdas_are_connected_only_to_what_goes_with_their_object(path: Path) -> None:
    assert list(connections(path)) == []


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
    )
    assert list(connections(source)) == [(5, "self.model"), (6, "presenter"), (10, "presenter.live")]
