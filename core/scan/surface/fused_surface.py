"""The fused surface: at most one point per cell of the picture's grid, and the mesh over it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array, frozen_array, set_field


@dataclass(frozen=True, eq=False, slots=True)
class Surface:
    """Fused surface of a scan: one point for each cell of the picture's grid that light fell on.

    Cells are squares of `cell_px` pixels; cell (row, column) holds the pixels whose centres lie in it. Cells between
    two stripes are empty: only the M occupied ones are stored.

    Parameters
    ----------
    image_size
        (width, height) of the picture in pixels.
    cell_px
        Side of a cell in pixels.
    cells
        (M,) row · columns + column of each occupied cell, ascending.
    points
        (M, 3) fused points in mm, camera frame.
    uv
        (M, 2) weighted mean of the pixels its points were seen at.
    sigma
        (M,) standard uncertainty of the fused depth in mm, without what is common to the whole scan.
    intensity
        (M,) weighted mean strength of the stripe in grey levels.
    count
        (M,) points fused.
    normals
        (M, 3) unit normals towards the camera; zero where unknown.
    member
        (N,) for each point of the cloud the index of its fused point, −1 where it was left out.
    """

    image_size: tuple[int, int]
    cell_px: float
    cells: NDArray[np.int64]
    points: Array
    uv: Array
    sigma: Array
    intensity: Array
    count: NDArray[np.int64]
    normals: Array
    member: NDArray[np.int64]

    def __post_init__(self) -> None:
        total = len(self.points)
        for name, shape in (
            ("points", (total, 3)),
            ("uv", (total, 2)),
            ("sigma", (total,)),
            ("intensity", (total,)),
            ("normals", (total, 3)),
        ):
            set_field(self, name, frozen_array(getattr(self, name), shape, name))
        for name, length in (("cells", total), ("count", total), ("member", len(self.member))):
            index = np.array(getattr(self, name), dtype=np.int64).reshape(length)
            index.flags.writeable = False
            set_field(self, name, index)

    def __len__(self) -> int:
        return len(self.points)

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of rows and columns of the grid of cells over the picture."""
        return grid_shape(self.image_size, self.cell_px)

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Mask (rows, columns), True where a cell has a fused point."""
        mask = np.zeros(self.shape, dtype=np.bool_)
        mask.ravel()[self.cells] = True
        return mask

    @property
    def depth(self) -> Array:
        """Fused depth (rows, columns) in mm; NaN in empty cells."""
        return self.grid(self.points[:, 2])

    def grid(self, values: Array) -> Array:
        """Lay out `values` (M,) of the fused points on the grid of cells, as (rows, columns); NaN in empty cells."""
        laid = np.full(self.shape, np.nan)
        laid.ravel()[self.cells] = values
        return laid


def grid_shape(image_size: tuple[int, int], cell_px: float) -> tuple[int, int]:
    """Compute how many rows and columns of cells cover a picture of `image_size` (width, height)."""
    width, height = image_size
    return int(np.ceil(height / cell_px)), int(np.ceil(width / cell_px))


@dataclass(frozen=True, eq=False, slots=True)
class Mesh:
    """Triangle mesh of a scan's surface, with σ of each vertex and a mark on triangles that only fill holes.

    Parameters
    ----------
    vertices
        (V, 3) in mm, camera frame.
    normals
        (V, 3) unit normals towards the camera.
    sigma
        (V,) standard uncertainty of the depth in mm.
    triangles
        (T, 3) indices into the vertices; seen from the camera each runs the same way round, so that
        (b − a) × (c − a) points towards the camera.
    filled
        (T,) True for triangles over a hole, where nothing was measured: they are shown, and never measured on.
    """

    vertices: Array
    normals: Array
    sigma: Array
    triangles: NDArray[np.int64]
    filled: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=np.bool_))

    def __post_init__(self) -> None:
        if len(self.filled) != len(self.triangles):
            set_field(self, "filled", np.zeros(len(self.triangles), dtype=np.bool_))

    @property
    def measured(self) -> NDArray[np.bool_]:
        """Mask (V,) of the vertices that are a corner of a measured triangle."""
        on = np.zeros(len(self.vertices), dtype=np.bool_)
        on[self.triangles[~self.filled]] = True
        return on
