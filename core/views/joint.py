"""The joint: poses of a carrier in all views, and so of all views to the first, in one generalised robust fit.

Unknown are the carrier's pose in each view's camera frame, and what is wrong with the marks' calibrated positions,
which have a prior. Seen are the centres of the marks' discs. With A the design of the seen marks and L L^T the marks'
covariance, the estimates follow noise ε and the marks' errors L ζ linearly, so what acts on the joint is kept cause by
cause:

- *marks*: noise of the seen centres, each view's its own;
- *carrier*: errors of the marks' positions, the same in all views;
- *carrier's temperature*: a carrier that is warmer is larger, and seems nearer in all views;
- *calibrations*: a displaced camera sees the marks elsewhere in all views at once, and its points move as well: the two
  are one error (`of_calibration`).

A motion of a view is (ω, τ): its points X in the first view's camera frame move by ω × X + τ.

References
----------
Förstner, W., Wrobel, B. P., Photogrammetric Computer Vision, Springer 2016, 15.2 (bundle adjustment with prior).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from core.calibrate.camera.reprojection import camera_of
from core.calibrate.deviations import SCALES
from core.errors import InputError
from core.image.targets.ellipses import centre_shift
from core.image.targets.pose import cross_matrices
from core.messages import Message
from core.model import Camera, Pose
from core.model.arrays import Array
from core.model.robust import HUBER, TUKEY, huber_weights, tukey_weights
from core.scan.common_errors import CommonErrors
from core.views.carrier import FEWEST_MARKS, Carrier
from core.views.marks_seen import MarksSeen

ROUNDS, HUBER_ROUNDS = 30, 10
"""Of the robust fit, and how many of them by Huber's weights."""
MARKS_HUBER, MARKS_TUKEY = 1.5 * HUBER, 1.5 * TUKEY
"""Limits of the lengths of standardised residuals, which have two coordinates."""
SETTLED = 1e-9
"""Step in rad, and in shares of mm, at which it has settled."""
FREE = 1e3
"""A view is free along a direction if the marks leave it uncertain by so many times what they leave along the best."""
LEFT_OUT = 0.05
"""Robust weight below which a mark counts as left out."""


@dataclass(frozen=True, eq=False, slots=True)
class Joint:
    """Joint of V views by the marks of one carrier.

    Parameters
    ----------
    carrier
        The marks, as calibrated.
    views
        (V,) their names, the first the datum.
    seen
        (V,) marks seen in each.
    poses
        (V,) `pose_cam_carrier` of each view.
    residuals
        (V,) of (n, 2) in px, of the marks seen in each view.
    weights
        (V,) of (n,) robust weights; below LEFT_OUT a mark is left out.
    by_marks, by_carrier
        (6V, K) motions of the carrier in the views' camera frames by unit causes: noise of the seen marks, and errors
        of the carrier. Small turn in the camera frame about the carrier's origin, then shift in mm.
    by_residuals
        (6V, 2M) how these follow the seen centres, view by view and mark by mark.
    without, grown
        (M, 6V) motions of the carrier if one of the M seen marks is left out, and (M, 6V, 2) roots of what that adds to
        their covariance, view by view and mark by mark.
    chi2, redundancy
        Sum of the squared standardised residuals of all marks seen by Huber's weights, also of those left out, with
        those of the carrier's marks, and what is expected of it.
    scale
        Factor ≥ 1 by which residuals are larger than stated; it is in `by_marks`.
    """

    carrier: Carrier
    views: tuple[str, ...]
    seen: tuple[MarksSeen, ...]
    poses: tuple[Pose, ...]
    residuals: tuple[Array, ...]
    weights: tuple[Array, ...]
    by_marks: Array
    by_carrier: Array
    by_residuals: Array
    without: Array
    grown: Array
    chi2: float
    redundancy: float
    scale: float

    def pose(self, view: int) -> Pose:
        """Compute the pose of a view: its camera frame to that of the first view."""
        return self.poses[0] @ self.poses[view].inverse()

    def motion_of(self, view: int) -> Array:
        """Compute the matrix (6, 6V) by which the motion (ω, τ) of a view follows those of the carrier in all views."""
        matrix = np.zeros((6, 6 * len(self.views)))
        turn = self.pose(view).rotation
        both = np.kron(np.eye(2), turn)
        matrix[:, :6] += np.eye(6)
        matrix[:, 6 * view : 6 * view + 6] -= both
        # about the carrier's origin in the first view -> about the camera's
        lever = np.eye(6)
        lever[3:, :3] = cross_matrices(self.poses[0].translation[None])[0]
        return lever @ matrix

    def covariance(self, view: int) -> Array:
        """Compute the covariance (6, 6) of a view's motion (ω in rad, τ in mm) by marks and carrier, and its warmth."""
        every = self.motion_of(view) @ np.hstack([self.by_marks, self.by_carrier, self.by_temperature])
        return np.asarray(every @ every.T, dtype=np.float64)

    @property
    def by_temperature(self) -> Array:
        """Motions (6V, 1) of the carrier by its temperature: larger by a share of itself, it seems nearer by that."""
        return (
            -self.carrier.growth[1]
            * np.concatenate([[0.0, 0.0, 0.0, *pose.translation] for pose in self.poses])[:, None]
        )

    def of_calibration(self, common: CommonErrors, scale_sd: float = 0.0) -> Array:
        """Compute the motions (K, 6V) of the carrier in the views by each displaced calibration of `common`.

        Where the size of the plane target is displaced, by `scale_sd` of itself, the carrier is so, too, if it was
        calibrated by that.
        """
        here = np.concatenate([_centres(camera_of(common.cameras[0], common.image_size), self, v) for v in self._all])
        motions = np.zeros((len(common.sources), 6 * len(self.views)))
        for k, source in enumerate(common.sources):
            if not np.array_equal(common.cameras[1 + k], common.cameras[0]):
                displaced = camera_of(common.cameras[1 + k], common.image_size)
                there = np.concatenate([_centres(displaced, self, v) for v in self._all])
                motions[k] = self.by_residuals @ (here - there).ravel()
            if source in SCALES and self.carrier.scaled_by_target:
                for v, pose in enumerate(self.poses):
                    motions[k, 6 * v + 3 : 6 * v + 6] += scale_sd * pose.translation
        return motions

    def motions(self, view: int, of_carrier: Array) -> Array:
        """Compute motions (K, 6) of a view's points from motions (K, 6V) of the carrier in all views."""
        return np.asarray(of_carrier @ self.motion_of(view).T, dtype=np.float64)

    @property
    def _all(self) -> range:
        return range(len(self.views))

    def kept(self, view: int) -> NDArray[np.bool_]:
        """Select (n,) the marks of a view that the robust fit has kept."""
        return np.asarray(self.weights[view] >= LEFT_OUT)

    def left_out(self, view: int) -> NDArray[np.int64]:
        """List the numbers of the marks of a view that the robust fit has left out."""
        return self.seen[view].numbers[~self.kept(view)]


def join(carrier: Carrier, seen: Sequence[MarksSeen], camera: Camera) -> Joint:
    """Join views by the marks of their carrier.

    Parameters
    ----------
    carrier
        The marks' positions with their covariance, at 20 °C; the joint is by what they are at its temperature.
    seen
        (V,) the marks seen in each view, the first the datum.
    camera
        The calibrated camera of all views.

    Raises
    ------
    InputError
        If a view shows fewer than FEWEST_MARKS marks that fit each other, or its marks leave a direction of it free.
    """
    for view in seen:
        if len(view) < FEWEST_MARKS:
            raise InputError(
                Message("views.too_few_marks", "{n} marks of the carrier are seen, and {least} are needed",
                        n=len(view), least=FEWEST_MARKS),
                where=view.view,
                todo=Message("views.advice_show_marks", "turn the carrier so that more of its marks are seen, "
                             "with even light and nothing in front of them"),
            )  # fmt: skip
    carrier = replace(carrier, positions=carrier.positions * (1 + carrier.growth[0]))
    poses = [_first_pose(carrier, view, camera) for view in seen]
    root = carrier.root
    zeta = np.zeros(root.shape[1])
    roots = [np.linalg.inv(np.linalg.cholesky(view.covariance)) for view in seen]
    weights = [np.ones(len(view)) for view in seen]
    for round_ in range(ROUNDS):
        positions = carrier.positions + (root @ zeta).reshape(-1, 3)
        design, misfit = _equations(carrier, positions, poses, seen, camera, roots)
        length = np.linalg.norm(misfit.reshape(-1, 2), axis=1)
        scale = max(1.0, float(np.median(length)) / 1.177)
        rule = (
            huber_weights(length / scale, MARKS_HUBER)
            if round_ < HUBER_ROUNDS
            else tukey_weights(length / scale, MARKS_TUKEY)
        )
        weights = np.split(np.asarray(rule), np.cumsum([len(view) for view in seen])[:-1])
        _require_kept(seen, weights)
        normal, weighted = _normal(design, np.repeat(rule, 2), scale, len(seen))
        step = np.linalg.solve(normal, weighted @ misfit - np.concatenate([np.zeros(6 * len(seen)), zeta]))
        poses = [_moved(pose, step[6 * v : 6 * v + 6]) for v, pose in enumerate(poses)]
        zeta = zeta + step[6 * len(seen) :]
        if round_ > HUBER_ROUNDS and np.abs(step[: 6 * len(seen)]).max() < SETTLED * 1e3:
            break
    positions = carrier.positions + (root @ zeta).reshape(-1, 3)
    design, misfit = _equations(carrier, positions, poses, seen, camera, roots)
    rule = np.concatenate(weights)
    length = np.linalg.norm(misfit.reshape(-1, 2), axis=1)
    squares = float(huber_weights(length, MARKS_HUBER) @ length**2 + zeta @ zeta)
    redundancy = float(len(misfit) - 6 * len(seen))
    scale = float(np.sqrt(max(1.0, squares / max(redundancy, 1.0))))
    normal, weighted = _normal(design, np.repeat(rule, 2), scale, len(seen))
    inverse = np.linalg.inv(normal)
    gains = (inverse @ weighted)[: 6 * len(seen)]
    whiten = _blocks(roots)
    residuals = np.split(np.linalg.solve(whiten, misfit).reshape(-1, 2), np.cumsum([len(view) for view in seen])[:-1])
    joint = Joint(
        carrier,
        tuple(view.view for view in seen),
        tuple(seen),
        tuple(poses),
        tuple(residuals),
        tuple(weights),
        np.asarray(gains * scale, dtype=np.float64),
        np.asarray(inverse[: 6 * len(seen), 6 * len(seen) :], dtype=np.float64),
        gains @ whiten,
        *_without_each(design, misfit, inverse @ weighted, gains, scale),
        squares,
        redundancy,
        scale,
    )
    for number in range(len(seen)):
        _require_held(joint, number)
    return joint


def _require_kept(seen: Sequence[MarksSeen], weights: Sequence[Array]) -> None:
    """InputError that names the view of which fewer than FEWEST_MARKS marks fit each other, if there is one."""
    for view, weight in zip(seen, weights, strict=True):
        kept = int(np.count_nonzero(weight >= LEFT_OUT))
        if kept < FEWEST_MARKS:
            raise InputError(
                Message("views.too_few_marks_fit", "of {seen} marks of the carrier seen, only {n} fit each other as "
                        "they were calibrated, and {least} are needed", seen=len(view), n=kept, least=FEWEST_MARKS),
                where=view.view,
                todo=Message("views.advice_clean_marks", "clean the marks, see that all are firm and seen without "
                             "glare, and calibrate the carrier anew if marks were moved"),
            )  # fmt: skip


def _without_each(design: Array, misfit: Array, solving: Array, gains: Array, scale: float) -> tuple[Array, Array]:
    """Motions (M, 6V) if one mark is left out, and roots (M, 6V, 2) of what the covariance grows by: exact if linear.

    `solving` (n, 2M) and `gains` (6V, 2M) are how all unknowns, and the poses, follow the misfits.
    """
    marks = len(misfit) // 2
    moved, grown = np.zeros((marks, len(gains))), np.zeros((marks, len(gains), 2))
    for mark in range(marks):
        rows = slice(2 * mark, 2 * mark + 2)
        left = np.linalg.pinv(np.eye(2) - design[rows] @ solving[:, rows], rcond=1e-9)
        moved[mark] = -gains[:, rows] @ left @ misfit[rows]
        grown[mark] = scale * gains[:, rows] @ _root((left + left.T) / 2)
    return moved, grown


def _root(matrix: Array) -> Array:
    values, vectors = np.linalg.eigh(matrix)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))


def _first_pose(carrier: Carrier, seen: MarksSeen, camera: Camera) -> Pose:
    """About where the carrier is: by RANSAC over its marks, which need not lie in a plane."""
    xy = camera.undistort(seen.uv)
    points = carrier.positions[carrier.index_of(seen.numbers)]
    limit = 4.0 / camera.focal
    found, turn, shift, _ = cv2.solvePnPRansac(
        points[:, None], xy[:, None], np.eye(3), None, flags=cv2.SOLVEPNP_SQPNP, reprojectionError=limit
    )
    if not found:
        raise InputError(
            Message("views.marks_fit_no_pose", "its marks do not lie as on the carrier: no pose of it shows them so"),
            where=seen.view,
            todo=Message(
                "views.advice_right_carrier",
                "give the carrier.toml of this carrier, and have the marks measured again if they were moved",
            ),
        )
    return Pose(Rotation.from_rotvec(np.ravel(turn)).as_matrix(), np.ravel(shift))


def _centres(camera: Camera, joint: Joint, view: int) -> Array:
    """(n, 2) where the marks of a view are seen with another camera, its poses as they are."""
    seen, carrier = joint.seen[view], joint.carrier
    return predicted_centres(carrier, carrier.positions, joint.poses[view], seen, camera)


def predicted_centres(carrier: Carrier, positions: Array, pose: Pose, seen: MarksSeen, camera: Camera) -> Array:
    """Compute the centres (n, 2) in px of the discs' ellipses, of marks at `positions` (N, 3) mm in the carrier."""
    index = carrier.index_of(seen.numbers)
    points, uv = positions[index], camera.project_pose(pose, positions[index])
    for side in (0, 1):
        mine = carrier.sides[index] == side
        if mine.any():
            height = float(points[mine, 2].mean())
            flat = np.column_stack([pose.rotation[:, :2], pose.rotation[:, 2] * height + pose.translation])
            uv[mine] += centre_shift(camera.matrix @ flat, points[mine, :2], carrier.radius_mm)
    return uv


def _equations(
    carrier: Carrier,
    positions: Array,
    poses: Sequence[Pose],
    seen: Sequence[MarksSeen],
    camera: Camera,
    roots: Sequence[Array],
) -> tuple[Array, Array]:
    """Design (2M, 6V + r) and misfit (2M,) of the seen centres, both in their standard uncertainties."""
    root = carrier.root.reshape(len(carrier), 3, -1)
    designs, misfits = [], []
    for v, (pose, view, whiten) in enumerate(zip(poses, seen, roots, strict=True)):
        index = carrier.index_of(view.numbers)
        turned = positions[index] @ pose.rotation.T
        x, y, z = (turned + pose.translation).T
        to_ray = np.zeros((len(x), 2, 3))
        to_ray[:, 0, 0] = to_ray[:, 1, 1] = 1 / z
        to_ray[:, 0, 2], to_ray[:, 1, 2] = -x / z**2, -y / z**2
        by_point = camera.matrix[:2, :2] @ camera.distort_jacobian(np.column_stack([x / z, y / z])) @ to_ray
        design = np.zeros((len(x), 2, 6 * len(poses) + root.shape[2]))
        design[:, :, 6 * v : 6 * v + 3] = -by_point @ cross_matrices(turned)
        design[:, :, 6 * v + 3 : 6 * v + 6] = by_point
        design[:, :, 6 * len(poses) :] = by_point @ pose.rotation @ root[index]
        misfit = view.uv - predicted_centres(carrier, positions, pose, view, camera)
        designs.append((whiten @ design).reshape(2 * len(x), -1))
        misfits.append(np.einsum("nij,nj->ni", whiten, misfit).ravel())
    return np.vstack(designs), np.concatenate(misfits)


def _normal(design: Array, weight: Array, scale: float, poses: int) -> tuple[Array, Array]:
    """AᵀWA with the marks' prior, after the 6 columns of each of `poses`, and AᵀW, of noise `scale` as stated."""
    weighted = (design * (weight / scale**2)[:, None]).T
    normal = weighted @ design
    normal[np.diag_indices(len(normal))] += np.repeat([0.0, 1.0], [6 * poses, len(normal) - 6 * poses])
    return normal, weighted


def _moved(pose: Pose, step: Array) -> Pose:
    return Pose(Rotation.from_rotvec(step[:3]).as_matrix() @ pose.rotation, pose.translation + step[3:])


def held(joint: Joint, view: int) -> tuple[Array, Array]:
    """Compute how well a view is held: standard uncertainties (6,) in mm, ascending, and their directions (6, 6).

    A turn counts by what it moves the farthest of the carrier's marks; columns are (ω in rad, τ in mm), of the carrier
    about its origin.
    """
    reach = float(np.linalg.norm(joint.carrier.positions, axis=1).max())
    unit = np.repeat([1 / reach, 1.0], 3)
    rows = slice(6 * view, 6 * view + 6)
    both = np.hstack([joint.by_marks[rows], joint.by_carrier[rows]]) / unit[:, None]
    directions, sizes, _ = np.linalg.svd(both, full_matrices=True)
    return sizes[::-1], directions[:, ::-1] * unit[:, None]


def _require_held(joint: Joint, view: int) -> None:
    """InputError that names the direction along which a view is free, if there is one."""
    sizes, directions = held(joint, view)
    if np.isfinite(sizes).all() and sizes[-1] <= FREE * max(float(sizes[0]), 1e-6):
        return
    turn, shift = directions[:3, -1], directions[3:, -1]
    reach = float(np.linalg.norm(joint.carrier.positions, axis=1).max())
    by_turn = np.linalg.norm(turn) * reach > np.linalg.norm(shift)
    axis = turn if by_turn else shift
    x, y, z = axis / np.linalg.norm(axis)
    how = (
        Message("views.free_turn", "turning about ({x:.2f}, {y:.2f}, {z:.2f})", x=x, y=y, z=z)
        if by_turn
        else Message("views.free_shift", "moving along ({x:.2f}, {y:.2f}, {z:.2f})", x=x, y=y, z=z)
    )
    raise InputError(
        Message("views.free_direction", "its marks leave it free: {how} in the camera frame changes nothing they show",
                how=how),
        where=joint.views[view],
        todo=Message("views.advice_spread_marks", "show marks that lie farther apart, and not on one line"),
    )  # fmt: skip


def _blocks(parts: Sequence[Array]) -> Array:
    """The block-diagonal matrix of all matrices (2, 2) of `parts`, each (n, 2, 2)."""
    every = np.concatenate(parts)
    matrix = np.zeros((2 * len(every), 2 * len(every)))
    for k, block in enumerate(every):
        matrix[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = block
    return matrix
