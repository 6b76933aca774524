"""Check of camera and fan by known planes within a scan: do the sweeps, tied to the fan, see the boards where they are?

The network's numbers z of the planes (`core.scan.known_planes.known_plane`) are 0 but for their own uncertainty where
all is as calibrated. With H⁻¹ the inverse of its normal matrix and D what one standard uncertainty of each calibration
does to ẑ, the covariance of ẑ is ::

    V = (1 − C)(1 − C)ᵀ/l² + E Eᵀ + N + D Dᵀ

C the block of H⁻¹ of the planes, E that of the planes with the fan's cells, N what the crossings' noise does, l by how
many times the network lets planes lie farther off than they are known to (`Control.loosening`). So
ẑᵀ V⁻¹ ẑ is χ² distributed with three degrees of freedom a plane, less those that the sweeps say nothing of.

Agreement alone is no check: what is hardly known agrees with everything. With M what usual changes of the rig do to ẑ,
one standard uncertainty each (`core.calibrate.change`), ẑ has the covariance V + M Mᵀ after them: so the probability
that they would have been told is known, and it has to be as large as it is for a picture of a check.

References
----------
Ruben, H., Probability content of regions under spherical normal distributions, IV, Ann. Math. Statist. 33 (1962).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_solve
from scipy.special import chdtr, chdtrc, chdtri

from core.calibrate.change import P_TOLD
from core.calibrate.deviations import Deviation
from core.findings.table import note_of
from core.messages import Message, plain
from core.model import Camera
from core.model.arrays import Array
from core.scan.known_planes.known_plane import FREEDOMS, Control
from core.scan.results import ScanResult
from core.scan.scan_evidence import change_of_misclosures, settled_equations

DISAGREES = 0.001
"""Probability by chance below which fan and planes surely disagree."""
SEES = 0.92
"""Probability of telling usual changes of a rig from which on planes are a check of it, as one picture of the plane
target in the fan is: that has 0.93 in the simulated rig. Three have 0.99, a board known exactly 0.94 to 0.97."""
LEAST_SEEN = 1e-6
"""Share of a plane's own variance below which the sweeps say nothing of where it is."""
_TERMS = 150
"""Of the series for a sum of squares: what is left out of it is below 1e-9."""

_RIG = Message("scan.planes_say_rig", "the fixed laser or the camera has turned or shifted since the calibration")
_EITHER = Message(
    "scan.planes_say_either",
    "the fixed laser or the camera has turned since the calibration, or the board moved, is bent or of another size: a "
    "second board would tell",
)


@dataclass(frozen=True, slots=True)
class PlaneOff:
    """Disagreement of the fan with one known plane.

    Parameters
    ----------
    name
        The board's.
    mm
        How much farther from the camera, along its normal, the fan has the middle of where its light met the board.
    turn
        Angle in rad between the board and where the fan has it.
    times
        How many times larger both are, together, than the standard uncertainties let one expect.
    others_p
        Probability that chance alone would set the fan as far off the other planes, wherever this one is; 1 where there
        is none.
    """

    name: str
    mm: float
    turn: float
    times: float
    others_p: float = 1.0

    @property
    def degrees(self) -> float:
        """The angle in degrees."""
        return float(np.degrees(self.turn))


@dataclass(frozen=True, eq=False, slots=True)
class PlaneCheck:
    """Comparison of the fan with the known planes of a scan.

    Parameters
    ----------
    planes
        How far it is off each of them.
    squares, freedom
        χ² of all of it, and the numbers that are compared.
    sees
        Probability that usual changes of the rig since its calibration would have been told.
    """

    planes: tuple[PlaneOff, ...]
    squares: float
    freedom: int
    sees: float

    @property
    def p(self) -> float:
        """Probability that chance alone would set fan and planes as far apart."""
        return _by_chance(self.freedom, self.squares)

    @property
    def agrees(self) -> bool:
        """Whether fan and planes agree, were it only because little is known of them."""
        return self.p >= DISAGREES

    @property
    def passed(self) -> bool:
        """Whether fan and planes agree where changes of the rig would have been told: a check of camera and fan."""
        return self.agrees and self.sees >= SEES

    @property
    def alone_off(self) -> PlaneOff | None:
        """The only plane that the fan disagrees with, so that its board has moved or is bent; None if not only one."""
        alone = [one for one in self.planes if one.others_p >= P_TOLD]
        return min(alone, key=lambda one: -one.times) if alone and len(self.planes) > 1 else None

    @property
    def note(self) -> Message:
        """Note on whether fan and planes agree, and if not, on what is the likeliest reason."""
        worst = max(self.planes, key=lambda one: one.times)
        names = tuple(plain(one.name) for one in self.planes)
        mm = max(abs(one.mm) for one in self.planes)
        if self.passed:
            return note_of("scan.checked_by_planes", boards=names, mm=mm, p=self.p)
        if self.agrees:
            return note_of(
                "scan.planes_see_little", boards=names, mm=mm, p=self.p, percent=100 * self.sees, least=100 * SEES
            )
        alone = self.alone_off
        if alone is not None:
            return note_of(
                "scan.board_off", board=alone.name, mm=abs(alone.mm), degrees=alone.degrees, times=alone.times
            )
        return note_of(
            "scan.planes_disagree",
            boards=names,
            mm=abs(worst.mm),
            degrees=worst.degrees,
            times=worst.times,
            cause=_RIG if len(self.planes) > 1 else _EITHER,
        )


def check_by_planes(
    scan: ScanResult,
    camera: Camera,
    control: Control,
    deviations: Sequence[Deviation],
    usual: Sequence[Deviation],
) -> PlaneCheck:
    """Compare the fan with the known planes of a scan that was solved with both; on each of them a point counts.

    `deviations` are what the calibrations leave uncertain, `usual` how rigs change after them, one standard uncertainty
    each.
    """
    equations, solution = settled_equations(scan, camera, control)
    first = equations.before_planes
    z = solution.cells[first - equations.unknowns :]
    of_planes = solution.inverse[:, first:]
    weight = solution.weights / solution.sigma**2
    noise = equations.noise(solution).T @ (weight[:, None] * (solution.design @ of_planes))
    own = np.eye(len(z)) - of_planes[first:]
    cells = of_planes[equations.unknowns : first]
    covariance = own @ own.T / control.loosening**2 + cells.T @ cells + max(1.0, scan.scale) ** 2 * (noise.T @ noise)
    moves = np.array(
        [
            change_of_misclosures(
                equations, solution, control.displaced(one), None if one.camera is camera else one.camera
            )
            for one in (*deviations, *usual)
        ]
    ).reshape(-1, len(weight))
    felt = cho_solve(solution.factor, solution.design.T @ (weight[:, None] * moves.T), check_finite=False)[first:]
    felt, changed = np.split(felt, [len(deviations)], axis=1)
    expected = covariance + felt @ felt.T
    squares, freedom = _squares(z, expected, slice(None))
    free = _as_the_fan_has_them(z, of_planes[first:])
    off = tuple(
        replace(
            _off(scan, camera, control, number, free),
            times=_times(*_squares(z, expected, _block(number))),
            others_p=_others_p(z, expected, own[:, _block(number)]),
        )
        for number in range(len(control.planes))
    )
    return PlaneCheck(off, squares, freedom, _told(_whitening(expected).T @ changed))


def _whitening(covariance: Array) -> Array:
    """Directions (N, M) of what is known of N numbers, each divided by its standard deviation."""
    values, vectors = np.linalg.eigh(covariance)
    known = values > LEAST_SEEN
    return np.asarray(vectors[:, known] / np.sqrt(values[known]))


def _squares(z: Array, covariance: Array, part: slice) -> tuple[float, int]:
    """χ² of a part of z, and its degrees of freedom."""
    whitened = z[part] @ _whitening(covariance[part, part])
    return float(whitened @ whitened), len(whitened)


def _times(squares: float, freedom: int) -> float:
    return float(np.sqrt(squares / max(freedom, 1)))


def _by_chance(freedom: int, squares: float) -> float:
    """Probability that a χ² is as large by chance; 1 where nothing is compared."""
    return float(chdtrc(freedom, squares)) if freedom else 1.0


def _others_p(z: Array, covariance: Array, shifted: Array) -> float:
    """Probability by chance of what is left of z if one board may lie anywhere: then z is moved along `shifted`."""
    whitening = _whitening(covariance)
    whitened, moved = whitening.T @ z, whitening.T @ shifted
    moves, sizes, _ = np.linalg.svd(moved, full_matrices=False)
    moves = moves[:, sizes > LEAST_SEEN * sizes.max(initial=0.0)]
    left = whitened - moves @ (moves.T @ whitened)
    return _by_chance(len(left) - moves.shape[1], float(left @ left))


def _told(moved: Array) -> float:
    """Probability that changes are told which move M numbers of variance 1 by `moved` (M, K), one deviation each.

    What is compared is then a sum of squares of normal numbers of several variances (Ruben).
    """
    if not len(moved):
        return 0.0
    count, variances = len(moved), 1 + np.linalg.eigvalsh(moved @ moved.T)
    least = variances.min()
    powers = (1 - least / variances)[:, None] ** np.arange(1, _TERMS)
    parts = [float(np.prod(np.sqrt(least / variances)))]
    for k in range(1, _TERMS):
        parts.append(float(powers.sum(axis=0)[:k][::-1] @ parts) / (2 * k))
    freedoms = count + 2 * np.arange(_TERMS)
    return float(1 - np.array(parts) @ chdtr(freedoms, chdtri(count, DISAGREES) / least))


def _block(number: int) -> slice:
    return slice(FREEDOMS * number, FREEDOMS * number + FREEDOMS)


def _as_the_fan_has_them(z: Array, block: Array) -> Array:
    """Z without its prior: where the sweeps, tied to the fan alone, have the planes; what they do not know stays 0."""
    information = np.linalg.inv(block) - np.eye(len(z))
    return np.asarray(np.linalg.pinv(information, rcond=1e-6, hermitian=True) @ np.linalg.solve(block, z))


def _off(scan: ScanResult, camera: Camera, control: Control, number: int, z: Array) -> PlaneOff:
    """How far the fan is off a plane, by z without its prior."""
    plane, mine = control.planes[number], _block(number)
    rays = camera.rays(scan.crossings.uv[scan.crossing_lines == control.fan.lines + number])
    there = plane.pi + control.factors[number] @ z[mine]
    ray = rays.mean(axis=0) if len(rays) else np.array([0.0, 0.0, 1.0])
    normal, other = (pi / np.linalg.norm(pi) for pi in (plane.pi, there))
    mm = float((normal @ ray) * (1 / (there @ ray) - 1 / (plane.pi @ ray)))
    turn = float(np.arccos(np.clip(normal @ other, -1.0, 1.0)))
    return PlaneOff(plane.name, mm, turn, 0.0)
