"""Another package brings folders of the same names: one sentence, whichever was installed first."""

import base64
import hashlib
import os
import shutil
import subprocess
import sys

import pytest

from tests.code import ROOT
from trisect import start

INIT = '"""Ours."""\n'
RAN = 'def main(): print("ran")\n'


@pytest.fixture
def site(tmp_path):
    """A place of packages with a small Trisect in it, as an installer leaves it."""
    site = tmp_path / "site"
    files = {
        "core/__init__.py": INIT,
        "core/cli.py": RAN,
        "workbench/__init__.py": INIT,
        "workbench/__main__.py": RAN,
        "resources/__init__.py": INIT,
    }
    put(site, "trisect-0.1.0", files)
    shutil.copytree(ROOT / "trisect", site / "trisect", ignore=shutil.ignore_patterns("__pycache__"))
    (site / "trisect" / "__init__.py").write_text("")
    return site


def put(site, package, files):
    """Install a package, over whatever is there."""
    record = ["core/__pycache__/cli.cpython-311.pyc,,"]
    for name, text in files.items():
        (site / name).parent.mkdir(parents=True, exist_ok=True)
        (site / name).write_text(text)
        digest = base64.urlsafe_b64encode(hashlib.sha256(text.encode()).digest()).decode().rstrip("=")
        record.append(f"{name},sha256={digest},{len(text)}")
    info = site / f"{package}.dist-info"
    info.mkdir()
    (info / "RECORD").write_text("\n".join(record))


def begun(site, program, *before):
    """What starting it answers: exit code, and what it says."""
    ran = subprocess.run(
        [sys.executable, "-S", "-P", "-c", f"import sys; from trisect.start import main_{program} as m; sys.exit(m())"],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(map(str, (*before, site)))},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert "Traceback" not in ran.stderr
    return ran.returncode, ran.stdout + ran.stderr


def test_a_program_that_is_whole_runs(site):
    assert begun(site, "cli") == (0, "ran\n")
    assert begun(site, "window") == (0, "ran\n")


@pytest.mark.parametrize("name", start.FOLDERS)
def test_a_package_installed_afterwards_over_ours_is_named(site, name):
    put(site, f"{name}-8.5", {f"{name}/__init__.py": "raise ImportError"})
    for program in ("cli", "window"):
        code, said = begun(site, program)
        assert code == 2
        assert f"the package {name} 8.5 has put a file of its own in place of {site / name}" in said
        assert said.endswith("install Trisect into an environment of its own (pipx install, or uv tool install).\n")
        assert said.count("\n") == 1


@pytest.mark.parametrize("name", start.FOLDERS)
def test_a_file_of_the_very_size_of_ours_is_told_by_what_it_says(site, name):
    put(site, f"{name}-8.5", {f"{name}/__init__.py": '"""Your"""\n'.ljust(len(INIT))})
    code, said = begun(site, "cli")
    assert (code, f"the package {name} 8.5 has put a file of its own" in said) == (2, True)


def test_ours_installed_over_another_package_runs(site):
    """All of ours is there; what is left of the other one is never imported."""
    put(site, "workbench-8.5", {"workbench/config.py": "raise ImportError"})
    assert begun(site, "window") == (0, "ran\n")


@pytest.mark.parametrize("name", start.FOLDERS)
@pytest.mark.parametrize("file", ["{}/__init__.py", "{}.py"])
def test_a_package_that_is_found_before_ours_is_told(site, tmp_path, name, file):
    put(tmp_path / "elsewhere", "other-1", {file.format(name): "raise ImportError"})
    code, said = begun(site, "cli", tmp_path / "elsewhere")
    assert code == 2
    place = tmp_path / "elsewhere" / file.format(name)
    assert said.startswith(f"Trisect cannot start: {place} is found before its own folder {site / name}; install")


def test_a_folder_that_is_gone_is_told(site):
    shutil.rmtree(site / "resources")
    assert "is not there; install it anew." in begun(site, "cli")[1]


def test_a_checkout_is_looked_at_for_its_place_alone():
    assert start.complaint() is None
    assert list(start.changed_files(ROOT)) == []


def test_nothing_that_may_be_another_ones_is_imported_before_the_look():
    """Nor what takes long: the program has begun nothing yet."""
    program = "import sys, trisect.start; print([x for x in ('core', 'numpy', 'resources') if x in sys.modules])"
    ran = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    assert ran.stdout == "[]\n"
