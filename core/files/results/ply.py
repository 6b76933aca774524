"""cloud.ply and mesh.ply: binary PLY as CloudCompare and MeshLab read it, σ and the rest as scalar fields."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core import __version__
from core.errors import InputError
from core.files.atomic import write_bytes
from core.files.limits import LARGEST
from core.files.reading import MISSING, read_bytes
from core.files.results.frame_text import frame_comments, pose_in_comments
from core.files.results.ply_format import Ply, parse_ply, ply_bytes
from core.inspect.shown.view_frame import CAMERA_FRAME, ViewFrame
from core.messages import Command, Message
from core.model.arrays import Array
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh

_COMMON, _SECTION = "sigma_common", ("skewness", "spread")
_SEEN, _RESTS = "normal_seen", ("x_rest", "y_rest", "z_rest")
"""1 where the normal is the surface's, 0 where it is the ray back to the camera; and what x y z in single precision
leave of the coordinates, so that rays and planes are fitted again to all their digits."""
_SINCE_LATER = (_COMMON, *_SECTION, _SEEN, *_RESTS)
"""Files of earlier versions have none."""
_LEAST_LOST_MM = 1e-4
"""Coordinates that single precision rounds by more are written about an offset: beyond 2048 mm."""
_OFFSET = "offset "
_NORMALS = [("nx", "f4"), ("ny", "f4"), ("nz", "f4")]
_VIEW = "view"
"""The view of each point, in the file of several views joined in one frame."""
_CLOUD = [
    # In single precision, off by 0.03 µm at 700 mm: PCL's filters drop all points whose coordinates are double.
    *[("x", "f4"), ("y", "f4"), ("z", "f4")],
    *_NORMALS,
    *[("sigma", "f4"), ("intensity", "f4"), ("frame", "i4")],
    *[("sweep", "i4"), ("image_u", "f4"), ("image_v", "f4")],
    (_COMMON, "f4"),
    *[(name, "f4") for name in _SECTION],
    (_SEEN, "u1"),
    *[(name, "f8") for name in _RESTS],
]
_MESH = [("x", "f4"), ("y", "f4"), ("z", "f4"), *_NORMALS, ("sigma", "f4")]
_FILLED = "filled"
_CALIBRATION = "calibration "

_TODO = Message(
    "advice.measure_scan_first", "measure the scan first{command}", command=Command("trisect scan SET --out DIR")
)


@dataclass(frozen=True, eq=False, slots=True)
class CloudFile:
    """Content of cloud.ply: the points, and the id of their calibration ("" if not stated)."""

    cloud: Cloud
    calibration_id: str


@dataclass(frozen=True, eq=False, slots=True)
class MeshFile:
    """Content of mesh.ply: the surface, and the id of its calibration as in `CloudFile`."""

    mesh: Mesh
    calibration_id: str


def write_cloud(path: Path, cloud: Cloud, calibration_id: str, frame: ViewFrame = CAMERA_FRAME) -> None:
    """Write a point cloud as binary PLY, with normals, σ, intensity and frame of each point; InputError if that fails.

    In this order: x y z nx ny nz sigma intensity frame; behind them what the comments in its head say.

    Where the surface's normal is not known, nx ny nz are the ray back to the camera: programs stumble over zeros.
    Places and directions are those of `frame`, which the head states; what is read back is in the camera frame again.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    joined = bool(cloud.view.any())
    vertices = np.empty(len(cloud), dtype=[*_CLOUD, (_VIEW, "i4")] if joined else _CLOUD)
    if joined:
        vertices[_VIEW] = cloud.view
    with np.errstate(over="ignore", invalid="ignore"):  # reading tells of coordinates that are not finite
        points = frame.coordinates(cloud.points)
        offset = _offset_of(points)
        about = points - offset
        _put(vertices, ("x", "y", "z"), about)
        _put(vertices, _RESTS, about - about.astype(np.float32))
        back = -cloud.points / np.maximum(np.linalg.norm(cloud.points, axis=1, keepdims=True), np.finfo(float).tiny)
    seen = np.asarray(cloud.normals.any(axis=1))
    _put(vertices, ("nx", "ny", "nz"), frame.directions(np.where(seen[:, None], cloud.normals, back)))
    vertices[_SEEN] = seen
    _put(vertices, ("image_u", "image_v"), cloud.uv)
    for name in ("sigma", "intensity", "frame", "sweep", "sigma_common"):
        vertices[name] = getattr(cloud, name)
    _put(vertices, _SECTION, np.column_stack([cloud.skewness, cloud.spread_mm]))
    comments = [
        "unit mm",
        *frame_comments(frame),
        *([f"{_OFFSET}{offset[0]:.0f} {offset[1]:.0f} {offset[2]:.0f}: add it to x y z"] if offset.any() else []),
        "sigma: standard uncertainty of the depth in mm; frame -1: measured by the fan itself",
        "sigma_common: what camera and fan calibration add to it, in mm, common to all points",
        "skewness: of the stripe's section, above 0 where its light reaches away from the camera; "
        "spread: its sigma in mm of depth",
        f"{_SEEN} 1: nx ny nz are the surface's normal; 0: that is not known, they are the ray back to the camera",
        "x_rest y_rest z_rest: add them to x y z where less than 0.1 um counts",
    ]
    _write(path, {"vertex": vertices}, comments, calibration_id)


def read_cloud(path: Path) -> CloudFile:
    """Read a point cloud from cloud.ply, in the camera frame whatever it is written in; InputError if it is wrong.

    Raises
    ------
    InputError
        If it is missing, damaged, lacks a property or holds values that are not finite; names it.
    """
    data = _read(path, _TODO)
    vertices = _element(data, "vertex", [name for name, _ in _CLOUD if name not in _SINCE_LATER], path)
    known = [name for name in (*_SINCE_LATER, _VIEW) if name in (vertices.dtype.names or ())]

    def columns(*names: str) -> Array:
        return _columns(vertices, names)

    _check_finite(vertices, ("x", "y", "z", "sigma", "image_u", "image_v", *known), path)
    if np.any(vertices["sigma"] <= 0):
        raise InputError(Message("file.sigma_not_positive", "property sigma is not above 0 in every point"), where=path)
    points, normals = columns("x", "y", "z"), columns("nx", "ny", "nz")
    if _SEEN in known:
        normals[vertices[_SEEN] == 0] = 0.0
    if set(_RESTS) <= set(known):
        points += columns(*_RESTS)
    points += _told_offset(data.comments, path)
    pose = pose_in_comments(data.comments, path)
    cloud = Cloud(
        points=pose.apply(points),
        uv=columns("image_u", "image_v"),
        sigma=columns("sigma")[:, 0],
        intensity=columns("intensity")[:, 0],
        frame=np.asarray(vertices["frame"], dtype=np.int64),
        sweep=np.asarray(vertices["sweep"], dtype=np.int64),
        normals=normals @ pose.rotation.T,
        sigma_common=columns(_COMMON)[:, 0] if _COMMON in known else np.zeros(0),
        skewness=columns("skewness")[:, 0] if "skewness" in known else np.zeros(0),
        spread_mm=columns("spread")[:, 0] if "spread" in known else np.zeros(0),
        view=np.asarray(vertices[_VIEW] if _VIEW in known else np.zeros(0), dtype=np.int64),
    )
    return CloudFile(cloud, _calibration(data))


def _calibration(data: Ply) -> str:
    ids = [line.removeprefix(_CALIBRATION) for line in data.comments if line.startswith(_CALIBRATION)]
    return ids[0] if ids else ""


def _offset_of(points: Array) -> Array:
    """Whole mm (3,) that coordinates (N, 3) are written about: nothing unless single precision would lose digits."""
    lost = np.abs(points - points.astype(np.float32)).max(initial=0.0)
    return np.round(points.mean(axis=0)) if np.isfinite(lost) and lost > _LEAST_LOST_MM else np.zeros(3)


def _told_offset(comments: Sequence[str], path: Path) -> Array:
    """The offset (3,) in mm that the file's head states; InputError if it is none."""
    told = [line.removeprefix(_OFFSET).partition(":")[0] for line in comments if line.startswith(_OFFSET)]
    if not told:
        return np.zeros(3)
    try:
        offset = np.array([float(word) for word in told[0].split()])
    except ValueError:
        offset = np.zeros(0)
    if offset.shape != (3,) or not np.all(np.abs(offset) <= LARGEST):
        raise InputError(Message("file.no_offset", "the offset in its head is not three lengths"), where=path)
    return offset


def write_mesh(path: Path, mesh: Mesh, calibration_id: str, frame: ViewFrame = CAMERA_FRAME) -> None:
    """Write a mesh as binary PLY, with normals, σ and flags of triangles over holes; InputError if that fails.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    vertices = np.empty(len(mesh.vertices), dtype=_MESH)
    _put(vertices, ("x", "y", "z"), frame.coordinates(mesh.vertices))
    _put(vertices, ("nx", "ny", "nz"), frame.directions(mesh.normals))
    vertices["sigma"] = mesh.sigma
    marked = [(_FILLED, "u1")] if mesh.filled.any() else []
    faces = np.empty(len(mesh.triangles), dtype=[("vertex_indices", "i4", (3,)), *marked])
    faces["vertex_indices"] = mesh.triangles
    if marked:
        faces[_FILLED] = mesh.filled
    comments = ["unit mm", *frame_comments(frame), "sigma: standard uncertainty in mm"]
    _write(path, {"vertex": vertices, "face": faces}, comments, calibration_id)


def read_mesh(path: Path) -> Mesh:
    """Read the mesh in mesh.ply, in the camera frame; InputError if it is missing or damaged."""
    return read_mesh_file(path).mesh


def read_mesh_file(path: Path) -> MeshFile:
    """Read mesh.ply and what its head tells, the mesh in the camera frame; InputError if missing or damaged.

    Raises
    ------
    InputError
        If it is missing, damaged or lacks a property; names it.
    """
    data = _read(path, _TODO)
    vertices = _element(data, "vertex", [name for name, _ in _MESH], path)
    faces = _element(data, "face", ["vertex_indices"], path)
    _check_finite(vertices, ("x", "y", "z", "sigma"), path)
    shape = faces["vertex_indices"].shape
    if len(faces) and shape[1:] != (3,):
        raise InputError(Message("file.faces_no_triangles", "its faces are no triangles"), where=path)
    corners = np.array(faces["vertex_indices"], dtype=np.int64).reshape(-1, 3)
    if len(corners) and (corners.min() < 0 or corners.max() >= len(vertices)):
        raise InputError(
            Message("file.triangle_without_vertex", "a triangle names a vertex that is not there"), where=path
        )
    pose = pose_in_comments(data.comments, path)
    mesh = Mesh(
        vertices=pose.apply(_columns(vertices, ("x", "y", "z"))),
        normals=_columns(vertices, ("nx", "ny", "nz")) @ pose.rotation.T,
        sigma=np.asarray(vertices["sigma"], dtype=np.float64),
        triangles=corners,
        filled=np.asarray(faces[_FILLED], dtype=np.bool_)
        if _FILLED in (faces.dtype.names or ())
        else np.zeros(0, bool),
    )
    return MeshFile(mesh, _calibration(data))


def _check_finite(vertices: NDArray[Any], names: Sequence[str], path: Path) -> None:
    """InputError if a property is not finite in every point, or beyond all that is computed with."""
    for name in names:
        wrong = int(np.count_nonzero(~(np.abs(_columns(vertices, (name,))) <= LARGEST)))
        if wrong:
            raise InputError(
                Message(
                    "file.property_not_finite",
                    "property {name} is not finite in {wrong} of {vertices} points",
                    name=name,
                    wrong=wrong,
                    vertices=len(vertices),
                ),
                where=path,
            )


def _columns(vertices: NDArray[Any], names: Sequence[str]) -> Array:
    with np.errstate(invalid="ignore"):  # of a NaN that signals; it becomes a quiet one
        return np.column_stack([vertices[name] for name in names]).astype(np.float64)


def _put(vertices: NDArray[Any], names: Sequence[str], values: Array) -> None:
    for column, name in enumerate(names):
        vertices[name] = values[:, column]


def _write(path: Path, elements: Mapping[str, NDArray[Any]], comments: list[str], calibration_id: str) -> None:
    stamp = (f"Trisect {__version__}", *comments, f"{_CALIBRATION}{calibration_id}")
    write_bytes(path, ply_bytes(Ply(elements, stamp)))


def _read(path: Path, todo: Message) -> Ply:
    if not path.exists():
        raise InputError(MISSING, where=path, todo=todo)
    data = read_bytes(path)
    try:
        return parse_ply(data)
    except ValueError as error:
        raise InputError(
            Message("file.no_whole_ply", "this is no whole PLY file ({reason})", reason=str(error)),
            where=path,
            todo=Message("advice.make_file_again", "make it again"),
        ) from error


def _element(data: Ply, name: str, properties: Sequence[str], path: Path) -> NDArray[Any]:
    """The rows of one element, all `properties` there."""
    rows = data.elements.get(name)
    if rows is None:
        raise InputError(Message("file.no_element", "there is no element {name}", name=name), where=path)
    missing = [one for one in properties if one not in (rows.dtype.names or ())]
    if missing:
        raise InputError(
            Message(
                "file.element_lacks_property",
                "element {name} lacks the property {missing}",
                name=name,
                missing=missing[0],
            ),
            where=path,
        )
    return rows
