"""What notes ask for helps: a set is rendered again with it, and its error or U is smaller."""

import pytest

from tests.accuracy.hostile import figures_of
from tests.accuracy.hostile_cases import EFFECTS
from tests.accuracy.remedies import REMEDIES, after, before, helps, remedies_table

WRONG, RIGHT = {"error": 0.05, "U": 0.2}, {"error": -0.01, "U": 0.3}


def test_a_remedy_helps_if_error_or_u_is_smaller_or_something_is_measured():
    assert helps(WRONG, RIGHT) and helps(RIGHT, WRONG)
    assert helps({"refused": "scan.no_points"}, RIGHT)
    assert not helps(WRONG, {"refused": "scan.no_points"}) and not helps(WRONG, WRONG)


def test_each_remedy_changes_the_set_and_most_effects_have_one():
    assert all(before(one).scenario != after(one).scenario for one in REMEDIES)
    assert len({one.of for one in REMEDIES} & {effect.title for effect in EFFECTS}) >= 22


def test_the_table_has_a_line_for_each_remedy_that_was_tried():
    first = REMEDIES[0]
    lines = remedies_table({before(first).name: WRONG, after(first).name: {"refused": "x.y"}})
    assert lines[2:] == [f"| {first.of} | {first.asked} | +50.0, 200.0 | refused | **no** |"]


@pytest.mark.accuracy
@pytest.mark.parametrize("remedy", REMEDIES, ids=lambda one: one.of)
def test_what_is_asked_for_helps(remedy, tmp_path):
    assert helps(figures_of(before(remedy), tmp_path), figures_of(after(remedy), tmp_path))
