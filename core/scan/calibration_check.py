"""Check of the calibrations by a scan: whether they agree, and how much the scan knows of them.

A scan's crossings cannot tell everything of the calibrations: π → s π + c of all planes, the fan's included, leaves
every crossing as it is. But how the fan's planes stand to each other, and the camera's distortion, they do see: with a
fan or camera that is off, no light planes of the sweeps satisfy them all. Let z be the calibrations' independent errors
in standard uncertainties (`core.calibrate.deviations`), N(0, 1) before the scan, and m a motion of the fan's laser
against the camera since it was calibrated. With the misclosures v, their derivatives B by z and m and A by the
network's unknowns, eliminated::

    N = Bᵀ W B − Bᵀ W A H⁻¹ Aᵀ W B,   g = −Bᵀ W v

N = 1 in a direction of z means that the scan knows as much of it as the calibration, and would halve its variance. If
nothing has moved, the part of g that belongs to m has the covariance N_mz N_zm + M, with M from the noise of the scan
alone, of which the crossings' whole covariance (`core.scan.network.equations`) is taken.

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
from core.messages import Message
from core.model import Camera, Fan, LightPlane
from core.model.arrays import Array
from core.scan.features.extraction import ScanFeatures
from core.scan.network.equations import Adjustment, Solution
from core.scan.network.geometry import CrossingRays
from core.scan.network.line_errors import LineErrors
from core.scan.results import ScanResult
from core.scan.sweeps.locate import by_sweep, numbered

# When it is said that laser and camera have moved. Chosen so that no true calibration is accused and a moved laser is
# found: tests/scan/test_calibration_check.py holds them.
SIGNIFICANCE = 1e-4
"""Something has moved if the probability that chance alone would look so is smaller."""
LEAST_FACTOR = 3.0
"""Less than this many times what the calibrations and the scan's noise let one expect is not reported."""
LEAST_SEEN_SHARE = 1e-6
"""A scan does not see a motion of which less than this share is left once the sweeps may follow it."""

MOTION_STEP = 1e-4
"""Step of the derivatives by motions: rad, and times 1000 mm. Large against rounding, small against any bend."""
_ROUNDS = 2
"""Rounds of Gauss–Helmert, with the weights of the solution: the first moves the crossings, the second settles."""


@dataclass(frozen=True, eq=False, slots=True)
class CalibrationCheck:
    """Result of checking the calibrations by a scan.

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
    def notes(self) -> tuple[Message, ...]:
        """A note if laser and camera have moved against each other since they were calibrated."""
        times = float(np.sqrt(self.squares / max(self.freedom, 1)))
        if self.p > SIGNIFICANCE or times < LEAST_FACTOR:
            return ()
        return (
            Message(
                "scan.fan_has_moved",
                "The fan is {times:.0f} times further from where it was calibrated than the calibration allows: laser "
                "or camera have moved since, or the target was not true; calibrate the fan again.",
                times=times,
            ),
        )


def check_calibration(
    features: ScanFeatures, scan: ScanResult, camera: Camera, fan: Fan, deviations: Sequence[Deviation]
) -> CalibrationCheck:
    """Check the calibrations by a scan.

    `scan` is the solution of `features` by the network with `camera` and `fan`; `deviations` are the K principal
    deviations of their calibrations.
    """
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
    seen = unit[:, None] * vectors[:, values > LEAST_SEEN_SHARE]
    part = seen.T @ gradient
    return float(part @ np.linalg.solve(seen.T @ expected @ seen, part)), len(part)


def _motions(fan: Fan, geometry: CrossingRays) -> list[Fan]:
    """The fan after a small turn about, and a small shift along, each axis through the middle of what is seen."""
    ray = np.median(geometry.rays, axis=0)
    pivot = ray / np.median(fan.pis @ ray)
    moved = []
    for axis in np.eye(3):
        turn = Rotation.from_rotvec(MOTION_STEP * axis).as_matrix()
        for rotation, shift in ((turn, np.zeros(3)), (np.eye(3), 1e3 * MOTION_STEP * axis)):
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
