"""What a scan says of the calibrations it is measured with, and of what has changed since.

A scan's crossings cannot tell everything of the calibrations: π → s π + c of all planes, the fan's included, leaves
every crossing as it is. But how the fan's planes stand to each other, and the camera's distortion, they do see: with a
fan or camera that is off, no light planes of the sweeps satisfy them all. With the misclosures v, their derivatives B
by the deviations and A by the network's unknowns, eliminated::

    N = Bᵀ W B − Bᵀ W A H⁻¹ Aᵀ W B,   g = −Bᵀ W v

N = 1 in a direction means that the scan knows as much of it as the calibration. The covariance of g is taken from the
crossings' whole covariance (`core.scan.network.equations`).

References
----------
Koch, K.-R., Parameter Estimation and Hypothesis Testing in Linear Models (1999), 3.2 (prior information), 4.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.linalg import cho_solve

from core.calibrate.change import Evidence
from core.calibrate.deviations import Deviation
from core.model import Camera, Fan
from core.model.arrays import Array
from core.scan.known_planes.known_plane import Control
from core.scan.network.equations import Adjustment, Solution
from core.scan.network.geometry import CrossingRays
from core.scan.network.line_errors import LineErrors
from core.scan.results import ScanResult
from core.scan.sweeps.locate import by_sweep

_ROUNDS = 2
"""Rounds of Gauss–Helmert, with the weights of the solution: the first moves the crossings, the second settles."""


def scan_evidence(scan: ScanResult, camera: Camera, fan: Fan | Control, deviations: Sequence[Deviation]) -> Evidence:
    """Compute from a scan's misclosures the normal equations for the sizes of K deviations of camera and fan.

    `scan` is the solution by the network with `camera` and `fan`, or with a control.
    """
    control = Control.of(fan)
    equations, solution = settled_equations(scan, camera, control)
    changes = np.array(
        [
            change_of_misclosures(
                equations, solution, control.displaced(one), one.camera if one.camera is not camera else None
            )
            for one in deviations
        ]
    ).T
    weight = solution.weights / solution.sigma**2
    eliminated = cho_solve(solution.factor, solution.design.T @ (weight[:, None] * changes), check_finite=False)
    felt = weight[:, None] * (changes - solution.design @ eliminated)
    noise, cells = equations.noise(solution).T @ felt, eliminated[equations.unknowns :]
    scatter = max(1.0, scan.scale) ** 2 * (noise.T @ noise + cells.T @ cells)
    gradient = -changes.T @ (weight * solution.residuals * solution.sigma)
    return Evidence(changes.T @ felt, scatter, gradient)


def settled_equations(scan: ScanResult, camera: Camera, control: Control) -> tuple[Adjustment, Solution]:
    """Make the equations that a scan was solved with, and its solution with the weights that it ended with."""
    table = by_sweep(scan.crossings.select(scan.of_solved), scan.sweep_frames)
    geometry = CrossingRays.of(table, camera)
    errors, line = LineErrors.of(table), scan.crossing_lines[scan.of_solved]
    equations = Adjustment(table, geometry, line, control, len(scan.pis), errors, scan.read_out)
    solution = replace(equations.start(), pis=scan.pis)
    for _ in range(_ROUNDS):
        solution = equations.improve(solution, scan.crossing_weights[scan.of_solved])
    return equations, solution


def change_of_misclosures(
    equations: Adjustment, solution: Solution, control: Control, camera: Camera | None = None
) -> Array:
    """Compute by how much (M,) in 1/mm misclosures change if `control` and `camera` replace those of the equations.

    `camera` None: the calibrated one.
    """
    rays = equations.geometry.rays
    here = np.einsum("mi,mi->m", equations.differences(solution.pis), rays)
    there = replace(equations, fan=control).differences(solution.pis)
    other = rays if camera is None else camera.rays(equations.crossings.uv)
    return np.asarray(here - np.einsum("mi,mi->m", there, other))
