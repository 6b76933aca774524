"""Lines made whole again behind a crossing: where two stripes of one picture cross, a tracer loses at least one.

Two ends belong together when one smooth curve goes through both arms, as far from the crossing as the other light does
not reach, and when that curve crosses other light in between. So a line is never joined across a depth edge that merely
looks like a gap. The way between the ends is known as well as the fit: no point is put there, but a neighbour that is
judged by its distance from the line is judged by it there too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from core.image.pieces import correlation_length
from core.image.placing import Piece
from core.image.profile import Profiles
from core.model.arrays import Array

_SKIP, _ARM, _SHORTEST_ARM = 12.0, 24.0, 5.0  # filter σ from an end: other light reaches so far at 20°; arms of the fit
_LONGEST_GAP = 40.0  # filter σ between ends
_SIGNIFICANT = 6.0  # standard uncertainties
_SMALLEST_JUMP, _LARGEST_JUMP = 0.3, 3.0  # px
_SMALLEST_KINK, _LARGEST_KINK = 0.06, 0.12  # rad
_STRAIGHT = math.cos(math.radians(30))  # at least, between an arm and the way across the gap
_HOLE = 4.0  # filter σ: a run may go so far without seeing its line


@dataclass(frozen=True, eq=False, slots=True)
class _End:
    """An end of a piece: which, whether it is its last point, that point (2,), and clear points (K, 2) up to it."""

    piece: int
    last: bool
    point: Array
    arm: Array


@dataclass(frozen=True, eq=False, slots=True)
class _Gap:
    """Two ends that may belong together: how badly they fit, 1 being the limit, and the way between the arms (M, 4)."""

    ends: tuple[_End, _End]
    misfit: float
    way: Array


def joined_at_crossings(pieces: list[Piece], filter_px: float) -> tuple[list[Piece], list[Array]]:
    """The pieces, those of one line on either side of a crossing made one; and for each the ways across its gaps.

    Those are points (M, 4) u, v, n_u, n_v in no order, none for a piece that was whole.
    """
    gaps = _gaps(pieces, filter_px) if len(pieces) > 2 else []
    crossing = [gap for gap in gaps if _crosses_light(gap, gaps, pieces, _HOLE * filter_px)]
    chains: list[list[tuple[int, bool]]] = [[(k, False)] for k in range(len(pieces))]  # number, reversed
    ways: dict[int, list[Array]] = {k: [] for k in range(len(pieces))}
    taken: set[tuple[int, bool]] = set()
    for gap in sorted(crossing, key=lambda gap: gap.misfit):
        keys = {(end.piece, end.last) for end in gap.ends}
        before, behind = (next(c for c in chains if any(k == end.piece for k, _ in c)) for end in gap.ends)
        if taken & keys or before is behind:
            continue
        taken |= keys
        chains = [c for c in chains if c is not before and c is not behind]
        if not _ends_chain(before, gap.ends[0]):
            before = _turned(before)
        if _ends_chain(behind, gap.ends[1]):
            behind = _turned(behind)
        chains.append(before + behind)
        ways[gap.ends[0].piece].append(gap.way)
    whole = [_chained(pieces, chain) for chain in chains]
    return whole, [np.concatenate([np.empty((0, 4)), *(way for k, _ in chain for way in ways[k])]) for chain in chains]


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
    skip, arm = min(round(_SKIP * filter_px), len(run) // 2), round(_ARM * filter_px)
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
    if (other.point - one.point) @ t <= 0 or any(arm @ t < _STRAIGHT * math.hypot(*arm) for arm in arms):
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
    jump, kink = _SIGNIFICANT * math.sqrt(variance * inverse[3, 3]), _SIGNIFICANT * math.sqrt(variance * inverse[4, 4])
    misfit = max(
        abs(fit[3]) / min(max(jump, _SMALLEST_JUMP), _LARGEST_JUMP),
        abs(fit[4]) / length / min(max(kink / length, _SMALLEST_KINK), _LARGEST_KINK),
    )
    if misfit >= 1:
        return None
    smooth = np.linalg.solve(normal[:3, :3], right[:3])
    at = np.linspace(-0.5, 0.5, max(2, round(length)))
    way = middle + (at * length)[:, None] * t + (smooth[0] + smooth[1] * at + smooth[2] * at**2)[:, None] * n
    return _Gap((one, other), misfit, np.column_stack([way, np.broadcast_to(n, way.shape)]))


def _crosses_light(gap: _Gap, gaps: list[_Gap], pieces: list[Piece], hole: float) -> bool:
    """Whether the way across a gap meets another piece, or the way across the gap of another line."""
    own = {end.piece for end in gap.ends}
    others = [piece.run for k, piece in enumerate(pieces) if k not in own]
    others += [other.way for other in gaps if not own & {end.piece for end in other.ends}]
    return any(_cross(gap.way, other, hole) for other in others)


def _cross(way: Array, line: Array, hole: float) -> bool:
    """Whether a line (M, ≥ 2) passes from one side of a `way`, nearly straight, to the other; `hole` px are none."""
    start, chord = way[0, :2], way[-1, :2] - way[0, :2]
    x = line[:, :2] - start
    along, across = x @ chord / (chord @ chord), x @ np.array([chord[1], -chord[0]])
    steps = np.hypot(*np.diff(line[:, :2], axis=0).T)
    met = (across[1:] * across[:-1] <= 0) & (along[1:] > 0) & (along[1:] < 1) & (steps < hole)
    return bool(met.any())


def _ends_chain(chain: list[tuple[int, bool]], end: _End) -> bool:
    """Whether this end of a piece is the last of its chain, rather than the first."""
    number, turned = chain[-1]
    return number == end.piece and end.last != turned


def _turned(chain: list[tuple[int, bool]]) -> list[tuple[int, bool]]:
    return [(number, not turned) for number, turned in reversed(chain)]


def _chained(pieces: list[Piece], chain: list[tuple[int, bool]]) -> Piece:
    """Pieces one after another as one, those turned that run the other way."""
    if len(chain) == 1:
        return pieces[chain[0][0]]
    parts = [_backwards(pieces[k]) if turned else pieces[k] for k, turned in chain]
    profiles = Profiles(
        *(
            np.concatenate([getattr(part.profiles, name) for part in parts])
            for name in ("height", "background", "slope", "slope_sigma", "width")
        )
    )
    return Piece(np.concatenate([p.run for p in parts]), profiles, np.concatenate([p.saturated for p in parts]))


def _backwards(piece: Piece) -> Piece:
    """The same points in the other order: the normal turns with the tangent, and what rises along it falls."""
    run, p = piece.run[::-1].copy(), piece.profiles
    run[:, 2:4] *= -1
    turned = Profiles(*(values[::-1].copy() for values in (p.height, p.background, -p.slope, p.slope_sigma, p.width)))
    return Piece(run, turned, piece.saturated[::-1].copy())
