"""Sphere, cylinder, plane and what is derived from them, on scans of known truth: right, and as sure as they say."""

import numpy as np
import pytest

from core.errors import InputError
from core.inspect.evaluate import evaluate
from core.inspect.fit.round import find_cylinder
from core.inspect.plan.feature_spec import Cut, FeatureSpec, InBox, InSphere, Polygon, Section
from core.inspect.plan.inspection_plan import InspectionPlan, PartFrame
from core.scan.surface.cloud import Cloud
from tests.inspect.block_scan import CENTRE, FOCAL
from tests.inspect.shape_scan import BALL, PIN, PIN_AXIS, ShapeScan

SCAN = ShapeScan()


def around(which):
    """A polygon about all points of the ball (0) or the pin (1)."""
    low, high = SCAN.uv[SCAN.on == which].min(axis=0) - 3, SCAN.uv[SCAN.on == which].max(axis=0) + 3
    return Polygon(((low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])))


ELEMENTS = (
    FeatureSpec("ball", "sphere", (around(0),)),
    FeatureSpec("pin", "cylinder", (around(1),)),
    FeatureSpec("table", "plane"),
)
DERIVED = (
    FeatureSpec("ball height", "distance", of=("ball", "table")),
    FeatureSpec("pin height", "distance", of=("table", "pin")),
    FeatureSpec("gap", "distance", of=("ball", "pin")),
    FeatureSpec("lean", "angle", of=("pin", "table")),
)
ACROSS = np.array([np.cos(0.4), np.sin(0.4), 0.0])
ENDS = [tuple(end[:2] / end[2] * FOCAL + CENTRE) for end in (BALL - 30 * ACROSS, BALL + 30 * ACROSS)]
THROUGH_BALL = Section((ENDS[0], ENDS[1]), half_width_mm=1.0, cuts=(Cut("round", "radius", (14.0, 46.0)),))
BETWEEN = BALL - PIN
TRUTH = {
    "ball diameter": 40.0,
    "pin diameter": 30.0,
    "ball height distance": 20.0,
    "pin height distance": 15.0,
    "gap distance": float(np.linalg.norm(BETWEEN - PIN_AXIS * (PIN_AXIS @ BETWEEN))),
    "lean angle": 0.0,
}


@pytest.mark.accuracy
def test_errors_are_as_large_as_the_stated_uncertainties():
    plan, relative = InspectionPlan((*ELEMENTS, *DERIVED)), {name: [] for name in TRUTH}
    for seed in range(10):
        inspection = evaluate(plan, SCAN.measure(np.random.default_rng(seed), outliers=0.01), errors=SCAN.errors)
        assert inspection.problems == ()
        for row in inspection.characteristics:
            if row.name in TRUTH:
                relative[row.name].append((row.value - TRUTH[row.name]) / row.u)
    spread = {name: float(np.sqrt(np.mean(np.square(values)))) for name, values in relative.items()}
    assert all(0.4 < value < 1.7 for value in spread.values()), spread  # each of 10 scans
    together = float(np.sqrt(np.mean(np.square(list(spread.values())))))
    assert 0.75 < together < 1.2, spread


def test_regions_in_part_coordinates_hold_what_lies_there():
    frame = PartFrame("table", "pin", "ball")  # z up from the table, x along the pin, x = 0 beside the ball
    cloud = SCAN.measure(np.random.default_rng(1))
    pose = evaluate(InspectionPlan(ELEMENTS, frame), cloud, errors=SCAN.errors).pose_camera_part
    assert pose is not None
    assert pose.rotation[:, 2] == pytest.approx([0.0, 0.0, -1.0], abs=1e-3)
    assert abs(pose.rotation[:, 0] @ PIN_AXIS) == pytest.approx(1.0, abs=1e-5)
    across = BETWEEN - PIN_AXIS * (PIN_AXIS @ BETWEEN)
    x, y, z = pose.inverse().apply(BALL[None])[0]
    assert (x, abs(y), z) == pytest.approx((0.0, np.linalg.norm(across[:2]), 20.0), abs=0.05)
    again = (
        FeatureSpec("again", "sphere", (InSphere((0.0, float(y), 20.0), 20.5),)),
        FeatureSpec("spot", "point", (InBox((-4.0, float(y) / 2 - 4, -1.0), (4.0, float(y) / 2 + 4, 1.0)),)),
    )
    inspection = evaluate(InspectionPlan((*ELEMENTS, *again), frame), cloud, errors=SCAN.errors)
    assert inspection.problems == ()
    assert np.mean(SCAN.on[inspection.result("again").indices] == 0) > 0.99
    assert inspection.result("again").shape.radius == pytest.approx(20.0, abs=0.03)
    assert inspection.result("spot").element.position[2] == pytest.approx(545.0, abs=0.05)


def test_the_section_through_a_ball_has_its_radius():
    relative = []
    for seed in range(6):
        cloud = SCAN.measure(np.random.default_rng(seed))
        inspection = evaluate(
            InspectionPlan((FeatureSpec("cut", "section", section=THROUGH_BALL),)), cloud, errors=SCAN.errors
        )
        (row,) = inspection.characteristics
        relative.append((row.value - 20.0) / row.u)
        assert row.u < 0.4
    assert np.sqrt(np.mean(np.square(relative))) < 1.8


def test_a_bore_is_a_cylinder_seen_from_inside():
    rng = np.random.default_rng(0)
    angle, along = rng.uniform(-1.0, 1.0, 3000), rng.uniform(-20, 20, 3000)
    radial = np.column_stack([np.sin(angle), np.zeros(3000), np.cos(angle)])
    points = np.array([0.0, 0.0, 500.0]) + 10.0 * radial + along[:, None] * [0.0, 1.0, 0.0]
    points += rng.normal(0, 0.01, 3000)[:, None] * radial
    index, uv = np.arange(3000), points[:, :2] / points[:, 2:] * 2500
    cloud = Cloud(points, uv, np.full(3000, 0.01), np.ones(3000), index, index, -radial)
    found, tube = find_cylinder(cloud, on_table=False)
    assert len(found) > 2900
    assert tube.radius == pytest.approx(10.0, abs=0.01)
    assert abs(tube.direction[1]) == pytest.approx(1.0, abs=1e-4)


def test_no_cylinder_is_said():
    flat = SCAN.measure(np.random.default_rng(0)).select(SCAN.on == 2)
    with pytest.raises(InputError, match="on a cylinder"):
        find_cylinder(flat, on_table=False)
