"""From centrelines and light planes to points with their σ."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from core.image.centreline import Centreline
from core.model import Camera
from core.model.arrays import Array
from core.scan.cloud import Cloud


def triangulate(centreline: Centreline, pi: Array, covariance: Array, camera: Camera, frame: int, sweep: int) -> Cloud:
    """Points of one centreline on the light plane `pi` (3,), with `covariance` (3, 3).

    With r the ray and n the centreline's normal, in inverse depth w = π·r: var(w) = rᵀ Σ r + (∂w/∂(u,v)·n)² σ², and
    σ_z = z² σ_w. Points that the plane puts behind the camera, and saturated ones, are left out.
    """
    rays = camera.rays(centreline.uv)
    inverse_depth = rays @ pi
    keep = (inverse_depth > 1e-5) & ~centreline.saturated & np.isfinite(inverse_depth)
    centreline, rays, inverse_depth = centreline.select(keep), rays[keep], inverse_depth[keep]
    slope = np.einsum("i,nij,nj->n", pi[:2], camera.ray_jacobian(rays), centreline.normal)
    variance = np.einsum("ni,ij,nj->n", rays, covariance, rays) + (slope * centreline.sigma) ** 2
    depth = 1 / inverse_depth
    count = len(rays)
    return Cloud(
        points=rays * depth[:, None],
        uv=centreline.uv,
        sigma=depth**2 * np.sqrt(np.maximum(variance, 0)),
        intensity=centreline.strength,
        frame=np.full(count, frame),
        sweep=np.full(count, sweep),
        normals=np.zeros((count, 3)),
    )


def join(clouds: list[Cloud]) -> Cloud:
    """All points of `clouds`, in order."""
    if not clouds:
        empty, index = np.zeros(0), np.zeros(0, dtype=np.int64)
        return Cloud(np.zeros((0, 3)), np.zeros((0, 2)), empty, empty, index, index, np.zeros((0, 3)))
    return Cloud(*(np.concatenate([getattr(cloud, field.name) for cloud in clouds]) for field in fields(Cloud)))
