"""Position of a pin and a ball to the datums of the part's coordinates, on scans of known truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.inspect.conformity import Limits, Verdict
from core.inspect.evaluate import evaluate
from core.inspect.plan.conditions import Temperature
from core.inspect.plan.feature_spec import FeatureSpec, Polygon, Position
from core.inspect.plan.inspection_plan import InspectionPlan, PartFrame
from core.inspect.uncertainty.budget import budget_of, combined
from tests.inspect.block_scan import NORMAL, TABLE_MM, axes, cloud_at
from tests.inspect.shape_scan import ShapeScan

# ---- a floor, two walls, a pin and a ball without errors: part coordinates have z up and x, y into the walls' corner

CORNER = TABLE_MM * NORMAL
ACROSS, ALONG = axes()
UP = -NORMAL
APART = 4000.0
PIN, BALL, RADIUS = np.array([50.0, 40.0, 20.0]), np.array([70.0, 70.0, 25.0]), 10.0


def of_part(places):
    """Part coordinates (N, 3) in the camera frame: right-handed with z up."""
    return CORNER + np.asarray(places) @ np.array([ACROSS, np.cross(UP, ACROSS), UP])


def part(lean=0.0):
    grid = np.stack(np.meshgrid(np.arange(2, 60.0), np.arange(2, 60.0)), axis=-1).reshape(-1, 2)
    zero = np.zeros((len(grid), 1))
    angle, along = np.meshgrid(np.linspace(0, 2 * np.pi, 40, endpoint=False), np.arange(-15.0, 16.0, 1.5))
    angle, along = angle.ravel(), along.ravel()
    axis = np.array([np.sin(lean), 0.0, np.cos(lean)])
    aside = np.cross([0.0, 1.0, 0.0], axis)
    outward = np.cos(angle)[:, None] * aside + np.sin(angle)[:, None] * [0.0, 1.0, 0.0]
    pin = PIN + RADIUS * outward + along[:, None] * axis
    height = np.random.default_rng(0).uniform(-1, 1, len(angle))
    ring = np.sqrt(1 - height**2)
    round_ball = np.column_stack([ring * np.cos(angle), ring * np.sin(angle), height])
    ball = BALL + RADIUS * round_ball
    low = grid[:, 1:] < 30
    walls = [
        np.hstack([zero, grid])[low.ravel()],
        np.column_stack([grid[:, 0], 0 * grid[:, 0], grid[:, 1]])[low.ravel()],
    ]
    surfaces = [np.hstack([grid, zero]), *walls, pin, ball]
    cloud = cloud_at(of_part(np.vstack(surfaces)))
    normals = [np.tile(axis, (len(one), 1)) for axis, one in zip(np.eye(3)[[2, 0, 1]], surfaces, strict=False)]
    turned = of_part(np.vstack([*normals, outward, round_ball])) - CORNER
    number = np.repeat(np.arange(len(surfaces)), [len(one) for one in surfaces])
    return replace(cloud, normals=turned, uv=cloud.uv + np.column_stack([APART * number, 0 * number]))


def surface(number):
    """The region of one of them: none hides another, as if each had a picture of its own."""
    low, high = APART * number, APART * (number + 1)
    return (Polygon(((low, -APART), (high, -APART), (high, APART), (low, APART))),)


FACES = tuple(FeatureSpec(name, "plane", surface(number)) for number, name in enumerate(("floor", "left", "front")))
FRAME = PartFrame("floor", "left", "front")
REGIONS = {"pin": surface(3), "ball": surface(4), "spot": surface(0)}


def position(kind, item, true, frame=FRAME, *, lean=0.0, **more):
    features = (
        *FACES,
        FeatureSpec(item, kind, REGIONS[item]),
        FeatureSpec("lies", "position", of=(item,), position=Position(tuple(true))),
    )
    return evaluate(InspectionPlan(features, frame, **more), part(lean))


def value(inspection):
    assert inspection.problems == ()
    return inspection.characteristics[-1].value


def coordinates(inspection, name):
    return inspection.pose_camera_part.inverse().apply(inspection.result(name).element.position)


def test_of_a_ball_it_is_twice_the_distance_of_the_centre_from_its_true_place():
    found = coordinates(position("sphere", "ball", BALL), "ball")
    assert np.allclose(np.abs(found), BALL, atol=0.01)
    assert value(position("sphere", "ball", found + [0.3, 0.0, -0.4])) == pytest.approx(1.0, abs=1e-6)


def test_of_a_pin_only_what_is_square_to_the_true_axis_counts():
    found = coordinates(position("cylinder", "pin", PIN), "pin")
    assert value(position("cylinder", "pin", found + [0.3, -0.4, 7.0])) == pytest.approx(1.0, abs=1e-3)


def test_along_a_direction_that_no_datum_fixes_the_zone_is_free():
    """Without a tertiary feature the origin lies beside the middle of what was scanned: no place to measure from."""
    two = PartFrame("floor", "left")
    found = coordinates(position("sphere", "ball", BALL, two), "ball")
    assert value(position("sphere", "ball", found + [0.3, 7.0, -0.4], two)) == pytest.approx(1.0, abs=1e-6)
    assert value(position("sphere", "ball", found + [0.3, 7.0, -0.4])) > 10


def test_of_a_pin_that_leans_the_end_farther_off_counts():
    inspection = position("cylinder", "pin", PIN, lean=0.01)
    found = coordinates(inspection, "pin")
    used = part(0.01).points[inspection.result("pin").indices]
    length = np.ptp((used - CORNER) @ UP)
    leaning = value(position("cylinder", "pin", found, lean=0.01))
    assert leaning == pytest.approx(0.01 * length, rel=0.1)


def test_a_warm_part_is_judged_as_it_would_be_at_20_degrees():
    found = coordinates(position("sphere", "ball", BALL), "ball")
    warm = Temperature(part_celsius=70.0, u_part_celsius=1.0, alpha=20e-6, u_alpha=1e-6)
    inspection = position("sphere", "ball", found - [0.5, 0.0, 0.0], temperature=warm)
    grown = found[0] * 20e-6 * 50
    assert value(inspection) == pytest.approx(2 * (0.5 - grown), abs=1e-3)
    assert any("20 °C" in str(note) for note in inspection.characteristics[-1].notes)
    assert inspection.characteristics[-1].at_20


@pytest.mark.parametrize(
    ("item", "frame", "said"),
    [
        (("cylinder", "pin"), None, "the plan has no part coordinates"),
        (("sphere", "ball"), PartFrame("floor", "left", "ball"), "part coordinates rest on ball itself"),
        (("point", "spot"), FRAME, "spot is neither a cylinder nor a sphere"),
    ],
)
def test_what_has_no_position_is_told_why(item, frame, said):
    assert said in str(position(*item, PIN, frame).problems[0])


# ---- a scan with errors

SCAN = ShapeScan()


def around(number):
    low, high = SCAN.uv[SCAN.on == number].min(axis=0) - 3, SCAN.uv[SCAN.on == number].max(axis=0) + 3
    return (Polygon(((low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1]))),)


PARTS = (
    FeatureSpec("ball", "sphere", around(0)),
    FeatureSpec("pin", "cylinder", around(1)),
    FeatureSpec("table", "plane"),
)


def scanned(seed, place, *limits):
    """The ball's position, from the table and the pin that lies on it."""
    asked = FeatureSpec("lies", "position", of=("ball",), position=Position(tuple(place)), limits=limits)
    plan = InspectionPlan((*PARTS, asked), PartFrame("table", "pin"))
    return evaluate(plan, SCAN.measure(np.random.default_rng(seed)), errors=SCAN.errors)


def test_the_datums_are_in_its_uncertainty_and_only_an_upper_limit_counts():
    place = coordinates(scanned(0, (0.0, 0.0, 0.0)), "ball") + [0.0, 0.5, 0.0]
    inspection = scanned(0, place, ("position", Limits(0.0, -np.inf, 2.0)))
    found = inspection.characteristics[-1]
    assert found.value == pytest.approx(1.0, abs=1e-6)
    assert found.verdict == Verdict.NOT_PROVEN, "these points know nothing of camera and fan"
    assert replace(found, notes=(), doubts=()).verdict == Verdict.CONFORMING
    ball = inspection.result("ball").element
    across = inspection.pose_camera_part.rotation[:, 1]
    assert found.u > 1.2 * combined(budget_of([(2 * across @ ball.position_gradient, ball.effects)]))


@pytest.mark.accuracy
@pytest.mark.parametrize("off", [(0.0, 0.5, 0.0), (0.0, 0.0, 0.5)])
def test_position_scatters_as_much_as_its_uncertainty_says(off):
    place = np.mean([coordinates(scanned(seed, (0.0, 0.0, 0.0)), "ball") for seed in range(12)], axis=0)
    rows = [scanned(seed, place + off).characteristics[-1] for seed in range(12)]
    values, stated = np.array([row.value for row in rows]), np.array([row.u for row in rows])
    assert 0.4 < values.std(ddof=1) / np.sqrt(np.mean(stated**2)) < 1.3
