from __future__ import annotations

from dataclasses import replace

import pytest

from core.files.project.data import Done, Project, new_project
from core.files.project.keys import finished
from core.files.recording.rig import GaugeSpec
from core.files.step_graph import MAIN
from workbench.step_state import ORDER, State, step_states

PAGES = ORDER[1:]
GAUGE = GaugeSpec(nominal_mm=50.0, tolerance_mm=0.2)


@pytest.fixture
def project() -> Project:
    made = new_project("Block")
    return replace(made, accepted=replace(made.accepted, camera="a", planes="b"))


@pytest.fixture
def results(project: Project) -> dict[str, Done]:
    """Every step done with the project as it is."""
    done: dict[str, Done] = {}
    for step in MAIN.values():
        done[step] = finished(step, project, done)
    return done


def states(project: Project, results: dict[str, Done]) -> dict[str, State]:
    return {step: state.state for step, state in step_states(project, results).items()}


def test_a_new_project_is_ready_for_its_camera_alone() -> None:
    now = states(new_project("Block"), {})
    assert now == {"project": State.DONE, "camera": State.READY} | dict.fromkeys(PAGES[1:], State.TODO)
    assert step_states(new_project("Block"), {})["scan"].sentence.startswith("First: calibrate the camera, calibrate")


def test_a_finished_project_is_done(project: Project, results: dict[str, Done]) -> None:
    assert set(states(project, results).values()) == {State.DONE}


def test_another_camera_puts_everything_behind_it_out_of_date_and_says_why(
    project: Project, results: dict[str, Done]
) -> None:
    other = replace(project, accepted=replace(project.accepted, camera="c"))
    now = step_states(other, results)
    assert [step for step in ORDER if now[step].state is State.OUTDATED] == ["planes", "scan", "inspect", "report"]
    assert now["planes"].sentence == "Out of date: changed since: camera calibration."
    assert now["inspect"].sentence == "Out of date, because this is: scan."


def test_a_report_prints_the_thickness_and_is_out_of_date_with_it(project: Project, results: dict[str, Done]) -> None:
    rig = replace(project.rig, gauge=GAUGE)
    now = step_states(replace(project, rig=rig), results)
    assert [step for step in ORDER if now[step].state is State.OUTDATED] == ["inspect", "report"]
    assert now["report"].sentence == "Out of date, because this is: inspect."


def test_a_report_can_do_without_a_thickness(project: Project, results: dict[str, Done]) -> None:
    done = {step: result for step, result in results.items() if step not in ("gauge", "report")}
    done["report"] = finished("report", project, done)
    assert states(project, done)["report"] is State.DONE
    assert states(project, done)["inspect"] is State.READY
