"""The nearest place on a nominal surface, laying it on a scan, and what the comparison says."""

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from core.errors import InputError
from core.inspect.causes import Cause
from core.inspect.evaluate import evaluate
from core.inspect.plan.alignment import best_fit
from core.inspect.plan.feature_spec import Deviation, FeatureSpec, Polygon
from core.inspect.plan.inspection_plan import InspectionPlan, PartFrame
from core.inspect.shown.deviation_map import classes_of, mark
from core.model import Pose
from core.scan.surface.triangles import ProximityQuery, Triangles
from core.simulate.scene.objects import gauge_block, step_block
from tests.inspect.shape_scan import BALL, BALL_RADIUS, PIN, PIN_AXIS, ShapeScan

STEPS = Triangles(step_block((12.0, 20.0, 31.0), (60.0, 35.0)).triangles)


def test_the_nearest_place_is_that_of_all_triangles():
    rng = np.random.default_rng(0)
    corners = rng.uniform(-10, 10, (60, 1, 3)) + rng.normal(0, [8.0, 1.0, 0.1], (60, 3, 3))  # long and thin ones too
    points = rng.uniform(-15, 15, (300, 3))
    found = ProximityQuery(Triangles(corners)).nearest(points)
    samples = rng.dirichlet([0.4, 0.4, 0.4], 1500)
    dense = np.einsum("sk,tkc->tsc", samples, corners).reshape(-1, 3)
    brute = np.min(np.linalg.norm(points[:, None] - dense[None, ::7], axis=2), axis=1)
    away = np.abs(found.distance)
    assert np.all(away <= brute + 1e-9)
    assert np.mean(brute - away) < 0.5
    assert np.linalg.norm(points - found.foot, axis=1) == pytest.approx(away)


def test_inside_is_negative_and_outside_positive():
    near = ProximityQuery(STEPS).nearest(np.array([[-20.0, 0.0, 13.0], [-20.0, 0.0, 11.5], [0.0, 0.0, 22.0]]))
    assert near.distance == pytest.approx([1.0, -0.5, 2.0])


def seen_from_above(rng, count=2000):
    """Points on the sides of the stepped block that look upwards, to +x or to +y, with noise."""
    normals = STEPS.normals
    seen = normals @ np.array([0.4, 0.3, 1.0]) > 0.1
    corners = STEPS.corners[seen]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    which = rng.choice(len(corners), count, p=area / area.sum())
    points = np.einsum("nk,nkc->nc", rng.dirichlet([1, 1, 1], count), corners[which])
    return points + rng.normal(0, 0.02, count)[:, None] * normals[seen][which]


@pytest.mark.accuracy
@pytest.mark.parametrize("turn", [0.3, -1.7])
def test_a_part_is_found_however_it_lies(turn):
    rng = np.random.default_rng(1)
    lie = Rotation.from_rotvec([0.0, 0.0, turn]) * Rotation.from_rotvec([0.15, -0.1, 0.0])
    rotation, shift = Rotation.from_euler("x", np.pi).as_matrix() @ lie.as_matrix(), np.array([10.0, -20.0, 540.0])
    points = seen_from_above(rng) @ rotation.T + shift
    points[:100] += rng.uniform(-8, 8, (100, 3))
    aligned = best_fit(points, np.array([0.0, 0.0, -1.0]), ProximityQuery(STEPS))
    pose = aligned.pose_camera_nominal
    corners = STEPS.corners.reshape(-1, 3)
    assert np.abs(pose.apply(corners) - (corners @ rotation.T + shift)).max() < 0.03


@pytest.mark.accuracy
def test_a_start_near_another_side_is_not_taken_where_that_leaves_points_off():
    """A block of 70 × 60 × 50, its top and a side scanned: half of the points lie close with either side up."""
    rng = np.random.default_rng(5)
    top = np.column_stack([rng.uniform(-34, 34, (900, 1)), rng.uniform(-29, 29, (900, 1)), np.full(900, 50.0)])
    side = np.column_stack([rng.uniform(-34, 34, (100, 1)), np.full(100, 30.0), rng.uniform(5, 49, (100, 1))])
    down = Pose(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, 500.0]))
    points = down.apply(np.vstack([top, side]) + rng.normal(0, 0.01, (1000, 3)))
    query, up = ProximityQuery(Triangles(gauge_block(50.0).triangles)), np.array([0.0, 0.0, -1.0])
    on_its_side = down @ Pose(Rotation.from_euler("x", 90, degrees=True).as_matrix(), np.array([0.0, 25.0, 20.0]))
    for near in (on_its_side, down):
        found = best_fit(points, up, query, near=near)
        assert np.abs(query.nearest(found.pose_camera_nominal.inverse().apply(points)).distance).max() < 0.06
    assert found.pose_camera_nominal.rotation == pytest.approx(down.rotation, abs=0.01)  # alike sides are not turned


@pytest.mark.accuracy
def test_one_face_alone_is_laid_on_a_face_it_fits_on():
    rng = np.random.default_rng(4)
    points = np.column_stack([rng.uniform(-29, 29, (600, 1)), rng.uniform(-17, 17, (600, 1)), rng.normal(0, 0.01, 600)])
    aligned = best_fit(
        points * [1, -1, -1] + [0, 0, 500], np.array([0.0, 0.0, -1.0]), ProximityQuery(STEPS)
    )  # the bottom is 60 × 35
    assert aligned.left_mm < 0.01
    feet = aligned.pose_camera_nominal.inverse().apply(points * [1, -1, -1] + [0, 0, 500])
    assert np.abs(feet[:, 2]).max() < 0.1


@pytest.mark.accuracy
def test_another_part_is_refused():
    points = np.random.default_rng(2).uniform(-30, 30, (600, 3)) + [0, 0, 500]
    with pytest.raises(InputError, match="cannot be laid"):
        best_fit(points, np.array([0.0, 0.0, -1.0]), ProximityQuery(STEPS))


def test_classes_are_told_apart_by_marks():
    assert [mark(one) for one in (-4, -2, 0, 1, 3, 4)] == ["−!", "−−", "", "+", "+++", "+!"]
    assert classes_of(np.array([-0.3, 0.1, 0.0251, -0.09]), 0.1).tolist() == [-4, 3, 1, -3]


def test_a_ball_too_large_by_a_twentieth_shows_it_with_an_honest_uncertainty():
    scan = ShapeScan()
    mesh = trimesh.creation.icosphere(subdivisions=5, radius=BALL_RADIUS - 0.05)
    nominal = Triangles(np.asarray(mesh.triangles) + BALL)
    spec = FeatureSpec("ball", "deviation", deviation=Deviation("ball.stl", "as measured", 0.1, 1.0))
    plan, relative = InspectionPlan((spec,)), []
    for seed in range(5):
        cloud = scan.measure(np.random.default_rng(seed))
        inspection = evaluate(plan, cloud, errors=scan.errors, nominals={"ball.stl": nominal})
        profile, mean = inspection.characteristics
        relative.append((mean.value - 0.05) / mean.u)
        deviations = inspection.results[0].deviations
        assert scan.on[deviations.vertices].mean() < 0.02  # all but the ball's foot is out of reach
        assert profile.value > 0.1
        edges, counts = deviations.histogram()
        assert counts.sum() == len(deviations.deviation)
        assert edges[np.argmax(counts)] == pytest.approx(0.05, abs=0.03)
    assert 0.4 < np.sqrt(np.mean(np.square(relative))) < 1.6


def test_how_far_triangles_are_off_the_nominal_surface_is_a_row_of_the_budget():
    scan = ShapeScan()
    cloud = scan.measure(np.random.default_rng(0))
    corners = np.asarray(trimesh.creation.icosphere(subdivisions=4, radius=BALL_RADIUS).triangles) + BALL
    spec = FeatureSpec("ball", "deviation", deviation=Deviation("ball.step", "as measured", 0.1, 1.0))
    exact, coarse = (
        evaluate(InspectionPlan((spec,)), cloud, errors=scan.errors, nominals={"ball.step": Triangles(corners, chord)})
        for chord in (0.0, 0.2)
    )
    for before, after, times in zip(exact.characteristics, coarse.characteristics, (2, 1), strict=True):
        row = {row.source: row.u_mm for row in after.budget}
        assert row[Cause.FACETS] == pytest.approx(times * 0.2 / np.sqrt(3))
        assert after.u == pytest.approx(np.hypot(before.u, row[Cause.FACETS]))
        assert Cause.FACETS not in {row.source for row in before.budget}


def test_a_nominal_surface_in_part_coordinates_is_laid_on_by_the_parts_frame():
    """z up from the table, x along the pin, which way is not said: so the nominal ball stands on both sides."""
    scan = ShapeScan(spacing_px=24.0)
    aside = BALL - PIN - PIN_AXIS * (PIN_AXIS @ (BALL - PIN))
    mesh = trimesh.creation.icosphere(subdivisions=4, radius=BALL_RADIUS - 0.05)
    places = [[0.0, side * np.hypot(*aside[:2]), BALL_RADIUS] for side in (-1, 1)]
    nominal = Triangles(np.concatenate([np.asarray(mesh.triangles) + place for place in places]))
    boxes = [
        Polygon(((low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])))
        for low, high in ((scan.uv[scan.on == one].min(axis=0), scan.uv[scan.on == one].max(axis=0)) for one in (0, 1))
    ]
    features = (
        FeatureSpec("table", "plane"),
        FeatureSpec("pin", "cylinder", (boxes[1],)),
        FeatureSpec("ball", "sphere", (boxes[0],)),
        FeatureSpec("form", "deviation", deviation=Deviation("ball.stl", "frame", 0.1, 1.0)),
    )
    cloud, nominals = scan.measure(np.random.default_rng(3)), {"ball.stl": nominal}
    plan = InspectionPlan(features, PartFrame("table", "pin", "ball"))
    inspection = evaluate(plan, cloud, errors=scan.errors, nominals=nominals)
    mean = next(row for row in inspection.characteristics if row.name == "form mean")
    assert mean.value == pytest.approx(0.05, abs=2 * mean.u)
    assert mean.u < 0.025
    used = inspection.result("form").indices
    assert np.mean(scan.on[used] == 0) > 0.98
    without = evaluate(InspectionPlan(features[3:]), cloud, nominals=nominals)
    assert "no part coordinates to align it by" in str(without.problems[0])


def test_without_its_file_a_deviation_is_a_problem():
    spec = FeatureSpec("ball", "deviation", deviation=Deviation("ball.stl"))
    inspection = evaluate(InspectionPlan((spec,)), ShapeScan().measure(np.random.default_rng(0)))
    assert "nominal surface was not read" in str(inspection.problems[0])
