"""Packages of strangers, installed for a test: their modules, and the entry points they declare."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import pytest

from core.cli import app
from core.files.results import export_list
from core.findings import table
from core.inspect.plan import kinds
from core.inspect.plan.plugins import plugins
from core.wing import wings
from workbench.wing import window_wings

Install = Callable[[str, Mapping[str, str], Mapping[str, Mapping[str, str]]], None]
"""Takes the package's name, its modules' sources, and the entry points by group and name."""


def look_again() -> None:
    """Forget which packages were found."""
    for kept in (wings, window_wings, plugins, app._commands, table._of_wings, export_list._of_wings, kinds._of_wings):
        kept.cache_clear()


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Install]:
    """Installs a package as pip would, version 1.2, until the test is over."""
    place, made = tmp_path / "site", list[str]()
    place.mkdir()

    def installed(name: str, modules: Mapping[str, str], points: Mapping[str, Mapping[str, str]]) -> None:
        for module, source in modules.items():
            (place / f"{module}.py").write_text(source, encoding="utf-8")
            made.append(module)
        info = place / f"{name.replace('-', '_')}.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.2\n", encoding="utf-8")
        groups = ("\n".join([f"[{group}]", *map(" = ".join, named.items())]) for group, named in points.items())
        (info / "entry_points.txt").write_text("\n\n".join(groups) + "\n", encoding="utf-8")
        look_again()

    monkeypatch.syspath_prepend(str(place))
    yield installed
    monkeypatch.undo()
    look_again()
    for module in made:
        sys.modules.pop(module, None)
