"""Location of sweeps while they come, each by the fan or known planes and by a few sweeps before it, the anchors.

The anchors are spread over the sweeps so far and adjusted together as a small network, anew each time there are a third
more sweeps. Every other sweep is located by its crossings with the fan and with them (`core.scan.sweeps.one_sweep`). So
the work for a frame does not grow with the length of the scan. When the anchors have been adjusted, all sweeps before
can be located anew, also by the anchors that came after them: one at a time, by whoever has the time for it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.image.crossings.crossing import search_crossings
from core.image.crossings.segments import CELLS
from core.image.stripes.centreline import Centreline
from core.model import Camera, Fan
from core.model.arrays import Array
from core.scan.features.crossings import (
    CrossingTable,
    CrossingWindow,
    Meeting,
    ShadedLines,
    crossing_table,
    meetings,
    meetings_at,
    shaded,
)
from core.scan.known_planes.known_plane import Control
from core.scan.known_planes.points_on_planes import SeenBoards
from core.scan.network.datum import free_directions
from core.scan.network.geometry import CrossingRays
from core.scan.sweeps.fan_lines import UNASSIGNED, FanLines, possible_fan_lines
from core.scan.sweeps.ghosts import held_from_turning
from core.scan.sweeps.locate import LocatedSweeps, choose_numbering, locate_together
from core.scan.sweeps.one_sweep import KnownPlanes, OneSweep, judge_plane, locate_one

# Chosen so that a preview is nearly as good as the network and a frame's work does not grow with the scan:
# tests/scan/preview/test_frames.py holds them.
FIRST_ADJUSTMENT = 4
"""Sweeps from which on the anchors are adjusted together: with fewer the fan alone says as much."""
GROWTH = 4 / 3
"""The anchors are adjusted again when there are so many times as many sweeps as the last time."""
MOST_ANCHORS = 40
"""Anchors at most: a frame is crossed with all of them."""
ANCHOR_STRIDE_PX = 6.0
"""Movement of the stripe from one anchor to the next, in px, until there are too many; then it is doubled."""
SURE_AFTER = 3
"""A numbering of the fan's lines that has been chosen so often in a row is kept."""
MOST_RENEWED = 1500
"""With more sweeps than this those before are not located again: by then they are known well, and crossings fill the
memory."""

MOVEMENT_SAMPLES = 60
"""Points of a stripe by which its movement from frame to frame is judged."""


@dataclass(frozen=True, eq=False, slots=True)
class TrackedSweep:
    """One sweep with its plane and its crossings, with the fan (b = −1) and with anchors (b their frame).

    Without a fan its points on known planes stand in place of those with it: on plane k `piece_b` is −1 − k.

    Anchors are the sweeps before and after it that are kept to be crossed. `used` (M,) are the rows of `crossings` that
    `plane` rests on; `left_out` the meetings that gave no crossing, each with about where in pixels, and why.
    """

    frame: int
    crossings: CrossingTable
    geometry: CrossingRays
    left_out: tuple[tuple[Array, str], ...]
    plane: OneSweep | None
    used: NDArray[np.int64]

    def without_crossings(self) -> TrackedSweep:
        """Copy the sweep and its plane without the crossings, which take most memory."""
        none = np.zeros(0, np.int64)
        table, rays = self.crossings.select(none), self.geometry.select(none)
        return replace(self, crossings=table, geometry=rays, left_out=(), used=none)


class SweepTracker:
    """Tracker that locates the sweeps of a scan one after another, as their frames come.

    `lines` are the numbers of the fan's centrelines as far as they are settled; given at first, they stay. Where the
    fan has no lines the known planes of the `Control` locate the sweeps; beside a fan they locate nothing.
    """

    def __init__(
        self,
        fan_pieces: Sequence[Centreline],
        camera: Camera,
        known: Fan | Control,
        window: CrossingWindow,
        most_anchors: int = MOST_ANCHORS,
        stride_px: float = ANCHOR_STRIDE_PX,
        lines: FanLines | None = None,
    ) -> None:
        self._fixed = shaded(fan_pieces, window)
        control = Control.of(known)
        self._camera, self._fan, self._window = camera, control.fan, window
        self._control = control if not control.fan.lines else Control(control.fan)
        self._boards = SeenBoards(self._control.planes, camera.image_size, camera) if self._control.planes else None
        self._numberings = (lines,) if lines else possible_fan_lines(fan_pieces, camera, control.fan)
        self.lines: FanLines = self._numberings[0]
        self._chosen_alike = SURE_AFTER if lines or not control.fan.lines else 0
        self._sweeps: dict[int, TrackedSweep] = {}
        self._anchors: dict[int, ShadedLines] = {}
        self._last_anchor: Sequence[Centreline] = ()
        self._most_anchors, self._stride_px = most_anchors, stride_px
        self._adjusted: LocatedSweeps | None = None
        self._due = FIRST_ADJUSTMENT
        self._outdated: set[int] = set()

    @property
    def is_due(self) -> bool:
        """Whether it is time to adjust the anchors, the sweeps that others are crossed with, again."""
        return len(self._sweeps) >= self._due and len(self._anchors) >= FIRST_ADJUSTMENT

    def add(self, frame: int, pieces: Sequence[Centreline]) -> TrackedSweep:
        """Locate the sweep whose centrelines in `frame` are `pieces`, and keep it."""
        window = self._window
        lines = shaded(pieces, window)
        search = search_crossings(lines.stack, self._fixed.stack, window.half_length_px, window.min_angle)
        rows: list[Meeting] = meetings_at(search.found, lines, self._fixed, frame, -1)
        for anchor, others in self._anchors.items():
            rows.extend(meetings(lines, others, frame, anchor, window))
        table = crossing_table(rows, window)
        if self._boards is not None:
            on_planes, plane = self._boards.points([(frame, pieces)], window.half_length_px, CELLS)
            table = table.followed_by(replace(on_planes, piece_b=-1 - plane))
        sweep = TrackedSweep(
            frame, table, CrossingRays.of(table, self._camera), search.left_out, None, np.zeros(0, np.int64)
        )
        self._sweeps[frame] = sweep = self._located(sweep)
        if len(table) and self._is_new(pieces):
            self._tell_earlier_anchors(sweep)
            self._anchors[frame] = lines
            self._last_anchor = pieces
            self._thin_out()
        if len(self._sweeps) > MOST_RENEWED and frame not in self._anchors:
            self._sweeps[frame] = sweep.without_crossings()
        return sweep

    def adjust(self) -> bool:
        """Adjust the anchors, the sweeps others are crossed with; True if all sweeps can be located anew by them."""
        self._due = round(GROWTH * len(self._sweeps))
        table = self._among_anchors()
        if table is None or not np.any(table.with_fan):
            return False
        if self._chosen_alike < SURE_AFTER:
            lines = choose_numbering(self._numberings, table, self._camera, self._fan)
            self._chosen_alike = self._chosen_alike + 1 if lines.line == self.lines.line else 0
            self.lines = lines
        line = self.line_of(table)
        known = ~table.with_fan | (line != UNASSIGNED)
        if self._boards is not None:
            known &= held_from_turning(table, self._camera)
        table, line = table.select(known), line[known]
        if not np.any(table.with_fan) or self._leaves_free(table, line):
            return False
        table = replace(table, piece_b=np.maximum(table.piece_b, -1))
        self._adjusted = locate_together(table, line, self._camera, self._control)
        if len(self._sweeps) > MOST_RENEWED:
            return False
        self._outdated = set(self._sweeps)
        return True

    def _leaves_free(self, table: CrossingTable, line: NDArray[np.int64]) -> bool:
        """Whether there is no fan, and all light on known planes lies in one plane: it leaves the sweeps free."""
        if self._boards is None:
            return False
        on_plane = table.on_plane
        rays = self._camera.rays(table.uv[on_plane])
        inverse_depths = np.einsum("mi,mi->m", rays, self._control.pis_at(line[on_plane], rays))
        return free_directions(rays, inverse_depths) > 0

    def line_of(self, table: CrossingTable) -> NDArray[np.int64]:
        """Number (M,) of the fan's line or, after these, of the known plane of each crossing; else UNASSIGNED."""
        numbers = np.array([*self.lines.line, UNASSIGNED], dtype=np.int64)
        line = np.where(
            table.with_fan, numbers[np.where(table.with_fan, np.maximum(table.piece_b, -1), -1)], UNASSIGNED
        )
        return np.where(table.on_plane, self._fan.lines - 1 - table.piece_b, line)

    def is_outdated(self, frame: int) -> bool:
        """Whether the sweep of `frame` is still located by an adjustment before the latest."""
        return frame in self._outdated

    def located_anew(self, frame: int) -> TrackedSweep:
        """Locate the sweep of `frame` by the latest adjustment, unless that has been done, and return it."""
        if frame in self._outdated:
            self._outdated.discard(frame)
            self._sweeps[frame] = self._located(self._sweeps[frame])
        return self._sweeps[frame]

    def sweeps(self) -> Iterator[TrackedSweep]:
        """Yield all sweeps located so far, in the order in which their frames came."""
        return iter(self._sweeps.values())

    def _is_new(self, pieces: Sequence[Centreline]) -> bool:
        return not self._last_anchor or not movement_px(pieces, self._last_anchor) < self._stride_px

    def _tell_earlier_anchors(self, sweep: TrackedSweep) -> None:
        """A new anchor: those it crosses keep the crossings too, for when they are anchors no more."""
        table = sweep.crossings
        for anchor in np.unique(table.b[~table.with_fan]).tolist():
            rows = table.b == anchor
            earlier = self._sweeps[anchor]
            self._sweeps[anchor] = replace(
                earlier,
                crossings=earlier.crossings.followed_by(table.select(rows).swapped()),
                geometry=earlier.geometry.followed_by(sweep.geometry.select(rows)),
            )

    def _thin_out(self) -> None:
        """Keep every second anchor when there are too many, and from now on take them twice as far apart."""
        if len(self._anchors) <= self._most_anchors:
            return
        if len(self._sweeps) > MOST_RENEWED:
            for frame in list(self._anchors)[1::2]:
                self._sweeps[frame] = self.located_anew(frame).without_crossings()
        self._anchors = {frame: self._anchors[frame] for frame in list(self._anchors)[::2]}
        self._stride_px *= 2

    def _among_anchors(self) -> CrossingTable | None:
        """The crossings of the anchors with the fan and with each other, each once."""
        anchors = np.array(list(self._anchors), dtype=np.int64)
        tables = []
        for frame in self._anchors:
            table = self._sweeps[frame].crossings
            tables.append(table.select(table.with_fan | ((table.b < frame) & np.isin(table.b, anchors))))
        return tables[0].followed_by(*tables[1:]) if tables else None

    def _located(self, sweep: TrackedSweep) -> TrackedSweep:
        """The sweep with its plane from what is known now."""
        known, used = self._known(sweep.crossings, sweep.geometry)
        crossings, geometry = sweep.crossings.select(used), sweep.geometry.select(used)
        adjusted = self._adjusted
        if adjusted is not None and sweep.frame in adjusted.frames:
            place = int(np.searchsorted(adjusted.frames, sweep.frame))
            block = slice(3 * place, 3 * place + 3)
            covariance = adjusted.covariance[block, block]
            plane = judge_plane(adjusted.pis[place], covariance, crossings, geometry, known)
            return replace(sweep, plane=plane, used=used)
        held = len(used) >= 3 and (self._boards is None or held_from_turning(_of_one(crossings), self._camera).all())
        return replace(sweep, plane=locate_one(crossings, geometry, known) if held else None, used=used)

    def _known(self, table: CrossingTable, geometry: CrossingRays) -> tuple[KnownPlanes, NDArray[np.int64]]:
        """The planes that crossings are with, and the rows of those crossings of which it is known."""
        line = self.line_of(table)
        pis = self._control.pis_at(np.maximum(line, 0), geometry.rays)
        sweep = np.full(len(table), -1, dtype=np.int64)
        covariance = np.zeros((0, 0))
        if self._adjusted is not None:
            frames = self._adjusted.frames
            place = np.minimum(np.searchsorted(frames, table.b), len(frames) - 1)
            sweep = np.where(~table.with_fan & (frames[place] == table.b), place, -1)
            pis = np.where((sweep >= 0)[:, None], self._adjusted.pis[np.maximum(sweep, 0)], pis)
            covariance = self._adjusted.covariance
        used = np.flatnonzero((line != UNASSIGNED) | (sweep >= 0))
        return KnownPlanes(pis[used], sweep[used], covariance), used


def _of_one(crossings: CrossingTable) -> CrossingTable:
    """The crossings of one sweep, as if all others were known: it alone could turn."""
    return replace(crossings, b=np.full(len(crossings), -1, dtype=np.int64))


def movement_px(now: Sequence[Centreline], before: Sequence[Centreline]) -> float:
    """Compute how far in px, across the stripe, the centrelines `now` lie from those of `before`; NaN without any.

    The median over their points.
    """
    if not now or not before:
        return float("nan")
    uv = np.concatenate([piece.uv for piece in now])
    normal = np.concatenate([piece.normal for piece in now])
    others = np.concatenate([piece.uv for piece in before])
    few, some = max(1, len(uv) // MOVEMENT_SAMPLES), max(1, len(others) // (4 * MOVEMENT_SAMPLES))
    uv, normal, others = uv[::few], normal[::few], others[::some]
    apart = others[None, :, :] - uv[:, None, :]
    across = np.abs(np.einsum("nmi,ni->nm", apart, normal))
    nearest = np.argmin(np.sum(apart**2, axis=2), axis=1)
    return float(np.median(across[np.arange(len(uv)), nearest]))
