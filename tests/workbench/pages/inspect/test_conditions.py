"""Part coordinates, temperature and master, entered in the window: in the plan, undoable, with what still lacks."""

from dataclasses import replace

import numpy as np
import pytest

from core.inspect.causes import Cause
from core.inspect.plan.conditions import Master, Temperature
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan, PartFrame
from core.messages import plain
from tests.workbench.pages import inspect_cases as cases
from workbench.pages.inspect.features import conditions as fields
from workbench.views import ask
from workbench.work import jobs

PLAN = InspectionPlan(
    (
        FeatureSpec("top", "plane"),
        FeatureSpec("side", "plane"),
        FeatureSpec("front", "plane"),
        FeatureSpec("height", "thickness"),
        FeatureSpec("ball", "sphere"),
    )
)
MASTER = Master("Block 50 no. 7", 50.0, 0.0, 50.004, ((Cause.CAMERA, 0.003), (plain("own noise"), 0.004)), (), False)


@pytest.fixture
def presenter(hand_bench, quick, tmp_path, qtbot):
    quick.answers[jobs.MEASURED_MASTER] = lambda folder, certified, project: MASTER
    project = cases.project()
    info = replace(project.info, part_celsius=23.5)
    return cases.entered(hand_bench, tmp_path / "project", replace(project, inspection=PLAN, info=info), qtbot)


@pytest.fixture
def conditions(presenter):
    return presenter.conditions


@pytest.fixture
def page(presenter, show_page, qtbot):
    made = show_page(presenter)
    made.conditions_fold.expand(animate=False)
    qtbot.waitUntil(lambda: "master" in made.conditions.forms)
    return made


def undo(presenter):
    presenter.model.undo_stack.undo()


def test_a_frame_waits_for_its_second_feature_and_is_undone_as_one_edit(presenter, conditions):
    conditions.set_value("primary", "top")
    assert presenter.features.plan.frame is None and "second feature" in conditions.complaint("frame")
    conditions.set_value("secondary", "top")
    assert "three different" in conditions.complaint("frame")
    conditions.set_value("secondary", "side")
    assert presenter.features.plan.frame == PartFrame("top", "side") and conditions.complaint("frame") == ""
    conditions.set_value("tertiary", "front")
    assert presenter.features.plan.frame == PartFrame("top", "side", "front")
    undo(presenter)
    assert presenter.features.plan.frame == PartFrame("top", "side")
    conditions.set_value("primary", "")
    assert presenter.features.plan.frame is None
    undo(presenter)
    assert presenter.features.plan.frame == PartFrame("top", "side")


def test_what_is_half_entered_stays_while_another_group_is_edited(presenter, conditions):
    conditions.set_value("primary", "top")
    conditions.set_value(fields.AT_20, True)
    assert conditions.values()["primary"] == "top" and conditions.complaint("frame")
    conditions.set_value("secondary", "side")
    assert presenter.features.plan.frame == PartFrame("top", "side") and presenter.features.plan.temperature is not None


def test_only_what_can_be_measured_as_such_is_offered_for_the_frame():
    plan = replace(PLAN, features=(*PLAN.features, FeatureSpec("bore", "cylinder")))
    assert fields.frame_choices(plan, "primary") == ("top", "side", "front")
    assert fields.frame_choices(plan, "secondary") == ("top", "side", "front", "bore")
    assert "ball" in fields.frame_choices(plan, "tertiary") and "height" not in fields.frame_choices(plan, "tertiary")


def test_temperature_begins_with_steel_and_what_the_project_page_says(presenter, conditions):
    conditions.set_value(fields.AT_20, True)
    assert presenter.features.plan.temperature == Temperature(23.5, 0.5, 11.5e-6, 0.6e-6)
    conditions.set_value("alpha", 23.0)
    assert presenter.features.plan.temperature == Temperature(23.5, 0.5, 23e-6, 0.6e-6)
    assert conditions.values()["alpha"] == 23.0
    undo(presenter)
    assert conditions.values()["alpha"] == 11.5
    conditions.set_value(fields.AT_20, False)
    assert presenter.features.plan.temperature is None


def test_a_master_waits_until_all_of_it_is_known(presenter, conditions):
    conditions.set_value(fields.WITH_MASTER, True)
    said = [conditions.complaint("master")]
    assert conditions.values()["u_certified_mm"] is None and conditions.values()[fields.U_MEASURED] is None
    for key, value in (
        ("name", "Block"),
        ("certified_mm", 50.001),
        ("u_certified_mm", 0.0002),
        ("measured_mm", 50.006),
        (fields.U_MEASURED, 0.004),
    ):
        assert presenter.features.plan.master is None
        conditions.set_value(key, value)
        said.append(conditions.complaint("master"))
    asked = (
        "name",
        "length by the certificate",
        "u by the certificate",
        "what was measured",
        "u of what was measured",
        "",
    )
    assert [part in text for part, text in zip(asked, said, strict=True)] == [True] * 6
    assert said[-1] == ""
    conditions.set_value(fields.U_MEASURED, 0.005)
    conditions.set_value(fields.COMPARED + "ball", False)
    wanted = Master("Block", 50.001, 0.0002, 50.006, ((Cause.MASTER_MEASURED, 0.005),), ("height",), True)
    assert presenter.features.plan.master == wanted
    conditions.set_value(fields.COMPARED + "height", False)
    assert presenter.features.plan.master == wanted and "Choose a feature" in conditions.complaint("master")


def test_a_master_is_taken_from_its_results_with_its_budget(presenter, conditions, tmp_path, qtbot):
    conditions.set_value(fields.WITH_MASTER, True)
    conditions.set_value("certified_mm", 50.001)
    conditions.set_value("u_certified_mm", 0.0001)
    conditions.take_master(tmp_path)
    qtbot.waitUntil(lambda: presenter.features.plan.master is not None)
    master = presenter.features.plan.master
    assert (master.name, master.certified_mm, master.measured_mm) == ("Block 50 no. 7", 50.001, 50.004)
    assert master.budget == MASTER.budget and not master.same_calibration
    assert conditions.values()[fields.U_MEASURED] == pytest.approx(0.005)
    conditions.set_value("u_certified_mm", 0.0002)
    assert presenter.features.plan.master.budget == MASTER.budget


def test_frame_and_master_follow_a_new_name_and_hold_what_they_rest_on(presenter, conditions, qtbot, tmp_path):
    features = presenter.features
    conditions.set_value("primary", "top")
    conditions.set_value("secondary", "side")
    conditions.set_value(fields.WITH_MASTER, True)
    conditions.set_value("certified_mm", 50.0)
    conditions.set_value("u_certified_mm", 0.0001)
    conditions.take_master(tmp_path)
    qtbot.waitUntil(lambda: features.plan.master is not None)
    for name, new in (("height", "block"), ("top", "table")):
        features.choose(name)
        presenter.feature.set_value("name", new)
    assert features.plan.master.features == ("block", "ball") and features.plan.frame.names == ("table", "side")
    features.remove("ball")
    assert features.plan.master.features == ("block",)
    assert "comparison with the master" in features.cannot_remove("block")
    assert "coordinates" in features.cannot_remove("table")


def test_the_panel_shows_what_is_set_and_sets_what_is_clicked(page, presenter, qtbot):
    panel = page.conditions
    page.refreshing.at_once()
    assert set(panel.forms["temperature"].values()) == {fields.AT_20}
    panel.forms["temperature"].editor(fields.AT_20).click()
    page.refreshing.at_once()
    assert presenter.features.plan.temperature is not None
    assert page.conditions_fold.text() == "Conditions and frame (20 °C)"
    qtbot.waitUntil(lambda: panel.forms["temperature"].values().get("part_celsius") == 23.5)
    choice = panel.forms["frame"].editor("primary")
    choice.setCurrentIndex(choice.findText("top"))
    choice.activated.emit(choice.currentIndex())
    page.refreshing.at_once()
    qtbot.waitUntil(lambda: "secondary" in panel.forms["frame"].values())
    page.refreshing.at_once()
    assert "second feature" in panel.complaints["frame"].text()
    panel.forms["master"].editor(fields.WITH_MASTER).click()
    page.refreshing.at_once()
    qtbot.waitUntil(lambda: panel.take is not None and panel.take.isVisible())
    page.refreshing.at_once()
    assert fields.COMPARED + "ball" in panel.forms["master"].values()
    undo(presenter)
    page.refreshing.at_once()
    qtbot.waitUntil(lambda: set(panel.forms["temperature"].values()) == {fields.AT_20})
    page.refreshing.at_once()
    assert all(
        form.help_of(key) for form in panel.forms.values() for key in form.values() if not key.startswith("comp")
    )


def test_the_panel_takes_a_master_from_the_folder_that_is_chosen(
    page, presenter, conditions, qtbot, monkeypatch, tmp_path
):
    conditions.set_value(fields.WITH_MASTER, True)
    conditions.set_value("certified_mm", 50.001)
    conditions.set_value("u_certified_mm", 0.0001)
    monkeypatch.setattr(ask, "choose_folder", lambda *_: tmp_path)
    qtbot.waitUntil(lambda: page.conditions.take is not None and page.conditions.take.isVisible())
    page.conditions.take.click()
    qtbot.waitUntil(lambda: presenter.features.plan.master is not None)
    qtbot.waitUntil(lambda: page.conditions.forms["master"].values()["measured_mm"] == 50.004)
    assert np.isclose(page.conditions.forms["master"].values()[fields.U_MEASURED], 0.005)
