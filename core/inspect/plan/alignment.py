"""How a part's coordinates lie in the camera frame: by 3-2-1 from features, or by the best fit to a nominal surface.

The best fit moves the measured points onto the surface by least squares of their distances along its normals, nearest
place by nearest place, wrong points and those of other things losing their weight. It needs a start near the truth:
every side of the nominal part up, turned in steps about the upward direction, each tried with few points.

References
----------
Chen, Medioni, Object modelling by registration of multiple range images, Image and Vision Computing 10 (1992),
doi:10.1016/0262-8856(92)90066-C.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from core.errors import InputError
from core.inspect.fit.elements import Element
from core.messages import Message
from core.model import Pose
from core.model.arrays import Array
from core.model.directions import square_to
from core.model.robust import MAD_TO_SD, TUKEY, Schedule, Weigh, irls, mad_sd
from core.progress import Progress, silent
from core.scan.surface.triangles import ProximityQuery, Triangles

FRAME = Message("feature.where_frame", "frame")
NAME_OTHERS = Message("feature.advice_name_others", "name other features")

TURNS = 12
"""Starts about the upward direction."""
STAGES = ((150, 8, 12), (500, 20, 2), (2000, 40, 1))
"""Points, rounds, and how many of the poses go on to the next stage."""
FREE = 1e-6
"""Directions known less well than the best one by this share of information count as not known at all."""
FIRST_CUT, NARROWER = 0.04, 0.85
"""Points off by more than this share of the part's size have no weight at first, and ever closer ones then: small sides
that alone fix a direction must not lose theirs before they have moved the part."""
HELD = 0.02
"""A fit holds if the median distance left is less than this share of the part's size,"""
BETTER = 2.0
"""and one from a start that was given, unless another start leaves less than 1 / BETTER of its mean distance."""


def three_two_one(primary: Element, secondary: Element, tertiary: Element | None) -> Pose:
    """Compute the pose of part coordinates in the camera frame from three features by the 3-2-1 rule.

    Raises
    ------
    InputError
        If the primary feature is no plane, the secondary one a point or parallel to it, or the tertiary one parallel to
        either.
    """
    if primary.kind != "plane" or secondary.kind == "point":
        raise InputError(
            Message("feature.frame_kinds", "part coordinates rest on a plane, and on a second plane or an axis"),
            where=FRAME,
            todo=NAME_OTHERS,
        )
    z = primary.direction
    x = secondary.direction - z * (z @ secondary.direction)
    if np.linalg.norm(x) < np.sin(np.radians(5.0)):
        raise InputError(
            Message("feature.frame_one_direction", "primary and secondary feature point in one direction"),
            where=FRAME,
            todo=NAME_OTHERS,
        )
    x = x / np.linalg.norm(x)
    y = np.cross(z, x)
    on_secondary = secondary.direction if secondary.kind == "plane" else y
    remaining = y if secondary.kind == "plane" else x
    third, place = remaining, secondary.position if tertiary is None else tertiary.position
    if tertiary is not None and tertiary.kind == "plane":
        third = tertiary.direction
    rows = np.array([z, on_secondary, third])
    if abs(np.linalg.det(rows)) < 0.05:
        raise InputError(
            Message("feature.frame_third_direction", "the tertiary plane fixes no third direction"),
            where=FRAME,
            todo=Message("feature.advice_name_another", "name another one"),
        )
    asked = np.array([z @ primary.position, on_secondary @ secondary.position, third @ place])
    return Pose(np.column_stack([x, y, z]), np.linalg.solve(rows, asked))


def unfixed(secondary: Element, tertiary: Element | None) -> int | None:
    """Return the part coordinate, 0 or 1, whose origin no feature fixes in `three_two_one`; None if all are fixed."""
    if tertiary is not None:
        return None
    return 1 if secondary.kind == "plane" else 0


@dataclass(frozen=True, eq=False, slots=True)
class Aligned:
    """Pose of the nominal surface's coordinates in the camera frame, and the median distance in mm that is left."""

    pose_camera_nominal: Pose
    left_mm: float


def best_fit(
    points: Array, up: Array, query: ProximityQuery, progress: Progress = silent, near: Pose | None = None
) -> Aligned:
    """Align a nominal surface with measured points (N, 3) in mm by a best fit; return its pose and the median distance.

    Parameters
    ----------
    points
        (N, 3) in mm, camera frame, of the part and as little else as can be.
    up
        (3,) unit: about the direction the camera sees the part from, or that of the table it stands on.
    query
        The surface, made ready to be asked.
    progress
        Called with how far it is.
    near
        A pose of the nominal surface near the one looked for, of a part that lies about as before: where it leads to is
        taken unless another start leads to a clearly better fit, so that a part with alike sides is not turned.

    Raises
    ------
    InputError
        If no start leads to a fit: the part is another one, or seen too little of.
    """
    rng = np.random.default_rng(0)
    shuffled = points[rng.permutation(len(points))]
    poses = _starts(shuffled[: STAGES[0][0]], up, query.surface)
    done, total = 0, len(poses) + sum(kept for _, _, kept in STAGES)
    for count, rounds, kept in STAGES:
        sample = shuffled[:count]
        tried: list[tuple[float, int, Pose]] = []
        for start in poses:
            progress("alignment", done, total)
            done += 1
            pose, _ = _fitted(sample, start, query, rounds)
            tried.append((_left(sample, pose, query), len(tried), pose))
        poses = [pose for _, _, pose in sorted(tried, key=lambda one: one[:2])[:kept]]
    found = poses[0]
    if near is not None:
        nearby = _fitted(sample, near.inverse(), query, rounds)[0]
        if _left(sample, nearby, query) <= BETTER * _left(sample, found, query):
            found = nearby
    pose, left = _fitted(sample, found, query, rounds, exact=True)
    progress("alignment", total, total)
    if left > HELD * query.size_mm:
        raise InputError(
            Message(
                "feature.nominal_does_not_fit",
                "the nominal surface cannot be laid on the scan: half of the points stay {left_mm:.2f} mm and more off",
                left_mm=left,
            ),
            todo=Message(
                "feature.advice_check_nominal", "check that it is the file of this part, in mm, or align by features"
            ),
        )
    return Aligned(pose.inverse(), left)


def _starts(points: Array, up: Array, nominal: Triangles) -> list[Pose]:
    """Camera into nominal coordinates: each side up, turned about it, the visible tops and middles in one place."""
    corners = nominal.corners.reshape(-1, 3)
    basis = np.column_stack([square_to(up), up])
    if np.linalg.det(basis) < 0:
        basis = basis[:, [1, 0, 2]]
    starts = []
    for axis in (*np.eye(3), *-np.eye(3)):
        sides = np.column_stack([square_to(axis), axis])
        if np.linalg.det(sides) < 0:
            sides = sides[:, [1, 0, 2]]
        for turn in range(TURNS):
            rotation = sides @ Rotation.from_rotvec([0, 0, 2 * np.pi * turn / TURNS]).as_matrix() @ basis.T
            mine, whole = points @ rotation.T @ sides, corners @ sides
            low, high = np.quantile(mine, [0.02, 0.98], axis=0)
            shift = (whole.min(axis=0) + whole.max(axis=0)) / 2 - (low + high) / 2
            shift[2] = whole[:, 2].max() - high[2]  # the tops are seen for sure, the feet may not be
            starts.append(Pose(rotation, sides @ shift))
    return starts


def _fitted(
    points: Array, pose: Pose, query: ProximityQuery, rounds: int, *, exact: bool = False
) -> tuple[Pose, float]:
    """Iterated closest places: the pose into nominal coordinates, and the median of the distances left.

    `exact` is for a pose that is good already: nearest places without compromise, and no wide cut at first.
    """
    widest = 0.0 if exact else FIRST_CUT * query.size_mm

    def improve(found: tuple[Pose, float, bool], weigh: Weigh) -> tuple[Pose, float, bool]:
        pose = found[0]
        moved = pose.apply(points)
        near = query.nearest(moved, exact_within=0.0 if exact else -np.inf)
        scale = max(mad_sd(near.distance), 1e-6)
        away = moved - near.foot
        length = np.linalg.norm(away, axis=1)
        direction = np.where(length[:, None] > 1e-6, away / np.maximum(length, 1e-6)[:, None], near.normal)
        cut = max(TUKEY * scale, widest * NARROWER**weigh.round)
        weight = weigh(length, cut)
        middle = moved.mean(axis=0)
        arms = (moved - middle) / query.size_mm
        design = np.hstack([direction, np.cross(arms, direction)])
        scaled = design * weight[:, None]
        # What the points do not fix, as a shift along the one face that was scanned, stays as it is.
        step = -np.linalg.pinv(scaled.T @ design, rcond=FREE, hermitian=True) @ (scaled.T @ length)
        step[3:] /= query.size_mm
        turn = Rotation.from_rotvec(step[3:]).as_matrix()
        pose = Pose(turn, middle + step[:3] - turn @ middle) @ pose
        settled = np.abs(step[:3]).max() < 1e-5 and np.abs(step[3:]).max() < 1e-7
        return pose, scale, bool(settled and cut <= TUKEY * scale)

    by_cut = Schedule(rounds, huber=0, tukey_at=1.0)
    pose, scale, _ = irls((pose, np.inf, False), improve, by_cut, lambda _, now: now[2])
    return pose, scale / MAD_TO_SD


def _left(points: Array, pose: Pose, query: ProximityQuery) -> float:
    """Mean distance in mm of the points, those farther than the first cut counted as if they lay there."""
    away = np.abs(query.nearest(pose.apply(points), exact_within=-np.inf).distance)
    return float(np.minimum(away, FIRST_CUT * query.size_mm).mean())
