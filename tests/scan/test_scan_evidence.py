"""What a scan says of the calibrations it is solved with, and of what has changed since."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.camera.reprojection import camera_of, parameters_of
from core.calibrate.change import STABLE, Change, Evidence, changes, displaced_fan, judge, lasting
from core.calibrate.deviations import Deviation, moved_fan
from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.model import Camera, Fan
from core.scan.features.extraction import ScanFeatures
from core.scan.reconstruct import reconstruct
from core.scan.scan_evidence import scan_evidence
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
    return displaced_fan(fan, np.radians(degrees) * np.eye(3)[axis], np.array([120.0, 30.0, 300.0]))


def said(exact: ExactScan, seed: int, camera: Camera, fan: Fan, steps: np.ndarray) -> tuple[list[Deviation], Evidence]:
    """What a scan with fresh noise says that is solved with this camera and fan."""
    deviations = [Deviation("fan", camera, moved_fan(fan, step)) for step in steps]
    deviations += [Deviation("camera", longer(camera, FOCAL_SHARE), fan), *changes(camera, fan)]
    seen = measured(exact, seed)
    scan = reconstruct(seen, camera, fan, fan_lines=FanLines.settled_as(exact.fan_line))
    return deviations, scan_evidence(scan, camera, fan, deviations)


def judged(exact: ExactScan, seed: int, camera: Camera, fan: Fan, steps: np.ndarray) -> Change:
    """What that proves of a rig that nothing should change."""
    deviations, evidence = said(exact, seed, camera, fan, steps)
    return judge(camera, fan, deviations, evidence, STABLE)


def left(exact: ExactScan, steps: np.ndarray) -> np.ndarray:
    """(K,) the calibrations' standard uncertainties adjusted by a scan, over those before."""
    deviations, evidence = said(exact, 3, exact.rig.camera, exact.rig.fan, steps)
    covariance = lasting(deviations, evidence, STABLE)[1]
    return np.sqrt(np.linalg.eigvalsh(covariance[: len(steps) + 1, : len(steps) + 1]))


@pytest.mark.accuracy
def test_scans_and_calibrations_agree_as_closely_as_is_stated(exact, fan_steps):
    rng = np.random.default_rng(1)
    found = []
    for seed in range(4):
        fan = moved_fan(exact.rig.fan, rng.normal(size=5) @ fan_steps)
        camera = longer(exact.rig.camera, FOCAL_SHARE * rng.normal())
        found.append(judged(exact, seed, camera, fan, fan_steps))
    assert 0.25 < np.mean([change.times**2 for change in found]) < 2.2
    assert not any(change.notes for change in found)


@pytest.mark.parametrize(("degrees", "axis"), [(0.1, 0), (0.25, 1), (0.25, 2)])
def test_a_laser_that_was_knocked_after_its_calibration_is_found_out(exact, fan_steps, degrees, axis):
    change = judged(exact, 3, exact.rig.camera, turned(exact.rig.fan, degrees, axis), fan_steps)
    assert change.p < 1e-6
    assert change.notes[0].code == "scan.fan_has_moved"


def test_a_scan_can_hardly_better_its_calibrations(exact, fan_steps):
    """Why nothing is refined by a scan: it leaves more than 0.9 of each standard uncertainty."""
    of_each = left(exact, fan_steps)
    assert (of_each > 0.9).all()
    assert (of_each < 1.001).all()


def test_a_scan_knows_more_of_calibrations_that_know_little(exact, fan_steps):
    """As a check of the normal matrix: of fifty times the uncertainty the scan takes three unknowns, never five."""
    of_each = np.sort(left(exact, 50 * fan_steps)) ** 2
    assert (of_each[:3] < 0.35).all()
    assert (of_each[3:5] > 0.5).all(), "scale and place come from nowhere else"


def test_frames_that_left_the_scan_do_not_matter(exact, fan_steps):
    seen = measured(exact, 2)
    camera, fan = exact.rig.camera, exact.rig.fan
    scan = reconstruct(seen, camera, fan, fan_lines=FanLines.settled_as(exact.fan_line))
    fewer = replace(scan, pis=scan.pis[:-2], sweep_frames=scan.sweep_frames[:-2])
    evidence = scan_evidence(fewer, camera, fan, changes(camera, fan))
    assert judge(camera, fan, changes(camera, fan), evidence, STABLE).times > 0


def test_a_scan_over_one_line_cannot_tell_whether_anything_moved(exact):
    """The sweeps follow whatever one plane does."""
    lines = FanLines.settled_as([number if number == 1 else -1 for number in exact.fan_line])
    seen, camera, fan = measured(exact, 2), exact.rig.camera, exact.rig.fan
    scan = reconstruct(seen, camera, fan, fan_lines=lines)
    change = judge(camera, fan, changes(camera, fan), scan_evidence(scan, camera, fan, changes(camera, fan)), STABLE)
    assert (change.times, change.p, change.notes) == (0.0, 1.0, ())
