"""What errs in the stretches of a face: noise that moves pixels, and light planes that many stretches share."""

from dataclasses import fields
from types import SimpleNamespace

import numpy as np
import pytest

from core.calibrate.camera.reprojection import parameters_of
from core.inspect.uncertainty.error_sources import Sources, _gain_of_noise, _on_planes
from core.inspect.uncertainty.point_errors import PointErrors
from core.model import Camera
from core.scan.common_errors import CommonErrors
from core.scan.surface.cloud import Cloud

CAMERA = Camera((1920, 1374), np.array([[2500.0, 0, 960], [0, 2500, 687], [0, 0, 1]]), np.zeros(5))
MIDDLE, RADIUS = np.array([5.0, -8.0, 530.0]), 25.0
NORMAL = np.array([0.6, 0.25, -0.3]) / np.linalg.norm([0.6, 0.25, -0.3])
PLANE = NORMAL / (NORMAL @ (MIDDLE + 3.0 * NORMAL))


def stripe():
    """Where a sheet of light cuts the camera's side of a ball: points, outward normals, and tangents."""
    flat = np.linalg.svd(NORMAL[None])[2][1:]
    angle = np.linspace(0, 2 * np.pi, 400)[:, None]
    outward = 3.0 * NORMAL + np.sqrt(RADIUS**2 - 9.0) * (np.cos(angle) * flat[0] + np.sin(angle) * flat[1])
    points, outward = MIDDLE + outward, outward / RADIUS
    tangent = np.cross(NORMAL, outward)
    seen = -(outward * points).sum(axis=1) / np.linalg.norm(points, axis=1) > 0.3
    return points[seen], outward[seen], tangent[seen]


def test_a_pixel_moved_across_the_stripe_leaves_the_ball_by_what_is_told():
    points, outward, tangent = stripe()
    rays = points / points[:, 2:]
    seen = tangent[:, :2] - rays[:, :2] * tangent[:, 2:]
    across = np.column_stack([seen[:, 1], -seen[:, 0], np.zeros(len(seen))]) / np.linalg.norm(seen, axis=1)[:, None]
    moved_rays = rays + 1e-6 * across
    moved = moved_rays / (moved_rays @ PLANE)[:, None]
    off = np.linalg.norm(moved - MIDDLE, axis=1) - RADIUS
    told = gain_of(points, outward)
    sound = (np.abs(told) > 0.11) & (np.abs(told) < 2.9)
    assert sound.sum() > 100
    np.testing.assert_allclose(off[sound], (told * (moved[:, 2] - points[:, 2]))[sound], rtol=2e-3)
    along_the_ray = np.abs((outward * rays).sum(axis=1))
    assert np.max(np.abs(told[sound]) / along_the_ray[sound]) > 1.5  # the pixel counts


def gain_of(points, outward):
    count = len(points)
    zero, one = np.zeros(count, dtype=np.int64), np.ones(count)
    cloud = Cloud(points, CAMERA.project(points), one, one, zero, zero, np.zeros((count, 3)))
    common = CommonErrors(CAMERA.image_size, (), parameters_of(CAMERA)[None], np.zeros((1, 3, 3)), PLANE[None, None])
    gain = (outward * points / points[:, 2:]).sum(axis=1)
    return _gain_of_noise(cloud, outward, gain, PointErrors(common=common))


def test_two_places_of_a_stretch_tell_what_a_displaced_calibration_does_to_all_its_points():
    points, outward, _ = stripe()
    count = len(points)
    one, sweep = np.ones(count), np.zeros(count, dtype=np.int64)
    cloud = Cloud(points, CAMERA.project(points), 0.01 * one, one, sweep, sweep, np.zeros((count, 3)))
    bent = Camera(CAMERA.image_size, CAMERA.matrix * [[1.001, 1, 1.002], [1, 0.999, 1], [1, 1, 1]], [0.01, 0, 1e-3, 0])
    common = CommonErrors(
        CAMERA.image_size,
        ("camera", "fan"),
        np.array([parameters_of(camera) for camera in (CAMERA, bent, CAMERA)]),
        np.zeros((3, 3, 3)),
        np.array([PLANE, PLANE, 1.001 * PLANE])[:, None],
    )
    errors = PointErrors(common=common, correlation_px=50.0)
    weights = np.linspace(0.5, 1.0, count)
    sources = Sources.of(cloud, outward, weights, sweep, sweep, errors)
    changes = common.changes(cloud.uv, cloud.sweep)
    of_points = np.column_stack([sources.mean((change * outward).sum(axis=1)) for change in changes])
    assert len(of_points) < count / 5
    np.testing.assert_allclose(sources.common, of_points, atol=2e-4 * np.abs(of_points).max())


@pytest.mark.parametrize("size", [3, 6])
def test_the_information_and_precision_of_all_stretches_are_those_of_few_rows_a_sweep(size):
    rng, sweeps, cells = np.random.default_rng(3), 7, 5
    sweep = np.sort(rng.choice([-2, -1, 0, 1, 3, 4, 6], 200))
    sweep[sweep == 3] = 4
    sweep[-1] = 5  # a sweep with one stretch, and others with none
    lever, planes = rng.normal(size=(200, size)), rng.normal(size=(size * sweeps, cells + size * sweeps))
    loose = rng.normal(size=size)  # a direction that hardly anything fixes, and no stretch feels
    lever -= np.outer(lever @ loose, loose) / (loose @ loose)
    planes[:size] += 1e7 * np.outer(loose, rng.normal(size=planes.shape[1]))
    on_planes = _on_planes(sweep, lever, sweeps)
    speckle, shared = np.split(on_planes @ planes, [cells], axis=1)
    speckle[sweep < 0] = rng.normal(size=(np.count_nonzero(sweep < 0), cells))
    others, weight = rng.normal(size=(200, 4)), rng.uniform(0.1, 2.0, 200)
    known = {"of_fan": sweep < 0, "speckle": speckle, "sweeps": shared, "on_planes": on_planes, "planes": planes}
    sources = Sources(**{one.name: known.get(one.name, SimpleNamespace()) for one in fields(Sources)})
    columns = np.hstack([others, speckle, shared])
    expected = (columns * weight[:, None]).T @ columns
    np.testing.assert_allclose(sources.information(others, weight), expected, atol=1e-6 * np.abs(expected).max())
    precision = sources.precision(weight)
    whole = np.linalg.inv(np.diag(1 / weight) + shared @ shared.T)
    np.testing.assert_allclose(precision.times(np.eye(200)), whole, atol=1e-6 * np.abs(whole).max())
    np.testing.assert_allclose(precision.diagonal, whole.diagonal(), atol=1e-6 * np.abs(whole).max())


def test_where_no_planes_are_known_the_others_and_the_speckle_are_left():
    sweep, others = np.array([0, 1, -1, 1]), np.arange(8.0).reshape(4, 2)
    errors = PointErrors()
    on_planes = _on_planes(sweep, np.ones((4, 3)), errors.sweeps)
    known = {
        "of_fan": sweep < 0,
        "speckle": np.zeros((4, 0)),
        "sweeps": np.zeros((4, 0)),
        "on_planes": on_planes,
        "planes": errors.planes_by_cause,
    }
    sources = Sources(**{one.name: known.get(one.name, SimpleNamespace()) for one in fields(Sources)})
    np.testing.assert_allclose(sources.information(others, np.ones(4)), others.T @ others)
    precision = sources.precision(np.full(4, 2.0))
    np.testing.assert_allclose(precision.times(others), 2.0 * others)
    np.testing.assert_allclose(precision.diagonal, 2.0)
