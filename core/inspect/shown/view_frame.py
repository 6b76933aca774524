"""The frame in which points are looked at and handed over: the part's as far as it is known, else the camera's.

Results stay in the camera frame; a view turns about the axes of its frame and reads coordinates out in it, an export
is written in it. Light to import.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike

from core.messages import label
from core.model import LightPlane, Pose
from core.model.arrays import Array


class FrameKind(StrEnum):
    """Kind of a frame, by what it rests on."""

    CAMERA = "camera"
    GROUND = "ground"
    """On the lower face's plane, z out of it."""
    PART = "part"
    """The part coordinates of an inspection plan."""


FRAME_NAMES: Mapping[FrameKind, str] = {
    FrameKind.CAMERA: label("as the camera sees it"),
    FrameKind.GROUND: label("z up from the lower face"),
    FrameKind.PART: label("part coordinates"),
}
"""As they are shown beside coordinates."""


@dataclass(frozen=True, eq=False, slots=True)
class Ground:
    """Frame of the surface: rows of `axes` are along (picture's right), across, and up; `origin` lies on it."""

    axes: Array
    origin: Array

    @classmethod
    def of(cls, plane: LightPlane | None, points: Array) -> Ground:
        """Make the ground frame: up is out of `plane`, or, if None, opposite to the camera's viewing direction."""
        away = np.array([0.0, 0.0, 1.0]) if plane is None else plane.normal
        along = np.array([1.0, 0.0, 0.0]) - away[0] * away
        along /= np.linalg.norm(along)
        up = -away
        farthest = float(np.quantile(points @ away, 0.999)) if len(points) else 0.0
        distance = farthest if plane is None else plane.d_mm
        return cls(np.array([along, np.cross(up, along), up]), away * distance)

    def local(self, points: Array) -> Array:
        """Transform `points` (N, 3) in mm from the camera frame into this frame: along, across, height."""
        local: Array = (points - self.origin) @ self.axes.T
        return local


@dataclass(frozen=True, eq=False, slots=True)
class ViewFrame:
    """Frame in which points are viewed: `pose_camera_frame` maps its coordinates into the camera frame."""

    kind: FrameKind
    pose_camera_frame: Pose

    @property
    def axes(self) -> Array:
        """Unit vectors of the frame's x, y and z axis as rows (3, 3), in the camera frame."""
        return self.pose_camera_frame.rotation.T

    def coordinates(self, points: ArrayLike) -> Array:
        """Transform `points` (N, 3) or (3,) in mm from the camera frame into this view frame."""
        if self.kind is FrameKind.CAMERA:
            return np.asarray(points, dtype=np.float64)  # to the bit
        return self.pose_camera_frame.inverse().apply(points)

    def directions(self, vectors: Array) -> Array:
        """Rotate `vectors` (N, 3) from the camera frame into this view frame, keeping their lengths."""
        if self.kind is FrameKind.CAMERA:
            return vectors
        turned: Array = vectors @ self.pose_camera_frame.rotation
        return turned

    def same_as(self, other: ViewFrame) -> bool:
        """Whether another view frame has the same kind and pose as this view frame."""
        ours, theirs = self.pose_camera_frame, other.pose_camera_frame
        return (
            self.kind is other.kind
            and np.array_equal(ours.rotation, theirs.rotation)
            and np.array_equal(ours.translation, theirs.translation)
        )

    def turned(self, about: int, degrees: float) -> ViewFrame:
        """Rotate the frame about its axis number `about` by `degrees`, right-handed; the origin stays."""
        angle, turn = np.radians(degrees), np.eye(3)
        first, second = (about + 1) % 3, (about + 2) % 3
        turn[first, first] = turn[second, second] = np.cos(angle)
        turn[second, first], turn[first, second] = np.sin(angle), -np.sin(angle)
        ours = self.pose_camera_frame
        return ViewFrame(self.kind, Pose(ours.rotation @ turn, ours.translation))


CAMERA_FRAME = ViewFrame(FrameKind.CAMERA, Pose.identity())


def shown_frame(part: ViewFrame | None, *, wanted: bool) -> ViewFrame:
    """Choose the frame to show points in: the part's if it is known and `wanted`, else the camera's."""
    return part if part is not None and wanted else CAMERA_FRAME


def part_frame(pose_camera_part: Pose | None, lower: LightPlane | None) -> ViewFrame | None:
    """Choose the part's own frame: its part coordinates, else a frame on its lower face; None without either.

    Parameters
    ----------
    pose_camera_part
        Part coordinates into the camera frame, where an inspection has any.
    lower
        Plane of the lower face, where a thickness was measured. Its frame has z out of it, towards the camera, x along
        the camera's, and its origin where the camera's centre falls on it.
    """
    if pose_camera_part is not None:
        return ViewFrame(FrameKind.PART, pose_camera_part)
    if lower is None:
        return None
    ground = Ground.of(lower, np.empty((0, 3)))
    return ViewFrame(FrameKind.GROUND, Pose(ground.axes.T, ground.origin))
