"""The mesh over a fused surface."""

import numpy as np
import pytest

from core.errors import InputError
from core.scan.surface.fusion import fuse, with_normals
from core.scan.surface.mesh import build_mesh
from tests.scan.stripes_on_planes import FOCAL, SIZE, cloud_of, on_plane, stripes


def block_surface(height=40.0, spacing=8.0):
    uv, index = stripes(spacing)
    upper = np.abs(uv - [240, 180]).max(axis=1) < 90
    depth = np.where(upper, 540.0 - height, 540.0) + np.random.default_rng(4).normal(0, 0.02, len(uv))
    return with_normals(fuse(cloud_of(uv, depth, 0.02, index), SIZE, 2))


def fronts(mesh):
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a), (a + b + c) / 3


def test_triangles_connect_across_the_gaps_between_stripes():
    uv, index = stripes(spacing=15.0)
    normal = np.array([0.1, 0.2, 1.0]) / np.linalg.norm([0.1, 0.2, 1.0])
    mesh = build_mesh(fuse(cloud_of(uv, on_plane(uv, normal, 500.0), 0.02, index), SIZE, 2))
    area = np.linalg.norm(fronts(mesh)[0], axis=1).sum() / 2
    corners = np.array([[60.0, 60.0], [420.0, 60.0], [60.0, 300.0]])
    rays = np.column_stack([(corners - np.array(SIZE) / 2) / FOCAL, np.ones(3)])
    corner = rays * on_plane(corners, normal, 500.0)[:, None]
    inner = np.linalg.norm(np.cross(corner[1] - corner[0], corner[2] - corner[0]))
    assert area > inner  # the stripes fill more than this inner rectangle, without holes


def test_all_triangles_and_normals_face_the_camera():
    mesh = build_mesh(block_surface())
    front, centre = fronts(mesh)
    assert ((front * centre).sum(axis=1) < 0).all()
    assert (mesh.normals[:, 2] < 0).all()
    assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(1.0)


@pytest.mark.parametrize("height", [4.0, 10.0, 40.0])
def test_no_triangle_spans_the_step(height):
    mesh = build_mesh(block_surface(height))
    depth = mesh.vertices[mesh.triangles][:, :, 2]
    assert np.ptp(depth, axis=1).max() < height / 2
    assert (depth.mean(axis=1) < 540 - height / 2).sum() > 1000  # both faces are there
    assert (depth.mean(axis=1) > 540 - height / 2).sum() > 1000


def test_noise_alone_cuts_nothing():
    uv, index = stripes(spacing=2.0)
    depth = 540 + np.random.default_rng(5).normal(0, 0.3, len(uv))  # steeper than the surface ever is, but within σ
    surface = fuse(cloud_of(uv, depth, 0.3, index), SIZE, 2)
    mesh = build_mesh(surface, max_edge_px=50)
    assert len(mesh.triangles) > 1.9 * len(surface)  # Euler: about two triangles a vertex when nothing is cut


def test_long_edges_are_cut():
    uv, index = stripes()
    apart = np.abs(uv[:, 0] - 240) > 60
    mesh = build_mesh(fuse(cloud_of(uv[apart], 540.0, 0.02, index[apart]), SIZE, 2))
    u = mesh.vertices[:, 0] / mesh.vertices[:, 2]
    side = np.sign(u)[mesh.triangles]
    assert (np.abs(side.sum(axis=1)) == 3).all()


def test_only_used_vertices_and_the_same_mesh_every_time():
    first, second = build_mesh(block_surface()), build_mesh(block_surface())
    assert first.triangles.tobytes() == second.triangles.tobytes()
    assert first.vertices.tobytes() == second.vertices.tobytes()
    assert np.array_equal(np.unique(first.triangles), np.arange(len(first.vertices)))


def test_too_few_points_are_said():
    with pytest.raises(InputError, match="no triangle"):
        build_mesh(fuse(cloud_of([[10, 10], [30, 30]], 500.0), SIZE))
    with pytest.raises(InputError, match="no triangle"):
        build_mesh(fuse(cloud_of([[10, 10], [30, 30], [50, 50]], 500.0), SIZE))
