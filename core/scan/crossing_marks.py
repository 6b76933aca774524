"""How the crossings of one frame are shown: good, weak or left out, and why."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array
from core.scan.crossings import CrossingTable
from core.scan.fan_lines import UNASSIGNED, FanLines
from core.scan.network import SILENCED
from core.scan.tracking import TrackedSweep

GOOD, WEAK, LEFT_OUT = 0, 1, 2

WEAK_ANGLE = float(np.deg2rad(30.0))
"""Lines that meet at a smaller angle cross badly: errors grow with 1/sin θ."""
WEAK_WEIGHT = 0.5
WEAK_SIGMA_PX = 0.4
"""A line known no better than this across itself is faint or torn."""
_SAME_PLACE_PX = 10.0

_NOT_CROSSED = {
    "angle too small": "Left out: the lines meet at too small an angle. Tilt the laser more.",
    "arm too short": "Left out: the light ends too near to this crossing.",
    "lines do not meet": "Left out: the lines bend too much here.",
}


@dataclass(frozen=True, eq=False, slots=True)
class CrossingMarks:
    """M crossings of one frame: `uv` (M, 2) in pixels, `status` (M,) GOOD, WEAK or LEFT_OUT, one sentence for each.

    `with_fan` (M,) is True for those with the fan, False for those with other sweeps.
    """

    uv: Array
    status: NDArray[np.int8]
    reason: tuple[str, ...]
    with_fan: NDArray[np.bool_]


def mark_crossings(sweep: TrackedSweep, lines: FanLines) -> CrossingMarks:
    """Marks for all crossings with the fan, and for those with other sweeps that the plane rests on."""
    table = sweep.crossings
    place_in_plane = {int(row): k for k, row in enumerate(sweep.used)}
    uv: list[Array] = []
    status: list[int] = []
    reason: list[str] = []
    with_fan: list[bool] = []
    for row in range(len(table)):
        of_fan = bool(table.with_fan[row])
        if not of_fan and (sweep.plane is None or row not in place_in_plane):
            continue
        how, why = _judged(sweep, row, place_in_plane.get(row), lines)
        uv.append(table.uv[row])
        status.append(how)
        reason.append(why)
        with_fan.append(of_fan)
    for place, why in sweep.left_out:
        if all(np.hypot(*(place - other)) > _SAME_PLACE_PX for other in uv):
            uv.append(place)
            status.append(LEFT_OUT)
            reason.append(_NOT_CROSSED[why])
            with_fan.append(True)
    return CrossingMarks(
        np.array(uv, dtype=np.float64).reshape(-1, 2),
        np.array(status, np.int8),
        tuple(reason),
        np.array(with_fan, bool),
    )


def _judged(sweep: TrackedSweep, row: int, k: int | None, lines: FanLines) -> tuple[int, str]:
    table = sweep.crossings
    other = "an earlier sweep"
    if table.with_fan[row]:
        line = lines.line[table.piece_b[row]]
        if line == UNASSIGNED:
            why = lines.reason[table.piece_b[row]] or "it is not clear which of the fan's lines this is"
            return LEFT_OUT, f"Left out: {why}."
        other = f"line {line + 1} of the fan"
    angle = _angle(table, row)
    crosses = f"crosses {other} at {np.rad2deg(angle):.0f}°"
    if sweep.plane is None or k is None:
        return WEAK, f"It {crosses}, but fewer than three crossings do not locate the sweep."
    weight, off = sweep.plane.weights[k], abs(sweep.plane.residuals[k])
    if weight < SILENCED:
        return LEFT_OUT, f"Left out: it {crosses}, but disagrees with the other crossings ({off:.0f} σ)."
    if weight < WEAK_WEIGHT:
        return WEAK, f"Weak: it {crosses}, but disagrees a little with the other crossings ({off:.1f} σ)."
    if angle < WEAK_ANGLE:
        return WEAK, f"Weak: it {crosses} only." + (" Tilt the laser more." if table.with_fan[row] else "")
    if max(table.sigma_a[row], table.sigma_b[row]) > WEAK_SIGMA_PX:
        return WEAK, f"Weak: it {crosses}, but the light is faint or uneven here."
    return GOOD, f"Good: it {crosses}."


def _angle(table: CrossingTable, row: int) -> float:
    a, b = table.tangent_a[row], table.tangent_b[row]
    return float(np.arctan2(abs(a[0] * b[1] - a[1] * b[0]), abs(a @ b)))
