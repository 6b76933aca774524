"""Compiled functions: saved code is never stale, and the same whether it was just made or loaded."""

import ast
import importlib
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

import core
from core import code_cache, compiled, errors, held_files, messages, processor, sources
from tests.simulated import copy_of

CALLER = """
from core.compiled import compiled
from core.callee import answer

@compiled()
def asked(x):
    return answer(x) + 1.0
"""

CALLEE = """
from core.compiled import inlined

@inlined()
def answer(x):
    return {factor} * x
"""

ASK = """
from core.caller import asked
from core.compiled import FOLDER
from numba.core import event
made = []
class Heard(event.Listener):
    def on_start(self, event): made.append(event)
    def on_end(self, event): pass
event.register("numba:compile", Heard())
print(asked(10.0), len(made), FOLDER)
"""

MEASURE = """
import hashlib, sys
from pathlib import Path
import core.threads
core.threads.MOST_WORKERS = int(sys.argv[3])
from core.settings.options import Options
from core.files.recording.recording_set import open_set
from core.pipeline.live import warm_up
from core.pipeline.steps.scan_step import scan_step
from core.pipeline.steps.workspace import Workspace
for stage in sys.argv[4:]:
    getattr(warm_up, stage)()
out = Path(sys.argv[2])
scan_step(Workspace.open(open_set(Path(sys.argv[1])), out), Options(sigma_cut_mm=0.3))
print(*(hashlib.sha256((out / name).read_bytes()).hexdigest() for name in ("cloud.ply", "mesh.ply", "scan.npz")))
"""


@pytest.fixture
def package(tmp_path):
    return put_package(tmp_path)


def put_package(place):
    """A small package of the same name with a compiled function that calls one of another file."""
    folder = place / "package" / "core"
    folder.mkdir(parents=True)
    for module in (compiled, code_cache, errors, held_files, messages, processor, sources):
        shutil.copy(module.__file__, folder)
    (folder / "__init__.py").touch()
    (folder / "caller.py").write_text(CALLER)
    (folder / "callee.py").write_text(CALLEE.format(factor=2.0))
    return folder


def run(program, *args, cwd, cache):
    surrounding = os.environ | {"PYTHONPATH": str(cwd), "NUMBA_CACHE_DIR": str(cache)}
    ran = subprocess.run(
        [sys.executable, "-c", program, *map(str, args)],
        cwd=cwd, env=surrounding, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert ran.returncode == 0, ran.stderr
    return ran.stdout.split()


def ask(package, cache):
    answer, made, folder = run(ASK, cwd=package.parent, cache=cache)
    return float(answer), int(made), Path(folder)


@pytest.fixture(scope="module")
def asked_once(tmp_path_factory):
    """Such a package that has been asked, its cache, and the folder of the code in it; copy what is to be changed."""
    folder = tmp_path_factory.mktemp("asked")
    package = put_package(folder)
    answer, made, code = ask(package, folder / "cache")
    assert (answer, made) == (21.0, 2)
    return package, folder / "cache", code


def copies(asked_once, tmp_path):
    """Package, cache and the folder of the code, to be changed."""
    package, cache, code = asked_once
    own = copy_of(cache, tmp_path / "cache")
    return copy_of(package.parent, tmp_path / "package") / "core", own, own / code.relative_to(cache)


def test_the_answer_changes_with_a_function_of_another_file_and_what_nobody_has_used_for_long_is_removed(
    asked_once, tmp_path
):
    package, _, folder = copies(asked_once, tmp_path)
    old, recent = folder.parent / "old", folder.parent / "recent"
    old.mkdir()
    recent.mkdir()
    month_ago = time.time() - 30 * 24 * 3600
    os.utime(old, (month_ago, month_ago))
    (package / "callee.py").write_text(CALLEE.format(factor=3.0))
    assert ask(package, tmp_path / "cache")[:2] == (31.0, 2)
    assert (old.exists(), recent.exists(), folder.exists()) == (False, True, True)
    (package / "callee.py").write_text(CALLEE.format(factor=2.0))
    assert ask(package, tmp_path / "cache")[:2] == (21.0, 0)


def test_saved_code_goes_where_its_package_goes(asked_once, tmp_path):
    package, _, made_in = asked_once
    elsewhere = shutil.copytree(package.parent, tmp_path / "installed") / "core"
    shutil.copytree(made_in.parent, elsewhere / compiled.SHIPPED.name)
    assert ask(elsewhere, tmp_path / "another_cache")[:2] == (21.0, 0)


def test_code_that_is_not_whole_is_made_anew(asked_once, tmp_path):
    package, _, folder = copies(asked_once, tmp_path)
    for file in folder.iterdir():
        file.write_bytes(file.read_bytes()[:-1])
    assert ask(package, tmp_path / "cache")[:2] == (21.0, 2)


def test_python_is_refused_an_inlined_function_before_and_after_others_have_compiled_it(package, tmp_path):
    program = """
from core.caller import asked
from core.callee import answer
for _ in range(2):
    try:
        answer(10.0)
    except TypeError as refused:
        print(len(str(refused)) > 0)
    asked(10.0)
"""
    assert run(program, cwd=package.parent, cache=tmp_path / "cache") == ["True", "True"]


def test_numbers_spelt_out_share_one_code_of_a_function(package, tmp_path):
    (package / "caller.py").write_text(CALLER.replace("answer(x)", "answer(2) + answer(3)"))
    assert ask(package, tmp_path / "cache")[:2] == (11.0, 2)


TWO = """
import subprocess, sys
from core.code_cache import note_on_cache
from core.compiled import FOLDER
ask = sys.argv[1]
for _ in range(2):
    print(subprocess.run([sys.executable, "-c", ask], check=True, capture_output=True, text=True).stdout.strip())
print(FOLDER, "lost" if note_on_cache() else "kept")
"""


def test_where_no_cache_can_be_written_a_process_and_those_it_starts_share_one_until_its_end(package, tmp_path):
    (tmp_path / "cache").write_text("no folder")
    said = run(TWO, ASK, cwd=package.parent, cache=tmp_path / "cache")
    answers, folders = (said[0:2], said[3:5]), {said[2], said[5], said[6]}
    assert answers == (["21.0", "2"], ["21.0", "0"])
    assert len(folders) == 1
    assert said[7] == "lost"
    assert not Path(folders.pop()).parent.exists()


def test_nothing_is_told_of_a_cache_that_is_kept(monkeypatch):
    monkeypatch.delenv(code_cache.HANDED_DOWN, raising=False)
    assert code_cache.note_on_cache() is None


def compiled_modules():
    package = Path(core.__file__).parent
    for file in sorted(package.rglob("*.py")):
        text = file.read_text()
        if "from core.compiled import" in text and file.name != "compiled.py":
            yield importlib.import_module(".".join(file.relative_to(package.parent).with_suffix("").parts)), text


def test_files_that_compiled_functions_take_numbers_from_are_looked_at_too():
    """Numbers become part of the code."""
    package = Path(core.__file__).parent
    looked_at = {
        ".".join(file.relative_to(package.parent).with_suffix("").parts) for file in compiled._files(package)
    }  # fmt: skip
    modules = {module.__name__: (module, text) for module, text in compiled_modules()}
    offending = []
    for module, text in modules.values():
        imported = {
            name.asname or name.name: node.module
            for node in ast.parse(text).body if isinstance(node, ast.ImportFrom) for name in node.names
        }  # fmt: skip
        for function in vars(module).values():
            for name in getattr(getattr(function, "py_func", None), "__code__", compile("", "", "exec")).co_names:
                source = imported.get(name, "") if function.__module__ == module.__name__ else ""
                if source.startswith("core") and source not in looked_at:
                    offending.append((module.__name__, function.__name__, name))
    assert len(modules) > 30
    assert offending == []


def test_every_compiled_function_is_declared_in_one_place():
    package = Path(core.__file__).parent
    users = [
        file for file in package.rglob("*.py") if "import numba" in (text := file.read_text()) or "from numba" in text
    ]
    assert users == [Path(compiled.__file__)]


@pytest.mark.accuracy
def test_first_and_later_runs_give_the_same_bytes(simulated, measured, tmp_path):
    """Just compiled or loaded, whatever was loaded before, in one thread or two."""
    answers = []
    for number, (threads, before) in enumerate([(2, ()), (2, ()), (1, ()), (2, ("_surface",))]):
        out = copy_of(measured, tmp_path / f"out {number}")
        answers.append(
            run(MEASURE, simulated, out, threads, *before, cwd=Path(core.__file__).parents[1], cache=tmp_path / "cache")
        )
    assert answers[1:] == answers[:1] * 3
