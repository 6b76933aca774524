"""One entry registers a kind of feature: plan, measurement, verdict and files know it without another word."""

import inspect
import math

import numpy as np
import pytest

from core.errors import InputError
from core.files.plan.plan_file import read_plan, write_plan
from core.files.results.inspection_file import read_inspection, write_inspection
from core.inspect.conformity import Limits
from core.inspect.evaluate import evaluate
from core.inspect.plan.conditions import Temperature
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.plan.kinds import KINDS
from tests.inspect.block_scan import BlockScan
from tests.inspect.plan.toy_kind import toy

__all__ = ["toy"]

PLAN = """
[[feature]]
name = "mist"
kind = "cloudlet"
limits.spread = { tolerance_mm = 60 }
limits.slope = { nominal_deg = 5, tolerance_deg = 10 }
"""


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_every_kind_is_measured_by_a_function_of_a_feature_and_a_scene(kind):
    assert list(inspect.signature(kind.measure).parameters) == ["spec", "scene"]
    assert kind.title and kind.help and kind.icon.startswith("mdi6.")


def test_a_kind_that_is_registered_goes_from_plan_to_result_file(toy, tmp_path):
    path = tmp_path / "plan.toml"
    path.write_text(PLAN)
    plan = read_plan(path)
    assert plan.features[0].limits_of("spread") == Limits(0.0, -math.inf, 60.0), "it cannot be too small"
    assert plan.features[0].limits_of("slope").upper == pytest.approx(math.radians(10))
    write_plan(path, plan)
    assert read_plan(path) == plan
    inspection = evaluate(plan, BlockScan(sweeps=6).measure(np.random.default_rng(1)))
    spread, slope = inspection.characteristics
    assert (spread.name, spread.quantity, slope.quantity) == ("mist spread", "length", "angle")
    assert 30 < spread.value < 100
    write_inspection(tmp_path / "inspection.json", inspection)
    again = read_inspection(tmp_path / "inspection.json")
    assert again.kinds == {"mist": "cloudlet"}
    assert [row.value for row in again.characteristics] == [spread.value, slope.value]


def test_what_expands_is_stated_at_20_degrees(toy):
    hot = Temperature(part_celsius=120.0, u_part_celsius=0.0, alpha=1e-3, u_alpha=0.0)
    cloud = BlockScan(sweeps=6).measure(np.random.default_rng(1))
    spec = FeatureSpec("mist", toy.name)
    cold, as_is = (evaluate(InspectionPlan((spec,), temperature=one), cloud).characteristics for one in (hot, None))
    assert cold[0].value == pytest.approx(0.9 * as_is[0].value)
    assert cold[1].value == as_is[1].value


def test_others_cannot_be_made_of_what_gives_no_place(toy):
    features = (FeatureSpec("a", toy.name), FeatureSpec("b", "point"), FeatureSpec("d", "distance", of=("a", "b")))
    with pytest.raises(InputError, match="no distance is made of that"):
        InspectionPlan(features).ordered()


def test_an_unknown_kind_is_refused_with_those_there_are(tmp_path):
    (tmp_path / "plan.toml").write_text(PLAN)
    with pytest.raises(InputError, match="plane, sphere, cylinder"):
        read_plan(tmp_path / "plan.toml")
