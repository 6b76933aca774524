"""The growing cloud of a preview: stripes kept as rays, so that a better light plane costs one product."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.image.centreline import Centreline
from core.model import Camera
from core.model.arrays import Array

Float32 = NDArray[np.float32]


@dataclass(frozen=True, eq=False, slots=True)
class PreviewCloud:
    """Points for display, light enough to be sent from process to process.

    `points` (P, 3) in mm in the camera frame, `sigma` (P,) standard uncertainty of depth in mm, `intensity` (P,) in
    grey levels, `uv` (P, 2) in pixels, `frame` (P,) the index of the frame, −1 for the fan's own points.
    """

    points: Float32
    sigma: Float32
    intensity: Float32
    uv: Float32
    frame: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.points)

    @classmethod
    def joined(cls, clouds: Sequence[PreviewCloud]) -> PreviewCloud:
        """All points of `clouds`, in order."""
        nothing = np.zeros(0, np.float32)
        flat = np.zeros((0, 3), np.float32), nothing, nothing, np.zeros((0, 2), np.float32), np.zeros(0, np.int32)
        parts = [(c.points, c.sigma, c.intensity, c.uv, c.frame) for c in clouds]
        return cls(*(np.concatenate(arrays) for arrays in zip(flat, *parts, strict=True)))


@dataclass(frozen=True, eq=False, slots=True)
class StripeRays:
    """The points of one frame's stripe: `rays` (N, 3), and how far each is off across the stripe, as (N, 2) in x, y."""

    frame: int
    uv: Array
    rays: Array
    across: Array
    intensity: Array
    usable: NDArray[np.bool_]

    @classmethod
    def of(cls, frame: int, pieces: Sequence[Centreline], camera: Camera) -> StripeRays:
        """The points of `pieces`, in their order."""
        uv = np.concatenate([np.zeros((0, 2)), *(piece.uv for piece in pieces)])
        normal = np.concatenate([np.zeros((0, 2)), *(piece.normal for piece in pieces)])
        sigma = np.concatenate([np.zeros(0), *(piece.sigma for piece in pieces)])
        strength = np.concatenate([np.zeros(0), *(piece.strength for piece in pieces)])
        saturated = np.concatenate([np.zeros(0, np.bool_), *(piece.saturated for piece in pieces)])
        rays = camera.rays(uv)
        across = np.einsum("nij,nj->ni", camera.ray_jacobian(rays), normal) * sigma[:, None]
        return cls(frame, uv, rays, across, strength, ~saturated & np.isfinite(rays).all(axis=1))

    def thinned(self, step: int = 2) -> StripeRays:
        """Every `step`-th point; copied, so that the others' memory is free."""
        return StripeRays(
            self.frame,
            self.uv[::step].copy(),
            self.rays[::step].copy(),
            self.across[::step].copy(),
            self.intensity[::step].copy(),
            self.usable[::step].copy(),
        )

    def __len__(self) -> int:
        return len(self.rays)

    def depth(self, pi: Array, covariance: Array) -> tuple[Array, Array]:
        """Depth (N,) in mm on the plane `pi` (3,) with `covariance` (3, 3), and its σ; NaN where there is none."""
        inverse = self.rays @ pi
        inverse = np.where(self.usable & (inverse > 1e-5), inverse, np.nan)
        variance = np.einsum("ni,ij,nj->n", self.rays, covariance, self.rays, optimize=True)
        variance = variance + (self.across @ pi[:2]) ** 2
        return 1 / inverse, np.sqrt(np.maximum(variance, 0)) / inverse**2

    def cloud(self, depth: Array, sigma: Array, keep: NDArray[np.bool_]) -> PreviewCloud:
        """The points that `keep` (N,) selects, at `depth` (N,)."""
        return PreviewCloud(
            (self.rays[keep] * depth[keep, None]).astype(np.float32),
            sigma[keep].astype(np.float32),
            self.intensity[keep].astype(np.float32),
            self.uv[keep].astype(np.float32),
            np.full(np.count_nonzero(keep), self.frame, np.int32),
        )
