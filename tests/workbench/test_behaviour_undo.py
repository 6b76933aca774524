"""Each kind of edit is undone and redone from the Edit menu; results go out of date by it, and come back."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.workbench.technician import Technician
from workbench.step_state import ORDER

AFTER_CAMERA = ("camera", "planes", "scan", "inspect", "report")
AFTER_PLANES = AFTER_CAMERA[1:]
AFTER_SCAN = AFTER_CAMERA[2:]
AFTER_INSPECT = AFTER_CAMERA[3:]


def leave_out_a_view(t: Technician) -> None:
    t.uncheck("view03.png")


def leave_out_a_pose(t: Technician) -> None:
    t.uncheck("pose02")


def leave_out_a_frame(t: Technician) -> None:
    t.uncheck("frame0004.png")


def change_a_parameter_of_the_scan(t: Technician) -> None:
    t.unfold("Settings")
    t.type_in(t.field("Largest σ"), "0.25")


def change_the_laser(t: Technician) -> None:
    t.unfold("Laser")
    t.type_in(t.field("Angle"), "4.9")


def change_the_target(t: Technician) -> None:
    t.unfold("Target")
    t.type_in(t.field("Square"), "10.1")


def reject_the_camera(t: Technician) -> None:
    t.press("Reject")


def reject_the_planes(t: Technician) -> None:
    t.press("Reject")


def choose_another_folder(t: Technician) -> None:
    assert t.model.folder is not None
    t.will_choose(t.model.folder / "recordings" / "camera")
    t.unfold("Recording")
    t.press("Recorded folder")
    t.press("Choose folder …")


def draw_regions(t: Technician) -> None:
    faces = t.presenter().faces
    t.until(lambda: faces.region("upper") is not None or t.presenter().scan.view is not None, "the scan to be read")
    square = np.array([[0.0, 0.0], [60.0, 0.0], [60.0, 60.0], [0.0, 60.0]])
    faces.set_region("upper", square + 200)


def change_the_tolerance(t: Technician) -> None:
    t.type_in(t.field("Tolerance ±"), "0.3")


def add_a_repeat(t: Technician) -> None:
    t.press("Add to repeats")


def leave_out_a_section(t: Technician) -> None:
    t.press(next(button.text() for button in t.page().boxes.values()))


def change_the_paper(t: Technician) -> None:
    t.choose("Paper", "Letter")


def change_a_field(t: Technician) -> None:
    t.type_in(t.field("Part"), "Another block")


@pytest.mark.parametrize(
    ("page", "edit", "outdated"),
    [
        ("project", change_a_field, ("report",)),
        ("camera", leave_out_a_view, AFTER_CAMERA),
        ("camera", change_the_target, AFTER_CAMERA),
        ("camera", reject_the_camera, AFTER_CAMERA),
        ("planes", leave_out_a_pose, AFTER_PLANES),
        ("planes", change_the_laser, AFTER_PLANES),
        ("planes", reject_the_planes, AFTER_PLANES),
        ("scan", leave_out_a_frame, AFTER_SCAN),
        ("scan", change_a_parameter_of_the_scan, AFTER_SCAN),
        ("scan", choose_another_folder, AFTER_SCAN),
        ("inspect", draw_regions, AFTER_INSPECT),
        ("inspect", change_the_tolerance, AFTER_INSPECT),
        ("inspect", add_a_repeat, ("report",)),
        ("report", leave_out_a_section, ("report",)),
        ("report", change_the_paper, ("report",)),
    ],
)
def test_an_edit_is_undone_and_redone_from_the_menu_and_results_follow(
    technician: Technician,
    measured_project: Path,
    page: str,
    edit: Callable[[Technician], None],
    outdated: tuple[str, ...],
) -> None:
    t = technician
    t.window.projects.open_project(measured_project)
    t.window.go_to(page)
    t.idle()
    t.activate()
    before, results = t.model.project, dict(t.model.results)
    undo, redo = t.window.menus.actions["undo"], t.window.menus.actions["redo"]
    assert not undo.isEnabled()

    def stale() -> tuple[str, ...]:
        states = {step: t.window.rail.state_of(step) for step in ORDER}
        assert set(states.values()) <= {"done", "outdated"}, states
        return tuple(step for step in ORDER if states[step] == "outdated")

    edit(t)
    t.until(lambda: t.model.project != before, "the edit")
    t.idle()
    after = t.model.project
    assert stale() == outdated
    assert undo.isEnabled()
    assert undo.text() == f"Undo {t.model.undo_stack.undoText()}"
    for _ in range(1 if page == "report" else 2):  # a report takes seconds each time
        undo.trigger()
        t.idle()
        assert t.model.project == before
        assert stale() == ()
        redo.trigger()
        t.idle()
        assert t.model.project == after
        assert stale() == outdated
    undo.trigger()
    t.idle()
    assert dict(t.model.results) == results
    assert t.presenter().blocker() == ""
    assert t.errors() == []


def test_accepting_another_calibration_is_an_edit_and_what_rested_on_the_last_one_goes_out_of_date(
    technician: Technician, measured_project: Path
) -> None:
    t = technician
    t.window.projects.open_project(measured_project)
    t.window.go_to("camera")
    t.idle()
    first = t.model.project.accepted.camera
    t.uncheck("view03.png")
    t.press("Accept")
    t.until(lambda: t.model.project.accepted.camera != first, "another camera to be accepted")
    t.idle()
    assert t.window.rail.state_of("camera") == "done"
    assert t.window.rail.state_of("planes") == "outdated"
    undo = t.window.menus.actions["undo"]
    assert undo.text() == "Undo accept the camera calibration"
    undo.trigger()
    t.idle()
    assert t.model.project.accepted.camera == first
    assert t.window.rail.state_of("planes") == "outdated"  # for the view is still left out
    undo.trigger()
    t.idle()
    assert t.window.rail.state_of("camera") == "done"


def test_a_new_project_has_nothing_to_undo(technician: Technician, measured_project: Path) -> None:
    t = technician
    t.window.projects.open_project(measured_project)
    t.type_in(t.field("Part"), "Another")
    t.window.projects.close_project()
    for name in ("undo", "redo", "save", "next"):
        assert not t.window.menus.actions[name].isEnabled(), name
    t.window.projects.open_project(measured_project)
    assert t.model.project.info.part == "Another"
    assert not t.window.menus.actions["undo"].isEnabled()
