"""OBJ, 3MF, PLY and STL of a mesh, read back by a reader that is not ours."""

import numpy as np
import pytest
import trimesh

from core.files.results.mesh_export import write_3mf, write_obj, write_stl
from core.files.results.ply import read_mesh, write_mesh
from core.scan.surface.mesh_holes import fill_holes
from tests.scan.surface.test_mesh_holes import HOLED

FILLED = fill_holes(HOLED, 10.0)


def test_3mf_holds_what_was_measured_and_what_was_filled_in_millimetres(tmp_path):
    path = tmp_path / "mesh.3mf"
    write_3mf(path, FILLED, name="a < b")
    scene = trimesh.load(path)
    assert scene.units == "millimeter"
    parts = {name: part for name, part in scene.geometry.items()}
    assert sorted(len(part.faces) for part in parts.values()) == [FILLED.filled.sum(), len(HOLED.triangles)]
    measured = max(parts.values(), key=lambda part: len(part.faces))
    seen = HOLED.vertices[HOLED.measured]
    assert measured.bounds == pytest.approx(np.array([seen.min(axis=0), seen.max(axis=0)]), abs=1e-5)
    first = path.read_bytes()
    write_3mf(path, FILLED, name="a < b")
    assert path.read_bytes() == first


def test_obj_has_normals_groups_and_all_triangles(tmp_path):
    path = tmp_path / "mesh.obj"
    write_obj(path, FILLED)
    text = path.read_text()
    assert "# unit mm; frame of reference: the camera, z forward, y down\n" in text
    assert text.index("g measured") < text.index("g filled")
    loaded = trimesh.load_mesh(path, process=False)
    assert len(loaded.faces) == len(FILLED.triangles)
    assert loaded.area == pytest.approx(
        trimesh.Trimesh(FILLED.vertices, FILLED.triangles, process=False).area, rel=1e-6
    )
    write_obj(path, HOLED)
    assert "filled" not in path.read_text()


def test_ply_marks_filled_triangles_and_only_them(tmp_path):
    path = tmp_path / "mesh.ply"
    write_mesh(path, FILLED, "abc")
    again = read_mesh(path)
    assert np.array_equal(again.filled, FILLED.filled)
    assert len(trimesh.load_mesh(path, process=False).faces) == len(FILLED.triangles)
    write_mesh(path, HOLED, "abc")
    assert b"filled" not in path.read_bytes()[:2000]
    assert not read_mesh(path).filled.any()


def test_stl_holds_all_triangles(tmp_path):
    path = tmp_path / "mesh.stl"
    write_stl(path, FILLED)
    assert len(trimesh.load_mesh(path, process=False).faces) == len(FILLED.triangles)
