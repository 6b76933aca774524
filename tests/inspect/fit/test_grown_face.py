"""The face about a point grows over all of it and no farther, whatever it is and wherever on it one begins."""

from dataclasses import replace

import numpy as np
import pytest

from core.errors import InputError
from core.inspect.fit.grown_face import grow_face
from core.inspect.fit.shapes import Cylinder, Sphere
from core.scan.surface.cloud import Cloud
from core.scan.surface.normals import with_normals
from tests.inspect.block_scan import NORMAL, BlockScan, pixels
from tests.inspect.shape_scan import BALL, BALL_RADIUS, PIN, PIN_AXIS, PIN_RADIUS, ShapeScan

BALL_POINTS, PIN_POINTS, TABLE_POINTS = 0, 1, 2


@pytest.fixture(scope="module")
def block():
    """A block on a plate: the plate has a hole where the block and its shadow are."""
    scan = BlockScan()
    return scan, with_normals(scan.measure(np.random.default_rng(1), outliers=0.01))


@pytest.fixture(
    scope="module",
    params=[pytest.param(9.0, marks=pytest.mark.accuracy, id="close stripes"), pytest.param(20.0, id="sparse stripes")],
)
def shapes(request):
    scan = ShapeScan(request.param)
    return scan, with_normals(scan.measure(np.random.default_rng(1), outliers=0.01))


def seeds(scan, cloud, which, count=12):
    """Points anywhere on what is meant but those that were measured wrongly."""
    good = np.flatnonzero(which & (np.linalg.norm(cloud.points - scan.points, axis=1) < 0.2))
    return np.random.default_rng(2).choice(good, count)


def parts(*places):
    """A cloud of the points (N, 3) given, σ 0.01 mm, normals towards the camera."""
    points = np.vstack(places)
    points = points + np.random.default_rng(0).normal(0, 0.01, (len(points), 1)) * [0.0, 0.0, 1.0]
    count, up = len(points), np.tile([0.0, 0.0, -1.0], (len(points), 1))
    return Cloud(points, pixels(points), np.full(count, 0.01), np.ones(count), np.arange(count), np.arange(count), up)


def land(left, right, depth=500.0, spacing=2.0):
    """Points of a face 40 mm long, from `left` to `right`, on stripes across it."""
    x, y = np.meshgrid(np.arange(left, right + 1e-9, 0.4), np.arange(-20.0, 20.1, spacing))
    return np.column_stack([x.ravel(), y.ravel(), np.full(x.size, depth)])


@pytest.mark.parametrize("upper", [True, False])
def test_a_tilted_face_is_the_same_from_every_point_of_it(block, upper):
    scan, cloud = block
    found = [grow_face(cloud, int(seed)) for seed in seeds(scan, cloud, scan.upper == upper)]
    assert {face.kind for face in found} == {"plane"}
    assert all(np.array_equal(face.indices, found[0].indices) for face in found)
    assert np.all(scan.upper[found[0].indices] == upper)
    good = (scan.upper == upper) & (np.linalg.norm(cloud.points - scan.points, axis=1) < 0.1)
    assert np.isin(np.flatnonzero(good), found[0].indices).mean() > 0.99
    assert abs(found[0].shape.outward_normal @ NORMAL) == pytest.approx(1.0, abs=1e-6)
    assert 0.01 < found[0].rms_mm < 0.05


@pytest.mark.parametrize(
    ("which", "kind"), [(BALL_POINTS, "sphere"), (PIN_POINTS, "cylinder"), (TABLE_POINTS, "plane")]
)
def test_each_surface_is_told_for_what_it_is_from_every_point_of_it(shapes, which, kind):
    scan, cloud = shapes
    found = [grow_face(cloud, int(seed)) for seed in seeds(scan, cloud, scan.on == which)]
    assert {face.kind for face in found} == {kind}
    for face in found:
        assert np.mean(scan.on[face.indices] == which) > 0.99
        assert len(face.indices) > 0.97 * np.count_nonzero(scan.on == which)


def test_sphere_and_cylinder_lie_where_they_are(shapes):
    scan, cloud = shapes
    ball = grow_face(cloud, int(seeds(scan, cloud, scan.on == BALL_POINTS)[0])).shape
    pin = grow_face(cloud, int(seeds(scan, cloud, scan.on == PIN_POINTS)[0])).shape
    assert isinstance(ball, Sphere) and isinstance(pin, Cylinder)
    assert (ball.radius, pin.radius) == pytest.approx((BALL_RADIUS, PIN_RADIUS), abs=0.05)
    assert ball.centre == pytest.approx(BALL, abs=0.1)
    assert abs(pin.direction @ PIN_AXIS) == pytest.approx(1.0, abs=1e-5)
    away = pin.centre - PIN
    assert np.linalg.norm(away - PIN_AXIS * (PIN_AXIS @ away)) < 0.1
    assert abs(PIN_AXIS @ away) < 5.0, "amid the points"


def test_a_bore_is_a_cylinder():
    angle, along = (one.ravel() for one in np.meshgrid(np.linspace(-1.0, 1.0, 80), np.arange(-20.0, 20.1, 1.0)))
    radial = np.column_stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)])
    cloud = parts(np.array([0.0, 0.0, 500.0]) + 10.0 * radial + along[:, None] * [0.0, 1.0, 0.0])
    face = grow_face(replace(cloud, normals=-radial), len(cloud) // 2)
    assert face.kind == "cylinder" and len(face.indices) == len(cloud)
    assert face.shape.radius == pytest.approx(10.0, abs=0.02)


def test_a_face_goes_on_across_gaps_between_stripes_and_ends_where_something_else_lies_between():
    left, right = land(-30.0, -3.0), land(3.0, 30.0)
    seed = len(left) // 2
    assert len(grow_face(parts(left, right), seed).indices) == len(left) + len(right), "nothing was seen between"
    slot = parts(left, right, land(-2.6, 2.6, depth=503.0))
    assert np.array_equal(grow_face(slot, seed).indices, np.arange(len(left)))


def test_two_faces_at_one_height_far_from_each_other_are_two():
    left, right = land(-40.0, -12.0), land(12.0, 40.0)
    assert np.array_equal(grow_face(parts(left, right), 5).indices, np.arange(len(left)))


def test_a_step_of_half_a_millimetre_ends_a_face():
    upper, lower = land(-30.0, -0.2), land(0.2, 30.0, depth=500.5)
    cloud = parts(upper, lower)
    assert np.array_equal(grow_face(cloud, 10).indices, np.arange(len(upper)))
    assert np.array_equal(grow_face(cloud, len(cloud) - 10).indices, np.arange(len(upper), len(cloud)))


def test_a_slightly_bowed_face_stays_one_plane():
    """A bow that light planes leave, 0.02 mm high, is no cylinder."""
    face = land(-30.0, 30.0)
    cloud = parts(face + (0.02 * (face[:, 0] / 30) ** 2)[:, None] * [0.0, 0.0, 1.0])
    found = grow_face(cloud, len(cloud) // 2)
    assert found.kind == "plane" and len(found.indices) == len(cloud)


def test_what_is_asked_for_is_grown(shapes):
    scan, cloud = shapes
    seed = int(seeds(scan, cloud, scan.on == PIN_POINTS)[0])
    strip, tube = grow_face(cloud, seed, "plane"), grow_face(cloud, seed, "cylinder")
    assert (strip.kind, tube.kind) == ("plane", "cylinder")
    assert 12 <= len(strip.indices) < 0.5 * len(tube.indices)


@pytest.mark.parametrize(("kind", "said"), [("sphere", "no sphere"), ("cylinder", "no cylinder")])
def test_a_flat_face_is_refused_as_a_round_one(block, kind, said):
    scan, cloud = block
    with pytest.raises(InputError, match=said):
        grow_face(cloud, int(seeds(scan, cloud, scan.upper)[0]), kind)


def test_stray_points_are_refused_with_a_sentence(block):
    scan, cloud = block
    strays = np.flatnonzero(np.linalg.norm(cloud.points - scan.points, axis=1) > 2.0)
    grown = []
    for stray in strays:
        try:
            grown.append(len(grow_face(cloud, int(stray)).indices))
        except InputError as refused:
            assert "no face goes on" in str(refused)
    assert len(grown) < 0.1 * len(strays) and max(grown, default=0) < 0.02 * len(cloud), "a slice at most"


def test_faces_whose_normals_are_not_known_are_found_by_their_points(block):
    scan, cloud = block
    blind = replace(cloud, normals=np.zeros((len(cloud), 3)))
    for upper in (True, False):
        found = [grow_face(blind, int(seed)) for seed in seeds(scan, cloud, scan.upper == upper)]
        assert all(np.array_equal(face.indices, found[0].indices) for face in found)
        assert np.mean(scan.upper[found[0].indices] == upper) > 0.99


def test_a_single_stripe_is_no_face():
    line = land(-30.0, 30.0, spacing=100.0)
    cloud = parts(line)
    with pytest.raises(InputError, match="no face goes on"):
        grow_face(replace(cloud, normals=np.zeros((len(cloud), 3))), len(cloud) // 2)
