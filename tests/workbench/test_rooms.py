"""What each room of the workbench may touch, beyond what the import linter can see."""

from __future__ import annotations

import ast
import importlib
from collections.abc import Iterator
from pathlib import Path

import pytest

import workbench
from workbench.work import jobs
from workbench.work.jobs import Job

ROOT = Path(workbench.__file__).parent
STEPS = ("project", "camera", "planes", "scan", "inspect", "report")
NUMBERS = ("scipy", "cv2", "numba", "numpy.linalg", "numpy.random")


def rooms() -> dict[str, Path]:
    """Every module of the workbench by its place in it."""
    return {path.relative_to(ROOT).as_posix(): path for path in sorted(ROOT.rglob("*.py"))}


def imported(path: Path) -> Iterator[str]:
    """Names of all modules a file imports, those for types alone left out."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            node.body = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def test_a_module_touches_only_what_its_room_may() -> None:
    offences: list[tuple[str, str, str]] = []
    for room, path in rooms().items():
        names = set(imported(path))

        def none(of: tuple[str, ...], why: str, room: str = room, names: set[str] = names) -> None:
            offences.extend((room, name, why) for name in sorted(names) if name.startswith(of))

        if not room.startswith("views/scene/"):
            none(("pyvista", "pyvistaqt", "vtk"), "3D is of views/scene")
            none(NUMBERS, "numbers are made in core")  # what the mouse meant is decided in screen pixels in views/scene
        if path.stem in ("presenter", "bench", "project_model", "tasks", "step_state"):
            none(("PySide6.QtWidgets", "workbench.views"), "no widgets here")
        if mine := next((step for step in STEPS if room.startswith(f"pages/{step}/")), None):
            none(tuple(f"workbench.pages.{step}." for step in STEPS if step != mine), "pages never import each other")
    assert offences == []


ENABLES = ("views/layouts.py", "views/forms/form.py")
"""Where a button, and a setting, are turned on and off together with their tips."""


def targets(function: ast.FunctionDef, method: str) -> set[str]:
    """What a method is called of within a function."""
    calls = (node.func for node in ast.walk(function) if isinstance(node, ast.Call))
    return {ast.unparse(one.value) for one in calls if isinstance(one, ast.Attribute) and one.attr == method}


def test_a_button_is_greyed_together_with_its_reason() -> None:
    """Else: use enable() of views/layouts.py."""
    by_hand = [
        (room, node.name)
        for room, path in rooms().items() if room not in ENABLES and not room.startswith("pages/project/")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef) and targets(node, "setEnabled") & targets(node, "setToolTip")
    ]  # fmt: skip
    assert by_hand == []


def every_job() -> Iterator[Job]:
    """The jobs of the house, and those of the wings."""
    for path in (ROOT / "work" / "jobs.py", *sorted(ROOT.glob("wings/*/jobs.py"))):
        module = importlib.import_module(".".join(("workbench", *path.relative_to(ROOT).with_suffix("").parts)))
        yield from (value for name, value in vars(module).items() if name.isupper() and name[0] != "_")


@pytest.mark.parametrize("job", list(every_job()))
def test_every_job_is_a_function_that_exists(job: Job) -> None:
    assert callable(jobs.resolve(job))


def test_the_window_can_be_imported_without_the_large_libraries() -> None:
    import subprocess
    import sys

    heavy = "('pyvista', 'vtkmodules', 'matplotlib', 'scipy.stats', 'numba', 'trimesh', 'networkx', 'qtconsole', 'zmq')"
    code = f"import sys, workbench.app, workbench.main_window; print([m for m in {heavy} if m in sys.modules])"
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert answer.stdout.strip() == "[]"
