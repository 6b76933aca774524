"""Numbering of the fan's centrelines on an object whose shape is not yet known.

A fan line seen on unknown relief could, by depth alone, be any of the lines: half a block's height moves it as far as
the next line is away. Two rules say which numbers centrelines can have together:

- Across the fan the lines keep their order, as long as the camera sees them all by one side of the laser. This holds
  where camera and laser look along one plane: on the lines of the picture that meet in the image of the laser's
  aperture (epipolar lines). Across the fan is measured as the angle of the rays about the axis.
- The light that leaves the aperture in one direction reaches one surface. So centrelines that would lie on one light
  plane in the same directions from the aperture, such as neighbours on one face, are not of the same line.

A number is sure if the rules leave no other, or if by no other the centreline lies on one plane face with two whose
numbers are sure. Where that leaves a choice, the number that gives the depth nearest to its
neighbours' is taken for the time being; the sweeps that cross the centreline decide once their planes are known, and
what they do not decide is left out.

The aperture lies on the pencil's axis, but where on it is not known; so places all along the stretch of the axis that
could light the scene are tried, and where they number the lines differently the sweeps decide again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, permutations

import numpy as np
from numpy.typing import NDArray

from core.image.stripes.centreline import Centreline
from core.messages import Message
from core.model import Camera, Fan
from core.model.arrays import Array
from core.model.robust import median

UNASSIGNED = -1
"""The line of a centreline whose line is not known."""

# Held by tests/scan/sweeps/test_fan_lines.py on rendered parts and a reflection.
LEAST_OVERLAP = 0.1
"""Two centrelines lie side by side if they do so over this share of the shorter one: at a depth edge the light before
and behind it overlaps a little."""
WIDEST_FAN = float(np.deg2rad(45.0))
"""rad: half the opening of a line laser, at most."""
_APERTURES = 31
"""Places of the laser on the pencil's axis that are tried over that opening, some 10 to 20 mm apart: with coarser steps
none may be near enough to the true one to give the true order."""
_SAMPLES = 32
"""Points of a centreline, at most, that say where it lies."""
LEAST_SHARED = 0.5
"""Centrelines of one line share no directions from the laser; they seem to, by less than this share of the shorter one,
where the place that is tried is not quite the laser's."""
_CLEARLY_NEARER = 0.5
"""A line is taken by the sweeps if its misfit is below this share of the next one's."""
ON_ONE_FACE = 1e-3
"""Share of the depth by which centrelines on one plane face leave it at most: 0.5 mm at 500 mm, more than bent light
and a calibration in need of renewal do, and a tenth of what a wrong line does."""

Order = NDArray[np.bool_]
Options = NDArray[np.bool_]
"""(n, N): which lines each of n centrelines could be of."""
Pairs = NDArray[np.bool_]
"""(n, N, n, N): whether centreline i may be of line k where centreline j is of line m."""
Counts = NDArray[np.int64]

PRINT = Message("scan.fan_light_is_print", "it is print on a known plane")
AMBIGUOUS = Message("scan.fan_light_ambiguous", "it could be more than one of the fan's lines")


@dataclass(frozen=True, eq=False, slots=True)
class Face:
    """Plane face that two of the fan's centrelines lie on if i is of line k and j of line m: `of` ((i, k), (j, m)).

    `on` (n, N): whether each centreline lies on it, too, were it of line 0 … N − 1.
    """

    of: tuple[tuple[int, int], tuple[int, int]]
    on: Options


@dataclass(frozen=True, slots=True)
class FanLines:
    """Numbering of the fan's centrelines: the line (from 0) of each, or UNASSIGNED and the reason.

    `choices` holds the lines that the rules alone would allow; a number is sure where there is but one. `allowed` says
    which numbers go together (one True for all: any), `faces` where centrelines could lie.
    """

    line: tuple[int, ...]
    reason: tuple[Message | None, ...]
    choices: tuple[tuple[int, ...], ...]
    allowed: Pairs = field(default_factory=lambda: np.ones((1, 1, 1, 1), dtype=np.bool_), compare=False, repr=False)
    faces: tuple[Face, ...] = field(default=(), compare=False, repr=False)

    @classmethod
    def settled_as(cls, line: Sequence[int]) -> FanLines:
        """Make a numbering that holds as settled the line numbers of centrelines known from an earlier solution."""
        return cls(tuple(line), (None,) * len(line), tuple((k,) for k in line))

    @classmethod
    def beside_print(cls, of_light: FanLines, printed: NDArray[np.bool_]) -> FanLines:
        """Complete the numbering of what is light by the centrelines that are `printed` (C,), which are of no line."""
        place = iter(range(len(of_light.line)))
        of = [None if is_print else next(place) for is_print in printed.tolist()]
        return cls(
            tuple(UNASSIGNED if i is None else of_light.line[i] for i in of),
            tuple(PRINT if i is None else of_light.reason[i] for i in of),
            tuple((UNASSIGNED,) if i is None else of_light.choices[i] for i in of),
        )

    @property
    def settled(self) -> int:
        """Count of the centrelines for which the rules of numbering, without the sweeps, allow one line only."""
        return sum(k != UNASSIGNED and len(c) == 1 for k, c in zip(self.line, self.choices, strict=True))

    @property
    def sure(self) -> FanLines:
        """Numbering in which only those centrelines keep a number for which the rules allow one line only."""
        kept = (k if len(c) == 1 else UNASSIGNED for k, c in zip(self.line, self.choices, strict=True))
        return replace(self, line=tuple(kept))

    @property
    def on_faces(self) -> int:
        """Count of the centrelines that lie on one plane face with two others if their numbers are true."""
        numbers = np.array(self.line)[:, None] == np.arange(self.allowed.shape[1])
        lying = [np.any(on & numbers, axis=1) for on in _known(self.faces, numbers)]
        return int(np.count_nonzero(np.any([on for on in lying if on.sum() > 2] or [False], axis=0)))

    def agreed(self, others: Sequence[FanLines]) -> FanLines:
        """Copy the numbering, with UNASSIGNED for each centreline to which any of the `others` gives another line."""
        line, reason = list(self.line), list(self.reason)
        for i, k in enumerate(line):
            if {k, *(lines.line[i] for lines in others)} - {k, UNASSIGNED}:
                line[i], reason[i] = UNASSIGNED, AMBIGUOUS
        return replace(self, line=tuple(line), reason=tuple(reason))


def possible_fan_lines(pieces: Sequence[Centreline], camera: Camera, fan: Fan) -> tuple[FanLines, ...]:
    """Number the fan's centrelines in every way that some place of the laser allows, the likeliest first."""
    if not fan.lines:
        return (FanLines((), (), ()),)
    if fan.lines == 1:
        return (FanLines((0,) * len(pieces), (None,) * len(pieces), ((0,),) * len(pieces)),)
    rays = [camera.rays(piece.uv) for piece in pieces]
    lengths = np.array([len(piece) for piece in pieces])
    frame = _fan_frame(fan)
    middle = np.median(np.concatenate(rays), axis=0)
    faces = _faces(rays, fan)
    some = [r[np.linspace(0, len(r) - 1, min(len(r), _SAMPLES)).round().astype(np.int64)] for r in rays]
    found: dict[tuple[tuple[int, ...], ...], FanLines] = {}
    for aperture in _apertures(fan, middle):
        before = _order([_profile(r, frame, aperture, middle) for r in some])
        kept = _drop_surplus(before, lengths, fan.lines)
        allowed = _allowed(before, [_lit(r, fan, frame, aperture) for r in some])
        lines = _choose(rays, fan, kept, allowed, faces)
        found.setdefault((lines.line, *lines.choices), lines)
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


def _lit(rays: Array, fan: Fan, frame: Array, aperture: Array) -> Array:
    """(N, 2): between which angles to the axis the laser would light a centreline, were it of line 0 … N − 1."""
    seen = []
    for plane in fan.planes:
        out = plane.points(rays) - aperture
        along = out @ frame[0]
        angle = np.arctan2(np.linalg.norm(out - along[:, None] * frame[0], axis=1), along)
        seen.append((angle.min(), angle.max()))
    return np.array(seen)


def _allowed(before: Order, lit: Sequence[Array]) -> Pairs:
    """Which numbers go together, by the order across the fan and by the angles at which each would be `lit`."""
    lines = len(lit[0])
    allowed = np.ones((len(before), lines, len(before), lines), dtype=np.bool_)
    number = np.arange(lines)
    i, j = np.nonzero(before)
    allowed[i, :, j, :] &= number[:, None] < number
    allowed[j, :, i, :] &= number[:, None] > number
    low, high = np.array(lit).transpose(2, 0, 1)
    common = np.minimum(high[:, None], high) - np.maximum(low[:, None], low)
    shorter = np.minimum((high - low)[:, None], high - low)
    shared = common > LEAST_SHARED * shorter  # (n, n, N)
    np.einsum("ikjk->ijk", allowed)[...] &= ~shared | np.eye(len(before), dtype=np.bool_)[:, :, None]
    return allowed


def _narrowed(options: Options, allowed: Pairs) -> Options:
    """Those of the `options` that leave every other centreline one, if it has any (arc consistency, Mackworth 1977)."""
    while True:
        goes = np.any(allowed & options, axis=3) | ~options.any(axis=1)
        left: Options = options & goes.all(axis=2)
        if np.array_equal(left, options):
            return left
        options = left


def _fixed(options: Options, allowed: Pairs, i: int, k: int) -> Options | None:
    """The options left once centreline `i` is of line `k`; None if that would leave another one without any."""
    chosen = options.copy()
    chosen[i] = np.arange(options.shape[1]) == k
    left = _narrowed(chosen, allowed)
    return left if np.array_equal(left.any(axis=1), options.any(axis=1)) else None


def _faces(rays: Sequence[Array], fan: Fan) -> tuple[Face, ...]:
    """Find all plane faces that two centrelines of different lines could lie on.

    Two lines in space seldom lie in one plane: hardly any wrong numbers make a face.
    """
    ends = np.array([r[[0, len(r) // 2, -1]] for r in rays])
    inverse_depth = np.einsum("nei,ki->nke", ends, fan.pis)
    faces = []
    for i, j in combinations(range(len(rays)), 2):
        both = np.concatenate([ends[i], ends[j]])
        fit = np.linalg.pinv(both)
        for k, m in permutations(range(fan.lines), 2):
            seen = np.concatenate([inverse_depth[i, k], inverse_depth[j, m]])
            if seen.min() <= 0 or np.abs(both @ (face := fit @ seen) / seen - 1).max() > ON_ONE_FACE:
                continue
            off = np.abs((ends @ face)[:, None] / np.where(inverse_depth > 0, inverse_depth, np.inf) - 1)
            faces.append(Face(((i, k), (j, m)), off.max(axis=2) < ON_ONE_FACE))
    return tuple(faces)


def _known(faces: Sequence[Face], numbers: Options) -> list[Options]:
    """Who is on each of the `faces` of which both centrelines have the numbers that make them one."""
    return [face.on for face in faces if numbers[face.of[0]] and numbers[face.of[1]]]


def _with_faces(options: Options, allowed: Pairs, faces: Sequence[Face]) -> Options:
    """Fix the centrelines that by just one of their options lie on one face with two whose numbers are sure."""
    while True:
        sure = options & (options.sum(axis=1) == 1)[:, None]
        known = _known(faces, sure)
        on = options & ~sure & np.any(known, axis=0) if known else np.zeros_like(options)
        left = options
        for i in np.flatnonzero(on.sum(axis=1) == 1).tolist():
            k = int(np.argmax(on[i]))
            fixed = _fixed(left, allowed, i, k) if left[i, k] else None
            left = left if fixed is None else fixed
        if np.array_equal(left, options):
            return left
        options = left


def _choose(rays: Sequence[Array], fan: Fan, kept: Array, allowed: Pairs, faces: tuple[Face, ...]) -> FanLines:
    """Fix the pieces that have one choice; then, longest first, the others by the depth nearest to those fixed."""
    depth = np.array([[median(r @ plane.pi) for plane in fan.planes] for r in rays])  # inverse depth, 1/mm
    centre = np.array([np.median(r, axis=0) for r in rays])
    options = sure = _with_faces(_narrowed((depth > 0) & (kept > 0)[:, None], allowed), allowed, faces)
    for i in sorted(np.flatnonzero(sure.sum(axis=1) > 1).tolist(), key=lambda i: -len(rays[i])):
        fixed = np.flatnonzero(options.sum(axis=1) == 1)
        if len(fixed):
            nearest = fixed[np.argsort(np.linalg.norm(centre[fixed] - centre[i], axis=1), kind="stable")[:3]]
            target = np.median(depth[nearest, np.argmax(options[nearest], axis=1)])
        else:
            target = np.median(depth[depth > 0])
        for k in sorted(np.flatnonzero(options[i]).tolist(), key=lambda k: abs(depth[i, k] - target)):
            if (left := _fixed(options, allowed, i, k)) is not None:
                options = left
                break
    return replace(_numbered(options, sure, kept), allowed=allowed, faces=faces)


def _numbered(options: Options, sure: Options, kept: Array) -> FanLines:
    """Number the centrelines that have one option left; the others get a reason."""
    count, lines = options.shape
    crowded = Message("scan.fan_light_crowded", "more than {n} stripes side by side: taken for a reflection", n=lines)
    none_fits = Message("scan.fan_light_fits_no_line", "no fan line fits between its neighbours")
    line, reason, choices = [], [], []
    for i in range(count):
        one = options[i].sum() == 1
        line.append(int(np.argmax(options[i])) if one else UNASSIGNED)
        reason.append(None if one else none_fits if kept[i] else crowded)
        choices.append(tuple(np.flatnonzero(sure[i]).tolist()) if one else (UNASSIGNED,))
    return FanLines(tuple(line), tuple(reason), tuple(choices))


def settle_by_sweeps(lines: FanLines, piece: Counts, rays: Array, inverse_depths: Array, fan: Fan) -> FanLines:
    """Decide by the sweeps' planes which line a centreline is where the order across the fan left a choice.

    `piece` (M,), `rays` (M, 3): crossings with the fan; `inverse_depths` (M,) what the sweeps' planes, solved without
    the unsure centrelines, say there. The line that comes nearest is taken if it is twice as near as any other, the
    clearest first, and as far as it goes with the lines beside; what is still open then is left out.
    """
    options = np.array([[k in choices for k in range(fan.lines)] for choices in lines.choices])
    clear: list[tuple[float, int, int]] = []
    for i, choices in enumerate(lines.choices):
        rows = piece == i
        if len(choices) < 2 or not rows.any():
            continue
        misfit = np.array([np.median(np.abs(rays[rows] @ fan.planes[k].pi - inverse_depths[rows])) for k in choices])
        best, second = np.argsort(misfit, kind="stable")[:2]
        if misfit[best] < _CLEARLY_NEARER * misfit[second]:
            clear.append((float(misfit[best] / misfit[second]), i, choices[best]))
    for _, i, k in sorted(clear):
        left = _fixed(options, lines.allowed, i, k) if options[i, k] else None
        options = options if left is None else left
    line, reason = list(lines.line), list(lines.reason)
    for i in np.flatnonzero(options.any(axis=1)).tolist():
        sure = options[i].sum() == 1
        line[i], reason[i] = (int(np.argmax(options[i])), None) if sure else (UNASSIGNED, AMBIGUOUS)
    return replace(lines, line=tuple(line), reason=tuple(reason))
