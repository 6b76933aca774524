"""kill -9 in the middle of work: what was edited is offered again, what was recorded is there."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from core.files.pictures import read_picture
from core.files.project.data import new_project
from core.files.project.folder import create_project, read_project, recoverable
from core.files.recording.set_listing import scan_frames
from tests.workbench.running import Running
from tests.workbench.technician import Technician

SCENE = "scale = 0.2\nseed = 3\n"

Program = Callable[..., "Running"]


@pytest.fixture
def program(tmp_path: Path) -> Iterator[Program]:
    started: list[Running] = []

    def start(*arguments: str) -> Running:
        started.append(Running(tmp_path / "home", *arguments))
        return started[-1]

    yield start
    for one in started:
        if one.members():
            os.killpg(one.process.pid, signal.SIGKILL)
        one.process.wait(10)
        if one.process.stdout is not None:
            one.process.stdout.close()


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A saved project."""
    from core.files.project.data import ProjectFile

    folder = tmp_path / "project"
    create_project(folder, ProjectFile(new_project("Crash")))
    return folder


@pytest.mark.skipif(sys.platform == "win32", reason="kill -9 is not known there")
@pytest.mark.slow
@pytest.mark.parametrize(
    "everything",
    [pytest.param(False, id="the window", marks=pytest.mark.accuracy), pytest.param(True, id="everything")],
)
def test_killed_while_recording_with_unsaved_edits_nothing_is_lost(
    program: Program, project: Path, technician: Technician, tmp_path: Path, everything: bool
) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE)
    running = program("record", str(project), str(scene))
    recorded: list[int] = []

    def enough(line: str) -> bool:
        word, _, count = line.partition(" ")
        if word == "recorded":
            recorded.append(int(count))
        return word == "edited" or (word == "recorded" and enough_edited)

    enough_edited = False
    running.said(enough)
    enough_edited = True
    running.said(lambda line: enough(line) and recorded[-1] >= 12)
    running.kill(everything=everything)
    technician.until(lambda: not running.members(), "all processes of the program to end", 15)

    (folder,) = (project / "recordings").glob("scan-*")
    reference, frames = scan_frames(folder)
    assert reference is not None
    assert len(frames) >= recorded[-1] - (1 if everything else 0)  # one may have been on its way to the disk
    for path in (reference, *frames):
        assert read_picture(path).shape == read_picture(reference).shape

    t = technician
    saved_by_itself = read_project(project).project.info.part != ""  # if all this took longer than that
    answers = ["Use them"] if saved_by_itself else ["Recover the changes", "Use them"]
    with t.answers(*answers) as asked:
        t.window.projects.open_project(project)
    assert saved_by_itself or "was not closed properly" in asked[0]
    assert f"{len(frames) + 1} pictures" in asked[-1]
    assert t.model.project.info.part == "Edited, not saved"
    assert t.window.current == "scan"
    t.idle()
    assert len(t.presenter().work.frames) == len(frames)
    assert t.model.undo_stack.undoText() == "use an interrupted recording"
    t.model.save()
    assert recoverable(project) is None


@pytest.mark.skipif(sys.platform == "win32", reason="kill -9 is not known there")
def test_killed_with_unsaved_edits_the_saved_state_can_be_had_as_well(
    program: Program, project: Path, technician: Technician
) -> None:
    running = program("edit", str(project))
    running.said(lambda line: line == "edited")
    running.kill(everything=True)
    with technician.answers("Open the saved state"):
        technician.window.projects.open_project(project)
    assert technician.model.project.info.part == ""
    assert recoverable(project) is None
