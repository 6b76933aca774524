"""Deviations of known planes: how they follow camera and print, and what errs in them alone."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.camera.reprojection import camera_of, parameters_of
from core.calibrate.deviations import Deviation, moved_fan
from core.scan.known_planes.known_plane import Control
from core.scan.known_planes.plane_deviations import PLANE_TARGET, followed_by_planes, own_deviations
from tests.scan.known_planes.planes_on_paper import CORNER, board
from tests.scan.synthetic import CAMERA, FAN

NEAR, FAR = (
    replace(board(plane, number, sd_mm=0.02), by_camera=np.full((3, 10), 1e-9 * (number + 1)), print_of=name)
    for number, (plane, name) in enumerate(zip(CORNER, (PLANE_TARGET, "own"), strict=True))
)
CONTROL = Control(FAN, (NEAR, FAR))


def moves(deviations, source):
    """By how much (K, P, 3) the deviations of one source move the planes."""
    return np.array([one.planes - CONTROL.plane_pis for one in deviations if one.source == source])


def test_planes_follow_the_camera_as_their_pictures_say():
    step = np.zeros(10)
    step[3] = 0.5
    other = camera_of(parameters_of(CAMERA) + step, CAMERA.image_size)
    (followed,) = followed_by_planes([Deviation("camera", other, FAN)], CAMERA, CONTROL, 0.001)
    expected = CONTROL.plane_pis + [[5e-10], [1e-9]]
    assert followed.planes == pytest.approx(expected, rel=1e-12)
    assert followed.camera is other and followed.fan is FAN


def test_boards_of_the_plane_targets_print_are_larger_with_it_and_no_others():
    larger = Deviation("scale", CAMERA, moved_fan(FAN, -0.001 * FAN.pis.ravel()))
    (followed,) = followed_by_planes([larger], CAMERA, CONTROL, 0.001)
    assert followed.planes[0] == pytest.approx(0.999 * NEAR.pi)
    assert np.array_equal(followed.planes[1], FAR.pi)


def test_without_planes_deviations_stay_as_they_are():
    one = Deviation("camera", CAMERA, FAN)
    assert followed_by_planes([one], CAMERA, Control(FAN), 0.001) == (one,)


@pytest.mark.parametrize(("assumed", "source"), [(False, "known flatness"), (True, "assumed known flatness")])
def test_own_deviations_of_pose_and_flatness_sum_up_to_their_covariances(assumed, source):
    planes = tuple(replace(plane, of_flatness=4 * plane.of_pose, flatness_assumed=assumed) for plane in CONTROL.planes)
    own = list(own_deviations(CAMERA, Control(FAN, planes), fan_has_scale=True))
    assert {one.source for one in own} == {"known pose", source}
    for name, times in (("known pose", 1), (source, 4)):
        of_all = moves(own, name).reshape(-1, 6)
        expected = np.zeros((6, 6))
        expected[:3, :3], expected[3:, 3:] = NEAR.of_pose, FAR.of_pose
        assert of_all.T @ of_all == pytest.approx(times * expected, abs=1e-6 * expected.max())


def test_a_print_has_one_size_and_the_plane_targets_is_the_fans_where_there_is_one():
    planes = [replace(plane, scale_sd=0.002) for plane in CONTROL.planes]
    twins = Control(FAN, (planes[0], planes[1], replace(planes[1], name="twin")))
    sizes = [one for one in own_deviations(CAMERA, twins, fan_has_scale=True) if one.source == "known size"]
    (size,) = sizes
    assert np.array_equal(size.planes[0], NEAR.pi), "its size is a deviation of the fan"
    assert size.planes[1:] == pytest.approx(0.998 * twins.plane_pis[1:]), "both boards of the print together"
    alone = [one for one in own_deviations(CAMERA, twins, fan_has_scale=False) if one.source == "known size"]
    assert len(alone) == 2


def test_a_size_that_nobody_stated_is_named_so():
    control = Control(FAN, (replace(FAR, scale_sd=0.002, scale_assumed=True),))
    sources = [one.source for one in own_deviations(CAMERA, control, fan_has_scale=True)]
    assert sources.count("assumed known size") == 1 and "known size" not in sources
