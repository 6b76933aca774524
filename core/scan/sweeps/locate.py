"""Location of the sweeps: numbers of the fan's centrelines and light planes of the frames, from crossings alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from core.errors import InputError
from core.findings.table import note_of
from core.image.stripes.centreline import Centreline
from core.messages import Message
from core.model import Camera, Fan
from core.model.arrays import Array
from core.progress import Progress, silent, steps
from core.scan.features.crossings import CrossingTable
from core.scan.known_planes.known_plane import Control
from core.scan.network.adjustment import has_collapsed, solve_network, solve_planes
from core.scan.network.equations import Adjustment
from core.scan.network.fan_residuals import judge_network
from core.scan.network.geometry import CrossingRays, inverse_depth_gradient, noise_gains
from core.scan.network.line_errors import LineErrors
from core.scan.network.read_out import AT_ONCE, ReadOut
from core.scan.network.sweep_plane import solve_sweep_plane
from core.scan.sweeps.fan_lines import UNASSIGNED, FanLines, possible_fan_lines, settle_by_sweeps

NUMBERING_SWEEPS = 60
"""Sweeps by which the fan's lines are numbered: more say no more of that and cost time."""
LEAST_SIGMA_SHARE = 0.1
"""Of the median σ of a frame's crossings that each of them has at least: none outweighs all others."""


@dataclass(frozen=True, eq=False, slots=True)
class LocatedSweeps:
    """Located sweeps: their frames (S,), their light planes with covariance, and the weight (M,) of each crossing.

    `fan_cells` (F, 2), `fan_covariance` (3S, F), `line_cells` (Q, 3) and `line_covariance` (Q, 3) as of
    `core.scan.network.adjustment.Network`; F = Q = 0 where not known. `judged`: what is wrong with the residuals.
    `collapsed`: whether the planes have fallen together into one; `fan_silenced`: whether many crossings disagree with
    the fan; `off_fan`: whether the planes are off its light by the place in the picture.
    """

    frames: NDArray[np.int64]
    pis: Array
    covariance: Array
    weights: Array
    scale: float
    notes: tuple[Message, ...]
    fan_cells: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 2), dtype=np.int64))
    fan_covariance: Array = field(default_factory=lambda: np.zeros((0, 0)))
    line_cells: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 3), dtype=np.int64))
    line_covariance: Array = field(default_factory=lambda: np.zeros((0, 3)))
    judged: tuple[Message, ...] = ()
    collapsed: bool = False
    fan_silenced: bool = False
    off_fan: bool = False

    @property
    def middle_planes(self) -> tuple[Array, Array]:
        """Planes (S, 3) in 1/mm that sweeps have in the middle of the read-out, and their covariance (3S, 3S)."""
        if self.pis.shape[1] == 3:
            return self.pis, self.covariance
        middle = np.arange(self.pis.size).reshape(self.pis.shape)[:, :3].ravel()
        return self.pis[:, :3], self.covariance[np.ix_(middle, middle)]


@dataclass(frozen=True, eq=False, slots=True)
class SweepPlanes:
    """Light planes of sweeps without uncertainty: `frames` (S,), `pis` (S, 3) in 1/mm, each crossing's weight.

    `collapsed`: whether the planes have fallen together into one.
    """

    frames: NDArray[np.int64]
    pis: Array
    weights: Array
    collapsed: bool


def number_fan_lines(
    pieces: Sequence[Centreline],
    crossings: CrossingTable,
    camera: Camera,
    fan: Fan,
    progress: Progress = silent,
    printed: NDArray[np.bool_] | None = None,
) -> FanLines:
    """Find the line (from 0) of each of the fan's centrelines, in the numbering the sweeps agree with best.

    Those that are `printed` (C,) on boards are of none.
    """
    if printed is None or not printed.any():
        return choose_numbering(possible_fan_lines(pieces, camera, fan), crossings, camera, fan, progress)
    light = [piece for piece, is_print in zip(pieces, printed, strict=True) if not is_print]
    if not light:
        return FanLines.beside_print(FanLines((), (), ()), printed)
    piece = np.where(crossings.with_fan, crossings.piece_b, 0)
    crossings = replace(
        crossings, piece_b=np.where(crossings.with_fan, np.cumsum(~printed)[piece] - 1, crossings.piece_b)
    )
    of_light = number_fan_lines(light, crossings.select(~crossings.with_fan | ~printed[piece]), camera, fan, progress)
    return FanLines.beside_print(of_light, printed)


def choose_numbering(
    numberings: Sequence[FanLines], crossings: CrossingTable, camera: Camera, fan: Fan, progress: Progress = silent
) -> FanLines:
    """Choose the numbering of the fan's centrelines that the sweeps agree with best; they settle unsure ones.

    Of those that they agree with alike the one counts that puts most centrelines on common faces; a centreline on which
    even these differ is left out.
    """
    if len(numberings) == 1 and numberings[0].settled == len(numberings[0].line):
        return numberings[0]
    crossings = crossings.select(some_sweeps(crossings))
    one_crossing = 1 / max(int(np.count_nonzero(crossings.with_fan)), 1)
    judged: dict[tuple[int, ...], tuple[float, FanLines]] = {}
    best = np.inf
    for lines in sorted(numberings, key=lambda lines: _unnumbered(lines, crossings)):
        if _unnumbered(lines, crossings) > best + one_crossing:
            break
        settled = _settled(lines, crossings, camera, fan, progress)
        if settled.line not in judged:
            judged[settled.line] = _disagreement(settled, crossings, camera, fan, progress), settled
            best = min(best, judged[settled.line][0])
    alike = [lines for off, lines in judged.values() if off <= best + one_crossing]
    most = max(lines.on_faces for lines in alike)
    first, *others = sorted((lines for lines in alike if lines.on_faces == most), key=lambda lines: -lines.settled)
    return first.agreed(others)


def some_sweeps(crossings: CrossingTable) -> NDArray[np.bool_]:
    """Choose NUMBERING_SWEEPS sweeps spread over the scan: the mask (M,) of their crossings with the fan or each other.

    They tell of fan and camera what all do.
    """
    frames = np.unique(crossings.a[crossings.with_fan])
    if len(frames) <= NUMBERING_SWEEPS:
        return np.ones(len(crossings), dtype=np.bool_)
    some = frames[np.linspace(0, len(frames) - 1, NUMBERING_SWEEPS).round().astype(np.int64)]
    return np.isin(crossings.a, some) & (crossings.with_fan | np.isin(crossings.b, some))


def _settled(lines: FanLines, all_of_them: CrossingTable, camera: Camera, fan: Fan, progress: Progress) -> FanLines:
    """Decide unsure fan lines by sweeps that are solved without them."""
    unsure = [i for i, choices in enumerate(lines.choices) if len(choices) > 1]
    crossings, line = numbered(all_of_them, lines.sure)
    if not unsure or np.unique(line[crossings.with_fan]).size < 2:
        return lines
    sweeps = planes_together(crossings, line, camera, fan, progress)
    crossings, _ = numbered(all_of_them, lines)
    rows = crossings.select(
        crossings.with_fan & np.isin(crossings.a, sweeps.frames) & np.isin(crossings.piece_b, unsure)
    )
    rays = camera.rays(rows.uv)
    pis = sweeps.pis[np.searchsorted(sweeps.frames, rows.a)]
    return settle_by_sweeps(lines, rows.piece_b, rays, np.einsum("mi,mi->m", rays, pis), fan)


def _unnumbered(lines: FanLines, crossings: CrossingTable) -> float:
    """Share of the fan's crossings that have no number."""
    of_fan = crossings.piece_b[crossings.with_fan]
    return float(np.mean(np.array(lines.line)[of_fan] == UNASSIGNED)) if len(of_fan) else 0.0


def _disagreement(lines: FanLines, all_of_them: CrossingTable, camera: Camera, fan: Fan, progress: Progress) -> float:
    """Share of the fan's crossings that the network leaves out or that have no number.

    Planes that have fallen together agree with everything, and say nothing: they come after all others, at 1 more.
    """
    crossings, line = numbered(all_of_them, lines)
    fan_crossings = np.count_nonzero(all_of_them.with_fan)
    if not np.any(crossings.with_fan):
        return 1.0
    sweeps = planes_together(crossings, line, camera, fan, progress)
    agreeing = np.sum(sweeps.weights[crossings.with_fan])
    return sweeps.collapsed + 1.0 - float(agreeing) / max(int(fan_crossings), 1)


def numbered(crossings: CrossingTable, lines: FanLines) -> tuple[CrossingTable, NDArray[np.int64]]:
    """Drop crossings with an unnumbered line of the fan; also return the line of the others, −1 between sweeps."""
    numbers = np.array([*lines.line, UNASSIGNED], dtype=np.int64)
    line = np.where(crossings.with_fan, numbers[np.where(crossings.with_fan, crossings.piece_b, -1)], -1)
    keep = ~crossings.with_fan | (line != UNASSIGNED)
    return crossings.select(keep), line[keep]


def locate_together(
    crossings: CrossingTable,
    line: NDArray[np.int64],
    camera: Camera,
    fan: Fan | Control,
    progress: Progress = silent,
    read_out: ReadOut = AT_ONCE,
) -> LocatedSweeps:
    """Locate all sweeps in one adjustment; `line` (M,) is the fan line of each crossing, −1 between sweeps.

    Where a `read_out` says that rows see different planes, these follow the hand.

    Raises
    ------
    ValueError
        If there is no crossing with the fan.
    """
    frames = sweeping_frames(crossings)
    renumbered = by_sweep(crossings, frames)
    network = solve_network(renumbered, CrossingRays.of(crossings, camera), line, fan, len(frames), progress, read_out)
    notes: tuple[Message, ...] = ()
    if network.fan_silenced:
        notes = (note_of("scan.fan_disagrees"),)
    if network.collapsed:
        notes += (note_of("scan.collapsed"),)
    off_fan, judged = judge_network(network.scale, network.fan_off, camera.image_size)
    return LocatedSweeps(
        frames,
        network.pis,
        network.covariance,
        network.weights,
        network.scale,
        notes,
        network.fan_cells,
        network.fan_covariance,
        network.line_cells,
        network.line_covariance,
        judged,
        network.collapsed,
        network.fan_silenced,
        off_fan,
    )


def planes_together(
    crossings: CrossingTable,
    line: NDArray[np.int64],
    camera: Camera,
    fan: Fan | Control,
    progress: Progress = silent,
    read_out: ReadOut = AT_ONCE,
) -> SweepPlanes:
    """Locate all sweeps in one adjustment without their uncertainty, in half the usual time.

    As `locate_together`, which takes the same.

    Raises
    ------
    ValueError
        If there is no crossing with the fan.
    """
    frames = sweeping_frames(crossings)
    renumbered, geometry = by_sweep(crossings, frames), CrossingRays.of(crossings, camera)
    equations = Adjustment(renumbered, geometry, line, fan, len(frames), LineErrors.of(renumbered), read_out)
    solution, _ = solve_planes(equations, progress)
    return SweepPlanes(frames, solution.pis, solution.weights, has_collapsed(equations, solution.pis))


def sweeping_frames(crossings: CrossingTable) -> NDArray[np.int64]:
    """List in order the indices (S,) of the frames with a sweep that crosses anything."""
    return np.unique(np.concatenate([crossings.a, crossings.b[~crossings.with_fan]]))


def by_sweep(crossings: CrossingTable, frames: NDArray[np.int64]) -> CrossingTable:
    """Replace the frame indices of crossings by their places among the ascending `frames` (S,)."""
    return crossings.renumber(np.searchsorted(frames, np.arange(frames[-1] + 1)))


def locate_each(
    crossings: CrossingTable, line: NDArray[np.int64], camera: Camera, fan: Fan, progress: Progress = silent
) -> LocatedSweeps:
    """Locate every sweep on its own from its crossings with the fan, as Sun et al. 2023, §4, do.

    Raises
    ------
    InputError
        If no frame has three of them.
    """
    geometry = CrossingRays.of(crossings, camera)
    weights = np.zeros(len(crossings))
    frames, pis, covariances = [], [], []
    sweeping = np.unique(crossings.a)
    for frame in steps(sweeping, progress, "adjustment", len(sweeping)):
        rows = np.flatnonzero((crossings.a == frame) & crossings.with_fan)
        if len(rows) < 3:
            continue
        fan_pis = fan.pis_at(line[rows], geometry.rays[rows])
        inverse_depths = np.einsum("mi,mi->m", geometry.rays[rows], fan_pis)
        # The sweep's own plane is not known yet; half the fan's gradient stands for the difference of the two.
        gradient = inverse_depth_gradient(fan_pis, geometry.jacobians[rows])
        gain_a, gain_b = noise_gains(crossings.select(rows), gradient)
        sigmas = np.hypot(gain_a * crossings.sigma_a[rows], gain_b * crossings.sigma_b[rows])
        plane = solve_sweep_plane(
            geometry.rays[rows], inverse_depths, np.maximum(sigmas, LEAST_SIGMA_SHARE * np.median(sigmas))
        )
        frames.append(frame)
        pis.append(plane.pi)
        covariances.append(plane.covariance)
        weights[rows] = plane.used
    if not frames:
        raise InputError(
            Message("scan.no_frame_located", "no frame has three crossings with the fan"),
            where="scan",
            todo=Message(
                "scan.advice_cross_all_lines",
                "cross all of the fan's lines with each sweep, or use the network method",
            ),
        )
    return LocatedSweeps(np.array(frames), np.array(pis), block_diag(*covariances), weights, 1.0, ())
