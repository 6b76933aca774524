"""Joining of lines across a crossing: where two stripes of one picture cross, a tracer loses at least one.

Two ends belong together when one smooth curve goes through both arms, as far from the crossing as the other light does
not reach, and when that curve crosses other light in between. So a line is never joined across a depth edge that merely
looks like a gap. The curve between the ends, the bridge, gets no points; but the distances of neighbours are measured
from it too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from core.image.stripes.lines.splitting import SIGNIFICANT, SMALLEST_JUMP_PX, SMALLEST_KINK
from core.image.stripes.positions import Piece
from core.image.stripes.profile import Profiles
from core.image.stripes.runs import correlation_length
from core.model.arrays import Array

# Where two ends may belong together, in filter σ. Held by tests/image/stripes/lines/test_joining.py on stripes that
# cross at 20° to 90°.
_SKIPPED = 12.0  # at each end: so far the other stripe's light reaches at 20°
_ARM, _SHORTEST_ARM = 24.0, 5.0  # fitted on either side of the gap, and at least
_LONGEST_GAP = 40.0  # between the ends
_HOLE = 4.0  # so far a run may go on without seeing its line, and is still taken to cross what lies there

# Largest misfits allowed however uncertain the arms are; the least are those that break a line, `splitting`.
_LARGEST_JUMP_PX = 3.0
_LARGEST_KINK = 0.12  # rad, 7°
_LEAST_COSINE = math.cos(math.radians(30))  # of the angle between an arm and the line across the gap


@dataclass(frozen=True, eq=False, slots=True)
class _End:
    """An end of a piece: which, whether it is its last point, that point (2,), and clear points (K, 2) up to it."""

    piece: int
    last: bool
    point: Array
    arm: Array


@dataclass(frozen=True, eq=False, slots=True)
class _Gap:
    """Two ends that may belong together: their misfit, 1 being the limit, and the bridge between the arms (M, 4)."""

    ends: tuple[_End, _End]
    misfit: float
    bridge: Array


def joined_at_crossings(pieces: list[Piece], filter_px: float) -> tuple[list[Piece], list[Array]]:
    """Join the pieces of lines that others cross; also give, for each, the points that bridge its gaps.

    Bridges are points (M, 4) u, v, n_u, n_v in no order, none for a piece that was whole.
    """
    gaps = _gaps(pieces, filter_px) if len(pieces) > 2 else []
    crossing = [gap for gap in gaps if _crosses_light(gap, gaps, pieces, _HOLE * filter_px)]
    chains: list[list[tuple[int, bool]]] = [[(k, False)] for k in range(len(pieces))]  # number, reversed
    bridges: dict[int, list[Array]] = {k: [] for k in range(len(pieces))}
    taken: set[tuple[int, bool]] = set()
    for gap in sorted(crossing, key=lambda gap: gap.misfit):
        keys = {(end.piece, end.last) for end in gap.ends}
        before, behind = (next(c for c in chains if any(k == end.piece for k, _ in c)) for end in gap.ends)
        if taken & keys or before is behind:
            continue
        taken |= keys
        chains = [c for c in chains if c is not before and c is not behind]
        if not _ends_chain(before, gap.ends[0]):
            before = _reversed(before)
        if _ends_chain(behind, gap.ends[1]):
            behind = _reversed(behind)
        chains.append(before + behind)
        bridges[gap.ends[0].piece].append(gap.bridge)
    whole = [_concatenated(pieces, chain) for chain in chains]
    return whole, [
        np.concatenate([np.empty((0, 4)), *(bridge for k, _ in chain for bridge in bridges[k])]) for chain in chains
    ]


def _gaps(pieces: list[Piece], filter_px: float) -> list[_Gap]:
    """All pairs of ends through which one smooth curve goes."""
    ends = [end for k, piece in enumerate(pieces) for end in _ends(k, piece, filter_px)]
    found = []
    places, limit = np.array([end.point for end in ends]).reshape(-1, 2), _LONGEST_GAP * filter_px
    apart = np.hypot(*(places[:, None] - places).T)
    for i, j in np.argwhere(np.triu(apart < limit, 1)):
        gap = _gap(ends[i], ends[j], filter_px) if ends[i].piece != ends[j].piece else None
        if gap is not None:
            found.append(gap)
    return found


def _ends(number: int, piece: Piece, filter_px: float) -> list[_End]:
    """Both ends of a piece, unless it is too short, or too saturated, to say where it goes."""
    run = piece.run
    skip, arm = min(round(_SKIPPED * filter_px), len(run) // 2), round(_ARM * filter_px)
    if len(run) - skip < _SHORTEST_ARM * filter_px or 2 * np.count_nonzero(piece.saturated) >= len(run):
        return []
    back = run[::-1]
    return [
        _End(number, True, run[-1, :2], back[skip : skip + arm, :2][::-1]),
        _End(number, False, run[0, :2], run[skip : skip + arm, :2][::-1]),
    ]


def _gap(one: _End, other: _End, filter_px: float) -> _Gap | None:
    """The curve through two arms, and how large jump and kink are that it would need in the middle, of those allowed.

    None where the arms do not point at each other, or need more than is allowed.
    """
    start, end = one.arm[-1], other.arm[-1]
    length = math.dist(start, end)
    if length == 0.0:
        return None
    t = (end - start) / length
    n, middle = np.array([t[1], -t[0]]), 0.5 * (start + end)
    arms = (one.arm[-1] - one.arm[0], other.arm[0] - other.arm[-1])
    if (other.point - one.point) @ t <= 0 or any(arm @ t < _LEAST_COSINE * math.hypot(*arm) for arm in arms):
        return None
    thin = max(1, round(0.5 * filter_px))
    x = np.concatenate([one.arm[::-thin], other.arm[::-thin]]) - middle
    along, across = (x @ t) / length, x @ n
    side = np.where(along > 0, 0.5, -0.5)
    broken = np.array([np.ones(len(along)), along, along**2, side, side * along])
    normal, right = broken @ broken.T, broken @ across
    normal[np.diag_indices(5)] *= 1 + 1e-9
    inverse = np.linalg.inv(normal)
    fit = inverse @ right
    variance = float(np.mean((across - fit @ broken) ** 2)) * correlation_length(filter_px) / thin
    jump, kink = SIGNIFICANT * math.sqrt(variance * inverse[3, 3]), SIGNIFICANT * math.sqrt(variance * inverse[4, 4])
    misfit = max(
        abs(fit[3]) / min(max(jump, SMALLEST_JUMP_PX), _LARGEST_JUMP_PX),
        abs(fit[4]) / length / min(max(kink / length, SMALLEST_KINK), _LARGEST_KINK),
    )
    if misfit >= 1:
        return None
    smooth = np.linalg.solve(normal[:3, :3], right[:3])
    at = np.linspace(-0.5, 0.5, max(2, round(length)))
    bridge = middle + (at * length)[:, None] * t + (smooth[0] + smooth[1] * at + smooth[2] * at**2)[:, None] * n
    return _Gap((one, other), misfit, np.column_stack([bridge, np.broadcast_to(n, bridge.shape)]))


def _crosses_light(gap: _Gap, gaps: list[_Gap], pieces: list[Piece], hole: float) -> bool:
    """Whether the bridge across a gap meets another piece, or the bridge across the gap of another line."""
    own = {end.piece for end in gap.ends}
    others = [piece.run for k, piece in enumerate(pieces) if k not in own]
    others += [other.bridge for other in gaps if not own & {end.piece for end in other.ends}]
    return any(crosses(gap.bridge, other, hole) for other in others)


def crosses(bridge: Array, line: Array, hole: float) -> bool:
    """Whether a line (M, ≥ 2) passes from one side of a straight `bridge` to the other in steps below `hole` px."""
    start, chord = bridge[0, :2], bridge[-1, :2] - bridge[0, :2]
    x = line[:, :2] - start
    along, across = x @ chord / (chord @ chord), x @ np.array([chord[1], -chord[0]])
    steps = np.hypot(*np.diff(line[:, :2], axis=0).T)
    met = (across[1:] * across[:-1] <= 0) & (along[1:] > 0) & (along[1:] < 1) & (steps < hole)
    return bool(met.any())


def _ends_chain(chain: list[tuple[int, bool]], end: _End) -> bool:
    """Whether this end of a piece is the last of its chain, rather than the first."""
    number, turned = chain[-1]
    return number == end.piece and end.last != turned


def _reversed(chain: list[tuple[int, bool]]) -> list[tuple[int, bool]]:
    return [(number, not turned) for number, turned in reversed(chain)]


def _concatenated(pieces: list[Piece], chain: list[tuple[int, bool]]) -> Piece:
    """Pieces one after another as one, those reversed that run the other way."""
    if len(chain) == 1:
        return pieces[chain[0][0]]
    parts = [_reversed_piece(pieces[k]) if turned else pieces[k] for k, turned in chain]
    profiles = Profiles(
        *(
            np.concatenate([getattr(part.profiles, name) for part in parts])
            for name in ("height", "background", "slope", "slope_sigma", "width", "skewness")
        )
    )
    return Piece(np.concatenate([p.run for p in parts]), profiles, np.concatenate([p.saturated for p in parts]))


def _reversed_piece(piece: Piece) -> Piece:
    """The same points in the other order: the normal turns with the tangent, and what rises along it falls."""
    run, p = piece.run[::-1].copy(), piece.profiles
    run[:, 2:4] *= -1
    columns = (p.height, p.background, -p.slope, p.slope_sigma, p.width, -p.skewness)
    turned = Profiles(*(values[::-1].copy() for values in columns))
    return Piece(run, turned, piece.saturated[::-1].copy())
