"""The sweeps' points on known planes beside the crossings of a scan: which of them are firm, and how they agree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from core.model import Camera
from core.model.arrays import Array
from core.model.robust import Schedule, Weigh, irls, mad_sd
from core.scan.features.crossings import CrossingTable, Index
from core.scan.features.extraction import ScanFeatures
from core.scan.features.frames import CrossingUse
from core.scan.known_planes.known_plane import Control, KnownPlane
from core.scan.known_planes.points_on_planes import PlaneAgreement, points_on_planes
from core.scan.network.adjustment import HUBER_AT, REJECT_AT, SILENCED
from core.scan.network.datum import main_plane
from core.scan.network.equations import Solution
from core.scan.results import ScanResult
from core.scan.scan_evidence import settled_equations
from core.scan.sweeps.ghosts import held_from_turning

_WEIGHTS = Schedule(8, 4, HUBER_AT, REJECT_AT)
"""Of reweighting the points on planes, the sweeps' own crossings staying as they are."""


@dataclass(frozen=True, eq=False, slots=True)
class PlanePoints:
    """Points of the sweeps on the known planes that they meet.

    Parameters
    ----------
    rows, plane
        P rows of a table of crossings, and the number (P,) of each one's plane.
    planes
        The known planes on which there are such points.
    seen
        How many points there are, those of sheets included that are free to turn about the line in which they meet the
        planes.
    """

    rows: CrossingTable
    plane: Index
    planes: tuple[KnownPlane, ...]
    seen: int

    def added_to(self, crossings: CrossingTable, line: Index, lines: int) -> tuple[CrossingTable, Index]:
        """Add the points to `crossings` and their fan's line (M,); planes are numbered after the fan's `lines`."""
        return crossings.followed_by(self.rows), np.concatenate([line, lines + self.plane])


def firm_points(
    features: ScanFeatures, planes: Sequence[KnownPlane], crossings: CrossingTable, camera: Camera
) -> PlanePoints:
    """Collect the points on known planes of the sweeps that these and `crossings` keep from turning."""
    rows, plane = points_on_planes(features, planes, camera)
    firm = held_from_turning(crossings.followed_by(rows), camera)[len(crossings) :]
    used, number = np.unique(plane[firm], return_inverse=True)
    return PlanePoints(rows.select(firm), number, tuple(planes[k] for k in used), len(rows))


def agreements(scan: ScanResult, camera: Camera, control: Control) -> tuple[PlaneAgreement, ...]:
    """Compute how the sweeps' points on each known plane of a scan agree with it."""
    crossings, fits = scan.crossings, []
    located = crossings.on_plane & np.isin(crossings.a, scan.sweep_frames)
    for number, plane in enumerate(control.planes):
        mine = np.flatnonzero(located & (scan.crossing_lines == control.fan.lines + number))
        used = mine[scan.crossing_weights[mine] > SILENCED]
        uv = crossings.uv[used]
        rays, sweep = camera.rays(uv), np.searchsorted(scan.sweep_frames, crossings.a[used])
        inverse = np.einsum("mi,mi->m", rays, scan.read_out.planes(scan.pis[sweep], uv[:, 1]))
        off_mm = 1 / inverse - 1 / (rays @ plane.pi)
        rms_mm = float(np.sqrt(np.mean(off_mm**2))) if len(used) else 0.0
        left_out = len(mine) - len(used)
        fits.append(
            PlaneAgreement(plane.name, len(used), len(np.unique(sweep)), left_out, rms_mm, plane.pi, plane.outline)
        )
    return tuple(fits)


def with_plane_points(
    scan: ScanResult, features: ScanFeatures, camera: Camera, control: Control
) -> tuple[ScanResult, Control]:
    """Add to a scan that was solved by the fan its sweeps' points on known planes, and select the planes they meet.

    The sweeps stay where the fan has them; a point that agrees with the others on its plane, wherever that is, counts.
    """
    points = firm_points(features, control.planes, scan.crossings, camera)
    met = replace(control, planes=points.planes)
    crossings, line = points.added_to(scan.crossings, scan.crossing_lines, control.fan.lines)
    added = len(points.rows)
    found = replace(
        scan,
        crossings=crossings,
        crossing_lines=line,
        crossing_weights=np.append(scan.crossing_weights, _on_one_plane_each(scan, points, camera)),
        crossing_reasons=np.append(scan.crossing_reasons, np.full(added, CrossingUse.COUNTS)),
    )
    if added:
        weights = found.crossing_weights.copy()
        weights[found.of_solved] = _weights(found, camera, met)
        found = replace(found, crossing_weights=weights)
    return replace(found, planes=agreements(found, camera, met)), met


def _on_one_plane_each(scan: ScanResult, points: PlanePoints, camera: Camera) -> Array:
    """Flag (P,) with 1 those points on each plane that, as the fan has their sweeps, lie on one plane, wherever."""
    solved = np.isin(points.rows.a, scan.sweep_frames)
    rays = camera.rays(points.rows.uv)
    sweep = np.searchsorted(scan.sweep_frames, np.where(solved, points.rows.a, scan.sweep_frames[0]))
    inverse = np.einsum("mi,mi->m", rays, scan.read_out.planes(scan.pis[sweep], points.rows.uv[:, 1]))
    flags = np.zeros(len(rays))
    for number in range(len(points.planes)):
        mine = np.flatnonzero(solved & (points.plane == number) & (inverse > 0))
        if len(mine):
            flags[mine] = main_plane(rays[mine], inverse[mine])[1]
    return flags


def _weights(scan: ScanResult, camera: Camera, control: Control) -> Array:
    """Robust weights (M,) of the crossings of solved sweeps, in which only those of points on planes are new."""
    equations, start = settled_equations(scan, camera, control)
    fixed, on_plane = start.weights, equations.crossings.on_plane

    def improve(found: Solution, weigh: Weigh) -> Solution:
        size = np.abs(found.residuals)
        own = weigh(size / max(1.0, mad_sd(found.residuals[on_plane])))
        return equations.improve(found, np.where(on_plane, own, fixed))

    return irls(start, improve, _WEIGHTS).weights if on_plane.any() else fixed
