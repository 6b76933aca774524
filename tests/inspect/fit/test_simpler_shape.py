"""What a plane explains is no sphere, cylinder or arc; what is curved beyond its noise is."""

from dataclasses import replace

import numpy as np
import pytest

from core.inspect.evaluate import evaluate
from core.inspect.plan.feature_spec import Cut, FeatureSpec, InSphere, PointsOf, Section
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.uncertainty.point_errors import PointErrors
from tests.inspect.block_scan import HALF, NORMAL, TABLE_MM, BlockScan, axes, pixels

BLOCK = BlockScan(height=40.0, sweeps=30)
ERRORS = PointErrors(BLOCK.covariance)
MIDDLE = (TABLE_MM - BLOCK.height) * NORMAL
ON_TOP = InSphere((*MIDDLE.tolist(),), 35.0)
TOP = FeatureSpec("top", "plane", (ON_TOP,))
ENDS = pixels(MIDDLE + np.array([[-HALF], [HALF]]) * axes()[0] * 0.9).tolist()
ARC = Section((tuple(ENDS[0]), tuple(ENDS[1])), half_width_mm=4.0, cuts=(Cut("arc", "radius", (3.0, 50.0)),))


@pytest.mark.parametrize("kind", ["sphere", "cylinder"])
@pytest.mark.parametrize("region", [None, ON_TOP, PointsOf("top")], ids=["found", "region", "points of"])
def test_no_round_shape_is_told_from_a_flat_face(kind: str, region: InSphere | PointsOf | None) -> None:
    cloud = BLOCK.measure(np.random.default_rng(1))
    asked = FeatureSpec("ball", kind) if region is None else FeatureSpec("ball", kind, (region,))
    inspection = evaluate(InspectionPlan((TOP, asked)), cloud, errors=ERRORS)
    assert len(inspection.problems) == 1
    assert inspection.result("ball").characteristics == ()


def test_points_of_a_face_are_said_to_be_flat() -> None:
    cloud = BLOCK.measure(np.random.default_rng(2))
    asked = FeatureSpec("ball", "sphere", (PointsOf("top"),))
    (problem,) = evaluate(InspectionPlan((TOP, asked)), cloud, errors=ERRORS).problems
    assert "flat within their noise" in str(problem)


def test_no_radius_is_told_from_a_straight_stretch() -> None:
    plan = InspectionPlan((FeatureSpec("cut", "section", (ON_TOP,), section=ARC),))
    (problem,) = evaluate(plan, BLOCK.measure(np.random.default_rng(3)), errors=ERRORS).problems
    assert "flat within their noise" in str(problem)


def test_a_face_bowed_beyond_its_noise_is_a_sphere_of_a_large_radius() -> None:
    cloud = BLOCK.measure(np.random.default_rng(4))
    flat = (BLOCK.points - MIDDLE) @ axes().T
    height = np.where(BLOCK.upper, -(flat**2).sum(axis=1) / 2 / 200.0, 0.0)
    bowed = replace(cloud, points=cloud.points * (1 - height / cloud.points[:, 2])[:, None])
    plan = InspectionPlan((TOP, FeatureSpec("ball", "sphere", (PointsOf("top"),))))
    (row,) = (one for one in evaluate(plan, bowed, errors=ERRORS).characteristics if one.kind == "diameter")
    assert abs(row.value - 400.0) < 3 * row.u
