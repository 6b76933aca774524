"""Features and model to surface points: number the fan's lines, solve the sweeps, triangulate, cut on σ.

No picture is needed here, so a scan can be solved again in a second with another camera, fan or method.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from core.errors import InputError
from core.model import Camera, Fan
from core.model.arrays import Array
from core.progress import Progress, silent
from core.scan.cloud import FAN, Cloud
from core.scan.crossings import CrossingTable
from core.scan.fan_lines import UNASSIGNED, FanLines, possible_fan_lines, settle_by_sweeps
from core.scan.features import ScanFeatures
from core.scan.geometry import CrossingRays, inverse_depth_gradient, noise_gains
from core.scan.network import SILENCED, FanStretches, solve_network
from core.scan.results import FrameRecord, ScanResult
from core.scan.sweep_plane import plane_condition, solve_sweep_plane
from core.scan.triangulate import join, triangulate

Method = Literal["network", "three-crossings"]


@dataclass(frozen=True, slots=True)
class ReconstructOptions:
    """How a scan is solved.

    `method`: "network" adjusts all sweeps together; "three-crossings" solves each frame from its own crossings with the
    fan, as the paper does. Points with a σ above `sigma_cut_mm` are left out.
    """

    method: Method = "network"
    sigma_cut_mm: float = 0.05


@dataclass(frozen=True, eq=False, slots=True)
class _Sweeps:
    """Solved planes: `frames` (S,) and, per crossing, the weight it had."""

    frames: NDArray[np.int64]
    pis: Array
    covariance: Array
    weights: Array
    scale: float
    notes: tuple[str, ...]


def reconstruct(
    features: ScanFeatures,
    camera: Camera,
    fan: Fan,
    options: ReconstructOptions | None = None,
    progress: Progress = silent,
    fan_lines: FanLines | None = None,
) -> ScanResult:
    """Solve the scan; `fan_lines` takes over the numbers an earlier solution has given to the fan's centrelines.

    Raises
    ------
    InputError
        If no sweep crosses the fan, or no point is left.
    """
    options = options or ReconstructOptions()
    progress("network", 0, 3)
    solve = _solve_network if options.method == "network" else _solve_each
    lines = fan_lines or _number_fan_lines(features, camera, fan)
    crossings, line = _numbered(features.crossings, lines)
    if not np.any(crossings.with_fan):
        raise InputError(
            "no sweep crosses the fan in any frame, so nothing says where the hand-held laser was",
            where="scan",
            todo="sweep the single line across the fan's lines, and check that the fan was on",
        )
    sweeps = solve(crossings, line, camera, fan)
    progress("network", 1, 3)
    clouds = _fan_clouds(features, lines, camera, fan) + _sweep_clouds(features, sweeps, camera)
    cloud = _cut(join(clouds), options.sigma_cut_mm)
    progress("network", 2, 3)
    if not np.any(cloud.sweep >= 0):
        raise InputError(
            f"no point of any sweep is known to {options.sigma_cut_mm} mm" + "".join(f" ({n})" for n in sweeps.notes),
            where="scan",
            todo="cross more of the fan with each sweep and tilt the laser between sweeps, check laser_fan.lines in "
            "rig.toml, or raise the σ cut",
        )
    records = _records(features, crossings, line, sweeps, cloud, camera)
    progress("network", 3, 3)
    return ScanResult(
        cloud=cloud,
        pis=sweeps.pis,
        covariance=sweeps.covariance,
        sweep_frames=sweeps.frames,
        frames=records,
        crossings=crossings,
        crossing_weights=sweeps.weights,
        fan_lines=lines,
        scale=sweeps.scale,
        notes=features.notes + sweeps.notes + _fan_notes(lines),
    )


def _number_fan_lines(features: ScanFeatures, camera: Camera, fan: Fan) -> FanLines:
    """The numbering of the fan's centrelines that the sweeps agree with best."""
    numberings = possible_fan_lines(features.fan, camera, fan)
    if len(numberings) == 1 and numberings[0].settled == len(features.fan):
        return numberings[0]
    settled = [_settled(lines, features, camera, fan) for lines in numberings]
    return min(settled, key=lambda lines: _disagreement(lines, features, camera, fan))


def _settled(lines: FanLines, features: ScanFeatures, camera: Camera, fan: Fan) -> FanLines:
    """Decide unsure fan lines by sweeps that are solved without them."""
    unsure = [i for i, choices in enumerate(lines.choices) if len(choices) > 1]
    crossings, line = _numbered(features.crossings, lines.sure)
    if not unsure or np.unique(line[crossings.with_fan]).size < 2:
        return lines
    sweeps = _solve_network(crossings, line, camera, fan)
    crossings, _ = _numbered(features.crossings, lines)
    rows = crossings.select(
        crossings.with_fan & np.isin(crossings.a, sweeps.frames) & np.isin(crossings.piece_b, unsure)
    )
    rays = camera.rays(rows.uv)
    pis = sweeps.pis[np.searchsorted(sweeps.frames, rows.a)]
    return settle_by_sweeps(lines, rows.piece_b, rays, np.einsum("mi,mi->m", rays, pis), fan)


def _disagreement(lines: FanLines, features: ScanFeatures, camera: Camera, fan: Fan) -> float:
    """Share of the fan's crossings that the network leaves out or that have no number."""
    crossings, line = _numbered(features.crossings, lines)
    fan_crossings = np.count_nonzero(features.crossings.with_fan)
    if not np.any(crossings.with_fan):
        return 1.0
    sweeps = _solve_network(crossings, line, camera, fan)
    agreeing = np.sum(sweeps.weights[crossings.with_fan])
    return 1.0 - float(agreeing) / max(int(fan_crossings), 1)


def _numbered(crossings: CrossingTable, lines: FanLines) -> tuple[CrossingTable, NDArray[np.int64]]:
    """Crossings whose fan stretch has a number, and that number (−1 for crossings between sweeps)."""
    numbers = np.array([*lines.line, UNASSIGNED], dtype=np.int64)
    line = np.where(crossings.with_fan, numbers[np.where(crossings.with_fan, crossings.piece_b, -1)], -1)
    keep = ~crossings.with_fan | (line != UNASSIGNED)
    return crossings.select(keep), line[keep]


def _solve_network(crossings: CrossingTable, line: NDArray[np.int64], camera: Camera, fan: Fan) -> _Sweeps:
    frames = np.unique(np.concatenate([crossings.a, crossings.b[~crossings.with_fan]]))
    renumbered = crossings.renumber(np.searchsorted(frames, np.arange(frames[-1] + 1)))
    network = solve_network(
        renumbered, CrossingRays.of(crossings, camera), _stretches(crossings, line), fan, len(frames)
    )
    notes: tuple[str, ...] = ()
    if network.fan_silenced:
        notes = (
            "Many crossings with the fan disagree with the sweeps; none was left out: check the fan's calibration, "
            "and that object and camera stood still.",
        )
    return _Sweeps(frames, network.pis, network.covariance, network.weights, network.scale, notes)


def _stretches(crossings: CrossingTable, line: NDArray[np.int64]) -> FanStretches:
    """Cut the fan's centrelines into stretches as long as the crossings' fit window."""
    with_fan = crossings.with_fan
    bins = np.floor(crossings.along_b / (2 * crossings.half_length_px)).astype(np.int64)
    keys = crossings.piece_b * 100_000 + bins
    stretch = np.full(len(crossings), -1, dtype=np.int64)
    stretch[with_fan] = np.unique(keys[with_fan], return_inverse=True)[1]
    return FanStretches(stretch, line)


def _solve_each(crossings: CrossingTable, line: NDArray[np.int64], camera: Camera, fan: Fan) -> _Sweeps:
    """Every frame on its own, from its crossings with the fan: the paper's §4."""
    geometry = CrossingRays.of(crossings, camera)
    weights = np.zeros(len(crossings))
    frames, pis, covariances = [], [], []
    for frame in np.unique(crossings.a):
        rows = np.flatnonzero((crossings.a == frame) & crossings.with_fan)
        if len(rows) < 3:
            continue
        fan_pis = fan.pis[line[rows]]
        inverse_depths = np.einsum("mi,mi->m", geometry.rays[rows], fan_pis)
        # The sweep's own plane is not known yet; half the fan's gradient stands for the difference of the two.
        gradient = inverse_depth_gradient(fan_pis, geometry.jacobians[rows])
        gain_a, gain_b = noise_gains(crossings.select(rows), gradient)
        sigmas = np.hypot(gain_a * crossings.sigma_a[rows], gain_b * crossings.sigma_b[rows])
        plane = solve_sweep_plane(geometry.rays[rows], inverse_depths, np.maximum(sigmas, 0.1 * np.median(sigmas)))
        frames.append(frame)
        pis.append(plane.pi)
        covariances.append(plane.covariance)
        weights[rows] = plane.used
    if not frames:
        raise InputError(
            "no frame has three crossings with the fan",
            where="scan",
            todo="cross all of the fan's lines with each sweep, or use the network method",
        )
    return _Sweeps(np.array(frames), np.array(pis), block_diag(*covariances), weights, 1.0, ())


def _fan_clouds(features: ScanFeatures, lines: FanLines, camera: Camera, fan: Fan) -> list[Cloud]:
    """The fan's own points: measured directly, on every line, at every height."""
    return [
        triangulate(piece, fan.planes[line].pi, np.zeros((3, 3)), camera, -1, FAN - line)
        for piece, line in zip(features.fan, lines.line, strict=True)
        if line != UNASSIGNED
    ]


def _sweep_clouds(features: ScanFeatures, sweeps: _Sweeps, camera: Camera) -> list[Cloud]:
    clouds: list[Cloud] = []
    for sweep, frame in enumerate(sweeps.frames):
        block = slice(3 * sweep, 3 * sweep + 3)
        clouds.extend(
            triangulate(piece, sweeps.pis[sweep], sweeps.covariance[block, block], camera, int(frame), sweep)
            for piece in features.frames[frame].centrelines
        )
    return clouds


def _cut(cloud: Cloud, sigma_cut_mm: float) -> Cloud:
    """Points known well enough, and not wildly away from where the fan sees the object (reflections)."""
    depth = cloud.points[:, 2]
    own = depth[cloud.sweep <= FAN]
    near, far = (0.6 * own.min(), 1.5 * own.max()) if len(own) else (0.0, np.inf)
    return cloud.select((cloud.sigma <= sigma_cut_mm) & (depth > near) & (depth < far))


def _records(
    features: ScanFeatures,
    crossings: CrossingTable,
    line: NDArray[np.int64],
    sweeps: _Sweeps,
    cloud: Cloud,
    camera: Camera,
) -> tuple[FrameRecord, ...]:
    rays = camera.rays(crossings.uv)
    solved = set(sweeps.frames.tolist())
    count: Callable[[NDArray[np.bool_]], int] = np.count_nonzero
    records = []
    for frame in features.frames:
        mine = (crossings.a == frame.index) | (crossings.b == frame.index)
        with_fan = mine & crossings.with_fan
        points = cloud.frame == frame.index
        number = count(points)
        records.append(
            FrameRecord(
                index=frame.index,
                name=frame.name,
                used=number > 0,
                reason="" if number else frame.reason or _why_no_points(count(mine), frame.index in solved),
                stripes=len(frame.centrelines),
                stripe_px=sum(len(piece) for piece in frame.centrelines),
                fan_crossings=count(with_fan),
                fan_lines_met=len(np.unique(line[with_fan])),
                sweep_crossings=count(mine & ~crossings.with_fan),
                left_out=count(mine & (sweeps.weights < SILENCED)),
                condition=plane_condition(rays[with_fan]),
                points=number,
                sigma_mm=float(np.median(cloud.sigma[points])) if number else float("nan"),
            )
        )
    return tuple(records)


def _why_no_points(crossings: int, solved: bool) -> str:
    if not crossings:
        return "its stripe crosses neither the fan nor another sweep"
    if not solved:
        return "fewer than three crossings with the fan"
    return "its light plane is too uncertain for any point to pass the σ cut"


def _fan_notes(lines: FanLines) -> tuple[str, ...]:
    left_out = [reason for reason in lines.reason if reason]
    if not left_out:
        return ()
    many = "1 stretch" if len(left_out) == 1 else f"{len(left_out)} stretches"
    return (f"Not used of the fan's light: {many} ({left_out[0]}).",)
