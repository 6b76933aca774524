"""Sweeps of a hand that moves while the camera reads its rows out: located, and told.

With a stated read-out every sweep gets the terms of `core.scan.network.read_out`. How fast and how steady the hand is
says the scan itself: by their marginal likelihood, in which the sweeps' own planes and motions are integrated out, of
the crossings r with covariance H⁻¹ of the unknowns and P the weight of their priors::

    −2 ln L = misfit + ln det H − ln det P + const.

The variances of the terms are those of the hands in HANDS, each as likely as that says: a scan that tells little of its
hand keeps what hands do. Without a stated read-out the terms are tried only where planes that stand still leave
crossings unexplained, and kept only where a moving hand is surely more likely.

References
----------
Patterson, H. D., Thompson, R., Recovery of inter-block information when block sizes are unequal, Biometrika 58 (1971),
doi:10.1093/biomet/58.3.545.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.findings.table import note_of
from core.messages import Field, Message
from core.model import Camera, Fan
from core.model.robust import huber_weights
from core.progress import Progress, silent
from core.scan.features.crossings import CrossingTable, Index
from core.scan.known_planes.known_plane import Control
from core.scan.network.adjustment import HUBER_AT
from core.scan.network.equations import Adjustment, Solution
from core.scan.network.geometry import CrossingRays
from core.scan.network.line_errors import LineErrors
from core.scan.network.read_out import FASTEST, SLOWEST_READOUT_MS, Hand, ReadOut, change_per_mm
from core.scan.sweeps.locate import LocatedSweeps, by_sweep, locate_together

# When terms are tried and kept. Held by tests/scan/sweeps/test_moving.py.
UNEXPLAINED = 1.5
"""Standard deviation of unit weight above which a scan asks for them; scans of a global shutter have 0.9 to 1.2."""
SURELY = 20.0
"""Difference of −2 ln L from which on a hand that moves is surely more likely than one that rests: odds of 20,000."""
HANDS = tuple(Hand(speed, tremor) for speed in (40.0, 80.0) for tremor in (0.02, 0.1, 0.2, 0.4))
"""Hands that are tried, all as likely. None rests: crossings hardly tell a steady hand from one at rest, because sheets
that are twisted alike cross nearly where flat ones do."""


def read_out_of(
    crossings: CrossingTable,
    line: Index,
    camera: Camera,
    fan: Fan | Control,
    row_time_us: float | None,
    progress: Progress = silent,
) -> ReadOut:
    """Find how sweeps' planes change from row to row of a picture; `line` (M,) is the fan's line, −1 between sweeps.

    `row_time_us` is 0 for a global shutter, None where nothing is stated: then the crossings are asked.
    """
    rows = camera.image_size[1]
    time_ms = SLOWEST_READOUT_MS if row_time_us is None else rows * row_time_us / 1000
    widest = ReadOut.of(rows, time_ms, FASTEST)
    if not widest.shifts_mm:
        return ReadOut(rows)
    sweeps = locate_together(crossings, line, camera, fan, progress)
    if row_time_us is None and sweeps.scale <= UNEXPLAINED:
        return ReadOut(rows)
    table = by_sweep(crossings, sweeps.frames)
    geometry = CrossingRays.of(table, camera)
    inverse_depths = np.einsum("mi,mi->m", geometry.rays, sweeps.pis[table.a])
    widest = replace(widest, per_mm=change_per_mm(sweeps.pis, inverse_depths, geometry.rays))
    equations = Adjustment(table, geometry, line, fan, len(sweeps.frames), LineErrors.of(table), widest)
    still = np.pad(sweeps.pis, ((0, 0), (0, widest.size - 3)))
    base = equations.improve(replace(equations.start(), pis=still), np.ones(len(table)))
    base = replace(base, pis=still, weights=huber_weights(base.residuals, HUBER_AT))
    unlikely = np.array([_minus_2_ln_l(replace(equations, read_out=widest.by(hand)), base) for hand in HANDS])
    if row_time_us is None:
        at_rest = _minus_2_ln_l(replace(equations, read_out=widest.by(Hand(0.0, 0.0))), base)
        if at_rest - unlikely.min() < SURELY:
            return ReadOut(rows)
    share = np.exp(-0.5 * (unlikely - unlikely.min()))
    tried = [widest.by(hand) for hand in HANDS]
    sizes = np.sqrt(share @ np.array([(one.steady_mm, *one.shifts_mm) for one in tried]) ** 2 / share.sum())
    return replace(widest, steady_mm=float(sizes[0]), shifts_mm=tuple(sizes[1:].tolist()))


def _minus_2_ln_l(equations: Adjustment, base: Solution) -> float:
    """−2 ln L of a hand, less a constant, with the crossings' σ and weights of `base`."""
    solution = equations.improve(base, base.weights)
    of_prior = equations.read_out.log_det_weight(equations.sweeps)
    return solution.misfit + 2 * float(np.sum(np.log(solution.factor[0].diagonal()))) - of_prior


def hand_notes(
    sweeps: LocatedSweeps, crossings: CrossingTable, camera: Camera, read_out: ReadOut, *, stated: bool
) -> tuple[Message, ...]:
    """Make a note on how the hand moved during the read-out of a picture; () where all rows see the same plane.

    `stated` is whether the time from row to row is.
    """
    if not read_out.moves:
        return ()
    twist = _twist(sweeps, crossings, camera, read_out)
    if not stated:
        return (note_of("scan.rows_roll", twist_mm=twist, field=Field("camera.row_time_us", whole=True)),)
    return (
        note_of("scan.hand_moved", speed=1000 * twist / read_out.time_ms, time_ms=read_out.time_ms, twist_mm=twist),
    )


def _twist(sweeps: LocatedSweeps, crossings: CrossingTable, camera: Camera, read_out: ReadOut) -> float:
    """How far (mm) a sheet goes from the first row to the last: RMS of what is known, median over the sweeps."""
    ends, size, twists = np.array([0.0, read_out.rows - 1.0]), read_out.size, []
    for sweep, (frame, pi) in enumerate(zip(sweeps.frames, sweeps.pis, strict=True)):
        ray = camera.rays(crossings.uv[(crossings.a == frame) | (crossings.b == frame)]).mean(axis=0)
        first, last = read_out.forms(np.tile(ray, (2, 1)), ends)
        block = slice(size * sweep, size * sweep + size)
        unsure = (last - first) @ sweeps.covariance[block, block] @ (last - first)
        way = np.hypot((last - first) @ pi, np.sqrt(max(unsure, 0.0)))
        twists.append(way / abs(pi[:3] @ ray * np.linalg.norm(pi[:3])))
    return float(np.median(twists))
