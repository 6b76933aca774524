"""What can be refused by what was typed is, before anything is compiled and before a second process is started."""

import subprocess
import sys
from pathlib import Path

import pytest
from typer.main import get_command

from core import second_process
from core.cli import measuring
from core.cli.app import app
from core.cli.simulating import as_typed
from core.pipeline.project import calibration as project_calibration
from core.pipeline.project import measuring as project_measuring
from tests.simulated import copy_of, trisect

OUT = ("--out", "{out}")
WRONG = "{out}/wrong"
WITH_A_FOLDER = {
    "run": (WRONG, *OUT),
    "batch": (WRONG, *OUT),
    "camera": (WRONG, *OUT),
    "planes": (WRONG, *OUT),
    "check": (WRONG, *OUT),
    "artefact": (WRONG, *OUT, "--id", "A"),
    "scan": (WRONG, *OUT),
    "profile": (WRONG, *OUT),
    "join": (WRONG, *OUT),
    "gauge": (WRONG, *OUT),
    "inspect": (WRONG, "--plan", "{out}/plan.toml"),
    "mesh": (WRONG, "--format", "stl"),
    "report": (WRONG, *OUT),
    "export": (WRONG, "--format", "csv"),
    "import-camera": (WRONG, *OUT),
    "import": ("{out}/set", "--camera", WRONG),
    "record": (WRONG, "camera", "--source", "simulated"),
    "pack": (WRONG, "--out", "{out}/a.trisectz"),
    "next-part": (WRONG, "--serial", "2", "--operator", "A", "--out", "{out}/next"),
    "script": (WRONG, "--out", "{out}/a.py"),
    "unpack": (WRONG, "--out", "{out}/project"),
    "target": ("--rig", WRONG, "--out", "{out}/a.pdf"),
    "simulate": ("block", "--out", "{file}/set"),
    "demo": ("--out", "{file}/out"),
    "card": ("--out", "{file}/a.pdf"),
}
"""Every command of the house that takes a folder, with one that is not there, or one that cannot be made."""


@pytest.fixture
def nothing_begun(monkeypatch):
    """Fails where something is compiled ahead, or a process started."""

    def refuse(*_, **__):
        raise AssertionError("begun before the arguments were looked at")

    for module in (measuring, project_calibration, project_measuring):
        monkeypatch.setattr(module, "compile_ahead", refuse)
    monkeypatch.setattr(second_process, "SecondProcess", refuse)
    monkeypatch.setattr(subprocess, "Popen", refuse)


def test_no_command_is_missing_here():
    assert set(get_command(app).commands) - {"sources"} == set(WITH_A_FOLDER)


@pytest.mark.parametrize("command", WITH_A_FOLDER)
def test_a_wrong_folder_is_refused_before_anything_is_begun(nothing_begun, tmp_path, command):
    (tmp_path / "file").touch()
    places = {"out": tmp_path / "out", "file": tmp_path / "file"}
    said = trisect(command, *(word.format(**places) for word in WITH_A_FOLDER[command]), cores=2)
    assert (said.code, bool(said.sentence)) == (2, True)


def run_that_lacks(tmp_path, simulated, what):
    folder = copy_of(simulated, tmp_path / "set")
    (tmp_path / "file").touch()
    match what:
        case "rig":
            (folder / "rig.toml").unlink()
        case "frames":
            for frame in (folder / "scan").iterdir():
                frame.unlink()
        case "out":
            return folder, "--out", tmp_path / "file" / "out"
        case "outside":
            return folder, "--out", folder / "scan"
        case "exclude":
            return folder, "--out", tmp_path / "out", "--exclude", "camera/none.png"
        case "cut":
            return folder, "--out", tmp_path / "out", "--sigma-cut", "-1"
    return folder, "--out", tmp_path / "out"


@pytest.mark.parametrize("what", ["rig", "frames", "out", "outside", "exclude", "cut"])
def test_whatever_keeps_a_run_from_being_done_is_said_first(nothing_begun, simulated, tmp_path, what):
    said = trisect("run", *run_that_lacks(tmp_path, simulated, what), cores=2)
    assert (said.code, bool(said.sentence)) == (2, True)


def test_a_batch_begins_nothing_where_one_folder_is_not_there(nothing_begun, simulated, tmp_path):
    said = trisect("batch", simulated, tmp_path / "none", "--out", tmp_path / "out")
    assert (said.code, "none" in said.sentence) == (2, True)
    assert not (tmp_path / "out").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="how a path is quoted there is another thing")
def test_a_path_in_a_printed_command_is_quoted_where_it_has_to_be():
    assert as_typed(Path("/data/my set")) == "'/data/my set'"
    assert as_typed(Path("/data/set")) == "/data/set"
