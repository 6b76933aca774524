"""What speaks against a joint: told, or the error of the joint is within its U."""

from dataclasses import replace

import numpy as np
import pytest

from core.errors import InputError
from core.image.targets.pose import cross_matrices
from core.views.joint import join
from core.views.joint_check import Overlap, check_joint
from core.views.marks_seen import MarksSeen
from tests.views.made import CAMERA, both_seen, carrier, exact, poses, seen_in

AT, ALONG = np.array([0.0, 50.0, 535.0]), np.array([0.0, 0.0, -1.0])
BY_MOTION = ALONG @ np.hstack([-cross_matrices(AT[None])[0], np.eye(3)])
FLAT, FLANKS = np.diag([0.0, 0.0, 1.0]), np.diag([0.5, 0.499, 0.001])
"""How the normals spread of a face square to the camera, and of flanks with the noise of their normals."""
SHARED = Overlap("scan", "turned", 5000, 0.004, 0.01, 0.0, FLAT)


def checked(known, seen, seed=0, overlaps=(SHARED,)):
    joint = join(known, seen, CAMERA)
    first, second = poses(seed)
    error = float(((joint.pose(1) @ (first @ second.inverse()).inverse()).apply(AT[None])[0] - AT) @ ALONG)
    u = float(np.sqrt(BY_MOTION @ joint.covariance(1) @ BY_MOTION))
    return check_joint(joint, CAMERA, AT, ALONG, overlaps), error, u


def told(check):
    return {doubt.fact for doubt in check.doubts} | {note.code for note in check.notes}


def hurt(known, seed, change):
    """Both views of a carrier whose true positions `change` has changed since it was calibrated."""
    rng, true, (first, second) = np.random.default_rng(seed + 100), exact(known), poses(seed)
    true = replace(true, positions=change(true.positions.copy()))
    return seen_in(true, first, 0, rng, "scan"), seen_in(true, second, 1, rng, "turned")


def test_of_rigs_in_order_nothing_is_told():
    for seed in range(12):
        known = carrier(seed)
        check, _, _ = checked(known, both_seen(known, seed), seed)
        assert told(check) == set()


def bent(positions):
    positions[:, 2] += 0.1 * (positions[:, 0] / 104) ** 2
    return positions


def moved(positions):
    positions[15, 0] += 0.2
    return positions


def lifted(positions):
    positions[15, 2] += 0.2
    return positions


@pytest.mark.parametrize("change", [bent, moved, lifted], ids=lambda one: one.__name__)
def test_what_a_hurt_carrier_does_is_told_or_within_U(change):
    for seed in range(12):
        known = carrier(seed)
        check, error, u = checked(known, hurt(known, seed, change), seed)
        _, without, _ = checked(known, both_seen(known, seed), seed)
        assert told(check) or abs(error - without) <= 2 * u, (seed, error, without, u)


@pytest.mark.parametrize(("marks", "axis", "mm"), [(5, 2, 0.3), (6, 2, 0.3), (5, 0, 0.5)])
def test_where_many_marks_have_moved_nothing_is_proven(marks, axis, mm):
    def change(positions):
        positions[12 : 12 + 2 * marks : 2, axis] += mm
        return positions

    for seed in range(3):
        known = carrier(seed)
        try:
            check, error, u = checked(known, hurt(known, seed, change), seed)
        except InputError as refused:
            assert refused.code == "views.too_few_marks_fit"
        else:
            assert check.doubts or abs(error) <= 2 * u


def test_five_marks_side_by_side_lifted_together_prove_nothing():
    """Of six or seven a tilt hides so much that marks do not tell; the overlap must."""

    def change(positions):
        positions[12:17, 2] += 0.3
        return positions

    known = carrier()
    assert "marks_disagree" in told(checked(known, hurt(known, 0, change))[0])


def test_with_as_many_marks_as_hold_a_view_nothing_is_proven():
    known = carrier()
    first, second = both_seen(known)
    check, _, _ = checked(known, (first, second.select(np.arange(12) % 3 == 0)))
    assert [doubt.fact for doubt in check.doubts] == ["few_marks_fit"]


@pytest.mark.parametrize(("axis", "mm"), [(0, 0.6), (1, 0.6), (2, 2.0)])
@pytest.mark.parametrize("seed", range(3))
def test_one_of_four_marks_moved_is_refused_or_proves_nothing(axis, mm, seed):
    def change(positions):
        positions[12, axis] += mm
        return positions

    known = carrier(seed)
    first, second = hurt(known, seed, change)
    for chosen in ([0, 3, 6, 9], [0, 1, 2, 3]):
        try:
            check, _, _ = checked(known, (first, second.select(np.isin(np.arange(12), chosen))), seed)
        except InputError as refused:
            assert refused.code == "views.too_few_marks_fit"
        else:
            assert "few_marks_fit" in told(check)


def test_a_mark_that_was_moved_is_named():
    known = carrier()
    check, error, u = checked(known, hurt(known, 0, moved))
    (note,) = [note for note in check.notes if note.code == "views.marks_left_out"]
    assert note.values["numbers"] == (15,)
    assert abs(error) <= 2 * u


def test_all_marks_of_a_side_moved_against_the_other_are_not_seen_by_marks_alone():
    """Why the carrier's calibration states how its sides lie to each other, and why an overlap matters."""

    def shifted(positions):
        positions[12:, 2] += 0.1
        return positions

    known = carrier()
    assert told(checked(known, hurt(known, 0, shifted))[0]) == set()


def test_an_overlap_that_disagrees_is_said_first_and_proves_nothing():
    known = carrier()
    seen = hurt(known, 0, lambda positions: positions + 3 * np.random.default_rng(2).normal(0, 0.1, positions.shape))
    check, _, _ = checked(known, seen, overlaps=(replace(SHARED, mm=0.1),))
    assert [doubt.fact for doubt in check.doubts][:2] == ["overlap_disagrees", "marks_disagree"]


def test_surfaces_that_face_each_other_are_told():
    known = carrier()
    check, _, _ = checked(known, both_seen(known), overlaps=(replace(SHARED, opposed=0.9),))
    assert [doubt.fact for doubt in check.doubts] == ["joint_inside_out"]


def test_without_an_overlap_nothing_shows_a_slip_and_nothing_is_proven():
    known = carrier()
    assert told(checked(known, both_seen(known), overlaps=())[0]) == {"slip_unseen"}


def test_a_carrier_as_printed_proves_nothing():
    known = carrier()
    assert told(checked(replace(known, as_printed=True), both_seen(known))[0]) == {"carrier_as_printed"}


def test_flanks_alone_do_not_show_a_slip_along_the_thickness():
    known = carrier()
    check, _, _ = checked(known, both_seen(known), overlaps=(replace(SHARED, spread=FLANKS),))
    assert told(check) == {"part_may_have_slipped"}
    assert check.u_slip_mm == pytest.approx(SHARED.u_mm / np.sqrt(FLANKS[2, 2]), rel=0.01)


def test_a_slip_is_shown_by_views_between_as_well():
    known = carrier()
    first, second = both_seen(known)
    middle = MarksSeen(first.numbers, first.uv, first.covariance, "again")
    again = Overlap("scan", "again", 5000, 0.0, 0.01, 0.0, FLAT)
    joint = join(known, (first, middle, second), CAMERA)
    u = [
        check_joint(joint, CAMERA, AT, ALONG, (again, *more)).u_slip_mm
        for more in ((), (replace(again, first="again", second="turned"),))
    ]
    assert u[0] > 1.0
    assert u[1] == pytest.approx(np.sqrt(2) * 0.01, rel=0.01)


def test_a_view_of_marks_elsewhere_is_a_pair_off():
    known = carrier()
    first, second = both_seen(known)
    uv = second.uv.copy()
    apart = (uv[2] - uv[3]) / np.linalg.norm(uv[2] - uv[3])
    uv[2:4] += [0.145 * apart, -0.145 * apart]
    check, _, _ = checked(known, (first, MarksSeen(second.numbers, uv, second.covariance, "turned")))
    assert "marks_apart" in told(check)
    worst = max(check.pairs, key=lambda pair: pair.z)
    assert worst.view == "turned"
    assert worst.z > 4
