"""Plates: edges, corners and circles where the camera model puts them, in pictures without noise."""

import cv2
import numpy as np
import pytest

from core.image.targets import BlackSquare, Charuco, Checkerboard, CircleGrid
from core.model import Pose
from core.simulate.calibration import CalibrationPictures
from core.simulate.poses import camera_poses, plane_poses
from core.simulate.rays import ray_map
from core.simulate.recording import scenario_rig
from core.simulate.rig import Optics, paper_rig
from core.simulate.scenario import Scenario
from core.simulate.scene.boards import BLACK, PLATES, WHITE, printed
from core.simulate.scene.image import Sensor, generator
from core.simulate.scene.patterns import Pattern, draw_pattern
from core.simulate.scene.targets import RenderContext, camera_picture, fan_centres

RIG = paper_rig(0.5)
CAMERA = RIG.camera
RAYS = ray_map(CAMERA)
QUIET = Sensor(Optics(black_level_grey=0.0), 16, 0.0)


def views_of(target, count: int):
    """Noise-free 16-bit pictures of a plate, with their poses."""
    pattern = printed(target)
    for pose in camera_poses(CAMERA, pattern.outline, count, generator(5, "test")):
        yield camera_picture(RenderContext(RIG, RAYS, QUIET), pattern, pose, 200.0, generator(5, "none")), pose


@pytest.mark.parametrize("roll", [0.0, 0.003, 0.1, 0.7])
def test_every_row_of_pixels_holds_exactly_the_share_of_white_beyond_an_edge(roll):
    pattern = Pattern(np.array([-200.0, 0.0, 200.0]), np.array([-200.0, 200.0]), np.array([[0.0, 1.0]]))
    pose = Pose.from_vector([0.3, -0.2, roll, 10.0, 20.0, 500.0])
    albedo = draw_pattern(pattern, pose, RAYS)[1]
    edge = CAMERA.project_pose(pose, np.column_stack([np.zeros(4001), np.linspace(-60, 60, 4001), np.zeros(4001)]))
    rows = np.arange(int(edge[:, 1].min()) + 2, int(edge[:, 1].max()) - 2)
    true = np.interp(rows, edge[:, 1], edge[:, 0])
    ends = np.round(true).astype(int) + 40
    found = np.array([end + 0.5 - albedo[row, end - 80 : end + 1].sum() for row, end in zip(rows, ends, strict=True)])
    assert np.abs(found - true).max() < 0.002
    assert abs(np.mean(found - true)) < 0.0003


@pytest.mark.parametrize("target", [Checkerboard(17, 12, 10.0), Charuco(12, 9, 15.0, 11.25, "DICT_4X4_100")])
def test_corners_are_unbiased(target):
    errors = []
    for picture, pose in views_of(target, 4):
        true = CAMERA.project_pose(pose, target.points)
        smooth = cv2.GaussianBlur(picture.astype(np.float32), (0, 0), 1.5)  # spares cornerSubPix its own phase error
        start = true.astype(np.float32).reshape(-1, 1, 2)
        found = cv2.cornerSubPix(smooth, start.copy(), (4, 4), (-1, -1), (3, 100, 1e-5)).reshape(-1, 2)
        errors.append(found - true)
    errors = np.concatenate(errors)
    assert np.abs(errors.mean(axis=0)).max() < 0.003
    assert np.sqrt((errors**2).mean()) < 0.022


@pytest.mark.parametrize("asymmetric", [False, True])
def test_dots_cover_the_images_of_the_circles(asymmetric):
    grid = CircleGrid(7, 6, 8.0 if asymmetric else 14.0, asymmetric)
    pattern = printed(grid)
    (pose,) = camera_poses(CAMERA, pattern.outline, 1, generator(5, "dots"))
    dark = 1 - (draw_pattern(pattern, pose, RAYS)[1] - BLACK) / (WHITE - BLACK)
    angle = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    rim = pattern.dot_radius * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(400)])
    for centre in grid.points:
        outline = CAMERA.project_pose(pose, centre + rim)
        x, y = outline.T
        cross = x * np.roll(y, -1) - np.roll(x, -1) * y
        area = cross.sum() / 2
        middle = [((a + np.roll(a, -1)) * cross).sum() / (6 * area) for a in (x, y)]
        (u0, v0), (u1, v1) = np.floor(outline.min(axis=0)).astype(int) - 2, np.ceil(outline.max(axis=0)).astype(int) + 3
        patch = dark[v0:v1, u0:u1].astype(float)
        v, u = np.mgrid[v0:v1, u0:u1]
        assert patch.sum() == pytest.approx(abs(area), rel=0.005)
        assert [(patch * u).sum() / patch.sum(), (patch * v).sum() / patch.sum()] == pytest.approx(middle, abs=0.005)


def test_opencv_reads_the_charuco_boards_markers_in_their_places():
    board = Charuco(12, 9, 15.0, 11.25, "DICT_4X4_100")
    layout = cv2.aruco.CharucoBoard(
        (12, 9), 15.0, 11.25, cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, board.dictionary_id))
    )
    for picture, pose in views_of(board, 2):
        corners, ids, _, _ = cv2.aruco.CharucoDetector(layout).detectBoard((picture >> 8).astype(np.uint8))
        assert len(ids) > 80
        true = CAMERA.project_pose(pose, board.points[np.ravel(ids)])
        assert np.abs(np.reshape(corners, (-1, 2)) - true).max() < 0.5


def test_camera_views_cover_the_picture_and_tilt_to_35_degrees_and_stay_inside():
    outline = printed(PLATES["checkerboard"]).outline
    poses = camera_poses(CAMERA, outline, 14, generator(1, "poses"))
    corners = np.array([CAMERA.project_pose(pose, outline) for pose in poses])
    assert corners.min() > 0
    assert (corners.max(axis=(0, 1)) < CAMERA.image_size).all()
    seen = np.zeros((4, 6), bool)
    for pose in poses:
        uv = CAMERA.project_pose(pose, Checkerboard(17, 12, 10.0).points)
        seen[(uv[:, 1] / 1374 * 4).astype(int), (uv[:, 0] / 1920 * 6).astype(int)] = True
    assert seen.mean() > 0.9
    tilts = np.degrees([np.arccos(pose.rotation[2, 2]) for pose in poses])
    assert 28 < tilts.max() < 36
    assert tilts.min() < 12
    depths = np.array([pose.apply(outline).mean(axis=0)[2] for pose in poses])
    assert depths.min() > 430
    assert depths.max() < 700


@pytest.mark.accuracy
def test_all_fan_lines_fall_on_light_parts_of_the_plane_target_in_every_pose():
    square = printed(BlackSquare(60.0))
    poses = plane_poses(fan_centres(RIG, 9), square.outline, generator(1, "planes"))
    depths = []
    for pose in poses:
        points, albedo = draw_pattern(square, pose, RAYS)
        for plane in RIG.fan.planes:
            on_line = (np.abs(points @ plane.normal - plane.d_mm) < 0.2) & (points[..., 2] > 0)
            assert (albedo[on_line] > 0.7).sum() > 250
            depths.append(np.ptp(points[on_line][:, 2]))
        corners = CAMERA.project_pose(pose, BlackSquare(60.0).points)
        assert corners.min() > 20
        assert (corners < np.array(CAMERA.image_size) - 20).all()
    centres = [pose.apply(BlackSquare(60.0).points).mean(axis=0)[2] for pose in poses]
    assert min(centres) < 470
    assert max(centres) > 580


def test_a_plane_pair_differs_by_the_fan_alone():
    scenario = Scenario(scale=0.25, plane_poses=1, camera_views=0, noise=0.0, speckle=0.0)
    rig = scenario_rig(scenario)
    pictures = CalibrationPictures(scenario, rig, ray_map(rig.camera))
    (_, on), (_, off) = pictures.render("pose00")
    difference = on.astype(int) - off
    rows, columns = np.nonzero(difference)
    rays = rig.camera.rays(np.column_stack([columns, rows]))
    pose = pictures.plane_poses["pose00"]
    normal = pose.rotation[:, 2]
    points = rays * ((normal @ pose.translation) / (rays @ normal))[:, None]
    nearest = np.abs(np.array([plane.distances(points) for plane in rig.fan.planes])).min(axis=0)
    assert len(rows) > 500
    assert nearest.max() < 3.5
    assert difference[rows, columns][nearest < 0.1].mean() > 40
