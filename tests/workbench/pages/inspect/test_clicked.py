"""Faces clicked in 3D: shown before they are taken, taken by Enter as one edit, dropped by Esc."""

from dataclasses import replace
from typing import cast

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt

from core.errors import InputError
from core.files.project.keys import finished
from core.inspect.plan.feature_spec import Auto, FaceAt, FeatureSpec, Polygon
from core.inspect.plan.inspection_plan import InspectionPlan, PartFrame
from core.inspect.shown.clicked_faces import ClickedFace, ClickedFaces
from core.inspect.shown.shown_features import ShownFeature, ShownInspection
from core.messages import plain
from core.model import Pose
from tests.workbench.hand_lane import HandLane
from tests.workbench.pages import inspect_cases as cases
from workbench.pages.inspect.features import values as fields
from workbench.pages.inspect.features.form import CLICK
from workbench.pages.inspect.surface import PROPOSALS
from workbench.views.scene.contents import Marks
from workbench.work import jobs

LEFT = Qt.MouseButton.LeftButton
CORNERS = ((1.0, 1.0), (9.0, 1.0), (5.0, 9.0))


def face(number: int, kind: str = "plane", pose: Pose | None = None) -> ClickedFace:
    """Grown from the point of this number in the cloud."""
    seeds = (FaceAt(at_px=(float(number), 2.0)),)
    placed = () if pose is None else (FaceAt(at_mm=(float(number), 0.0, 0.0)),)
    return ClickedFace(kind, 8476, 0.0123, np.full((5, 3), float(number), np.float32), placed + seeds)


@pytest.fixture
def asked():
    """What was asked of the job that grows faces: points, kind and part coordinates of each call."""
    return []


@pytest.fixture
def quick(quick, asked):
    """Points below 300 are on a plane each, the others on a sphere; two planes are parallel if both are even."""

    def grow(folder, points, kind, pose):
        asked.append((points, kind, pose))
        faces = tuple(face(one, kind or ("plane" if one < 300 else "sphere"), pose) for one in points)
        return ClickedFaces(faces, len(points) == 2 and not any(one % 2 for one in points))

    quick.answers[jobs.CLICKED_FACES] = grow
    return quick


@pytest.fixture
def presenter(hand_bench, measuring, quick, tmp_path, qtbot):
    """A scan with its thickness is shown; the plan is empty."""
    measuring.answers[jobs.MEASURE_FEATURES] = lambda folder, project: shown_of(project.inspection)
    return cases.entered(hand_bench, tmp_path / "project", cases.project(), qtbot)


POSE = Pose(np.eye(3), np.array([0.0, 0.0, 500.0]))


def shown_of(plan):
    none = np.zeros((0, 3), np.float32)
    features = tuple(ShownFeature(one.name, one.kind, (), 0, none, none[:, :2]) for one in plan.features)
    return ShownInspection(features, False, (), "cal-1", POSE if plan.frame else None)


@pytest.fixture
def page(presenter, show_page):
    made = show_page(presenter)
    made.refreshing.at_once()
    return made


def click(presenter, qtbot, cloud_number):
    """Click the point that has this number in the cloud, and wait for what is shown."""
    presenter.click(int(np.flatnonzero(presenter.scan.view.number == cloud_number)[0]))
    qtbot.waitUntil(lambda: presenter.clicked.hint() != "Growing the face …")


def edits(presenter):
    return presenter.model.undo_stack.count()


# ---- one face


def test_a_click_proposes_enter_adds_and_one_undo_takes_it_back(presenter, qtbot, asked):
    presenter.start_clicking("face")
    assert presenter.clicked.hint() == "Click a face. Drag turns the view, Esc ends."
    click(presenter, qtbot, 7)
    assert asked == [((7,), "", None)]
    shown, keys = presenter.clicked.hint().split("\n")
    assert shown == "Plane: 8\N{NO-BREAK SPACE}476 points, scatter 0.012 mm"
    assert keys == "Enter adds it as a feature. Click elsewhere for another, Esc drops it."
    assert presenter.features.plan.features == () and edits(presenter) == 0, "a preview is no edit"
    presenter.clicked.take()
    assert presenter.features.plan.features == (FeatureSpec("plane 1", "plane", (FaceAt(at_px=(7.0, 2.0)),)),)
    assert presenter.features.chosen == "plane 1" and edits(presenter) == 1
    assert presenter.clicked.proposal is None and presenter.clicked.mode == "face", "the next face can be clicked"
    presenter.model.undo_stack.undo()
    assert presenter.features.plan.features == ()


def test_what_is_taken_is_measured_even_where_nothing_was_measured_before(presenter, measuring, qtbot):
    presenter.start_clicking("step")
    for number in (8, 10):
        click(presenter, qtbot, number)
    assert jobs.MEASURE_FEATURES not in measuring.ran and "inspection" not in presenter.model.results
    presenter.clicked.take()
    qtbot.waitUntil(lambda: presenter.features.result("thickness 1") is not None)
    assert measuring.ran.count(jobs.MEASURE_FEATURES) == 1 and edits(presenter) == 1


def test_another_click_replaces_what_is_shown_and_a_double_click_changes_nothing(presenter, qtbot, asked):
    presenter.start_clicking("face")
    click(presenter, qtbot, 7)
    click(presenter, qtbot, 7)
    click(presenter, qtbot, 9)
    assert [points for points, *_ in asked] == [(7,), (9,)]
    presenter.clicked.take()
    assert presenter.features.plan.features[0].regions == (FaceAt(at_px=(9.0, 2.0)),)


def test_faces_clicked_one_after_the_other_become_features_of_what_they_are(presenter, qtbot):
    presenter.start_clicking("face")
    for number in (7, 400, 9):
        click(presenter, qtbot, number)
        presenter.clicked.take()
    assert [(one.name, one.kind) for one in presenter.features.plan.features] == [
        ("plane 1", "plane"),
        ("sphere 1", "sphere"),
        ("plane 2", "plane"),
    ]


def test_a_clicked_face_replaces_the_region_of_the_feature_that_is_chosen(presenter, qtbot, asked):
    presenter.feature.add("cylinder")
    presenter.start_clicking("face")
    click(presenter, qtbot, 7)
    assert asked[-1][1] == "cylinder", "the face is grown as what the feature measures"
    assert "Enter takes it for cylinder 1." in presenter.clicked.hint()
    presenter.clicked.take()
    assert presenter.features.plan.features == (FeatureSpec("cylinder 1", "cylinder", (FaceAt(at_px=(7.0, 2.0)),)),)


def test_what_is_chosen_while_faces_are_clicked_is_what_the_next_one_is_for(presenter, qtbot):
    presenter.feature.add("plane")
    presenter.feature.add("sphere")
    presenter.start_clicking("face")
    click(presenter, qtbot, 7)
    presenter.features.choose("plane 1")
    assert presenter.clicked.proposal is None, "it was shown for another feature"
    click(presenter, qtbot, 8)
    presenter.clicked.take()
    assert presenter.features.plan.feature("plane 1").regions == (FaceAt(at_px=(8.0, 2.0)),)
    assert presenter.features.plan.feature("sphere 1").regions == (Auto(),)


def test_a_feature_added_by_a_click_can_be_renamed_before_the_next_click(presenter, qtbot):
    presenter.start_clicking("face")
    click(presenter, qtbot, 7)
    presenter.clicked.take()
    presenter.feature.set_value("name", "top")
    presenter.features.changed.emit()
    click(presenter, qtbot, 9)
    presenter.clicked.take()
    assert presenter.features.plan.names == ("top", "plane 1")


def test_when_the_feature_meant_is_undone_the_face_is_for_a_new_one(presenter, qtbot):
    presenter.feature.add("sphere")
    presenter.start_clicking("face")
    presenter.model.undo_stack.undo()
    click(presenter, qtbot, 7)
    assert "Enter adds it as a feature." in presenter.clicked.hint()
    presenter.clicked.take()
    assert presenter.features.plan.names == ("plane 1",)


def test_a_refused_face_is_told_and_another_can_be_clicked(presenter, qtbot, quick):
    grow = quick.answers[jobs.CLICKED_FACES]

    def refuse(*_):
        raise InputError(plain("no face goes on from the place that was clicked"))

    quick.answers[jobs.CLICKED_FACES] = refuse
    presenter.start_clicking("face")
    click(presenter, qtbot, 7)
    assert presenter.bench.notices.all[-1].text.startswith("no face goes on")
    assert presenter.clicked.proposal is None and presenter.clicked.hint().startswith("Click a face.")
    presenter.clicked.take()
    assert edits(presenter) == 0
    quick.answers[jobs.CLICKED_FACES] = grow
    click(presenter, qtbot, 7)
    assert presenter.clicked.proposal is not None


def test_an_answer_that_comes_after_the_tool_was_put_down_shows_nothing(presenter, qtbot, quick):
    quick.held = {jobs.CLICKED_FACES}
    presenter.start_clicking("face")
    presenter.click(3)
    presenter.clicked.stop()
    quick.finish(ClickedFaces((face(3),)))
    assert presenter.clicked.proposal is None and presenter.clicked.mode == ""


def test_picking_points_and_leaving_the_page_end_it(presenter, qtbot):
    for end in (lambda: presenter.start_picking("point"), presenter.left):
        presenter.start_clicking("face")
        click(presenter, qtbot, 7)
        end()
        assert presenter.clicked.mode == "" and presenter.clicked.proposal is None
    presenter.start_picking("point")
    presenter.start_clicking("face")
    assert presenter.picks.mode == ""


def test_another_scan_ends_it(presenter, qtbot):
    presenter.start_clicking("face")
    click(presenter, qtbot, 7)
    other = replace(presenter.project, sources=replace(presenter.project.sources, scan="recordings/scan-2"))
    presenter.model.edit("another scan", other)
    presenter.model.record("scan", finished("scan", other, {}))
    qtbot.waitUntil(lambda: not presenter.scan.stale)
    assert presenter.clicked.mode == "" and presenter.clicked.proposal is None


# ---- two faces


def test_two_clicks_on_parallel_faces_make_a_thickness_in_one_edit(presenter, qtbot):
    presenter.start_clicking("step")
    assert presenter.clicked.hint().startswith("Click the first of two faces.")
    click(presenter, qtbot, 8)
    assert presenter.clicked.hint().endswith("\nClick the second face. Esc ends.")
    presenter.clicked.take()
    assert edits(presenter) == 0, "one face is no step"
    click(presenter, qtbot, 10)
    assert "Enter measures the step between them." in presenter.clicked.hint()
    presenter.clicked.take()
    step = FeatureSpec("thickness 1", "thickness", (FaceAt(at_px=(8.0, 2.0)), FaceAt(at_px=(10.0, 2.0))))
    assert presenter.features.plan.features == (step,) and edits(presenter) == 1


def test_a_third_click_replaces_the_second_face(presenter, qtbot, asked):
    presenter.start_clicking("step")
    for number in (8, 8, 10, 10, 12):  # some of them twice
        click(presenter, qtbot, number)
    assert [points for points, *_ in asked] == [(8,), (8, 10), (8, 12)]


@pytest.mark.parametrize(
    ("second", "kinds", "said"),
    [(9, ("plane", "plane", "angle"), "not parallel"), (400, ("plane", "sphere", "distance"), "the distance")],
)
def test_faces_that_are_not_parallel_planes_have_an_angle_or_a_distance(presenter, qtbot, second, kinds, said):
    presenter.start_clicking("step")
    for number in (7, second):
        click(presenter, qtbot, number)
    assert said in presenter.clicked.hint()
    presenter.clicked.take()
    features = presenter.features.plan.features
    assert tuple(one.kind for one in features) == kinds
    assert features[2].of == (features[0].name, features[1].name)
    assert presenter.features.chosen == features[2].name and edits(presenter) == 1
    presenter.features.plan.ordered()
    presenter.model.undo_stack.undo()
    assert presenter.features.plan.features == ()


def test_a_second_face_that_is_refused_leaves_the_first(presenter, qtbot, quick):
    presenter.start_clicking("step")
    click(presenter, qtbot, 8)

    def refuse(*_):
        raise InputError(plain("both places that were clicked are on one and the same face"))

    grow, quick.answers[jobs.CLICKED_FACES] = quick.answers[jobs.CLICKED_FACES], refuse
    click(presenter, qtbot, 10)
    assert len(presenter.clicked.proposal.faces) == 1
    quick.answers[jobs.CLICKED_FACES] = grow
    click(presenter, qtbot, 10)
    assert len(presenter.clicked.proposal.faces) == 2


# ---- part coordinates


@pytest.fixture
def framed(presenter, qtbot):
    """Part coordinates rest on two features that are measured."""
    features = FeatureSpec("base", "plane"), FeatureSpec("side", "plane", (Auto(2),)), FeatureSpec("top", "plane")
    presenter.features.put_plan(InspectionPlan(features, PartFrame("base", "side")), "a frame")
    presenter.features.measure()
    qtbot.waitUntil(lambda: presenter.features.shown is not None)
    return presenter


def test_with_part_coordinates_a_face_is_kept_by_its_place_in_them(framed, qtbot, asked):
    framed.start_clicking("face")
    click(framed, qtbot, 7)
    assert asked[-1][2] is POSE
    framed.clicked.take()
    assert framed.features.plan.features[-1].regions == (FaceAt(at_mm=(7.0, 0.0, 0.0)),)


def test_what_part_coordinates_rest_on_is_kept_by_its_pixel(framed, qtbot):
    framed.features.choose("base")
    framed.start_clicking("face")
    click(framed, qtbot, 7)
    framed.clicked.take()
    assert framed.features.plan.feature("base").regions == (FaceAt(at_px=(7.0, 2.0)),)
    framed.features.plan.ordered()


def test_part_coordinates_that_are_out_of_date_are_not_used(framed, qtbot, asked):
    cast(HandLane, framed.bench.measuring).held = {jobs.MEASURE_FEATURES}
    framed.features.choose("side")
    framed.feature.set_value("number 0", 3)
    framed.start_clicking("face")
    click(framed, qtbot, 7)
    assert asked[-1][2] is None


# ---- the page


def marks(page):
    return {name: item for (kind, name), item in page.surface.scene._scene.items.items() if kind is Marks}


def button(page, mode):
    return page.surface.scene._buttons.widgetForAction(page.surface.clicks[mode])


def test_a_face_is_clicked_seen_and_taken_with_mouse_and_keys(page, qtbot):
    scene, presenter = page.surface.scene, page.presenter
    qtbot.mouseClick(button(page, "face"), LEFT)
    page.refreshing.at_once()
    assert page.surface.clicks["face"].isChecked()
    assert scene._canvas.tool.hint.startswith("Click a face.")
    spots = scene.screen_positions(presenter.scan.view.points)
    x, y = spots[np.argmin(np.hypot(*(spots - spots.mean(axis=0)).T))]
    qtbot.mouseClick(scene._canvas, LEFT, pos=QPoint(round(x), round(y)))
    qtbot.waitUntil(lambda: presenter.clicked.proposal is not None)
    page.refreshing.at_once()
    assert PROPOSALS[0] in marks(page)
    assert "scatter 0.012 mm" in scene._canvas.tool.hint
    qtbot.keyClick(scene._canvas, Qt.Key.Key_Return)
    page.refreshing.at_once()
    assert len(presenter.features.plan.features) == 1 and edits(presenter) == 1
    assert PROPOSALS[0] not in marks(page) and scene._canvas.tool.hint.startswith("Click a face.")


def test_escape_drops_what_is_shown_and_puts_the_tool_down(page, qtbot):
    scene, presenter = page.surface.scene, page.presenter
    qtbot.mouseClick(button(page, "step"), LEFT)
    page.refreshing.at_once()
    for number in (8, 10):
        click(presenter, qtbot, number)
    page.refreshing.at_once()
    assert set(PROPOSALS) <= set(marks(page))
    qtbot.keyClick(scene._canvas, Qt.Key.Key_Escape)
    page.refreshing.at_once()
    assert not set(PROPOSALS) & set(marks(page))
    assert presenter.clicked.mode == "" and not page.surface.clicks["step"].isChecked()
    assert presenter.features.plan.features == () and edits(presenter) == 0


def test_keys_begin_and_end_it(page, qtbot):
    canvas = page.surface.scene._canvas
    page.activateWindow()
    canvas.setFocus()
    qtbot.waitUntil(lambda: canvas.hasFocus())
    qtbot.keyClick(canvas, Qt.Key.Key_C)
    assert page.presenter.clicked.mode == "face"
    page.refreshing.at_once()
    qtbot.keyClick(canvas, Qt.Key.Key_C, Qt.KeyboardModifier.ShiftModifier)
    assert page.presenter.clicked.mode == "step"
    page.refreshing.at_once()
    qtbot.keyClick(canvas, Qt.Key.Key_C, Qt.KeyboardModifier.ShiftModifier)
    assert page.presenter.clicked.mode == ""


def test_the_form_takes_a_clicked_face_for_one_of_two_regions(page, qtbot):
    presenter = page.presenter
    spec = FeatureSpec("block", "thickness", (Polygon(CORNERS), Auto(2)))
    presenter.features.put(spec)
    page.refreshing.at_once()
    form = page.features.form
    assert form.where.values()["source 0"] == fields.DRAWN
    form.tools[1, CLICK].click()
    page.refreshing.at_once()
    click(presenter, qtbot, 7)
    presenter.clicked.take()
    page.refreshing.at_once()
    assert presenter.features.plan.feature("block").regions == (Polygon(CORNERS), FaceAt(at_px=(7.0, 2.0)))
    assert form.where.values()["source 1"] == fields.CLICKED


def test_choosing_a_clicked_face_in_the_form_lets_one_click(page):
    page.presenter.feature.add("plane")
    page.refreshing.at_once()
    page.features.form.where.edited.emit("source 0", fields.CLICKED)
    assert page.presenter.clicked.mode == "face" and page.tabs.currentWidget() is page.surface
    page.refreshing.at_once()
    assert page.features.form.where.values()["source 0"] == fields.AUTO, "nothing was clicked yet"


def test_the_picture_shows_where_a_face_was_clicked(page):
    page.presenter.features.put(FeatureSpec("top", "plane", (FaceAt(at_px=(20.0, 15.0)),)))
    page.tabs.setCurrentWidget(page.picture)
    page.refreshing.at_once()
    assert "clicked face of the feature" in page.picture.image.legend_titles
