"""Camera model: full intrinsics with skew, Brown–Conrady distortion, and rays.

Pinhole with skew (paper, eq. 1)::

    u = α x_d + γ y_d + u0
    v =         β y_d + v0

and Brown–Conrady distortion (paper, eq. 2, whose print is wrong; this is the model it means, and OpenCV's)::

    x_d = x (1 + k1 r² + k2 r⁴ + k3 r⁶) + 2 p1 x y + p2 (r² + 2 x²)
    y_d = y (1 + k1 r² + k2 r⁴ + k3 r⁶) + p1 (r² + 2 y²) + 2 p2 x y,     r² = x² + y²

The centre of the first pixel is (0, 0). A ray is r = (x, y, 1) with x, y undistorted; a point at depth z on it
is X = z r.

References
----------
Sun et al., Sensors 2023, 23, 13, §3.1, doi:10.3390/s23010013.
Brown, D. C., Decentering distortion of lenses, Photogrammetric Engineering 32 (1966).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from core.errors import WrongValue
from core.messages import Message
from core.model.arrays import Array, frozen_array, set_field
from core.model.pose import Pose

DISTORTION_NAMES = ("k1", "k2", "p1", "p2", "k3")
"""Names and order of the distortion coefficients."""


@dataclass(frozen=True, eq=False, slots=True)
class Camera:
    """Intrinsics and distortion of one camera at one picture size.

    Parameters
    ----------
    image_size
        (width, height) in pixels.
    matrix
        (3, 3), [[α, γ, u0], [0, β, v0], [0, 0, 1]] in pixels.
    distortion
        (5,), k1, k2, p1, p2, k3; four values mean k3 = 0.

    Raises
    ------
    WrongValue
        If a shape is wrong, a value is not finite, or a focal length is not positive.
    """

    image_size: tuple[int, int]
    matrix: Array
    distortion: Array = field(default_factory=lambda: np.zeros(5))

    def __post_init__(self) -> None:
        width, height = self.image_size
        set_field(self, "image_size", (int(width), int(height)))
        set_field(self, "matrix", frozen_array(self.matrix, (3, 3), "matrix"))
        coefficients = np.zeros(5)
        given = np.asarray(self.distortion, dtype=np.float64).ravel()
        if given.size not in (4, 5):
            raise WrongValue(
                Message("model.distortion_count", "distortion has {n} values, not 4 or 5", n=int(given.size))
            )
        coefficients[: given.size] = given
        set_field(self, "distortion", frozen_array(coefficients, (5,), "distortion"))
        if width <= 0 or height <= 0:
            raise WrongValue(
                Message(
                    "model.image_size",
                    "an image size of {width} × {height} is not positive",
                    width=width,
                    height=height,
                )
            )
        if not (np.isfinite(self.matrix).all() and np.isfinite(self.distortion).all()):
            raise WrongValue(Message("model.camera_not_finite", "matrix and distortion must be finite"))
        if self.matrix[0, 0] <= 0 or self.matrix[1, 1] <= 0:
            raise WrongValue(
                Message("model.focal_length", "the focal lengths on the diagonal of matrix must be positive")
            )

    @property
    def focal(self) -> float:
        """Geometric mean of the two focal lengths, in pixels."""
        return float(np.sqrt(self.matrix[0, 0] * self.matrix[1, 1]))

    def scaled(self, factor: float) -> Camera:
        """Make the camera of pictures resized by `factor`, their pixel edges kept in place."""
        width, height = self.image_size
        matrix = self.matrix.copy()
        matrix[:2] *= factor
        matrix[:2, 2] += (factor - 1) / 2
        return Camera((round(width * factor), round(height * factor)), matrix, self.distortion)

    def project(self, points: ArrayLike) -> Array:
        """Project `points` (N, 3) in mm in the camera frame to image points (N, 2) in pixels."""
        xyz = np.asarray(points, dtype=np.float64)
        return self.pixels(xyz[:, :2] / xyz[:, 2:])

    def project_pose(self, pose_cam_target: Pose, points: ArrayLike) -> Array:
        """Project `points` (N, 3) in mm in the frame of a target to image points (N, 2) in pixels."""
        return self.project(pose_cam_target.apply(points))

    def pixels(self, xy: ArrayLike) -> Array:
        """Compute image points (N, 2) in pixels of undistorted ray coordinates `xy` (N, 2)."""
        distorted = self.distort(np.asarray(xy, dtype=np.float64))
        return distorted @ self.matrix[:2, :2].T + self.matrix[:2, 2]

    def distort(self, xy: Array) -> Array:
        """Apply the lens distortion to undistorted ray coordinates `xy` (N, 2), x/z and y/z."""
        k1, k2, p1, p2, k3 = self.distortion
        x, y = xy[:, 0], xy[:, 1]
        r2 = x * x + y * y
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        return np.column_stack(
            [
                x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
                y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
            ]
        )

    def distort_jacobian(self, xy: Array) -> Array:
        """Compute the derivatives (N, 2, 2) of distorted by undistorted ray coordinates at `xy` (N, 2)."""
        k1, k2, p1, p2, k3 = self.distortion
        x, y = xy[:, 0], xy[:, 1]
        r2 = x * x + y * y
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        slope = 2 * (k1 + r2 * (2 * k2 + r2 * 3 * k3))  # ∂radial/∂x = slope · x
        jacobian = np.empty((len(x), 2, 2))
        jacobian[:, 0, 0] = radial + slope * x * x + 2 * p1 * y + 6 * p2 * x
        jacobian[:, 0, 1] = slope * x * y + 2 * p1 * x + 2 * p2 * y
        jacobian[:, 1, 0] = jacobian[:, 0, 1]
        jacobian[:, 1, 1] = radial + slope * y * y + 6 * p1 * y + 2 * p2 * x
        return jacobian

    def undistort(self, uv: ArrayLike) -> Array:
        """Compute undistorted ray coordinates x/z, y/z (N, 2) of image points `uv` (N, 2) in px; NaN if none.

        By Newton's method to 1e-12. A point outside the region where the distortion is one-to-one does not converge.
        """
        from core.model.undistortion import undistorted  # compiled: a window starts without

        points = np.asarray(uv, dtype=np.float64).reshape(-1, 2)
        distorted = (points - self.matrix[:2, 2]) @ np.linalg.inv(self.matrix[:2, :2]).T
        return np.asarray(undistorted(distorted, self.distortion))

    def rays(self, uv: ArrayLike) -> Array:
        """Compute undistorted rays r = (x, y, 1), (N, 3), of image points `uv` (N, 2) in px."""
        xy = self.undistort(uv)
        return np.column_stack([xy, np.ones(len(xy))])

    def ray_jacobian(self, rays: Array) -> Array:
        """Compute the derivatives (N, 2, 2) in 1/px of the x, y of `rays` (N, 3) by the image point (u, v)."""
        forward: Array = self.matrix[:2, :2] @ self.distort_jacobian(rays[:, :2])
        (a, b), (c, d) = np.moveaxis(forward, 0, 2)
        inverse = np.array([[d, -b], [-c, a]]) / (a * d - b * c)
        return np.ascontiguousarray(np.moveaxis(inverse, 2, 0))

    def inverse_depth_slopes(self, pi: Array, rays: Array, directions: Array) -> Array:
        """Compute ∂(1/z) (N,) in 1/(mm px) along `directions` (N, 2) of the picture, of light in a plane `pi` (3,)."""
        return np.asarray(np.einsum("i,nij,nj->n", pi[:2], self.ray_jacobian(rays), directions), dtype=np.float64)
