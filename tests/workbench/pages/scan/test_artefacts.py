"""Compare with an artefact: from the Check card, by the registers of the user and the project."""

from dataclasses import replace
from datetime import date, timedelta
from typing import cast

import pytest
from PySide6.QtCore import Qt

from core.checks.artefact_check import Artefact, ArtefactCheck
from core.errors import InputError
from core.files.project.folder import read_project
from core.files.project.keys import finished
from core.files.results.artefact_register import own_register, store_own
from tests.workbench.hand_lane import HandLane
from workbench.notices import Level
from workbench.pages.scan.artefact_dialog import ArtefactDialog
from workbench.views import ask
from workbench.work import jobs

LEFT = Qt.MouseButton.LeftButton
BLOCK = Artefact("GB 50-7", 50.0003, 0.0004, 2.0, "D-K-15070 2026-03", date.today() + timedelta(days=1))
LAPSED = replace(BLOCK, id="GB 50-8", due=date.today() - timedelta(days=1))


@pytest.fixture
def page(scan_bench, scan_page):
    cast(HandLane, scan_bench.measuring).held.add(jobs.COMPARE_WITH_ARTEFACT)
    return scan_page


@pytest.fixture
def measured(page):
    """A thickness is measured, and up to date."""
    model = page.presenter.model
    scan = finished("scan", model.project, {})
    model.record_all({"scan": scan, "gauge": finished("gauge", model.project, {"scan": scan})})
    page.refresh()
    return page


def opened(page, qtbot):
    """The dialog, once it has read the registers."""
    page.refresh()
    qtbot.mouseClick(page.check.compare, LEFT)
    (dialog,) = page.check.findChildren(ArtefactDialog)
    qtbot.waitUntil(lambda: not page.presenter.bench.quick.busy)
    return dialog


def fill(dialog, **values):
    full = {
        "id": "GB 50-7",
        "kind": "block",
        "value_mm": 50.0003,
        "U_mm": 0.0004,
        "k": 2.0,
        "certificate": "",
        "due": "",
    }
    dialog.form.set_values({**full, "register": "own", **values})
    press(dialog.add)


def press(button):
    assert button.isEnabled()
    button.click()


def test_nothing_is_compared_before_a_thickness_is_measured_nor_where_nothing_can_be_kept(page, monkeypatch):
    page.refresh()
    assert not page.check.compare.isEnabled()
    assert page.check.compare.toolTip() == "Measure the artefact first, like a part."
    monkeypatch.setattr(type(page.presenter.model), "is_read_only", property(lambda _: True))
    page.refresh()
    assert "read-only" in page.check.compare.toolTip()


def test_a_thickness_that_is_out_of_date_is_not_compared(measured):
    assert measured.check.compare.isEnabled()
    model = measured.presenter.model
    model.edit("use another fan", replace(model.project, accepted=replace(model.project.accepted, planes="fan-2")))
    measured.refresh()
    assert measured.check.compare.toolTip() == "The scan is out of date; measure it again."


def test_both_registers_are_shown_and_what_has_lapsed_is_said(measured, qtbot):
    store_own(BLOCK)
    model = measured.presenter.model
    model.edit("add", replace(model.project, artefacts=(LAPSED,)))
    dialog = opened(measured, qtbot)
    first, second = dialog.table.rows()
    assert first == (
        "GB 50-7", "block, thickness", "50.00030", "0.00040 (k\u00a0=\u00a02)",
        "D-K-15070 2026-03", str(BLOCK.due), "mine",
    )  # fmt: skip
    assert second[0] == "GB 50-8" and second[-2:] == (f"{LAPSED.due}, lapsed", "project")
    assert not dialog.compare.isEnabled() and dialog.compare.toolTip() == "Choose an artefact."
    dialog.table.set_current_row(1)
    assert dialog.compare.isEnabled() and "have it calibrated" in dialog.said.text()


def test_the_thickness_is_compared_with_the_chosen_artefact_and_the_card_shows_the_result(measured, qtbot):
    store_own(BLOCK)
    bench = measured.presenter.bench
    lane, quick = cast(HandLane, bench.measuring), cast(HandLane, bench.quick)
    dialog = opened(measured, qtbot)
    dialog.table.set_current_row(0)
    press(dialog.compare)
    assert dialog.isHidden()
    (_, job, (folder, project, artefact, characteristic), _), *_ = lane.waiting
    assert (job, folder, project) == (jobs.COMPARE_WITH_ARTEFACT, bench.model.folder, bench.model.project)
    assert artefact == BLOCK and characteristic == "", "the thickness of the part"
    measured.refresh()
    assert measured.check.compare.toolTip() == "An artefact is being compared."
    check = ArtefactCheck(BLOCK, 50.05, 0.009, date.today())
    quick.answers[jobs.ARTEFACT_CHECKS] = lambda folder, project: (check,)
    lane.finish(check)
    qtbot.waitUntil(lambda: not quick.busy)
    measured.refresh()
    assert measured.check.rows.text_of("GB 50-7, measured") == "50.050 ± 0.018 mm"
    assert measured.check.compare.isEnabled()
    said = bench.notices.all[-1]
    assert said.level is Level.WARNING and "look for what changed" in said.text


def test_a_comparison_that_fails_says_why_and_can_be_made_again(measured, qtbot):
    store_own(BLOCK)
    dialog = opened(measured, qtbot)
    dialog.table.set_current_row(0)
    press(dialog.compare)
    bench = measured.presenter.bench
    cast(HandLane, bench.measuring).fail(InputError("no thickness was measured in it"))
    measured.refresh()
    assert "no thickness was measured" in bench.notices.all[-1].text
    assert measured.check.compare.isEnabled()


def test_an_artefact_added_to_the_project_is_saved_and_undone_in_one_step(measured, qtbot):
    model = measured.presenter.model
    dialog = opened(measured, qtbot)
    assert "add one" in dialog.said.text()
    before = model.undo_stack.count()
    fill(dialog, register="project", due=BLOCK.due.isoformat(), certificate=BLOCK.certificate)
    assert model.project.artefacts == (BLOCK,) and own_register() == {}
    assert dialog.chosen == BLOCK and dialog.compare.isEnabled(), "what was added is chosen"
    model.save()
    assert read_project(model.folder).project.artefacts == (BLOCK,)
    assert model.undo_stack.count() == before + 1
    model.undo_stack.undo()
    assert model.project.artefacts == ()


def test_an_artefact_added_to_the_users_own_is_there_in_every_project(measured, qtbot):
    model = measured.presenter.model
    dialog = opened(measured, qtbot)
    fill(dialog, k=3.0)
    qtbot.waitUntil(lambda: dialog.chosen is not None)
    assert own_register() == {"GB 50-7": Artefact("GB 50-7", 50.0003, 0.0004, 3.0)}
    assert model.project.artefacts == () and not model.undo_stack.canUndo()


def test_why_the_users_register_cannot_be_read_is_said(measured, qtbot):
    quick = cast(HandLane, measured.presenter.bench.quick)

    def damaged():
        raise InputError("the register is damaged")

    quick.answers[jobs.OWN_ARTEFACTS] = damaged
    assert "the register is damaged" in opened(measured, qtbot).problem.text()


def test_a_sphere_is_compared_with_a_diameter_of_the_features_that_can_be_chosen(measured, qtbot):
    bench, model = measured.presenter.bench, measured.presenter.model
    cast(HandLane, bench.quick).answers[jobs.COMPARABLE_LENGTHS] = lambda _: {
        "block": ("",), "sphere": ("ball diameter", "other diameter"), "step": (),
    }  # fmt: skip
    store_own(replace(BLOCK, id="B 25", kind="sphere"))
    store_own(replace(BLOCK, id="S 20", kind="step"))
    dialog = opened(measured, qtbot)
    dialog.table.set_current_row(0)
    assert dialog.compare.toolTip() == "Measure the artefact first, like a part.", "no features are measured yet"
    model.record_all({"inspection": finished("inspection", model.project, model.results)})
    dialog.table.set_current_row(1)
    assert dialog.length.isHidden() and "(step, height)" in dialog.compare.toolTip()
    dialog.table.set_current_row(0)
    assert not dialog.length.isHidden() and dialog.length.count() == 2
    dialog.length.setCurrentIndex(1)
    press(dialog.compare)
    (_, _, (_, _, artefact, characteristic), _), *_ = cast(HandLane, bench.measuring).waiting
    assert (artefact.id, characteristic) == ("B 25", "other diameter")


def chosen_in_the_project(page, qtbot):
    """The dialog with the project's only artefact chosen."""
    model = page.presenter.model
    model.edit("add", replace(model.project, artefacts=(BLOCK,)))
    dialog = opened(page, qtbot)
    dialog.table.set_current_row(0)
    return dialog


def test_an_artefact_of_the_project_is_changed_and_removed_each_undone_in_one_step(measured, qtbot):
    dialog, model = chosen_in_the_project(measured, qtbot), measured.presenter.model
    assert dialog.form.values()["value_mm"] == BLOCK.value_mm, "the fields are those of the chosen artefact"
    dialog.form.set_values({"id": "B 50", "kind": "sphere"})
    press(dialog.change)
    changed = replace(BLOCK, id="B 50", kind="sphere")
    assert model.project.artefacts == (changed,) and dialog.chosen == changed
    press(dialog.remove)
    assert model.project.artefacts == () and not dialog.remove.isEnabled()
    model.undo_stack.undo()
    assert model.project.artefacts == (changed,)
    model.undo_stack.undo()
    assert model.project.artefacts == (BLOCK,)


def test_an_artefact_stays_in_its_register_where_it_is_changed(measured, qtbot):
    dialog = chosen_in_the_project(measured, qtbot)
    dialog.form.set_values({"register": "own"})
    press(dialog.change)
    assert "add it to the other one" in dialog.form.help_of("register")
    assert measured.presenter.model.project.artefacts == (BLOCK,) and own_register() == {}


def test_an_artefact_of_the_users_own_is_changed_and_removed_once_that_is_confirmed(measured, qtbot, monkeypatch):
    store_own(BLOCK)
    dialog = opened(measured, qtbot)
    dialog.table.set_current_row(0)
    dialog.form.set_values({"value_mm": 50.5})
    press(dialog.change)
    changed = replace(BLOCK, value_mm=50.5)
    qtbot.waitUntil(lambda: dialog.chosen == changed)
    assert own_register() == {BLOCK.id: changed}
    monkeypatch.setattr(ask, "ask", lambda *_: 1)
    press(dialog.remove)
    assert own_register() == {BLOCK.id: changed}, "kept"
    monkeypatch.setattr(ask, "ask", lambda *_: 0)
    press(dialog.remove)
    qtbot.waitUntil(lambda: dialog.table.rows() == ())
    assert own_register() == {} and not measured.presenter.model.undo_stack.canUndo()


@pytest.mark.parametrize(
    ("field", "value", "said"),
    [
        ("id", " ", "Give it the name that is engraved on it."),
        ("id", "x" * 61, "At most 60 letters."),
        ("id", "GB 50-8", "The register has one of this name already."),
        ("value_mm", None, "The certificate states it."),
        ("U_mm", None, "The certificate states it."),
        ("due", "31.1.2028", "Write the day as 2028-03-01."),
    ],
)
def test_what_is_wrong_with_an_artefact_is_said_at_its_field_and_nothing_is_added(measured, qtbot, field, value, said):
    store_own(LAPSED)
    dialog = opened(measured, qtbot)
    fill(dialog, **{field: value})
    assert dialog.form.help_of(field) == said
    assert set(own_register()) == {LAPSED.id}
    fill(dialog)
    qtbot.waitUntil(lambda: set(own_register()) == {LAPSED.id, BLOCK.id})
    assert dialog.form.help_of(field) != said, "what was mended is no longer complained of"
