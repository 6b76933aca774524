"""Results at their places on the surface: which, how an outdated one is marked, what is remembered of them."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Limits
from core.inspect.plan.feature_spec import Auto, FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.shown.shown_features import ShownFeature, ShownInspection
from tests.workbench.pages import inspect_cases as cases
from workbench.pages.inspect.callouts import MOST, OUTDATED
from workbench.pages.inspect.features.plan import THICKNESS
from workbench.settings import AppSettings
from workbench.work import jobs

TOP = np.array([[0, 0, 500], [4, 0, 500], [1, 1, 500], [1, -1, 500]], np.float32)
PLAN = InspectionPlan(
    (
        FeatureSpec("top", "plane", (Auto(2),), limits=(("flatness", Limits(0.0, -np.inf, 0.1)),)),
        FeatureSpec("table", "plane"),
        FeatureSpec("gap", "distance", of=("top", "table")),
    )
)


def shown_of(plan):
    """Every feature 0.05 ± 0.01 mm."""
    features = []
    for spec in plan.features:
        places = TOP if not spec.of else TOP[:0]
        kind = "distance" if spec.of else "flatness"
        row = Characteristic(f"{spec.name} {kind}", kind, 0.05, 0.005, limits=spec.limits_of(kind), doubts=())
        features.append(ShownFeature(spec.name, spec.kind, (row,), len(places), places, places[:, :2]))
    return ShownInspection(tuple(features), False, (), "cal-1")


@pytest.fixture
def measuring(measuring):
    measuring.answers[jobs.MEASURE_FEATURES] = lambda folder, project: shown_of(project.inspection)
    return measuring


@pytest.fixture
def page(hand_bench, measuring, quick, show_page, tmp_path, qtbot):
    made = show_page(cases.entered(hand_bench, tmp_path / "project", cases.project(), qtbot))
    measure(made, qtbot, PLAN)
    return made


def measure(page, qtbot, plan):
    features = page.presenter.features
    features.put_plan(plan, "a plan")
    if not features.measuring:
        features.measure()
    qtbot.waitUntil(lambda: features.shown is not None and not features.measuring)
    page.refreshing.at_once()


def called(page):
    return {one.name: one for one in page.surface.scene._scene.callouts}


def test_each_feature_has_name_value_and_verdict_at_its_middle(page):
    top, gap = called(page)["top"], called(page)["gap"]
    assert (top.title, top.value) == ("top flatness", "0.050 ± 0.010 mm")
    assert top.sign == ("mdi6.check-decagram", "good") and gap.sign is None
    assert_allclose(top.place, TOP[2:].mean(axis=0), atol=1.01)
    assert gap.title == "gap distance" and gap.place is not None, "it stands at what it is made of"


def test_a_thickness_measured_alone_stands_on_its_upper_face(page):
    alone = called(page)[THICKNESS]
    assert (alone.title, alone.value) == ("Thickness", "50.012 ± 0.024 mm") and alone.place[2] == 500


def test_an_outdated_value_stays_and_is_marked(page, measuring, qtbot):
    measuring.held = {jobs.MEASURE_FEATURES}
    first = replace(PLAN.features[0], regions=(Auto(3),))
    page.presenter.features.put_plan(replace(PLAN, features=(first, *PLAN.features[1:])), "another region")
    page.refreshing.at_once()
    shown = called(page)
    assert shown["top"].outdated and shown["top"].sign == OUTDATED and shown["top"].value == "0.050 ± 0.010 mm"
    assert shown["gap"].outdated and not shown["table"].outdated


def test_a_thickness_of_other_faces_than_those_drawn_now_is_marked_as_old(page):
    assert not called(page)[THICKNESS].outdated
    page.presenter.faces.set_region("upper", [[20.0, 15.0], [40.0, 15.0], [40.0, 20.0]])
    page.refreshing.at_once()
    assert called(page)[THICKNESS].outdated and called(page)[THICKNESS].sign == OUTDATED


def test_of_many_features_the_worst_and_the_chosen_one_are_shown(page, qtbot):
    many = InspectionPlan(
        tuple(
            FeatureSpec(f"plane {k}", "plane", limits=(("flatness", Limits(0.0, -np.inf, 0.1 + 0.01 * k)),))
            for k in range(MOST + 3)
        )
    )
    measure(page, qtbot, many)
    worst = {f"plane {k}" for k in range(MOST)}
    assert set(called(page)) - {THICKNESS} == worst
    page.presenter.features.choose(f"plane {MOST + 2}")
    page.refreshing.at_once()
    assert set(called(page)) - {THICKNESS} == worst - {f"plane {MOST - 1}"} | {f"plane {MOST + 2}"}


def test_the_button_hides_them_and_is_remembered(page, tmp_path):
    action, settings = page.surface.callouts.action, page.presenter.bench.settings
    assert action.isChecked() and action.toolTip().endswith("(V)")
    action.trigger()
    assert not called(page) and not settings.callouts
    page.refreshing.at_once()
    assert not called(page)
    settings.flush()
    assert not AppSettings(tmp_path / "settings.ini").callouts
    action.trigger()
    assert "top" in called(page)


def test_where_one_was_dragged_is_kept_in_the_project_and_can_be_undone(page, qtbot):
    features = page.presenter.features
    page.surface.scene.callout_moved.emit("top", (40.0, -70.0))
    features.put(replace(PLAN.features[0], name="upper"), "top")
    measure(page, qtbot, features.plan)
    assert called(page)["upper"].moved == (40.0, -70.0) and called(page)["table"].moved is None
    model = page.presenter.bench.model
    assert model.project.callouts == {"upper": (40.0, -70.0)}
    model.undo_stack.undo()
    assert model.project.callouts == {"top": (40.0, -70.0)} and model.project.inspection == PLAN
    model.undo_stack.undo()
    assert not model.project.callouts


def test_the_place_of_a_removed_feature_is_forgotten_and_that_of_the_thickness_stays(page):
    features = page.presenter.features
    for name in ("gap", THICKNESS):
        page.surface.scene.callout_moved.emit(name, (40.0, -70.0))
    features.remove("gap")
    assert set(features.callouts_moved) == {THICKNESS}


def test_a_click_on_one_chooses_its_feature(page):
    page.surface.scene.callout_chosen.emit("table")
    assert page.presenter.features.chosen == "table"
    page.surface.scene.callout_chosen.emit(THICKNESS)
    assert page.presenter.features.chosen == THICKNESS
