"""Noise of a stripe moves its points across a slanting surface by their depth and by their pixel."""

import numpy as np

from core.calibrate.camera.reprojection import parameters_of
from core.inspect.uncertainty.error_sources import _gain_of_noise
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
