"""Cancel acts within a second in every long job, and leaves what was there before."""

from __future__ import annotations

import hashlib
import time
from pathlib import Path

import pytest

from core.files.step_graph import MAIN
from tests.workbench.technician import Technician
from workbench.work.tasks import Task

WITHIN_S = 1.0
SLACK_S = 0.4
"""What the system may take to end a process and to tell it, with other tests beside this one."""

SHORT = ("faces",)
"""Stages that may be over, and the result on the disk, before a job has heard of a Cancel pressed in them."""


def fingerprint(folder: Path) -> dict[str, str]:
    """Every file of a project that is not a note of the program's own, and what is in it."""
    files = (path for path in folder.rglob("*") if path.is_file() and path.parent.name != "backups")
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in files
        if path.name != "project.json" and path.name[0] != "."  # as a mark of a worker that had to be ended
    }


class Canceller:
    """Presses Cancel in the status bar when a job says that it is at a certain stage."""

    def __init__(self, technician: Technician, stage: str) -> None:
        self.pressed_at = self.ended_at = 0.0
        self.outcome: list[str] = []
        self._t, self._stage = technician, stage
        technician.bench.measuring.task_started.connect(self._started)

    def leave(self) -> None:
        """Take no notice of what begins from now on."""
        self._t.bench.measuring.task_started.disconnect(self._started)

    def _started(self, task: Task) -> None:
        task.progressed.connect(lambda stage, done, total: self._look(stage))
        task.cancelled.connect(lambda: self.outcome.append("cancelled"))
        task.done.connect(lambda _: self.outcome.append("done"))
        task.failed.connect(lambda _: self.outcome.append("failed"))
        task.ended.connect(self._ended)

    def _look(self, stage: str) -> None:
        if not self.pressed_at and stage == self._stage:
            self.pressed_at = time.monotonic()
            self._t.press(self._t.window.task_bar.cancel)

    def _ended(self) -> None:
        self.ended_at = time.monotonic()


EVERY_PAGE = (
    ("camera", "Calibrate", "camera views"),
    ("scan", "Measure again", "network"),
    ("report", "Make it again", "report"),
    ("inspect", "Measure again", "faces"),
)
# Normals and mesh of a small set are made in the second process before the job has to wait for them: no stage of it.
FURTHER = (
    ("planes", "Calibrate", "plane poses"),
    ("scan", "Measure again", "frames"),
    ("scan", "Measure again", "calibration uncertainty"),
)


@pytest.mark.parametrize(
    "jobs",
    [
        pytest.param(EVERY_PAGE, id="every page"),
        pytest.param(FURTHER, id="further stages", marks=pytest.mark.accuracy),
    ],
)
def test_cancel_acts_within_a_second_and_the_job_can_be_done_afterwards(
    technician: Technician, measured_project: Path, jobs: tuple[tuple[str, str, str], ...]
) -> None:
    """`jobs` are the page, the button that begins each, and the stage at which it is cancelled."""
    t = technician
    t.window.projects.open_project(measured_project)
    for page, button, stage in jobs:
        t.window.go_to(page)
        t.idle()
        cancel(t, button, stage)
    made_at = t.model.results[MAIN[page]].at
    t.press(button)
    t.until(lambda: t.model.results[MAIN[page]].at > made_at, f"{page} to be measured after it was cancelled")
    t.idle()


def cancel(t: Technician, button: str, stage: str) -> None:
    folder = t.model.folder
    assert folder is not None
    before, results = fingerprint(folder), dict(t.model.results)
    canceller = Canceller(t, stage)
    try:
        t.press(button)
        t.until(lambda: canceller.ended_at, f"the job to end ({stage})", 60)
        assert canceller.pressed_at, f"the job never came to {stage}"
        assert canceller.ended_at - canceller.pressed_at < WITHIN_S + SLACK_S, stage
        t.idle()
    finally:
        canceller.leave()
    assert t.errors() == [], stage
    if stage in SHORT and canceller.outcome == ["done"]:
        assert fingerprint(folder) != before, "told as done, but nothing has been written"
        assert dict(t.model.results) != results, "told as done, but not in the project"
        return
    assert canceller.outcome == ["cancelled"], stage
    assert fingerprint(folder) == before, stage
    assert dict(t.model.results) == results, stage
