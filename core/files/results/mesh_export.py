"""The mesh as OBJ, STL and 3MF: triangles over filled holes told apart from those measured, where the format can."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from core import __version__
from core.files.atomic import write_bytes, write_text
from core.files.results.frame_text import SHORT, frame_words
from core.files.stl import HEAD, TRIANGLE
from core.inspect.shown.view_frame import CAMERA_FRAME, ViewFrame
from core.model.arrays import Array
from core.scan.surface.fused_surface import Mesh

_EPOCH = (1980, 1, 1, 0, 0, 0)
"""The time of all parts of a 3MF file, so that the same mesh gives the same bytes."""
_CONTENT_TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>'
)
_RELATIONS = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Target="/3D/3dmodel.model" Id="rel0" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)


def write_obj(path: Path, mesh: Mesh, frame: ViewFrame = CAMERA_FRAME) -> None:
    """Write a mesh as Wavefront OBJ in mm, measured and filled triangles as groups; InputError if that fails.

    Places and directions are those of `frame`, which the head names.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    head = f"# Trisect {__version__}\n# unit mm; {frame_words(frame.kind)}\n"
    parts = [head, _rows("v", frame.coordinates(mesh.vertices)), _rows("vn", frame.directions(mesh.normals))]
    for name, chosen in _groups(mesh):
        corners = mesh.triangles[chosen] + 1
        lines = [f"f {a}//{a} {b}//{b} {c}//{c}" for a, b, c in corners.tolist()]
        parts += [f"g {name}\n", "\n".join(lines), "\n"]
    write_text(path, "".join(parts))


def write_3mf(path: Path, mesh: Mesh, frame: ViewFrame = CAMERA_FRAME, name: str = "scan") -> None:
    """Write a mesh as 3MF in mm, measured and filled triangles as two objects; InputError if that fails.

    Places are those of `frame`, which the description names.

    Raises
    ------
    InputError
        If it cannot be written.

    References
    ----------
    3MF Core Specification 1.3, 3MF Consortium.
    """
    objects, items = [], []
    vertices = frame.coordinates(mesh.vertices)
    for number, (group, chosen) in enumerate(_groups(mesh), start=1):
        objects.append(_object(number, f"{name}, {group}", vertices, mesh.triangles[chosen]))
        items.append(f'<item objectid="{number}"/>')
    model = (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<model unit="millimeter" xml:lang="en-US" '
        'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
        f'<metadata name="Application">Trisect {__version__}</metadata>'
        f'<metadata name="Description">{frame_words(frame.kind)}</metadata>'
        f"<resources>{''.join(objects)}</resources><build>{''.join(items)}</build></model>"
    )
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as file:
        parts = (("[Content_Types].xml", _CONTENT_TYPES), ("_rels/.rels", _RELATIONS), ("3D/3dmodel.model", model))
        for part, text in parts:
            info = zipfile.ZipInfo(part, _EPOCH)
            info.compress_type = zipfile.ZIP_DEFLATED
            file.writestr(info, text)
    write_bytes(path, data.getvalue())


def _groups(mesh: Mesh) -> list[tuple[str, NDArray[np.int64]]]:
    """The triangles measured and, if there are any, filled."""
    groups = [("measured", np.flatnonzero(~mesh.filled)), ("filled", np.flatnonzero(mesh.filled))]
    return [(name, chosen) for name, chosen in groups if len(chosen)]


def _rows(letter: str, values: Array) -> str:
    return "".join(f"{letter} {x:.6f} {y:.6f} {z:.6f}\n" for x, y, z in values.tolist())


def _object(number: int, name: str, vertices: Array, triangles: NDArray[np.int64]) -> str:
    used, corners = np.unique(triangles, return_inverse=True)
    places = "".join(f'<vertex x="{x:.6f}" y="{y:.6f}" z="{z:.6f}"/>' for x, y, z in vertices[used].tolist())
    faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in corners.reshape(-1, 3).tolist())
    shape = f"<mesh><vertices>{places}</vertices><triangles>{faces}</triangles></mesh>"
    return f'<object id="{number}" type="surface" name={quoteattr(name)}>{shape}</object>'


def write_stl(path: Path, mesh: Mesh, frame: ViewFrame = CAMERA_FRAME) -> None:
    """Write a mesh as binary STL in mm, in `frame`, its normals facing the camera; InputError if that fails.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    triangles = np.zeros(len(mesh.triangles), dtype=TRIANGLE)
    corners = frame.coordinates(mesh.vertices)[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    triangles["normal"] = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    triangles["corners"] = corners
    head = f"Trisect {__version__}; mm; {SHORT[frame.kind]}".encode("ascii", "replace")[:HEAD]
    count = np.array(len(triangles), dtype="<u4")
    write_bytes(path, head.ljust(HEAD) + count.tobytes() + triangles.tobytes())
