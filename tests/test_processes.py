"""How modules of the program are started in other processes, from source and frozen."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

from core import processes
from tests.code import ROOT, modules, nodes

pytestmark = pytest.mark.usefixtures("syntax_trees")

MAKES = (ROOT / "core" / "processes.py",)
"""Modules that may ask for Python's own program."""

FROZEN = """
import sys
sys.frozen = True
sys.argv = ["trisect", *sys.argv[1:]]
from core.processes import run_asked_module
if not run_asked_module():
    print("the program itself", sys.argv[1:])
"""


@pytest.fixture
def frozen(monkeypatch):
    monkeypatch.setattr(sys, "frozen", True, raising=False)


def test_one_module_alone_knows_what_starts_python():
    found = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for path in modules("core", "workbench", "trisect")
        if path not in MAKES
        for node in nodes(path)
        if isinstance(node, ast.Attribute) and node.attr in ("executable", "_base_executable")
    ]
    assert found == [], "core.processes.module_command says how a module of ours is started"


def test_from_source_python_runs_the_module_and_takes_none_of_the_current_folder():
    assert processes.module_command("core.cli", "demo") == (sys.executable, "-P", "-m", "core.cli", "demo")


def test_frozen_the_program_runs_it(frozen):
    assert processes.module_command("core.cli", "demo") == (sys.executable, "--module", "core.cli", "demo")


def answer(folder, *arguments):
    """What a program that takes itself for frozen says to some arguments."""
    return subprocess.run(
        [sys.executable, "-c", FROZEN, *arguments],
        cwd=folder, env=os.environ | {"PYTHONPATH": f"{ROOT}{os.pathsep}{folder}"}, capture_output=True, text=True,
    )  # fmt: skip


def test_a_frozen_program_answers_with_that_module_its_arguments_and_its_exit_code(tmp_path):
    (tmp_path / "of_ours.py").write_text("import sys\nprint(__name__, sys.argv[1:])\nsys.exit(3)\n")
    ran = answer(tmp_path, processes.MODULE, "of_ours", "one", "--two")
    assert (ran.stdout, ran.returncode) == ("__main__ ['one', '--two']\n", 3), ran.stderr


def test_a_frozen_program_runs_a_script_as_python_would(tmp_path):
    script = tmp_path / "script.py"
    script.write_text("import sys, core\nprint(__name__, core.__version__, sys.argv[1:])\n")
    ran = answer(tmp_path, processes.MODULE, str(script), "one")
    assert ran.stdout.split(" ", 1)[0] == "__main__" and "['one']" in ran.stdout, ran.stderr


@pytest.mark.parametrize("arguments", [(), ("demo",), ("demo", processes.MODULE, "of_ours"), (processes.MODULE,)])
def test_other_arguments_are_the_programs_own(tmp_path, arguments):
    assert answer(tmp_path, *arguments).stdout == f"the program itself {list(arguments)}\n"


def test_an_installed_program_is_started_by_its_name_and_else_by_its_module(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    assert processes.program_command("trisect-workbench", "workbench")[-2:] == ("-m", "workbench")
    program = tmp_path / ("trisect-workbench" + Path(sys.executable).suffix)
    program.touch()
    assert processes.program_command("trisect-workbench", "workbench") == (str(program),)
