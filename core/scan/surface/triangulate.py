"""Triangulation: from centrelines and light planes to points with their σ."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from core.image.stripes.centreline import Centreline
from core.image.stripes.runs import arc_length
from core.model import Camera
from core.model.arrays import Array
from core.model.robust import median
from core.scan.network.read_out import row_forms, row_planes
from core.scan.surface.cloud import Cloud

LEAST_VARIANCE_SHARE = 0.2
"""Of a point's variance that is left at least, however much the plane undoes of it: the covariance is an estimate."""
LEAST_INVERSE_DEPTH = 1e-5
"""In 1/mm, 100 m: what is farther lies behind the camera or is no measurement."""


@dataclass(frozen=True, eq=False, slots=True)
class OwnLine:
    """Covariance of a light plane with the centreline it is triangulated with, for crossings on that line fixed it.

    `covariance` (C, 3) in 1/mm of π̂ − π with the errors z of the line's cells of `cell_px`, from its beginning on, or
    (C, 3·(1 + K)) where planes change with the rows; see
    `core.scan.network.adjustment.Network.line_covariance`.
    """

    covariance: Array
    cell_px: float

    def with_noise(self, centreline: Centreline, rays: Array, forms: Array, slope: Array, focal: float) -> Array:
        """Compute the covariance (N,) in 1/mm² of π̂·r with the error that the centreline's own noise makes in it.

        A cell's mean is off by z times its standard deviation. Points are averages over cells; the covariance changes
        so little from one to the next that an average of it is its value at the point.
        """
        middle = arc_length(focal * rays) / self.cell_px - 0.5
        cells = np.arange(len(self.covariance))
        here = np.column_stack([np.interp(middle, cells, column) for column in self.covariance.T])
        of_cell = median(centreline.sigma) * np.sqrt(centreline.correlation_px / self.cell_px)
        return np.asarray(slope * of_cell * np.einsum("ni,ni->n", forms, here))


def triangulate(
    centreline: Centreline,
    pi: Array,
    covariance: Array,
    camera: Camera,
    frame: int,
    sweep: int,
    own: OwnLine | None = None,
) -> Cloud:
    """Triangulate the points of one centreline on the light plane `pi` (3,), in 1/mm, with `covariance` (3, 3).

    Both are larger where each row sees another plane (`core.scan.network.read_out`).
    With r the ray and n the centreline's normal, in inverse depth w = π·r: var(w) = rᵀ Σ r + (∂w/∂(u,v)·n)² σ² + 2 c,
    and σ_z = z² σ_w. The plane goes where its crossings are, so it follows the line's noise and undoes some of it: c,
    by `own`, is mostly negative. Points that the plane puts behind the camera, and saturated ones, are left out, and
    those of a plane that is known so little that rᵀ Σ r is lost in rounding, and below 0: their σ is not known.
    """
    rays, rows = camera.rays(centreline.uv), camera.image_size[1]
    forms = row_forms(rays, centreline.uv[:, 1], rows, len(pi))
    inverse_depth = forms @ pi
    plane = np.broadcast_to(row_planes(pi[None], centreline.uv[:, 1], rows)[:, :2], (len(rays), 2))
    slope = np.einsum("ni,nij,nj->n", plane, camera.ray_jacobian(rays), centreline.normal)
    of_plane = np.einsum("ni,ij,nj->n", forms, covariance, forms)
    variance = of_plane + (slope * centreline.sigma) ** 2
    if own is not None and len(own.covariance):
        common = own.with_noise(centreline, rays, forms, slope, camera.focal)
        variance = np.maximum(variance + 2 * common, LEAST_VARIANCE_SHARE * variance)
    keep = (inverse_depth > LEAST_INVERSE_DEPTH) & ~centreline.saturated & np.isfinite(inverse_depth) & (of_plane >= 0)
    centreline, rays, inverse_depth = centreline.select(keep), rays[keep], inverse_depth[keep]
    variance, slope = variance[keep], slope[keep]
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
        skewness=-np.sign(slope) * centreline.skewness,
        spread_mm=depth**2 * np.abs(slope) * centreline.width,
    )


def join(clouds: list[Cloud]) -> Cloud:
    """Concatenate the points of several clouds, in order, to one."""
    if not clouds:
        empty, index = np.zeros(0), np.zeros(0, dtype=np.int64)
        return Cloud(np.zeros((0, 3)), np.zeros((0, 2)), empty, empty, index, index, np.zeros((0, 3)))
    return Cloud(*(np.concatenate([getattr(cloud, field.name) for cloud in clouds]) for field in fields(Cloud)))
