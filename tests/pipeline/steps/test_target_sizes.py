"""Sizes of camera and plane target against each other, from rendered pictures that show both."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.board_shape import TRUE, BoardTolerance
from core.calibrate.results import FanCalibration
from core.files.pictures import write_picture
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import open_set
from core.files.recording.rig import ReferenceTarget
from core.findings.table import note_of
from core.image.targets import BlackSquare, Checkerboard
from core.model import Fan, LightPlane, Pose
from core.pipeline.steps import target_sizes
from core.pipeline.steps.target_sizes import compare_targets, with_compared_sizes, with_known_size
from core.simulate.blur import blurred
from core.simulate.calibration import CAMERA_GREY
from core.simulate.rays import ray_map
from core.simulate.rig import paper_rig
from core.simulate.scene.boards import printed
from core.simulate.scene.image import Sensor, generator
from core.simulate.scene.patterns import draw_pattern
from core.simulate.scene.targets import room_shade

PLANE = LightPlane(np.array([0.0, 0.001, 0.002]))
FAN = FanCalibration(
    Fan((PLANE,)), Fan((PLANE,)), (0.0,), (), (), 0.0, None, None, (), scale_sd=5e-4, scale_assumed=False
)
BOARD = Checkerboard(9, 7, 8.0)


@pytest.fixture(scope="module", autouse=True)
def each_target_is_looked_for_once():
    """In the same pictures the same targets are found, whatever is stated of them."""
    detect, seen = target_sizes.detect, {}

    def found(target, picture, name, camera):
        key = (target, picture.tobytes(), name, camera.matrix.tobytes())
        if key not in seen:
            seen[key] = detect(target, picture, name, camera)
        return seen[key]

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(target_sizes, "detect", found)
        yield


@pytest.fixture(scope="module")
def pictures():
    """A checkerboard with a square of 60 mm beside it, 3 mm behind its plane, in three poses; and the camera."""
    rig = paper_rig(0.25)
    rays = ray_map(rig.camera)
    board, square = printed(BOARD), printed(BlackSquare(60.0))
    sensor, shown = Sensor(rig.optics, 8, 1.0), []
    for number, (turn, z) in enumerate(((0.25, 480.0), (0.15, 540.0), (0.4, 520.0))):
        c, s = np.cos(turn), np.sin(turn)
        at = Pose(np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]), np.array([-115.0, -30.0, z]))
        beside = at @ Pose(np.eye(3), np.array([124.0, 0.0, 3.0]))
        points, light = draw_pattern(board, at, rays)
        other = draw_pattern(square, beside, rays)[1]
        inside = points[..., 2] == 0
        light = np.where(inside, other, light) * room_shade(at, CAMERA_GREY)
        shown.append(sensor.expose(blurred(light.astype(np.float32), rig.blur_px), generator(number, "both")))
    return rig.camera, shown


@pytest.fixture(scope="module")
def two_squares():
    """A square of 60 mm and one of 36 mm beside it, in three poses."""
    rig = paper_rig(0.25)
    rays, sensor, shown = ray_map(rig.camera), Sensor(rig.optics, 8, 1.0), []
    large, small = printed(BlackSquare(60.0)), printed(BlackSquare(36.0))
    for number, (turn, z) in enumerate(((0.25, 480.0), (-0.3, 540.0), (0.4, 520.0))):
        c, s = np.cos(turn), np.sin(turn)
        at = Pose(np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]), np.array([-95.0, -30.0, z]))
        beside = at @ Pose(np.eye(3), np.array([135.0, 8.0, 2.0]))
        points, light = draw_pattern(large, at, rays)
        light = np.where(points[..., 2] == 0, draw_pattern(small, beside, rays)[1], light)
        light = light * room_shade(at, CAMERA_GREY)
        shown.append(sensor.expose(blurred(light.astype(np.float32), rig.blur_px), generator(number, "squares")))
    return rig.camera, shown


@pytest.mark.parametrize(
    ("plane_mm", "stated_mm", "reference_mm"),
    [
        pytest.param(60, 60, 36, marks=pytest.mark.accuracy),
        (60, 61, 36),
        (36, 36, 60),
        pytest.param(36, 37, 60, marks=pytest.mark.accuracy),
    ],
)
def test_two_squares_in_one_picture_tell_the_size_of_the_one_by_the_other(
    tmp_path, simulated, two_squares, plane_mm, stated_mm, reference_mm
):
    """Also where camera and planes are calibrated with one target."""
    camera, shown = two_squares
    found, plane = opened(tmp_path, simulated, shown, 60.0), BlackSquare(float(stated_mm))
    rig = replace(
        found.rig, camera_target=plane, plane_target=plane, plane_board=BoardTolerance(),
        reference=ReferenceTarget(BlackSquare(float(reference_mm)), BoardTolerance(scale_sd=1e-4)),
    )  # fmt: skip
    found = replace(found, rig=rig)
    assert found.rig.one_target
    ratio, notes = compare_targets(PictureReader(found), camera)
    assert notes == () and ratio.pictures == 3 and ratio.fit_p > 0.01
    assert abs(ratio.ratio - plane_mm / stated_mm) < 3 * ratio.u < 0.006
    fan, said = with_compared_sizes(UNSTATED, PictureReader(found), camera)
    assert not fan.scale_assumed
    assert fan.scale_sd == pytest.approx(np.hypot(1e-4, np.hypot(ratio.u, ratio.ratio - 1)))
    assert "the reference target" in str(said[-1])


def test_a_reference_target_counts_in_place_of_the_cameras(tmp_path, simulated, pictures):
    camera, shown = pictures
    found = opened(tmp_path, simulated, shown, 60.0)
    rig = replace(
        found.rig, camera_target=Checkerboard(17, 12, 10.0), camera_board=BoardTolerance(),
        reference=ReferenceTarget(BOARD, BoardTolerance(scale_sd=1e-4)), plane_board=BoardTolerance(),
    )  # fmt: skip
    fan, said = with_compared_sizes(UNSTATED, PictureReader(replace(found, rig=rig)), camera)
    assert not fan.scale_assumed and said[-1].code == "target.sizes_agree"


def opened(tmp_path, simulated, shown, side_mm):
    folder = tmp_path / "set"
    for part in ("camera", "planes", "scan"):
        (folder / part).mkdir(parents=True)
    (folder / "rig.toml").write_text((simulated / "rig.toml").read_text())
    (folder / "targets").mkdir()
    for number, picture in enumerate(shown):
        write_picture(folder / "targets" / f"both{number}.png", picture)
    recording_set = open_set(folder)
    square, true = BlackSquare(side_mm), {"camera_board": TRUE, "plane_board": TRUE}
    rig = replace(recording_set.rig, camera_target=BOARD, plane_target=square, **true)
    return replace(recording_set, rig=rig)


def test_sizes_that_are_stated_truly_agree(tmp_path, simulated, pictures):
    camera, shown = pictures
    ratio, notes = compare_targets(PictureReader(opened(tmp_path, simulated, shown, 60.0)), camera)
    assert ratio.pictures == 3 and notes == () and ratio.fit_p > 0.01
    assert abs(ratio.ratio - 1) < 3 * ratio.u < 0.01
    fan, said = with_compared_sizes(FAN, PictureReader(opened(tmp_path / "again", simulated, shown, 60.0)), camera)
    assert fan.scale_sd == FAN.scale_sd and {note.code for note in said} == {"target.sizes_agree"}


def test_a_square_stated_as_61_mm_in_place_of_60_is_found_out_and_in_u(tmp_path, simulated, pictures):
    """Alone in the set nothing knew: a thickness of 50 mm came out 0.79 mm too large at U = 0.05 mm."""
    camera, shown = pictures
    fan, said = with_compared_sizes(FAN, PictureReader(opened(tmp_path, simulated, shown, 61.0)), camera)
    assert {note.code for note in said} == {"target.sizes_disagree"}
    assert 2 * fan.scale_sd * 50 > 0.79, "U of a thickness of 50 mm holds it"
    assert fan.scale_sd == pytest.approx(1 / 61, rel=0.3)


UNSTATED = replace(FAN, scale_assumed=True)


def test_a_size_that_is_known_is_not_told_to_be_assumed_whatever_was_assumed():
    flat = note_of("target.flatness_assumed", field="[plane_target] flatness_mm", mm=0.05)
    unstated = replace(UNSTATED, notes=(flat,))
    assert [note.code for note in unstated.all_notes] == ["target.flatness_assumed", "target.size_assumed"]
    assert with_known_size(unstated, 3e-4).all_notes == (flat,)


@pytest.mark.parametrize(("side_mm", "off"), [(60.0, 0.0), (61.0, -1 / 61)])
def test_a_camera_target_of_a_stated_size_confirms_the_plane_target(tmp_path, simulated, pictures, side_mm, off):
    camera, shown = pictures
    found = opened(tmp_path, simulated, shown, side_mm)
    stated = BoardTolerance(scale_sd=3e-4)
    found = replace(found, rig=replace(found.rig, camera_board=stated, plane_board=BoardTolerance()))
    ratio, _ = compare_targets(PictureReader(found), camera)
    fan, _ = with_compared_sizes(UNSTATED, PictureReader(found), camera)
    assert not fan.scale_assumed
    assert fan.scale_sd == pytest.approx(np.hypot(3e-4, np.hypot(ratio.u, ratio.ratio - 1)))
    assert abs(ratio.ratio - 1 - off) < 3 * ratio.u


def test_a_camera_target_of_which_nothing_is_stated_confirms_nothing(tmp_path, simulated, pictures):
    camera, shown = pictures
    found = opened(tmp_path, simulated, shown, 60.0)
    found = replace(found, rig=replace(found.rig, camera_board=BoardTolerance(), plane_board=BoardTolerance()))
    assert with_compared_sizes(UNSTATED, PictureReader(found), camera)[0].scale_assumed


def test_a_camera_target_that_rig_toml_does_not_name_is_not_looked_for(tmp_path, simulated, pictures):
    """In memory it is the paper's checkerboard: each picture was said not to show a board that nobody has."""
    camera, shown = pictures
    opened(tmp_path, simulated, shown, 60.0)
    (tmp_path / "set" / "rig.toml").write_text('[plane_target]\nkind = "black_square"\nside_mm = 60.0\n')
    recording_set = open_set(tmp_path / "set")
    assert compare_targets(PictureReader(recording_set), camera) == (None, ())
    assert with_compared_sizes(UNSTATED, PictureReader(recording_set), camera) == (UNSTATED, ())


def test_targets_that_are_not_fixed_to_each_other_say_nothing(tmp_path, simulated, pictures):
    camera, shown = pictures
    half = shown[0].shape[1] // 2
    moved = shown[1].copy()
    moved[:, :half] = np.roll(moved[:, :half], 12, axis=0)
    found = opened(tmp_path, simulated, (shown[0], moved, shown[2]), 61.0)
    fan, said = with_compared_sizes(FAN, PictureReader(found), camera)
    assert {note.code for note in said} == {"target.not_fixed"} and fan.scale_sd == FAN.scale_sd


def test_without_such_pictures_nothing_is_said(tmp_path, simulated, pictures):
    found = opened(tmp_path, simulated, (), 61.0)
    assert with_compared_sizes(FAN, PictureReader(found), pictures[0]) == (FAN, ())


def test_a_picture_that_shows_one_of_them_is_told(tmp_path, simulated, pictures):
    camera, shown = pictures
    grey = np.full_like(shown[0], 90)
    ratio, notes = compare_targets(PictureReader(opened(tmp_path, simulated, (grey,), 60.0)), camera)
    assert ratio is None and [note.code for note in notes] == ["target.not_both"]
