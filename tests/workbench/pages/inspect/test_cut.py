"""A plane laid through the surface by hand: seen at once, kept as one edit."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from PySide6.QtCore import QPoint, QRect, Qt

from core.inspect.plan.feature_spec import Auto, FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan, PartFrame
from core.report.wording import grouped
from tests.workbench.pages import inspect_cases as cases
from workbench.pages.inspect.surface import CUT
from workbench.views.scene.contents import Patches
from workbench.work import jobs

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def page(hand_bench, measuring, quick, show_page, tmp_path, qtbot):
    measuring.held = {jobs.MEASURE_FEATURES}
    made = show_page(cases.entered(hand_bench, tmp_path / "project", cases.project(), qtbot))
    made.refreshing.at_once()
    return made


def press(page, qtbot, button):
    assert button.isEnabled(), button.toolTip()
    qtbot.mouseClick(button, LEFT)
    settle(page, qtbot)


def settle(page, qtbot):
    qtbot.wait(30)
    page.refreshing.at_once()


def button(page):
    return page.surface.scene._buttons.widgetForAction(page.surface.cutting)


def patch(page):
    """Corners of the plane as it is drawn, in the frame of the view."""
    corners = page.surface.scene._scene.items[Patches, CUT].corners[0]
    return page.surface.scene.frame.coordinates(corners)


@pytest.fixture
def cut(page, qtbot):
    """The page with a plane laid through the surface."""
    press(page, qtbot, button(page))
    return page


def test_the_button_lays_a_plane_through_the_part_and_takes_it_away(page, qtbot):
    assert page.surface.cut.isHidden()
    press(page, qtbot, button(page))
    assert page.surface.cut.isVisible() and page.surface.cutting.isChecked()
    upper = page.presenter.scan.view.points[page.presenter.scan.gauge.upper.indices]
    middle = np.median(page.surface.scene.frame.coordinates(upper)[:, 0])
    assert_allclose(patch(page)[:, 0], middle, atol=1e-9)
    assert page.surface.cut.at.value() == pytest.approx(middle, abs=0.006)
    press(page, qtbot, button(page))
    assert page.surface.cut.isHidden() and (Patches, CUT) not in page.surface.scene._scene.items
    assert page.presenter.model.undo_stack.count() == 0, "looking is no edit"


@pytest.mark.parametrize(("height", "beside"), [(430, True), (800, False)])
def test_surface_and_profile_are_seen_whole_side_by_side_where_the_window_is_low(cut, qtbot, height, beside):
    cut.resize(880, height)
    surface = cut.surface
    views = [surface.scene._canvas, surface.cut.chart]
    qtbot.waitUntil(lambda: (views[1].geometry().left() > surface.scene.geometry().right()) == beside)
    assert surface.rect().contains(surface.cut.geometry())
    for view in views:
        assert surface.rect().contains(QRect(view.mapTo(surface, QPoint(0, 0)), view.size()))
        assert view.height() >= 140 and view.width() >= 150


def test_the_profile_holds_the_points_near_the_plane_as_it_is_moved(cut, qtbot):
    for at in (-10.0, 12.5):
        cut.surface.cut.at.setValue(at)
        settle(cut, qtbot)
        coordinates = cut.surface.scene.frame.coordinates(cut.presenter.scan.view.points)
        near = coordinates[np.abs(coordinates[:, 0] - at) <= 1.0]
        drawn = cut.surface.cut.chart._curves["points"]
        assert_allclose(drawn.x, np.sort(near[:, 1]))
        assert set(np.round(drawn.y, 6)) == set(np.round(near[:, 2], 6))
        assert_allclose(patch(cut)[:, 0], at, atol=1e-9)


def test_points_hidden_by_their_sigma_are_not_in_the_profile(cut, qtbot):
    before = len(cut.surface.cut.chart._curves["points"].x)
    cut.presenter.clip(0.02)
    settle(cut, qtbot)
    assert len(cut.surface.cut.chart._curves["points"].x) < before


def test_the_ring_in_3d_moves_the_plane_up_to_where_points_are(cut, qtbot):
    before = cut.presenter.cut.plane.at_mm
    cut.surface.scene.handle_pulled.emit(4.0)
    settle(cut, qtbot)
    assert patch(cut)[0, 0] == pytest.approx(before + 4)
    cut.surface.scene.handle_pulled.emit(1e4)
    settle(cut, qtbot)
    coordinates = cut.surface.scene.frame.coordinates(cut.presenter.scan.view.points)
    assert patch(cut)[0, 0] == pytest.approx(coordinates[:, 0].max())


def test_square_to_the_other_axis_it_runs_along_the_first(cut, qtbot):
    cut.surface.cut.axis.setCurrentIndex(1)
    settle(cut, qtbot)
    assert np.ptp(patch(cut)[:, 1]) < 1e-9 and np.ptp(patch(cut)[:, 0]) > 10


def test_in_another_frame_it_stands_square_to_that(cut, qtbot):
    cut.presenter.bench.settings.part_frame = False
    settle(cut, qtbot)
    assert np.ptp(patch(cut)[:, 0]) < 1e-9
    assert cut.surface.cut.chart._names[2] == "−z"


def test_kept_it_is_a_section_of_the_plan_and_one_undo_takes_it_back(cut, qtbot):
    cut.surface.cut.at.setValue(5.0)
    press(cut, qtbot, cut.surface.cut.keep)
    (spec,) = cut.presenter.features.plan.features
    assert spec.kind == "section" and cut.presenter.features.chosen == spec.name
    place, normal = np.array(spec.section.point_mm), np.array(spec.section.normal)
    drawn = cut.surface.scene._scene.items[Patches, CUT].corners[0]
    assert_allclose((drawn - place) @ normal, 0, atol=2e-3)
    cut.presenter.features.plan.ordered()
    cut.presenter.model.undo_stack.undo()
    assert cut.presenter.features.plan.features == ()


def test_without_the_plans_part_coordinates_it_cannot_be_kept_and_says_why(cut, qtbot):
    base = FeatureSpec("base", "plane"), FeatureSpec("side", "plane", (Auto(2),))
    cut.presenter.features.put_plan(InspectionPlan(base, PartFrame("base", "side")), "a frame")
    settle(cut, qtbot)
    keep = cut.surface.cut.keep
    assert not keep.isEnabled() and "Measure the features first" in keep.toolTip()


def test_another_scan_has_no_plane_yet(cut, qtbot):
    cut.presenter.scan.forget()
    settle(cut, qtbot)
    assert cut.surface.cut.isHidden() and not cut.surface.cutting.isEnabled()
    cut.presenter.entered()
    qtbot.waitUntil(lambda: cut.presenter.scan.view is not None)
    settle(cut, qtbot)
    assert cut.surface.cut.isHidden() and cut.surface.cutting.isEnabled()


def hide(cut, qtbot, place):
    cut.surface.cut.side.setCurrentIndex(place)
    cut.surface.cut.side.activated.emit(place)
    settle(cut, qtbot)


@pytest.mark.parametrize(("place", "side"), [(1, 1), (2, -1)])
def test_the_side_that_is_hidden_is_that_of_larger_or_smaller_coordinates_and_moves_along(cut, qtbot, place, side):
    hide(cut, qtbot, place)
    points = cut.presenter.scan.view.points
    for at in (-10.0, 12.5):
        cut.surface.cut.at.setValue(at)
        settle(cut, qtbot)
        beyond = side * (cut.surface.scene.frame.coordinates(points)[:, 0] - at) > 0
        assert beyond.any()
        assert np.array_equal(cut.surface.scene._scene.hidden.hides(points), beyond)
        assert np.array_equal(np.isnan(cut.surface.scene._points_seen()[:, 0]), beyond), "what is hidden is not clicked"
        shown, total = grouped(int(np.count_nonzero(~beyond))), grouped(len(points))
        assert cut.surface.line.text().startswith(f"{shown} of {total} points"), "what is hidden is not counted"


def test_faces_and_mesh_are_counted_without_what_the_cut_hides(cut, qtbot):
    hide(cut, qtbot, 1)
    view, surface = cut.presenter.scan.view, cut.surface
    surface.choices.choose_colour("faces")
    hidden = surface.scene._scene.hidden
    upper, lower = (np.count_nonzero(~hidden.hides(view.points[used])) for used in view.used_up_to(len(view)))
    assert 0 < upper < len(view.gauge.upper.indices)
    settle(cut, qtbot)
    assert f"{upper} used on the upper face" in surface.line.text() and f"{lower} on the lower" in surface.line.text()
    press(cut, qtbot, surface.choices.shapes["mesh"])
    for at, seen in ((-1.0, 0), (5.0, 2), (20.0, 2)):
        cut.presenter.cut.move_to(at)
        settle(cut, qtbot)
        assert surface.line.text().startswith(f"{seen} of 2 triangles"), "a triangle the plane cuts is seen"


def test_hiding_a_side_leaves_the_profile_and_taking_the_plane_away_shows_all_again(cut, qtbot):
    before = cut.surface.cut.chart._curves["points"].x
    hide(cut, qtbot, 1)
    assert_allclose(cut.surface.cut.chart._curves["points"].x, before)
    press(cut, qtbot, button(cut))
    assert cut.surface.scene._scene.hidden is None
    press(cut, qtbot, button(cut))
    hide(cut, qtbot, 0)
    assert cut.surface.scene._scene.hidden is None


def test_square_to_z_it_shows_an_outline_that_no_section_measures_and_says_so(cut, qtbot):
    cut.surface.cut.axis.setCurrentIndex(2)
    settle(cut, qtbot)
    assert np.ptp(patch(cut)[:, 2]) < 1e-9 and np.ptp(patch(cut)[:, 0]) > 10 and np.ptp(patch(cut)[:, 1]) > 10
    assert (cut.surface.cut.chart._names[0], cut.surface.cut.chart._names[2]) == ("x", "y")
    keep = cut.surface.cut.keep
    assert not keep.isEnabled() and "stand upright" in keep.toolTip()


def test_turned_it_stands_at_that_angle_through_the_same_middle_and_can_be_kept(cut, qtbot):
    middle = patch(cut).mean(axis=0)
    cut.surface.cut.turned.setValue(30.0)
    settle(cut, qtbot)
    normal = cut.surface.scene.frame.axes @ cut.presenter.cut.plane.normal
    assert_allclose(normal, [np.cos(np.pi / 6), 0.5, 0.0], atol=1e-9)
    assert_allclose((patch(cut) - middle) @ normal, 0, atol=1e-9)
    names = cut.surface.cut.chart._names
    assert (names[0], names[2]) == ("y′", "z′")
    assert cut.surface.cut.side.itemText(1) == "hide larger x′"
    drawn = cut.surface.scene._scene.items[Patches, CUT].corners[0]
    press(cut, qtbot, cut.surface.cut.keep)
    (spec,) = cut.presenter.features.plan.features
    place, kept = np.array(spec.section.point_mm), np.array(spec.section.normal)
    assert_allclose((drawn - place) @ kept, 0, atol=2e-3)


def test_tilted_it_hides_what_lies_beyond_and_is_to_look_at_only(cut, qtbot):
    cut.surface.cut.turned.setValue(20.0)
    cut.surface.cut.tilted.setValue(45.0)
    hide(cut, qtbot, 1)
    plane, points = cut.presenter.cut.plane, cut.presenter.scan.view.points
    normal = cut.surface.scene.frame.axes @ plane.normal
    assert abs(normal[2]) == pytest.approx(np.sqrt(0.5)), "half way down"
    beyond = (points - plane.corners(cut.presenter.cut._coordinates)[0]) @ plane.normal > 0
    assert beyond.any() and not beyond.all()
    assert np.array_equal(cut.surface.scene._scene.hidden.hides(points), beyond)
    keep = cut.surface.cut.keep
    assert not keep.isEnabled() and "stand upright" in keep.toolTip()


def test_square_to_another_axis_it_stands_straight_again(cut, qtbot):
    cut.surface.cut.turned.setValue(20.0)
    cut.surface.cut.tilted.setValue(-10.0)
    cut.surface.cut.axis.setCurrentIndex(1)
    settle(cut, qtbot)
    assert np.ptp(patch(cut)[:, 1]) < 1e-9
    assert (cut.surface.cut.turned.value(), cut.surface.cut.tilted.value()) == (0.0, 0.0)


def test_a_typed_angle_moves_the_plane_no_further_than_points_are(cut, qtbot):
    cut.presenter.cut.move_to(1e4)
    cut.surface.cut.turned.setValue(90.0)
    settle(cut, qtbot)
    low, high = cut.presenter.cut.reach
    assert low <= cut.presenter.cut.plane.at_mm <= high
