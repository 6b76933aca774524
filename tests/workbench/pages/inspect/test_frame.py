"""The frame in which the surface is shown, and in which all that is read from it is told."""

from dataclasses import replace
from typing import cast

import numpy as np
import pytest
from numpy.testing import assert_allclose
from PySide6.QtCore import QPoint, Qt

from core.inspect.plan.feature_spec import Auto, FaceAt, FeatureSpec, InBox, InSphere
from core.inspect.plan.inspection_plan import InspectionPlan, PartFrame
from core.inspect.shown.clicked_faces import ClickedFace, ClickedFaces
from core.inspect.shown.shown_features import ShownFeature, ShownInspection
from core.inspect.shown.view_frame import FrameKind
from core.model import Pose
from tests.workbench.cells import shown
from tests.workbench.hand_lane import HandLane
from tests.workbench.pages import inspect_cases as cases
from workbench.settings import AppSettings
from workbench.work import jobs

POSE = Pose.from_vector([3.0, 0.2, 0.1, 4.0, -6.0, 548.0])
PLACED = InspectionPlan(
    (FeatureSpec("base", "plane"), FeatureSpec("side", "plane", (Auto(2),))), PartFrame("base", "side")
)


def shown_of(plan):
    none = np.zeros((0, 3), np.float32)
    features = tuple(ShownFeature(one.name, one.kind, (), 0, none, none[:, :2]) for one in plan.features)
    return ShownInspection(features, False, (), "cal-1", POSE if plan.frame else None)


@pytest.fixture
def measuring(measuring):
    measuring.answers[jobs.MEASURE_FEATURES] = lambda folder, project: shown_of(project.inspection)
    return measuring


@pytest.fixture
def measured():
    """The thickness that the scan has, if any."""
    return [cases.gauge()]


@pytest.fixture
def page(hand_bench, measuring, quick, measured, show_page, tmp_path, qtbot):
    quick.answers[jobs.INSPECTION_VIEW] = lambda folder, project: cases.view(*measured)
    made = show_page(cases.entered(hand_bench, tmp_path / "project", cases.project(), qtbot))
    made.refreshing.at_once()
    return made


def press(page, qtbot):
    """The button of the frame in the view's tool bar."""
    qtbot.mouseClick(page.surface.scene._buttons.widgetForAction(page.surface.frame.action), Qt.MouseButton.LeftButton)
    page.refreshing.at_once()


def place_parts(page, qtbot, plan=PLACED):
    """Give the plan part coordinates that are measured."""
    page.presenter.features.put_plan(plan, "a frame")
    page.presenter.features.measure()
    qtbot.waitUntil(lambda: page.presenter.features.shown is not None)
    page.refreshing.at_once()


def listed(page):
    """x, y, z of the picked point as they stand in the list, and what stands over them."""
    words = shown(page.picks.list, 0).split("\n")[0].replace("\N{MINUS SIGN}", "-").split()
    return [float(words[words.index(name) + 1]) for name in "xyz"], page.picks.frame.text()


def test_with_a_thickness_z_stands_on_the_lower_face(page):
    assert page.surface.scene.frame.kind is FrameKind.GROUND
    assert page.surface.frame.action.isChecked()
    points = page.presenter.scan.view.points
    assert_allclose(page.surface.scene.frame.coordinates(points)[:, 2], 550 - points[:, 2])


def test_without_a_thickness_the_frame_is_the_cameras_and_the_button_says_why(page, measured, qtbot):
    measured[:] = [None]
    page.presenter.scan.forget()
    page.presenter.entered()
    qtbot.waitUntil(lambda: page.presenter.scan.view is not None)
    page.refreshing.at_once()
    assert page.surface.scene.frame.kind is FrameKind.CAMERA
    action = page.surface.frame.action
    assert not action.isEnabled() and not action.isChecked()
    assert "measure the thickness" in action.toolTip()
    assert page.presenter.bench.settings.part_frame, "the wish stays"


def test_part_coordinates_of_the_plan_are_shown_as_soon_as_they_are_measured(page, qtbot):
    place_parts(page, qtbot)
    assert page.surface.scene.frame.kind is FrameKind.PART
    assert_allclose(page.surface.scene.frame.coordinates(POSE.translation), np.zeros(3), atol=1e-9)


def test_part_coordinates_by_other_features_are_not_taken_for_those_asked_for(page, measuring, qtbot):
    place_parts(page, qtbot)
    measuring.held = {jobs.MEASURE_FEATURES}
    page.presenter.features.put_plan(replace(PLACED, frame=PartFrame("side", "base")), "another frame")
    page.refreshing.at_once()
    assert page.presenter.features.pose_camera_part is None
    assert page.surface.scene.frame.kind is FrameKind.GROUND
    assert page.surface.frame.action.isEnabled()


def test_the_button_changes_the_frame_of_view_and_numbers_and_is_remembered(page, qtbot, tmp_path):
    place_parts(page, qtbot)
    page.presenter.start_picking("point")
    page.surface.scene.point_picked.emit(7, None)
    page.refreshing.at_once()
    point = page.presenter.scan.view.points[7]
    inside, frame = listed(page)
    assert frame == "x, y, z: part coordinates"
    assert_allclose(inside, POSE.inverse().apply(point), atol=0.006)
    press(page, qtbot)
    seen, frame = listed(page)
    assert frame == "x, y, z: as the camera sees it" and page.surface.scene.frame.kind is FrameKind.CAMERA
    assert_allclose(seen, point, atol=0.006)
    settings = page.presenter.bench.settings
    settings.flush()
    assert not AppSettings(tmp_path / "settings.ini").part_frame
    press(page, qtbot)
    assert listed(page)[1] == "x, y, z: part coordinates" and settings.part_frame


def test_the_ends_of_a_distance_are_listed_in_the_frame_of_the_view(page, qtbot):
    place_parts(page, qtbot)
    page.presenter.start_picking("distance")
    for number in (5, 6):
        page.surface.scene.point_picked.emit(number, None)
    page.refreshing.at_once()
    inside = shown(page.picks.list, 0)
    first = POSE.inverse().apply(page.presenter.scan.view.points[5])
    assert f"({', '.join(f'{c:.1f}' for c in first)})".replace("-", "\N{MINUS SIGN}") in inside
    press(page, qtbot)
    seen = shown(page.picks.list, 0)
    assert seen.split("\n")[0] == inside.split("\n")[0], "the distance is the same"
    assert seen != inside


@pytest.mark.parametrize("in_part", [True, False])
def test_a_click_on_a_face_grows_from_the_point_under_it_in_either_frame(page, qtbot, in_part):
    place_parts(page, qtbot)
    if not in_part:
        press(page, qtbot)
    asked = []

    def grow(folder, points, kind, pose):
        asked.append((points, pose))
        return ClickedFaces((ClickedFace("plane", 9, 0.01, np.zeros((5, 3), np.float32), (FaceAt(at_px=(1.0, 2.0)),)),))

    cast(HandLane, page.presenter.bench.quick).answers[jobs.CLICKED_FACES] = grow
    page.presenter.start_clicking("face")
    page.refreshing.at_once()
    scene, view = page.surface.scene, page.presenter.scan.view
    scene.view("iso")
    at = scene.screen_positions(view.points)
    apart = np.linalg.norm(at[:, None] - at[None], axis=2)
    np.fill_diagonal(apart, np.inf)
    lonely = int(apart.min(axis=1).argmax())
    qtbot.mouseClick(scene.focusProxy(), Qt.MouseButton.LeftButton, pos=QPoint(*np.round(at[lonely]).astype(int)))
    qtbot.waitUntil(lambda: bool(asked))
    assert asked == [((int(view.number[lonely]),), POSE)], "points and part coordinates stay what they are"


# ---- sections and regions in part coordinates


def test_a_new_section_is_a_plane_in_part_coordinates_where_these_are_known(page, qtbot):
    presenter = page.presenter
    presenter.feature.add("section")
    assert presenter.feature.spec.section.line_px is not None, "nothing of the part is known yet"
    place_parts(page, qtbot)
    presenter.feature.add("section")
    section = presenter.feature.spec.section
    assert section.line_px is None
    middle = np.median(POSE.inverse().apply(presenter.scan.view.points)[:, 1])
    assert_allclose(section.point_mm, (0.0, middle, 0.0), atol=6e-4)
    assert_allclose(section.normal, (0.0, -1.0, 0.0), atol=1e-9)  # so that positions run along x


def test_where_a_section_is_can_be_typed_undone_and_is_refused_with_a_sentence(page, qtbot):
    place_parts(page, qtbot)
    features, edit = page.presenter.features, page.presenter.feature
    edit.add("section")
    page.refreshing.at_once()
    form = page.features.form.what
    before = edit.spec.section
    assert {"place", "direction"} <= set(form.values()) and not any(key.startswith("line ") for key in form.values())
    form.edited.emit("place", "10; 20,5; -3")
    form.edited.emit("direction", "1; 0; 0")
    page.refreshing.at_once()
    assert edit.spec.section.point_mm == (10.0, 20.5, -3.0) and edit.spec.section.normal == (1.0, 0.0, 0.0)
    assert (form.values()["place"], form.values()["direction"]) == ("10; 20.5; -3", "1; 0; 0")
    for key, text in (("place", "10; 20"), ("direction", "0; 0; 1")):
        form.edited.emit(key, text)
        page.refreshing.at_once()
        assert form.help_of(key).startswith("Write x, y and z") and form.values()[key] == text
        assert edit.spec.section.normal == (1.0, 0.0, 0.0), "the plan stays as it was"
    for _ in range(2):
        features.model.undo_stack.undo()
    assert edit.spec.section == before


def test_a_region_of_part_coordinates_is_laid_round_the_points_used_and_typed(page, measuring, qtbot):
    points = POSE.apply(np.array([[0.0, 0.0, 0.0], [10.0, 20.0, 4.0]])).astype(np.float32)

    def measured(folder, project):
        shown = shown_of(project.inspection)
        return replace(shown, features=tuple(replace(one, places=points) for one in shown.features))

    features, edit = page.presenter.features, page.presenter.feature
    edit.add("plane")
    page.refreshing.at_once()
    form = page.features.form
    source = form.where._editors["source 0"]
    assert source.findData("box") < 0, "of no frame, there are no part coordinates"
    measuring.answers[jobs.MEASURE_FEATURES] = measured
    place_parts(page, qtbot, replace(PLACED, features=(*PLACED.features, FeatureSpec("top", "plane", (Auto(3),)))))
    features.choose("top")
    page.refreshing.at_once()
    form.where.edited.emit("source 0", "box")
    page.refreshing.at_once()
    (box,) = edit.spec.regions
    assert_allclose((box.low_mm, box.high_mm), ((0, 0, 0), (10, 20, 4)), atol=2e-3)
    form.where.edited.emit("low 0", "30; 0; 0")
    page.refreshing.at_once()
    assert form.where.help_of("low 0").startswith("Each of the smallest") and edit.spec.regions == (box,)
    form.where.edited.emit("high 0", "50; 20; 5")
    assert edit.spec.regions == (InBox((30.0, 0.0, 0.0), (50.0, 20.0, 5.0)),), "both corners count together"
    form.where.edited.emit("source 0", "sphere")
    page.refreshing.at_once()
    form.where.edited.emit("radius 0", 7.5)
    form.where.edited.emit("centre 0", "1; 2; 3")
    assert edit.spec.regions == (InSphere((1.0, 2.0, 3.0), 7.5),)
    for _ in range(4):
        features.model.undo_stack.undo()
    assert edit.spec.regions == (box,)
