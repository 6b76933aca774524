"""The frame of what is handed over: the part's own, z up from its lower face, or the camera's by choice."""

from __future__ import annotations

import json

import numpy as np
import pye57
import pytest
import trimesh

from core.errors import InputError
from core.files.project.folder import results_folder
from core.files.results.gauge_file import read_gauge
from core.files.results.ply import read_cloud, read_mesh
from core.files.results.ply_format import parse_ply
from core.inspect.shown.view_frame import FrameKind
from core.model import Pose
from core.pipeline.project.export import export_results
from core.pipeline.steps.export_kinds import frame_of
from core.pipeline.steps.mesh_step import MeshOptions, mesh_step
from tests.simulated import copy_of

TURNED = Pose.from_vector([0.4, -0.3, 0.2, 10.0, -20.0, 650.0])


@pytest.fixture
def results(done, tmp_path):
    return results_folder(copy_of(done.folder, tmp_path / "project"))


def heights(points, on):
    """Median height of the points of each face."""
    return np.median(points[on.lower.indices, 2]), np.median(points[on.upper.indices, 2])


def test_clouds_and_surfaces_are_written_with_z_up_from_the_lower_face(results, tmp_path):
    cloud = read_cloud(results / "cloud.ply").cloud
    gauge = read_gauge(results / "gauge.json", cloud)
    kinds = ["cloud", "csv", "e57", "mesh", "stl", "obj", "3mf"]
    paths = export_results(results, kinds, tmp_path / "to")
    vertices = parse_ply(paths["cloud"].read_bytes()).elements["vertex"]
    table = np.genfromtxt(paths["csv"], delimiter=",", names=True)
    metres = pye57.E57(str(paths["e57"])).read_scan(0, ignore_missing_fields=True)
    clouds = {
        "cloud": np.column_stack([vertices[axis] for axis in "xyz"]),
        "csv": np.column_stack([table[name] for name in ("x_face_mm", "y_face_mm", "height_over_face_mm")]),
        "e57": 1e3 * np.column_stack([metres[f"cartesian{axis}"] for axis in "XYZ"]),
    }
    for name, points in clouds.items():
        low, high = heights(points, gauge)
        assert low == pytest.approx(0, abs=0.05), name
        assert high == pytest.approx(gauge.thickness_mm, abs=0.1), name
    surface = read_mesh(results / "mesh.ply")
    wanted = frame_of(results, in_camera_frame=False).coordinates(surface.vertices[surface.triangles]).reshape(-1, 3)
    for name in ("mesh", "stl", "obj", "3mf"):
        loaded = trimesh.load(paths[name], force="mesh", process=False)
        assert loaded.triangles.reshape(-1, 3).min(axis=0) == pytest.approx(wanted.min(axis=0), abs=1e-3), name
        assert loaded.triangles.reshape(-1, 3).max(axis=0) == pytest.approx(wanted.max(axis=0), abs=1e-3), name
        assert np.median(loaded.face_normals[:, 2]) > 0.9, f"{name}: a surface seen from above faces up"


def test_every_head_names_unit_and_frame(results, tmp_path):
    for camera, words in ((False, b"z up from"), (True, b"z forward")):
        paths = export_results(results, ["cloud", "mesh", "stl", "obj"], tmp_path / f"{camera}", in_camera_frame=camera)
        for path in paths.values():
            head = path.read_bytes()[:1500]
            assert words in head, path.name
            assert b"mm" in head, path.name


def test_by_choice_they_are_as_the_camera_sees_them_and_the_same_bytes_as_the_results(results, tmp_path):
    paths = export_results(results, ["cloud", "mesh"], tmp_path / "to", in_camera_frame=True)
    for name, path in paths.items():
        assert path.read_bytes() == (results / f"{name}.ply").read_bytes()


def test_what_is_read_back_is_the_same_cloud_and_mesh(results, tmp_path):
    paths = export_results(results, ["cloud", "mesh"], tmp_path / "to")
    ours, back = read_cloud(results / "cloud.ply"), read_cloud(paths["cloud"])
    assert back.calibration_id == ours.calibration_id
    assert np.abs(back.cloud.points - ours.cloud.points).max() < 1e-9
    assert np.abs(back.cloud.normals - ours.cloud.normals).max() < 1e-6
    mesh, again = read_mesh(results / "mesh.ply"), read_mesh(paths["mesh"])
    assert np.abs(again.vertices - mesh.vertices).max() < 1e-4


def test_part_coordinates_of_an_inspection_come_before_the_lower_face(results, tmp_path):
    placed = {"rotation": TURNED.rotation.tolist(), "translation_mm": TURNED.translation.tolist()}
    (results / "inspection.json").write_text(json.dumps({"schema_version": 1, "pose_camera_part": placed}))
    assert frame_of(results, in_camera_frame=False).kind is FrameKind.PART
    paths = export_results(results, ["csv"], tmp_path / "to")
    table = np.genfromtxt(paths["csv"], delimiter=",", names=True)
    points = np.column_stack([table[f"{axis}_part_mm"] for axis in "xyz"])
    assert np.allclose(TURNED.apply(points), read_cloud(results / "cloud.ply").cloud.points, atol=2e-6)


def test_without_a_thickness_they_are_as_the_camera_sees_them(results, tmp_path):
    (results / "gauge.json").unlink()
    paths = export_results(results, ["csv", "mesh"], tmp_path / "to")
    assert paths["csv"].read_text().startswith("x_camera_mm,")
    assert paths["mesh"].read_bytes() == (results / "mesh.ply").read_bytes()


def test_a_result_is_never_replaced_by_its_export(results):
    before = (results / "cloud.ply").read_bytes()
    with pytest.raises(InputError, match=r"would replace the result itself.*--frame camera"):
        export_results(results, ["cloud"])
    assert (results / "cloud.ply").read_bytes() == before


def test_a_surface_made_ready_lies_as_its_export_does(results, tmp_path):
    _, written = mesh_step(results, ["ply", "stl"], MeshOptions(), tmp_path)
    exported = export_results(results, ["stl"], tmp_path / "to")
    assert written["stl"].read_bytes() == exported["stl"].read_bytes()
    assert b"z up from its lower face" in written["ply"].read_bytes()[:800]


@pytest.mark.parametrize("numbers", ["1 2 3", "a b c", " ".join(["1"] * 12), " ".join(["nan"] * 12)])
def test_a_motion_that_is_none_is_told(results, tmp_path, numbers):
    path = export_results(results, ["cloud"], tmp_path / "to")["cloud"]
    data = path.read_bytes()
    start = data.index(b"into the camera frame: ")
    end = data.index(b"\n", start)
    path.write_bytes(data[:start] + b"into the camera frame: " + numbers.encode() + data[end:])
    with pytest.raises(InputError, match="no rotation and translation"):
        read_cloud(path)


def test_another_frame_without_its_motion_is_not_taken_for_the_cameras(results, tmp_path):
    for name, path in export_results(results, ["cloud", "mesh"], tmp_path / "to").items():
        data = path.read_bytes()
        start = data.index(b"comment into the camera frame: ")
        path.write_bytes(data[:start] + data[data.index(b"\n", start) + 1 :])
        with pytest.raises(InputError, match="is missing or no rotation"):
            (read_cloud if name == "cloud" else read_mesh)(path)
