"""What is installed only by an extra: without it one sentence says what to install."""

import subprocess
import sys
from pathlib import Path

import pytest

from core.errors import InputError
from core.pipeline.steps.export_kinds import WRITERS
from workbench import __main__ as start


def test_the_command_line_is_imported_without_any_extra():
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
    program = (
        "import sys, core.cli.measuring, core.cli.preparing, core.cli.results, core.cli.studying, core.cli.importing; "
        f"print([name for name in {of_extras} if name in sys.modules])"
    )
    said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "[]"


def test_the_window_asks_for_its_extra(monkeypatch, capsys):
    monkeypatch.setattr(start, "find_spec", lambda name: None)
    assert start.main() == 2
    said = capsys.readouterr().err
    assert said.endswith("pip install 'trisect[window]'.\n")
    assert said.count("\n") == 1


def test_e57_asks_for_its_extra(monkeypatch):
    monkeypatch.delitem(sys.modules, "core.files.exchange.e57", raising=False)
    monkeypatch.setitem(sys.modules, "pye57", None)
    with pytest.raises(InputError, match=r"pip install 'trisect\[e57\]'"):
        WRITERS["e57"](None, Path("cloud.e57"), None)


def test_dxf_asks_for_its_extra(monkeypatch):
    monkeypatch.delitem(sys.modules, "core.files.exchange.dxf", raising=False)
    monkeypatch.setitem(sys.modules, "ezdxf", None)
    with pytest.raises(InputError, match=r"pip install 'trisect\[dxf\]'"):
        WRITERS["dxf"](None, Path("result.dxf"), None)
