"""What is installed only by an extra: without it one sentence says what to install."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

from core.errors import InputError
from core.pipeline.steps.export_kinds import WRITERS
from workbench import __main__ as start


def extras_loaded_by(*modules):
    """What of the extras is imported with these modules, in a process of their own."""
    of_extras = (
        "PySide6",
        "pyqtgraph",
        "pyvista",
        "vtkmodules",
        "qtawesome",
        "superqt",
        "pypdfium2",
        "pye57",
        "ezdxf",
        "trimesh",
        "cascadio",
        "pypylon",
        "qtconsole",
        "ipykernel",
    )
    program = f"import sys, {', '.join(modules)}; print([name for name in {of_extras} if name in sys.modules])"
    said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    return ast.literal_eval(said.stdout)


def test_the_command_line_is_imported_without_any_extra():
    assert extras_loaded_by(*(f"core.cli.{name}" for name in ("measuring", "preparing", "results", "importing"))) == []


def test_the_window_asks_for_its_extra(monkeypatch, capsys):
    monkeypatch.setattr(start, "find_spec", lambda name: None)
    assert start.main() == 2
    said = capsys.readouterr().err
    assert "make app" in said and "install -e '.[window]'" in said and "none-any.whl[window]'" in said
    assert said.count("\n") == 1


def test_no_advice_names_a_package_that_no_index_has():
    """`trisect` is on none: a command that asks one for it installs nothing, or something else of that name."""
    root = Path(__file__).parents[1]
    texts = [*root.glob("core/**/*.py"), *root.glob("workbench/**/*.py"), *root.glob("resources/manual/**/*.md")]
    asked = re.compile(r"pip install (?!-)[^`]*?(?<![./\w-])trisect\b(?!-)")
    found = {path.name for path in texts if asked.search(path.read_text("utf-8"))}
    assert found <= {"changelog.md"}, "which tells what once was"


def test_e57_asks_for_its_extra(monkeypatch):
    monkeypatch.delitem(sys.modules, "core.files.exchange.e57", raising=False)
    monkeypatch.setitem(sys.modules, "pye57", None)
    with pytest.raises(InputError, match=r"pip install -e '\.\[e57\]'"):
        WRITERS["e57"](None, Path("cloud.e57"), None)


def test_dxf_asks_for_its_extra(monkeypatch):
    monkeypatch.delitem(sys.modules, "core.files.exchange.dxf", raising=False)
    monkeypatch.setitem(sys.modules, "ezdxf", None)
    with pytest.raises(InputError, match=r"pip install -e '\.\[dxf\]'"):
        WRITERS["dxf"](None, Path("result.dxf"), None)
