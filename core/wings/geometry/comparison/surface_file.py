"""Surfaces of any program to compare a scan with: points or triangles of PLY, STL, STEP and E57 files, in mm."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError, words_of
from core.extras import install
from core.files import cad_part
from core.files.limits import LARGEST, check_file
from core.files.reading import MISSING, read_bytes
from core.files.results.nominal_surface import read_nominal
from core.files.results.ply_format import Ply, parse_ply
from core.messages import Message
from core.model.arrays import Array
from core.scan.surface.triangles import Triangles
from core.wings.geometry.comparison.compare import SurfacePoints

MM_PER_METRE = 1e3
"""E57 states metres."""
TOLERANCE_MM = 0.1
"""What the triangles of a STEP file are made for: a tenth of it is how far they are off its faces."""


@dataclass(frozen=True, eq=False, slots=True)
class OtherSurface:
    """Surface made by another program: triangles, or else points."""

    points: SurfacePoints
    triangles: Triangles | None = None


def read_surface(path: Path) -> OtherSurface:
    """Read points or triangles from a PLY, STL, STEP (in mm) or E57 file (in m); InputError if that fails.

    A PLY with faces is taken as triangles, unless its vertices have a `sigma`: then they were measured. Points may have
    normals (nx, ny, nz) and `sigma` in mm.

    Raises
    ------
    InputError
        If it is missing, damaged, of another kind, or holds no point.
    """
    readers: Mapping[str, Callable[[Path], OtherSurface]] = {
        ".ply": _ply,
        ".e57": _e57,
        **dict.fromkeys((".stl", *cad_part.SUFFIXES), _nominal),
    }
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise InputError(
            Message("comparison.file_kind", "this is none of the kinds of surface that can be read"),
            where=path,
            todo=Message("advice.name_surface", "name a PLY, STL, STEP or E57 file, or a folder of results"),
        )
    return reader(path)


def _nominal(path: Path) -> OtherSurface:
    return OtherSurface(SurfacePoints.bare(np.zeros((0, 3))), read_nominal(path, TOLERANCE_MM))


def _ply(path: Path) -> OtherSurface:
    if not path.exists():
        raise InputError(MISSING, where=path)
    try:
        data = parse_ply(read_bytes(path))
    except ValueError as error:
        raise InputError(
            Message("file.no_whole_ply", "this is no whole PLY file ({reason})", reason=words_of(error)), where=path
        ) from error
    vertices = data.elements.get("vertex")
    names = () if vertices is None else vertices.dtype.names or ()
    if vertices is None or not {"x", "y", "z"} <= set(names):
        raise _no_points(path)
    places = _columns(vertices, ("x", "y", "z"))
    corners = _faces(data, len(places))
    if corners is not None and "sigma" not in names:
        known = np.isfinite(places[corners]).all(axis=(1, 2))
        return OtherSurface(SurfacePoints.bare(np.zeros((0, 3))), _with_area(places[corners[known]], path))
    normals = _columns(vertices, ("nx", "ny", "nz")) if {"nx", "ny", "nz"} <= set(names) else None
    sigma = _columns(vertices, ("sigma",))[:, 0] if "sigma" in names else None
    return OtherSurface(_checked(places, normals, sigma, path))


def _columns(vertices: NDArray[Any], names: tuple[str, ...]) -> Array:
    with np.errstate(invalid="ignore"):
        return np.column_stack([vertices[name] for name in names]).astype(np.float64)


def _faces(data: Ply, vertices: int) -> NDArray[np.int64] | None:
    """Corners (T, 3) of the faces, those of four cut in two; None where there are none that can be used."""
    rows = data.elements.get("face")
    name = next(
        (one for one in ("vertex_indices", "vertex_index") if rows is not None and one in (rows.dtype.names or ())), ""
    )
    if rows is None or not name or not len(rows):
        return None
    corners = np.asarray(rows[name], dtype=np.int64).reshape(len(rows), -1)
    if corners.shape[1] < 3 or corners.min() < 0 or corners.max() >= vertices:
        return None
    fans = [corners[:, [0, k, k + 1]] for k in range(1, corners.shape[1] - 1)]
    return np.concatenate(fans)


def _with_area(corners: Array, path: Path) -> Triangles:
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    kept = (area > 0) & (np.abs(corners) <= LARGEST).all(axis=(1, 2))
    if not kept.any():
        raise _no_points(path)
    return Triangles(corners[kept])


def _checked(places: Array, normals: Array | None, sigma: Array | None, path: Path) -> SurfacePoints:
    """Points that are finite; normals of length 1 or unknown; σ not below 0."""
    with np.errstate(invalid="ignore"):
        kept = (np.abs(places) <= LARGEST).all(axis=1)
    if not kept.any():
        raise _no_points(path)
    if normals is not None:
        length = np.linalg.norm(normals, axis=1)
        with np.errstate(invalid="ignore"):
            known = (np.abs(length - 1) < 0.01)[:, None]
        normals = np.where(known, normals, 0.0)[kept]
    if sigma is not None:
        with np.errstate(invalid="ignore"):
            sigma = np.where((sigma > 0) & (sigma <= LARGEST), sigma, 0.0)[kept]
    return SurfacePoints.bare(places[kept], normals, sigma)


def _e57(path: Path) -> OtherSurface:
    try:
        import pye57  # an extra
    except ImportError as missing:
        raise InputError(
            Message("export.install_pye57", "E57 needs pye57: install it with {command}", command=install("e57")),
            where=path,
        ) from missing
    if not path.exists():
        raise InputError(MISSING, where=path)
    check_file(path)
    parts, sigmas = [], []
    try:
        with pye57.E57(str(path)) as file:
            for number in range(file.scan_count):
                name = _name_of(file, number)
                ours = name.endswith("(intensity: sigma in mm)")
                read = file.read_scan(number, intensity=ours, ignore_missing_fields=True)
                parts.append(MM_PER_METRE * np.column_stack([read[f"cartesian{axis}"] for axis in "XYZ"]))
                sigmas.append(np.asarray(read["intensity"], dtype=np.float64) if ours else np.zeros(len(parts[-1])))
    except (pye57.libe57.E57Exception, OSError, KeyError, ValueError, RuntimeError) as error:
        raise InputError(
            Message("comparison.e57_damaged", "it cannot be read as E57 ({reason})", reason=words_of(error)),
            where=path,
        ) from error
    if not parts:
        raise _no_points(path)
    return OtherSurface(_checked(np.concatenate(parts), None, np.concatenate(sigmas), path))


def _name_of(file: Any, number: int) -> str:
    scan = file.data3d[number]
    return str(scan["name"].value()) if scan.isDefined("name") else ""


def _no_points(path: Path) -> InputError:
    return InputError(
        Message("comparison.file_without_points", "it holds no point of a surface"),
        where=path,
        todo=Message("advice.name_surface", "name a PLY, STL, STEP or E57 file, or a folder of results"),
    )
