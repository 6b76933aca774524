"""Features of the wing on the Inspect page: the plan edited, measured, shown; the panel clicked."""

import math

import numpy as np
import pytest
from PySide6.QtCore import QRect, Qt
from PySide6.QtWidgets import QLabel, QStyleOptionViewItem

from core.inspect.conformity import Limits
from core.inspect.plan.feature_spec import Auto, FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.shown.deviation_map import bounds, mark
from core.inspect.shown.shown_features import ShownClass, ShownDeviations
from core.wings.geometry.kinds import KINDS
from tests.workbench.pages import inspect_cases as cases
from tests.workbench.pages.inspect.test_feature_values import ALL, PLANES, made
from tests.workbench.pages.inspect.test_features import (
    features,
    measured,
    measuring,
    page,
    presenter,
    undo,
    with_drawn,
)
from workbench.pages.inspect.features import values as fields
from workbench.views.colours import DEVIATIONS, to_rgba
from workbench.views.control_frames import FRAMES_ROLE, Frame
from workbench.views.scene.colours import table
from workbench.views.scene.contents import Labels, Marks, Patches
from workbench.work import jobs

__all__ = ["features", "measuring", "page", "presenter"]

NOMINAL = np.array([[[0, 0, 500], [9, 0, 500], [0, 9, 500]]], np.float32)


@pytest.mark.parametrize("kind", [kind.name for kind in KINDS])
def test_every_kind_has_a_form_and_fits_into_a_plan(presenter, page, features, kind, tmp_path):
    assert not fields.why_not(kind, ALL)
    InspectionPlan((*ALL.features, made(kind))).ordered()
    for name in ("plane", "plane", "cylinder"):
        presenter.feature.add(name)
    presenter.feature.add(kind, tmp_path / "part.stl" if kind == "deviation" else None)
    form = page.features.form
    values = presenter.feature.values()
    assert set(form.where.values()) | set(form.what.values()) <= set(values)
    for one in (form.where, form.what):
        assert all(one.help_of(key) for key in one.values())
    spec = presenter.feature.spec
    for key, value in fields.values_of(spec).items():
        if not key.startswith("limits "):
            assert fields.with_value(spec, key, value) == spec, key


def test_a_true_place_has_three_coordinates():
    placed = fields.with_value(made("position"), "at_mm", "10; 20,5; 0")
    assert placed.of == ("hole",) and placed.position.at_mm == (10.0, 20.5, 0.0)
    with pytest.raises(ValueError, match="Write x, y and z in mm"):
        fields.with_value(placed, "at_mm", "10; 20")
    assert "made of another feature" in fields.why_not("position", PLANES)


def test_a_template_is_taken_for_the_next_part_with_one_click_and_taken_back(presenter, features, tmp_path, qtbot):
    nominal = presenter.model.folder / "part.stl"
    nominal.write_bytes(b"")
    presenter.feature.add("plane")
    presenter.feature.add("deviation", nominal)
    assert features.plan.feature("deviation 1").deviation.nominal == "part.stl"
    presenter.templates.save(tmp_path / "block")
    qtbot.waitUntil(lambda: presenter.templates.recent == [tmp_path / "block.toml"])
    presenter.model.create(tmp_path / "next", cases.project())
    for step, done in cases.results(presenter.project).items():
        presenter.model.record(step, done)
    assert not features.plan.features
    presenter.templates.take(presenter.templates.recent[0])
    qtbot.waitUntil(lambda: features.shown is not None)
    assert features.plan.names == ("plane 1", "deviation 1")
    assert features.plan.feature("deviation 1").deviation.nominal == nominal.as_posix()
    undo(features)
    assert not features.plan.features


def test_deviations_are_drawn_by_class_and_their_shares_are_told(presenter, page, features, measuring, qtbot, tmp_path):
    classes = tuple(
        ShownClass(mark(number), number, *bounds(number, 0.1), 0.125 * (number > -4), np.ones((int(number > -4), 3)))
        for number in range(-4, 5)
    )
    found = ShownDeviations(classes, np.linspace(-1, 1, 5), np.arange(4), 0.1, NOMINAL)
    measuring.answers[jobs.MEASURE_FEATURES] = lambda folder, project: with_drawn(project, deviations=found)
    presenter.feature.add("deviation", tmp_path / "part.stl")
    measured(features, qtbot)
    drawn = {name for kind, name in page.surface.scene._scene.items if kind is Marks}
    page.refreshing.at_once()
    assert drawn == {f"deviation {number}" for number in range(-3, 5)}
    page.tabs.setCurrentWidget(page.plot)
    page.refreshing.at_once()
    assert page.plot.rows.text_of("Deviation [mm]") == "share"
    assert page.plot.rows.text_of("++  +0.05 to +0.075") == "12.5 %"
    assert page.plot.rows.text_of("+!  over +0.1") == "12.5 %"
    assert page.plot.rows.text_of("−!  under −0.1") == "0.0 %"
    words = [part for part in page.plot.rows.findChildren(QLabel) if part.isVisible() and part.wordWrap()]
    page.refreshing.at_once()
    assert {part.height() for part in words} == {words[0].fontMetrics().height()}, "no row wraps in a small window"
    page.tabs.setCurrentWidget(page.surface)
    page.refreshing.at_once()
    assert page.surface.minimumSizeHint().width() < 690, "the legend leaves the side panel its width"
    features.choose("")
    page.refreshing.at_once()
    assert not {name for kind, name in page.surface.scene._scene.items if kind is Marks}


def test_a_chosen_deviation_is_what_the_colour_bar_says(presenter, page, features, measuring, qtbot, tmp_path):
    found = ShownDeviations(
        (ShownClass("++", 2, 0.05, 0.075, 1.0, np.ones((1, 3))),), np.linspace(-1, 1, 5), np.arange(4), 0.1, NOMINAL
    )
    measuring.answers[jobs.MEASURE_FEATURES] = lambda folder, project: with_drawn(project, deviations=found)
    page.surface.choices.choose_colour("sigma")
    presenter.feature.add("deviation", tmp_path / "part.stl")
    measured(features, qtbot)
    page.refreshing.at_once()
    surface = page.surface

    def marks():
        return {name for kind, name in surface.scene._scene.items if kind is Marks}

    def bar():
        surface.refresh()
        surface._draw()
        return surface.scene._scene.cloud.colouring

    assert surface.colour == "nominal" and bar().title == "deviation from part.stl [mm]"
    assert bar().limits == pytest.approx((-0.125, 0.125)), "a class beyond the tolerance at either end"
    assert tuple(table(bar().colour_map)[-1]) == to_rgba(DEVIATIONS[-1])[:3]
    assert np.isnan(surface.scene._scene.cloud._values).all(), "what was not compared has no colour of the bar"
    surface.choices.choose_colour("height")
    assert bar().name.startswith("height") and not marks(), "never two meanings of colours at once"
    surface.choices.choose_colour("nominal")
    assert bar().colour_map == "classes" and marks() == {"deviation 2"}
    features.choose("")
    page.refreshing.at_once()
    assert surface.colour == "sigma", "as before it was chosen"
    place = surface.choices.colours.findData("nominal")
    assert not surface.choices.colours.model().item(place).isEnabled()
    assert "in the list" in surface.choices.colours.itemData(place, Qt.ItemDataRole.ToolTipRole)


def test_the_nominal_surface_lies_over_the_part_by_a_button(presenter, page, features, measuring, qtbot, tmp_path):
    found = ShownDeviations(
        (ShownClass("++", 2, 0.05, 0.075, 1.0, np.ones((1, 3))),), np.linspace(-1, 1, 5), np.arange(4), 0.1, NOMINAL
    )
    measuring.answers[jobs.MEASURE_FEATURES] = lambda folder, project: with_drawn(project, deviations=found)
    surface = page.surface

    def over():
        page.refreshing.at_once()
        return [item for (kind, _), item in surface.scene._scene.items.items() if kind is Patches]

    over()
    assert not surface.nominal.isEnabled() and "deviation from a nominal" in surface.nominal.toolTip()
    presenter.feature.add("deviation", tmp_path / "part.stl")
    measured(features, qtbot)
    assert over() == [] and surface.nominal.isEnabled()
    surface.nominal.trigger()
    (drawn,) = over()
    np.testing.assert_array_equal(drawn.corners[0][:3], NOMINAL[0])
    assert drawn.opacity < 0.5 and presenter.bench.settings.nominal_shown
    features.choose("")
    assert over() == []
    features.choose(features.plan.names[0])
    assert len(over()) == 1
    surface.nominal.trigger()
    assert over() == []


# ---- lie to datums


@pytest.fixture
def lie(presenter, qtbot):
    """A face that should be parallel to another one, which is its datum, and one that nobody asks for; measured."""
    plan = InspectionPlan(
        (
            FeatureSpec("base", "plane", (Auto(1),)),
            FeatureSpec("top", "plane", (Auto(2),)),
            FeatureSpec("other", "plane", (Auto(3),)),
            FeatureSpec(
                "lie", "parallelism", of=("top", "base"), limits=(("parallelism", Limits(0.0, -math.inf, 0.05)),)
            ),
        )
    )
    presenter.features.put_plan(plan, "plan")
    measured(presenter.features, qtbot)
    return presenter.features


def row_named(page, name):
    return page.features.list.model().index_of(name)


def test_what_is_asked_of_a_lie_stands_as_a_control_frame_in_list_and_form_with_its_datum(lie, page):
    asked = Frame("parallelism", ("0.05", "A"))
    assert row_named(page, "lie").data(FRAMES_ROLE) == [asked]
    assert row_named(page, "lie").data() == "lie"
    assert row_named(page, "base").data(FRAMES_ROLE)[0] == Frame(None, ("A",))
    assert not row_named(page, "other").data(FRAMES_ROLE)
    lie.choose("lie")
    page.refresh()
    assert page.features.form.frames.frames == (asked,)
    lie.choose("base")
    page.refresh()
    assert page.features.form.frames.frames == (Frame(None, ("A",)),)


def test_a_tolerance_changed_changes_the_frame_and_leaves_the_editors_where_they_are(lie, page):
    lie.choose("lie")
    page.refresh()
    form = page.features.form
    before, place = form.what, form.what.mapTo(page, form.what.rect().topLeft())
    page.presenter.feature.set_value("limits upper parallelism", 0.125)
    page.refresh()
    assert form.frames.frames == (Frame("parallelism", ("0.125", "A")),)
    assert form.what is before
    assert form.what.mapTo(page, form.what.rect().topLeft()) == place


def test_a_chosen_lie_marks_its_face_and_its_datum_with_its_letter(lie, page):
    scene = page.surface.scene._scene
    lie.choose("lie")
    page.refresh()
    assert {(Marks, "feature"), (Marks, "datum A"), (Labels, "datums")} <= set(scene.items)
    assert scene.items[Labels, "datums"].texts == ("A",)
    assert "used for lie" in page.surface.line.text()
    assert "datum A" in page.surface.line.text()
    lie.choose("other")
    page.refresh()
    assert (Marks, "feature") in scene.items
    assert not {(Marks, "datum A"), (Labels, "datums")} & set(scene.items)


def test_a_name_is_whole_in_the_list_where_its_kind_has_no_room_beside_it(lie, page):
    tree = page.features.list
    index, delegate = row_named(page, "other"), tree.itemDelegateForColumn(0)
    assert index.data() == "other, flatness"
    for width, words in ((400, "other, flatness"), (70, "other")):
        option = QStyleOptionViewItem()
        option.widget, option.rect = tree, QRect(0, 0, width, 20)
        delegate.initStyleOption(option, index)
        assert option.text == words
    assert "other flatness" in index.data(Qt.ItemDataRole.ToolTipRole)
