"""From where the scene is seen: a camera of the 3D view, its projection and its motions. Numpy only.

The projection here is the only one: VTK is given the same numbers, and labels, picking and regions are projected with
them, so what is chosen is what is seen. Screen coordinates are in logical pixels, (0, 0) at the upper left corner.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.inspect.shown.view_frame import CAMERA_FRAME, FrameKind, ViewFrame
from core.model.arrays import Array

VIEW_ANGLE = np.radians(30.0)
"""Height of the picture as an angle, in perspective."""

DEGREES_PER_PIXEL = 0.35
"""How far a drag turns the scene."""

BORDER_PX = 10
"""What fills the picture leaves so much free on every side: names stand above what they name."""


@dataclass(frozen=True, eq=False, slots=True)
class Orientation:
    """Orientation of a frame: up and north, away from the viewer of the front view, unit vectors (3,).

    `origin` (3,) in mm is where the lines of a grid are counted from.
    """

    up: Array
    north: Array
    origin: Array

    @classmethod
    def of(cls, frame: ViewFrame) -> Orientation:
        """Make the orientation of a view frame: up is its z and north its y; both reversed in the camera's frame."""
        _, y, z = frame.axes if frame.kind is not FrameKind.CAMERA else -frame.axes
        return cls(z, y, frame.pose_camera_frame.translation)

    @property
    def east(self) -> Array:
        """Unit vector (3,) that points to the right in the front view."""
        return np.cross(self.north, self.up)

    @property
    def axes(self) -> Array:
        """Unit vectors to the east, north and up, as rows (3, 3)."""
        return np.array([self.east, self.north, self.up])

    def direction(self, view: str) -> tuple[Array, Array]:
        """Return two unit vectors (3,) of a standard view: towards the viewer, and up on the screen."""
        up, north, east = self.up, self.north, self.east
        corner = 0.55 * east - 0.75 * north + 0.6 * up
        return {
            "front": (-north, up),
            "back": (north, up),
            "left": (-east, up),
            "right": (east, up),
            "top": (up, north),
            "bottom": (-up, north),
            "iso": (corner / np.linalg.norm(corner), up),
        }[view]


FROM_CAMERA = Orientation.of(CAMERA_FRAME)
"""Without other knowledge: up is towards the camera, north is up in its picture."""


@dataclass(frozen=True, eq=False, slots=True)
class SceneCamera:
    """Camera that looks at `focal` (3,) from `distance` mm.

    `axes` (3, 3) are the rows right, up and back (towards the viewer). In parallel projection the scale is that of
    the perspective at the focal point, so switching changes no size there.
    """

    focal: Array
    axes: Array
    distance: float
    view_angle: float = VIEW_ANGLE
    parallel: bool = False

    @classmethod
    def looking(cls, back: ArrayLike, up: ArrayLike, focal: ArrayLike, distance: float) -> SceneCamera:
        """Make a camera `distance` mm from `focal` in the direction `back`, with `up` upwards on the screen."""
        return cls(np.asarray(focal, dtype=np.float64), _axes(back, up), float(distance))

    @property
    def position(self) -> Array:
        """Position (3,) of the camera in mm."""
        where: Array = self.focal + self.axes[2] * self.distance
        return where

    @property
    def half_height(self) -> float:
        """Half the height in mm that the picture covers at the focal point."""
        return float(self.distance * np.tan(self.view_angle / 2))

    def pixels_per_mm(self, size: tuple[int, int]) -> float:
        """Compute how many pixels a mm at the focal point has in a picture of `size` (width, height) px."""
        return float(size[1] / 2 / self.half_height)

    def project(self, points: ArrayLike, size: tuple[int, int]) -> tuple[Array, Array]:
        """Project points (N, 3) in mm to screen coordinates (N, 2) in px and depths (N,) in mm.

        A point at or behind the viewer has a depth ≤ 0 and NaN for coordinates.
        """
        given = np.asarray(points)
        kind = np.dtype(np.float32 if given.dtype == np.float32 else np.float64)
        xyz = given.reshape(-1, 3).astype(kind, copy=False)
        local: NDArray[Any] = self.axes.astype(kind) @ xyz.T
        local -= (self.axes @ self.focal).astype(kind)[:, None]
        depth = self.distance - local[2]
        scale = np.full(1, self.pixels_per_mm(size), dtype=kind)
        if not self.parallel:
            with np.errstate(divide="ignore", invalid="ignore"):
                scale = scale * self.distance / depth
            scale[depth <= 0] = np.nan
        local[0] *= scale
        local[1] *= -scale
        local[:2] += np.array(size, dtype=kind)[:, None] / 2
        return local[:2].T, depth

    def orbited(self, dx: float, dy: float, up: ArrayLike) -> SceneCamera:
        """Return the camera turned by a drag of (dx, dy) px about `up` and the screen's horizontal."""
        pole = np.asarray(up, dtype=np.float64)
        axes = self.axes @ _rotation(pole, -np.radians(DEGREES_PER_PIXEL) * dx).T
        tilt = np.radians(DEGREES_PER_PIXEL) * dy
        rise = np.arctan2(axes[2] @ pole, axes[1] @ pole)  # of the viewer above the horizon, as far as it is upright
        lowest, highest = min(-np.pi / 2, rise), max(np.pi / 2, rise)
        tilt = float(np.clip(rise + tilt, lowest, highest) - rise)
        axes = axes @ _rotation(axes[0], -tilt).T
        return replace(self, axes=_axes(axes[2], axes[1]))

    def turned(self, before: Orientation, after: Orientation) -> SceneCamera:
        """Return the camera turned so that it sees the orientation `after` as it saw `before`."""
        return replace(self, axes=self.axes @ before.axes.T @ after.axes)

    def panned(self, dx: float, dy: float, size: tuple[int, int]) -> SceneCamera:
        """Return the camera moved so that the scene follows a drag of (dx, dy) px."""
        scale = self.pixels_per_mm(size)
        return replace(self, focal=self.focal - (self.axes[0] * dx - self.axes[1] * dy) / scale)

    def zoomed(self, factor: float, at: tuple[float, float], size: tuple[int, int]) -> SceneCamera:
        """Return the camera moved nearer by `factor`, with the place at the screen point `at` staying there."""
        dx, dy = at[0] - size[0] / 2, at[1] - size[1] / 2
        nearer = replace(self, distance=self.distance / factor)
        return nearer.panned(dx * (1 - factor), dy * (1 - factor), size)

    def fitted(self, points: Array, size: tuple[int, int], margin: tuple[int, int] = (0, 0)) -> SceneCamera:
        """Return the camera moved, in the same direction, so that `points` (N, 3) in mm fill the picture.

        `margin` are pixels to leave free at the right and at the lower edge, besides BORDER_PX on every side.
        """
        if len(points) == 0:
            return self
        local = np.asarray(points, dtype=np.float64) @ self.axes.T
        low, high = local.min(axis=0), local.max(axis=0)
        middle = (low + high) / 2
        x, y, z = (local - middle).T
        free = [max(whole - less - 2 * BORDER_PX, 1) for whole, less in zip(size, margin, strict=True)]
        tangent = np.tan(self.view_angle / 2)
        tall, wide = tangent * free[1] / size[1], tangent * free[0] / size[1]
        towards = 0.0 if self.parallel else z
        distance = float(np.max([np.abs(x) / wide + towards, np.abs(y) / tall + towards]) * 1.06)
        distance = max(distance, float(np.linalg.norm(high - low)) * 0.02, 1e-3)
        moved = replace(self, focal=middle @ self.axes, distance=distance)
        return moved.panned(-margin[0] / 2, -margin[1] / 2, size)

    def depth_range(self, corners: Array) -> tuple[float, float]:
        """Compute the nearest and the farthest depth in mm to draw, around the points `corners` (N, 3)."""
        depth = self.distance - (corners - self.focal) @ self.axes[2]
        room = max(0.02 * float(depth.max() - depth.min()), 0.01 * self.distance)  # marks are drawn a little nearer
        near, far = float(depth.min()) - room, float(depth.max()) + room
        if not self.parallel:
            far = max(far, self.distance * 0.01)
            near = max(near, far / 2000)
        return near, far


def _axes(back: ArrayLike, up: ArrayLike) -> Array:
    b = np.asarray(back, dtype=np.float64)
    b = b / np.linalg.norm(b)
    right = np.cross(np.asarray(up, dtype=np.float64), b)
    right = right / np.linalg.norm(right)
    return np.array([right, np.cross(b, right), b])


def _rotation(axis: Array, angle: float) -> Array:
    """Matrix (3, 3) that turns about a unit vector (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turned: Array = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return turned


def from_origin(points: Array, size: tuple[int, int], pyramid: Array | None) -> SceneCamera:
    """Make the camera that sees `points` as the measuring camera does: from the origin along +z, with −y up.

    `pyramid` (5, 3) are its centre and the corners of its picture, which is then shown whole; without it `points`
    (N, 3) are.
    """
    seen = points[points[:, 2] > 0] if len(points) else points
    shown = pyramid[1:] if pyramid is not None else seen
    if not len(shown):
        shown = np.array([[-100.0, -100.0, 500.0], [100.0, 100.0, 500.0]])
    slopes = shown[:, :2] / shown[:, 2:]
    low, high = slopes.min(axis=0), slopes.max(axis=0)
    middle = np.append((low + high) / 2, 1.0)
    depth = float(np.median(seen[:, 2])) if len(seen) else float(np.median(shown[:, 2]))
    half = float(max((high - low)[1], (high - low)[0] * size[1] / max(size[0], 1))) / 2 / float(middle @ middle) ** 0.5
    camera = SceneCamera.looking(-middle, (0.0, -1.0, 0.0), middle * depth, depth * float(np.linalg.norm(middle)))
    return replace(camera, view_angle=2 * float(np.arctan(max(half, 1e-4) * 1.04)))
