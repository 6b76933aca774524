"""Cameras handed to OpenCV and ROS, and taken from them."""

from dataclasses import replace
from datetime import UTC, datetime

import cv2
import numpy as np
import pytest
import yaml

from core.calibrate.deviations import calibration_deviations
from core.calibrate.results import FanCalibration
from core.errors import InputError
from core.files.exchange.opencv_calibration import read_opencv, write_opencv
from core.files.exchange.ros_camera_info import read_camera_info, write_camera_info
from core.findings.finding import Effect
from core.findings.table import FINDINGS
from core.model import Camera, Fan, LightPlane
from tests.report.report_samples import CAMERA, camera_calibration

AT = datetime(2026, 3, 14, 15, 9, 26, tzinfo=UTC)


@pytest.fixture(scope="module")
def calibration():
    return camera_calibration()


@pytest.fixture(scope="module")
def straight(calibration):
    """The same without a skew."""
    matrix = CAMERA.matrix.copy()
    matrix[0, 1] = 0
    return replace(calibration, camera=Camera(CAMERA.image_size, matrix, CAMERA.distortion))


@pytest.mark.parametrize("ending", ["yml", "json"])
def test_opencv_reads_our_camera_and_projects_with_it_as_we_do(tmp_path, straight, ending):
    path = tmp_path / f"camera.{ending}"
    write_opencv(path, straight, AT)
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    matrix, distortion = (storage.getNode(name).mat() for name in ("camera_matrix", "distortion_coefficients"))
    assert (storage.getNode("image_width").real(), storage.getNode("image_height").real()) == (1920, 1374)
    points = np.array([[10.0, -60, 500], [-90, 40, 600], [100, 80, 550]])
    theirs = cv2.projectPoints(points, np.zeros(3), np.zeros(3), matrix, distortion)[0].reshape(-1, 2)
    assert np.allclose(theirs, straight.camera.project(points), atol=1e-6)


@pytest.mark.parametrize("ending", ["yml", "json"])
def test_a_camera_with_skew_comes_back_from_opencvs_file_to_the_last_digit(tmp_path, calibration, ending):
    path = tmp_path / f"camera.{ending}"
    write_opencv(path, calibration, AT)
    back = read_opencv(path)
    assert np.array_equal(back.camera.matrix, CAMERA.matrix)
    assert np.array_equal(back.camera.distortion, CAMERA.distortion)
    assert back.camera.image_size == CAMERA.image_size
    assert back.rms_px == calibration.rms_px
    assert "standard deviations are not known" in str(back.notes[0])
    assert "is the skew in px" in path.read_text()


def test_a_file_as_opencvs_calibration_sample_writes_it_is_read(tmp_path):
    storage = cv2.FileStorage(str(tmp_path / "c.xml"), cv2.FILE_STORAGE_WRITE)
    storage.write("image_width", 640)
    storage.write("image_height", 480)
    storage.write("camera_matrix", np.array([[500.0, 0, 320], [0, 501, 240], [0, 0, 1]]))
    storage.write("distortion_coefficients", np.array([[0.1], [-0.2], [0.001], [0.002], [0.05]]))
    storage.release()
    assert read_opencv(tmp_path / "c.xml").camera.distortion.tolist() == [0.1, -0.2, 0.001, 0.002, 0.05]


def test_a_yaml_reader_finds_the_keys_of_camera_info(tmp_path, straight):
    write_camera_info(tmp_path / "c.yaml", straight)
    file = yaml.safe_load((tmp_path / "c.yaml").read_text())
    assert list(file) == [
        "image_width", "image_height", "camera_name", "camera_matrix", "distortion_model", "distortion_coefficients",
        "rectification_matrix", "projection_matrix"]  # fmt: skip
    assert (file["image_width"], file["distortion_model"]) == (1920, "plumb_bob")
    for key, shape in (("camera_matrix", (3, 3)), ("distortion_coefficients", (1, 5)), ("projection_matrix", (3, 4))):
        assert (file[key]["rows"], file[key]["cols"]) == shape
        assert len(file[key]["data"]) == shape[0] * shape[1]
    assert file["camera_matrix"]["data"] == straight.camera.matrix.ravel().tolist()
    assert file["distortion_coefficients"]["data"] == straight.camera.distortion.tolist()


def test_a_camera_comes_back_from_ros_to_the_last_digit(tmp_path, straight):
    write_camera_info(tmp_path / "c.yaml", straight)
    back = read_camera_info(tmp_path / "c.yaml").camera
    assert np.array_equal(back.matrix, straight.camera.matrix)
    assert np.array_equal(back.distortion, straight.camera.distortion)


def test_ros_has_no_skew_so_a_camera_with_one_is_not_written(tmp_path, calibration):
    with pytest.raises(
        InputError, match=r"camera_info has no skew, and this camera's is 0.39 px; calibrate without it"
    ):
        write_camera_info(tmp_path / "c.yaml", calibration)
    assert not (tmp_path / "c.yaml").exists()


ROS = """image_width: 640
image_height: 480
camera_matrix: {{rows: 3, cols: 3, data: [500, 0, 320, 0, 500, 240, 0, 0, 1]}}
distortion_model: {model}
distortion_coefficients: {{data: [{coefficients}]}}
"""


def test_a_rational_model_is_read_where_it_says_no_more_than_plumb_bob(tmp_path):
    (tmp_path / "c.yaml").write_text(ROS.format(model="rational_polynomial", coefficients="0.1, 0, 0, 0, 0.2, 0, 0, 0"))
    assert read_camera_info(tmp_path / "c.yaml").camera.distortion.tolist() == [0.1, 0, 0, 0, 0.2]
    (tmp_path / "c.yaml").write_text(ROS.format(model="rational_polynomial", coefficients="0.1, 0, 0, 0, 0, 0.3, 0, 0"))
    with pytest.raises(InputError, match="8 distortion coefficients, of which more than k1, k2, p1, p2, k3"):
        read_camera_info(tmp_path / "c.yaml")


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        (ROS.format(model="equidistant", coefficients="0, 0, 0, 0"), "distortion_model is 'equidistant'"),
        (ROS.format(model="plumb_bob", coefficients="a, b"), "distortion_coefficients is not a list of numbers"),
        (
            ROS.format(model="plumb_bob", coefficients="0, 0, 0, 0").replace("640", "wide"),
            "image_width is not a number",
        ),
        (
            ROS.format(model="plumb_bob", coefficients="0").replace("240, 0, 0, 1", "240"),
            "camera_matrix is not 9 numbers",
        ),
        (ROS.format(model="plumb_bob", coefficients="0").replace("500, 0, 320", "-5, 0, 320"), "this is no camera"),
        ("just words", "no calibration in YAML, JSON or XML"),
        ("a: [", "no calibration in YAML"),
    ],
)
def test_what_is_wrong_in_a_file_of_ros_is_told(tmp_path, text, complaint):
    (tmp_path / "c.yaml").write_text(text)
    with pytest.raises(InputError, match=complaint) as refused:
        read_camera_info(tmp_path / "c.yaml")
    assert "c.yaml" in str(refused.value)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("%YAML:1.0\n---\nimage_width: 640\n", "there is no camera_matrix"),
        ("nonsense", "no calibration in YAML"),
        ('{"camera_matrix": 5}', "there is no camera_matrix"),
    ],
)
def test_what_is_wrong_in_a_file_of_opencv_is_told(tmp_path, text, complaint):
    (tmp_path / "c.yml").write_text(text)
    with pytest.raises(InputError, match=complaint):
        read_opencv(tmp_path / "c.yml")


MATRIX = "!!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [500., 0., 320., 0., 501., 240., 0., 0., 1.]"
GOOD = f"%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: {MATRIX}\ndistortion_coefficients: [0.1]\n"


def test_opencvs_yaml_is_read_without_opencv(tmp_path, monkeypatch):
    monkeypatch.delattr(cv2, "FileStorage")
    (tmp_path / "c.yml").write_text(GOOD)
    assert read_opencv(tmp_path / "c.yml").camera.matrix[1].tolist() == [0, 501, 240]


@pytest.mark.parametrize(
    ("name", "text", "complaint"),
    [
        ("c.json", '{"a":' * 100_000, "more than 60 deep"),
        ("c.yml", "%YAML:1.0\n---\na: " + "[" * 100_000, "more than 60 deep"),
        ("c.yml", "- " * 100_000, "no calibration"),
        ("c.yml", "? " * 100_000, "no calibration"),
        ("c.xml", "<opencv_storage>" + "<a>" * 100_000 + "</a>" * 100_000 + "</opencv_storage>", "no camera_matrix"),
        ("c.xml", '<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>', "declares entities"),
        ("c.yml", GOOD.replace("500.", "9" * 5000), "more than 100 digits"),
        ("c.yml", GOOD.replace("500.", ".Inf"), "no camera_matrix"),
        ("c.yml", GOOD.replace("500.", "1e999"), "no camera_matrix"),
        ("c.yml", GOOD.replace("640", "0"), "no camera"),
        ("c.yml", GOOD + "note: !!python/object/apply:os.system [exit 7]\ncamera_matrix: 5\n", "no camera_matrix"),
        ("c.yml", "a: &a [1,2]\nb: &b [*a,*a]\ncamera_matrix: [*b, *b]\n", "no calibration"),
        ("c.json", " " * 1_000_001, "the file has 1.0 MB"),
        ("c.yml", "a: \0", "no calibration"),
    ],
)
def test_a_hostile_calibration_is_refused_in_one_sentence(tmp_path, name, text, complaint):
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=complaint) as refused:
        read_opencv(tmp_path / name)
    assert len(refused.value.text_in().removeprefix(str(tmp_path))) < 300


def test_a_camera_of_another_program_leaves_its_share_out_of_u_as_its_note_says(tmp_path, calibration):
    """What it lacks takes away every proof: `core.inspect.uncertainty.point_errors.PointErrors.missing`."""
    write_opencv(tmp_path / "c.yml", calibration, AT)
    theirs = read_opencv(tmp_path / "c.yml")
    (note,) = theirs.notes
    plane = LightPlane(np.array([0.0, 0.001, 0.002]))
    fan = FanCalibration(Fan((plane,)), Fan((plane,)), (0.0,), (), (), 0.0, None, None, ())
    sources = [{one.source for one in calibration_deviations(camera, fan)} for camera in (calibration, theirs)]
    assert FINDINGS[note.code].effect == Effect.NO_PROOF
    assert ["camera" in own for own in sources] == [True, False]
