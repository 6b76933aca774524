import cv2
import numpy as np
import pytest

from core.model import Camera, Fan, LightPlane, Pose, angle_between
from tests.paper import CAMERA as PAPER
from tests.paper import PLANES


def pixels_everywhere() -> np.ndarray:
    u, v = np.meshgrid(np.linspace(0, 3839, 25), np.linspace(0, 2747, 19))
    return np.column_stack([u.ravel(), v.ravel()])


def test_undistorting_then_projecting_returns_the_pixel():
    uv = pixels_everywhere()
    assert np.abs(PAPER.project(PAPER.rays(uv) * 700) - uv).max() < 1e-8


def test_projection_without_skew_is_opencvs():
    matrix = PAPER.matrix.copy()
    matrix[0, 1] = 0
    camera = Camera(PAPER.image_size, matrix, [0.08, -0.38, 0.004, -0.0004, 0.05])
    points = np.random.default_rng(1).uniform([-150, -100, 400], [150, 100, 800], (200, 3))
    theirs = cv2.projectPoints(points, np.zeros(3), np.zeros(3), matrix, camera.distortion)[0][:, 0]
    assert np.abs(camera.project(points) - theirs).max() < 1e-8


def test_skew_shifts_u_by_gamma_times_y():
    matrix = PAPER.matrix.copy()
    matrix[0, 1] = 0
    without = Camera(PAPER.image_size, matrix)
    with_skew = Camera(PAPER.image_size, PAPER.matrix)
    point = np.array([[30.0, 60.0, 600.0]])
    assert (with_skew.project(point) - without.project(point))[0] == pytest.approx([0.77900164 * 0.1, 0])


def test_ray_jacobian_is_the_derivative_of_the_ray():
    uv = pixels_everywhere()
    jacobian = PAPER.ray_jacobian(PAPER.rays(uv))
    for axis in range(2):
        step = np.zeros(2)
        step[axis] = 0.5
        numeric = (PAPER.undistort(uv + step) - PAPER.undistort(uv - step)) / 1.0
        assert np.abs(jacobian[:, :, axis] - numeric).max() < 1e-10


def test_scaled_camera_sees_the_same_pixel_edges():
    half = PAPER.scaled(0.5)
    points = np.random.default_rng(2).uniform([-150, -100, 400], [150, 100, 800], (50, 3))
    full = PAPER.project(points)
    assert np.abs((half.project(points) + 0.5) * 2 - (full + 0.5)).max() < 1e-9
    assert half.image_size == (1920, 1374)


@pytest.mark.parametrize("change", [(0, 0, -1.0), (0, 0, np.nan), (1, 1, 0.0)])
def test_impossible_intrinsics_are_refused(change):
    matrix = PAPER.matrix.copy()
    matrix[change[0], change[1]] = change[2]
    with pytest.raises(ValueError, match=r"finite|positive"):
        Camera(PAPER.image_size, matrix)


def test_a_camera_cannot_be_changed_behind_its_back():
    with pytest.raises(ValueError, match="read-only"):
        PAPER.matrix[0, 0] = 1


def test_pose_and_its_inverse_cancel():
    pose = Pose.from_vector([0.1, -0.2, 0.3, 10, 20, 600])
    points = np.random.default_rng(3).normal(size=(10, 3))
    assert np.allclose((pose.inverse() @ pose).apply(points), points)
    assert np.allclose(pose.vector, [0.1, -0.2, 0.3, 10, 20, 600])


def test_triangulated_points_lie_on_the_light_plane_and_on_their_rays():
    plane = LightPlane.from_normal([0, 0.98, 0.2], 60.0)
    rays = PAPER.rays(pixels_everywhere())
    rays = rays[rays @ plane.pi > 1e-4]
    points = plane.points(rays)
    assert np.abs(points @ plane.pi - 1).max() < 1e-12
    assert np.allclose(points / points[:, 2:], rays)


def test_angles_between_planes_scatter_as_the_planes_covariance_says():
    fan = Fan(tuple(LightPlane(pi) for pi in PLANES), np.diag(np.square(np.tile([2e-6, 1e-6, 3e-6], 3))))
    moved = np.random.default_rng(1).multivariate_normal(fan.pis.ravel(), fan.covariance, 4000).reshape(-1, 3, 3)
    angles = [Fan(tuple(LightPlane(pi) for pi in pis)).angles for pis in moved]
    assert fan.angle_sds == pytest.approx(np.std(angles, axis=0), rel=0.05)


def test_the_papers_fan_is_one_pencil_with_angles_near_five_degrees():
    fan = Fan(tuple(LightPlane(pi) for pi in PLANES))
    assert np.rad2deg(fan.angles) == pytest.approx([4.929, 4.919], abs=0.001)
    assert np.rad2deg(angle_between(fan.planes[0], fan.planes[2])) == pytest.approx(9.848, abs=0.001)
