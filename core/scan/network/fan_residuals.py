"""What the network leaves over, judged: are crossings as scattered as stated, and do sweeps and fan agree everywhere?

Two things can be judged. The *scale*: how many times as large as stated all residuals are together. And the errors that
the network finds in the fan's cells: stretches of 40 px of its stripes with one error of unit variance each, which only
the sweeps tell of. By their prior and by what the sweeps know their covariance is 1 − (AᵀWA + 1)⁻¹, all that is shared
included, so a pattern of them over the picture is held against that. Speckle has none; a fan that is turned or bent, a
lens that is not as calibrated, a part that moved after the reference have.

Not judged are runs of the residuals of single sweeps, nor patterns by turning their signs: all sweeps are seen as
differences from one reference picture and share its noise, place by place, so that every scan would be accused. Nor are
crossings between sweeps judged by place: which of two comes first is arbitrary, and so is the sign of their residual.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.calibrate.camera.coverage import REGIONS
from core.findings.table import note_of
from core.messages import Message
from core.model.arrays import Array
from core.model.residuals import Judgement, Residuals, judge_with_covariance, over_picture
from core.scan.network.equations import Adjustment, Solution

# Held by tests/scan/network/test_fan_residuals.py; on 18 ideal rendered scans scales are 0.8 to 1.0, p 0.14 to 0.98.
TIMES = 1.5
"""Scale from which on it is told."""
SURELY = 1e-3
"""Probability below which a pattern is no chance."""
GRID = (3, 3)
"""Columns and rows in which cells are compared: the parts of a picture that have names."""
_NEARER, _FARTHER = Message("scan.nearer", "nearer to the camera"), Message("scan.farther", "farther from the camera")


@dataclass(frozen=True, eq=False, slots=True)
class CellErrors:
    """Errors of the fan's F cells, short pieces of its centrelines, as the sweeps see them.

    Parameters
    ----------
    z, covariance
        (F,) in their standard deviations as stated, and (F, F) of them if all is as stated.
    uv
        (F, 2) where each is, in pixels.
    depth_mm
        (F,) how much nearer the fan's light is than the sweeps there for z = 1; 0 where nothing crosses.
    line
        (F,) which of the fan's centrelines it is on.
    """

    z: Array
    covariance: Array
    uv: Array
    depth_mm: Array
    line: NDArray[np.int64]

    @classmethod
    def of(cls, equations: Adjustment, solution: Solution) -> CellErrors:
        """Take from the adjustment's `solution` the errors of those of the fan's cells that sweeps cross."""
        table, first = equations.crossings, equations.unknowns
        share = equations.errors.fan.tocoo()
        row, cell, part = share.coords[0], share.coords[1], share.data
        size = np.bincount(cell, np.abs(part), minlength=share.shape[1])
        crossed = np.flatnonzero(size > 0)
        weight = np.abs(part) / np.maximum(size[cell], 1e-300)

        def mean(values: Array) -> Array:
            sums = np.zeros((len(size), values.shape[1]))
            np.add.at(sums, cell, weight[:, None] * values)
            return sums

        rays = equations.geometry.rays[row]
        inverse = np.einsum("ni,ni->n", equations.read_out.planes(solution.pis[table.a[row]], table.uv[row, 1]), rays)
        depth = part * solution.gains[row, 1] / np.maximum(inverse, 1e-12) ** 2
        last = equations.before_planes
        covariance = np.eye(share.shape[1]) - solution.inverse[first:last, first:last]
        return cls(
            solution.cells[: share.shape[1]][crossed],
            covariance[np.ix_(crossed, crossed)],
            mean(table.uv[row])[crossed],
            mean(depth[:, None])[crossed, 0],
            equations.errors.fan_cells[crossed, 0],
        )


def judge_fan_cells(cells: CellErrors, image_size: tuple[int, int], scale: float = 1.0) -> Judgement:
    """Judge over the picture how far in mm the sweeps lie off the fan's light in depth; positive is farther away.

    Where all residuals are `scale` times as large as stated, these may be as well.
    """
    millimetres = cells.z * cells.depth_mm
    covariance = max(1.0, scale) ** 2 * cells.covariance * np.outer(cells.depth_mm, cells.depth_mm)
    place = over_picture(cells.uv, image_size, GRID)
    expected = np.sqrt(np.maximum(covariance.diagonal(), 0.0))  # one that nothing foretells is 0 but for rounding
    return judge_with_covariance(
        Residuals(millimetres, expected, cells.line.astype(np.intp), place, GRID[0] * GRID[1]), covariance
    )


def judge_network(scale: float, cells: CellErrors, image_size: tuple[int, int]) -> tuple[bool, tuple[Message, ...]]:
    """Judge whether sweeps lie off the fan's light somewhere in the picture; return that and notes on what is wrong.

    Where they do not, a note tells of a misfit that is too large: `scale` is the standard deviation of unit weight.
    """
    if len(cells.z) and (found := judge_fan_cells(cells, image_size, scale)).p < SURELY:
        place = found.strongest
        note = note_of(
            "scan.fan_off_in_region",
            place=REGIONS[place],
            mm=abs(float(found.profile[place])),
            where=_FARTHER if found.profile[place] > 0 else _NEARER,
        )
        return True, (note,)
    return False, (note_of("scan.crossings_scatter", times=scale),) if scale > TIMES else ()
