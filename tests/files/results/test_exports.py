import csv

import numpy as np
import pytest
import trimesh

from core.errors import Cancelled, InputError
from core.files.results.cloud_csv import point_columns, write_points_csv
from core.files.results.mesh_export import write_stl
from core.inspect.shown.view_frame import FrameKind
from core.scan.surface.fused_surface import Mesh


@pytest.fixture
def mesh():
    """Two triangles towards the camera (−z), and one without area."""
    vertices = np.array([[0, 0, 700], [10, 0, 700], [0, 20, 700], [10, 20, 705.25]])
    triangles = np.array([[0, 2, 1], [1, 2, 3], [0, 1, 1]])
    return Mesh(vertices, np.tile([0, 0, -1.0], (4, 1)), np.full(4, 0.02), triangles)


def test_another_program_reads_the_mesh_in_mm(tmp_path, mesh):
    write_stl(tmp_path / "mesh.stl", mesh)
    back = trimesh.load_mesh(tmp_path / "mesh.stl", process=False)
    assert np.allclose(back.triangles, mesh.vertices[mesh.triangles])
    assert back.area == pytest.approx(trimesh.Trimesh(mesh.vertices, mesh.triangles).area)


def test_the_file_is_binary_stl_with_normals_towards_the_camera(tmp_path, mesh):
    write_stl(tmp_path / "mesh.stl", mesh)
    data = (tmp_path / "mesh.stl").read_bytes()
    assert len(data) == 84 + 50 * 3
    assert not data.startswith(b"solid")  # many programs would take it for text
    assert b"mm; camera frame, z forward" in data[:80]
    assert int.from_bytes(data[80:84], "little") == 3
    normals = np.array([np.frombuffer(data, "<f4", 3, 84 + 50 * k) for k in range(3)])
    assert np.allclose(normals[0], [0, 0, -1])
    assert np.allclose(np.linalg.norm(normals, axis=1), [1, 1, 0])
    assert normals[1, 2] < 0


def test_an_empty_mesh_is_still_a_file(tmp_path):
    empty = Mesh(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), np.zeros((0, 3), dtype=np.int64))
    write_stl(tmp_path / "empty.stl", empty)
    assert len((tmp_path / "empty.stl").read_bytes()) == 84


def test_points_are_read_by_numpy_to_a_nanometre(tmp_path, cloud, monkeypatch):
    monkeypatch.setattr("core.files.results.cloud_csv._ROWS_AT_ONCE", 7)
    write_points_csv(tmp_path / "cloud.csv", cloud)
    table = np.genfromtxt(tmp_path / "cloud.csv", delimiter=",", names=True)
    assert table.dtype.names == tuple(point_columns(FrameKind.CAMERA))
    assert len(table) == len(cloud)
    for names, values in (
        (("x_camera_mm", "y_camera_mm", "z_camera_mm"), cloud.points),
        (("sigma_mm",), cloud.sigma[:, None]),
        (("nx", "ny", "nz"), cloud.normals),
    ):
        assert np.allclose(np.column_stack([table[name] for name in names]), values, rtol=0, atol=5.1e-7)
    assert np.allclose(table["image_u_px"], cloud.uv[:, 0], rtol=0, atol=5.1e-5)
    assert np.allclose(table["intensity_grey"], cloud.intensity, rtol=0, atol=5.1e-4)
    assert np.array_equal(table["frame"], cloud.frame)
    assert np.array_equal(table["sweep"], cloud.sweep)


def test_every_line_has_the_columns_of_the_head(tmp_path, cloud):
    write_points_csv(tmp_path / "cloud.csv", cloud)
    with (tmp_path / "cloud.csv").open(newline="") as file:
        rows = list(csv.reader(file))
    assert rows[0][:4] == ["x_camera_mm", "y_camera_mm", "z_camera_mm", "sigma_mm"]
    assert {len(row) for row in rows} == {len(point_columns(FrameKind.CAMERA))}
    write_points_csv(tmp_path / "empty.csv", cloud.select(np.zeros(len(cloud), dtype=bool)))
    assert (tmp_path / "empty.csv").read_text() == ",".join(point_columns(FrameKind.CAMERA)) + "\n"


def test_a_cancelled_table_leaves_nothing(tmp_path, cloud):
    def cancel(step, done, total):
        raise Cancelled

    with pytest.raises(Cancelled):
        write_points_csv(tmp_path / "cloud.csv", cloud, progress=cancel)
    assert list(tmp_path.iterdir()) == []


def test_a_table_that_cannot_be_written_says_so(tmp_path, cloud):
    with pytest.raises(InputError, match="cannot be written"):
        write_points_csv(tmp_path / "nowhere" / "cloud.csv", cloud)
