"""The program's own code as syntax trees: each module is parsed once for all tests of a process."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from itertools import chain
from pathlib import Path

ROOT = Path(__file__).parents[1]


@cache
def syntax_tree(path: Path) -> ast.Module:
    """What a file says, parsed; not to be changed."""
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def nodes(path: Path) -> tuple[ast.AST, ...]:
    """Every node of it: to walk a tree takes as long as to parse it."""
    return tuple(ast.walk(syntax_tree(path)))


@cache
def _within(folder: str) -> tuple[Path, ...]:
    return tuple(sorted((ROOT / folder).rglob("*.py")))


def forget() -> None:
    """Let go of all trees: together they take hundreds of megabytes."""
    syntax_tree.cache_clear()
    nodes.cache_clear()


def modules(*folders: str) -> Iterator[Path]:
    """Every module below some folders of the checkout."""
    return chain.from_iterable(map(_within, folders))
