"""What notes ask for helps: a set is rendered again with it, and measured better by more than chance."""

import pytest

from tests.accuracy.hostile import figures_of
from tests.accuracy.hostile_cases import EFFECTS
from tests.accuracy.remedies import REMEDIES, after, before, helps, remedies_table, suffices

WRONG = {"error": 0.05, "U": 0.2, "verdict": "not proven"}
RIGHT = {"error": -0.01, "U": 0.15, "verdict": "conforming"}
REFUSED = {"refused": "scan.no_points"}


def test_a_remedy_helps_if_nothing_is_worse_and_error_or_u_clearly_better():
    assert helps({**WRONG, "verdict": ""}, {**RIGHT, "verdict": ""})
    assert helps(RIGHT, {**RIGHT, "U": 0.9 * 0.15 - 1e-6})
    assert not helps(RIGHT, RIGHT) and not helps(RIGHT, REFUSED)
    assert not helps(RIGHT, {**RIGHT, "error": 0.009, "U": 0.149})  # by chance
    assert not helps(RIGHT, {**RIGHT, "error": 0.0, "U": 0.16})
    assert not helps(RIGHT, {**RIGHT, "error": 0.03, "U": 0.1})


def test_where_a_part_conforms_already_a_remedy_need_only_do_no_harm():
    assert suffices(RIGHT, RIGHT) and not suffices(WRONG, WRONG)
    assert not suffices(RIGHT, {**RIGHT, "verdict": "not proven"}) and not suffices(RIGHT, REFUSED)
    assert not suffices(RIGHT, {**RIGHT, "error": 0.03})


def test_a_remedy_helps_if_conformity_is_proven_that_was_not():
    assert helps(REFUSED, RIGHT) and helps(WRONG, {**RIGHT, "error": 0.06, "U": 0.25})
    assert not helps(REFUSED, WRONG) and not helps(WRONG, REFUSED) and not helps(REFUSED, REFUSED)


def test_each_remedy_changes_the_set_and_most_effects_have_one():
    """Of those by which a thickness gets worse: a shadow and coma leave nothing to gain."""
    assert not {one.of for one in REMEDIES} & {"a shadow that passes", "coma"}
    assert all(before(one).scenario != after(one).scenario for one in REMEDIES)
    assert len({one.of for one in REMEDIES} & {effect.title for effect in EFFECTS}) >= 20


def test_the_table_has_a_line_for_each_remedy_that_was_tried():
    first = REMEDIES[0]
    lines = remedies_table({before(first).name: WRONG, after(first).name: {"refused": "x.y"}})
    assert lines[2:] == [f"| {first.of} | {first.asked} | +50.0, 200.0 | refused | **no** |"]


@pytest.mark.accuracy
@pytest.mark.parametrize("remedy", REMEDIES[::4], ids=lambda one: one.of)
def test_what_is_asked_for_helps(remedy, tmp_path):
    """A quarter of them, more than `tests.shared.ENOUGH`; `python -m tests.accuracy remedies` tries each of them."""
    assert suffices(figures_of(before(remedy), tmp_path), figures_of(after(remedy), tmp_path))
