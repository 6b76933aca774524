"""A plane that is laid through measured points by hand, and the profile seen in it at once. Light to import.

It is looked at, not measured: `CutPlane.section` is the cross-section that measures what is shown.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.inspect.plan.feature_spec import Section
from core.inspect.profile import averaged
from core.inspect.shown.shown_features import ShownProfile
from core.inspect.shown.view_frame import FrameKind, ViewFrame
from core.model import Pose
from core.model.arrays import Array

AXES = ("x", "y", "z")
"""What a plane can be square to."""
UPRIGHT = 2
"""So many of them, the first, are those of planes that stand upright: cross-sections can measure what they show."""
USUAL = Section()
"""Its half width and its step are those of the profile that is shown."""
MOST_DRAWN = 2_000
"""So many points of the profile are drawn while the plane is moved."""
BEYOND = 0.05
"""The plane is drawn larger than the points reach by this share of their reach, on every side."""


ACROSS, HEIGHT = (1, 0, 0), (2, 2, 1)
"""By the axis a plane is square to: the axis along which a profile in it runs, and that of the profile's heights."""


def turned_for(frame: ViewFrame, axis: int, turned_deg: float, tilted_deg: float) -> ViewFrame:
    """Rotate the frame of a cutting plane square to `axis` about the plane's height axis, then about its run.

    A turned plane square to x or y stays upright; a tilted one does not.
    """
    if turned_deg:
        frame = frame.turned(HEIGHT[axis], turned_deg)
    return frame.turned(ACROSS[axis], tilted_deg) if tilted_deg else frame


@dataclass(frozen=True, eq=False, slots=True)
class CutPlane:
    """Plane on which coordinate number `axis` (an index of AXES) of `frame` is `at_mm`.

    A plane at any angle stands in a frame that is turned (`turned_for`).
    """

    frame: ViewFrame
    axis: int
    at_mm: float

    @property
    def normal(self) -> Array:
        """Unit vector (3,) of the axis the plane is square to, in the camera frame."""
        normal: Array = self.frame.axes[self.axis]
        return normal

    @property
    def upwards(self) -> int:
        """Sign of heights in the profile: 1, or −1 in the camera frame, whose z points away from the viewer."""
        return -1 if self.frame.kind is FrameKind.CAMERA else 1

    @property
    def across(self) -> int:
        """Index (0, 1 or 2) of the frame's axis along which positions in the profile are counted."""
        return ACROSS[self.axis]

    @property
    def height(self) -> int:
        """Index (0, 1 or 2) of the frame's axis along which heights in the profile are counted."""
        return HEIGHT[self.axis]

    def corners(self, coordinates: Array) -> Array:
        """Compute the corners (4, 3) in mm of the camera frame of a patch of the plane that spans `coordinates` (N, 3).

        Its lower edge comes first.
        """
        low, high = coordinates.min(axis=0), coordinates.max(axis=0)
        low, high = low - BEYOND * (high - low), high + BEYOND * (high - low)
        places = np.full((4, 3), self.at_mm)
        places[:, self.across] = np.array([low, high, high, low])[:, self.across]
        lower, upper = (low[self.height], high[self.height])[:: self.upwards]
        places[:, self.height] = lower, lower, upper, upper
        return self.frame.pose_camera_frame.apply(places)

    def profile(self, coordinates: Array) -> ShownProfile:
        """Cut points (N, 3), given in mm in the plane's frame, and return the profile of those near the plane.

        An outline, as a plane square to z cuts it, has no mean line.
        """
        near = coordinates[np.abs(coordinates[:, self.axis] - self.at_mm) <= USUAL.half_width_mm]
        position, height = near[:, self.across], self.upwards * near[:, self.height]
        drawn = slice(None) if self.axis < UPRIGHT else slice(0)
        means = averaged(position[drawn], height[drawn], USUAL.step_mm)
        return ShownProfile.of(position, height, means, USUAL.step_mm, MOST_DRAWN)

    def section(self, pose_camera_part: Pose | None) -> Section:
        """Make the plan's section for this plane; without part coordinates (None), in the camera frame."""
        pose = Pose.identity() if pose_camera_part is None else pose_camera_part
        place = np.zeros(3)
        place[self.axis] = self.at_mm
        place = pose.inverse().apply(self.frame.pose_camera_frame.apply(place))
        # a section's positions run along z × normal of its coordinates: so that they run as those shown
        runs = np.cross(pose.rotation[:, 2], self.normal) @ self.frame.axes[self.across]
        normal = pose.rotation.T @ self.normal * (1 if runs >= 0 else -1)
        return Section(point_mm=_three(place, 3), normal=_three(normal, 9))


def _three(values: Array, decimals: int) -> tuple[float, float, float]:
    x, y, z = (round(float(value), decimals) + 0.0 for value in values)
    return x, y, z
