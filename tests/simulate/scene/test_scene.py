import numpy as np
import pytest
import trimesh

from core.errors import InputError
from core.model import Camera, Pose
from core.simulate.rays import ray_map
from core.simulate.rig import paper_rig
from core.simulate.scene.objects import cylinder, face_mask, gauge_block, step_block, stl
from core.simulate.scene.scene import Mesh, Scene, Sphere, surface_maps
from core.simulate.scene.stage import table_pose

RIG = paper_rig(0.2)
RAYS = ray_map(RIG.camera)


def rays_of(pixels: np.ndarray) -> np.ndarray:
    """(N, 3), from (row, column)."""
    return RIG.camera.rays(pixels[:, ::-1])


def test_table_depth_is_that_of_the_plane():
    pose = table_pose()
    maps = surface_maps(Scene.on_table(pose), RIG.camera, RAYS)
    pixels = np.argwhere(maps.depth > 0)[::997]
    up = pose.rotation[:, 2]
    expected = (up @ pose.translation) / (rays_of(pixels) @ up)
    assert np.abs(maps.depth[tuple(pixels.T)] - expected).max() < 1e-4
    assert maps.table.all()


def test_block_depth_is_that_of_its_upper_face_and_its_walls_are_seen_from_aside():
    pose = table_pose()
    maps = surface_maps(Scene.on_table(pose, gauge_block(50.0)), RIG.camera, RAYS)
    pixels = np.argwhere(~maps.table)
    up = pose.rotation[:, 2]
    points = rays_of(pixels) * maps.depth[tuple(pixels.T)][:, None]
    local = pose.inverse().apply(points)
    on_top = np.abs(local[:, 2] - 50) < 1e-3
    assert on_top.mean() > 0.8
    assert (np.abs(local[on_top, :2]) < [35.001, 30.001]).all()
    assert np.abs(maps.normals[tuple(pixels[on_top].T)] - up).max() < 1e-5
    on_wall = ~on_top
    assert on_wall.sum() > 20
    gap = np.abs(np.abs(local[on_wall, :2]) - [35, 30]).min(axis=1)
    assert gap.max() < 1e-3


def test_sphere_depth_solves_the_quadratic_and_a_fine_mesh_of_it_agrees():
    centre = np.array([3.0, 50.0, 530.0])
    ball = surface_maps(Scene(None, spheres=(Sphere(centre, 25.0),)), RIG.camera, RAYS)
    pixels = np.argwhere(ball.depth > 0)
    points = rays_of(pixels) * ball.depth[tuple(pixels.T)][:, None]
    assert np.abs(np.linalg.norm(points - centre, axis=1) - 25).max() < 2e-4
    fine = trimesh.creation.icosphere(subdivisions=5, radius=25.0)
    mesh = Mesh(fine.triangles + centre)
    meshed = surface_maps(Scene(None, (mesh,)), RIG.camera, RAYS)
    both = (ball.depth > 0) & (meshed.depth > 0) & (ball.normals[..., 2] < -0.4)
    assert both.sum() > 0.7 * (ball.depth > 0).sum()
    assert np.abs(ball.depth - meshed.depth)[both].max() < 0.05
    assert (ball.normals[both] * meshed.normals[both]).sum(axis=1).min() > 0.999


def test_a_lying_cylinder_is_closed_round_and_shaded_as_if_it_had_no_facets():
    shaft = cylinder(30.0, 60.0)
    solid = trimesh.Trimesh(**trimesh.triangles.to_kwargs(shaft.triangles))
    assert solid.is_watertight
    assert solid.volume == pytest.approx(np.pi * 15.0**2 * 60.0, rel=1e-5)
    pose = table_pose()
    maps = surface_maps(Scene.on_table(pose, shaft), RIG.camera, RAYS)
    pixels = np.argwhere(~maps.table)
    local = pose.inverse().apply(rays_of(pixels) * maps.depth[tuple(pixels.T)][:, None])
    normals = maps.normals[tuple(pixels.T)] @ pose.rotation
    away = local - [0.0, 0.0, 15.0]
    side = np.abs(away[:, 0]) < 29.9
    assert side.sum() > 1000
    assert np.abs(np.hypot(away[side, 1], away[side, 2]) - 15.0).max() < 1e-3
    assert np.abs(normals[side, 1:] - away[side, 1:] / 15.0).max() < 1e-3
    assert np.abs(normals[side, 0]).max() < 1e-5


def test_nearer_triangles_hide_farther_ones_in_whatever_order():
    near, far = (
        gauge_block(10.0).moved(Pose(np.eye(3), [0, 0, 400])),
        gauge_block(10.0).moved(Pose(np.eye(3), [0, 0, 500])),
    )
    camera = Camera((200, 200), [[500, 0, 100], [0, 500, 100], [0, 0, 1]])
    for meshes in ((near, far), (far, near)):
        depth = surface_maps(Scene(None, meshes), camera).depth
        assert depth[100, 100] == pytest.approx(400.0)


def test_triangles_behind_the_camera_are_left_out():
    behind = gauge_block(10.0).moved(Pose(np.eye(3), [0, 0, -9]))
    assert not surface_maps(Scene(None, (behind,)), RIG.camera, RAYS).depth.any()


def test_steps_have_the_four_heights():
    pose = table_pose()
    maps = surface_maps(Scene.on_table(pose, step_block()), RIG.camera, RAYS)
    height = (maps.points - pose.translation) @ pose.rotation[:, 2]
    for step in (40, 50, 60, 70):
        assert (np.abs(height - step) < 1e-3).sum() > 1000


def test_ears_of_the_mask_hide_a_part_of_themselves():
    pose = table_pose()
    scene = Scene.on_table(pose, face_mask())
    maps = surface_maps(scene, RIG.camera, RAYS)
    local = pose.inverse().apply(maps.points.reshape(-1, 3)).reshape(maps.points.shape)
    ear = np.abs(local[..., 0]) > 47
    ear &= ~maps.table
    assert ear.sum() > 300
    jumps = np.abs(np.diff(maps.depth, axis=1))[ear[:, 1:]]
    assert (jumps > 3).sum() > 50
    middle = ~maps.table & (np.abs(local[..., 0]) < 30) & (np.abs(local[..., 1]) < 40)
    assert np.abs(np.diff(maps.depth, axis=1))[middle[:, 1:] & middle[:, :-1]].max() < 3


def test_the_mask_has_the_height_asked_for():
    points = face_mask(42.0).triangles[..., 2]
    assert points.max() == pytest.approx(42.0)
    assert points.min() >= -1e-9


def test_thin_shells_are_lit_from_the_side_they_are_seen():
    triangle = np.array([[[-20.0, -20, 500], [20, -20, 500], [0, 30, 500]]])
    for turned in (triangle, triangle[:, ::-1]):
        maps = surface_maps(Scene(None, (Mesh(turned),)), RIG.camera, RAYS)
        assert (maps.normals[maps.depth > 0][:, 2] < -0.99).all()


def test_stl_is_stood_on_the_table(tmp_path):
    path = tmp_path / "part.stl"
    part = trimesh.creation.box((20, 10, 8))
    part.apply_translation([100, 50, 30])
    part.export(path)
    corners = stl(path).triangles.reshape(-1, 3)
    assert corners.min(axis=0) == pytest.approx([-10, -5, 0])
    assert corners.max(axis=0) == pytest.approx([10, 5, 8])


@pytest.mark.parametrize("content", [b"", b"this is no mesh", b"\x00" * 90])
def test_a_file_that_is_no_stl_is_named(tmp_path, content):
    path = tmp_path / "broken.stl"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"broken\.stl"):
        stl(path)


def test_a_missing_stl_is_named(tmp_path):
    with pytest.raises(InputError, match=r"absent\.stl"):
        stl(tmp_path / "absent.stl")
