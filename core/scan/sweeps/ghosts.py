"""Second bounces: pieces of a sweep's light that shiny sides have mirrored onto table or part.

Mirrored light lies in another plane than its sweep, so its crossings with other sweeps and with the fan do not close.
Within the network it would be known by that, were it not for its number: some twenty such pieces among a hundred make
the planes fall together, or look as if something had moved. But a mirror gives back less than it gets. So the network
is solved by the bright pieces alone, and every fainter one is held against it:

- it is the sweep's own if its crossings close within their σ;
- it is a second bounce if they miss by more than its own width, too;
- where no crossing says either, it is left out as well if there are second bounces in the scan, and if it is also
  fainter than the light of other sweeps at its place: it may be one.

A scan in which no piece misses keeps all of them, the faint ones as well: dark paint, grazed sides and a laser far from
the surface are no mirrors.

Bright pieces that all lie on the table cross others along one straight line. About it the sheet is free to turn, and
what noise seems to say of that is worth nothing: pieces off that line cannot miss.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence, Set
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.findings.table import note_of
from core.image.stripes.stripe import WIDTH_IN_SIGMA
from core.messages import Message
from core.model import Camera, Fan
from core.model.arrays import Array
from core.model.residuals import over_picture
from core.model.robust import Schedule, mad_sd, median
from core.scan.features.crossings import CrossingTable, Index
from core.scan.features.frames import FrameFeatures, FrameRecord
from core.scan.known_planes.known_plane import Control
from core.scan.network.adjustment import HUBER_AT, has_collapsed
from core.scan.network.equations import GRADIENT_FLOOR, Adjustment
from core.scan.network.geometry import CrossingRays, floored, noise_gains
from core.scan.network.line_errors import LineErrors
from core.scan.network.sweep_plane import PRIOR_SD
from core.scan.sweeps.locate import by_sweep, sweeping_frames

# Held by tests/scan/sweeps/test_ghosts.py and tests/accuracy/test_second_bounces.py.
FAINT = 0.85
"""Of the median height of a frame's stripe: fainter pieces may be second bounces. Polished metal mirrors 0.6."""
SEVERAL = 3
"""Crossings of such pieces in a scan, at least, before there are second bounces in it: one may be wrong by chance."""
MISSED = 4.0
"""Standard deviations by which a crossing misses. Those of second bounces miss by 100 to 1000."""
FIRM = 5.0
"""Noise of crossings by which they spread beside a straight line at least, or their sheet may turn about it."""
GRID = (16, 12)
"""Columns and rows of the parts of a picture in which the light of sweeps is compared."""
_WEIGHTS = Schedule(6, huber_at=HUBER_AT)
"""Of reweighting: wrong crossings are few among bright pieces."""


Piece = tuple[int, int]
"""Frame and number of a piece of a sweep's light."""


@dataclass(frozen=True, slots=True)
class SecondBounces:
    """Pieces of the sweeps' centrelines that are, or may be, second bounces: light mirrored by a shiny side."""

    pieces: frozenset[Piece] = frozenset()

    def __contains__(self, piece: Piece) -> bool:
        return piece in self.pieces

    def among(self, crossings: CrossingTable) -> NDArray[np.bool_]:
        """Find the mask (M,) of the crossings on a piece that is, or may be, a second bounce."""
        return _of(self.pieces, crossings.a, crossings.piece_a) | _of(self.pieces, crossings.b, crossings.piece_b)

    def counted(self, records: Sequence[FrameRecord]) -> tuple[FrameRecord, ...]:
        """Copy the records of all frames, adding how many of each frame's pieces are second bounces."""
        count = Counter(frame for frame, _ in self.pieces)
        return tuple(replace(one, second_bounces=count[one.index]) for one in records)

    @property
    def notes(self) -> tuple[Message, ...]:
        """Note for the technician if any piece is a second bounce; () if none is."""
        if not self.pieces:
            return ()
        return (note_of("scan.second_bounces", n=len(self.pieces), frames=len({frame for frame, _ in self.pieces})),)


NO_BOUNCES = SecondBounces()


def find_second_bounces(
    frames: Sequence[FrameFeatures], numbered_crossings: tuple[CrossingTable, Index], camera: Camera, fan: Fan | Control
) -> SecondBounces:
    """Find the pieces of the sweeps' centrelines that are second bounces: light mirrored by a shiny side.

    With the crossings goes the fan's line (M,) of each, −1 between sweeps.
    """
    crossings, line = numbered_crossings
    faint = _faint_pieces(frames)
    faint_a, faint_b = _of(faint, crossings.a, crossings.piece_a), _of(faint, crossings.b, crossings.piece_b)
    among = ~faint_a & ~faint_b
    bright, tested = crossings.select(among), faint_a != faint_b
    if np.count_nonzero(tested) < SEVERAL or not np.any(bright.with_fan):
        return NO_BOUNCES
    first, second = np.flatnonzero(tested & faint_a), np.flatnonzero(tested & faint_b)
    table = crossings.select(first).followed_by(crossings.select(second).swapped())  # the faint piece is a
    known = sweeping_frames(bright)
    solvable = np.isin(table.a, known) & (table.with_fan | np.isin(table.b, known))
    table, of_fan = table.select(solvable), line[np.concatenate([first, second])][solvable]
    missed, real = _judged(table, of_fan, bright, line[among], camera, fan)
    width = {(f, p): WIDTH_IN_SIGMA * median(frames[f].centrelines[p].width) for f, p in faint}
    found, missing, proven = 0, set[Piece](), set[Piece]()
    for piece in faint:
        mine = (table.a == piece[0]) & (table.piece_a == piece[1])
        if np.any(mine) and np.median(missed[mine]) > width[piece]:
            found += int(np.count_nonzero(mine))
            missing.add(piece)
        elif np.any(real[mine]) and 2 * np.count_nonzero(real[mine]) > np.count_nonzero(mine):
            proven.add(piece)
    if found < SEVERAL:
        return NO_BOUNCES
    unsure = (faint - proven - missing) & _faint_at_their_places(frames, camera.image_size)
    return SecondBounces(frozenset(missing | unsure))


def _faint_pieces(frames: Sequence[FrameFeatures]) -> set[Piece]:
    """Frame and number of the pieces that are clearly fainter than the frame's stripe is on the whole."""
    found = set()
    for frame in frames:
        if len(frame.centrelines) < 2:
            continue
        usual = np.median(np.concatenate([piece.strength for piece in frame.centrelines]))
        found |= {
            (frame.index, number)
            for number, piece in enumerate(frame.centrelines)
            if median(piece.strength) < FAINT * usual
        }
    return found


def _faint_at_their_places(frames: Sequence[FrameFeatures], image_size: tuple[int, int]) -> set[Piece]:
    """Frame and number of the pieces that are clearly fainter than the light of other sweeps at the same places.

    What distance, incidence and the surface's colour do to light they do to all sweeps alike at one place. That of a
    frame on the whole is taken off before: the laser may have been farther away.
    """
    pieces = [((frame.index, k), one) for frame in frames for k, one in enumerate(frame.centrelines)]
    if not pieces:
        return set()
    part = [over_picture(one.uv, image_size, GRID) for _, one in pieces]
    strength, of_part = np.concatenate([one.strength for _, one in pieces]), np.concatenate(part)
    usual = np.full(GRID[0] * GRID[1], np.nan)
    for one in np.unique(of_part):
        usual[one] = np.median(strength[of_part == one])
    share = {piece: one.strength / usual[mine] for (piece, one), mine in zip(pieces, part, strict=True)}
    found = set()
    for frame in frames:
        mine = [share[frame.index, k] for k in range(len(frame.centrelines))]
        level = np.median(np.concatenate(mine)) if mine else 1.0
        found |= {(frame.index, k) for k, one in enumerate(mine) if np.median(one) < FAINT * level}
    return found


def _of(pieces: Set[Piece], frame: Index, piece: Index) -> NDArray[np.bool_]:
    """(M,) True where frame and piece are one of `pieces`."""
    return np.array([one in pieces for one in zip(frame.tolist(), piece.tolist(), strict=True)], dtype=np.bool_)


def _judged(
    table: CrossingTable, line: Index, bright: CrossingTable, bright_line: Index, camera: Camera, fan: Fan | Control
) -> tuple[Array, NDArray[np.bool_]]:
    """By how many px (M,) a's line misses each crossing of `table`, and whether it does not although it well could.

    0 px where it misses by no more than its uncertainty, that of the planes solved by the `bright` crossings included;
    neither where these alone do not tell the planes apart.
    """
    frames = sweeping_frames(bright)
    renumbered = by_sweep(bright, frames)
    equations = Adjustment(
        renumbered, CrossingRays.of(bright, camera), bright_line, fan, len(frames), LineErrors.of(renumbered)
    )
    solution = equations.weighted(_WEIGHTS)
    if has_collapsed(equations, solution.pis):  # the part is dark: the bright pieces know nothing of depth
        return np.zeros(len(table)), np.zeros(len(table), dtype=np.bool_)
    covariance = equations.covariance(solution)[0].reshape(len(frames), 3, len(frames), 3)
    for sweep, free in enumerate(free_turns(renumbered, equations.geometry, len(frames))):
        covariance[sweep, :, sweep, :] += PRIOR_SD**2 * np.outer(free, free)
    scale = max(1.0, mad_sd(solution.residuals))
    place = np.searchsorted(frames, np.arange(max(frames[-1], table.a.max(initial=0), table.b.max(initial=0)) + 1))
    at = table.renumber(place)
    rays = CrossingRays.of(at, camera)
    tested = Adjustment(at, rays, line, fan, len(frames), LineErrors.of(at))
    off = np.einsum("mi,mi->m", tested.differences(solution.pis), rays.rays)
    gradient = floored(tested.gradient(solution.pis), GRADIENT_FLOOR * equations.typical_gradient)
    gain_a, gain_b = noise_gains(at, gradient)
    a, b = at.a, np.maximum(at.b, 0)
    of_planes = _variance(covariance, a, a, rays.rays)
    between = _variance(covariance, b, b, rays.rays) - 2 * _variance(covariance, a, b, rays.rays)
    of_planes = of_planes + np.where(at.with_fan, 0.0, between)
    sigma = scale * np.sqrt((gain_a * at.sigma_a) ** 2 + (gain_b * at.sigma_b) ** 2 + np.maximum(of_planes, 0.0))
    misses = np.abs(off) > MISSED * sigma
    sharp = MISSED * sigma < np.abs(gain_a)  # a line one pixel aside would miss
    return np.where(misses, np.abs(off / gain_a), 0.0), ~misses & sharp


def free_turns(crossings: CrossingTable, geometry: CrossingRays, sweeps: int) -> Array:
    """Find for each sweep the unit vector (S, 3) along which its plane is free as all its rays are coplanar; else 0."""
    px = np.sqrt(np.abs(np.linalg.det(geometry.jacobians)))
    free = np.zeros((sweeps, 3))
    for sweep in range(sweeps):
        as_a, as_b = crossings.a == sweep, crossings.b == sweep
        rays = np.concatenate([geometry.rays[as_a], geometry.rays[as_b]])
        noise = np.concatenate([(crossings.sigma_a * px)[as_a], (crossings.sigma_b * px)[as_b]])
        _, spread, directions = np.linalg.svd(rays / noise[:, None], full_matrices=len(rays) < 3)
        if len(rays) < 3 or spread[2] < FIRM * np.sqrt(len(rays)):
            free[sweep] = directions[2]
    return free


def held_from_turning(crossings: CrossingTable, camera: Camera) -> NDArray[np.bool_]:
    """Mask (M,) of the crossings of sweeps that meet more than one straight line.

    A sheet known along one line alone is free to turn about it, and would fall onto the board that it is seen on.
    """
    if not len(crossings):
        return np.zeros(0, dtype=np.bool_)
    frames = sweeping_frames(crossings)
    free = free_turns(by_sweep(crossings, frames), CrossingRays.of(crossings, camera), len(frames))
    return ~np.isin(crossings.a, frames[free.any(axis=1)])


def _variance(covariance: Array, one: Index, other: Index, rays: Array) -> Array:
    """Covariance (M,) of π·r of two sweeps each."""
    return np.asarray(np.einsum("mi,mij,mj->m", rays, covariance[one, :, other, :], rays))
