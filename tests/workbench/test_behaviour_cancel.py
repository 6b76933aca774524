"""Cancel acts within a second in every long job, and leaves what was there before."""

from __future__ import annotations

import hashlib
import time
from pathlib import Path

import pytest

from core.pipeline.project.verify import CHANGING
from tests.workbench.technician import Technician
from workbench.work.tasks import Task

WITHIN_S = 1.0
SLACK_S = 0.4
"""What the system may take to end a process and to tell it, with other tests beside this one."""


def fingerprint(folder: Path) -> dict[str, str]:
    """Every file of a project that is not a note of the program's own, and what is in it."""
    files = (path for path in folder.rglob("*") if path.is_file() and path.parent.name != "backups")
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in files
        if path.name not in ("project.json", ".autosave.json", CHANGING)  # the last: of a worker that had to be ended
    }


class Canceller:
    """Presses Cancel in the status bar when a job says that it is at a certain stage."""

    def __init__(self, technician: Technician, stage: str) -> None:
        self.pressed_at = self.ended_at = 0.0
        self.outcome: list[str] = []
        self._t, self._stage = technician, stage
        technician.bench.measuring.task_started.connect(self._started)

    def _started(self, task: Task) -> None:
        task.progressed.connect(lambda stage, done, total: self._look(stage))
        task.cancelled.connect(lambda: self.outcome.append("cancelled"))
        task.done.connect(lambda _: self.outcome.append("done"))
        task.failed.connect(lambda _: self.outcome.append("failed"))
        task.ended.connect(self._ended)

    def _look(self, stage: str) -> None:
        if not self.pressed_at and (not self._stage or stage == self._stage):
            self.pressed_at = time.monotonic()
            self._t.press(self._t.window.task_bar.cancel)

    def _ended(self) -> None:
        self.ended_at = time.monotonic()


@pytest.mark.parametrize(
    ("page", "button", "stage"),
    [
        ("camera", "Calibrate", "camera views"),
        pytest.param("planes", "Calibrate", "plane poses", marks=pytest.mark.accuracy),
        pytest.param("scan", "Measure again", "frames", marks=pytest.mark.accuracy),
        ("scan", "Measure again", "network"),
        pytest.param("scan", "Measure again", "mesh", marks=pytest.mark.accuracy),
        pytest.param("scan", "Measure again", "calibration uncertainty", marks=pytest.mark.accuracy),
        ("inspect", "Measure again", "faces"),
        ("report", "Make it again", "report"),
    ],
)
def test_cancel_acts_within_a_second(
    technician: Technician, measured_project: Path, page: str, button: str, stage: str
) -> None:
    t = technician
    t.window.projects.open_project(measured_project)
    t.window.go_to(page)
    t.idle()
    before, results = fingerprint(measured_project), dict(t.model.results)
    canceller = Canceller(t, stage)
    t.press(button)
    t.until(lambda: canceller.ended_at, f"the job to end ({stage})", 60)
    assert canceller.pressed_at, "the job never came to that stage"
    assert canceller.outcome == ["cancelled"]
    assert canceller.ended_at - canceller.pressed_at < WITHIN_S + SLACK_S
    t.idle()
    assert fingerprint(measured_project) == before
    assert dict(t.model.results) == results
    assert t.errors() == []


def test_a_job_can_be_done_after_one_was_cancelled(technician: Technician, measured_project: Path) -> None:
    t = technician
    t.window.projects.open_project(measured_project)
    t.window.go_to("report")
    t.idle()
    canceller = Canceller(t, "")
    t.press("Make it again")
    t.until(lambda: canceller.outcome == ["cancelled"], "the job to be cancelled")
    made_at = t.model.results["report"].at
    t.press("Make it again")
    t.until(lambda: t.model.results["report"].at > made_at, "the report")
    assert canceller.outcome == ["cancelled", "done"]
