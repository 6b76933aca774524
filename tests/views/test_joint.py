"""The joint of views by the marks of their carrier."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.camera.reprojection import parameters_of
from core.errors import InputError
from core.image.targets.pose import cross_matrices
from core.model import Camera
from core.scan.common_errors import CommonErrors
from core.views.carrier import Carrier
from core.views.joint import join
from core.views.marks_seen import MarksSeen
from tests.views.made import CAMERA, SIGMA_PX, both_seen, carrier, exact, poses, seen_in

AT = np.array([[0.0, 50.0, 535.0]])
"""A point of the part."""
BY_MOTION = np.hstack([-cross_matrices(AT)[0], np.eye(3)])
"""How it follows a motion (ω, τ)."""


def error_at(joint, seed):
    first, second = poses(seed)
    true = first @ second.inverse()
    return ((joint.pose(1) @ true.inverse()).apply(AT) - AT)[0]


def test_marks_without_noise_give_the_true_pose_of_a_turned_view():
    known = exact(carrier())
    joint = join(known, both_seen(known, sigma=1e-9), CAMERA)
    assert np.abs(error_at(joint, 0)).max() < 1e-6


def test_the_error_of_the_joint_is_as_large_as_its_covariance_states():
    relative = []
    for seed in range(40):
        known = carrier(seed)
        joint = join(known, both_seen(known, seed), CAMERA)
        u = np.sqrt(np.diag(BY_MOTION @ joint.covariance(1) @ BY_MOTION.T))
        relative.append(error_at(joint, seed) / u)
    assert 0.8 < np.sqrt(np.mean(np.square(relative))) < 1.2


def test_a_moved_mark_is_left_out_and_named():
    known = carrier()
    first, second = both_seen(known)
    uv = second.uv.copy()
    uv[3] += [0.9, 0.2]
    joint = join(known, (first, MarksSeen(second.numbers, uv, second.covariance, "turned")), CAMERA)
    assert joint.left_out(1).tolist() == [second.numbers[3]]
    assert joint.left_out(0).tolist() == []


def test_the_joint_of_more_marks_is_surer():
    few, many = carrier(marks=6), carrier(marks=18)
    u = [
        np.sqrt((BY_MOTION @ join(one, both_seen(one), CAMERA).covariance(1) @ BY_MOTION.T)[2, 2])
        for one in (few, many)
    ]
    assert u[1] < 0.7 * u[0]


def test_a_displaced_camera_moves_the_joint_as_a_new_solution_with_it():
    known = exact(carrier())
    seen = both_seen(known, sigma=1e-6)
    seen = tuple(MarksSeen(one.numbers, one.uv, SIGMA_PX**2 * np.tile(np.eye(2), (12, 1, 1)), one.view) for one in seen)
    matrix = CAMERA.matrix.copy()
    matrix[0, 0] += 0.4
    matrix[1, 2] += 0.3
    other = Camera(CAMERA.image_size, matrix, CAMERA.distortion)
    joint, again = join(known, seen, CAMERA), join(known, seen, other)
    cameras = np.array([parameters_of(CAMERA), parameters_of(other)])
    common = CommonErrors(CAMERA.image_size, ("camera",), cameras, np.zeros((2, 1, 3)), np.zeros((2, 0, 3)))
    motion = joint.motions(1, joint.of_calibration(common))[0]
    moved = ((again.pose(1) @ joint.pose(1).inverse()).apply(AT) - AT)[0]
    assert BY_MOTION @ motion == pytest.approx(moved, rel=1e-2)
    assert np.abs(moved).max() > 1e-3


def test_fewer_than_four_marks_are_refused_with_the_view_named():
    known = carrier()
    first, second = both_seen(known)
    with pytest.raises(InputError, match="turned: 3 marks of the carrier are seen, and 4 are needed"):
        join(known, (first, second.select(np.arange(12) < 3)), CAMERA)


def test_marks_of_another_carrier_fit_no_pose():
    known = carrier()
    first, second = both_seen(known)
    rng = np.random.default_rng(5)
    other = replace(known, positions=known.positions + rng.normal(0, 30, known.positions.shape))
    with pytest.raises(InputError, match="do not lie as on the carrier"):
        join(other, (first, second), CAMERA)


@pytest.mark.parametrize(
    ("beside_mm", "refusal"),
    [(0.0, "its marks do not lie as on the carrier"), (0.1, "its marks leave it free: turning about")],
)
def test_marks_on_one_line_hold_no_view(beside_mm, refusal):
    known = exact(carrier(marks=6))
    line = known.positions.copy()
    line[:, 1] = np.tile([beside_mm, -beside_mm], 6)
    line[:, 0] = np.tile(np.linspace(-80, 80, 6), 2)
    on_line = Carrier(known.numbers, known.sides, line, known.covariance, known.radius_mm)
    rng = np.random.default_rng(1)
    first, second = poses()
    seen = (seen_in(on_line, first, 0, rng, "scan"), seen_in(on_line, second, 1, rng, "turned"))
    with pytest.raises(InputError, match=f"scan: {refusal}"):
        join(on_line, seen, CAMERA)
