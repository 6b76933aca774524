"""Surfaces of other programs: what is read of PLY, STL, STEP and E57, and what is refused in one sentence."""

from datetime import UTC, datetime

import numpy as np
import pytest
import trimesh

from core.errors import InputError
from core.files.exchange.e57 import write_e57
from core.files.results.ply import write_cloud, write_mesh
from core.wings.geometry.comparison.surface_file import read_surface
from tests.files.test_cad_part import PLATE
from tests.report.report_samples import block_content


@pytest.fixture(scope="module")
def content():
    return block_content()


def test_a_cloud_keeps_points_normals_and_sigma(tmp_path, content):
    write_cloud(tmp_path / "any.ply", content.cloud, "abc")
    found = read_surface(tmp_path / "any.ply")
    assert found.triangles is None
    assert found.points.points == pytest.approx(content.cloud.points, abs=1e-4), "as any program reads it"
    assert found.points.normals == pytest.approx(content.cloud.normals, abs=1e-6)
    assert found.points.sigma == pytest.approx(content.cloud.sigma, rel=1e-6)


def test_a_mesh_with_sigma_is_taken_as_points_that_were_measured(tmp_path, content):
    write_mesh(tmp_path / "mesh.ply", content.mesh, "abc")
    found = read_surface(tmp_path / "mesh.ply")
    assert found.triangles is None
    assert len(found.points) == len(content.mesh.vertices)


@pytest.mark.parametrize("encoding", ["ascii", "binary"])
def test_another_programs_mesh_is_taken_as_triangles(tmp_path, encoding):
    trimesh.creation.box((10, 20, 30)).export(tmp_path / "box.ply", encoding=encoding)
    found = read_surface(tmp_path / "box.ply")
    assert found.triangles is not None
    assert len(found.triangles.corners) == 12
    assert found.triangles.size_mm == pytest.approx(np.sqrt(1400))


def test_an_stl_is_triangles(tmp_path):
    trimesh.creation.box((10, 20, 30)).export(tmp_path / "box.STL")
    found = read_surface(tmp_path / "box.STL")
    assert found.triangles is not None
    assert len(found.triangles.corners) == 12


def test_a_step_part_is_triangles_near_enough_to_its_faces():
    found = read_surface(PLATE)
    assert found.triangles is not None
    assert np.ptp(found.triangles.corners.reshape(-1, 3), axis=0) == pytest.approx([60, 40, 20], abs=0.01)


def test_points_of_four_cornered_faces_are_cut_in_two(tmp_path):
    text = (
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"
    )
    (tmp_path / "quad.ply").write_text(text)
    found = read_surface(tmp_path / "quad.ply")
    assert found.triangles is not None
    assert len(found.triangles.corners) == 2


def test_an_e57_of_ours_comes_back_in_mm_with_its_sigma(tmp_path, content):
    write_e57(tmp_path / "c.e57", content.cloud, datetime(2026, 1, 1, tzinfo=UTC))
    found = read_surface(tmp_path / "c.e57")
    assert found.points.points == pytest.approx(content.cloud.points, abs=1e-9)
    assert found.points.sigma == pytest.approx(content.cloud.sigma, rel=1e-6)


@pytest.mark.parametrize(
    ("name", "data", "said"),
    [
        ("part.obj", b"v 0 0 0", "none of the kinds"),
        ("cut.ply", b"ply\nformat ascii 1.0\nelement vertex 3\n", "no whole PLY"),
        ("none.ply", b"ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nend_header\n", "no point"),
        ("noise.e57", b"ASTM-E57" + bytes(2000), "cannot be read as E57"),
        ("empty.stl", b"solid x\nendsolid x\n", "no usable triangle"),
    ],
)
def test_what_is_no_surface_is_refused_in_one_sentence(tmp_path, name, data, said):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(InputError, match=said):
        read_surface(tmp_path / name)


def test_points_that_are_not_finite_are_left_out(tmp_path):
    head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    (tmp_path / "holes.ply").write_text(head + "0 0 0\nnan 0 0\n1 2 3\n")
    assert read_surface(tmp_path / "holes.ply").points.points.tolist() == [[0, 0, 0], [1, 2, 3]]
