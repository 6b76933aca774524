"""What a scan says of the calibrations it is solved with."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.calibrate.camera.reprojection import camera_of, parameters_of
from core.calibrate.deviations import Deviation, moved_fan
from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.model import Camera, Fan, LightPlane
from core.scan.calibration_check import check_calibration
from core.scan.features.extraction import ScanFeatures
from core.scan.reconstruct import reconstruct
from core.scan.sweeps.fan_lines import FanLines
from core.simulate.scenario import Scenario
from tests.calibrate.fan_scenes import ALPHA, CAMERA, Noise, features, poses
from tests.scan.centreline_scan import ExactScan

FOCAL_SHARE = 1e-4
"""Standard uncertainty of the focal length, as a share of it."""


@pytest.fixture(scope="module")
def exact():
    return ExactScan.of(Scenario(height_mm=50.0, seed=4, scale=0.5, frames=24))


@pytest.fixture(scope="module")
def fan_steps():
    """One-σ steps (9,) of the fan, as nine poses of its target leave them."""
    covariance = fit_fan(features(poses(9, 2), Noise(), 2), CAMERA, FanOptions(3, ALPHA)).fan.covariance
    values, vectors = np.linalg.eigh(covariance)
    return (vectors * np.sqrt(np.maximum(values, 0)))[:, -5:].T


SEEN: dict[int, ScanFeatures] = {}


def measured(exact: ExactScan, seed: int) -> ScanFeatures:
    """What the scan shows with the noise of this seed, found once."""
    if seed not in SEEN:
        SEEN[seed] = exact.measured(seed)
    return SEEN[seed]


def longer(camera: Camera, share: float) -> Camera:
    """The camera with a focal length longer by `share`."""
    return camera_of(parameters_of(camera) * np.array([1 + share, 1 + share, *[1] * 8]), camera.image_size)


def turned(fan: Fan, degrees: float, axis: int) -> Fan:
    """The fan turned about an axis through its laser."""
    rotation = Rotation.from_rotvec(np.radians(degrees) * np.eye(3)[axis]).as_matrix()
    laser = np.array([120.0, 30.0, 300.0])
    planes = []
    for plane in fan.planes:
        normal = rotation @ plane.normal
        foot = rotation @ (plane.normal * plane.d_mm - laser) + laser
        planes.append(LightPlane(normal / (normal @ foot)))
    return Fan(tuple(planes))


def checked(exact: ExactScan, seed: int, camera: Camera, fan: Fan, steps: np.ndarray):
    """The check of a scan with fresh noise that is solved with this camera and fan."""
    deviations = [Deviation("fan", camera, moved_fan(fan, step)) for step in steps]
    deviations.append(Deviation("camera", longer(camera, FOCAL_SHARE), fan))
    seen = measured(exact, seed)
    scan = reconstruct(seen, camera, fan, fan_lines=FanLines.settled_as(exact.fan_line))
    return check_calibration(seen, scan, camera, fan, deviations)


def test_scans_and_calibrations_agree_as_closely_as_is_stated(exact, fan_steps):
    rng = np.random.default_rng(1)
    checks = []
    for seed in range(4):
        fan = moved_fan(exact.rig.fan, rng.normal(size=5) @ fan_steps)
        camera = longer(exact.rig.camera, FOCAL_SHARE * rng.normal())
        checks.append(checked(exact, seed, camera, fan, fan_steps))
    assert {check.freedom for check in checks} == {3}, "turns and shifts that leave no trace are not looked at"
    assert 0.25 < np.mean([check.squares / check.freedom for check in checks]) < 2.2
    assert not any(check.notes for check in checks)


@pytest.mark.parametrize(("degrees", "axis"), [(0.1, 0), (0.25, 1), (0.25, 2)])
def test_a_laser_that_was_knocked_after_its_calibration_is_found_out(exact, fan_steps, degrees, axis):
    check = checked(exact, 3, exact.rig.camera, turned(exact.rig.fan, degrees, axis), fan_steps)
    assert check.p < 1e-6
    assert check.notes[0].code == "scan.fan_has_moved"


def test_a_scan_can_hardly_better_its_calibrations(exact, fan_steps):
    """Why there is the check alone and no refinement: the scan leaves more than 0.9 of each standard uncertainty."""
    check = checked(exact, 3, exact.rig.camera, exact.rig.fan, fan_steps)
    left = np.sqrt(np.linalg.eigvalsh(check.posterior))
    print("standard uncertainties of the calibrations, adjusted by the scan over before:", np.round(left, 3))
    assert (left > 0.9).all()
    assert (left < 1.001).all()


def test_a_scan_knows_more_of_calibrations_that_know_little(exact, fan_steps):
    """As a check of the normal matrix: of fifty times the uncertainty the scan takes three unknowns, never five."""
    check = checked(exact, 3, exact.rig.camera, exact.rig.fan, 50 * fan_steps)
    left = np.sort(np.linalg.eigvalsh(check.posterior))
    assert (left[:3] < 0.35).all()
    assert (left[3:5] > 0.5).all(), "scale and place come from nowhere else"


def test_frames_that_left_the_scan_do_not_matter(exact, fan_steps):
    seen = measured(exact, 2)
    camera, fan = exact.rig.camera, exact.rig.fan
    scan = reconstruct(seen, camera, fan, fan_lines=FanLines.settled_as(exact.fan_line))
    fewer = replace(scan, pis=scan.pis[:-2], sweep_frames=scan.sweep_frames[:-2])
    assert check_calibration(seen, fewer, camera, fan, []).freedom == 3


def test_a_scan_over_one_line_cannot_tell_whether_anything_moved(exact):
    """The sweeps follow whatever one plane does."""
    lines = FanLines.settled_as([number if number == 1 else -1 for number in exact.fan_line])
    seen = measured(exact, 2)
    scan = reconstruct(seen, exact.rig.camera, exact.rig.fan, fan_lines=lines)
    check = check_calibration(seen, scan, exact.rig.camera, exact.rig.fan, [])
    assert (check.freedom, check.p, check.notes) == (0, 1.0, ())
