"""Uneven light makes everything round less sure: its radius, and its centre along the line of sight."""

from dataclasses import replace

import numpy as np
import pytest

from core.inspect.causes import Cause
from core.inspect.evaluate import evaluate
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from tests.inspect.test_shape_features import DERIVED, ELEMENTS, SCAN, THROUGH_BALL


@pytest.fixture(scope="module")
def shares():
    """What uneven light contributes to each characteristic, in mm or rad."""
    plan = InspectionPlan((*ELEMENTS, *DERIVED, FeatureSpec("cut", "section", section=THROUGH_BALL)))
    errors = replace(SCAN.errors, stripe_px=3.0)
    inspection = evaluate(plan, SCAN.measure(np.random.default_rng(2)), errors=errors)
    assert inspection.problems == ()
    return {
        row.name: sum(part.u_mm for part in row.budget if part.source == Cause.UNEVEN_LIGHT)
        for row in inspection.characteristics
    }


def test_every_radius_counts_it(shares):
    assert all(shares[name] > 0.005 for name in ("ball diameter", "pin diameter", "cut round")), shares
    assert shares["table flatness"] == 0


def test_the_top_stays_where_it_is_so_a_centre_moves_as_far_as_the_radius_grows(shares):
    for name in ("ball", "pin"):
        assert shares[f"{name} height distance"] == pytest.approx(shares[f"{name} diameter"] / 2, rel=0.02)


def test_an_axis_does_not_lean(shares):
    assert shares["lean angle"] == pytest.approx(0.0, abs=1e-12)
