"""Proof on the twin: a block turned over on its carrier, both views rendered; hours at full size, here a quarter."""

import numpy as np
import pytest

from core.errors import InputError
from core.views.thickness import require_turned
from tests.accuracy.joints import figures, joint_by_marks, marks_alone, measure_joint, scenario


@pytest.mark.accuracy
@pytest.mark.parametrize("seed", [1, 2])
def test_the_thickness_across_two_views_is_within_its_U(seed, tmp_path):
    found = figures(*measure_joint(scenario(seed, 0.25), tmp_path))
    assert abs(found["error"]) <= found["U"]
    assert found["U"] < 0.12
    assert set(found["doubts"]) <= {"slip_unseen", "part_may_have_slipped"}
    assert min(found["marks"]) >= 9
    assert {"joint: marks", "joint: carrier"} <= set(found["budget"])


@pytest.mark.accuracy
def test_the_joint_by_rendered_rings_errs_as_it_states():
    found = [marks_alone(seed, 0.25) for seed in range(1, 9)]
    assert 0.5 < np.sqrt(np.mean([(one["error"] / one["u"]) ** 2 for one in found])) < 1.5
    assert [one["told"] for one in found if one["told"]] == []


@pytest.mark.accuracy
@pytest.mark.parametrize("effect", [{"moved_mm": 0.2}, {"bent_mm": 0.1}, {"smeared": 2}], ids=str)
def test_a_hurt_carrier_is_told_or_the_joint_is_within_its_U(effect):
    for seed in (1, 2):
        found = marks_alone(seed, 0.5, **effect)
        assert found["told"] or abs(found["error"]) <= found["U"]


@pytest.mark.accuracy
def test_a_part_that_was_not_turned_over_has_no_thickness_across():
    require_turned(joint_by_marks(scenario(1, 0.25, 0)))
    with pytest.raises(InputError, match="turned: it shows side A of the carrier, as the first view does"):
        require_turned(joint_by_marks(scenario(1, 0.25, 0, again=True)))


@pytest.mark.accuracy
def test_a_part_that_has_slipped_through_its_carrier_is_measured_wrong_by_that_and_proves_nothing(tmp_path):
    slipped = 2.0
    found = figures(*measure_joint(scenario(1, 0.25, slipped_mm=slipped), tmp_path))
    assert abs(abs(found["error"]) - slipped) <= found["U"]
    assert found["doubts"] != []
