"""Features and model to surface points: number the fan's lines, solve the sweeps, triangulate, cut on σ.

No picture is needed here, so a scan can be solved again in a second with another camera, fan or method.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.model import Camera, Fan
from core.model.arrays import Array
from core.progress import Progress, Told, silent
from core.scan.cloud import FAN, Cloud
from core.scan.crossings import CrossingTable
from core.scan.datum import Datum, datum_of
from core.scan.fan_lines import UNASSIGNED, FanLines
from core.scan.fan_speckle import FanSpeckle, fan_speckle
from core.scan.features import ScanFeatures
from core.scan.left_out import reasons_of
from core.scan.locate import LocatedSweeps, by_sweep, locate_each, locate_together, number_fan_lines, numbered
from core.scan.method import Method
from core.scan.records import frame_records
from core.scan.results import ScanResult
from core.scan.still_part import still_part
from core.scan.triangulate import OwnLine, join, triangulate


@dataclass(frozen=True, slots=True)
class ReconstructOptions:
    """How a scan is solved.

    `method`: "network" adjusts all sweeps together; "three-crossings" solves each frame from its own crossings with the
    fan, as the paper does. Points with a σ above `sigma_cut_mm` are left out.
    """

    method: Method = "network"
    sigma_cut_mm: float = 0.05


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
    progress = told = Told(progress)
    progress("network", 0, 3)
    lines = fan_lines or number_fan_lines(features.fan, features.crossings, camera, fan, told.again)
    crossings, line = numbered(features.crossings, lines)
    if not np.any(crossings.with_fan):
        raise InputError(
            "no sweep crosses the fan in any frame, so nothing says where the hand-held laser was",
            where="scan",
            todo="sweep the single line across the fan's lines, and check that the fan was on",
        )
    solved = _solve(options.method, crossings, line, camera, fan, [frame.name for frame in features.frames], told.again)
    sweeps = solved.sweeps
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
    records = frame_records(features, crossings, line, solved.reasons, sweeps.frames, cloud, camera)
    progress("network", 3, 3)
    return ScanResult(
        cloud=cloud,
        pis=sweeps.pis,
        covariance=sweeps.covariance,
        sweep_frames=sweeps.frames,
        frames=records,
        crossings=crossings,
        crossing_weights=solved.weights,
        fan_lines=lines,
        scale=sweeps.scale,
        notes=features.notes + solved.notes + _fan_notes(lines),
        datum=solved.datum,
        speckle=_speckle(features, lines, sweeps, camera, fan) if options.method == "network" else None,
        crossing_reasons=solved.reasons,
    )


@dataclass(frozen=True, eq=False, slots=True)
class _Solved:
    """Solved sweeps; weight and reason (M,) of every crossing, those of other frames included."""

    sweeps: LocatedSweeps
    weights: Array
    reasons: NDArray[np.int64]
    notes: tuple[str, ...]
    datum: Datum | None = None


def _solve(
    method: Method,
    crossings: CrossingTable,
    line: NDArray[np.int64],
    camera: Camera,
    fan: Fan,
    names: Sequence[str],
    progress: Progress,
) -> _Solved:
    if method != "network":
        sweeps = locate_each(crossings, line, camera, fan, progress)
        everywhere = np.ones(len(crossings), dtype=np.bool_)
        located = np.isin(crossings.a, sweeps.frames) & crossings.with_fan
        reasons = reasons_of(crossings.with_fan, sweeps.weights, everywhere, located)
        return _Solved(sweeps, sweeps.weights, reasons, sweeps.notes)
    part = still_part(crossings, line, camera, fan, names, progress)
    kept = part.kept
    among = crossings.select(kept)
    sweeps = locate_together(among, line[kept], camera, fan, progress)
    weights = np.zeros(len(crossings))
    weights[kept] = sweeps.weights
    datum = datum_of(sweeps.pis, sweeps.covariance, by_sweep(among, sweeps.frames), camera)
    return _Solved(
        sweeps,
        weights,
        reasons_of(crossings.with_fan, weights, kept, np.ones(len(crossings), dtype=np.bool_)),
        part.note(names, len(sweeps.frames)) + sweeps.notes + (datum.sentence,),
        datum,
    )


def _fan_clouds(features: ScanFeatures, lines: FanLines, camera: Camera, fan: Fan) -> list[Cloud]:
    """The fan's own points: measured directly, on every line, at every height."""
    return [
        triangulate(piece, fan.planes[line].pi, np.zeros((3, 3)), camera, -1, FAN - line)
        for piece, line in zip(features.fan, lines.line, strict=True)
        if line != UNASSIGNED
    ]


def _speckle(features: ScanFeatures, lines: FanLines, sweeps: LocatedSweeps, camera: Camera, fan: Fan) -> FanSpeckle:
    """What the fan's own points have in common with the sweeps."""
    planes = [None if line == UNASSIGNED else fan.planes[line] for line in lines.line]
    cell_px = features.crossings.half_length_px
    return fan_speckle(features.fan, planes, camera, cell_px, sweeps.fan_cells, sweeps.fan_covariance)


def _sweep_clouds(features: ScanFeatures, sweeps: LocatedSweeps, camera: Camera) -> list[Cloud]:
    clouds: list[Cloud] = []
    cell_px = features.crossings.half_length_px
    for sweep, frame in enumerate(sweeps.frames):
        block = slice(3 * sweep, 3 * sweep + 3)
        mine = sweeps.line_cells[:, 0] == sweep
        cells, covariance = sweeps.line_cells[mine, 1:], sweeps.line_covariance[mine]
        for number, piece in enumerate(features.frames[frame].centrelines):
            own = OwnLine(_by_cell(cells[:, 0] == number, cells[:, 1], covariance), cell_px)
            clouds.append(
                triangulate(piece, sweeps.pis[sweep], sweeps.covariance[block, block], camera, int(frame), sweep, own)
            )
    return clouds


def _by_cell(mine: NDArray[np.bool_], cell: NDArray[np.int64], covariance: Array) -> Array:
    """Rows of `covariance` (Q, 3) that are `mine` (Q,) in the order of their cells from 0, zero where there is none."""
    ordered = np.zeros((int(cell[mine].max(initial=-1)) + 1, 3))
    known = mine & (cell >= 0)
    ordered[cell[known]] = covariance[known]
    return ordered


def _cut(cloud: Cloud, sigma_cut_mm: float) -> Cloud:
    """Points known well enough, and not wildly away from where the fan sees the object (reflections)."""
    depth = cloud.points[:, 2]
    own = depth[cloud.sweep <= FAN]
    near, far = (0.6 * own.min(), 1.5 * own.max()) if len(own) else (0.0, np.inf)
    return cloud.select((cloud.sigma <= sigma_cut_mm) & (depth > near) & (depth < far))


def _fan_notes(lines: FanLines) -> tuple[str, ...]:
    left_out = [reason for reason in lines.reason if reason]
    if not left_out:
        return ()
    many = "1 stretch" if len(left_out) == 1 else f"{len(left_out)} stretches"
    return (f"Not used of the fan's light: {many} ({left_out[0]}).",)
