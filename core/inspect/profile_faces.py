"""Two parallel faces on light profiles: the straight stretches of each line's profile, and which lie on one level.

A profile is what one line of the fan lights of a part, in one picture. A plane face cuts its light plane in a straight
line, so faces are straight stretches; two stretches of different lines that lie in one plane say how it is tilted. With
one line alone nothing says that, and the normal must come from elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from core.inspect.faces import FacePair
from core.model.arrays import Array
from core.scan.surface.cloud import FAN, Cloud

# Held by tests/inspect/test_step_height.py on exact profiles and by tests/accuracy/test_profile.py on rendered ones.
GAP_PX = 3.0
"""Points of one line farther apart than this lie on two stretches: points are a pixel apart."""
SHORTEST_MM = 4.0
"""A stretch has at least this length: shorter ones are chamfers and light at edges."""
MARGIN_MM, MARGIN_SHARE = 1.5, 0.2
"""Left out at either end of a stretch, in mm, but no more than this share of it: stripes are biased at edges."""
STRAIGHT_SIGMAS, STRAIGHT_MM = 5.0, 0.05
"""A stretch is straight if no point is farther off than so many standard uncertainties, or this many mm."""
ARC_SIGMAS, ARC_MM = 2.0, 0.02
"""A stretch whose ends bend away from its middle by more than so many uncertainties of a point, or this many mm, is no
face; what is less is a face's form."""
PARALLEL = float(np.radians(2.0))
"""Stretches lie on parallel faces within this angle."""
LEVEL_SIGMAS, LEVEL_MM = 5.0, 0.1
"""Stretches are on one level if their heights differ by less than so many uncertainties of a point, or this many mm."""


@dataclass(frozen=True, eq=False, slots=True)
class Stretch:
    """Straight piece of one line's profile, less its margins.

    `line` from 0; `indices` (N,) into the cloud, in order along it; `centre` (3,) in mm, `along` (3,) unit direction,
    `length_mm`.
    """

    line: int
    indices: NDArray[np.int64]
    centre: Array
    along: Array
    length_mm: float


def stretches(cloud: Cloud, correlation_px: float = 8.0) -> tuple[Stretch, ...]:
    """Find the straight pieces of the light profiles in one picture's `cloud`, in order along each laser line.

    `correlation_px` is the length along a line over which its noise counts as one.
    """
    limit = _limit(cloud, STRAIGHT_SIGMAS, STRAIGHT_MM)
    found = []
    for line in range(int(FAN - cloud.sweep.min(initial=FAN)) + 1):
        mine = np.flatnonzero(cloud.sweep == FAN - line)
        apart = np.linalg.norm(np.diff(cloud.uv[mine], axis=0), axis=1) > GAP_PX
        for piece in np.split(mine, np.flatnonzero(apart) + 1):
            runs = _straight(cloud.points, piece, limit)
            found += [_stretch(cloud, line, run) for run in runs if not _bent(cloud, run, correlation_px)]
    return tuple(found)


def faces_of(cloud: Cloud, found: Sequence[Stretch], normal: Array | None) -> FacePair | None:
    """Choose the upper and the lower face: the two longest levels seen on common laser lines; None if there are no two.

    Parameters
    ----------
    cloud
        Of one picture.
    found
        Its straight stretches.
    normal
        (3,) normal of the faces where it is known, away from the camera; None: that of any two stretches of different
        lines is tried.
    """
    limit = level_limit(cloud)
    if normal is not None:
        return _pair(next(iter(_apart(found, normal, limit)), None))
    tried = [levels for one in _normals(found) for levels in _two_levels(found, one, limit)]
    for levels in sorted(tried, key=lambda levels: -_common_length(*levels)):
        # Short stretches tell a tilt badly; both levels together tell it well, and then hold all that lies in them.
        for _ in range(_REFINED):
            better = next(iter(_apart(found, _common_normal(levels), limit)), None)
            if better is None:
                break
            levels = better
        else:
            return _pair(levels)
    return None


_REFINED = 2
"""Times that levels and their common normal are found from each other."""

_TwoLevels = tuple[list[Stretch], list[Stretch]]
"""The stretches of the upper face, and of the lower one."""


def _pair(levels: _TwoLevels | None) -> FacePair | None:
    if levels is None:
        return None
    upper, lower = (np.concatenate([one.indices for one in level]) for level in levels)
    return FacePair(upper, lower)


def _apart(found: Sequence[Stretch], normal: Array, limit: float) -> list[_TwoLevels]:
    """Two levels that are a step apart along the normal, those longest on common lines first."""
    pairs = [
        (upper, lower)
        for upper, lower in _two_levels(found, normal, limit)
        if _height(lower, normal) - _height(upper, normal) > 2 * limit
    ]
    return sorted(pairs, key=lambda levels: -_common_length(*levels))


def _two_levels(found: Sequence[Stretch], normal: Array, limit: float) -> list[_TwoLevels]:
    pairs = combinations(_levels(found, normal, limit), 2)
    return [(upper, lower) for upper, lower in pairs if _common_length(upper, lower) > 0]


def _height(level: Sequence[Stretch], normal: Array) -> float:
    lengths = np.array([one.length_mm for one in level])
    return float(lengths @ [float(one.centre @ normal) for one in level] / lengths.sum())


def _common_normal(levels: _TwoLevels) -> Array:
    """The normal, away from the camera, of two parallel planes through stretches that are uniform in density."""
    scatter = np.zeros((3, 3))
    for level in levels:
        lengths = np.array([one.length_mm for one in level])
        centres = np.array([one.centre for one in level])
        off = centres - lengths @ centres / lengths.sum()
        scatter += (off * lengths[:, None]).T @ off
        scatter += sum(one.length_mm**3 / 12 * np.outer(one.along, one.along) for one in level)
    normal = np.linalg.eigh(scatter)[1][:, 0]
    return np.asarray(normal if normal @ levels[0][0].centre > 0 else -normal, dtype=np.float64)


def level_limit(cloud: Cloud) -> float:
    """Compute the largest difference in mm between the heights of stretches that count as one level."""
    return _limit(cloud, LEVEL_SIGMAS, LEVEL_MM)


def _limit(cloud: Cloud, sigmas: float, least_mm: float) -> float:
    return max(least_mm, sigmas * float(np.median(cloud.sigma))) if len(cloud) else least_mm


def _straight(points: Array, run: NDArray[np.int64], limit: float) -> Iterator[NDArray[np.int64]]:
    """Cut a run of points where it bends or steps (Douglas, Peucker 1973), until each part is straight."""
    if len(run) < 4 or float(np.linalg.norm(points[run[-1]] - points[run[0]])) < SHORTEST_MM:
        return
    mine = points[run]
    centre, along = _line(mine)
    off = np.linalg.norm(mine - centre - np.outer((mine - centre) @ along, along), axis=1)
    if off.max() <= limit:
        yield run
        return
    chord = mine[-1] - mine[0]
    chord = chord / np.linalg.norm(chord)
    bow = np.linalg.norm(mine - mine[0] - np.outer((mine - mine[0]) @ chord, chord), axis=1)
    at = int(np.clip(np.argmax(bow), 2, len(run) - 2))
    yield from _straight(points, run[:at], limit)
    yield from _straight(points, run[at:], limit)


def _bent(cloud: Cloud, run: NDArray[np.int64], correlation_px: float) -> bool:
    """Whether a run is an arc: short ones of a curved surface are straight within the noise of a single point."""
    points = cloud.points[run]
    centre, along = _line(points)
    position = (points - centre) @ along
    off = points - centre - np.outer(position, along)
    across = np.linalg.svd(off, full_matrices=False)[2][0]
    height = off @ across
    arc = (position / np.abs(position).max()) ** 2
    arc -= arc.mean()
    size = float(arc @ height / (arc @ arc))
    rest = height - size * arc
    sd = float(np.std(rest)) * np.sqrt(max(correlation_px, 1.0) / float(arc @ arc))
    least = max(ARC_SIGMAS * float(np.median(cloud.sigma[run])), ARC_MM)
    return bool(abs(size) > max(_ARC_CLEAR * sd, least))


_ARC_CLEAR = 5.0
"""Standard deviations from which on an arc is no chance."""


def _line(points: Array) -> tuple[Array, Array]:
    centre = points.mean(axis=0)
    along = np.linalg.svd(points - centre, full_matrices=False)[2][0]
    return centre, along if along @ (points[-1] - points[0]) > 0 else -along


def _stretch(cloud: Cloud, line: int, run: NDArray[np.int64]) -> Stretch:
    centre, along = _line(cloud.points[run])
    position = (cloud.points[run] - centre) @ along
    low, high = float(position.min()), float(position.max())
    margin = min(MARGIN_MM, MARGIN_SHARE * (high - low))
    kept = run[(position >= low + margin) & (position <= high - margin)]
    return Stretch(line, kept, cloud.points[kept].mean(axis=0), along, high - low - 2 * margin)


def _normals(found: Sequence[Stretch]) -> Iterator[Array]:
    """The normals, away from the camera, of all planes through two parallel stretches of different lines."""
    for one, other in combinations(found, 2):
        if one.line != other.line and abs(float(one.along @ other.along)) > np.cos(PARALLEL):
            along = one.along + np.copysign(1.0, one.along @ other.along) * other.along
            normal = np.cross(along, other.centre - one.centre)
            size = float(np.linalg.norm(normal))
            if size > 0:
                yield normal / size if normal @ one.centre > 0 else -normal / size


def _levels(found: Sequence[Stretch], normal: Array, limit: float) -> list[list[Stretch]]:
    """Stretches that lie in planes of this normal, by their planes, the nearest to the camera first."""
    lying = [one for one in found if abs(float(one.along @ normal)) < np.sin(PARALLEL)]
    lying.sort(key=lambda one: float(one.centre @ normal))
    levels: list[list[Stretch]] = []
    for one in lying:
        if levels and float((one.centre - levels[-1][-1].centre) @ normal) < limit:
            levels[-1].append(one)
        else:
            levels.append([one])
    return levels


def _common_length(upper: Sequence[Stretch], lower: Sequence[Stretch]) -> float:
    """The shorter of both levels' lengths in mm on the lines that have both; 0 if there is none."""
    common = {one.line for one in upper} & {one.line for one in lower}
    of_levels = [sum(one.length_mm for one in level if one.line in common) for level in (upper, lower)]
    return min(of_levels)
