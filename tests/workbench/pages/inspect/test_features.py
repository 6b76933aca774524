"""Features beside the thickness: the plan edited, measured, shown; the panel clicked."""

import math
from dataclasses import replace
from itertools import combinations_with_replacement
from typing import cast

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import QAbstractButton, QApplication, QLineEdit

from core.errors import InputError
from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Limits
from core.inspect.plan.feature_spec import Auto, FeatureSpec, PointsOf, Polygon
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.plan.kinds import KINDS, kind_named, results_of
from core.inspect.shown.shown_features import ShownFeature, ShownInspection, ShownProfile
from core.messages import plain
from core.translations import language
from tests.inspect.plan.toy_kind import toy
from tests.workbench.cells import icon_of, place, shown, tip
from tests.workbench.hand_lane import HandLane
from tests.workbench.pages import inspect_cases as cases
from tests.workbench.pages.places import moved, places
from workbench.language import choose
from workbench.pages.inspect.features import values as fields
from workbench.pages.inspect.features.edit import LINE
from workbench.pages.inspect.features.plan import THICKNESS
from workbench.pages.inspect.stage import Stage
from workbench.views import ask
from workbench.views.control_frames import Frame, FramesIcon
from workbench.views.lists.tree_model import Cell, TreeRow
from workbench.views.scene.contents import Marks
from workbench.work import jobs

__all__ = ["toy"]

ELEMENTS = ("plane", "sphere", "cylinder", "point")
"""Kinds that others are made of."""
CORNERS = [(10.0, 10.0), (30.0, 10.0), (20.0, 30.0)]


def shown_of(project):
    """What measuring the plan would give: 50.012 ± 0.024 mm each; nothing for those called "lost"."""
    features = []
    for spec in project.inspection.features:
        rows = tuple(
            Characteristic(f"{spec.name} {result}", result, 50.012, 0.012, limits=spec.limits_of(result), doubts=())
            for result in results_of(spec)
        )
        lost = plain("no points there") if spec.name == "lost" else None
        places = np.zeros((0 if lost else 5, 3), np.float32)
        features.append(
            ShownFeature(spec.name, spec.kind, () if lost else rows, len(places), places, places[:, :2], lost)
        )
    return ShownInspection(tuple(features), False, (), "cal-1")


def with_drawn(project, **drawn):
    """The same, with something to draw."""
    shown = shown_of(project)
    return replace(shown, features=tuple(replace(one, **drawn) for one in shown.features))


@pytest.fixture
def measuring(measuring):
    measuring.answers[jobs.MEASURE_FEATURES] = lambda folder, project: shown_of(project)
    measuring.answers[jobs.LOOK_AT_FEATURES] = lambda folder, project: shown_of(project)
    return measuring


@pytest.fixture
def presenter(hand_bench, measuring, quick, tmp_path, qtbot):
    """A scan with its thickness is shown; the plan is empty."""
    quick.answers[jobs.OUTLINE_SELECTED] = lambda folder, numbers, face: np.array(CORNERS)
    return cases.entered(hand_bench, tmp_path / "project", cases.project(), qtbot)


@pytest.fixture
def features(presenter):
    return presenter.features


@pytest.fixture
def page(presenter, show_page):
    return show_page(presenter)


def measured(features, qtbot):
    features.measure()
    qtbot.waitUntil(lambda: features.shown is not None and not features.measuring)


def undo(features):
    features.model.undo_stack.undo()


def test_the_card_says_the_verdict_on_the_part_and_none_while_it_is_not_known(presenter, features, page, qtbot):
    def said():
        page.refresh()
        return page.card.words.text(), page.card.sign.isVisible()

    assert said()[0].startswith("Conforming") and said()[1]
    asked = FeatureSpec("step", "thickness", limits=(("thickness", Limits(50.0, -0.015, 0.02)),))
    features.put(asked)
    measured(features, qtbot)
    assert said()[0].startswith("Not proven") and said()[1], "as the report"
    features.put(replace(asked, limits=(("thickness", Limits(50.0, -0.2, 0.2)),)), "step")
    assert features.shown is None
    assert not said()[1] and "proven" not in said()[0]
    measured(features, qtbot)
    assert said()[0].startswith("Conforming")


# ---- the plan


def test_a_feature_is_added_changed_moved_and_removed_and_each_is_undone(presenter, features):
    presenter.feature.add("plane")
    presenter.feature.add("sphere")
    assert features.plan.names == ("plane 1", "sphere 1") and features.chosen == "sphere 1"
    features.move("sphere 1", -1)
    assert features.plan.names == ("sphere 1", "plane 1")
    presenter.feature.set_value("margin_mm", 0.5)
    assert features.plan.feature("sphere 1").filters.margin_mm == 0.5
    features.remove("sphere 1")
    assert features.plan.names == ("plane 1",)
    for names in (("sphere 1", "plane 1"),) * 2 + (("plane 1", "sphere 1"), ("plane 1",), ()):
        undo(features)
        assert features.plan.names == names


def test_others_follow_a_new_name(presenter, features):
    presenter.feature.add("plane")
    presenter.feature.add("plane")
    presenter.feature.add("distance")
    presenter.feature.add("plane")
    presenter.feature.set_value("source 0", fields.POINTS_OF + "plane 1")
    features.choose("plane 1")
    presenter.feature.set_value("name", "top")
    assert features.plan.feature("distance 1").of == ("top", "plane 2")
    assert features.plan.feature("plane 3").regions == (PointsOf("top"),)
    assert features.chosen == "top"
    features.plan.ordered()


def test_a_feature_that_others_rest_on_stays(presenter, features):
    for kind in ("plane", "plane", "distance"):
        presenter.feature.add(kind)
    features.remove("plane 1")
    assert "plane 1" in features.plan.names
    assert presenter.bench.notices.all[-1].text == "plane 1 cannot be removed: distance 1 rests on it."


def test_what_cannot_be_stays_in_the_form_with_a_sentence(presenter, features):
    presenter.feature.add("plane")
    presenter.feature.add("plane")
    presenter.feature.set_value("name", "plane 1")
    assert "two features have this name" in presenter.feature.complaint("name")
    assert presenter.feature.values()["name"] == "plane 1" and features.plan.names == ("plane 1", "plane 2")
    presenter.feature.set_value("name", "top")
    assert presenter.feature.complaint("name") == "" and features.plan.names == ("plane 1", "top")


def test_limits_wait_for_their_other_half(presenter, features):
    presenter.feature.add("sphere")
    presenter.feature.set_value("limits nominal diameter", 50.0)
    assert "lower or an upper deviation" in presenter.feature.complaint("limits nominal diameter")
    assert not features.plan.feature("sphere 1").limits
    presenter.feature.set_value("limits upper diameter", 0.1)
    assert features.plan.feature("sphere 1").limits == (("diameter", Limits(50.0, -math.inf, 0.1)),)
    assert not presenter.feature.complaint("limits nominal diameter")


def test_a_half_entered_value_is_not_taken_for_another_feature(presenter, features):
    presenter.feature.add("sphere")
    presenter.feature.set_value("limits nominal diameter", 50.0)
    presenter.feature.add("sphere")
    assert presenter.feature.values()["limits nominal diameter"] is None


def test_a_region_outlined_for_one_feature_is_not_given_to_another_chosen_meanwhile(
    presenter, features, hand_bench, qtbot
):
    quick = cast(HandLane, hand_bench.quick)
    quick.held = {jobs.OUTLINE_SELECTED}
    presenter.feature.add("plane")
    presenter.feature.add("sphere")
    presenter.outline(presenter.feature.region_name(0), np.ones(cases.POINTS, bool))
    features.choose("plane 1")
    qtbot.waitUntil(lambda: quick.busy)
    quick.finish(np.array(CORNERS))
    assert [one.regions for one in features.plan.features] == [(Auto(),), (Auto(),)]
    assert "draw it again" in presenter.bench.notices.all[-1].text


def test_a_region_drawn_in_3d_is_outlined_and_taken(presenter, features, qtbot):
    presenter.feature.add("sphere")
    presenter.outline(presenter.feature.region_name(0), np.ones(cases.POINTS, bool))
    qtbot.waitUntil(lambda: isinstance(features.plan.feature("sphere 1").regions[0], Polygon))
    assert features.plan.feature("sphere 1").regions == (Polygon(tuple(CORNERS)),)
    undo(features)
    assert features.plan.feature("sphere 1").regions == (Auto(),)


# ---- measuring


def test_why_nothing_can_be_measured_is_told(features):
    assert features.buttons.measure == "Add a feature first."


def test_the_plan_is_measured_and_stays_so_after_opening_again(presenter, features, measuring, qtbot):
    presenter.feature.add("plane")
    measured(features, qtbot)
    assert features.up_to_date and features.result("plane 1").rows[0].value == 50.012
    model = presenter.model
    model.save()
    model.open(model.folder)
    qtbot.waitUntil(lambda: features.shown is not None)
    assert measuring.ran[-1] == jobs.LOOK_AT_FEATURES


def test_features_that_are_only_read_again_are_not_said_to_be_measured(presenter, page, features, measuring, qtbot):
    presenter.feature.add("plane")
    measured(features, qtbot)
    model = presenter.model
    model.save()
    measuring.held = {jobs.LOOK_AT_FEATURES}
    model.open(model.folder)
    qtbot.waitUntil(lambda: features.measuring)
    page.refreshing.at_once()
    assert shown(page.features.list, 1, 1) == "reading …"


def test_a_plan_measured_once_is_measured_anew_when_it_changes(presenter, features, measuring, qtbot):
    features.put(FeatureSpec("plane 1", "plane"))
    assert not features.measuring
    measured(features, qtbot)
    presenter.feature.set_value("margin_mm", 0.5)
    assert features.result("plane 1") is None
    qtbot.waitUntil(lambda: features.up_to_date and features.shown is not None)
    undo(features)
    qtbot.waitUntil(lambda: features.up_to_date and features.shown is not None)
    assert measuring.ran.count(jobs.MEASURE_FEATURES) == 3


def test_without_its_last_feature_nothing_old_stays_among_the_results(presenter, features, measuring, qtbot):
    presenter.feature.add("plane")
    measured(features, qtbot)
    features.remove("plane 1")
    qtbot.waitUntil(lambda: features.shown is not None and features.up_to_date)
    assert features.shown.features == () and measuring.ran.count(jobs.MEASURE_FEATURES) == 2


def test_an_edit_while_measuring_is_measured_next_and_shown_is_of_the_plan(presenter, features, measuring, qtbot):
    presenter.feature.add("plane")
    measured(features, qtbot)
    measuring.held = {jobs.MEASURE_FEATURES}
    presenter.feature.set_value("margin_mm", 0.5)
    old = shown_of(presenter.project)
    presenter.feature.set_value("name", "top")
    measuring.finish(old)
    assert features.shown is None and features.measuring
    measuring.finish(shown_of(presenter.project))
    assert features.result("top") is not None and not features.measuring


def test_a_plan_that_cannot_be_measured_says_so_once(presenter, features, measuring, qtbot):
    def refuse(folder, project):
        raise InputError("the nominal surface is missing", where="part.stl")

    presenter.feature.add("plane")
    measured(features, qtbot)
    measuring.answers[jobs.MEASURE_FEATURES] = refuse
    presenter.feature.set_value("margin_mm", 0.5)
    qtbot.waitUntil(lambda: bool(features.problem) and not features.measuring)
    assert "nominal surface is missing" in features.problem
    assert measuring.ran.count(jobs.MEASURE_FEATURES) == 2


# ---- templates


def test_a_template_that_cannot_be_read_is_told_and_changes_nothing(presenter, features, tmp_path, qtbot):
    path = tmp_path / "plan.toml"
    path.write_text("[[feature]]\nkind = 'plane'\n", encoding="utf-8")
    presenter.templates.take(path)
    qtbot.waitUntil(lambda: bool(presenter.bench.notices.all))
    assert "name" in presenter.bench.notices.all[-1].text and not features.plan.features
    assert presenter.templates.recent == []


def test_the_templates_button_lists_the_ones_used_last(presenter, page, features, tmp_path, qtbot, monkeypatch):
    button = page.features.templates
    page.refreshing.at_once()
    assert not button.save.isEnabled() and button.save.toolTip() == "Add a feature first."
    presenter.feature.add("plane")
    monkeypatch.setattr(ask, "choose_file_to_save", lambda *_: tmp_path / "block.toml")
    page.refreshing.at_once()
    button.save.trigger()
    qtbot.waitUntil(lambda: [action.text() for action in button.recent] == ["block"])
    features.remove("plane 1")
    button.recent[0].trigger()
    page.refreshing.at_once()
    qtbot.waitUntil(lambda: features.plan.names == ("plane 1",))
    features.remove("plane 1")
    monkeypatch.setattr(ask, "choose_file_to_open", lambda *_: tmp_path / "block.toml")
    button.open.trigger()
    page.refreshing.at_once()
    qtbot.waitUntil(lambda: features.plan.names == ("plane 1",))


# ---- the panel


def test_a_high_page_shows_more_features_whatever_is_in_the_list(page, presenter):
    heights = []
    for height in (600, 700, 950, 3000):
        page.features.fit(height)
        presenter.feature.add("plane")
        page.refresh()
        heights.append(page.features.list.height())
    assert heights[0] == heights[1] < heights[2] < heights[3]
    page.features.fit(10_000)
    assert page.features.list.height() == heights[3]


def test_the_buttons_stand_below_the_list_however_high_the_page_is_made(page, presenter, qtbot):
    presenter.feature.add("plane")
    page.refresh()
    page.show()
    panel = page.features
    for height in (700, 1000, 720):
        page.resize(1280, height)
        qtbot.waitUntil(lambda: panel.list.geometry().bottom() < panel.measure.geometry().top())


def test_a_page_too_low_for_the_usual_rows_shows_fewer(page, presenter):
    presenter.feature.add("plane")
    page.refresh()
    heights = []
    for height in (410, 380, 300, 200):
        page.features.fit(height)
        heights.append(page.features.list.height())
    assert heights[0] > heights[1] > heights[2] == heights[3] > 3 * page.features.list.sizeHintForRow(0)


def test_the_chosen_feature_stays_in_sight_as_the_list_becomes_lower(page, features, presenter, qtbot):
    for _ in range(12):
        presenter.feature.add("plane")
    page.refresh()
    page.show()
    rows = page.features.list
    page.features.fit(3000)
    features.choose(features.plan.names[10])
    page.refresh()
    page.features.fit(600)
    qtbot.waitUntil(lambda: rows.viewport().rect().contains(rows.visualRect(rows.currentIndex()).center()))


def test_the_values_of_the_chosen_feature_are_in_sight(page):
    rows, below = page.features.list, [TreeRow("", (Cell(value), Cell("0.1 mm"))) for value in ("profile", "mean")]
    page.show()
    rows.set_rows([TreeRow(f"{number}", (Cell(f"{number}"), Cell("")), tuple(below)) for number in range(4)])
    rows.setFixedHeight(rows.header().height() + 5 * rows.rowHeight(rows.model().index(0, 0)))
    QApplication.processEvents()
    rows.choose("1")
    chosen, in_view = rows.currentIndex(), rows.viewport().rect()
    for index in (chosen, *(rows.model().index(row, 0, chosen) for row in range(2))):
        assert index.isValid() and in_view.contains(rows.visualRect(index).center())


def test_with_no_feature_chosen_none_looks_chosen(page, features, presenter):
    presenter.feature.add("plane")
    page.refreshing.at_once()
    assert [row.data() for row in page.features.list.selectionModel().selectedRows()] == ["plane 1"]
    features.choose("")
    page.refreshing.at_once()
    assert not page.features.list.selectedIndexes() and not page.features.list.currentIndex().isValid()


def test_without_features_the_panel_is_one_button(page):
    panel = page.features
    assert panel.add.isVisibleTo(page)
    assert not any(one.isVisibleTo(page) for one in (panel.measure, panel.remove, panel.form))
    assert panel.list.isVisibleTo(page) and panel.list.model().rowCount() == 1, "the thickness"
    assert not panel.kinds["distance"].isEnabled()
    assert "made of two other features" in panel.kinds["distance"].toolTip()


@pytest.mark.parametrize("made", [one for n in (0, 1, 2) for one in combinations_with_replacement(ELEMENTS, n)])
def test_a_kind_can_be_added_once_there_is_what_it_is_made_of(presenter, page, features, made):
    for kind in made:
        presenter.feature.add(kind)
    page.refreshing.at_once()
    directed = sum(kind in ("plane", "cylinder") for kind in made)
    placed = any(kind in ("sphere", "cylinder", "point") for kind in made)
    useful = {"distance": len(made), "position": 2 * placed} | dict.fromkeys(
        ("angle", "parallelism", "perpendicularity"), directed
    )
    for name, action in page.features.kinds.items():
        assert action.isEnabled() == (useful.get(name, 2) == 2) and action.toolTip()
        if not action.isEnabled():
            assert action.toolTip().startswith(
                ("It is made of two other features: add planes", "It is made of another feature")
            )


def test_an_angle_is_made_of_the_last_two_that_have_a_direction(presenter, page, features):
    for kind in ("plane", "cylinder", "sphere", "angle"):
        presenter.feature.add(kind)
    assert features.plan.feature("angle 1").of == ("plane 1", "cylinder 1")
    page.refreshing.at_once()
    chosen = page.features.form.where.editor("of 0")
    assert [chosen.itemText(place) for place in range(chosen.count())] == ["plane 1", "cylinder 1"]


def test_the_buttons_of_the_features_follow_the_panel_from_state_to_state(presenter, page, features, measuring, qtbot):
    panel = page.features

    def follow():
        page.refreshing.at_once()
        can = features.buttons
        for button, why_not in (
            (panel.measure, can.measure), (panel.remove, can.remove), (panel.up, can.up), (panel.down, can.down),
            (panel.templates.save, can.save),
        ):  # fmt: skip
            assert button.isEnabled() if not why_not else not button.isEnabled() and button.toolTip() == why_not
        return can

    assert follow().measure == follow().save == "Add a feature first."
    for kind in ("plane", "plane", "distance"):
        presenter.feature.add(kind)
    qtbot.waitUntil(lambda: not features.measuring)
    assert follow() == ("", "", "", "It is the last.", "")
    features.choose("plane 1")
    assert follow().up == "It is the first." and follow().remove.endswith("distance 1 rests on it.")
    features.choose("")
    assert follow()[1:4] == ("Choose a feature first.",) * 3
    measuring.held = {jobs.MEASURE_FEATURES}
    panel.measure.click()
    assert follow().measure == "The features are being measured."
    qtbot.waitUntil(lambda: measuring.busy)
    measuring.finish(shown_of(features.model.project))
    assert follow().measure == ""


def test_a_scan_that_cannot_be_read_has_no_features_measured(presenter, page, features, hand_bench, qtbot):
    presenter.feature.add("plane")
    qtbot.waitUntil(lambda: not features.measuring)
    quick = cast(HandLane, hand_bench.quick)
    quick.held = {jobs.INSPECTION_VIEW}
    presenter.scan.forget()
    presenter.entered()
    page.refreshing.at_once()
    assert page.features.measure.isEnabled(), "it need not be shown"
    quick.fail(InputError("broken"))
    page.refreshing.at_once()
    assert not page.features.measure.isEnabled()
    assert page.features.measure.toolTip() == "The scan cannot be read."


def test_nothing_is_measured_into_a_project_that_is_read_only(presenter, page, features, measuring, monkeypatch, qtbot):
    presenter.feature.add("plane")
    qtbot.waitUntil(lambda: not features.measuring)
    monkeypatch.setattr(type(features.model), "is_read_only", property(lambda _: True))
    page.refresh()
    for button in (page.features.measure, page.card.buttons["measure"]):
        assert not button.isEnabled() and button.toolTip().startswith("The project is read-only: go on in a copy")
    features.measure()
    presenter.do_run()
    assert not measuring.busy and not presenter.bench.notices.all


def test_the_list_shows_value_uncertainty_verdict_and_problem(page, features, qtbot):
    plan = InspectionPlan(
        (
            FeatureSpec("ball", "sphere", limits=(("diameter", Limits(50.0, -0.1, 0.1)),)),
            FeatureSpec("top", "plane"),
            FeatureSpec("lost", "plane"),
        )
    )
    features.put_plan(plan, "three")
    page.refreshing.at_once()
    assert shown(page.features.list, 1, 1) == "not measured"
    measured(features, qtbot)
    listed, (ball, top, lost) = page.features.list, range(1, 4)
    page.refreshing.at_once()
    assert (shown(listed, ball, 0, 0), shown(listed, ball, 1, 0)) == ("diameter", "50.012 ± 0.024 mm")
    assert "Conformity is proven" in tip(listed, ball, 1, 0) and not icon_of(listed, ball, 1).isNull()
    assert shown(listed, top, 1) == "50.012 ± 0.024 mm" and icon_of(listed, top, 1) is None
    assert shown(listed, lost, 1) == "cannot be measured" and "no points there" in tip(listed, lost, 1)
    assert (shown(listed, top), shown(listed, lost)) == ("top, flatness", "lost"), "what the number is of"
    assert page.features.list.verticalScrollBar().maximum() == 0, "all rows are seen"


def test_old_values_stay_marked_while_only_what_an_edit_concerns_is_measured_again(page, features, presenter, qtbot):
    plane = {"kind": "plane", "regions": (Auto(1),), "limits": (("flatness", Limits(50.0, -0.1, 0.1)),)}
    plan = InspectionPlan(
        (
            FeatureSpec("top", **plane),
            FeatureSpec("table", **plane),
            FeatureSpec("height", "distance", of=("top", "table")),
        )
    )
    features.put_plan(plan, "three")
    measured(features, qtbot)
    before = features.result("table")
    features.choose("top")
    presenter.feature.set_value("margin_mm", 0.5)
    page.refreshing.at_once()
    assert features.measuring
    listed, (top, table, height) = page.features.list, range(1, 4)
    for one in (top, height):
        assert shown(listed, one, 1) == "50.012 ± 0.024 mm" and "out of date" in tip(listed, one, 1)
        assert "Conformity is proven" not in tip(listed, one, 1)
    assert features.result("top") is None and features.result("height") is None
    assert features.result("table") is before
    assert "Conformity is proven" in tip(listed, table, 1) and "Out of date" not in tip(listed, table, 1)
    qtbot.waitUntil(lambda: features.shown is not None and not features.measuring)
    page.refreshing.at_once()
    assert "Conformity is proven" in tip(listed, top, 1)
    assert features.outdated("top") is None
    undo(features)
    assert features.outdated("top") is not None, "what was measured last is of the plan that was undone"


def test_values_of_another_scan_are_not_kept(features, presenter, qtbot):
    features.put_plan(InspectionPlan((FeatureSpec("top", "plane", regions=(Auto(1),)),)), "one")
    measured(features, qtbot)
    model = presenter.bench.model
    model.record("scan", replace(model.results["scan"], key="another"))
    assert features.result("top") is None and features.outdated("top") is None


def test_the_list_stays_in_sight_and_results_do_not_move_the_form_of_the_one_chosen(page, features, presenter, qtbot):
    presenter.feature.add("plane")
    page.resize(1000, 640)
    page.show()
    form, panels = page.features.form, page.scrolled
    qtbot.waitUntil(lambda: form.isVisible() and panels.verticalScrollBar().maximum() > 0)
    qtbot.waitUntil(lambda: page.features.height() == page.features.sizeHint().height())
    before = form.mapTo(page, form.rect().topLeft())
    measured(features, qtbot)
    page.refreshing.at_once()
    qtbot.wait(50)
    assert form.mapTo(page, form.rect().topLeft()) == before
    panels.verticalScrollBar().setValue(panels.verticalScrollBar().maximum())
    assert not page.features.list.visibleRegion().isEmpty()
    assert not page.features.measure.visibleRegion().isEmpty()


def test_the_form_of_a_feature_begins_at_its_top(page, features, presenter, qtbot):
    for kind in ("plane", "cylinder"):
        presenter.feature.add(kind)
    page.resize(1000, 640)
    bar = page.scrolled.verticalScrollBar()
    page.refreshing.at_once()
    qtbot.waitUntil(lambda: bar.maximum() > 300)
    bar.setValue(300)
    presenter.feature.set_value("limits upper diameter", 0.1)
    page.refreshing.at_once()
    assert bar.value() == 300, "nothing moves while it is edited"
    features.choose("plane 1")
    page.refreshing.at_once()
    qtbot.wait(50)
    assert bar.value() == 0
    bar.setValue(300)
    presenter.model.opened.emit()
    assert bar.value() == 0, "another project"


@pytest.mark.parametrize("notes", [(), (plain("The stated uncertainty does not hold that of the fan. " * 9),)])
@pytest.mark.parametrize("chosen", ["plane 1", "lost", ""])
def test_measured_features_push_no_section(page, features, presenter, measuring, qtbot, chosen, notes):
    for name in ("plane 1", "lost"):
        presenter.feature.add("plane")
        presenter.feature.set_value("name", name)
    features.choose(chosen)
    page.show()
    before = places(page, qtbot)
    measuring.answers[jobs.MEASURE_FEATURES] = lambda folder, project: replace(shown_of(project), notes=notes)
    measured(features, qtbot)
    assert not moved(before, places(page, qtbot))


def test_no_row_of_the_list_is_marked_when_no_feature_is_chosen(page, features, presenter, qtbot):
    presenter.feature.add("plane")
    page.refreshing.at_once()
    assert page.features.list.selectedIndexes()
    features.choose("")
    page.refreshing.at_once()
    assert not page.features.list.selectedIndexes() and not page.features.list.currentIndex().isValid()


def test_choosing_a_feature_shows_its_points_in_3d_and_in_the_picture(presenter, page, features, qtbot):
    presenter.feature.add("plane")
    presenter.feature.add("sphere")
    measured(features, qtbot)
    page.features.list.setCurrentIndex(place(page.features.list, 1))
    page.refreshing.at_once()
    assert features.chosen == "plane 1" and (Marks, "feature") in page.surface.scene._scene.items
    page.tabs.setCurrentWidget(page.picture)
    page.refreshing.at_once()
    assert "feature points" in page.picture.image.layer_names()
    features.choose("")
    page.refreshing.at_once()
    assert "feature points" not in page.picture.image.layer_names()
    page.tabs.setCurrentWidget(page.surface)
    page.refreshing.at_once()
    assert (Marks, "feature") not in page.surface.scene._scene.items


def test_a_region_drawn_in_the_picture_is_the_features(presenter, page, features):
    presenter.feature.add("plane")
    page.tabs.setCurrentWidget(page.picture)
    page.refreshing.at_once()
    page.features.form.tools[0, "polygon"].click()
    page.refreshing.at_once()
    page.picture.image.polygon_drawn.emit(presenter.feature.region_name(0), np.array(CORNERS))
    page.refreshing.at_once()
    assert features.plan.feature("plane 1").regions == (Polygon(tuple(CORNERS)),)
    assert presenter.feature.region_name(0) in page.picture.image.layer_names()
    page.presenter.faces.set_region("upper", np.array(CORNERS))
    page.refreshing.at_once()
    assert features.plan.feature("plane 1").regions == (Polygon(tuple(CORNERS)),)


def test_the_cut_is_dragged_in_the_picture(presenter, page, features):
    presenter.feature.add("section")
    page.tabs.setCurrentWidget(page.picture)
    page.picture.image.polygon_edited.emit(LINE, np.array([(1.0, 2.0), (30.0, 40.0)]))
    page.refreshing.at_once()
    assert features.plan.feature("section 1").section.line_px == ((1.0, 2.0), (30.0, 40.0))
    features.choose("")
    page.refreshing.at_once()
    assert LINE not in page.picture.image.layer_names()


def test_the_plot_shows_the_profile_of_the_chosen_section(presenter, page, features, measuring, qtbot):
    profile = ShownProfile(np.arange(5.0), np.ones(5), np.arange(2.0), np.ones(2), np.zeros(2, np.int64))
    measuring.answers[jobs.MEASURE_FEATURES] = lambda folder, project: with_drawn(project, profile=profile)
    page.refreshing.at_once()
    assert not page.tabs.isTabVisible(page.tabs.indexOf(page.plot))
    presenter.feature.add("section")
    presenter.feature.add_cut()
    page.tabs.setCurrentWidget(page.plot)
    page.refreshing.at_once()
    assert "Measure the features" in page.plot.chart.empty_state.message
    measured(features, qtbot)
    page.refreshing.at_once()
    assert set(page.plot.chart._curves) == {"points", "mean"}
    assert page.plot.rows.text_of("height 1") == "50.012 ± 0.024 mm"
    features.choose("")
    page.refreshing.at_once()
    assert "Choose a cross-section" in page.plot.chart.empty_state.message


def test_a_new_measurement_in_a_section_begins_on_the_levels_of_its_profile(presenter, features, measuring, qtbot):
    position = np.arange(0.5, 100.0)
    profile = ShownProfile(
        position, position, position, np.where(position < 40, 0.0, 10.0), np.zeros(len(position), np.int64)
    )
    measuring.answers[jobs.MEASURE_FEATURES] = lambda folder, project: with_drawn(project, profile=profile)
    presenter.feature.add("section")
    measured(features, qtbot)
    presenter.feature.add_cut()
    (cut,) = features.plan.feature("section 1").section.cuts
    assert (cut.kind, cut.first, cut.second) == ("height", (8.1, 30.9), (53.1, 87.9))


@pytest.mark.parametrize("kind", [kind.name for kind in KINDS])
def test_every_kind_has_a_form_in_which_all_is_named_and_helped(presenter, page, features, kind, tmp_path):
    presenter.feature.add("plane")
    presenter.feature.add("plane")
    presenter.feature.add(kind, tmp_path / "part.stl" if kind_named(kind).nominal_file else None)
    presenter.feature.add_cut()
    form = page.features.form
    values = presenter.feature.values()
    held = set(form.where.values()) | set(form.what.values())
    assert held <= set(values)
    for one in (form.where, form.what):
        assert all(one.help_of(key) for key in one.values())
    greyed = [b for b in page.features.findChildren(QAbstractButton) if b.isVisible() and not b.isEnabled()]
    assert all(button.toolTip() for button in greyed)


def test_a_kind_that_is_registered_is_in_the_menu_has_a_form_and_is_measured(toy, presenter, page, features, qtbot):
    assert toy.title in {action.text() for action in page.features.kinds.values()}
    presenter.feature.add(toy.name)
    qtbot.waitUntil(lambda: "limits upper spread" in page.features.form.what.values())
    assert {"nominal_heights", "limits nominal slope"} <= set(page.features.form.what.values())
    presenter.feature.set_value("limits upper spread", 60.0)
    assert features.plan.features[0].limits_of("spread").upper == 60.0
    measured(features, qtbot)
    qtbot.waitUntil(lambda: page.features.list.model().rowCount(place(page.features.list, 1)) == 2)


def test_an_edit_in_the_form_is_an_edit_of_the_plan(presenter, page, features, qtbot):
    presenter.feature.add("plane")
    page.refreshing.at_once()
    editor = page.features.form.what.editor("margin_mm")
    editor.setFocus()
    editor.selectAll()
    page.refreshing.at_once()
    qtbot.keyClicks(editor, "0.75")
    page.refreshing.at_once()
    qtbot.keyClick(editor, Qt.Key.Key_Return)
    page.refreshing.at_once()
    assert features.plan.feature("plane 1").filters.margin_mm == 0.75


def test_delete_and_alt_arrows_work_in_the_list(presenter, page, features, qtbot):
    presenter.feature.add("plane")
    presenter.feature.add("sphere")
    page.refreshing.at_once()
    page.features.list.setFocus()
    qtbot.keyClick(page.features.list, Qt.Key.Key_Up, Qt.KeyboardModifier.AltModifier)
    page.refreshing.at_once()
    assert features.plan.names == ("sphere 1", "plane 1")
    qtbot.keyClick(page.features.list, Qt.Key.Key_Delete)
    page.refreshing.at_once()
    assert features.plan.names == ("plane 1",)


def test_a_control_frame_is_drawn_in_its_own_size(qapp):
    icon = FramesIcon((Frame(None, ("B",)), Frame("position", ("⌀0.1", "A", "B"))))
    drawn = icon.pixmap(icon.size, QIcon.Mode.Normal, QIcon.State.Off).toImage()
    inked = np.array(
        [[drawn.pixelColor(x, y).alpha() > 0 for x in range(drawn.width())] for y in range(drawn.height())]
    )
    assert inked[0].mean() > 0.8  # the upper edge of its boxes
    assert not inked.any(axis=0).all()  # with a gap between the two
    assert icon.size.width() > FramesIcon((Frame("position", ("⌀0.1",)),)).size.width()


# ---- one list of results


def test_the_thickness_is_the_first_of_all_results_and_an_old_one_looks_old(presenter, page, features, qtbot):
    presenter.feature.add("plane")
    qtbot.waitUntil(lambda: not features.measuring)
    page.refreshing.at_once()
    listed = page.features.list
    assert (shown(listed, 0), shown(listed, 0, 1)) == ("Thickness", "50.012 ± 0.024 mm")
    assert "Conformity is proven" in tip(listed, 0, 1)
    presenter.faces.set_number("nominal_mm", 51.0)
    presenter.faces.set_number("tolerance_mm", 0.1)
    page.refreshing.at_once()
    assert "out of date" in tip(listed, 0, 1) and "Conformity" not in tip(listed, 0, 1)


def test_a_new_feature_is_measured_at_once(presenter, features, qtbot):
    presenter.feature.add("plane")
    qtbot.waitUntil(lambda: features.result("plane 1") is not None)


def test_new_features_are_called_in_the_language_of_the_window(presenter, features, qapp):
    choose(language("de"), qapp)
    try:
        presenter.feature.add("plane")
        presenter.feature.add("section")
    finally:
        choose(language("en"), qapp)
    assert features.plan.names == ("Ebene 1", "Schnitt 1")


@pytest.mark.parametrize("way", ["key", "double click"])
def test_a_feature_is_renamed_in_the_list(presenter, page, features, qtbot, way):
    presenter.feature.add("plane")
    page.refreshing.at_once()
    listed = page.features.list
    listed.setFocus()
    if way == "key":
        qtbot.keyClick(listed, Qt.Key.Key_F2)
    else:
        at = listed.visualRect(place(listed, 1)).center()
        qtbot.mouseClick(listed.viewport(), Qt.MouseButton.LeftButton, pos=at)
        qtbot.mouseDClick(listed.viewport(), Qt.MouseButton.LeftButton, pos=at)
    editor = listed.viewport().findChild(QLineEdit)
    assert editor is not None and editor.text() == "plane 1"
    editor.setText("table")
    qtbot.keyClick(editor, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: features.plan.names == ("table",))
    undo(features)
    assert features.plan.names == ("plane 1",)


def test_what_can_be_done_with_a_row_is_in_its_menu(presenter, page, features, qtbot):
    presenter.feature.add("plane")
    qtbot.waitUntil(lambda: not features.measuring)
    page.refreshing.at_once()
    panel, listed = page.features, page.features.list
    listed.customContextMenuRequested.emit(listed.visualRect(place(listed, 1)).center())
    can = panel.actions_of_row
    can["duplicate"].trigger()
    assert features.plan.names == ("plane 1", "plane 2") and features.chosen == "plane 2"
    assert features.plan.feature("plane 2").regions == features.plan.feature("plane 1").regions
    page.refreshing.at_once()
    can["limits"].trigger()
    qtbot.waitUntil(lambda: panel.form.what.editor("limits upper flatness").hasFocus())
    page.tabs.setCurrentWidget(page.picture)
    qtbot.waitUntil(lambda: features.result("plane 2") is not None)
    page.refreshing.at_once()
    before = page.surface.scene._navigator.camera
    can["show"].trigger()
    assert page.tabs.currentWidget() is page.surface and page.surface.scene._navigator.camera != before
    can["remove"].trigger()
    assert features.plan.names == ("plane 1",)


def test_the_thickness_has_limits_and_is_measured_again_from_its_row_but_not_removed(presenter, page, features, qtbot):
    page.refreshing.at_once()
    listed, can = page.features.list, page.features.actions_of_row
    listed.customContextMenuRequested.emit(listed.visualRect(place(listed, 0)).center())
    assert features.chosen == THICKNESS
    for name in ("rename", "duplicate", "remove"):
        assert not can[name].isEnabled() and can[name].toolTip()
    can["limits"].trigger()
    assert page.faces.form.editor("nominal_mm").hasFocus()
    can["show"].trigger()
    can["measure"].trigger()
    assert presenter.stage is Stage.MEASURING


def in_sight(page, editor):
    """Whether a field at the side is seen whole."""
    seen = page.scrolled.viewport().rect()
    return seen.contains(QRect(editor.mapTo(page.scrolled.viewport(), QPoint(0, 0)), editor.size()))


@pytest.mark.parametrize("kind", ["plane", "section", "cylinder"])
def test_limits_bring_their_field_in_sight_on_a_low_page(presenter, page, features, qtbot, kind):
    page.resize(1050, 620)
    presenter.feature.add(kind)
    if kind == "section":
        presenter.feature.add_cut()
    qtbot.waitUntil(lambda: not features.measuring)
    page.refreshing.at_once()
    can = page.features.actions_of_row
    can["limits"].trigger()
    qtbot.waitUntil(lambda: page.features.form.first_limit.hasFocus())
    qtbot.waitUntil(lambda: in_sight(page, page.features.form.first_limit))
    qtbot.wait(50)
    assert in_sight(page, page.features.form.first_limit), "and it stays there"
    features.choose(THICKNESS)
    page.refreshing.at_once()
    can["limits"].trigger()
    qtbot.waitUntil(lambda: page.faces.form.editor("nominal_mm").hasFocus())
    qtbot.wait(50)
    assert in_sight(page, page.faces.form.editor("nominal_mm"))
