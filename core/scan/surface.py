"""The fused surface: one depth per cell of the picture's grid, and the mesh over it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array


@dataclass(frozen=True, eq=False, slots=True)
class Mesh:
    """Triangles, normals towards the camera.

    Parameters
    ----------
    vertices
        (V, 3) in mm, camera frame.
    normals
        (V, 3) unit normals towards the camera.
    sigma
        (V,) standard uncertainty of the depth in mm.
    triangles
        (T, 3) indices into the vertices.
    """

    vertices: Array
    normals: Array
    sigma: Array
    triangles: NDArray[np.int64]
