import csv
from datetime import UTC, datetime

import numpy as np
import pytest
import trimesh

from core.errors import Cancelled, InputError
from core.files.csv_file import POINT_COLUMNS, write_gauge_csv, write_points_csv, write_repeats_csv
from core.files.project import Repeat
from core.files.stl import write_stl
from core.scan.surface import Mesh


@pytest.fixture
def mesh():
    """Two triangles towards the camera (−z), and one without area."""
    vertices = np.array([[0, 0, 700], [10, 0, 700], [0, 20, 700], [10, 20, 705.25]])
    triangles = np.array([[0, 2, 1], [1, 2, 3], [0, 1, 1]])
    return Mesh(vertices, np.tile([0, 0, -1.0], (4, 1)), np.full(4, 0.02), triangles)


def test_another_program_reads_the_mesh_in_mm(tmp_path, mesh):
    write_stl(tmp_path / "mesh.stl", mesh, "abc-def")
    back = trimesh.load_mesh(tmp_path / "mesh.stl", process=False)
    assert np.allclose(back.triangles, mesh.vertices[mesh.triangles])
    assert back.area == pytest.approx(trimesh.Trimesh(mesh.vertices, mesh.triangles).area)


def test_the_file_is_binary_stl_with_normals_towards_the_camera(tmp_path, mesh):
    write_stl(tmp_path / "mesh.stl", mesh, "abc-def")
    data = (tmp_path / "mesh.stl").read_bytes()
    assert len(data) == 84 + 50 * 3
    assert not data.startswith(b"solid")  # many programs would take it for text
    assert b"unit mm; calibration abc-def" in data[:80]
    assert int.from_bytes(data[80:84], "little") == 3
    normals = np.array([np.frombuffer(data, "<f4", 3, 84 + 50 * k) for k in range(3)])
    assert np.allclose(normals[0], [0, 0, -1])
    assert np.allclose(np.linalg.norm(normals, axis=1), [1, 1, 0])
    assert normals[1, 2] < 0


def test_an_empty_mesh_and_a_long_id_are_still_a_file(tmp_path):
    empty = Mesh(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), np.zeros((0, 3), dtype=np.int64))
    write_stl(tmp_path / "empty.stl", empty, "ü" * 99)
    assert len((tmp_path / "empty.stl").read_bytes()) == 84


def test_points_are_read_by_numpy_to_a_nanometre(tmp_path, cloud, monkeypatch):
    monkeypatch.setattr("core.files.csv_file._ROWS_AT_ONCE", 7)
    write_points_csv(tmp_path / "cloud.csv", cloud)
    table = np.genfromtxt(tmp_path / "cloud.csv", delimiter=",", names=True)
    assert table.dtype.names == tuple(POINT_COLUMNS)
    assert len(table) == len(cloud)
    for names, values in (
        (("x_mm", "y_mm", "z_mm"), cloud.points),
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
    rows = list(csv.reader((tmp_path / "cloud.csv").open(newline="")))
    assert rows[0][:4] == ["x_mm", "y_mm", "z_mm", "sigma_mm"]
    assert {len(row) for row in rows} == {len(POINT_COLUMNS)}
    write_points_csv(tmp_path / "empty.csv", cloud.select(np.zeros(len(cloud), dtype=bool)))
    assert (tmp_path / "empty.csv").read_text() == ",".join(POINT_COLUMNS) + "\n"


def test_a_cancelled_table_leaves_nothing(tmp_path, cloud):
    def cancel(step, done, total):
        raise Cancelled

    with pytest.raises(Cancelled):
        write_points_csv(tmp_path / "cloud.csv", cloud, cancel)
    assert list(tmp_path.iterdir()) == []


def test_a_thickness_as_a_table(tmp_path, gauge):
    write_gauge_csv(tmp_path / "gauge.csv", gauge, "abc-def")
    rows = list(csv.DictReader((tmp_path / "gauge.csv").open(newline="", encoding="utf-8")))
    values = {row["quantity"]: (row["value"], row["unit"]) for row in rows}
    assert len(values) == len(rows)
    assert float(values["thickness"][0]) == gauge.thickness_mm
    assert values["thickness"][1] == "mm"
    assert float(values["expanded uncertainty U = k u"][0]) == gauge.U_mm
    assert float(values["deviation"][0]) == gauge.deviation_mm
    assert float(values["angle between the faces"][0]) == pytest.approx(np.degrees(gauge.parallelism))
    assert values["angle between the faces"][1] == "deg"
    assert values["verdict"] == ("conforming", "")
    assert values["points on the lower face"] == ("25", "")
    assert values["u from camera"] == ("0.01", "mm")
    assert values["calibration"][0] == "abc-def"


def test_what_was_not_asked_for_is_empty_in_the_table(tmp_path, gauge):
    from dataclasses import replace

    write_gauge_csv(tmp_path / "gauge.csv", replace(gauge, nominal_mm=None, tolerance_mm=None, verdict=""))
    values = {row["quantity"]: row["value"] for row in csv.DictReader((tmp_path / "gauge.csv").open(newline=""))}
    assert values["nominal"] == values["deviation"] == values["verdict"] == ""


def test_a_series_as_a_table(tmp_path):
    at = datetime(2026, 1, 31, 12, tzinfo=UTC)
    write_repeats_csv(tmp_path / "repeats.csv", [Repeat('scan, "1"', 49.987, 0.024, 2.0, "abc", at)] * 2)
    rows = list(csv.DictReader((tmp_path / "repeats.csv").open(newline="", encoding="utf-8")))
    assert len(rows) == 2
    assert rows[0]["scan"] == 'scan, "1"'
    assert (float(rows[0]["thickness_mm"]), float(rows[0]["U_mm"]), float(rows[0]["k"])) == (49.987, 0.024, 2.0)
    assert datetime.fromisoformat(rows[0]["measured_at"]) == at


def test_a_table_that_cannot_be_written_says_so(tmp_path, gauge):
    with pytest.raises(InputError, match="cannot be written"):
        write_gauge_csv(tmp_path / "nowhere" / "gauge.csv", gauge)
