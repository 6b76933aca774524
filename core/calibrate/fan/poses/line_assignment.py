"""Which stripe belongs to which line of the fan: the light planes that most poses agree on.

Two stripes on two poses of the target suggest a light plane: π·r = τ·r at their rays r, where τ is the plane of the
target in the same inverse-depth form. The true planes find a stripe in nearly every pose; a wrong pairing, a stripe
on the table behind the target or the edge of a mark finds none elsewhere. So nobody has to say which stripe is
which, and a pose may show only some of them.

The plane of nearly parallel targets themselves goes through every stripe on them, whatever drew it: a suggestion gains
nothing by poses whose target it nearly is. How far poses may disagree is not known beforehand: where some poses agree
with no plane, wider tolerances are tried, and the one is kept whose agreement chance explains least.

References
----------
Moisan, L. & Stival, B., A probabilistic criterion to detect rigid point matches, Int. J. Computer Vision 57 (2004)
201–218, doi:10.1023/B:VISI.0000013094.38752.54.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.calibrate.fan.poses.stripe_lines import StripeLine
from core.model.arrays import Array

NOT_SEEN = -1
"""In an assignment: this pose does not show this line."""

MIN_TOLERANCE, MAX_TOLERANCE = 0.003, 0.01
"""How far a stripe may be off a suggested plane along its ray, as a share of its depth: at least and at most."""
WIDER = (1.0, 2.0, 4.0, 8.0)
"""Factors on the tolerance that are tried where poses disagree."""
REACH = 2.0
"""Of the wider tolerance in the end: a bound within the scatter would keep the middle of it only."""
SURE = -2.0
"""log₁₀ of the most often that chance may make a plane of a wider tolerance."""
LEAST_ANGLE = np.deg2rad(10.0)
"""A light plane that meets a target at a flatter angle cannot be told from the target's own plane there."""
LIKELIEST = 0.9
"""Bound on the probability that a pose agrees by chance."""
PAIRS = 20_000
"""Pairs of stripes tried at most, drawn by chance where there are more: of 12 stripes a pose one in 144 is of a given
line, which still makes more than a hundred true pairs."""
KEPT = 60
"""Suggested planes compared with each other in the end."""
VARIANT = 0.9
"""A suggested plane that shares more of its stripes than this with a better one is the same plane."""
ANGLE_PENALTY = 1.0
"""Poses that two planes must win back when the angle between them is not a multiple of the fan's."""


@dataclass(frozen=True, eq=False, slots=True)
class PoseLines:
    """Straight stripes of one pose, and the plane they lie on.

    `target` (3,) is τ in 1/mm with τ·X = 1 on the target, `covariance` (3, 3) its covariance, `points` (N, 3) rays of
    the target's points.
    """

    lines: tuple[StripeLine, ...]
    target: Array
    covariance: Array
    points: Array


@dataclass(frozen=True, eq=False, slots=True)
class Assignment:
    """Stripe of each fan line: `which` (N, P), its index in pose p or NOT_SEEN; `pis` (N, 3) roughly, in 1/mm."""

    which: NDArray[np.intp]
    pis: Array


def assign_lines(
    poses: Sequence[PoseLines], lines: int, angle: float | None, wider: Sequence[float] = WIDER
) -> Assignment:
    """Find the `lines` light planes that explain the stripes of most poses, and which plane drew each stripe.

    Parameters
    ----------
    poses
        P poses; some may have no stripe, or more than the fan drew.
    lines
        How many light planes are looked for.
    angle
        In rad between neighbouring planes, if known: used where the poses alone leave a doubt.
    wider
        Factors on the tolerance; the further ones are for poses that disagree.

    Returns
    -------
    The planes found, in order across the fan (from the top of the picture, or from the left where stripes are
    steep); fewer than `lines` if no more are seen in enough poses.
    """
    best, least, chosen = _nothing(len(poses)), 0.0, wider[0]
    shown = np.array([len(pose.lines) > 0 for pose in poses])
    for factor in wider:
        found = _assigned(_Candidates(poses, factor), lines, angle)
        chance = _log_chance(found, poses, factor)
        surely = factor == wider[0] or bool((chance < SURE).all())
        more = len(found.pis) - len(best.pis)
        if surely and (more > 0 or (more == 0 and chance.sum() < least)):
            best, least, chosen = found, float(chance.sum()), factor
        if len(found.pis) == lines and (found.which != NOT_SEEN).any(axis=0)[shown].all():
            break
    return best if chosen == wider[0] else _completed(best, _Candidates(poses, REACH * chosen))


def _completed(found: Assignment, candidates: _Candidates) -> Assignment:
    """With the stripes that are nearest to the same planes within the tolerance of `candidates`."""
    nearest = np.array(
        [candidates.index_in_pose(own) for own in candidates.best_in_pose(candidates.scores(found.pis))[0]]
    )
    which = found.which.copy()
    for line, pose in zip(*np.nonzero((which == NOT_SEEN) & (nearest != NOT_SEEN)), strict=True):
        if nearest[line, pose] not in which[:, pose]:
            which[line, pose] = nearest[line, pose]
    return Assignment(which, found.pis)


def _assigned(candidates: _Candidates, lines: int, angle: float | None) -> Assignment:
    """The planes found within one tolerance."""
    if candidates.count == 0:
        return _nothing(candidates.poses)
    suggestions = _suggest(candidates, lines)
    best = _best_set(candidates, suggestions, lines, angle)
    if not best:
        return _nothing(candidates.poses)
    ordered = _in_order(candidates, best)
    return Assignment(
        np.array([candidates.index_in_pose(s.stripes) for s in ordered]), np.array([s.pi for s in ordered])
    )


def _log_chance(found: Assignment, poses: Sequence[PoseLines], wider: float) -> Array:
    """(N,) log₁₀ of how often stripes anywhere on the targets would agree with a plane as well as these, by chance."""
    shown = np.array([len(pose.lines) > 0 for pose in poses])
    found_so = []
    for pi, which in zip(found.pis, found.which, strict=True):
        agreeing = np.flatnonzero(which != NOT_SEEN)
        total = math.log10(math.comb(int(shown.sum()), len(agreeing)))
        for pose in (poses[int(index)] for index in agreeing):
            inverse_depth = pose.points @ pose.target
            reach = float(np.ptp((pose.points @ pi) / inverse_depth))
            tolerance = wider * _tolerance(pose.points.mean(axis=0)[None], pose.target, pose.covariance)[0]
            chance = len(pose.lines) * 2 * tolerance / max(reach * float(inverse_depth.mean()), 1e-12)
            total += math.log10(min(chance, LIKELIEST))
        found_so.append(total)
    return np.array(found_so)


def _tolerance(rays: Array, target: Array, covariance: Array) -> Array:
    """How far in 1/mm stripes of `rays` (..., 3) on a target may be off a plane: (...)."""
    inverse_depth = np.einsum("...j,...j->...", rays, target)
    sd = np.sqrt(np.maximum(np.einsum("...j,...jk,...k->...", rays, covariance, rays), 0.0))
    # as much again for the poses that suggested the plane
    return np.asarray(np.clip(6 * sd / inverse_depth, MIN_TOLERANCE, MAX_TOLERANCE) * inverse_depth, dtype=np.float64)


def _nothing(poses: int) -> Assignment:
    return Assignment(np.zeros((0, poses), dtype=np.intp), np.zeros((0, 3)))


@dataclass(frozen=True, eq=False, slots=True)
class _Suggestion:
    """A light plane, the stripe (over all poses) it finds in each pose or NOT_SEEN, and how well: 0 … 1 per pose."""

    pi: Array
    stripes: NDArray[np.intp]
    score: float

    @property
    def seen(self) -> int:
        return int((self.stripes != NOT_SEEN).sum())


class _Candidates:
    """All stripes of all poses as equations π·r = 1/z at two rays each, with tolerances `wider` than usual."""

    def __init__(self, poses: Sequence[PoseLines], wider: float) -> None:
        self.pose = np.repeat(np.arange(len(poses)), [len(p.lines) for p in poses])
        self.first = np.concatenate([[0], np.cumsum([len(p.lines) for p in poses])[:-1]]).astype(np.intp)
        self.poses = len(poses)
        self.count = len(self.pose)
        stripes = [line for p in poses for line in p.lines]
        self.rays = np.array([line.pivots for line in stripes]).reshape(-1, 2, 3)
        self.points = np.array([len(line) for line in stripes], dtype=np.float64)
        self.across = np.array([line.across for line in stripes]).reshape(-1, 2)
        target = np.array([p.target for p in poses])[self.pose]
        covariance = np.array([p.covariance for p in poses])[self.pose]
        self.normal = target / np.maximum(np.linalg.norm(target, axis=1), 1e-300)[:, None]
        self.inverse_depth = np.einsum("sij,sj->si", self.rays, target)
        self.tolerance = wider * _tolerance(self.rays, target[:, None], covariance[:, None])

    def plane(self, stripes: NDArray[np.intp]) -> Array:
        """π (H, 3) nearest to sets of stripes (H, n) in the sense of inverse depths within their tolerances."""
        weight = 1 / self.tolerance[stripes]
        rays = (self.rays[stripes] * weight[..., None]).reshape(len(stripes), -1, 3)
        depth = (self.inverse_depth[stripes] * weight).reshape(len(stripes), -1, 1)
        transposed = rays.transpose(0, 2, 1)
        normal = transposed @ rays
        # stripes of one direction at one depth leave the plane open: the ridge gives such a plane no support
        normal += 1e-12 * np.trace(normal, axis1=1, axis2=2)[:, None, None] * np.eye(3)
        return np.asarray(np.linalg.solve(normal, transposed @ depth)[..., 0], dtype=np.float64)

    def scores(self, pis: Array) -> Array:
        """How well planes (H, 3) fit each stripe: (H, S), 1 exactly, 0 at the tolerance and beyond.

        0 as well where the plane nearly is the target the stripe lies on.
        """
        off = np.einsum("hj,sij->hsi", pis, self.rays, optimize=True) - self.inverse_depth
        worst: Array = np.abs(off / self.tolerance).max(axis=2)
        cosine = np.abs(pis @ self.normal.T) / np.linalg.norm(pis, axis=1)[:, None]
        scores = np.where(cosine > np.cos(LEAST_ANGLE), 0.0, np.maximum(1 - worst**2, 0.0))
        return np.asarray(scores, dtype=np.float64)

    def best_in_pose(self, scores: Array) -> tuple[NDArray[np.intp], Array]:
        """For scores (H, S) the best stripe of each pose (H, P), or NOT_SEEN, and its score (H, P)."""
        stripes = np.full((len(scores), self.poses), NOT_SEEN, dtype=np.intp)
        best = np.zeros((len(scores), self.poses))
        for pose in range(self.poses):
            own = np.flatnonzero(self.pose == pose)
            if len(own):
                winner = scores[:, own].argmax(axis=1)
                best[:, pose] = scores[np.arange(len(scores)), own[winner]]
                stripes[:, pose] = np.where(best[:, pose] > 0, own[winner], NOT_SEEN)
        return stripes, best

    def index_in_pose(self, stripes: NDArray[np.intp]) -> NDArray[np.intp]:
        """Indices within their own pose of one stripe per pose (P,)."""
        return np.where(stripes == NOT_SEEN, NOT_SEEN, stripes - self.first)


def _suggest(candidates: _Candidates, lines: int) -> list[_Suggestion]:
    """Planes through two stripes of different poses, fitted again to all stripes they find; the best KEPT."""
    first, second = np.triu_indices(candidates.count, 1)
    apart = candidates.pose[first] != candidates.pose[second]
    pairs = np.column_stack([first[apart], second[apart]])
    if len(pairs) > PAIRS:
        pairs = pairs[np.random.default_rng(0).choice(len(pairs), PAIRS, replace=False)]
    found: dict[bytes, _Suggestion] = {}
    for start in range(0, len(pairs), 4096):
        block = pairs[start : start + 4096]
        scores = candidates.scores(candidates.plane(block))
        own = np.minimum(*(scores[np.arange(len(block)), block[:, side]] for side in (0, 1)))
        stripes, best = candidates.best_in_pose(scores[own > 0])
        stripes = stripes[np.argsort(-best.sum(axis=1))]
        for chosen in stripes[_distinct(stripes, KEPT * lines)]:
            if chosen.tobytes() not in found:
                found[chosen.tobytes()] = _refined(candidates, chosen)
    unique = {suggestion.stripes.tobytes(): suggestion for suggestion in found.values()}
    ranked = sorted(unique.values(), key=lambda suggestion: -suggestion.score)
    return [ranked[index] for index in _distinct(np.array([own.stripes for own in ranked]), KEPT)] if ranked else []


def _distinct(stripes: NDArray[np.intp], most: int) -> list[int]:
    """Indices of at most `most` of sets of stripes (H, P), best first, none nearly all of whose stripes a better has.

    Of many poses the variants of one plane are legion, and would leave no room for the others.
    """
    kept: list[int] = []
    for index, own in enumerate(stripes):
        if len(kept) == most:
            break
        shown = own != NOT_SEEN
        same = np.count_nonzero((stripes[kept] == own) & shown, axis=1)
        if not len(kept) or same.max() <= VARIANT * np.count_nonzero(shown):
            kept.append(index)
    return kept


def _refined(candidates: _Candidates, stripes: NDArray[np.intp]) -> _Suggestion:
    """The plane through all the stripes a suggestion found, and what it finds then."""
    pi, score = candidates.plane(stripes[None, stripes != NOT_SEEN])[0], 0.0
    for _ in range(3):
        found, best = candidates.best_in_pose(candidates.scores(pi[None]))
        settled = np.array_equal(found[0], stripes)
        stripes, score = found[0], float(best.sum())
        if settled or (stripes != NOT_SEEN).sum() < 2:
            break
        pi = candidates.plane(stripes[None, stripes != NOT_SEEN])[0]
    return _Suggestion(pi, stripes, score)


def _best_set(
    candidates: _Candidates, suggestions: list[_Suggestion], lines: int, angle: float | None
) -> list[_Suggestion]:
    """At most `lines` suggestions that can be true together and explain most, found by branch and bound."""
    with_stripes = len(np.unique(candidates.pose))
    enough = 2 if with_stripes < 4 else 3
    usable = [s for s in suggestions if s.seen >= enough]
    penalty = np.array([[_conflict(candidates, a, b, lines, angle) for b in usable] for a in usable])
    best: tuple[float, list[int]] = (0.0, [])

    def extend(chosen: list[int], value: float, start: int) -> None:
        nonlocal best
        if value > best[0]:
            best = (value, chosen)
        if len(chosen) == lines:
            return
        for index in range(start, len(usable)):
            if value + usable[index].score * (lines - len(chosen)) <= best[0]:
                return  # sorted by score: no later one can do better
            cost = penalty[index, chosen].sum()
            if np.isfinite(cost):
                extend([*chosen, index], value + usable[index].score - cost, index + 1)

    extend([], 0.0, 0)
    return [usable[index] for index in best[1]]


def _conflict(candidates: _Candidates, a: _Suggestion, b: _Suggestion, lines: int, angle: float | None) -> float:
    """Infinite if two planes cannot both be true, a penalty if the fan's angle speaks against it, else 0."""
    both = (a.stripes != NOT_SEEN) & (b.stripes != NOT_SEEN)
    if np.any(a.stripes[both] == b.stripes[both]):
        return np.inf
    sides = _side(candidates, a.stripes[both], b.stripes[both])
    if len(sides) and np.abs(sides.sum()) < len(sides):
        return np.inf  # the lines of a fan never change their order
    if angle is None:
        return 0.0
    sine = float(np.linalg.norm(np.cross(a.pi, b.pi)) / (np.linalg.norm(a.pi) * np.linalg.norm(b.pi)))
    between = float(np.arcsin(min(sine, 1.0)))
    multiple = min(max(round(between / angle), 1), max(lines - 1, 1))
    return 0.0 if abs(between - multiple * angle) < 0.3 * angle else ANGLE_PENALTY


def _side(candidates: _Candidates, a: NDArray[np.intp], b: NDArray[np.intp]) -> Array:
    """+1 where stripe b lies below stripe a in the picture (to its right where steep), −1 above: (n,)."""
    across = candidates.across[a]
    steep = np.abs(across[:, 0]) > np.abs(across[:, 1])
    across = across * np.sign(np.where(steep, across[:, 0], across[:, 1]))[:, None]
    middle = candidates.rays[:, :, :2].mean(axis=1)
    return np.asarray(np.sign(np.einsum("ni,ni->n", middle[b] - middle[a], across)), dtype=np.float64)


def _in_order(candidates: _Candidates, chosen: list[_Suggestion]) -> list[_Suggestion]:
    """Sorted across the fan by where the planes are met on a typical target."""
    stripes = np.concatenate([s.stripes[s.stripes != NOT_SEEN] for s in chosen])
    steep, flat = np.abs(candidates.across[stripes]).mean(axis=0)
    axis = 0 if steep > flat else 1
    rays = candidates.rays[stripes].mean(axis=(0, 1))
    depth = float(np.median(1 / candidates.inverse_depth[stripes]))
    other = 1 - axis

    def position(suggestion: _Suggestion) -> float:
        pi = suggestion.pi
        return float((1 / depth - pi[2] - pi[other] * rays[other]) / pi[axis])

    return sorted(chosen, key=position)
