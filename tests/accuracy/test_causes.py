"""Precision of causes: what counts as a false one, and what as the first one told."""

import pytest

from tests.accuracy.causes import (
    BENIGN,
    CLAIMS,
    benign_cases,
    benign_table,
    false_causes,
    first_cases,
    first_cause,
    first_table,
)
from tests.accuracy.hostile import figures_of

FINE = {"error": 0.01, "U": 0.08, "verdict": "conforming", "first": ["scan.scale_weak"]}


def test_a_cause_is_false_unless_it_is_told_of_every_rig_or_true_of_its_kind():
    assert false_causes("as usual", FINE) == []
    told = {**FINE, "first": ["scan.moved", "scan.speckled", "scan.scale_weak"]}
    assert false_causes("as usual", told) == ["scan.moved", "scan.speckled"]
    assert false_causes("blotchy surfaces", told) == ["scan.moved"]


def test_the_table_of_benign_sets_has_a_line_for_each_kind_and_counts_sets_once():
    cases = benign_cases()
    results = {case.name: FINE for case in cases}
    results[cases[0].name] = {**FINE, "first": ["scan.moved", "scan.fan_shifted"]}
    lines = benign_table(cases, results)
    assert len(lines) == len(BENIGN) + 4
    assert "`scan.moved` 1 of 7" in lines[2]
    assert lines[-1].startswith(f"{len(cases)} sets in order: of 1 a cause was told")


def test_the_first_cause_is_the_first_code_that_claims_one():
    assert "scan.moved" in CLAIMS and "part.material_assumed" not in CLAIMS
    assert (
        first_cause({"first": ["part.material_assumed", "scan.scale_weak", "scan.moved", "scan.drifted"]})
        == "scan.moved"
    )
    assert first_cause({"first": ["scan.scale_weak"]}) == ""


def test_the_table_of_first_causes_tells_which_others_were_told():
    cases = [case for case in first_cases() if case.effect in ("JPEG", "speckle")]
    results = {case.name: {"first": ["scan.compressed"]} for case in cases}
    lines = first_table(cases, results)
    assert "| JPEG | quality 30 | 5 of 5 | – |" in lines
    assert "| speckle | contrast 0.6 | 0 of 5 | scan.compressed |" in lines
    assert lines[-1].endswith(
        "0 are right within half their U and nothing is told of them. Of the others, the first "
        "cause told of 5 is the true one (50%)."
    )
    harmless = {case.name: {"first": [], "error": 0.01, "U": 0.08} for case in cases if case.effect == "speckle"}
    assert first_table(cases, {**results, **harmless})[-1].endswith("of 5 is the true one (100%).")


@pytest.mark.accuracy
@pytest.mark.parametrize("kind", ["table tilted to the right", "oblique sheets", "150 frames"])
def test_nothing_is_told_of_a_set_that_is_in_order(kind, tmp_path):
    case = next(case for case in benign_cases() if case.strength == kind)
    figures = figures_of(case, tmp_path)
    assert false_causes(kind, figures) == []
    assert abs(figures["error"]) <= figures["U"]
