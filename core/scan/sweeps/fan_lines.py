"""Numbering of the fan's centrelines on an object whose shape is not yet known.

A fan line seen on unknown relief could, by depth alone, be any of the lines: half a block's height moves it as far as
the next line is away. But across the fan the lines keep their order, as long as the camera sees them all by one side of
the laser. So each centreline can only carry the numbers that leave room for those before and behind it. Where that
leaves a choice, the number that gives the depth nearest to its neighbours' is taken for the time being, and the sweeps
that cross it decide once their planes are known.

The order holds where camera and laser look along one plane: on the lines of the picture that meet in the image of the
laser's aperture (epipolar lines). The aperture lies on the pencil's axis, but where on it is not known; so places all
along the stretch of the axis that could light the scene are tried, and where they number the lines differently the
sweeps decide again. Across the fan is measured as the angle of the rays about the axis.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.image.stripes.centreline import Centreline
from core.messages import Message
from core.model import Camera, Fan
from core.model.arrays import Array

UNASSIGNED = -1
"""The line of a centreline whose line is not known."""

# Held by tests/scan/sweeps/test_fan_lines.py on rendered parts and a reflection.
LEAST_OVERLAP = 0.1
"""Two centrelines lie side by side if they do so over this share of the shorter one: at a depth edge the light before
and behind it overlaps a little."""
WIDEST_FAN = float(np.deg2rad(45.0))
"""rad: half the opening of a line laser, at most."""
_APERTURES = 7
"""Places of the laser on the pencil's axis that are tried over that opening."""
_CLEARLY_NEARER = 0.5
"""A line is taken by the sweeps if its misfit is below this share of the next one's."""

Order = NDArray[np.bool_]
Counts = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class FanLines:
    """The fan line (from 0) of each centreline; UNASSIGNED where none fits, and then the reason.

    `choices` holds the lines that the order alone would allow; a number is sure where there is but one.
    """

    line: tuple[int, ...]
    reason: tuple[Message | None, ...]
    choices: tuple[tuple[int, ...], ...]

    @classmethod
    def settled_as(cls, line: Sequence[int]) -> FanLines:
        """Numbers settled earlier."""
        return cls(tuple(line), (None,) * len(line), tuple((k,) for k in line))

    @property
    def settled(self) -> int:
        """Number of centrelines that the order alone has numbered."""
        return sum(k != UNASSIGNED and len(c) == 1 for k, c in zip(self.line, self.choices, strict=True))

    @property
    def sure(self) -> FanLines:
        """Only the numbers that the order alone has settled."""
        kept = (k if len(c) == 1 else UNASSIGNED for k, c in zip(self.line, self.choices, strict=True))
        return replace(self, line=tuple(kept))


def possible_fan_lines(pieces: Sequence[Centreline], camera: Camera, fan: Fan) -> tuple[FanLines, ...]:
    """Number the fan's centrelines 0 … N − 1 in every way that some place of the laser allows, likeliest first."""
    if fan.lines == 1:
        return (FanLines((0,) * len(pieces), (None,) * len(pieces), ((0,),) * len(pieces)),)
    rays = [camera.rays(piece.uv) for piece in pieces]
    lengths = np.array([len(piece) for piece in pieces])
    frame = _fan_frame(fan)
    middle = np.median(np.concatenate(rays), axis=0)
    found: dict[tuple[int, ...], FanLines] = {}
    for aperture in _apertures(fan, middle):
        before = _order([_profile(r, frame, aperture, middle) for r in rays])
        kept = _drop_surplus(before, lengths, fan.lines)
        lowest = _chain(before, kept)
        highest = fan.lines - 1 - _chain(before.T, kept)
        lines = _choose(rays, fan, before, kept, lowest, highest)
        known = found.get(lines.line)
        if known is None or lines.settled > known.settled:
            found[lines.line] = lines
    return tuple(sorted(found.values(), key=lambda lines: -lines.settled))


def _fan_frame(fan: Fan) -> Array:
    """Rows: along the pencil's axis, across it from line 1 towards line N, and forward from the camera."""
    _, _, rows = np.linalg.svd(np.array([plane.normal for plane in fan.planes]))
    axis, ahead = rows[2], np.array([0.0, 0.0, 1.0])
    across = np.cross(axis, ahead)
    across /= np.linalg.norm(across)
    # Far away (1/z = 0) line k sits at s_k across, where π_k·(ahead + s across) = 0.
    far = [-(plane.pi @ ahead) / (plane.pi @ across) for plane in fan.planes]
    if far[-1] < far[0]:
        across = -across
    forward = np.cross(axis, across)
    return np.array([axis, across, forward if forward @ ahead > 0 else -forward])


def _apertures(fan: Fan, middle: Array) -> Array:
    """(7, 3): places on the pencil's axis, in mm, from where the laser could light the scene's middle."""
    u, sizes, rows = np.linalg.svd(fan.pis)
    axis = rows[2]
    on_axis = (u[:, :2].T @ np.ones(fan.lines) / sizes[:2]) @ rows[:2]  # nearest to the camera
    scene = fan.planes[fan.lines // 2].points(middle[None])[0]
    foot = on_axis + ((scene - on_axis) @ axis) * axis
    reach = np.linalg.norm(scene - foot) * np.tan(WIDEST_FAN)
    return np.asarray(foot + np.linspace(-reach, reach, _APERTURES)[:, None] * axis)


def _profile(rays: Array, frame: Array, aperture: Array, middle: Array) -> Array:
    """(N, 2): which epipolar plane each ray is in, and where across the fan it points, both as angles; sorted."""
    baseline = aperture / np.linalg.norm(aperture)
    ahead = middle - (middle @ baseline) * baseline
    ahead /= np.linalg.norm(ahead)
    _, across, forward = (rays @ frame.T).T
    plane = np.arctan2(rays @ np.cross(baseline, ahead), rays @ ahead)
    profile = np.column_stack([plane, np.arctan2(across, forward)])
    ordered: Array = profile[np.argsort(profile[:, 0], kind="stable")]
    return ordered


def _order(profiles: Sequence[Array]) -> Order:
    """before[i, j]: where both are seen side by side, i lies on the side of lower line numbers."""
    count = len(profiles)
    before = np.zeros((count, count), dtype=np.bool_)
    for i in range(count):
        for j in range(i + 1, count):
            a, b = profiles[i], profiles[j]
            low, high = max(a[0, 0], b[0, 0]), min(a[-1, 0], b[-1, 0])
            if high - low <= LEAST_OVERLAP * min(a[-1, 0] - a[0, 0], b[-1, 0] - b[0, 0]):
                continue
            at = np.linspace(low, high, 9)
            gap = np.median(np.interp(at, b[:, 0], b[:, 1]) - np.interp(at, a[:, 0], a[:, 1]))
            before[i, j] = gap > 0
            before[j, i] = gap < 0
    return before


def _chain(before: Order, kept: Array) -> Counts:
    """How many kept pieces at most stand in one row before each piece."""
    depth = np.zeros(len(before), dtype=np.int64)
    for _ in range(len(before)):
        candidates = np.where(before & (kept > 0)[:, None], depth[:, None] + 1, 0)
        deeper = candidates.max(axis=0, initial=0)
        if np.array_equal(deeper, depth):
            break
        depth = deeper
    return depth


def _drop_surplus(before: Order, lengths: Array, lines: int) -> Array:
    """1 for kept pieces; the shortest of any row of more than `lines` pieces is dropped until none is left."""
    kept = np.ones(len(before))
    while True:
        row = _chain(before, kept) + _chain(before.T, kept) + 1
        crowded = np.flatnonzero((row > lines) & (kept > 0))
        if not len(crowded):
            return kept
        kept[crowded[np.argmin(lengths[crowded])]] = 0


def _choose(
    rays: Sequence[Array],
    fan: Fan,
    before: Order,
    kept: Array,
    lowest: Counts,
    highest: Counts,
) -> FanLines:
    """Fix the pieces that have one choice; then, longest first, the others by the depth nearest to those fixed."""
    count = len(rays)
    line = np.full(count, UNASSIGNED)
    reason: list[Message | None] = [None] * count
    depth = np.array([[np.median(r @ plane.pi) for plane in fan.planes] for r in rays])  # inverse depth, 1/mm
    centre = np.array([np.median(r, axis=0) for r in rays])
    for i in range(count):
        if not kept[i]:
            reason[i] = Message(
                "scan.fan_light_crowded", "more than {n} stripes side by side: taken for a reflection", n=fan.lines
            )
        elif lowest[i] == highest[i]:
            line[i] = lowest[i]
    waiting = [i for i in range(count) if kept[i] and line[i] == UNASSIGNED]
    for i in sorted(waiting, key=lambda i: -len(rays[i])):
        options = [
            k
            for k in range(lowest[i], highest[i] + 1)
            if depth[i, k] > 0
            and not any(line[j] != UNASSIGNED and before[j, i] and line[j] >= k for j in range(count))
            and not any(line[j] != UNASSIGNED and before[i, j] and line[j] <= k for j in range(count))
        ]
        if not options:
            reason[i] = Message("scan.fan_light_fits_no_line", "no fan line fits between its neighbours")
            continue
        fixed = np.flatnonzero(line != UNASSIGNED)
        if len(fixed):
            nearest = fixed[np.argsort(np.linalg.norm(centre[fixed] - centre[i], axis=1), kind="stable")[:3]]
            target = np.median(depth[nearest, line[nearest]])
        else:
            target = np.median(depth[depth > 0])
        line[i] = min(options, key=lambda k: abs(depth[i, k] - target))
    choices = tuple(
        tuple(range(lowest[i], highest[i] + 1)) if line[i] != UNASSIGNED else (UNASSIGNED,) for i in range(count)
    )
    return FanLines(tuple(int(k) for k in line), tuple(reason), choices)


def settle_by_sweeps(lines: FanLines, piece: Counts, rays: Array, inverse_depths: Array, fan: Fan) -> FanLines:
    """Decide by the sweeps where the order across the fan left a choice.

    `piece` (M,), `rays` (M, 3): crossings with the fan; `inverse_depths` (M,) what the sweeps' planes, solved without
    the unsure centrelines, say there. The line that comes nearest is taken if it is twice as near as any other.
    """
    line, reason = list(lines.line), list(lines.reason)
    for i, choices in enumerate(lines.choices):
        rows = piece == i
        if len(choices) < 2 or not rows.any():
            continue
        misfit = np.array([np.median(np.abs(rays[rows] @ fan.planes[k].pi - inverse_depths[rows])) for k in choices])
        best, second = np.argsort(misfit, kind="stable")[:2]
        if misfit[best] < _CLEARLY_NEARER * misfit[second]:
            line[i] = choices[best]
        else:
            line[i] = UNASSIGNED
            reason[i] = Message("scan.fan_light_ambiguous", "it could be more than one of the fan's lines")
    return replace(lines, line=tuple(line), reason=tuple(reason))
