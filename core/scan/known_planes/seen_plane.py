"""A known plane from pictures of its board: its pose by the target on it, and how well that is known.

A board is one plane, however many pictures show it: that which agrees best with all of them. Pictures that say
something else, beyond the noise of their points, show that it moved between them: then nothing is known of it. Where
they are off by too little to do harm, the plane is known as much worse as they disagree more than their noise explains.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from core.calibrate.board_shape import BoardTolerance
from core.calibrate.camera import reprojection
from core.calibrate.fan.poses.even_plate import EvenPlate
from core.calibrate.fan.poses.plane_pose import plate_level
from core.calibrate.fan.poses.plate import Plate
from core.calibrate.fan.poses.target_plane import target_plane_changes
from core.errors import InputError
from core.findings.table import note_of
from core.image.targets import Target, TargetNotFound, detect, estimate_pose
from core.image.targets.target_view import TargetView
from core.messages import Message
from core.model import Camera, Pose
from core.model.arrays import Array
from core.scan.known_planes.known_plane import KnownPlane

MOVED = 1e-4
"""Probability by chance below which pictures of a board that disagree show that it moved."""
LEAST_SHIFT_MM = 0.05
"""Shift of a board's middle along its normal from picture to picture that does no harm: warmth does as much."""
_EDGE_POINTS = 16
"""Points of each edge of the outline: a distorted picture bends it."""


@dataclass(frozen=True, slots=True)
class BoardOf:
    """What is stated of a board.

    Parameters
    ----------
    name
        Its name.
    target, tolerance, margin_mm
        What is printed on it, how true that is, and how far the board goes on beyond it (None: not known).
    print_of
        Names the print whose error of size is its own.
    region_px
        Polygon (u, v) in pixels within which it lies; None: anywhere.
    """

    name: str
    target: Target
    tolerance: BoardTolerance
    margin_mm: float | None = None
    print_of: str = ""
    region_px: tuple[tuple[float, float], ...] | None = None


@dataclass(frozen=True, eq=False, slots=True)
class SoughtPlane:
    """Known plane that was looked for: the plane, None where there is none, and notes on what was found."""

    plane: KnownPlane | None
    notes: tuple[Message, ...] = ()


@dataclass(frozen=True, eq=False, slots=True)
class _Seen:
    """The plane τ (3,) that one picture shows, its covariance (3, 3), and how it follows the camera (3, 10)."""

    view: TargetView
    pose: Pose
    pi: Array
    covariance: Array
    by_camera: Array
    rms_px: float


def seek_plane(board: BoardOf, pictures: Sequence[tuple[str, NDArray[Any]]], camera: Camera) -> SoughtPlane:
    """Find the plane of a board in `pictures` of it, each a name and grey levels (H, W), the laser off or on."""
    seen, shown, reasons = list[_Seen](), list[NDArray[Any]](), list[Message]()
    for name, picture in pictures:
        try:
            seen.append(_seen(board, picture, name, camera))
            shown.append(picture)
        except InputError as error:
            reasons.append(error.reason)
    if not seen:
        why = tuple(reasons) or (Message("scan.board_without_picture", "no picture shows it"),)
        return SoughtPlane(None, (note_of("scan.board_not_found", board=board.name, reasons=why),))
    weights = [np.linalg.inv(one.covariance) for one in seen]
    of_pose = np.linalg.inv(np.sum(weights, axis=0))
    pi = of_pose @ np.sum([w @ one.pi for w, one in zip(weights, seen, strict=True)], axis=0)
    notes = tuple(note_of("scan.board_picture_left_out", board=board.name, reason=reason) for reason in reasons)
    moved_mm = max(_apart_mm(one, pi) for one in seen)
    squares = sum(float((one.pi - pi) @ w @ (one.pi - pi)) for w, one in zip(weights, seen, strict=True))
    freedom = max(3 * (len(seen) - 1), 1)
    if moved_mm > LEAST_SHIFT_MM and chdtrc(freedom, squares) < MOVED:
        return SoughtPlane(None, (*notes, note_of("scan.board_moved", board=board.name, mm=moved_mm)))
    by_camera = np.zeros((3, 10))
    for w, one in zip(weights, seen, strict=True):
        by_camera += of_pose @ w @ one.by_camera
    even = EvenPlate.of(shown[0], seen[0].view, plate_level(shown[0], seen[0].view))
    plane = replace(
        _known(board, seen[0], camera),
        pi=pi,
        of_pose=max(1.0, squares / freedom) * of_pose,
        by_camera=by_camera,
        marks=even.uneven,
        pictures=len(seen),
        rms_px=float(np.sqrt(np.mean([one.rms_px**2 for one in seen]))),
        picture=shown[0],
    )
    return SoughtPlane(plane, notes)


def plane_of_view(board: BoardOf, view: TargetView, camera: Camera) -> KnownPlane:
    """Compute the plane of a board from one `view` of it, without what is printed on it.

    Raises
    ------
    TargetNotFound
        If its pose is not sure.
    """
    return _known(board, _posed(view, camera), camera)


def _known(board: BoardOf, one: _Seen, camera: Camera) -> KnownPlane:
    """The plane that one picture shows."""
    plate = Plate(board.target, one.view, camera, board.margin_mm)
    return KnownPlane(
        board.name,
        one.pi,
        _outline(plate, one.pose, camera),
        one.covariance,
        _of_flatness(one.pose, plate.corners, board.tolerance.flatness_sd_mm),
        one.by_camera,
        None,
        board.tolerance.size_sd,
        scale_assumed=board.tolerance.scale_sd is None,
        flatness_assumed=board.tolerance.flatness_mm is None,
        print_of=board.print_of or board.name,
        rms_px=one.rms_px,
    )


def _seen(board: BoardOf, picture: NDArray[Any], name: str, camera: Camera) -> _Seen:
    """The board in one picture; TargetNotFound if it is not seen, or its pose is not sure."""
    return _posed(detect(board.target, picture, name, camera, plane_only=True, region_px=board.region_px), camera)


def _posed(view: TargetView, camera: Camera) -> _Seen:
    """The plane of a view of a board; TargetNotFound if its pose is not sure."""
    found = estimate_pose(view, camera)
    if found.ambiguous:
        raise TargetNotFound(
            Message("scan.board_ambiguous", "its points do not tell which of two ways it is tilted"), where=view.name
        )
    kept = found.used
    view = replace(
        view,
        points=view.points[kept],
        uv=view.uv[kept],
        sigma=view.sigma[kept],
        covariance=None if view.covariance is None else view.covariance[np.ix_(np.repeat(kept, 2), np.repeat(kept, 2))],
    )
    _, by_camera, by_pose = reprojection.linearise(camera, found.pose, view.points)
    off = view.whitened(found.residuals[kept][..., None])[:, 0]
    own = view.whitened(by_pose)
    inverse = np.linalg.pinv(own.T @ own, hermitian=True, rcond=1e-14)
    pi, by_step = target_plane_changes(found.pose)
    noise = max(1.0, float(off @ off) / max(len(off) - 6, 1)) if len(off) > 12 else 1.0
    follows = -by_step @ inverse @ own.T @ view.whitened(by_camera)
    return _Seen(view, found.pose, pi, noise * by_step @ inverse @ by_step.T, follows, found.rms_px)


def _apart_mm(one: _Seen, pi: Array) -> float:
    """How far in mm the board's points in a picture are off the plane `pi` at most."""
    points = one.pose.apply(one.view.points)
    return float(np.abs((points @ pi - 1) / np.linalg.norm(pi)).max())


def _outline(plate: Plate, pose: Pose, camera: Camera) -> Array:
    """Where the edges of the plate are seen, (K, 2) in px."""
    low, high = plate.corners
    corners = np.array([low, [high[0], low[1]], high, [low[0], high[1]], low])
    steps = np.linspace(0.0, 1.0, _EDGE_POINTS, endpoint=False)[:, None]
    edges = np.concatenate([a + steps * (b - a) for a, b in pairwise(corners)])
    return camera.project_pose(pose, np.column_stack([edges, np.zeros(len(edges))]))


def _of_flatness(pose: Pose, corners: tuple[Array, Array], flatness_mm: float) -> Array:
    """Covariance (3, 3) of τ where a board bows: its edges are off its plane by a standard deviation of `flatness_mm`.

    A part of it may lie half of that above the plane, and slope by all of it over half its extent.
    """
    low, high = corners
    pi = target_plane_changes(pose)[0]
    middle = pose.apply(np.array([[*(low + high) / 2, 0.0]]))[0]
    lean = [pose.rotation[:, axis] - (pose.rotation[:, axis] @ middle) * pi for axis in range(2)]
    half = (high - low) / 2
    steps = np.array([pi / 2, lean[0] / half[0], lean[1] / half[1]]) * flatness_mm * np.linalg.norm(pi)
    return np.asarray(steps.T @ steps)
