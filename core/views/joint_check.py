"""What speaks against a joint: its marks, its single marks, the surfaces that two views share.

Each is a number with its uncertainty first; which of them takes away a proof is said by the table of findings.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.findings.proof import Doubt, Doubts
from core.findings.table import note_of
from core.image.targets.pose import cross_matrices
from core.messages import Message
from core.model import Camera
from core.model.arrays import Array
from core.model.robust import huber_weights
from core.views.carrier import FEWEST_MARKS
from core.views.joined_cloud import JoinedCloud
from core.views.joint import MARKS_HUBER, Joint

CHANCE = 1e-4
"""Chance of a false alarm that is taken, by each test of one joint."""
MARKS_CHANCE = 1e-3
"""The same of the marks' residuals: a tilt hides most of what half the marks of a side are off together."""
MOST_LEFT_OUT = 0.25
"""Share of a view's marks that may be left out: beyond it, which of them are wrong is a guess."""
NEAR_MM, ALONG, REACH = 1.0, 0.8, 0.05
"""Points of two views are on one surface if they are this near along it, their normals' cosine is at least this, and
it is no farther off than this share of what the first view shows."""
WALL = 3.0
"""A surface that looks the other way is the far side of a wall if it lies behind by so many times the points' σ."""
SLIP_MM, SLIP_TIMES = 10.0, 2.0
"""How far a part may have slipped, as standard uncertainty, where nothing shows it; and what the surfaces that views
share may leave of that, in units of the joint's u, for a proof."""
FEWEST_SHARED = 200
"""Points that two views share, with which the overlap is judged."""


@dataclass(frozen=True, slots=True)
class PairOff:
    """Two marks of a view whose distance is `mm` larger than calibrated, `z` times its uncertainty."""

    view: str
    first: int
    second: int
    mm: float
    z: float


@dataclass(frozen=True, slots=True)
class WithoutMark:
    """Joint without one mark: it moves by `change_mm` where it counts, of which `u_mm` is explained."""

    view: str
    number: int
    change_mm: float
    u_mm: float

    @property
    def z(self) -> float:
        """Change in units of what is explained of it."""
        return abs(self.change_mm) / max(self.u_mm, 1e-9)


@dataclass(frozen=True, eq=False, slots=True)
class Overlap:
    """What two views show of one surface: how far apart they are, along its normals, with the uncertainty of that.

    `opposed` is the share of the points that meet with normals against each other; `spread` (3, 3) the mean of n nᵀ
    over the normals n: along directions that they do not span, the overlap shows nothing.
    """

    first: str
    second: str
    points: int
    mm: float
    u_mm: float
    opposed: float
    spread: Array


@dataclass(frozen=True, eq=False, slots=True)
class JointCheck:
    """Check of a joint.

    Parameters
    ----------
    chi2, redundancy, chance
        Of the marks' residuals, and the chance that they are larger, of all views or of one among them.
    u_mm
        Standard uncertainty of the joint, by marks and carrier, where and along which it counts.
    pairs
        Pairs of marks that are used with the largest z-scores of their distances, one a view.
    without
        The joint without each single mark, in the order of the views.
    overlaps
        Of views that share surface; () where none do.
    u_slip_mm
        Standard uncertainty to which they show that the part has not slipped from the first view to the last, along
        where the joint counts.
    """

    joint: Joint
    chi2: float
    redundancy: float
    chance: float
    u_mm: float
    pairs: tuple[PairOff, ...]
    without: tuple[WithoutMark, ...]
    overlaps: tuple[Overlap, ...] = ()
    u_slip_mm: float = SLIP_MM

    @property
    def doubts(self) -> Doubts:
        """Why the joint proves nothing; what the surfaces say comes first."""
        notes = [*self._of_overlaps(), *self._of_marks(), *self._of_slip()]
        return tuple(Doubt.of(note) for note in notes)

    @property
    def notes(self) -> tuple[Message, ...]:
        """What else is told of the joint."""
        notes = []
        for number, view in enumerate(self.joint.views):
            gone = self.joint.left_out(number)
            if len(gone):
                notes.append(note_of("views.marks_left_out", view=view, n=len(gone), numbers=tuple(map(int, gone))))
        return tuple(notes)

    def _of_overlaps(self) -> list[Message]:
        found = []
        for one in self.overlaps:
            if one.opposed > 0.5:
                found.append(note_of("views.normals_opposed", first=one.first, second=one.second))
            elif abs(one.mm) > _quantile(len(self.overlaps)) * one.u_mm:
                found.append(
                    note_of("views.overlap_disagrees", first=one.first, second=one.second, mm=one.mm, u_mm=one.u_mm)
                )
        return found

    def _of_slip(self) -> list[Message]:
        if not self.overlaps:
            return [note_of("views.no_overlap")]
        if self.u_slip_mm > SLIP_TIMES * self.u_mm:
            return [note_of("views.slip_unseen", u_mm=self.u_slip_mm, joint_mm=self.u_mm)]
        return []

    def _of_marks(self) -> list[Message]:
        found, joint = [], self.joint
        if joint.carrier.as_printed:
            found.append(note_of("views.carrier_as_printed"))
        for number, seen in enumerate(joint.seen):
            kept = int(np.count_nonzero(joint.kept(number)))
            if kept <= FEWEST_MARKS or len(seen) - kept > MOST_LEFT_OUT * len(seen):
                found.append(
                    note_of("views.few_marks_fit", view=seen.view, n=kept, seen=len(seen), least=FEWEST_MARKS + 1)
                )
        if self.chance < MARKS_CHANCE:
            off = [np.linalg.norm(residuals, axis=1) for residuals in joint.residuals]
            view = int(np.argmax([px.max() for px in off]))
            worst = int(np.argmax(off[view]))
            found.append(
                note_of(
                    "views.marks_disagree",
                    times=joint.scale,
                    px=float(off[view][worst]),
                    number=int(joint.seen[view].numbers[worst]),
                    view=joint.views[view],
                )
            )
        found += [
            note_of("views.pair_off", view=pair.view, first=pair.first, second=pair.second, mm=pair.mm, z=pair.z)
            for pair in self.pairs
            if pair.z > _quantile(sum(len(seen) ** 2 for seen in joint.seen))
        ]
        matter = (one for one in self.without if abs(one.change_mm) > self.u_mm)
        worst_one = max(matter, key=lambda one: one.z, default=None)
        if worst_one is not None and worst_one.z > _quantile(len(self.without)):
            found.append(
                note_of(
                    "views.hangs_on_one_mark",
                    view=worst_one.view,
                    number=worst_one.number,
                    mm=worst_one.change_mm,
                    u_mm=worst_one.u_mm,
                )
            )
        return found


def check_joint(joint: Joint, camera: Camera, at: Array, along: Array, overlaps: Sequence[Overlap] = ()) -> JointCheck:
    """Look for what speaks against a joint.

    Parameters
    ----------
    joint, camera
        The joint, and the camera of its views.
    at, along
        (3,) the place in mm and the unit direction, in the first view's camera frame, in which the joint counts.
    overlaps
        What `overlaps_of` found.
    """
    from scipy.stats import chi2

    by_motion = along @ np.hstack([-cross_matrices(at[None])[0], np.eye(3)])
    u_mm = float(np.sqrt(by_motion @ joint.covariance(len(joint.views) - 1) @ by_motion))
    return JointCheck(
        joint,
        joint.chi2,
        joint.redundancy,
        min(
            float(chi2.sf(joint.chi2, max(joint.redundancy, 1.0))),
            *(
                len(joint.views) * float(chi2.sf(_squares(joint, view), 2 * len(seen) - 6))
                for view, seen in enumerate(joint.seen)
            ),
        ),
        u_mm,
        tuple(_worst_pair(joint, camera, view) for view in range(len(joint.views))),
        tuple(_without_each(joint, by_motion)),
        tuple(overlaps),
        _u_of_slip(joint.views, overlaps, along),
    )


def _squares(joint: Joint, view: int) -> float:
    """Sum of the squared standardised residuals of a view's marks by Huber's weights."""
    residuals = joint.residuals[view]
    whitened = np.linalg.solve(joint.seen[view].covariance, residuals[..., None])[..., 0]
    squares = np.einsum("ni,ni->n", residuals, whitened)
    return float(huber_weights(np.sqrt(squares), MARKS_HUBER) @ squares)


def _u_of_slip(views: Sequence[str], overlaps: Sequence[Overlap], along: Array) -> float:
    """To what u in mm overlaps show, directly or by views between, how far the part slipped `along` from first to last.

    Unknown is the part's shift in each view on its carrier; an overlap weighs the difference of two along its normals.
    """
    normal = np.eye(3 * len(views)) / SLIP_MM**2
    for one in overlaps:
        apart = np.zeros((3, 3 * len(views)))
        for view, sign in ((one.first, -1.0), (one.second, 1.0)):
            at = 3 * views.index(view)
            apart[:, at : at + 3] = sign * np.eye(3)
        normal += apart.T @ one.spread @ apart / one.u_mm**2
    rest = np.linalg.inv(normal[3:, 3:])
    return float(np.sqrt(along @ rest[-3:, -3:] @ along))


def _quantile(tests: int) -> float:
    """What a normal quantity exceeds by CHANCE in one of so many tests, on either side."""
    from scipy.stats import norm

    return float(norm.isf(CHANCE / (2 * max(tests, 1))))


def _worst_pair(joint: Joint, camera: Camera, view: int) -> PairOff:
    """The two used marks of a view whose distance, where their centres are seen on the carrier, is off most."""
    carrier, kept, pose = joint.carrier, joint.kept(view), joint.poses[view]
    seen = joint.seen[view].select(kept)
    index = carrier.index_of(seen.numbers)
    off = _off_mm(joint, camera, view)[kept]
    places = carrier.positions[index]
    first, second = np.triu_indices(len(index), 1)
    apart = places[first] - places[second]
    unit = apart / np.linalg.norm(apart, axis=1, keepdims=True)
    change = np.einsum("ni,ni->n", unit, off[first] - off[second])
    depth = pose.apply(places)[:, 2]
    noise = (np.sqrt(seen.covariance[:, 0, 0]) * joint.scale * depth / camera.focal) ** 2
    blocks = carrier.covariance.reshape(len(carrier), 3, len(carrier), 3)

    def known(a: NDArray[np.intp], b: NDArray[np.intp]) -> Array:
        return np.asarray(np.einsum("ni,nij,nj->n", unit, blocks[index[a], :, index[b], :], unit))

    variance = noise[first] + noise[second] + known(first, first) + known(second, second) - 2 * known(first, second)
    z = np.abs(change) / np.sqrt(variance)
    worst = int(np.argmax(z))
    numbers = seen.numbers
    return PairOff(
        joint.views[view],
        int(numbers[first[worst]]),
        int(numbers[second[worst]]),
        float(change[worst]),
        float(z[worst]),
    )


def _off_mm(joint: Joint, camera: Camera, view: int) -> Array:
    """(n, 3) in mm how far beside its calibrated place, in the carrier's plane, each mark of a view is seen."""
    pose, index = joint.poses[view], joint.carrier.index_of(joint.seen[view].numbers)
    places = joint.carrier.positions[index]
    uv = camera.project_pose(pose, places)
    step = 0.01
    by_x, by_y = (camera.project_pose(pose, places + step * axis) - uv for axis in np.eye(3)[:2])
    slopes = np.stack([by_x, by_y], axis=2) / step
    flat = np.linalg.solve(slopes, joint.residuals[view][..., None])[..., 0]
    return np.column_stack([flat, np.zeros(len(flat))])


def _without_each(joint: Joint, by_motion: Array) -> list[WithoutMark]:
    """The joint of the last view to the first without each mark that is used, along `by_motion` (6,)."""
    by_carrier = by_motion @ joint.motion_of(len(joint.views) - 1)
    names = [(view, int(number)) for view, seen in zip(joint.views, joint.seen, strict=True) for number in seen.numbers]
    changes, roots = joint.without @ by_carrier, np.einsum("i,mij->mj", by_carrier, joint.grown)
    return [
        WithoutMark(view, number, float(change), float(np.linalg.norm(root)))
        for (view, number), change, root, kept in zip(
            names, changes, roots, np.concatenate([joint.kept(v) for v in range(len(joint.views))]), strict=True
        )
        if kept
    ]


def overlaps_of(joined: JoinedCloud) -> list[Overlap]:
    """Compare what each two views show of one surface of the part or its carrier.

    Points below the carrier are left out: the table does not move along.
    """
    on_part = _on_part(joined)
    views, found = range(len(joined.joint.views)), []
    for first in views:
        for second in range(first + 1, len(views)):
            overlap = _overlap(joined, on_part, first, second)
            if overlap is not None:
                found.append(overlap)
    return found


def _on_part(joined: JoinedCloud) -> NDArray[np.bool_]:
    """Which points (N,) lie within reach of the carrier's marks and on the camera's side of its far face."""
    carrier, joint = joined.joint.carrier, joined.joint
    reach = np.abs(carrier.positions[:, :2]).max(axis=0)
    kept = np.zeros(len(joined.cloud), dtype=np.bool_)
    for number, view in enumerate(joined.errors.views):
        mine = np.flatnonzero(joined.cloud.view == number)
        pose = joint.poses[number]
        side = -np.sign(pose.rotation[2, 2])
        own = pose.inverse().apply(view.pose.inverse().apply(joined.cloud.points[mine]))
        lowest = float((carrier.positions[:, 2] * side).min())
        kept[mine] = (np.abs(own[:, :2]) <= reach).all(axis=1) & (own[:, 2] * side > lowest - NEAR_MM)
    return kept


def _overlap(joined: JoinedCloud, on_part: NDArray[np.bool_], first: int, second: int) -> Overlap | None:
    cloud = joined.cloud
    known = on_part & (np.linalg.norm(cloud.normals, axis=1) > 0.5)
    a, b = (np.flatnonzero(known & (cloud.view == view)) for view in (first, second))
    if min(len(a), len(b)) < FEWEST_SHARED:
        return None
    reach = max(NEAR_MM, REACH * float(np.ptp(cloud.points[a], axis=0).max()))
    found = cKDTree(cloud.points[a]).query(cloud.points[b], distance_upper_bound=reach)
    distance, nearest = np.asarray(found[0]), np.asarray(found[1])
    met = np.isfinite(distance)
    ours, theirs = a[nearest[met]], b[met]
    cosine = np.einsum("ni,ni->n", cloud.normals[ours], cloud.normals[theirs])
    apart = np.einsum("ni,ni->n", cloud.normals[ours], cloud.points[theirs] - cloud.points[ours])
    beside = np.sqrt(np.maximum(distance[met] ** 2 - apart**2, 0.0))
    noise = np.hypot(cloud.sigma[ours], cloud.sigma[theirs])
    against = (cosine <= -ALONG) & (apart >= -WALL * noise) & (apart <= NEAR_MM)  # not across a wall or a gap
    shared = (beside <= NEAR_MM) & ((cosine >= ALONG) | against)
    if np.count_nonzero(shared) < FEWEST_SHARED:
        return None
    ours, theirs, cosine, apart = ours[shared], theirs[shared], cosine[shared], apart[shared]
    names = joined.joint.views[first], joined.joint.views[second]
    opposed = float(np.mean(cosine < 0))
    normals = cloud.normals[ours]
    moved = [
        joined.errors.views[view].common_along(cloud.select(mine), normals).mean(axis=0)
        for view, mine in ((first, ours), (second, theirs))
    ]
    in_common = float(np.linalg.norm(moved[1] - moved[0]))
    sweeps = max(len(np.unique(cloud.sweep[theirs])), 1)
    scatter = 1.2533 * float(np.median(np.abs(apart - np.median(apart)))) * 1.4826 / np.sqrt(sweeps)
    spread = normals.T @ normals / len(normals)
    return Overlap(*names, len(ours), float(np.median(apart)), float(np.hypot(in_common, scatter)), opposed, spread)
