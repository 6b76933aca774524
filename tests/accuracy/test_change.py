"""Rigs that changed between calibration and scan, at the level of centrelines: is U true, or is it told?

Camera and fan are drawn about the true ones as their calibrations leave them; then the laser turns or the picture
drifts; then the scan is taken, with three pictures of an interim check or without: the plane target near, in the
middle and far of where parts are, tilted as the manual says, or as it comes: four corners that are seen nearly square
on tell little of a tilt.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.calibrate.camera.reprojection import camera_of, parameters_of
from core.calibrate.change import DEFAULT_STABILITY, STABLE, Evidence, changes, displaced_fan, judge
from core.calibrate.deviations import Deviation
from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.calibrate.fan.interim_check import check_poses
from core.inspect.faces import find_faces
from core.inspect.gauge import fit_gauge
from core.inspect.uncertainty.budget import combined
from core.inspect.uncertainty.point_errors import PointErrors
from core.model import Pose
from core.scan.common_errors import solve_common
from core.scan.reconstruct import reconstruct
from core.scan.scan_evidence import scan_evidence
from core.scan.sweeps.fan_lines import FanLines
from core.simulate.scenario import Scenario
from tests.accuracy.coverage import _calibration_steps, _off
from tests.calibrate import fan_scenes
from tests.scan.centreline_scan import ExactScan

HEIGHT = 50.0
CHANGED = {
    "nothing": (np.zeros(3), 0.0),
    "laser turned by 100 urad": (np.array([100e-6, 0, 0]), 0.0),
    "laser turned by 262 urad": (np.array([262e-6, 0, 0]), 0.0),
    "laser turned sideways by 262 urad": (np.array([0, 262e-6, 0]), 0.0),
    "picture drifted by 0.3 px": (np.zeros(3), 0.3),
    "picture drifted by 1 px": (np.zeros(3), 1.0),
}


def tilted(depth: float, across: float, along: float) -> Pose:
    """The plane target in the fan, tilted by these angles in degrees."""
    tilt = Rotation.from_euler("yx", [across, along], degrees=True)
    return Pose(tilt.as_matrix(), np.array([0.0, 0.075 * depth, depth]) - tilt.apply([30.0, 30.0, 0.0]))


AS_TOLD = (tilted(450, 40, 0), tilted(525, -20, 34), tilted(600, -20, -34))
"""By 40°, each to another side."""


@cache
def exact() -> ExactScan:
    return ExactScan.of(Scenario(height_mm=HEIGHT, seed=1, scale=0.5, frames=30))


@cache
def calibrated_fan():
    shown = fan_scenes.features(fan_scenes.poses(9, 2), fan_scenes.Noise(), 2)
    return fit_fan(shown, fan_scenes.CAMERA, FanOptions(3, fan_scenes.ALPHA))


def measured(turn, drift_px: float, seed: int) -> dict[str, tuple[float, float, float]]:
    """Error and U of the thickness in mm and p of a change: of a rig called stable, without a check, and with one.

    The check is made with a black square's four corners, tilted as told or as it comes, or with a grid of corners.
    """
    rig, steps = exact().rig, _calibration_steps()
    rng = np.random.default_rng([seed, 15])
    camera, fan = _off(rig.camera, rig.fan, sum((rng.normal() * step for _, step in steps), np.zeros(19)))
    fan = displaced_fan(fan, -turn, rig.fan_emitter)  # what was calibrated is where the rig was before
    there = parameters_of(camera) - drift_px * np.array([0, 0, 0, 1.0, 0.6, 0, 0, 0, 0, 0])
    camera = camera_of(there, camera.image_size)
    features = exact().measured(seed)
    scan = reconstruct(features, camera, fan, fan_lines=FanLines.settled_as(exact().fan_line))
    known = tuple(Deviation(source, *_off(camera, fan, step)) for source, step in steps)
    deviations = (*known, *changes(camera, fan))
    depths = sorted(fan_scenes.poses(9, 100 + seed), key=lambda pose: pose.translation[2])
    as_it_comes = [depths[0], depths[len(depths) // 2], depths[-1]]

    def of_check(points, where=AS_TOLD) -> Evidence:
        shown = fan_scenes.features(list(where), fan_scenes.Noise(), seed, pis=rig.fan.pis, points=points)
        return check_poses(shown, camera, replace(calibrated_fan(), fan=fan), deviations)[1]

    of_scan = scan_evidence(scan, camera, fan, deviations)
    cases = {
        "stable": (Evidence.none(len(deviations)), STABLE),
        "unchecked": (of_scan, DEFAULT_STABILITY),
        "checked": (of_scan + of_check(fan_scenes.SQUARE), DEFAULT_STABILITY),
        "checked as it comes": (of_scan + of_check(fan_scenes.SQUARE, as_it_comes), DEFAULT_STABILITY),
        "checked with a grid": (of_scan + of_check(fan_scenes.GRID), DEFAULT_STABILITY),
    }
    faces, found = find_faces(scan.cloud), {}
    for name, (evidence, stability) in cases.items():
        change = judge(camera, fan, deviations, evidence, stability)
        common = solve_common(scan, camera, fan, change.deviations)
        errors = PointErrors.of_scan(features, scan.covariance, common, scan.speckle)
        fit = fit_gauge(scan.cloud, errors=errors, regions=faces)
        found[name] = fit.thickness_mm - HEIGHT, 2 * combined(fit.budget), change.p
    return found


@pytest.mark.accuracy
def test_no_change_makes_a_thickness_wrong_beyond_u_without_a_word():
    print()
    U = {case: [] for case in ("stable", "unchecked", "checked", "checked as it comes", "checked with a grid")}
    for name, (turn, drift) in CHANGED.items():
        for seed in (1, 2):
            found = measured(turn, drift, seed)
            told = "; ".join(
                f"{case} {1e3 * error:+.0f} ± {1e3 * U_mm:.0f} µm (p {p:.1g})"
                for case, (error, U_mm, p) in found.items()
            )
            print(f"{name}: {told}")
            for case in U.keys() - {"stable"}:
                error, U_mm, p = found[case]
                assert abs(error) <= U_mm or p < 0.001, (name, case)
            if name == "nothing":
                for case, (_, U_mm, _) in found.items():
                    U[case].append(U_mm)
                assert found["checked"][2] > 0.01
                assert found["checked as it comes"][2] > 0.01
            if turn[0] > 200e-6 or drift >= 0.3:
                assert found["checked"][2] < 0.001, "the check sees it"
    over = {case: float(np.mean(of_case) / np.mean(U["stable"])) for case, of_case in U.items()}
    print("U over U of a rig that nothing can change:", {case: round(times, 2) for case, times in over.items()})
    assert over["checked"] < 1.2
    assert over["checked as it comes"] < 1.6
    assert over["checked with a grid"] < 1.2
