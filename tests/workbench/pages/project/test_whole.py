"""One button from pictures to verdict, in the window, with real processes."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from core.files.project.data import Accepted, Project
from core.files.project.folder import read_project, results_folder
from tests.workbench.technician import Technician

STEPS = ("camera", "planes", "scan", "inspect", "report")


@pytest.fixture
def opened(technician: Technician, measured_project: Path) -> Technician:
    """A project whose pictures are there, and nothing else."""
    project = read_project(measured_project).project
    technician.model.create(measured_project.parent / "fresh", _fresh(project, measured_project))
    technician.idle()
    return technician


def _fresh(project: Project, folder: Path) -> Project:
    inside = {part: str(folder / getattr(project.sources, part)) for part in ("camera", "planes", "scan")}
    return replace(project, accepted=Accepted(), sources=replace(project.sources, **inside))


def states(t: Technician) -> list[str]:
    return [str(t.model.states[step].state) for step in STEPS]


def is_over(t: Technician) -> bool:
    return not t.window.presenters["project"].whole.running  # type: ignore[attr-defined]


def shows_its_calibration(page: Any) -> bool:
    return page.candidate == page.acceptance.accepted != ""


@pytest.mark.accuracy
def test_it_ends_at_the_report_with_every_page_up_to_date_and_one_undo(
    opened: Technician, measured_project: Path
) -> None:
    t = opened
    t.press("Measure everything")
    t.until(lambda: is_over(t), "the whole job", 120)
    t.idle()
    assert t.errors() == []
    assert t.window.current == "report"
    assert states(t) == ["done"] * 5
    for name in ("cloud.ply", "gauge.json"):
        mine = results_folder(measured_project.parent / "fresh") / name
        assert mine.read_bytes() == (results_folder(measured_project) / name).read_bytes(), name
    for step in ("camera", "planes"):  # the pages show what the calibration was made from, as if they had made it
        page: Any = t.window.presenters[step]
        t.until(partial(shows_its_calibration, page), f"{step} to show its calibration")
        assert page.views()
    assert t.model.undo_stack.count() == 1
    t.model.undo_stack.undo()
    assert t.model.project.accepted == Accepted()


@pytest.mark.accuracy
def test_it_stops_where_somebody_has_to_decide_and_goes_on_from_there(opened: Technician) -> None:
    t = opened
    sources = t.model.project.sources
    t.model.edit("no plates", replace(t.model.project, sources=replace(sources, planes="")))
    t.press("Measure everything")
    t.until(lambda: is_over(t), "the job to stop", 60)
    assert t.window.current == "planes"
    assert states(t)[0] == "done"
    assert [notice.level for notice in t.bench.notices.all] == ["warning"]
    t.model.edit("plates", replace(t.model.project, sources=sources))
    t.window.presenter_action("whole", "project")
    t.until(lambda: is_over(t), "the rest of the job", 120)
    assert t.window.current == "report"
    assert states(t) == ["done"] * 5
    t.idle()


def test_what_was_done_before_a_cancel_stays(opened: Technician) -> None:
    t = opened
    t.press("Measure everything")
    t.until(lambda: "camera" in t.model.results, "the camera", 60)
    t.window.cancel_task()
    t.until(lambda: is_over(t), "the job to be cancelled", 20)
    assert t.model.project.accepted.camera
    assert states(t)[0] == "done"
    assert "scan" not in t.model.results
    t.idle()


def test_the_button_says_why_nothing_is_to_be_done(technician: Technician, measured_project: Path) -> None:
    t = technician
    t.model.open(measured_project)
    t.idle()
    page: Any = t.window.pages["project"]
    t.until(lambda: page.whole.toolTip() == "Everything is done.", "the button's reason")
    assert not page.whole.isEnabled()
    t.model.edit("no scan", replace(t.model.project, sources=replace(t.model.project.sources, scan="")))
    t.until(lambda: "Choose or record" in page.whole.toolTip(), "another reason")
