"""Marks of the crossings of one frame: good, weak or left out, and why."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.messages import Message
from core.model.arrays import Array
from core.scan.features.crossings import CrossingTable
from core.scan.network.adjustment import SILENCED
from core.scan.preview.shown import CrossingStatus
from core.scan.sweeps.fan_lines import UNASSIGNED, FanLines
from core.scan.sweeps.tracking import TrackedSweep

# What is marked as weak: it is used all the same. Chosen by judgement; tests/scan/preview/test_frames.py shows them.
WEAK_ANGLE = float(np.deg2rad(30.0))
"""rad: lines that meet at a smaller angle cross badly, for errors grow with 1/sin θ, twofold here."""
WEAK_WEIGHT = 0.5
"""Robust weight below which a crossing disagrees a little."""
WEAK_SIGMA_PX = 0.4
"""Standard uncertainty in px above which a line is faint or torn."""
_SAME_PLACE_PX = 10.0
"""Px to a crossing that is shown already within which another one is not: about the size of a mark."""

_NOT_CROSSED: Mapping[str, Message] = {
    "angle too small": Message(
        "scan.crossing_flat", "Left out: the lines meet at too small an angle. Tilt the laser more."
    ),
    "arm too short": Message("scan.crossing_at_end", "Left out: the light ends too near to this crossing."),
    "do not meet": Message("scan.crossing_bent", "Left out: the lines bend too much here."),
}
"""By `core.image.crossings.crossing.CrossingSearch.left_out`."""


@dataclass(frozen=True, eq=False, slots=True)
class CrossingMarks:
    """Marks of the M crossings of one frame: places `uv` (M, 2) in px, `status` (M,) `CrossingStatus`, and why.

    `with_fan` (M,) is True for those with the fan, False for those with other sweeps.
    """

    uv: Array
    status: NDArray[np.int8]
    reason: tuple[Message, ...]
    with_fan: NDArray[np.bool_]


def mark_crossings(sweep: TrackedSweep, lines: FanLines, boards: Sequence[str] = ()) -> CrossingMarks:
    """Make marks of a sweep's crossings with the fan, of those with other sweeps it rests on, and of those left out.

    Without a fan its points on known planes, the `boards` by name, stand in place of those with it.
    """
    table = sweep.crossings
    place_in_plane = {int(row): k for k, row in enumerate(sweep.used)}
    uv: list[Array] = []
    status: list[CrossingStatus] = []
    reason: list[Message] = []
    with_fan: list[bool] = []
    for row in range(len(table)):
        of_fan = bool(table.with_fan[row])
        if not of_fan and (sweep.plane is None or row not in place_in_plane):
            continue
        how, why = _judged(sweep, row, place_in_plane.get(row), lines, boards)
        uv.append(table.uv[row])
        status.append(how)
        reason.append(why)
        with_fan.append(of_fan)
    for place, what in sweep.left_out:
        if all(np.hypot(*(place - other)) > _SAME_PLACE_PX for other in uv):
            uv.append(place)
            status.append(CrossingStatus.LEFT_OUT)
            reason.append(_NOT_CROSSED[what])
            with_fan.append(True)
    return CrossingMarks(
        np.array(uv, dtype=np.float64).reshape(-1, 2),
        np.array(status, np.int8),
        tuple(reason),
        np.array(with_fan, bool),
    )


def _judged(
    sweep: TrackedSweep, row: int, k: int | None, lines: FanLines, boards: Sequence[str]
) -> tuple[CrossingStatus, Message]:
    """Judge the crossing in `row`, with the reason; `k` is its place among those the plane rests on."""
    table = sweep.crossings
    good, weak, left_out = CrossingStatus
    other = Message("scan.earlier_sweep", "an earlier sweep")
    if table.with_fan[row] and not table.on_plane[row]:
        line = lines.line[table.piece_b[row]]
        if line == UNASSIGNED:
            unclear = Message("scan.fan_light_unclear", "it is not clear which of the fan's lines this is")
            why = lines.reason[table.piece_b[row]] or unclear
            return left_out, Message("scan.crossing_left_out", "Left out: {why}.", why=why)
        other = Message("scan.fan_line", "line {number} of the fan", number=line + 1)
    angle = _angle(table, row)
    crosses = Message(
        "scan.crosses", "crosses {other} at {angle_deg:.0f}°", other=other, angle_deg=float(np.rad2deg(angle))
    )
    if table.on_plane[row]:
        crosses = Message("scan.lies_on_board", "lies on the board {board}", board=boards[-1 - table.piece_b[row]])
    if sweep.plane is None or k is None:
        return weak, Message(
            "scan.crossing_of_unlocated",
            "It {crosses}, but fewer than three crossings do not locate the sweep.",
            crosses=crosses,
        )
    weight, off = sweep.plane.weights[k], abs(sweep.plane.residuals[k])
    if weight < SILENCED:
        return left_out, Message(
            "scan.crossing_disagrees",
            "Left out: it {crosses}, but disagrees with the other crossings ({off:.0f} σ).",
            crosses=crosses,
            off=off,
        )
    if weight < WEAK_WEIGHT:
        return weak, Message(
            "scan.crossing_disagrees_a_little",
            "Weak: it {crosses}, but disagrees a little with the other crossings ({off:.1f} σ).",
            crosses=crosses,
            off=off,
        )
    if angle < WEAK_ANGLE and table.with_fan[row]:
        return weak, Message(
            "scan.crossing_weak_angle_fan", "Weak: it {crosses} only. Tilt the laser more.", crosses=crosses
        )
    if angle < WEAK_ANGLE:
        return weak, Message("scan.crossing_weak_angle", "Weak: it {crosses} only.", crosses=crosses)
    if max(table.sigma_a[row], table.sigma_b[row]) > WEAK_SIGMA_PX:
        return weak, Message(
            "scan.crossing_faint", "Weak: it {crosses}, but the light is faint or uneven here.", crosses=crosses
        )
    return good, Message("scan.crossing_good", "Good: it {crosses}.", crosses=crosses)


def _angle(table: CrossingTable, row: int) -> float:
    a, b = table.tangent_a[row], table.tangent_b[row]
    return float(np.arctan2(abs(a[0] * b[1] - a[1] * b[0]), abs(a @ b)))
