"""Binary STL: the mesh for programs that know nothing of normals at points, σ or units."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from core import __version__
from core.files.atomic import write_bytes
from core.scan.surface import Mesh

_HEAD = 80
_TRIANGLE = np.dtype([("normal", "<f4", (3,)), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def write_stl(path: Path, mesh: Mesh, calibration_id: str = "") -> None:
    """Write the triangles of `mesh` as binary STL, in mm, in the camera frame; normals point towards the camera.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    triangles = np.zeros(len(mesh.triangles), dtype=_TRIANGLE)
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    triangles["normal"] = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    triangles["corners"] = corners
    head = f"Trisect {__version__}; unit mm; calibration {calibration_id}".encode("ascii", "replace")[:_HEAD]
    count = np.array(len(triangles), dtype="<u4")
    write_bytes(path, head.ljust(_HEAD) + count.tobytes() + triangles.tobytes())
