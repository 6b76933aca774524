import json
import math
from dataclasses import replace
from datetime import UTC, datetime

import meshio
import numpy as np
import pytest
import trimesh

from core.calibrate.board_shape import Board, BoardShape
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.errors import InputError
from core.files.json_text import to_json
from core.files.recording.features_file import read_poses, write_poses
from core.files.results.camera_file import camera_id, read_camera, write_camera
from core.files.results.gauge_file import read_gauge, read_thickness, write_gauge
from core.files.results.planes_file import read_planes, write_planes
from core.files.results.ply import read_cloud, read_mesh, write_cloud, write_mesh
from core.files.results.ply_format import Ply, parse_ply, ply_bytes
from core.files.results.run_file import RunRecord, read_run, write_run
from core.files.results.scan_file import ScanFile, read_scan, write_scan
from core.findings.table import note_of
from core.image.stripes.centreline import Centreline
from core.image.stripes.extraction import StripeSettings
from core.image.targets.target_view import TargetView
from core.inspect.causes import cause_named
from core.inspect.results import Contribution, PairCandidate
from core.messages import Message, plain
from core.model import Camera, Fan
from core.scan.common_errors import CommonErrors
from core.scan.features.crossings import CrossingTable
from core.scan.features.extraction import FrameFeatures, ScanFeatures
from core.scan.first_cause import Cause, Suspect
from core.scan.network.fan_speckle import FanSpeckle
from core.scan.part_light import PartLight
from core.scan.results import FrameRecord
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh
from tests.files.conftest import square

NOTE = Message("scan.fan_disagrees", "{n} of them.", n=3)
FAULTS = (note_of("scan.compressed", grey=3.0, noise=1.0),)


def edited(path, change):
    tables = json.loads(path.read_text())
    change(tables)
    path.write_text(json.dumps(tables))


def test_camera_round_trip_is_exact_and_has_the_keys_of_the_design(tmp_path, camera):
    path = tmp_path / "camera.json"
    write_camera(path, camera)
    tables = json.loads(path.read_text())
    assert {"image_size", "matrix", "distortion", "rms_px", "sd", "views"} <= set(tables)
    assert {"k1", "k2", "p1", "p2"} <= set(tables["distortion"])
    assert tables["sd"]["alpha"] == camera.sd["alpha"]
    back = read_camera(path)
    assert back.camera.image_size == camera.camera.image_size
    assert np.array_equal(back.camera.matrix, camera.camera.matrix)
    assert np.array_equal(back.camera.distortion, camera.camera.distortion)
    assert np.array_equal(back.covariance, camera.covariance)
    assert np.isnan(back.cross_validation_mm)
    assert np.allclose(back.views[0].residuals, camera.views[0].residuals, atol=1e-6)
    assert np.allclose(back.views[0].pose.translation, [1, 2, 600])
    assert back.views[0].counted.tolist() == [True] * 5 + [False]
    assert np.isnan(back.views[1].residuals).all()
    assert (back.views[1].used, str(back.views[1].reason)) == (False, "too few corners")


def test_a_camera_of_another_program_needs_only_its_parameters(tmp_path):
    path = tmp_path / "camera.json"
    path.write_text(
        '{"image_size": [640, 480], "matrix": [[800, 0, 320], [0, 800, 240], [0, 0, 1]], "software": "other",'
        ' "distortion": {"k1": 0, "k2": 0, "p1": 0, "p2": 0}}'
    )
    back = read_camera(path)
    assert back.camera.focal == pytest.approx(800)
    assert not back.covariance.any()
    assert back.views == ()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda t: t["matrix"][0].__setitem__(2, float("nan")), "matrix[0][2] is NaN, but matrix must be 3 × 3 finite"),
        (lambda t: t["matrix"][1].__setitem__(1, 0), "matrix[1][1] is 0, but a focal length in pixels is above 0"),
        (lambda t: t["matrix"].pop(), "matrix is "),
        (lambda t: t["matrix"][2].__setitem__(2, 2), "matrix is not of the form"),
        (lambda t: t["distortion"].__setitem__("k1", float("inf")), "distortion.k1 is Infinity, not a finite number"),
        (lambda t: t["distortion"].pop("p2"), "distortion.p2 is missing"),
        (lambda t: t.pop("distortion"), "distortion is missing; it must be a table of k1, k2, p1, p2"),
        (lambda t: t["image_size"].__setitem__(0, 0), "image_size[0] is 0, but image_size must be [width, height]"),
        (lambda t: t.__setitem__("image_size", "1920x1374"), 'image_size is "1920x1374", not [width, height]'),
        (lambda t: t["covariance"].pop(), "covariance is not 10 × 10 numbers"),
        (lambda t: t["covariance"][3].__setitem__(3, float("nan")), "covariance[3][3] is NaN"),
        (lambda t: t.__setitem__("rms_px", "small"), 'rms_px is "small", not a finite number'),
    ],
)
def test_a_spoilt_camera_file_is_refused_by_field(tmp_path, camera, change, said):
    path = tmp_path / "camera.json"
    write_camera(path, camera)
    edited(path, change)
    with pytest.raises(InputError) as error:
        read_camera(path)
    assert str(error.value).startswith(f"{path}: ")
    assert said in str(error.value)


def test_missing_and_broken_files_say_what_to_do(tmp_path):
    with pytest.raises(InputError, match=r"camera\.json: the file is missing; calibrate the camera first"):
        read_camera(tmp_path / "camera.json")
    (tmp_path / "camera.json").write_text('{"image_size": [1, 2')
    with pytest.raises(InputError, match=r"camera\.json: this is no valid JSON"):
        read_camera(tmp_path / "camera.json")
    (tmp_path / "camera.json").write_text("[1, 2, 3]")
    with pytest.raises(InputError, match=r"camera\.json"):
        read_camera(tmp_path / "camera.json")


def test_the_shape_of_the_board_is_kept(tmp_path, camera):
    board = Board(np.array([80.0, 55.0]), np.array([80.0, 55.0]))
    bowed = BoardShape(board, np.array([0.2, -0.1, 0.05, 1e-4]), np.diag([1e-6, 1e-6, 1e-6, 1e-9]))
    path = tmp_path / "camera.json"
    write_camera(path, replace(camera, board=bowed))
    back = read_camera(path).board
    assert np.array_equal(back.values, bowed.values)
    assert np.array_equal(back.covariance, bowed.covariance)
    assert np.array_equal(back.shaped(np.ones((1, 3))), bowed.shaped(np.ones((1, 3))))
    assert json.loads(path.read_text())["board"]["departure_mm"] == bowed.departure_mm


def test_fan_round_trip_is_exact_and_has_the_keys_of_the_design(tmp_path, camera, fan):
    path = tmp_path / "planes.json"
    write_planes(path, fan, camera.camera)
    tables = json.loads(path.read_text())
    assert set(tables["planes"][0]) >= {"normal", "d_mm", "pi", "rms_mm"}
    assert set(tables["angles_deg"]) == {"constrained", "free"}
    assert tables["camera_id"] == camera_id(camera.camera)
    back = read_planes(path, camera.camera)
    assert np.array_equal(back.fan.pis, fan.fan.pis)
    assert np.array_equal(back.fan.covariance, fan.fan.covariance)
    assert np.allclose(back.angles, fan.angles, rtol=1e-14)
    assert (back.verdict, back.constraint_suits, back.notes) == (fan.verdict, True, (plain("note"),))
    assert back.poses[0].name == "p1"


def test_what_the_fan_knows_of_its_camera_and_its_target_is_kept(tmp_path, camera, fan):
    rng = np.random.default_rng(3)
    path = tmp_path / "planes.json"
    corrected = Camera(camera.camera.image_size, camera.camera.matrix * 1.0001, camera.camera.distortion)
    known = replace(
        fan,
        by_camera=rng.normal(size=(9, 10)),
        scale_sd=2e-4,
        board=BoardShape(Board(np.zeros(2), np.full(2, 70.0)), np.array([0.1, 0.2, 0, 0]), 1e-4 * np.eye(4)),
        cross_validation_mm=0.02,
        poses=(replace(fan.poses[0], prediction_mm=0.03),),
        camera=corrected,
        camera_covariance=0.5 * camera.covariance,
    )
    write_planes(path, known, camera.camera)
    back = read_planes(path, camera.camera)
    assert np.array_equal(back.by_camera, known.by_camera)
    assert (back.board.values == known.board.values).all()
    assert (back.board.sd == known.board.sd).all()
    assert (back.scale_sd, back.cross_validation_mm, back.poses[0].prediction_mm) == (2e-4, 0.02, 0.03)
    used = back.camera_used(camera)
    assert camera_id(used.camera) == camera_id(corrected)
    assert np.array_equal(used.covariance, 0.5 * camera.covariance)
    assert fan.camera_used(camera) is camera


def test_how_sure_the_free_planes_are_is_kept_and_its_absence_is_not_known(tmp_path, camera, fan):
    path, sure = tmp_path / "planes.json", Fan(fan.free.planes, np.diag(np.full(3 * len(fan.free.planes), 1e-14)))
    write_planes(path, replace(fan, free=sure), camera.camera)
    back = read_planes(path, camera.camera)
    assert np.array_equal(back.free.covariance, sure.covariance) and back.free.angle_sds == sure.angle_sds
    edited(path, lambda t: t["free_covariance"].pop())
    with pytest.raises(InputError, match="free_covariance is not"):
        read_planes(path, camera.camera)
    edited(path, lambda t: t.pop("free_covariance"))  # as of an earlier version
    assert not read_planes(path, camera.camera).free.has_covariance


def test_a_normal_that_contradicts_pi_is_refused(tmp_path, camera, fan):
    path = tmp_path / "planes.json"
    write_planes(path, fan, camera.camera)
    tables = json.loads(path.read_text())
    tables["planes"][1]["normal"] = [0.0, 0.0, 0.0]
    path.write_text(json.dumps(tables))
    with pytest.raises(InputError, match=r"planes\[1\].*normal"):
        read_planes(path, camera.camera)


def test_planes_of_another_camera_are_refused(tmp_path, camera, fan):
    write_planes(tmp_path / "planes.json", fan, camera.camera)
    other = Camera((1920, 1374), camera.camera.matrix * [[1.001, 1, 1], [1, 1, 1], [1, 1, 1]])
    with pytest.raises(InputError, match="the camera was calibrated again; calibrate the laser planes again"):
        read_planes(tmp_path / "planes.json", other)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda t: t["planes"][1].__setitem__("pi", [0, 0, 0]), "planes[1].pi is [0, 0, 0], not three finite numbers"),
        (lambda t: t["planes"][2]["pi"].__setitem__(0, float("nan")), "planes[2].pi[0] is NaN"),
        (lambda t: t["planes"][0].pop("pi"), "planes[0].pi is missing"),
        (lambda t: t.__setitem__("planes", []), "planes is [], not a list of one or more"),
        (lambda t: t["covariance"].pop(), "covariance is not 9 × 9 numbers"),
        (lambda t: t.__setitem__("by_camera", [[0.0]]), "by_camera is not 9 × 10 numbers"),
        (lambda t: t.__setitem__("scale_sd", 2.0), "scale_sd is 2.0, not a share of the target's size"),
        (lambda t: t["free_planes"].pop(), "free_planes has 2 planes, not 3"),
    ],
)
def test_a_spoilt_planes_file_is_refused_by_field(tmp_path, camera, fan, change, said):
    path = tmp_path / "planes.json"
    write_planes(path, fan, camera.camera)
    edited(path, change)
    with pytest.raises(InputError) as error:
        read_planes(path, camera.camera)
    assert str(error.value).startswith(f"{path}: ")
    assert said in str(error.value)


def test_cloud_round_trip(tmp_path, cloud):
    path = tmp_path / "cloud.ply"
    write_cloud(path, cloud, "abc")
    back = read_cloud(path)
    assert back.calibration_id == "abc"
    assert np.array_equal(back.cloud.points, cloud.points)
    assert np.allclose(back.cloud.sigma, cloud.sigma, rtol=1e-6)
    assert np.allclose(back.cloud.uv, cloud.uv, atol=1e-4)
    assert np.array_equal(back.cloud.frame, cloud.frame)
    assert np.array_equal(back.cloud.sweep, cloud.sweep)
    write_cloud(tmp_path / "again.ply", back.cloud, "abc")
    assert (tmp_path / "again.ply").read_bytes() == path.read_bytes()


def test_each_point_of_joined_views_keeps_its_view(tmp_path, cloud):
    view = np.arange(len(cloud)) % 3
    write_cloud(tmp_path / "joined.ply", replace(cloud, view=view), "abc")
    assert read_cloud(tmp_path / "joined.ply").cloud.view.tolist() == view.tolist()


def test_what_calibrations_add_to_sigma_is_a_property_behind_those_of_the_design(tmp_path, cloud):
    path = tmp_path / "cloud.ply"
    common = np.linspace(0.01, 0.02, len(cloud))
    write_cloud(path, replace(cloud, sigma_common=common), "abc")
    assert np.allclose(read_cloud(path).cloud.sigma_common, common, rtol=1e-6)
    assert parse_ply(path.read_bytes()).elements["vertex"].dtype.names[12:15] == ("sigma_common", "skewness", "spread")
    path.write_bytes(path.read_bytes().replace(b"property float sigma_common", b"property float of_another_prog"))
    assert not read_cloud(path).cloud.sigma_common.any()  # a file of an earlier version: not known


def test_cloud_is_the_ply_of_the_design(tmp_path, cloud):
    write_cloud(tmp_path / "cloud.ply", cloud, "abc")
    written = (tmp_path / "cloud.ply").read_bytes()
    assert written.startswith(b"ply\nformat binary_little_endian 1.0\n")
    data = parse_ply(written)
    names = data.elements["vertex"].dtype.names
    assert list(names[:9]) == ["x", "y", "z", "nx", "ny", "nz", "sigma", "intensity", "frame"]
    assert "unit mm" in data.comments
    assert "calibration abc" in data.comments
    assert any(line.startswith("Trisect ") for line in data.comments)


def test_cloud_and_mesh_are_read_alike_by_another_program(tmp_path, cloud):
    write_cloud(tmp_path / "cloud.ply", cloud, "abc")
    theirs = meshio.read(tmp_path / "cloud.ply")
    assert theirs.points.dtype == np.float32, "filters of PCL drop points whose coordinates are double"
    assert np.array_equal(theirs.points, cloud.points.astype(np.float32))
    assert np.allclose(theirs.point_data["sigma"], cloud.sigma, rtol=1e-6)
    assert np.array_equal(theirs.point_data["frame"], cloud.frame)
    corners = np.array([[0, 1, 2], [2, 3, 4]])
    mesh = Mesh(np.eye(5)[:, :3], np.eye(5)[:, :3], np.ones(5), corners, np.array([False, True]))
    write_mesh(tmp_path / "mesh.ply", mesh, "abc")
    assert np.array_equal(trimesh.load_mesh(tmp_path / "mesh.ply", process=False).faces, corners)
    assert read_mesh(tmp_path / "mesh.ply").filled.tolist() == [False, True]


def test_every_point_has_a_normal_and_the_file_says_which_are_rays(tmp_path, cloud):
    known = cloud.normals.copy()
    known[::3] = 0.0
    write_cloud(tmp_path / "cloud.ply", replace(cloud, normals=known), "abc")
    theirs = meshio.read(tmp_path / "cloud.ply")
    normals = np.column_stack([theirs.point_data[name] for name in ("nx", "ny", "nz")])
    assert np.allclose(np.linalg.norm(normals, axis=1)[::3], 1.0, atol=1e-6)
    back = -cloud.points[::3] / np.linalg.norm(cloud.points[::3], axis=1, keepdims=True)
    assert np.allclose(normals[::3], back, atol=1e-6)
    assert np.array_equal(theirs.point_data["normal_seen"] == 0, np.arange(len(cloud)) % 3 == 0)
    assert np.allclose(read_cloud(tmp_path / "cloud.ply").cloud.normals, known, atol=1e-6), "ours are unknown as before"
    assert any(line.startswith("normal_seen") for line in parse_ply((tmp_path / "cloud.ply").read_bytes()).comments)


@pytest.mark.parametrize(("moved_mm", "offset"), [(0.0, False), (1500.0, False), (20_000.0, True)])
def test_single_precision_loses_less_than_a_tenth_of_a_micrometre_wherever_the_part_is(
    tmp_path, cloud, moved_mm, offset
):
    points = cloud.points + [0.0, 0.0, moved_mm - cloud.points[:, 2].min()]
    write_cloud(tmp_path / "cloud.ply", replace(cloud, points=points), "abc")
    data = parse_ply((tmp_path / "cloud.ply").read_bytes())
    told = [line for line in data.comments if line.startswith("offset ")]
    assert bool(told) is offset
    add = np.array([float(word) for word in told[0].split(":")[0].split()[1:]]) if told else np.zeros(3)
    theirs = meshio.read(tmp_path / "cloud.ply").points.astype(float) + add
    assert np.abs(theirs - points).max() < 1e-4
    assert np.allclose(read_cloud(tmp_path / "cloud.ply").cloud.points, points, rtol=0, atol=1e-11)


def test_clouds_of_earlier_versions_have_coordinates_in_double_and_are_read(tmp_path, cloud):
    write_cloud(tmp_path / "new.ply", cloud, "abc")
    rows = parse_ply((tmp_path / "new.ply").read_bytes()).elements["vertex"]
    names = rows.dtype.names[:15]
    earlier = np.empty(len(rows), [(name, "f8" if name in ("x", "y", "z") else rows.dtype[name]) for name in names])
    for name in names:
        earlier[name] = rows[name]
    for axis, name in enumerate(("x", "y", "z")):
        earlier[name] = cloud.points[:, axis]
    (tmp_path / "old.ply").write_bytes(ply_bytes(Ply({"vertex": earlier}, ("unit mm", "calibration abc"))))
    assert np.array_equal(read_cloud(tmp_path / "old.ply").cloud.points, cloud.points)


def test_truncated_and_spoilt_clouds_are_refused(tmp_path, cloud):
    path = tmp_path / "cloud.ply"
    write_cloud(path, cloud, "abc")
    whole = path.read_bytes()
    path.write_bytes(whole[:-10])
    with pytest.raises(InputError, match=r"cloud\.ply: this is no whole PLY"):
        read_cloud(path)
    path.write_bytes(b"hello")
    with pytest.raises(InputError, match=r"cloud\.ply: this is no whole PLY"):
        read_cloud(path)
    path.write_bytes(whole.replace(b"property float sigma", b"property float noise"))
    with pytest.raises(InputError, match="lacks the property sigma"):
        read_cloud(path)
    with pytest.raises(InputError, match="the file is missing; measure the scan first"):
        read_cloud(tmp_path / "none.ply")
    points = cloud.points.copy()
    points[3, 2] = np.nan
    write_cloud(
        path, Cloud(points, cloud.uv, cloud.sigma, cloud.intensity, cloud.frame, cloud.sweep, cloud.normals), ""
    )
    with pytest.raises(InputError, match="property z is not finite in 1 of 50 points"):
        read_cloud(path)


def test_mesh_round_trip(tmp_path):
    rng = np.random.default_rng(3)
    mesh = Mesh(rng.normal(size=(5, 3)), rng.normal(size=(5, 3)), rng.uniform(size=5), np.array([[0, 1, 2], [2, 3, 4]]))
    write_mesh(tmp_path / "mesh.ply", mesh, "abc")
    back = read_mesh(tmp_path / "mesh.ply")
    assert np.allclose(back.vertices, mesh.vertices, atol=1e-6)
    assert np.array_equal(back.triangles, mesh.triangles)
    empty = Mesh(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), np.zeros((0, 3), dtype=np.int64))
    write_mesh(tmp_path / "empty.ply", empty, "abc")
    assert read_mesh(tmp_path / "empty.ply").triangles.shape == (0, 3)


@pytest.mark.parametrize("bits", [0x7FA00000, 0x7FC00000, 0x7F800000], ids=["signalling NaN", "NaN", "infinite"])
def test_a_mesh_with_a_corner_nowhere_is_refused(tmp_path, bits):
    """Found by `make fuzz`: a NaN that signals was a warning of numpy, not a sentence."""
    write_mesh(tmp_path / "mesh.ply", Mesh(np.ones((3, 3)), np.ones((3, 3)), np.ones(3), np.array([[0, 1, 2]])), "a")
    data = (tmp_path / "mesh.ply").read_bytes()
    head, end, body = data.partition(b"end_header\n")
    (tmp_path / "mesh.ply").write_bytes(head + end + bits.to_bytes(4, "little") + body[4:])
    with pytest.raises(InputError, match="property x is not finite in 1 of 3 points"):
        read_mesh(tmp_path / "mesh.ply")


def test_a_mesh_of_squares_is_refused(tmp_path):
    squares = np.zeros(2, dtype=[("vertex_indices", "i4", (4,))])
    vertices = np.zeros(4, dtype=[(name, "f4") for name in ("x", "y", "z", "nx", "ny", "nz", "sigma")])
    (tmp_path / "mesh.ply").write_bytes(ply_bytes(Ply({"vertex": vertices, "face": squares})))
    with pytest.raises(InputError, match=r"mesh\.ply: its faces are no triangles"):
        read_mesh(tmp_path / "mesh.ply")


def centreline(rng, count):
    angle = rng.uniform(0, 6, count)
    normal = np.column_stack([np.cos(angle), np.sin(angle)])
    return Centreline(rng.uniform(0, 99, (count, 2)), normal, *rng.uniform(1, 2, (3, count)), angle > 3, 7.5)


@pytest.fixture
def scan():
    rng = np.random.default_rng(4)
    two, one = rng.normal(size=(2, 5, 2)), rng.uniform(size=(4, 5))
    index = np.arange(5)
    crossings = CrossingTable(
        two[0], two[1], two[1], one[0], one[1], index, index - 2, index, index, one[2], one[3], 40.0
    )  # fmt: skip
    frames = (
        FrameFeatures(0, "scan/a.png", (centreline(rng, 4), centreline(rng, 5)), None, 0.1),
        FrameFeatures(1, "scan/b.png", (), plain("the picture ends early"), 0.0),
        FrameFeatures(2, "scan/ß.png", (centreline(rng, 3),), None, 0.2),
    )
    fan = (centreline(rng, 4), centreline(rng, 7))
    features = ScanFeatures((99, 88), fan, frames, crossings, None, StripeSettings(10.0, 80.0), (NOTE,), FAULTS)
    return ScanFile(
        features, rng.normal(size=(2, 3)), square(rng, 6, 1e-6), np.array([0, 2]), (0, -1), rng.normal(size=(4, 2)), 2,
        "abc",
    )  # fmt: skip


def test_scan_round_trip_gives_the_same_bytes(tmp_path, scan):
    path = tmp_path / "scan.npz"
    write_scan(path, scan)
    back = read_scan(path)
    assert np.array_equal(back.covariance, scan.covariance)
    features = back.features
    assert np.array_equal(features.fan[1].uv, scan.features.fan[1].uv)
    assert features.fan[1].correlation_px == 7.5
    assert features.fan[0].saturated.tolist() == scan.features.fan[0].saturated.tolist()
    assert [len(frame.centrelines) for frame in features.frames] == [2, 0, 1]
    assert [frame.name for frame in features.frames] == ["scan/a.png", "scan/b.png", "scan/ß.png"]
    assert features.frames[1].reason == plain("the picture ends early")
    assert [(note.code, str(note)) for note in features.notes] == [(NOTE.code, str(NOTE))]
    assert features.faults == FAULTS
    assert np.array_equal(features.crossings.along_b, scan.features.crossings.along_b)
    assert (features.sweep_stripe, features.fan_stripe) == (None, StripeSettings(10.0, 80.0))
    assert (back.fan_line, back.shown, back.calibration_id) == ((0, -1), 2, "abc")
    write_scan(tmp_path / "again.npz", back)
    assert (tmp_path / "again.npz").read_bytes() == path.read_bytes()


def test_how_wide_stripes_are_on_the_part_is_kept(tmp_path, scan):
    light = PartLight(0.2, 0.01, 0.3, np.array([1e-4, 2e-4, 2e-3]))
    write_scan(tmp_path / "scan.npz", replace(scan, part_light=light))
    back = read_scan(tmp_path / "scan.npz").part_light
    assert (back.wider, back.error, back.behind_mm) == (0.2, 0.01, 0.3)
    assert back.table.tolist() == light.table.tolist()


def test_causes_that_were_compared_are_kept_and_of_another_version_passed_by(tmp_path, scan):
    causes = (Cause(Suspect.MOVED, 0.83, 12, 1e-9), Cause(Suspect.SECOND_BOUNCES, 0.1, 40, 1e-4))
    write_scan(tmp_path / "scan.npz", replace(scan, causes=causes))
    assert read_scan(tmp_path / "scan.npz").causes == causes
    arrays = dict(np.load(tmp_path / "scan.npz"))
    np.savez(tmp_path / "scan.npz", **{**arrays, "cause_suspects": np.array(["melted", "second_bounces"])})
    assert read_scan(tmp_path / "scan.npz").causes == causes[1:]
    write_scan(tmp_path / "scan.npz", scan)
    assert read_scan(tmp_path / "scan.npz").causes == ()


def test_second_bounces_of_a_scan_are_kept(tmp_path, scan):
    write_scan(tmp_path / "scan.npz", replace(scan, second_bounces=((0, 1), (2, 0))))
    assert read_scan(tmp_path / "scan.npz").second_bounces == ((0, 1), (2, 0))
    write_scan(tmp_path / "scan.npz", scan)
    assert read_scan(tmp_path / "scan.npz").second_bounces == ()


def test_what_displaced_calibrations_do_is_kept_with_the_scan(tmp_path, scan):
    rng = np.random.default_rng(6)
    cameras = rng.normal(size=(3, 10))
    common = CommonErrors((99, 88), ("camera", "fan"), cameras, rng.normal(size=(3, 3, 3)), rng.normal(size=(3, 2, 3)))
    path = tmp_path / "scan.npz"
    write_scan(path, scan)
    assert read_scan(path).common is None
    write_scan(path, replace(scan, common=common))
    back = read_scan(path).common
    assert (back.sources, back.image_size) == (("camera", "fan"), (99, 88))
    for name in ("cameras", "fans", "sweeps"):
        assert np.array_equal(getattr(back, name), getattr(common, name))
    write_scan(path, replace(scan, common=replace(common, sweeps=rng.normal(size=(3, 4, 3)))))
    with pytest.raises(InputError, match="4 sweeps, not 2"):
        read_scan(path)


def test_what_fan_and_sweeps_have_in_common_is_kept_with_the_scan(tmp_path, scan):
    rng = np.random.default_rng(7)
    index = np.array([0, 0, 1])
    speckle = FanSpeckle(
        rng.normal(size=(3, 2)), index, np.array([2, 1]), index, rng.normal(size=(3, 2)), rng.normal(size=(6, 2))
    )
    path = tmp_path / "scan.npz"
    write_scan(path, scan)
    assert read_scan(path).speckle is None
    write_scan(path, replace(scan, speckle=speckle))
    back = read_scan(path).speckle
    for name in ("uv", "cell", "members", "first", "shares", "covariance"):
        assert np.array_equal(getattr(back, name), getattr(speckle, name))
    write_scan(path, replace(scan, speckle=replace(speckle, covariance=rng.normal(size=(9, 2)))))
    with pytest.raises(InputError, match="9 rows, not 6"):
        read_scan(path)


def test_spoilt_scan_files_are_refused(tmp_path, scan):
    path = tmp_path / "scan.npz"
    write_scan(path, replace(scan, pis=np.full((2, 3), np.nan)))
    with pytest.raises(InputError, match=r"scan\.npz: the array pis holds values that are not finite"):
        read_scan(path)
    write_scan(path, replace(scan, covariance=np.zeros((5, 5))))
    with pytest.raises(InputError, match=r"covariance has shape \(5, 5\), not 6 × 6"):
        read_scan(path)
    write_scan(path, scan)
    path.write_bytes(path.read_bytes()[:-50])
    with pytest.raises(InputError, match=r"scan\.npz: this is no whole file of arrays"):
        read_scan(path)
    np.savez(path, pis=np.zeros((2, 3)))
    with pytest.raises(InputError, match="the array image_size is missing"):
        read_scan(path)
    with pytest.raises(InputError, match="the file is missing; measure the scan first"):
        read_scan(tmp_path / "none.npz")


def test_poses_round_trip_and_belong_to_their_fan(tmp_path):
    rng = np.random.default_rng(5)
    view = TargetView(rng.normal(size=(4, 3)), rng.normal(size=(4, 2)), np.ones(4), "p1")
    covariance = np.cov(rng.normal(size=(8, 20)))
    poses = (
        PoseFeatures("p1", view, (centreline(rng, 6),)),
        PoseFeatures("p2", None, (), plain("no target"), moved_px=0.75),
        PoseFeatures("p3", replace(view, name="p3", covariance=covariance), (centreline(rng, 2), centreline(rng, 3))),
    )
    write_poses(tmp_path / "planes.npz", "fan1", poses)
    back = read_poses(tmp_path / "planes.npz", "fan1")
    assert [(pose.name, pose.reason, len(pose.centrelines)) for pose in back] == [
        ("p1", None, 1),
        ("p2", plain("no target"), 0),
        ("p3", None, 2),
    ]
    assert back[1].view is None
    assert [pose.target_moved for pose in back] == [False, True, False]
    assert np.array_equal(back[2].view.uv, view.uv)
    assert back[0].view.covariance is None
    assert np.array_equal(back[2].view.covariance, covariance)
    assert np.array_equal(back[2].centrelines[1].uv, poses[2].centrelines[1].uv)
    assert [pose.others for pose in back] == [{}] * 3
    assert read_poses(tmp_path / "planes.npz", "another fan") == ()
    assert read_poses(tmp_path / "none.npz", "fan1") == ()


def test_stripes_of_poses_in_other_channels_round_trip(tmp_path):
    rng = np.random.default_rng(6)
    blue, green = (centreline(rng, 2), centreline(rng, 3)), (centreline(rng, 4),)
    poses = [
        PoseFeatures("p1", None, (), others={"blue": blue}),
        PoseFeatures("p2", None, ()),
        PoseFeatures("p3", None, (), others={"green": green, "blue": blue[:1]}),
    ]
    path = tmp_path / "planes.npz"
    write_poses(path, "fan1", poses)
    back = read_poses(path, "fan1")
    assert [{name: len(own) for name, own in pose.others.items()} for pose in back] == [
        {"blue": 2},
        {},
        {"blue": 1, "green": 1},
    ]
    assert np.array_equal(back[2].others["green"][0].uv, green[0].uv)
    with np.load(path) as arrays:
        np.savez(path, **{**arrays, "other_channels": np.array(["blue"])})
    with pytest.raises(InputError, match=r"planes\.npz"):
        read_poses(path, "fan1")


def test_the_id_in_a_file_of_poses_has_the_name_that_earlier_versions_gave_it(tmp_path):
    path = tmp_path / "planes.npz"
    write_poses(path, "fan1", (PoseFeatures("p1", None, ()),))
    with np.load(path) as arrays:
        assert str(arrays["fan_id"]) == "fan1"


@pytest.mark.parametrize("name", ["names", "notes", "reasons"])
@pytest.mark.parametrize("wrong", [np.zeros((1, 2)), np.array([["a", "b"]]), np.zeros(1)])
def test_texts_of_poses_that_are_none_are_a_damaged_file(tmp_path, name, wrong):
    path = tmp_path / "planes.npz"
    write_poses(path, "fan1", (PoseFeatures("p1", None, ()),))
    with np.load(path) as arrays:
        np.savez(path.with_name("other.npz"), **{**arrays, name: wrong})
    with pytest.raises(InputError, match=r"other\.npz"):
        read_poses(path.with_name("other.npz"), "fan1")


def test_gauge_round_trip_and_the_keys_of_the_design(tmp_path, cloud, gauge):
    path = tmp_path / "gauge.json"
    write_gauge(path, gauge, "abc")
    tables = json.loads(path.read_text())
    assert {"thickness_mm", "u_mm", "U_mm", "k", "flatness_mm", "parallelism_deg", "points", "verdict"} <= set(tables)
    assert tables["U_mm"] == 0.024
    assert tables["deviation_mm"] == pytest.approx(-0.013)
    assert tables["points"] == {"upper": 20, "lower": 25}
    back = read_gauge(path, cloud)
    assert (back.thickness_mm, back.u_mm, back.k, back.verdict) == (49.987, 0.012, 2.0, "conforming")
    assert np.array_equal(back.lower.indices, gauge.lower.indices)
    assert np.allclose(back.upper.residuals, gauge.upper.residuals)
    assert back.parallelism == pytest.approx(1e-4)
    assert (str(back.budget[0].source), str(back.rule), [str(note) for note in back.notes]) == (
        "camera",
        "the rule",
        ["a note"],
    )
    assert (back.budget[0].point_mm, back.budget[0].sensitivity) == (None, None)


def test_other_pairs_of_faces_are_read_as_they_were_written(tmp_path, cloud, gauge):
    corners = ((1.0, 2.0), (8.5, 2.0), (8.0, 9.0)), ((0.0, 0.0), (30.0, 0.0), (30.0, 40.0), (0.0, 40.0))
    candidates = (PairCandidate(30.0, (1200, 3400), (10.5, 20.0), (30.0, 40.0), corners),)
    write_gauge(tmp_path / "gauge.json", replace(gauge, candidates=candidates), "a-b")
    assert read_gauge(tmp_path / "gauge.json", cloud).candidates == candidates


def test_a_face_on_no_plane_is_no_result(tmp_path, cloud, gauge):
    path = tmp_path / "gauge.json"
    write_gauge(path, gauge, "a-b")
    tables = json.loads(path.read_text())
    tables["faces"]["lower"]["pi"] = [0.0, 0.0, 0.0]
    path.write_text(json.dumps(tables))
    for read in (read_thickness, lambda path: read_gauge(path, cloud)):
        with pytest.raises(InputError, match="0, 0, 0"):
            read(path)


def test_whether_a_thickness_is_at_20_degrees_is_not_known_of_an_older_file(tmp_path, cloud, gauge):
    path = tmp_path / "gauge.json"
    write_gauge(path, replace(gauge, at_20=True), "abc")
    assert read_gauge(path, cloud).at_20 is read_thickness(path).at_20 is True
    tables = json.loads(path.read_text())
    del tables["at_20"]
    path.write_text(json.dumps(tables))
    assert read_gauge(path, cloud).at_20 is read_thickness(path).at_20 is None


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"verdict": "not conforming"}, "conforming"),
        ({"thickness_mm": 50.3}, "not conforming"),
        ({"complete": False}, "not proven"),
        ({"complete": None}, "not proven"),  # not known
        ({"tolerance_mm": None}, ""),
    ],
)
def test_a_verdict_in_gauge_json_never_says_more_than_its_numbers_and_facts(tmp_path, cloud, gauge, changes, expected):
    path = tmp_path / "gauge.json"
    write_gauge(path, gauge, "abc")
    tables = json.loads(path.read_text()) | changes
    path.write_text(json.dumps({key: value for key, value in tables.items() if value is not None or key == "rule"}))
    assert (read_gauge(path, cloud).verdict, read_thickness(path).verdict) == (expected, expected)


def test_every_row_of_the_budget_has_its_input_its_sensitivity_and_its_share(tmp_path, cloud, gauge):
    path = tmp_path / "gauge.json"
    rows = (
        Contribution(cause_named("camera"), 0.006, 0.03),
        Contribution(cause_named("α"), 0.008, 1e-6, "rectangular", 50.0, 11.5e-6, "1/K"),
    )
    write_gauge(path, replace(gauge, u_mm=0.01, budget=rows), "abc")
    first, second = json.loads(path.read_text())["budget"]
    assert first == {
        "source": "camera",
        "u_mm": 0.006,
        "point_mm": 0.03,
        "distribution": "normal",
        "dof": None,
        "value": None,
        "unit": "mm",
        "sensitivity": pytest.approx(0.2),
        "share": pytest.approx(0.36),
    }
    assert first["share"] + second["share"] == pytest.approx(1)
    camera, expansion = read_gauge(path, cloud).budget
    assert (camera.sensitivity, camera.dof) == (pytest.approx(0.2), math.inf)
    assert (expansion.distribution, expansion.dof, expansion.value, expansion.unit) == (
        "rectangular",
        50,
        11.5e-6,
        "1/K",
    )


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda t: t.__setitem__("thickness_mm", float("nan")), "thickness_mm is NaN, not a length in mm above 0"),
        (lambda t: t.__setitem__("u_mm", -1), "u_mm is -1, not a length in mm, not negative"),
        (lambda t: t["flatness_mm"].pop("lower"), "flatness_mm.lower is missing"),
    ],
)
def test_a_spoilt_gauge_file_is_refused_by_field(tmp_path, cloud, gauge, change, said):
    path = tmp_path / "gauge.json"
    write_gauge(path, gauge, "abc")
    edited(path, change)
    with pytest.raises(InputError) as error:
        read_gauge(path, cloud)
    assert said in str(error.value)


def test_gauge_of_another_cloud_is_refused(tmp_path, cloud, gauge):
    write_gauge(tmp_path / "gauge.json", gauge, "abc")
    with pytest.raises(InputError, match="lower names points that the cloud does not have"):
        read_gauge(tmp_path / "gauge.json", cloud.select(np.arange(40)))


def test_run_round_trip(tmp_path):
    frame = FrameRecord(3, "scan/f.png", False, plain("no stripe"), condition=np.inf, sigma_mm=np.nan)
    record = RunRecord("set", "a block", datetime(2025, 1, 31, 12, 0, 5, tzinfo=UTC), frames=(frame,))
    record = record.with_step("camera", 1.23456, {"b": "2", "a": "1"}, {"skew": True}, ["Tilt more."])
    record = record.with_step("scan", 2.0, {"c": "3"}, {"method": "network"}, [])
    record = record.with_step("camera", 4.0, {}, {"skew": False}, ["Fine."])
    write_run(tmp_path / "run.json", record)
    back = read_run(tmp_path / "run.json")
    assert back.measured_at == record.measured_at
    assert (back.set_name, back.part) == ("set", "a block")
    assert back.settings == {"camera": {"skew": False}, "scan": {"method": "network"}}
    assert back.timings == {"camera": 4.0, "scan": 2.0}
    assert list(back.inputs) == ["a", "b", "c"]
    assert back.all_notes == (plain("Fine."),)
    assert back.frames[0].condition == np.inf
    assert np.isnan(back.frames[0].sigma_mm)
    assert json.loads((tmp_path / "run.json").read_text())["versions"]["numpy"] == np.__version__


def test_json_is_strict_and_readable():
    text = to_json({"a": np.arange(3.0), "b": float("nan"), "c": [{"d": (1, 2)}, "e"], "f": np.bool_(True), "g": "µ"})
    assert json.loads(text, parse_constant=lambda name: pytest.fail(name)) == {
        "a": [0, 1, 2],
        "b": None,
        "c": [{"d": [1, 2]}, "e"],
        "f": True,
        "g": "µ",
    }
    assert text.splitlines()[1] == '  "a": [0.0, 1.0, 2.0],'
