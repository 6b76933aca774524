from dataclasses import replace

import numpy as np
import pytest

from core.calibrate import levenberg
from core.calibrate.board_shape import TRUE, BoardTolerance
from core.calibrate.camera.reprojection import camera_of, parameters_of
from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.calibrate.fan.pencil import Pencil, pencil_near, plane_distances
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.results import FanCalibration
from core.errors import InputError
from core.image.exclusion import Exclusion
from core.messages import plain
from core.model import Pose
from tests.calibrate.fan_scenes import (
    ALPHA,
    CAMERA,
    GRID,
    PAPER,
    PLATE,
    QUIET,
    Noise,
    bowed,
    features,
    poses,
    stripe,
)
from tests.paper import PLANES as PUBLISHED

THREE = FanOptions(3, ALPHA)
WHERE = poses(7, 1)


def normalised(result: FanCalibration) -> float:
    """Mean square of the fan's error in units of its stated covariance: 1 where that is true."""
    error = (result.fan.pis - PAPER).ravel()
    covariance = result.fan.covariance
    assert covariance is not None
    freedom = np.linalg.matrix_rank(covariance, tol=1e-9 * np.trace(covariance), hermitian=True)
    return float(error @ np.linalg.pinv(covariance, rcond=1e-9, hermitian=True) @ error) / freedom


def worst_mm(pis: np.ndarray, truth: np.ndarray) -> float:
    """Largest distance between planes at 450 … 600 mm."""
    z, x = (a.ravel() for a in np.meshgrid(np.linspace(450, 600, 4), np.linspace(-60, 60, 5)))
    worst = 0.0
    for pi, true in zip(pis, truth, strict=True):
        points = np.column_stack([x, (1 - true[0] * x - true[2] * z) / true[1], z])
        worst = max(worst, float(np.abs(plane_distances(np.broadcast_to(pi, points.shape), points)[0]).max()))
    return worst


def without_lines(pose: PoseFeatures, *missing: int) -> PoseFeatures:
    """The pose with lines taken out, counted from the top of the picture."""
    ordered = sorted(pose.centrelines, key=lambda line: float(line.uv[:, 1].mean()))
    return replace(pose, centrelines=tuple(line for index, line in enumerate(ordered) if index not in missing))


def test_exact_features_give_the_exact_fan():
    result = fit_fan(features(WHERE, QUIET, 1), CAMERA, THREE)
    assert worst_mm(result.fan.pis, PAPER) < 1e-5
    assert worst_mm(result.free.pis, PAPER) < 1e-5
    assert max(result.rms_mm) < 1e-5


def test_a_fit_that_has_not_settled_says_so_and_one_that_has_does_not(monkeypatch):
    noisy = features(WHERE, Noise(), 2)
    for each in (noisy, features(WHERE, QUIET, 1)):
        assert "fan.not_converged" not in [note.code for note in fit_fan(each, CAMERA, THREE).notes]
    monkeypatch.setattr(levenberg, "MOST_STEPS", 1)
    assert fit_fan(noisy, CAMERA, THREE).notes[0].code == "fan.not_converged"


def test_noisy_features_give_lines_in_order_and_a_fit_as_good_as_the_noise():
    result = fit_fan(features(WHERE, Noise(), 2), CAMERA, THREE)
    assert worst_mm(result.fan.pis, PAPER) < 0.02
    assert all(0.008 < rms < 0.02 for rms in result.rms_mm)
    assert result.angles == pytest.approx((ALPHA, ALPHA), abs=1e-9)
    assert result.constraint_suits is True
    assert all(pose.used and len(pose.points) == 3 and len(pose.points[1]) > 100 for pose in result.poses)


@pytest.mark.accuracy
@pytest.mark.parametrize(("flatness_mm", "corner_px", "seed"), [(0.0, 0.02, 100), (0.05, 0.05, 200)])
def test_covariance_is_that_of_repeated_calibrations(flatness_mm, corner_px, seed):
    tied, free = [], []
    for number in range(10):
        where = poses(8, seed + number)
        noisy = features(where, Noise(corner_px, flatness_mm=flatness_mm), seed + number)
        result = fit_fan(noisy, CAMERA, FanOptions(3, ALPHA, "always"))
        tied.append(normalised(result))
        error = (result.free.pis - PAPER).ravel()
        free.append(error @ np.linalg.solve(result.free.covariance, error) / 9)
    assert 0.5 < np.mean(tied) < 1.8
    assert 0.5 < np.mean(free) < 1.8


def test_a_target_of_many_points_works_as_well():
    result = fit_fan(features(WHERE, Noise(), 3, points=GRID), CAMERA, THREE)
    assert worst_mm(result.fan.pis, PAPER) < 0.01


def test_doubtful_target_points_are_helped_by_the_stripes():
    """Poses from four corners of 0.2 px are off by about a millimetre at the plate's edge; the fan is not."""
    result = fit_fan(features(WHERE, Noise(0.2), 4), CAMERA, THREE)
    assert worst_mm(result.fan.pis, PAPER) < 0.1


def test_poses_may_show_only_some_of_the_lines():
    every = features(WHERE, Noise(), 5)
    some = [without_lines(pose, number % 3) if number < 6 else pose for number, pose in enumerate(every)]
    result = fit_fan(some, CAMERA, THREE)
    assert worst_mm(result.fan.pis, PAPER) < 0.02
    assert [len(points) == 0 for points in result.poses[1].points] == [False, True, False]


def test_stripes_on_the_table_behind_the_target_are_told_apart():
    rng = np.random.default_rng(6)
    table = Pose.from_vector([0.9, 0, 0, -30, 20, 700])
    behind = tuple(stripe(pi, table, Noise(), rng, reach=120) for pi in PAPER)
    result = fit_fan(
        [replace(pose, centrelines=behind + pose.centrelines) for pose in features(WHERE, Noise(), 6)], CAMERA, THREE
    )
    assert worst_mm(result.fan.pis, PAPER) < 0.02


def test_a_laser_with_other_angles_than_stated_is_found_out():
    result = fit_fan(features(WHERE, Noise(), 7, pis=PUBLISHED), CAMERA, THREE)
    assert result.constraint_suits is False
    assert "does not suit" in str(result.verdict)
    assert np.degrees(result.free_angles) == pytest.approx([4.929, 4.919], abs=0.005)
    assert worst_mm(result.fan.pis, PUBLISHED) < 0.02


def test_planes_that_share_an_axis_keep_it_when_only_the_angles_are_wrong():
    wider = pencil_near(PUBLISHED, np.deg2rad(4.8)).pis
    result = fit_fan(features(WHERE, Noise(), 8, pis=wider), CAMERA, THREE)
    assert result.constraint_suits is False
    assert "do share an axis" in str(result.verdict)
    assert worst_mm(result.fan.pis, wider) < 0.02


def test_planes_without_a_common_axis_are_fitted_freely():
    skewed = PAPER.copy()
    skewed[1] *= 1.004
    result = fit_fan(features(WHERE, Noise(), 9, pis=skewed), CAMERA, THREE)
    assert result.constraint_suits is False
    assert result.fan is not result.free
    assert (result.fan.pis == result.free.pis).all()
    assert result.pencil_gap_mm > 0.05


@pytest.mark.parametrize("lines", [1, 2, 5])
def test_any_number_of_lines(lines):
    pencil = pencil_near(PUBLISHED, ALPHA)
    angle = np.deg2rad(2.5)
    pis = Pencil(pencil.frame, pencil.point, angle * (np.arange(lines) - (lines - 1) / 2), fixed_angles=True).pis
    result = fit_fan(features(WHERE, Noise(), 10, pis=pis), CAMERA, FanOptions(lines, angle if lines > 1 else None))
    assert result.fan.lines == lines
    assert worst_mm(result.fan.pis, pis) < 0.03
    assert (result.constraint_suits is None) == (lines == 1)


def test_a_pose_with_a_misfound_corner_is_left_out_and_named():
    spoilt = features(WHERE, Noise(), 11, points=GRID)
    spoilt[3] = replace(spoilt[3], view=replace(spoilt[3].view, points=spoilt[3].view.points * 1.05))
    result = fit_fan(spoilt, CAMERA, THREE)
    assert not result.poses[3].used
    assert result.poses[3].reason
    assert any("p3" in str(note) for note in result.notes)
    assert worst_mm(result.fan.pis, PAPER) < 0.02


@pytest.mark.parametrize(("count", "told"), [(3, True), (4, False), (9, False)])
def test_few_poses_are_told_with_their_number(count, told):
    fan = fit_fan(features(poses(count, 2), Noise(), 2), CAMERA, FanOptions(3, ALPHA))
    notes = [str(note) for note in fan.notes if note.code == "fan.few_poses"]
    assert bool(notes) == told and all(f"only {count} of {count} poses" in note for note in notes)


def test_a_pose_left_out_by_hand_is_located_but_has_no_part():
    seen = features(WHERE, Noise(), 2)
    without = fit_fan(seen, CAMERA, THREE, excluded={seen[1].name})
    assert (without.poses[1].used, without.poses[1].exclusion) == (False, Exclusion.BY_HAND)
    assert without.poses[1].pose.translation[2] > 100
    rest = fit_fan([pose for i, pose in enumerate(seen) if i != 1], CAMERA, THREE)
    assert (without.fan.pis == rest.fan.pis).all()
    assert any(f"{seen[1].name} ({Exclusion.BY_HAND.message})" in str(note) for note in without.notes)


@pytest.mark.accuracy
def test_poses_of_many_points_correct_a_camera_that_is_off():
    """Views that know the focal length to 0.2 %, and poses of a checkerboard that know better."""
    true = parameters_of(CAMERA)
    sd = np.array([5.0, 5, 0.1, 2, 2, 2e-3, 1e-2, 1e-4, 1e-4, 0])
    off = camera_of(true + sd * [1, 1, 0, 0.5, -0.5, 0, 0, 0, 0, 0], CAMERA.image_size)
    seen = features(WHERE, Noise(), 19, points=GRID)
    alone, joint = fit_fan(seen, off, THREE), fit_fan(seen, off, THREE, camera_covariance=np.diag(sd**2))
    assert alone.camera is None
    corrected = parameters_of(joint.camera)
    corrected_sd = np.sqrt(np.diag(joint.camera_covariance))
    assert (corrected_sd[:2] < 0.5 * sd[:2]).all()
    assert (np.abs(corrected - true)[:5] < 3 * corrected_sd[:5]).all()
    assert corrected[9] == 0
    assert worst_mm(joint.fan.pis, PAPER) < 0.5 * worst_mm(alone.fan.pis, PAPER)
    assert (fit_fan(seen, joint.camera, THREE).fan.pis == joint.fan.pis).all()


@pytest.mark.accuracy
def test_a_fan_from_a_bowed_target_is_right_within_its_covariance_once_the_bow_is_solved_for():
    """Bowed by 0.3 and 0.4 mm at the plate's edges: the same in every pose, so poses do not average it out."""
    shaped, blind = [], []
    for seed in (2, 4, 5):
        seen = features(poses(9, 300 + seed), Noise(), seed, shape=bowed(0.3, 0.4, 0.0))
        shaped.append(fit_fan(seen, CAMERA, replace(THREE, constrained="always", target=BoardTolerance(0.3, 0.0))))
        blind.append(fit_fan(seen, CAMERA, replace(THREE, constrained="always")))
        assert worst_mm(shaped[-1].fan.pis, PAPER) < 0.5 * worst_mm(blind[-1].fan.pis, PAPER)
        assert shaped[-1].cross_validation_mm < 0.8 * blind[-1].cross_validation_mm
    assert np.mean([normalised(result) for result in shaped]) < 1.5
    assert np.mean([normalised(result) for result in blind]) > 3
    found = shaped[0].board
    expected = np.array([0.3, 0.4]) * (found.board.half / PLATE.half) ** 2
    assert (np.abs(found.values[:2] - expected) < 4 * found.sd[:2]).all()
    assert (found.sd[:2] < 0.05).all()
    assert any("plane target is bowed by 0." in str(note) for note in shaped[0].notes)


def test_an_unstated_target_is_taken_for_a_print_and_the_technician_is_told():
    seen = features(poses(9, 303), Noise(), 3, points=GRID)
    unstated, true = (fit_fan(seen, CAMERA, replace(THREE, target=one)) for one in (BoardTolerance(), TRUE))
    assert [note.code for note in unstated.all_notes[-2:]] == ["target.flatness_assumed", "target.size_assumed"]
    assert (true.scale_sd, true.scale_assumed, true.board.values.any()) == (0.0, False, False)
    assert np.trace(unstated.fan.covariance) > np.trace(true.fan.covariance)
    assert unstated.board.values.any()


@pytest.mark.accuracy
def test_a_flat_target_of_uncertain_flatness_is_found_flat_and_costs_little():
    """On the whole: how far leaving out single poses moves the planes, which σ holds, varies from set to set."""
    costs = []
    for seed in (3, 4, 5):
        seen = features(poses(9, 300 + seed), Noise(), seed, points=GRID)
        unsure, flat = (
            fit_fan(seen, CAMERA, replace(THREE, target=BoardTolerance(flatness, 0.0))) for flatness in (0.3, 0.0)
        )
        assert (np.abs(unsure.board.values[:3]) < 3.5 * unsure.board.sd[:3]).all()
        assert unsure.notes == flat.notes
        assert not flat.board.values.any()
        costs.append(np.trace(unsure.fan.covariance) / np.trace(flat.fan.covariance))
    assert 0.95 < np.median(costs) < 1.2


def test_twist_of_a_target_is_told_by_its_points():
    seen = features(WHERE, Noise(), 12, points=GRID, shape=bowed(0.0, 0.0, 0.4))
    result = fit_fan(seen, CAMERA, replace(THREE, target=BoardTolerance(0.3, 0.0)))
    assert np.abs(result.board.values[2]) > 10 * result.board.sd[2]
    assert worst_mm(result.fan.pis, PAPER) < 0.01


def test_each_pose_is_foretold_by_the_others():
    quiet, loud = (fit_fan(features(WHERE, Noise(px, px), 20), CAMERA, THREE) for px in (0.02, 0.1))
    assert 3 < loud.cross_validation_mm / quiet.cross_validation_mm < 7
    errors = np.array([pose.prediction_mm for pose in quiet.poses])
    assert quiet.cross_validation_mm == pytest.approx(np.sqrt(np.mean(errors**2)))
    assert np.isnan(fit_fan(features(WHERE[::3], Noise(), 20), CAMERA, THREE).cross_validation_mm)


def test_a_pose_that_the_others_do_not_foretell_is_named():
    """Its stripes agree with the planes only because the pose turned for them; its own points say another distance."""
    seen = features(WHERE, Noise(), 21, points=GRID)
    seen[2] = replace(seen[2], view=replace(seen[2].view, points=seen[2].view.points * 1.001))
    result = fit_fan(seen, CAMERA, THREE)
    assert max(result.poses, key=lambda pose: np.nan_to_num(pose.prediction_mm)).name == "p2"
    assert any("foretell the stripes of p2" in str(note) for note in result.notes)


def test_a_small_target_far_beyond_all_others_is_not_accused_for_it():
    """Nothing is wrong with it: the others say little of light there, and its own corners little of its tilt."""
    far = Pose(np.eye(3), np.array([-20.0, 72.0, 1200.0]))
    for seed in (40, 41):
        result = fit_fan(features([*WHERE, far], Noise(0.05), seed), CAMERA, THREE)
        errors = np.array([pose.prediction_mm for pose in result.poses])
        assert errors[-1] > max(4 * np.median(errors), 0.05)
        assert not any("foretell the stripes" in str(note) for note in result.notes)


def test_more_lines_than_promised_is_noted():
    result = fit_fan(features(WHERE, Noise(), 2), CAMERA, FanOptions(1))
    assert any("a further light plane is seen in 7 poses" in str(note) for note in result.notes)
    assert not fit_fan(features(WHERE, Noise(), 2), CAMERA, THREE).notes


def test_saturated_stripes_are_warned_of():
    pairs = features(WHERE, Noise(), 13)
    burnt = [
        replace(
            pose,
            centrelines=tuple(replace(line, saturated=np.arange(len(line)) % 4 < 3) for line in pose.centrelines),
        )
        for pose in pairs
    ]
    assert not any("saturated" in str(note) for note in fit_fan(pairs, CAMERA, THREE).notes)
    assert any("saturated at 75%" in str(note) for note in fit_fan(burnt, CAMERA, THREE).notes)


def test_pairs_that_were_not_exposed_alike_are_told():
    pairs = features(WHERE, Noise(), 13)
    pairs[2] = replace(pairs[2], gain=0.8)
    told = [str(note) for note in fit_fan(pairs, CAMERA, THREE).notes]
    assert any("not exposed alike in 1 of 7 poses" in note and "by up to 20 %" in note for note in told)


def test_fewer_lines_than_promised_is_said():
    with pytest.raises(InputError, match=r"only 2 of the 3 promised fan lines.*laser_fan\.lines in rig\.toml"):
        fit_fan(features(WHERE, Noise(), 14, pis=PAPER[:2]), CAMERA, THREE)


def test_poses_in_one_plane_do_not_determine_the_fan():
    one = WHERE[3]
    alike = [Pose(one.rotation, one.translation + one.rotation @ [4.0 * n, 3.0 * n, 0]) for n in range(5)]
    with pytest.raises(InputError, match="too alike"):
        fit_fan(features(alike, Noise(), 15), CAMERA, THREE)


def test_one_pose_is_not_enough():
    with pytest.raises(InputError, match="only one pose can be used"):
        fit_fan(features(WHERE[:1], Noise(), 16), CAMERA, THREE)


def test_no_usable_pose_gives_the_reasons():
    useless = [replace(pose, exclusion=plain("the picture is all black")) for pose in features(WHERE, Noise(), 17)]
    with pytest.raises(InputError, match=r"none of the 7 poses can be used.*all black"):
        fit_fan(useless, CAMERA, THREE)
    with pytest.raises(InputError, match="there are no poses"):
        fit_fan([], CAMERA, THREE)


def test_parallel_poses_at_different_distances_do_determine_the_fan():
    where = [Pose(np.eye(3), np.array([-30, 0.075 * z - 30, z])) for z in (450, 500, 550, 600)]
    assert worst_mm(fit_fan(features(where, Noise(), 18), CAMERA, THREE).fan.pis, PAPER) < 0.1
