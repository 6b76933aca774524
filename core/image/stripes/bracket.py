"""Stripes seen in several exposures: where one is saturated, cross-sections of the next shorter one stand in its place.

Each picture's cross-sections are fitted by themselves, with that picture's own noise, so nothing depends on how a
camera's grey values go together from one exposure to the next, and no grey value is made up. A point is taken from the
longest picture that is not saturated there: that has the smallest noise. The pictures see the same light only if
nothing moved between them, and that is looked at first. Which one is longer is told by the whole picture's brightness,
and by how much, by the stripes' heights.

Of a sensor that blooms, a full pixel fills its neighbours, mostly those behind it in its column. That needs no mask of
its own: points whose sections have saturated pixels do not count, and those beside them were as sure as they say on
simulated stripes of a part that shines, up to 90 % of the overflow passed on (tests/scan/features/test_blooming.py).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.image.stripes.centreline import Centreline
from core.image.stripes.running_statistics import median
from core.model.arrays import Array, runs_of

MOVED_PX = 0.1
"""A short exposure whose stripes lie farther than this from where the long one has them is not used: half of the σ of
the points it would replace, and ten times what noise makes of a median along a stripe."""
_MOVED_BY_FLANKS_PX = 0.3
"""The same where the long one is saturated all along, and its stripes are known by their flanks alone."""
_ENOUGH = 20
"""Points, unsaturated in both, from which on these alone tell of a movement; and the shortest stretch that is taken."""
_HARDLY_ANY = 0.1
"""Share of the long exposure's points that are not saturated below which the short one alone is as good: then nothing
is mixed, and neither a movement nor what blooming does to the flanks matters."""
_SAME_WIDTHS = 2.0
"""Stripe σ, at least two px, between the two exposures' points of one stripe: beside a plateau the ridge is unsure."""
_SAME_COSINE = 0.9
"""Between the normals of the two."""
_NEW_WIDTHS = 4.0
"""Stripe σ from every point of the long exposure from which on a stripe is one that it does not show."""


@dataclass(frozen=True, eq=False, slots=True)
class Exposure:
    """Stripes of a picture, (H, W) where it is saturated, and its mean `light` as a share of full scale."""

    lines: Sequence[Centreline]
    saturated: NDArray[np.bool_]
    light: float


@dataclass(frozen=True, eq=False, slots=True)
class Exposures:
    """Comparison of another exposure of the same stripes with the first one.

    It is `factor` times shorter, below 1 if it is longer, nan where nothing tells; the stripes of the two are
    `shift_px` apart, and `points` were taken from it. None are if something `moved` between the two.
    """

    factor: float = float("nan")
    shift_px: float = 0.0
    points: int = 0
    moved: bool = False


def fused(first: Exposure, others: Sequence[Exposure]) -> tuple[tuple[Centreline, ...], tuple[Exposures, ...]]:
    """Merge the centrelines of several exposures, longest first; compare each of `others` with `first`.

    Heights are in grey levels of the first exposure. What moved between exposures is left out.
    """
    longest, *shorter = sorted((first, *others), key=lambda one: -one.light)
    lines, saturated = tuple(longest.lines), longest.saturated
    told = {longest: Exposures(1.0)}  # how many times shorter than the longest one in use
    for short in shorter:
        joined, both = bracketed(lines, short.lines, saturated)
        if both.moved and short is first:
            told = {one: Exposures(seen.factor / both.factor, both.shift_px, 0, True) for one, seen in told.items()}
            lines, told[short], longest = tuple(short.lines), Exposures(1.0), short
        else:
            lines, told[short] = joined, both
        if short is first or not both.moved:
            saturated = short.saturated
    of_longest = sum(map(len, lines)) - sum(told[one].points for one in shorter)
    told[longest] = replace(told[longest], points=max(of_longest, 0))
    unit = told[first].factor
    if np.isfinite(unit) and unit != 1:
        lines = tuple(replace(line, strength=line.strength / unit) for line in lines)
    return lines, tuple(replace(told[one], factor=told[one].factor / unit) for one in others)


def bracketed(
    long: Sequence[Centreline], short: Sequence[Centreline], saturated: NDArray[np.bool_]
) -> tuple[tuple[Centreline, ...], Exposures]:
    """Replace saturated points of the `long` exposure's centrelines by the `short` one's; also compare both.

    The centrelines come longest first. Heights are in grey levels of the long exposure, against which the short one is
    told.

    Parameters
    ----------
    long, short
        The centrelines of either picture.
    saturated
        (H, W) True where the long picture is saturated.
    """
    if not short:
        return tuple(long), Exposures()
    if not long:
        return tuple(short), Exposures(points=sum(map(len, short)))
    both = _compared(long, short)
    scale = both.factor if np.isfinite(both.factor) else 1.0
    clear = sum(int(np.count_nonzero(~line.saturated)) for line in long)
    if clear < _HARDLY_ANY * sum(map(len, long)):
        alone = tuple(replace(one, strength=scale * one.strength) for one in short)
        return alone, Exposures(both.factor, 0.0, sum(map(len, alone)))
    if both.moved:
        return tuple(long), both
    # what is left of a movement is in the points' σ
    scaled = [replace(one, strength=scale * one.strength, sigma=np.hypot(one.sigma, both.shift_px)) for one in short]
    mended = [_mended(line, scaled) for line in long]
    added = tuple(_not_seen(long, scaled, saturated))
    lines = (*(line for line, _ in mended), *added)
    points = sum(taken for _, taken in mended) + sum(map(len, added))
    return tuple(sorted(lines, key=len, reverse=True)), replace(both, points=points)


def _compared(long: Sequence[Centreline], short: Sequence[Centreline]) -> Exposures:
    """What the points of the stripes that both exposures show tell of the two."""
    uv, normal = (np.vstack([getattr(line, name) for line in short]) for name in ("uv", "normal"))
    strength = np.concatenate([line.strength for line in short])
    clear_of_short = np.concatenate([~line.saturated for line in short])
    tree = cKDTree(uv)
    shifts: dict[bool, list[tuple[int, float]]] = {True: [], False: []}  # by whether the long one is clear there
    ratios: dict[bool, list[Array]] = {True: [np.zeros(0)], False: [np.zeros(0)]}
    for line in long:
        near = np.atleast_1d(tree.query(line.uv)[1])
        apart = uv[near] - line.uv
        across, along = (apart * line.normal).sum(axis=1), np.abs((apart * line.tangent).sum(axis=1))
        same = (np.abs(across) < _reach(line)) & (along < 1) & clear_of_short[near]
        same &= np.abs((normal[near] * line.normal).sum(axis=1)) > _SAME_COSINE
        for clear in (True, False):
            chosen = same & (line.saturated != clear)
            ratios[clear].append(line.strength[chosen] / strength[near[chosen]])
            if (count := int(np.count_nonzero(chosen))) >= _ENOUGH:
                shifts[clear].append((count, median(across[chosen])))
    known = {clear: np.concatenate(found) for clear, found in ratios.items()}
    best = known[len(known[True]) >= _ENOUGH]
    clear = bool(shifts[True])
    counts, medians = np.array(shifts[clear]).reshape(-1, 2).T
    apart_px = float(np.sqrt(np.average(medians**2, weights=counts))) if len(counts) else 0.0
    factor = float(median(best)) if len(best) else float("nan")
    return Exposures(factor, apart_px, 0, apart_px > (MOVED_PX if clear else _MOVED_BY_FLANKS_PX))


def _reach(line: Centreline) -> Array:
    """How far from each point (N,) the same stripe may be in the other picture, in px."""
    reach: Array = np.maximum(_SAME_WIDTHS * line.width, 2.0)
    return reach


def _mended(line: Centreline, short: Sequence[Centreline]) -> tuple[Centreline, int]:
    """A centreline of the long exposure with the points of the short one where it is saturated, and how many."""
    stretches = runs_of(line.saturated)
    if not stretches:
        return line, 0
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line.uv, axis=0).T))])
    tree = cKDTree(line.uv)
    parts: list[tuple[int, int, Centreline]] = []  # points of the line that a part replaces, and the part
    for other in short:
        _, near = tree.query(other.uv)
        apart = other.uv - line.uv[near]
        place = arc[near] + (apart * line.tangent[near]).sum(axis=1)
        here = np.abs((apart * line.normal[near]).sum(axis=1)) < _reach(line)[near]
        here &= np.abs((other.normal * line.normal[near]).sum(axis=1)) > _SAME_COSINE
        for begin, end in stretches:
            first = arc[begin - 1] + 0.5 if begin else -np.inf
            last = arc[end] - 0.5 if end < len(arc) else np.inf
            inside = here & (place > first) & (place < last)
            for a, b in runs_of(inside):
                piece, at = other.select(slice(a, b)), place[a:b]
                if at[-1] < at[0]:
                    piece, at = _reversed(piece), at[::-1]
                replaced = np.flatnonzero((arc >= at[0] - 0.5) & (arc <= at[-1] + 0.5) & line.saturated)
                replaced = replaced[(replaced >= begin) & (replaced < end)]
                if len(replaced) and np.all(np.diff(at) > 0):
                    parts.append((int(replaced[0]), int(replaced[-1]) + 1, piece))
    parts.sort(key=lambda part: part[:2])
    kept, done, taken = [], 0, 0
    for begin, end, piece in parts:
        if begin < done:
            continue  # two stripes of the short exposure on one stretch: the first is as good
        kept += [line.select(slice(done, begin)), piece]
        taken += len(piece)
        done = end
    return (_joined([*kept, line.select(slice(done, len(line)))]) if taken else line), taken


def _not_seen(
    long: Sequence[Centreline], short: Sequence[Centreline], saturated: NDArray[np.bool_]
) -> Iterator[Centreline]:
    """Stretches of the short exposure's stripes where the long one is saturated and shows no stripe at all."""
    tree = cKDTree(np.vstack([line.uv for line in long])) if long else None
    height, width = saturated.shape
    for line in short:
        u, v = np.rint(line.uv).astype(int).T
        new = saturated[np.clip(v, 0, height - 1), np.clip(u, 0, width - 1)]
        if tree is not None:
            new &= tree.query(line.uv)[0] > np.maximum(_NEW_WIDTHS * line.width, 2.0)
        yield from (line.select(slice(a, b)) for a, b in runs_of(new) if b - a >= _ENOUGH)


def _reversed(line: Centreline) -> Centreline:
    turned = line.select(np.arange(len(line))[::-1])
    return replace(turned, normal=-turned.normal, skewness=-turned.skewness)


def _joined(parts: Sequence[Centreline]) -> Centreline:
    """Pieces of one stripe, one behind the other, as one."""
    names = ("uv", "normal", "width", "strength", "sigma", "saturated", "skewness")
    values = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    return Centreline(**values, correlation_px=max(part.correlation_px for part in parts))
