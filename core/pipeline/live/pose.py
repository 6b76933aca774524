"""What live pictures of the plane target show: its corners, the fan's stripes on it, and which line each is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from core.acquire.source import Frame, Picture
from core.calibrate.fan.poses.plane_pose import measure_plane_pose
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.fan.poses.stripe_lines import straight_lines
from core.image.sharpness import edge_blur_px
from core.image.stripes.centreline import Centreline
from core.image.stripes.stripe import WIDTH_IN_SIGMA, StripeSettings
from core.image.targets import Target
from core.model import Camera
from core.model.arrays import Array

NUMBERING_UNCLEAR = -1
"""Stands in place of a stripe's number where it is not clear which line it is of."""

_THIN = 3  # points of a stripe for display

_STILL_LIT = 0.5  # of a stripe's height: the fan is on
_BESIDE = 4.0  # times a stripe's width: there is none of its light

_ROOM, _LEAST_ROOM_PX = 0.6, 60.0
"""How far around the target's last place it is looked for, as a share of its size, and at least."""


@dataclass(frozen=True, eq=False, slots=True)
class FoundPose:
    """Pose found in one frame with the fan on: its features, edge blur, and the likely line of each stripe."""

    frame: Frame
    pose: PoseFeatures
    blur_px: float
    stripes: tuple[Array, ...]
    line: tuple[int, ...]


def find_pose(
    frame: Frame,
    target: Target,
    camera: Camera | None,
    settings: StripeSettings | None,
    lines: int,
    around: Array | None = None,
) -> FoundPose:
    """Find the plane target and the stripes on it in one frame, looking first `around` (N, 2) px, where it was last."""
    pose = None if around is None else _pose_around(around, frame.picture, target, camera, settings)
    if pose is None:
        pose = measure_plane_pose("", frame.picture, None, target, camera, settings)
    if pose.view is None:
        return FoundPose(frame, pose, float("nan"), (), ())
    stripes, line = _numbered_stripes(pose, camera, lines)
    return FoundPose(frame, pose, edge_blur_px(frame.picture, pose.view.uv), stripes, line)


def _pose_around(
    around: Array, picture: Picture, target: Target, camera: Camera | None, settings: StripeSettings | None
) -> PoseFeatures | None:
    """The pose in the part of the picture around points (N, 2), in pixels of the whole; None if it is not there."""
    low, high = around.min(axis=0), around.max(axis=0)
    reach = np.maximum(_ROOM * (high - low), _LEAST_ROOM_PX)
    u0, v0 = (int(value) for value in np.maximum(low - reach, 0))
    part = np.ascontiguousarray(picture[v0 : int(high[1] + reach[1]) + 1, u0 : int(high[0] + reach[0]) + 1])
    origin = np.array([u0, v0], dtype=np.float64)
    pose = measure_plane_pose(
        "",
        part,
        None,
        target,
        None if camera is None else _part_of(camera, (part.shape[1], part.shape[0]), origin),
        settings,
    )
    view = pose.view
    if view is None:
        return None
    return replace(
        pose,
        view=replace(view, uv=view.uv + origin),
        centrelines=tuple(replace(piece, uv=piece.uv + origin) for piece in pose.centrelines),
    )


def _part_of(camera: Camera, size: tuple[int, int], origin: Array) -> Camera:
    """The camera that sees only a part of the picture, of this size, whose first pixel is at `origin` (2,)."""
    matrix = camera.matrix.copy()
    matrix[:2, 2] -= origin
    return Camera(size, matrix, camera.distortion)


def is_lit(picture: Picture, lit: Picture, stripes: Sequence[Centreline]) -> bool:
    """Whether a picture (H, W) shows `stripes` at least half as bright as a picture `lit` (H, W) of the scene."""
    return _height(picture, stripes) > _STILL_LIT * _height(lit, stripes)


def _height(picture: Picture, stripes: Sequence[Centreline]) -> float:
    """Mean grey value along stripes above that beside them."""

    def grey(beside: float) -> float:
        uv = np.concatenate([piece.uv + beside * piece.width[:, None] * piece.normal for piece in stripes])
        u, v = np.clip(np.rint(uv).astype(int), 0, np.array(picture.shape[::-1]) - 1).T
        return float(picture[v, u].mean())

    return grey(0.0) - 0.5 * (grey(-_BESIDE) + grey(_BESIDE))


def measure_pair(
    name: str,
    on: Picture,
    off: Picture | None,
    target: Target,
    camera: Camera | None,
    settings: StripeSettings | None,
    margin_mm: float | None,
) -> PoseFeatures:
    """Measure a pose from its pictures, fan `on` and `off` (None: not taken), as the fan's calibration does."""
    return measure_plane_pose(name, on, off, target, camera, settings, margin_mm)


def _numbered_stripes(
    pose: PoseFeatures, camera: Camera | None, lines: int
) -> tuple[tuple[Array, ...], tuple[int, ...]]:
    """The stripes on the target, and the line each is likely to be: in order from the top, or from the left if steep.

    Where there are not as many straight stripes as the fan has lines, none has a number.
    """
    if camera is None or pose.view is None:
        stripes = tuple(piece.uv[::_THIN] for piece in pose.centrelines)
        return stripes, (NUMBERING_UNCLEAR,) * len(stripes)
    low, high = pose.view.uv.min(axis=0), pose.view.uv.max(axis=0)
    margin = 0.5 * (high - low)
    inside = []
    for piece in pose.centrelines:
        near = np.all((piece.uv > low - margin) & (piece.uv < high + margin), axis=1)
        if np.count_nonzero(near) > 1:
            inside.append(piece.select(near))
    straight = straight_lines(inside, camera, limit=2 * lines)
    if not straight:
        stripes = tuple(piece.uv[::_THIN] for piece in inside)
        return stripes, (NUMBERING_UNCLEAR,) * len(stripes)
    across = np.mean([np.abs(line.across) for line in straight], axis=0)
    axis = 0 if across[0] > across[1] else 1
    ordered = sorted(straight, key=lambda line: float(np.median(line.uv[:, axis])))
    known = len(ordered) == lines
    return (
        tuple(line.uv[::_THIN] for line in ordered),
        tuple(k if known else NUMBERING_UNCLEAR for k in range(len(ordered))),
    )


def settings_of(pose: PoseFeatures) -> StripeSettings:
    """Estimate width and contrast of a pose's stripes, so that later pictures need not be searched for them."""
    width = float(np.median(np.concatenate([piece.width for piece in pose.centrelines])))
    strength = float(np.quantile(np.concatenate([piece.strength for piece in pose.centrelines]), 0.2))
    return StripeSettings(WIDTH_IN_SIGMA * width, strength)
