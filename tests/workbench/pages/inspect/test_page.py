"""The inspect page, clicked."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QModelIndex, QPoint, Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import (
    QAbstractButton,
    QApplication,
    QComboBox,
    QDoubleSpinBox,
    QSlider,
    QStyle,
    QStyleOptionComboBox,
)

from core.errors import InputError
from core.files.project.keys import finished
from core.files.project.view_file import read_view, write_view
from core.inspect.results import PairCandidate
from core.inspect.shown.seen_from import SeenFrom
from core.inspect.shown.shown_scan import NextPair
from core.messages import plain
from tests.workbench.cells import shown as text_in
from tests.workbench.pages import inspect_cases as cases
from tests.workbench.pages.places import moved, places
from workbench.pages.inspect.presenter import InspectPresenter
from workbench.pages.inspect.stage import Stage
from workbench.views.scene.contents import Marks
from workbench.work import jobs

LEFT = Qt.MouseButton.LeftButton
OUTLINE = np.array([[10.0, 10.0], [30.0, 10.0], [20.0, 30.0]])


@pytest.fixture
def measuring(measuring):
    measuring.held = {jobs.MEASURE_GAUGE}
    return measuring


@pytest.fixture
def quick(quick):
    quick.answers[jobs.OUTLINE_SELECTED] = lambda folder, numbers, face: OUTLINE
    return quick


@pytest.fixture
def page(hand_bench, measuring, quick, show_page, tmp_path):
    """The page of an open project without a scan."""
    made = show_page(InspectPresenter(hand_bench), 1100, 700)
    hand_bench.model.create(tmp_path / "project", cases.project(nominal_mm=50.0, tolerance_mm=0.2))
    made.presenter.entered()
    return made


def scan(page, qtbot, *, inspected=True):
    p = page.presenter
    for step, done in cases.results(p.project, inspected=inspected).items():
        p.model.record(step, done)
    qtbot.waitUntil(lambda: p.scan.view is not None and not p.scan.stale)


@pytest.fixture
def shown(page, qtbot):
    """The page with a scan and its thickness."""
    scan(page, qtbot)
    return page


@pytest.fixture
def unmeasured(page, quick, qtbot):
    """The page with a scan without a thickness."""
    quick.answers[jobs.INSPECTION_VIEW] = lambda folder, project: cases.view()
    scan(page, qtbot, inspected=False)
    return page


def undo(page):
    page.presenter.model.undo_stack.undo()


def cloud(page):
    return page.surface.scene._scene.cloud


def press(qtbot, button):
    assert button.isEnabled(), button.toolTip()
    qtbot.mouseClick(button, LEFT)


# ---- what is seen when


def test_an_empty_page_says_what_to_do_next(page, qtbot):
    assert page.card.title.text() == "Nothing to inspect yet"
    assert page.surface.empty.message.startswith("There is no scan yet. Scan the part")
    wanted = []
    page.presenter.go_to.connect(wanted.append)
    press(qtbot, page.surface.empty.button)
    assert wanted == ["scan"] and page.surface.scene.isHidden()
    assert page.result_fold.isHidden()
    page.tabs.setCurrentWidget(page.picture)
    assert "Scan the part" in page.picture.image.empty_state.message
    press(qtbot, page.picture.image.empty_state.button)
    assert wanted == ["scan", "scan"]
    page.tabs.setCurrentWidget(page.series)
    assert "Each scan counts once" in page.series.words.text()
    assert "how well the measurement repeats" in page.series.chart.empty_state.message


def test_greyed_buttons_say_why(page):
    for tab in (page.surface, page.picture, page.series):
        page.tabs.setCurrentWidget(tab)
        buttons = [
            button for part in (page.card, page.faces, page.picks, tab) for button in part.findChildren(QAbstractButton)
        ]
        greyed = [button for button in buttons if button.isVisible() and not button.isEnabled()]
        assert all(button.toolTip() for button in greyed), [button.text() for button in greyed if not button.toolTip()]
    assert page.card.buttons["measure"].toolTip() == "Scan the part first."


def stands_as(button, why_not):
    """Whether a button, or a tool of the 3D view, is on, or grey with this reason."""
    return button.isEnabled() if not why_not else not button.isEnabled() and button.toolTip() == why_not


def stand_as_the_facts_say(page):
    """The buttons of the surface, the faces and the picks."""
    page.refreshing.at_once()
    surface, faces = page.presenter.scan.buttons, page.presenter.faces.buttons
    choices = page.surface.choices.shapes
    for button, why_not in (
        (choices["points"], surface.use), (choices["mesh"], surface.mesh), (choices["both"], surface.mesh),
        *((tool, surface.use) for tool in page.surface.clicks.values()),
        *((tool, surface.use) for tool in page.picks.tools.values()),
        *((tool, faces.draw) for tool in page.faces.tools.values()),
        (page.faces.own, faces.take_found), (page.faces.automatic, faces.automatic),
        (page.faces.exchange, faces.exchange),
    ):  # fmt: skip
        assert stands_as(button, why_not), (button.text(), button.toolTip(), why_not)
    return surface, faces


def test_the_buttons_of_surface_and_faces_follow_the_page_from_state_to_state(page, quick, qtbot):
    assert stand_as_the_facts_say(page)[0].use == "Scan the part first."
    quick.held = {jobs.INSPECTION_VIEW}
    page.presenter.model.record("scan", cases.results(page.presenter.project)["scan"])
    assert stand_as_the_facts_say(page)[0].use == "The scan is being read."
    quick.fail(InputError("broken"))
    assert stand_as_the_facts_say(page)[0].use == "The scan cannot be read."
    quick.held = set()
    quick.answers[jobs.INSPECTION_VIEW] = lambda folder, project: cases.view(mesh=False)
    page.presenter.scan.forget()
    page.presenter.entered()
    qtbot.waitUntil(lambda: page.presenter.scan.view is not None)
    surface, faces = stand_as_the_facts_say(page)
    assert surface[:2] == ("", "This scan has no mesh.") and faces.take_found.startswith("Measure the thickness first")
    page.presenter.faces.set_region("lower", OUTLINE)
    _, faces = stand_as_the_facts_say(page)
    assert faces.exchange.startswith("Draw the upper face too") and not faces.automatic
    page.presenter.faces.set_region("upper", OUTLINE)
    _, faces = stand_as_the_facts_say(page)
    assert faces.exchange == faces.automatic == "" and "already" in faces.take_found


@pytest.mark.parametrize("half", ["", "upper"])
@pytest.mark.parametrize("own", [False, True])
@pytest.mark.parametrize("outlines", [False, True])
def test_a_button_of_the_faces_that_is_on_changes_the_regions(page, quick, qtbot, outlines, own, half):
    quick.answers[jobs.INSPECTION_VIEW] = lambda folder, project: cases.view(cases.gauge() if outlines else None)
    scan(page, qtbot)
    faces = page.presenter.faces
    for face in ("upper", "lower") if own else (half,) if half else ():
        faces.set_region(face, OUTLINE + (5 if face == "lower" else 0))

    def regions():
        return [None if (one := faces.region(face)) is None else one.tolist() for face in ("upper", "lower")]

    for button in (page.faces.own, page.faces.automatic, page.faces.exchange):
        page.refreshing.at_once()
        before, could = regions(), button.isEnabled()
        button.click()
        assert (regions() != before) == could, button.toolTip()


def test_what_is_picked_is_chosen_before_it_is_removed(shown, qtbot):
    p, panel = shown.presenter, shown.picks
    p.picks.start("point")
    for point in (3, 5):
        p.picks.pick(point)
    shown.refreshing.at_once()
    assert panel.remove.isEnabled() and panel.clear.isEnabled()
    panel.list.setCurrentIndex(QModelIndex())
    assert stands_as(panel.remove, "Choose a point or a distance in the list first.") and panel.clear.isEnabled()
    press(qtbot, panel.clear)
    shown.refreshing.at_once()
    assert stands_as(panel.remove, "Nothing is picked yet.") and stands_as(panel.clear, "Nothing is picked yet.")


def test_everything_has_a_name_for_those_who_do_not_see_it(shown):
    for kind in (QAbstractButton, QComboBox, QDoubleSpinBox, QSlider):
        for part in (shown.surface, shown.picture, shown.series, shown.card, shown.faces, shown.picks):
            for widget in part.findChildren(kind):
                named = (
                    widget.accessibleName()
                    or (isinstance(widget, QAbstractButton) and widget.text())
                    or widget.toolTip()
                )
                assert named or not widget.isVisibleTo(shown), (part, widget)


def test_a_finished_scan_shows_its_thickness_and_verdict(shown):
    assert shown.card.title.text() == "50.012\u00a0mm ±\u00a00.024\u00a0mm (k\u00a0=\u00a02)"
    assert shown.result.verdict.text == "Conforming"
    rows = shown.result.rows
    assert rows.text_of("Thickness (k = 2)") == "50.012 ± 0.024 mm"
    assert rows.text_of("Deviation") == "+0.012 mm" and rows.text_of("Angle of the faces") == "0.029°"
    assert rows.text_of("Upper face, flatness") == "0.031 mm" and rows.text_of("Lower face, flatness") == "0.042 mm"
    assert rows.text_of("Upper face, points") == "300"
    assert shown.result.rule.text() == "Rule: distance of two parallel planes."
    assert shown.result.budget.text_of("Camera calibration") == "0.0020 mm"
    assert shown.result.budget.text_of("Combined standard uncertainty u") == "0.0120 mm"
    assert shown.result.notes.isHidden()


def test_notes_of_the_measurement_are_shown(page, quick, qtbot):
    told = cases.gauge(notes=(plain("The stated uncertainty does not hold that of the fan."),))
    quick.answers[jobs.INSPECTION_VIEW] = lambda folder, project: cases.view(told)
    scan(page, qtbot)
    assert page.result.notes.text() == "The stated uncertainty does not hold that of the fan."


def test_a_scan_without_a_thickness_offers_to_measure_it(unmeasured):
    assert unmeasured.card.title.text() == "No thickness yet"
    measure = unmeasured.card.buttons["measure"]
    assert measure.property("primary") and measure.text() == "Measure" and "Ctrl+R" in measure.toolTip()
    assert unmeasured.result_fold.isHidden()
    assert unmeasured.surface.choices.colours.itemText(1) == "depth"


# ---- measuring


def test_measuring_by_the_button_shows_the_points_used(unmeasured, measuring, quick, qtbot):
    quick.answers[jobs.INSPECTION_VIEW] = lambda folder, project: cases.view(cases.gauge())
    unmeasured.refreshing.at_once()
    press(qtbot, unmeasured.card.buttons["measure"])
    unmeasured.refreshing.at_once()
    assert unmeasured.card.title.text() == "Measuring the thickness …"
    assert not unmeasured.card.buttons["measure"].isEnabled()
    measuring.finish(cases.gauge())
    unmeasured.refreshing.at_once()
    qtbot.waitUntil(lambda: unmeasured.presenter.stage is Stage.MEASURED)
    unmeasured.refreshing.at_once()
    assert unmeasured.surface.colour == "faces"
    assert "300 used on the upper face" in unmeasured.surface.line.text()
    assert unmeasured.card.buttons["measure"].text() == "Measure again"


def test_what_changed_since_is_said_and_the_verdict_is_taken_back(shown, qtbot):
    form = shown.faces.form
    form.edited.emit("tolerance_mm", 0.01)
    shown.refreshing.at_once()
    assert "Out of date: changed since: nominal thickness" in shown.card.words.text()
    assert shown.result.verdict.text == "No verdict"
    assert shown.card.buttons["measure"].property("primary")
    undo(shown)
    shown.refreshing.at_once()
    assert shown.result.verdict.text == "Conforming"


def test_a_failed_measurement_keeps_no_old_verdict_up(shown, measuring, qtbot):
    shown.faces.form.edited.emit("tolerance_mm", 0.01)
    shown.refreshing.at_once()
    press(qtbot, shown.card.buttons["measure"])
    measuring.fail(InputError("among 1 plane faces no two are parallel", where="point cloud"))
    shown.refreshing.at_once()
    assert shown.card.title.text() == "No thickness was measured"
    assert "no two are parallel" in shown.card.words.text()
    assert shown.result.verdict.text == "No verdict"


def test_half_a_pair_of_numbers_is_complained_about(shown):
    shown.faces.form.edited.emit("tolerance_mm", None)
    shown.refreshing.at_once()
    assert shown.faces.form.help_of("tolerance_mm").startswith("Enter the tolerance too")
    shown.faces.form.edited.emit("tolerance_mm", 0.2)
    shown.refreshing.at_once()
    assert shown.faces.form.help_of("tolerance_mm").startswith("Largest permitted deviation")


def test_the_first_thickness_and_a_new_one_push_nothing(unmeasured, measuring, quick, qtbot):
    quick.answers[jobs.INSPECTION_VIEW] = lambda folder, project: cases.view(cases.gauge())
    before = places(unmeasured, qtbot)
    press(qtbot, unmeasured.card.buttons["measure"])
    assert not moved(before, places(unmeasured, qtbot)), "it is being measured"
    measuring.finish(cases.gauge(notes=(plain("What is stated does not hold that of the fan. " * 9),)))
    qtbot.waitUntil(lambda: unmeasured.presenter.stage is Stage.MEASURED)
    assert not moved(before, places(unmeasured, qtbot))
    for key, value in (("nominal_mm", 50.5), ("tolerance_mm", 0.01)):
        unmeasured.faces.form.edited.emit(key, value)
    assert unmeasured.presenter.stage is Stage.OUTDATED
    assert not moved(before, places(unmeasured, qtbot)), "what is said to be out of date has no room of its own"


@pytest.mark.parametrize("side", [300, 330, 350])
def test_a_thickness_that_takes_two_lines_on_a_narrow_card_pushes_nothing(unmeasured, quick, measuring, qtbot, side):
    unmeasured.card.title.setStyleSheet("font-size: 18px; font-weight: 600")
    unmeasured.splitter.setSizes([unmeasured.width() - side, side])
    before = places(unmeasured, qtbot)
    quick.answers[jobs.INSPECTION_VIEW] = lambda folder, project: cases.view(cases.gauge())
    press(qtbot, unmeasured.card.buttons["measure"])
    measuring.finish(cases.gauge())
    qtbot.waitUntil(lambda: unmeasured.presenter.stage is Stage.MEASURED)
    assert not moved(before, places(unmeasured, qtbot))
    unmeasured.faces.form.edited.emit("nominal_mm", 50.5)
    assert not moved(before, places(unmeasured, qtbot)), "its sign is taken off"


def test_value_and_verdict_are_seen_without_scrolling(shown, qtbot):
    places(shown, qtbot)
    card = shown.card
    for label in (card.title, card.words):
        assert not label.visibleRegion().isEmpty()
    assert "50.012" in card.title.text() and card.words.text().startswith("Conforming")
    assert shown.side.indexOf(shown.result_fold) == shown.side.count() - 2, "it is last, before the room that is left"


# ---- the 3D view


def test_every_colour_shows_its_bar_with_a_unit(shown):
    bars = {}
    for name in ("faces", "height", "sigma", "deviation", "frame", "plain"):
        shown.surface.choices.choose_colour(name)
        shown.surface._draw()
        bars[name] = cloud(shown).colouring.title
    assert bars["height"] == "height over the lower face [mm]"
    assert bars["sigma"] == "σ of the depth [mm]"
    assert bars["deviation"] == "deviation from the face [mm]"
    assert bars["frame"] == "frame number" and bars["faces"] == bars["plain"] == ""


def test_without_faces_nothing_can_be_coloured_by_them(unmeasured):
    model = unmeasured.surface.choices.colours.model()
    for name in ("faces", "deviation"):
        assert not model.item(unmeasured.surface.choices.colours.findData(name)).isEnabled()


def test_points_mesh_or_both(shown, qtbot):
    scene = shown.surface.scene._scene
    for name, points, mesh in (("mesh", False, True), ("both", True, True), ("points", True, False)):
        press(qtbot, shown.surface.choices.shapes[name])
        shown.surface._draw()
        assert (scene.cloud_shown, scene.mesh_shown and scene.mesh is not None) == (points, mesh), name
    press(qtbot, shown.surface.choices.shapes["mesh"])
    shown.surface._draw()
    assert shown.surface.line.text() == "2 of 2 triangles shown"


def test_a_scan_without_a_mesh_shows_points_only(page, quick, qtbot):
    quick.answers[jobs.INSPECTION_VIEW] = lambda folder, project: cases.view(cases.gauge(), mesh=False)
    press_later = page.surface.choices.shapes["mesh"]
    scan(page, qtbot)
    assert not press_later.isEnabled() and page.surface.shape == "points"


def test_the_sigma_limit_says_how_many_points_are_left(shown, qtbot):
    shown.refreshing.at_once()
    assert shown.surface.line.text() == "600 of 600 points shown"
    shown.surface.choices.limit.setValue(0.03)
    left = shown.presenter.points_shown()
    shown.refreshing.at_once()
    assert shown.surface.line.text() == f"{left} of 600 points shown" and 0 < left < 600
    qtbot.waitUntil(lambda: cloud(shown).given == left)
    shown.surface.choices.slider.setValue(shown.surface.choices.slider.maximum())
    shown.refreshing.at_once()
    assert shown.surface.line.text() == "600 of 600 points shown"
    qtbot.waitUntil(lambda: cloud(shown).given == 600)


def test_points_used_stand_out_on_a_mesh(shown, qtbot):
    press(qtbot, shown.surface.choices.shapes["mesh"])
    shown.surface.choices.choose_colour("faces")
    shown.surface._draw()
    marked = {name for _, name in shown.surface.scene._scene.items}
    assert {"used upper", "used lower"} <= marked
    shown.surface.choices.choose_colour("height")
    shown.surface._draw()
    assert not {"used upper"} & {name for _, name in shown.surface.scene._scene.items}


def test_picked_points_stand_in_the_list_and_in_the_view(shown, qtbot):
    shown.refreshing.at_once()
    assert shown.picks.list.isHidden() and shown.picks.clear.isHidden(), "nothing is picked yet"
    press(qtbot, shown.picks.tools["point"])
    shown.refreshing.at_once()
    assert shown.surface.hint.text().startswith("Click points of the surface")
    shown.surface.scene.point_picked.emit(7, shown.presenter.scan.view.points[7])
    shown.refreshing.at_once()
    text = text_in(shown.picks.list, 0)
    assert not shown.picks.list.isHidden()
    assert text.startswith("P1   x ") and " mm\nσ = 0.0" in text and "px" in text
    assert "P1" in {name for _, name in shown.surface.scene._scene.items}
    shown.surface.scene.stop_drawing()
    shown.refreshing.at_once()
    assert shown.presenter.picks.mode == "" and not shown.picks.tools["point"].isChecked()
    press(qtbot, shown.picks.remove)
    shown.refreshing.at_once()
    assert shown.picks.list.model().rowCount() == 0
    assert "P1" not in {name for _, name in shown.surface.scene._scene.items}


def test_a_click_on_the_cloud_picks_the_point_under_it(shown, qtbot):
    shown.refreshing.at_once()
    press(qtbot, shown.picks.tools["point"])
    scene = shown.surface.scene
    spots = scene.screen_positions(shown.presenter.scan.view.points)
    x, y = spots[np.argmin(np.hypot(*(spots - spots.mean(axis=0)).T))]
    shown.refreshing.at_once()
    qtbot.mouseClick(scene._canvas, LEFT, pos=QPoint(round(x), round(y)))
    shown.refreshing.at_once()
    qtbot.waitUntil(lambda: shown.picks.list.model().rowCount() == 1)


def test_a_distance_is_drawn_between_its_ends(shown, qtbot):
    shown.refreshing.at_once()
    press(qtbot, shown.picks.tools["distance"])
    shown.refreshing.at_once()
    for point in (0, 1):
        shown.surface.scene.point_picked.emit(point, shown.presenter.scan.view.points[point])
    shown.refreshing.at_once()
    assert ", u = 0.0" in text_in(shown.picks.list, 0)
    assert "D1" in {name for _, name in shown.surface.scene._scene.items}
    press(qtbot, shown.picks.clear)
    shown.refreshing.at_once()
    assert shown.picks.list.model().rowCount() == 0


# ---- regions


def test_a_lasso_in_3d_becomes_a_region(shown, qtbot):
    shown.refreshing.at_once()
    press(qtbot, shown.faces.tools["upper", "lasso"])
    overlay = shown.surface.scene._canvas
    size = overlay.width(), overlay.height()
    corners = [QPoint(2, 2), QPoint(size[0] - 2, 2), QPoint(size[0] - 2, size[1] - 2), QPoint(2, size[1] - 2)]
    shown.refreshing.at_once()
    qtbot.mousePress(overlay, LEFT, pos=corners[0])
    shown.refreshing.at_once()
    for corner in corners[1:]:
        qtbot.mouseMove(overlay, corner)
    shown.refreshing.at_once()
    qtbot.mouseRelease(overlay, LEFT, pos=corners[-1])
    shown.refreshing.at_once()
    qtbot.waitUntil(lambda: shown.presenter.faces.own)
    shown.refreshing.at_once()
    assert np.array_equal(shown.presenter.faces.region("upper"), OUTLINE)
    assert "own region, 3 corners" in shown.faces.states["upper"].text()
    undo(shown)
    shown.refreshing.at_once()
    assert "found automatically" in shown.faces.states["upper"].text()


def drawn(page) -> bool:
    """Whether points that were drawn round are marked in 3D."""
    page.refreshing.at_once()
    return (Marks, "drawn region") in page.surface.scene._scene.items


def draw_round(page, name, *, some=100):
    """As a lasso round the first points of the view."""
    p = page.presenter
    chosen = np.zeros(p.points_shown(), bool)
    chosen[:some] = True
    p.outline(name, chosen)


def test_what_was_drawn_round_in_3d_stays_marked_until_it_is_measured_or_dropped(shown, measuring, qtbot):
    p = shown.presenter
    draw_round(shown, "upper")
    assert drawn(shown), "at once"
    qtbot.waitUntil(lambda: p.faces.own)
    assert drawn(shown), "as long as the thickness is of other faces"
    undo(shown)
    assert not drawn(shown), "dropped"
    draw_round(shown, "upper")
    qtbot.waitUntil(lambda: p.faces.own)
    p.model.record("gauge", finished("gauge", p.project, p.model.results))
    qtbot.waitUntil(lambda: not p.scan.stale)
    assert not drawn(shown), "measured"


def test_what_was_drawn_round_for_a_feature_stays_marked_while_that_is_chosen(shown, measuring, qtbot):
    measuring.held = {jobs.MEASURE_GAUGE, jobs.MEASURE_FEATURES}
    p = shown.presenter
    p.feature.add("plane")
    draw_round(shown, p.feature.region_name(0))
    qtbot.waitUntil(lambda: p.outlining == "")
    assert drawn(shown)
    p.features.choose("")
    assert not drawn(shown)
    p.features.choose("plane 1")
    assert drawn(shown)
    p.features.remove("plane 1")
    assert not drawn(shown)


def test_a_polygon_in_the_picture_becomes_a_region(shown, qtbot):
    shown.tabs.setCurrentWidget(shown.picture)
    press(qtbot, shown.faces.tools["lower", "polygon"])
    image = shown.picture.image
    for u, v in ((10, 10), (50, 10), (30, 40)):
        qtbot.mouseClick(image.canvas, LEFT, pos=image.to_screen(u, v))
        qtbot.wait(QGuiApplication.styleHints().mouseDoubleClickInterval() + 10)
    qtbot.keyClick(image, Qt.Key.Key_Return)
    region = shown.presenter.faces.region("lower")
    assert region is not None and region == pytest.approx(np.array([[10, 10], [50, 10], [30, 40]]), abs=0.5)


def test_drawing_by_keys_alone(shown, qtbot):
    shown.tabs.setCurrentWidget(shown.picture)
    shown.faces.tools["upper", "polygon"].click()
    image = shown.picture.image
    for key in (Qt.Key.Key_Right, Qt.Key.Key_Down, Qt.Key.Key_Left):
        for _ in range(3):
            qtbot.keyClick(image, key, Qt.KeyboardModifier.ShiftModifier)
        qtbot.keyClick(image, Qt.Key.Key_Space)
    qtbot.keyClick(image, Qt.Key.Key_Return)
    assert shown.presenter.faces.own


def test_regions_are_dragged_in_the_picture_and_undone(shown, qtbot):
    shown.tabs.setCurrentWidget(shown.picture)
    shown.refreshing.at_once()
    press(qtbot, shown.faces.own)
    shown.refreshing.at_once()
    assert "Drag a corner" in shown.picture.line.text()
    moved = cases.UPPER_OUTLINE + [[2, 0], [0, 0], [0, 0], [0, 0]]
    shown.picture.image.polygon_edited.emit("upper", moved)
    shown.refreshing.at_once()
    assert np.array_equal(shown.presenter.faces.region("upper"), moved)
    undo(shown)
    shown.refreshing.at_once()
    assert np.array_equal(shown.picture.image._layers["upper"].uv, cases.UPPER_OUTLINE)


def test_the_picture_shows_the_faces_and_the_points_used(shown):
    shown.tabs.setCurrentWidget(shown.picture)
    shown.refreshing.at_once()
    assert shown.picture.image.has_picture
    assert set(shown.picture.image.layer_names()) == {"upper", "lower", "used upper", "used lower"}
    assert "upper face, found" in shown.picture.image.legend_titles
    shown.presenter.faces.take_found()
    shown.refreshing.at_once()
    assert "upper face, own region" in shown.picture.image.legend_titles


def test_a_waiting_region_asks_for_the_other_one(unmeasured):
    unmeasured.tabs.setCurrentWidget(unmeasured.picture)
    unmeasured.picture.image.polygon_drawn.emit("upper", OUTLINE)
    unmeasured.refreshing.at_once()
    assert unmeasured.picture.line.text().startswith("Draw the lower face too")
    assert unmeasured.faces.words.text().startswith("Draw the lower face too")
    assert unmeasured.card.buttons["measure"].toolTip().startswith("Draw the lower face too")


def test_drawing_from_the_repeats_goes_to_the_picture(shown, qtbot):
    shown.tabs.setCurrentWidget(shown.series)
    press(qtbot, shown.faces.tools["upper", "polygon"])
    assert shown.tabs.currentWidget() is shown.picture


# ---- repeats


def test_a_repeat_is_added_shown_and_refused_twice(shown, qtbot):
    shown.refreshing.at_once()
    press(qtbot, shown.card.buttons["repeat"])
    shown.refreshing.at_once()
    qtbot.waitUntil(lambda: shown.tabs.currentWidget() is shown.series)
    shown.refreshing.at_once()
    assert shown.tabs.tabText(2) == "Repeats (1)"
    table = shown.series.table
    shown.refreshing.at_once()
    assert table.rows()[0][:4] == ("scan-1", "50.012", "±\u00a00.024", "cal-1")
    assert shown.series.rows.text_of("Mean") == "50.012 mm"
    assert shown.series.rows.text_of("s (n − 1)") == "needs two repeats"
    again = shown.card.buttons["repeat"]
    shown.refreshing.at_once()
    assert not again.isEnabled() and again.toolTip().startswith("This scan is among the repeats already.")
    assert shown.series.add.toolTip() == again.toolTip()
    undo(shown)
    shown.refreshing.at_once()
    assert shown.series.table.rows() == () and again.isEnabled()


def test_repeats_are_removed_and_copied(shown, qtbot):
    repeats = tuple(cases.repeat(number, 50 + 0.01 * number) for number in (2, 3, 4))
    shown.presenter.model.edit("repeats", replace(shown.presenter.project, repeats=repeats))
    shown.tabs.setCurrentWidget(shown.series)
    assert not shown.series.remove.isEnabled() or shown.series.table.current_row() >= 0
    shown.series.table.set_current_row(1)
    press(qtbot, shown.series.remove)
    assert [repeat.scan for repeat in shown.presenter.project.repeats] == ["recordings/scan-2", "recordings/scan-4"]
    press(qtbot, shown.series.copy)
    assert QGuiApplication.clipboard().text().splitlines()[2].startswith("recordings/scan-4\t50.040000")
    undo(shown)
    assert len(shown.series.table.rows()) == 3
    assert shown.series.rows.text_of("Largest error") == "0.040 mm"


def test_the_buttons_of_the_repeats_follow_the_page_from_state_to_state(page, quick, qtbot):
    p, series = page.presenter, page.series
    page.tabs.setCurrentWidget(series)

    def reason():
        page.refreshing.at_once()
        can = p.repeats.buttons(chosen=series.table.current_row() >= 0)
        assert stands_as(series.add, can.add) and stands_as(page.card.buttons["repeat"], can.add)
        assert stands_as(series.remove, can.remove) and stands_as(series.copy, can.copy)
        return can.add

    assert reason() == "Scan the part first."
    quick.held = {jobs.INSPECTION_VIEW}
    for step, done in cases.results(p.project).items():
        p.model.record(step, done)
    assert reason() == "The scan is being read.", "its thickness is measured"
    qtbot.waitUntil(lambda: len(quick.waiting) == 2)
    for _ in range(2):
        quick.finish(cases.view(cases.gauge()))
    assert reason() == "" and series.copy.toolTip() == series.remove.toolTip() == "There are no repeats yet."
    press(qtbot, series.add)
    assert reason().startswith("This scan is among the repeats already.")
    assert series.copy.isEnabled() and stands_as(series.remove, "Choose a repeat in the table first.")
    series.table.set_current_row(0)
    assert series.remove.isEnabled()
    p.model.record("gauge", replace(p.model.results["gauge"], at=p.model.results["gauge"].at.replace(year=2026)))
    assert reason() == "The scan is being read.", "it was measured again; what is shown is the thickness before"


def test_repeats_of_several_calibrations_are_pointed_out(shown):
    repeats = (cases.repeat(2, 50.0), cases.repeat(3, 50.1, calibration="cal-2"))
    shown.presenter.model.edit("repeats", replace(shown.presenter.project, repeats=repeats))
    shown.tabs.setCurrentWidget(shown.series)
    assert shown.series.words.text().startswith("Measured with 2 different calibrations")


def test_the_chart_of_the_repeats_shows_its_axis_in_the_lowest_window(shown, qtbot):
    shown.tabs.setCurrentWidget(shown.series)
    shown.resize(760, 380)
    qtbot.wait(50)
    charts = shown.series.charts
    assert charts.height() >= charts.minimumSizeHint().height()


def test_what_the_part_is_made_of_is_chosen_on_the_page(page, qtbot):
    scan(page, qtbot)
    page.part_fold.expand(animate=False)
    form = page.part.form
    assert isinstance(form.editor("material"), QComboBox)
    form.edited.emit("material", "plastic")
    assert page.presenter.model.project.rig.part.material == "plastic"
    page.refresh()
    assert "Plastic" in form.editor("material").currentText()


def test_no_colour_that_is_chosen_is_cut_where_there_is_room(unmeasured):
    box = unmeasured.surface.choices.colours
    for place in range(box.count()):
        box.setCurrentIndex(place)
        QApplication.processEvents()
        option = QStyleOptionComboBox()
        box.initStyleOption(option)
        field = box.style().subControlRect(
            QStyle.ComplexControl.CC_ComboBox, option, QStyle.SubControl.SC_ComboBoxEditField, box
        )
        assert box.fontMetrics().horizontalAdvance(box.currentText()) <= field.width(), box.currentText()


# ---- several pairs of faces


@pytest.fixture
def several(page, quick, qtbot):
    """The page with a scan of two blocks, of which that of 50 mm was measured and the one of 20 mm was not."""
    corners = tuple(map(tuple, cases.UPPER_OUTLINE)), tuple(map(tuple, cases.LOWER_OUTLINE))
    beside = tuple((u - 12.0, v) for u, v in corners[0])
    candidates = (
        PairCandidate(50.0, (300, 300), (30.0, 22.0), (30.0, 22.0), corners),
        PairCandidate(20.0, (100, 300), (18.0, 22.0), (30.0, 22.0), (beside, corners[1])),
    )
    outline = np.array(beside)
    pair = NextPair(20.0, (outline,), (np.column_stack([outline, np.full(4, 520.0)]),))
    shown = replace(cases.view(cases.gauge(candidates=candidates)), next_pair=pair)
    quick.answers[jobs.INSPECTION_VIEW] = lambda folder, project: shown
    scan(page, qtbot)
    page.refreshing.at_once()
    return page


def drawn_pairs(page):
    """Names of what is drawn of the next best pair in the picture and in 3D."""
    layers = {name for name in page.picture.image.layer_names() if "pair" in name}
    return layers | {"next pair"} & {name for _, name in page.surface.scene._scene.items}


def test_the_next_best_pair_is_drawn_until_one_is_confirmed(several, qtbot):
    several.surface.refresh()
    several.picture.refresh()
    assert drawn_pairs(several) == {"next pair 0", "next pair"}
    first, second = (several.faces.pairs.itemAt(row).widget() for row in range(2))
    assert "50.0 mm" in first.text() and "20.0 mm" in second.text()
    press(qtbot, second)
    several.refreshing.at_once()
    several.surface.refresh()
    several.picture.refresh()
    assert np.array_equal(several.presenter.faces.region("upper"), cases.UPPER_OUTLINE - [12.0, 0.0])
    assert drawn_pairs(several) == set() and several.faces.pairs.count() == 0


def test_the_view_left_in_3d_is_kept_for_the_report_and_is_no_edit(page, qtbot):
    presenter, scene = page.presenter, page.surface.scene
    folder = presenter.model.folder
    scan(page, qtbot)
    qtbot.waitUntil(lambda: scene.state().points > 0)
    presenter.left()
    assert read_view(folder) is None, "nobody turned it"
    scene.orbit(40, 15)
    camera = scene._navigator.camera
    presenter.left()
    kept = read_view(folder)
    assert kept is not None and kept.hidden is None
    np.testing.assert_allclose(kept.axes, camera.axes, atol=1e-6)
    np.testing.assert_allclose(kept.focal, camera.focal, atol=1e-6)
    assert kept.half_height_mm == pytest.approx(camera.half_height, abs=1e-5)
    assert presenter.model.undo_stack.count() == 0


def test_a_view_that_was_given_up_is_not_kept_for_the_report(page, qtbot):
    presenter, scene = page.presenter, page.surface.scene
    folder = presenter.model.folder
    scan(page, qtbot)
    qtbot.waitUntil(lambda: scene.state().points > 0)
    scene.orbit(40, 15)
    presenter.left()
    scene.fit()
    presenter.left()
    kept = read_view(folder)
    assert kept is not None, "turned, and fitted"
    np.testing.assert_allclose(kept.half_height_mm, scene._navigator.camera.half_height, atol=1e-5)
    scene.view("iso")
    presenter.left()
    assert read_view(folder) is None, "it is seen as at first again"
    presenter.left()


def test_a_view_of_before_is_kept_where_nobody_turned_the_surface_since(page, qtbot):
    presenter, scene = page.presenter, page.surface.scene
    write_view(presenter.model.folder, SeenFrom(np.eye(3), np.zeros(3), 50.0, 1.5), presenter.scan.recording)
    presenter.left()
    assert read_view(presenter.model.folder) is not None, "nothing is shown"
    presenter.entered()
    scan(page, qtbot)
    qtbot.waitUntil(lambda: scene.state().points > 0)
    presenter.left()
    assert read_view(presenter.model.folder) is not None


def test_the_view_of_one_project_is_not_kept_in_the_next(page, qtbot, tmp_path):
    presenter, scene = page.presenter, page.surface.scene
    scan(page, qtbot)
    qtbot.waitUntil(lambda: scene.state().points > 0)
    scene.orbit(40, 15)
    presenter.model.opened.disconnect(presenter._opened)
    presenter.model.opened.connect(presenter.left)  # as the window does, before the presenter forgets the last one
    presenter.model.create(tmp_path / "another", cases.project())
    assert presenter.model.folder == tmp_path / "another"
    assert read_view(tmp_path / "another") is None
