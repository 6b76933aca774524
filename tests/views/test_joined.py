"""Points of two views in one frame: what errs in both at once adds up in the thickness between them."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.deviations import Deviation, moved_fan
from core.inspect.causes import Cause
from core.inspect.faces import FacePair
from core.inspect.uncertainty.error_sources import Sources
from core.inspect.uncertainty.part import SUSPECTED_LAYER_MM, Part, TargetTemperature
from core.inspect.uncertainty.point_errors import PointErrors
from core.model import Pose
from core.scan.common_errors import CommonErrors
from core.scan.surface.cloud import FAN, Cloud
from core.simulate.rig import pencil_fan
from core.views.joined_cloud import View, join_clouds
from core.views.joint import join
from core.views.joint_check import overlaps_of
from core.views.thickness import require_turned, thickness_across
from tests.views.made import CAMERA, both_seen, carrier, exact, seen_in

DEPTH, HALF = 510.0, 25.0
"""Of the face that each view shows, and half the thickness: the carrier is amid the part."""
SCALE = 2e-5
"""By which a displaced fan sees everything farther away."""
UP = np.diag([1.0, -1.0, -1.0])
POSES = Pose(UP, np.array([0.0, 50.0, DEPTH + HALF])), Pose(np.eye(3), np.array([0.0, 50.0, DEPTH + HALF]))


def face(sigma=0.01, seed=0, at=DEPTH):
    """A face square to the view at a depth, where the fan's lines meet it."""
    points, line = [], []
    for k, pi in enumerate(pencil_fan().pis):
        x = np.linspace(-30, 30, 120)
        points.append(np.column_stack([x, (1 - pi[0] * x - pi[2] * at) / pi[1], np.full_like(x, at)]))
        line.append(np.full(len(x), FAN - k))
    points = np.concatenate(points)
    depth = at + sigma * np.random.default_rng(seed).standard_normal(len(points))
    uv, ones = CAMERA.project(points), np.ones(len(points))
    points *= (depth / at)[:, None]
    frame = np.full(len(points), -1)
    return Cloud(
        points, uv, sigma * ones, 100 * ones, frame, np.concatenate(line), np.tile([0.0, 0, -1], (len(points), 1))
    )


def errors():
    fan = pencil_fan()
    larger = Deviation("fan", CAMERA, moved_fan(fan, -SCALE * fan.pis.ravel()))
    return PointErrors(common=CommonErrors.of_fan(CAMERA, fan, [larger]), swept=False, part=Part(material="metal"))


@pytest.fixture(scope="module")
def joined():
    known = exact(carrier())
    rng = np.random.default_rng(3)
    seen = [
        seen_in(known, pose, side, rng, name)
        for side, (pose, name) in enumerate(zip(POSES, ("scan", "turned"), strict=True))
    ]
    joint = join(known, seen, CAMERA)
    return join_clouds(joint, [View("scan", face(), errors()), View("turned", face(seed=1), errors())])


def across(joined):
    views = joined.cloud.view
    return thickness_across(joined, faces=FacePair(np.flatnonzero(views == 0), np.flatnonzero(views == 1)))


def test_the_thickness_goes_from_a_face_of_one_view_to_a_face_of_the_other(joined):
    gauge = across(joined)
    assert gauge.thickness_mm == pytest.approx(2 * HALF, abs=gauge.U_mm)
    assert 0.005 < gauge.u_mm < 0.04


def test_what_the_fan_sees_too_far_in_both_views_counts_twice_not_by_chance(joined):
    rows = {row.source: row.u_mm for row in across(joined).budget}
    assert rows[Cause.FAN_CALIBRATION] == pytest.approx(2 * SCALE * DEPTH, rel=0.02)


def test_the_joint_has_rows_of_its_own_in_the_budget(joined):
    rows = {row.source: row.u_mm for row in across(joined).budget}
    along = np.array([0.0, 0, 1])
    at = np.array([0.0, 50.0, DEPTH + HALF])
    by_motion = along @ np.hstack([[[0, at[2], -at[1]], [-at[2], 0, at[0]], [at[1], -at[0], 0]], np.eye(3)])
    u = float(np.sqrt(by_motion @ joined.joint.covariance(1) @ by_motion))
    assert np.hypot(rows[Cause.JOINT_MARKS], rows[Cause.JOINT_CARRIER]) == pytest.approx(u, rel=0.3)


def test_matter_that_lets_light_in_counts_twice_linearly():
    known = exact(carrier())
    rng = np.random.default_rng(3)
    joint = join(known, [seen_in(known, pose, side, rng, str(side)) for side, pose in enumerate(POSES)], CAMERA)
    plastic = replace(errors(), part=Part(material="plastic"))
    both = join_clouds(joint, [View("scan", face(), plastic), View("turned", face(seed=1), plastic)])
    views = both.cloud.view
    direction = np.where(views[:, None] == 0, [0.0, 0, -1], [0.0, 0, 1])
    sources = Sources.of(both.cloud, direction, np.ones(len(views)), views, views, both.errors)
    assert sources.below.shape[1] == 1
    of_first = sources.stretch[views == 0].max() + 1
    assert np.sign(sources.below[:of_first]).max() == np.sign(sources.below[of_first:]).max()


def joined_of(part):
    known, rng = exact(carrier()), np.random.default_rng(3)
    joint = join(known, [seen_in(known, pose, side, rng, str(side)) for side, pose in enumerate(POSES)], CAMERA)
    mine = replace(errors(), part=part)
    return join_clouds(joint, [View("scan", face(), mine), View("turned", face(seed=1), mine)])


def test_layers_of_spray_on_both_faces_add_up():
    stated = across(joined_of(Part(material="sprayed", spray_mm=0.012, spray_sd_mm=0.002)))
    bare = across(joined_of(Part(material="metal")))
    assert stated.thickness_mm - bare.thickness_mm == pytest.approx(-0.024, abs=1e-9)
    assert {row.source: row.u_mm for row in stated.budget}[Cause.SPRAY] == pytest.approx(0.004)


def test_an_assumed_layer_of_spray_is_on_both_faces():
    rows = {row.source: row.u_mm for row in across(joined_of(Part(material="sprayed"))).budget}
    assert rows[Cause.SPRAY_ASSUMED] == pytest.approx(2 * SUSPECTED_LAYER_MM)


@pytest.mark.parametrize(
    ("material", "within", "through"),
    [
        ("plastic", Cause.LIGHT_FROM_BELOW, Cause.JOINT_DEPTH_BIAS),
        (None, Cause.LIGHT_FROM_BELOW_ASSUMED, Cause.JOINT_DEPTH_BIAS_ASSUMED),
    ],
)
def test_light_from_below_is_told_twice_only_across_views_and_where_it_is_assumed(material, within, through):
    both = joined_of(Part(material=material))
    views, up = both.cloud.view, np.array([0.0, 0.0, -1.0])
    every = Sources.of(both.cloud, up, np.ones(len(views)), views, views, both.errors)
    first = both.cloud.select(views == 0)
    here = np.zeros(len(first), dtype=np.int64)
    alone = Sources.of(first, up, np.ones(len(first)), here, here, both.errors)
    assert (every.cause_below, alone.cause_below) == (through, within)


def test_every_point_says_its_view_and_what_it_has_in_common_with_the_others(joined):
    cloud = joined.cloud
    assert np.bincount(cloud.view).tolist() == [360, 360]
    assert cloud.sigma_common[cloud.view == 0] == pytest.approx(SCALE * DEPTH, rel=0.1)
    assert (cloud.sigma_common[cloud.view == 1] > 1.05 * SCALE * DEPTH).all()
    assert len(set(cloud.sweep[cloud.view == 0]) & set(cloud.sweep[cloud.view == 1])) == 0


def test_one_view_by_itself_errs_as_its_scan_does(joined):
    mine = np.flatnonzero(joined.cloud.view == 0)
    cloud, direction = joined.cloud.select(mine), np.array([0.0, 0.0, -1.0])
    part = np.zeros(len(cloud), dtype=np.int64)
    alone = Sources.of(cloud, direction, np.ones(len(cloud)), part, part, errors())
    among = Sources.of(cloud, direction, np.ones(len(cloud)), part, part, joined.errors)
    assert among.own == pytest.approx(alone.own)
    assert among.common[:, :1] == pytest.approx(alone.common)
    assert np.abs(among.common[:, 1:]).max() < 1e-15


def test_what_a_warm_carrier_makes_nearer_counts_in_both_views():
    known, rng = exact(carrier()), np.random.default_rng(3)
    cold = replace(known, temperature=TargetTemperature(None, None, 23e-6, 0.0))
    seen = [seen_in(cold, pose, side, rng, str(side), 1e-9) for side, pose in enumerate(POSES)]
    both = join_clouds(join(cold, seen, CAMERA), [View("scan", face(), errors()), View("1", face(seed=1), errors())])
    rows = {row.source: row.u_mm for row in across(both).budget}
    assert rows[Cause.JOINT_TEMPERATURE_ASSUMED] == pytest.approx(2 * 23e-6 * 3.0 * (DEPTH + HALF), rel=0.01)


def test_a_carrier_of_stated_temperature_is_taken_larger_by_its_expansion():
    known, rng = exact(carrier()), np.random.default_rng(3)
    warm = replace(known, temperature=TargetTemperature(30.0, 0.0, 23e-6, 0.0))
    grown = replace(known, positions=known.positions * (1 + 230e-6))
    seen = [seen_in(grown, pose, side, rng, str(side), 1e-9) for side, pose in enumerate(POSES)]
    joint = join(warm, seen, CAMERA)
    assert joint.poses[1].translation == pytest.approx(POSES[1].translation, abs=1e-5)
    assert not joint.by_temperature.any()


@pytest.fixture(scope="module")
def again():
    """Two views of the same side, the carrier as it was."""
    known, rng = exact(carrier()), np.random.default_rng(3)
    joint = join(known, [seen_in(known, POSES[0], 0, rng, name) for name in ("scan", "again")], CAMERA)
    return join_clouds(joint, [View("scan", face(), errors()), View("again", face(), errors())])


def second_shifted(joined, along_z, normal_z):
    """The views with the second's points shifted by `along_z` mm from the first's, with normals (0, 0, `normal_z`)."""
    cloud, first = joined.cloud, joined.cloud.view == 0
    points, normals = cloud.points.copy(), cloud.normals.copy()
    points[~first], normals[~first] = points[first] + [0.0, 0.0, along_z], [0.0, 0.0, normal_z]
    return replace(joined, cloud=replace(cloud, points=points, normals=normals))


def test_the_faces_of_a_thin_sheet_are_not_inside_out(again):
    assert overlaps_of(second_shifted(again, 0.8, 1.0)) == []


def test_surfaces_against_each_other_are_inside_out(again):
    (one,) = overlaps_of(second_shifted(again, 0.0, 1.0))
    assert one.opposed == 1.0


@pytest.mark.parametrize("slip", [0.3, 1.2, 2.0])
def test_a_face_seen_twice_is_apart_by_what_the_part_slipped(again, slip):
    (one,) = overlaps_of(second_shifted(again, -slip, -1.0))
    assert one.mm == pytest.approx(slip, abs=0.02)
    assert one.spread[2, 2] == pytest.approx(1.0)


@pytest.mark.parametrize("nearer", [0.0, 100.0])
def test_two_views_are_parted_by_what_a_calibration_does_to_their_points_differently(nearer):
    """A fan displaced by a share of the depth: alike at one distance, by that share of the way at another."""
    known, rng, fan = exact(carrier()), np.random.default_rng(3), pencil_fan()
    there = Pose(POSES[0].rotation, POSES[0].translation - [0.0, 0.0, nearer])
    joint = join(
        known, [seen_in(known, pose, 0, rng, str(k), 1e-4) for k, pose in enumerate((POSES[0], there))], CAMERA
    )
    larger = Deviation("fan", CAMERA, moved_fan(fan, -1e-3 * fan.pis.ravel()))
    mine = replace(errors(), common=CommonErrors.of_fan(CAMERA, fan, [larger]))
    views = [View("scan", face(), mine), View("again", face(at=DEPTH - nearer), mine)]
    (one,) = overlaps_of(second_shifted(join_clouds(joint, views), 0.0, -1.0))
    assert one.u_mm == pytest.approx(1e-3 * nearer, abs=0.012)


def test_two_views_of_the_same_side_have_no_thickness_between_them():
    known = carrier()
    first, _ = both_seen(known)
    with pytest.raises(Exception, match="shows side A of the carrier, as the first view does"):
        require_turned(join(known, (first, first), CAMERA))
