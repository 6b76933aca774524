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


Edit = Callable[[Technician], None]


@pytest.mark.parametrize(
    ("page", "edits"),
    [
        ("project", {change_a_field: ("report",)}),
        (
            "camera",
            {leave_out_a_view: AFTER_CAMERA, change_the_target: AFTER_CAMERA, reject_the_camera: AFTER_CAMERA},
        ),
        (
            "planes",
            {leave_out_a_pose: AFTER_PLANES, change_the_laser: AFTER_PLANES, reject_the_planes: AFTER_PLANES},
        ),
        (
            "scan",
            {
                leave_out_a_frame: AFTER_SCAN,
                change_a_parameter_of_the_scan: AFTER_SCAN,
                choose_another_folder: AFTER_SCAN,
            },
        ),
        ("inspect", {draw_regions: AFTER_INSPECT, change_the_tolerance: AFTER_INSPECT, add_a_repeat: ("report",)}),
        ("report", {leave_out_a_section: ("report",), change_the_paper: ("report",)}),
    ],
)
def test_an_edit_is_undone_and_redone_from_the_menu_and_results_follow(
    technician: Technician, measured_project: Path, page: str, edits: dict[Edit, tuple[str, ...]]
) -> None:
    """One edit after another, each from the project as it was opened, which it leaves as it was."""
    t = technician
    t.window.projects.open_project(measured_project)
    t.window.go_to(page)
    t.idle()
    t.activate()
    for edit, outdated in edits.items():
        undo_and_redo(t, edit, outdated)


def undo_and_redo(t: Technician, edit: Edit, outdated: tuple[str, ...]) -> None:
    before, results, what = t.model.project, dict(t.model.results), edit.__name__
    undo, redo = t.window.menus.actions["undo"], t.window.menus.actions["redo"]
    assert not undo.isEnabled(), what

    def stale() -> tuple[str, ...]:
        states = {step: t.window.rail.state_of(step) for step in ORDER}
        assert set(states.values()) <= {"done", "outdated"}, states
        return tuple(step for step in ORDER if states[step] == "outdated")

    def settle(wanted: tuple[str, ...]) -> None:
        """What follows is there; the pages of a report, of which each takes seconds, need not be drawn each time."""
        if t.window.current == "report":
            t.until(lambda: stale() == wanted, f"{what}: {wanted} to be out of date")
        else:
            t.idle()

    edit(t)
    t.until(lambda: t.model.project != before, what)
    settle(outdated)
    after = t.model.project
    assert stale() == outdated, what
    assert undo.isEnabled(), what
    assert undo.text() == f"Undo {t.model.undo_stack.undoText()}"
    undo.trigger()
    settle(())
    assert t.model.project == before, what
    assert stale() == (), what
    redo.trigger()
    settle(outdated)
    assert t.model.project == after, what
    assert stale() == outdated, what
    undo.trigger()
    settle(())
    assert t.model.project == before and stale() == (), what
    assert dict(t.model.results) == results, what
    assert t.presenter().blocker() == "", what
    assert t.errors() == [], what


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
