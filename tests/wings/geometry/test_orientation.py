"""Parallelism and perpendicularity to a datum, on scans of known truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.inspect.conformity import Limits, Verdict
from core.inspect.evaluate import evaluate
from core.inspect.fit.surface_fit import range_of
from core.inspect.plan.feature_spec import Auto, FeatureSpec, Filters, InSphere, Polygon
from core.inspect.plan.inspection_plan import InspectionPlan
from tests.inspect.block_scan import HALF, NORMAL, TABLE_MM, BlockScan, axes, cloud_at
from tests.inspect.shape_scan import PIN, PIN_AXIS, ShapeScan

BLOCK = BlockScan(sweeps=24)
ERRORS = BLOCK.errors(12.0)
TOP = Polygon(tuple((float(u), float(v)) for u, v in BLOCK.polygons[0]))
CELLS = Filters(cell_mm=5.0)
PLANES = (FeatureSpec("top", "plane", (TOP,), filters=CELLS), FeatureSpec("table", "plane", (Auto(1),)))
PARALLEL = FeatureSpec("lie", "parallelism", of=("top", "table"))


def tilted(rad, seed, **settings):
    """The block with its top turned about an axis in the table's plane, and the true heights of all points over it."""
    heights = np.where(BLOCK.upper, rad * ((BLOCK.points - TABLE_MM * NORMAL) @ axes()[0]), 0.0)
    rays = BLOCK.points / BLOCK.points[:, 2:]
    return BLOCK.measure(np.random.default_rng(seed), shift=heights / (rays @ NORMAL), **settings), heights


def parallelism(cloud, *more):
    inspection = evaluate(InspectionPlan((*PLANES, replace(PARALLEL, limits=more))), cloud, errors=ERRORS)
    assert inspection.problems == ()
    return inspection.characteristics[-1], inspection.results[0].indices


def test_a_face_that_lies_askew_is_as_wide_as_its_tilt_times_its_length():
    cloud, heights = tilted(0.004, seed=1)
    found, used = parallelism(cloud)
    true = range_of(cloud.select(used), heights[used], CELLS.cell_mm).value
    assert found.name == "lie parallelism"
    assert 0.7 < true / (0.004 * 2 * HALF) < 0.96
    assert found.value == pytest.approx(true, abs=2 * found.u)
    assert 0.02 < found.u < 0.1


def test_a_parallel_face_is_little_wider_than_its_flatness_and_only_an_upper_limit_counts():
    cloud, _ = tilted(0.0, seed=1)
    found, _ = parallelism(cloud, ("parallelism", Limits(0.0, -np.inf, 0.5)))
    flatness = evaluate(InspectionPlan(PLANES), cloud, errors=ERRORS).characteristics[0]
    assert 0.8 * flatness.value < found.value < flatness.value + 6 * found.u
    assert found.verdict == Verdict.CONFORMING


@pytest.mark.accuracy
@pytest.mark.parametrize("rad", [0.0, 0.005, 0.02])
def test_parallelism_scatters_as_much_as_its_uncertainty_says(rad):
    found = [parallelism(tilted(rad, seed)[0])[0] for seed in range(12)]
    values, stated = np.array([row.value for row in found]), np.array([row.u for row in found])
    assert 0.4 < values.std(ddof=1) / np.sqrt(np.mean(stated**2)) < 1.3


def corner(rad):
    """A floor and a wall that leans from its perpendicular by an angle, without errors, and where their middles are."""
    floor, across = NORMAL, axes()[0]
    up = -np.cos(rad) * floor + np.sin(rad) * across
    grid = np.stack(np.meshgrid(np.arange(1, 40.0), np.arange(-20.0, 20.0)), axis=-1).reshape(-1, 2)
    foot = TABLE_MM * floor
    on_floor = foot + grid[:, :1] * across + grid[:, 1:] * axes()[1]
    on_wall = foot + grid[:, :1] * up + grid[:, 1:] * axes()[1]
    return cloud_at(np.vstack([on_floor, on_wall])), foot + 20.0 * across, foot + 20.0 * up


@pytest.mark.parametrize("rad", [0.0, 0.003, -0.003])
def test_a_wall_that_leans_from_the_floor_is_not_perpendicular(rad):
    cloud, floor, wall = corner(rad)
    regions = [(InSphere(tuple(place), 15.0),) for place in (floor, wall)]
    features = (
        FeatureSpec("floor", "plane", regions[0]),
        FeatureSpec("wall", "plane", regions[1]),
        FeatureSpec("stand", "perpendicularity", of=("wall", "floor")),
    )
    inspection = evaluate(InspectionPlan(features), cloud)
    assert inspection.problems == ()
    length = np.ptp(cloud.points[inspection.results[1].indices] @ NORMAL)
    assert inspection.characteristics[-1].value == pytest.approx(abs(rad) * length, rel=0.15, abs=1e-6)


def test_of_an_axis_it_is_the_angle_times_the_length_that_was_scanned():
    scan = ShapeScan()
    low, high = scan.uv[scan.on == 1].min(axis=0) - 3, scan.uv[scan.on == 1].max(axis=0) + 3
    around = Polygon(((low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])))
    features = (
        FeatureSpec("pin", "cylinder", (around,)),
        FeatureSpec("table", "plane"),
        FeatureSpec("lean", "angle", of=("pin", "table")),
        FeatureSpec("lie", "parallelism", of=("pin", "table")),
    )
    inspection = evaluate(InspectionPlan(features), scan.measure(np.random.default_rng(2)), errors=scan.errors)
    lean, lie = inspection.characteristics[-2:]
    length = np.ptp(((scan.points - PIN) @ PIN_AXIS)[inspection.results[0].indices])
    assert lie.value == pytest.approx(length * np.sin(lean.value), rel=0.01)
    assert lie.u == pytest.approx(length * lean.u, rel=0.02)
    assert lie.value < 4 * lie.u  # the pin lies parallel to the table


def test_what_lies_far_from_the_direction_asked_for_is_refused_with_what_to_do():
    cloud, _ = tilted(0.0, seed=1)
    plan = InspectionPlan((*PLANES, FeatureSpec("stand", "perpendicularity", of=("top", "table"))))
    problem = evaluate(plan, cloud, errors=ERRORS).problems[0]
    assert "top lies at 0° to table" in str(problem)
    assert "choose another datum" in str(problem)
