"""Who may do what in a project: names with PINs and roles, reasons, signatures; all of it in the audit trail."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import pytest

from core.errors import InputError
from core.files.project.data import Done, Project, ProjectFile, new_project
from core.files.project.folder import create_project, read_project, write_project
from core.files.project.witness import PEOPLE
from core.files.recording.rig import GaugeSpec
from core.inspect.conformity import Limits
from core.inspect.plan.feature_spec import FeatureSpec
from core.wings.audit.people import (
    Rules,
    needed_role,
    needs_reason,
    person,
    read_rules,
    refused,
    reset_rules,
    sign,
    with_pin,
    write_rules,
)
from core.wings.audit.trail import read_trail
from core.wings.audit.verify import verify
from tests.simulated import contents

ANNA, OLE, EVE = (
    person("Anna", "administrator", "anna-1"),
    person("Ole", "operator", "0000"),
    person("Eve", "inspector", "5678"),
)


@pytest.fixture
def project(tmp_path: Path) -> Path:
    create_project(tmp_path / "block", ProjectFile(new_project("Block")))
    write_rules(tmp_path / "block", Rules((ANNA, OLE, EVE)))
    return tmp_path / "block"


def with_gauge(project: Project, nominal: float) -> Project:
    return replace(project, rig=replace(project.rig, gauge=GaugeSpec(nominal, 0.1)))


def test_no_pin_can_be_read_from_the_file_and_only_the_right_one_is_taken(project: Path) -> None:
    assert "anna-1" not in (project / PEOPLE).read_text()
    assert with_pin(read_rules(project), "Anna", "anna-1") == ANNA
    for name, pin in (("Anna", "0000"), ("Ole", "anna-1"), ("Nobody", "0000")):
        with pytest.raises(InputError, match="name and PIN do not belong together"):
            with_pin(read_rules(project), name, pin)
    with pytest.raises(InputError, match="fewer than 4"):
        person("Max", "operator", "123")


def test_each_role_may_do_what_it_may_and_what_those_below_it_may(project: Path) -> None:
    before, rules = new_project("Block"), read_rules(project)
    typed = replace(before, info=replace(before.info, serial="7"))
    edited = replace(before, options=replace(before.options, sigma_cut_mm=0.1))
    limits = with_gauge(before, 50.0)
    feature = FeatureSpec("top", "plane", limits=(("flatness", Limits(0.0, -1.0, 0.1)),))
    planned = replace(before, inspection=replace(before.inspection, features=(feature,)))
    needed = {"operator": typed, "inspector": edited, "administrator": limits}
    assert [needed_role(before, after) for after in needed.values()] == list(needed)
    assert needed_role(before, planned) == "administrator"
    for by, most in ((None, 0), (OLE, 0), (EVE, 1), (ANNA, 2)):
        for place, after in enumerate(needed.values()):
            said = refused(rules, by, before, after)
            assert (said is None) == (place <= most)
            assert said is None or "only an" in str(said)
    assert refused(Rules(), None, before, limits) is None


def test_only_an_administrator_changes_the_people_and_one_always_stays(project: Path) -> None:
    for by in (None, OLE, EVE, person("Anna", "administrator", "other")):
        with pytest.raises(InputError, match="only an administrator"):
            write_rules(project, Rules(), by)
    with pytest.raises(InputError, match="there would be no administrator"):
        write_rules(project, Rules((OLE, EVE)), ANNA)
    with pytest.raises(InputError, match="a name is there twice"):
        write_rules(project, Rules((ANNA, person("Anna", "operator", "0000"))), ANNA)
    write_rules(project, Rules((ANNA,), reasons=True), ANNA)
    last = read_trail(project).entries[-1]
    assert (last.what, last.by, last.role) == ("people", "Anna", "administrator")
    told = {(change.field, change.old, change.new) for change in last.changes}
    assert told == {("people.Ole", "operator", ""), ("people.Eve", "inspector", ""), ("reasons", "false", "true")}


def test_lost_pins_lock_nobody_out_and_the_way_back_stays_in_the_trail(project: Path) -> None:
    with pytest.raises(InputError, match="a reason must be given"):
        reset_rules(project, " ")
    (project / PEOPLE).write_text("{")  # nor does a damaged file
    reset_rules(project, "Anna has left")
    assert read_rules(project) == Rules()
    last = read_trail(project).entries[-1]
    assert (last.what, last.why) == ("people reset", "Anna has left")
    assert verify(project).problems == ()


@pytest.mark.parametrize("change", ["remove", "edit", "put back"])
def test_people_changed_beside_the_program_are_told_by_verify(project: Path, change: str) -> None:
    path = project / PEOPLE
    text = path.read_text()
    assert verify(project).problems == ()
    if change == "put back":
        reset_rules(project, "lost")
        path.write_text(text)
    elif change == "edit":
        path.write_text(text.replace("operator", "inspector"))
    else:
        path.unlink()
    assert [str(one) for one in verify(project).problems] == ["people.json is not what the audit trail tells of"]


def test_a_signature_needs_the_pin_again_and_says_who_and_what(project: Path) -> None:
    with pytest.raises(InputError, match="do not belong together"):
        sign(project, "Eve", "0000", "released")
    sign(project, "Eve", "5678", "released")
    last = read_trail(project).entries[-1]
    assert (last.what, last.by, last.role, last.why) == ("signed", "Eve", "inspector", "released")
    assert read_trail(project).problems == ()


def test_a_reason_is_wanted_where_it_is_asked_for_and_limits_change_after_something_was_judged() -> None:
    before = with_gauge(new_project("Block"), 50.0)
    judged = {"gauge": Done("k", at=datetime.now(UTC))}
    other, typed = with_gauge(before, 51.0), replace(before, info=replace(before.info, serial="7"))
    assert needs_reason(Rules(reasons=True), judged, before, other)
    assert not needs_reason(Rules(reasons=True), judged, before, typed)
    assert not needs_reason(Rules(reasons=True), {}, before, other)
    assert not needs_reason(Rules(), judged, before, other)


def test_what_a_role_does_not_permit_is_not_saved_by_a_script_either(project: Path) -> None:
    file = read_project(project)
    limits = replace(file, project=with_gauge(file.project, 50.0))
    typed = replace(file, project=replace(file.project, info=replace(file.project.info, serial="7")))
    before = contents(project)
    for by in (None, OLE, EVE, person("Anna", "administrator", "other")):
        with pytest.raises(InputError) as told:
            write_project(project, limits, by=by)
        assert str(told.value).startswith(f"{project}: only an administrator may change this; sign in")
        assert contents(project) == before
    write_project(project, limits, by=ANNA)
    write_project(project, replace(limits, project=replace(limits.project, info=typed.project.info)))
    assert read_project(project).project.info.serial == "7"


def test_a_project_that_cannot_be_read_is_not_replaced_by_one_with_other_limits(project: Path) -> None:
    file = read_project(project)
    (project / "project.json").write_text("{")
    with pytest.raises(InputError, match="only an administrator"):
        write_project(project, replace(file, project=with_gauge(file.project, 50.0)), by=EVE)
    assert (project / "project.json").read_text() == "{"
