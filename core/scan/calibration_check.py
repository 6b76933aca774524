"""Does a scan agree with the calibration it is solved with, and what does it know of it?

A scan's crossings cannot tell everything of the calibrations: π → s π + c of all planes, the fan's included, leaves
every crossing as it is. But how the fan's planes stand to each other, and the camera's distortion, they do see: with a
fan or camera that is off, no light planes of the sweeps satisfy them all. Let z be the calibrations' independent errors
in standard uncertainties (`core.calibrate.deviations`), N(0, 1) before the scan, and m a motion of the fan's laser
against the camera since it was calibrated. With the misclosures v, their derivatives B by z and m and A by the
network's unknowns, eliminated::

    N = Bᵀ W B − Bᵀ W A H⁻¹ Aᵀ W B,   g = −Bᵀ W v

N = 1 in a direction of z means that the scan knows as much of it as the calibration, and would halve its variance. If
nothing has moved, the part of g that belongs to m has the covariance N_mz N_zm + M, with M from the noise of the scan
alone, of which the crossings' whole covariance (`core.scan.adjustment`) is taken.

References
----------
Koch, K.-R., Parameter Estimation and Hypothesis Testing in Linear Models (1999), 3.2 (prior information), 4.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_solve
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from core.calibrate.deviations import Deviation
from core.model import Camera, Fan, LightPlane
from core.model.arrays import Array
from core.scan.adjustment import Adjustment, Solution
from core.scan.features import ScanFeatures
from core.scan.geometry import CrossingRays
from core.scan.line_errors import LineErrors
from core.scan.locate import by_sweep, numbered
from core.scan.results import ScanResult

KNOWN = 1e-6
"""A scan does not see a motion of which less than this share is left once the sweeps may follow it."""
SURE = 1e-4
"""Something has moved for sure if chance alone would look so more rarely than this."""
MUCH = 3.0
"""Less than this many times what the calibrations and the scan's noise let one expect is not worth a word."""
STEP = 1e-4
"""rad, and times 1000 mm: derivatives by motions are taken over such steps."""
_ROUNDS = 2


@dataclass(frozen=True, eq=False, slots=True)
class CalibrationCheck:
    """What a scan says of the calibrations.

    Parameters
    ----------
    information
        (K, K) N of the K deviations z: 1 where it knows as much as the calibrations.
    scatter
        (K, K) covariance of their g from the scan's noise.
    squares
        Sum of squares of the motions seen, in units of their covariance if nothing has moved.
    freedom
        Motions that the scan sees.
    """

    information: Array
    scatter: Array
    squares: float
    freedom: int

    @property
    def posterior(self) -> Array:
        """(K, K) covariance of z, 1 before, if the scan were let adjust the calibrations."""
        one = np.eye(len(self.information))
        gain = np.linalg.inv(one + self.information)
        return np.asarray(gain @ (one + self.scatter) @ gain)

    @property
    def p(self) -> float:
        """Probability that chance alone sets scan and calibrations this far apart; 1 where the scan cannot tell."""
        return float(chi2.sf(self.squares, self.freedom)) if self.freedom else 1.0

    @property
    def notes(self) -> tuple[str, ...]:
        """A sentence if laser and camera have moved against each other since they were calibrated."""
        times = float(np.sqrt(self.squares / max(self.freedom, 1)))
        if self.p > SURE or times < MUCH:
            return ()
        return (
            f"The fan is {times:.0f} times further from where it was calibrated than the calibration allows: laser or "
            "camera have moved since, or the target was not true; calibrate the fan again.",
        )


def check_calibration(
    features: ScanFeatures, scan: ScanResult, camera: Camera, fan: Fan, deviations: Sequence[Deviation]
) -> CalibrationCheck:
    """What a `scan` of `features`, its sweeps solved together with `camera` and `fan`, says of the `deviations`."""
    crossings, line = numbered(features.crossings, scan.fan_lines)
    table = by_sweep(crossings.select(scan.of_solved), scan.sweep_frames)
    geometry = CrossingRays.of(table, camera)
    equations = Adjustment(table, geometry, line[scan.of_solved], fan, len(scan.pis), LineErrors.of(table))
    solution = replace(equations.start(), pis=scan.pis)
    for _ in range(_ROUNDS):
        solution = equations.improve(solution, scan.crossing_weights[scan.of_solved])
    calibrated = [
        _change(equations, solution, one.fan, one.camera if one.camera is not camera else None) for one in deviations
    ]
    moved = [_change(equations, solution, one) for one in _motions(fan, geometry)]
    changes = np.array([*calibrated, *moved]).T
    weight = solution.weights / solution.sigma**2
    eliminated = cho_solve(solution.factor, solution.design.T @ (weight[:, None] * changes), check_finite=False)
    felt = weight[:, None] * (changes - solution.design @ eliminated)
    information = changes.T @ felt
    noise, cells = equations.noise(solution).T @ felt, eliminated[3 * equations.sweeps :]
    scatter = max(1.0, scan.scale) ** 2 * (noise.T @ noise + cells.T @ cells)
    gradient = -changes.T @ (weight * solution.residuals * solution.sigma)
    z, m = slice(0, len(calibrated)), slice(len(calibrated), None)
    followed = np.einsum("mk,m,mk->k", changes, weight, changes)[m]
    expected = information[m, z] @ information[z, m] + scatter[m, m]
    squares, freedom = _squares(gradient[m], information[m, m], followed, expected)
    return CalibrationCheck(information[z, z], scatter[z, z], squares, freedom)


def _squares(gradient: Array, information: Array, followed: Array, expected: Array) -> tuple[float, int]:
    """Sum of squares of `gradient` (6,) in units of the covariance `expected`, where `information` is; and how many.

    `followed` (6,) is what the information would be if the sweeps could not follow.
    """
    unit = 1 / np.sqrt(np.maximum(followed, 1e-300))
    values, vectors = np.linalg.eigh(information * np.outer(unit, unit))
    seen = unit[:, None] * vectors[:, values > KNOWN]
    part = seen.T @ gradient
    return float(part @ np.linalg.solve(seen.T @ expected @ seen, part)), len(part)


def _motions(fan: Fan, geometry: CrossingRays) -> list[Fan]:
    """The fan after a small turn about, and a small shift along, each axis through the middle of what is seen."""
    ray = np.median(geometry.rays, axis=0)
    pivot = ray / np.median(fan.pis @ ray)
    moved = []
    for axis in np.eye(3):
        turn = Rotation.from_rotvec(STEP * axis).as_matrix()
        for rotation, shift in ((turn, np.zeros(3)), (np.eye(3), 1e3 * STEP * axis)):
            planes = []
            for plane in fan.planes:
                normal = rotation @ plane.normal
                foot = rotation @ (plane.normal * plane.d_mm - pivot) + pivot + shift
                planes.append(LightPlane(normal / (normal @ foot)))
            moved.append(Fan(tuple(planes)))
    return moved


def _change(equations: Adjustment, solution: Solution, fan: Fan, camera: Camera | None = None) -> Array:
    """(M,) change of the misclosures observed − adjusted, in 1/mm, with another `fan` and `camera` (None: the same)."""
    rays = equations.geometry.rays
    here = np.einsum("mi,mi->m", equations.differences(solution.pis), rays)
    there = replace(equations, fan=fan).differences(solution.pis)
    other = rays if camera is None else camera.rays(equations.crossings.uv)
    return np.asarray(here - np.einsum("mi,mi->m", there, other))
