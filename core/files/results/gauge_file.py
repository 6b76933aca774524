"""gauge.json: the thickness with its uncertainty; gauge.npz beside it: which points of the cloud each face rests on."""

from __future__ import annotations

import math
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from core import __version__
from core.errors import InputError
from core.files.arrays_file import read_arrays, whole, write_arrays
from core.files.atomic import write_text
from core.files.complaints import checked
from core.files.json_text import to_json
from core.files.reading import read_json
from core.files.tables import (
    BudgetRow,
    Finite,
    KeptMessage,
    OptionalMessage,
    PlaneRow,
    ResultFile,
    Row2,
    Row3,
    kept,
    row_tables,
)
from core.findings.proof import doubts_named, notes_beside
from core.inspect.characteristic import Characteristic, thickness_characteristic
from core.inspect.results import Contribution, Corners, Face, GaugeResult, PairCandidate
from core.messages import Command, Message
from core.model import LightPlane
from core.model.arrays import Array
from core.scan.surface.cloud import Cloud

_TODO = Message(
    "advice.measure_thickness_first",
    "measure the thickness first{command}",
    command=Command("trisect gauge SET --out DIR"),
)


_MEMBERS = {"upper": whole(None), "lower": whole(None)}


class _Pair(ResultFile):
    upper: Finite | None = Field(description="a finite number, or null")
    lower: Finite | None = Field(description="a finite number, or null")


class _Face(PlaneRow):
    rms_mm: Finite = Field(description="a finite number")
    spanned: bool = True


class _Faces(ResultFile):
    upper: _Face
    lower: _Face


_PX = Field(description="two finite numbers: a pixel")


class _Candidate(ResultFile):
    thickness_mm: Finite = Field(ge=0, description="a length in mm, not negative")
    points: list[int] = Field(min_length=2, max_length=2, description="two whole numbers")
    upper_px: Row2 = _PX
    lower_px: Row2 = _PX
    outlines_px: list[list[Row2]] = Field(
        default=[[], []], min_length=2, max_length=2, description="two lists of pixels"
    )

    def candidate(self) -> PairCandidate:
        return PairCandidate(
            self.thickness_mm,
            (self.points[0], self.points[1]),
            (self.upper_px[0], self.upper_px[1]),
            (self.lower_px[0], self.lower_px[1]),
            (_corners(self.outlines_px[0]), _corners(self.outlines_px[1])),
        )


def _corners(rows: list[Row2]) -> Corners:
    return tuple((row[0], row[1]) for row in rows)


class _Contribution(BudgetRow):
    u_mm: Finite

    def row(self) -> Contribution:
        return self.contributing(self.u_mm)


class _GaugeFile(ResultFile):
    thickness_mm: Finite = Field(gt=0, description="a length in mm above 0")
    u_mm: Finite = Field(ge=0, description="a length in mm, not negative")
    k: Finite = Field(gt=0, description="a number above 0")
    flatness_mm: _Pair = Field(description="a table of upper and lower")
    flatness_u_mm: _Pair = Field(default=_Pair(upper=None, lower=None), description="a table of upper and lower")
    parallelism_deg: Finite | None = Field(description="an angle in degrees, or null")
    faces: _Faces = Field(description="a table of upper and lower")
    nominal_mm: Finite | None = None
    tolerance_mm: Finite | None = Field(default=None, gt=0, description="a length in mm above 0")
    complete: bool = False
    doubts: list[str] = Field(default_factory=list)
    at_20: bool | None = None
    rule: OptionalMessage = None
    normal: Row3 | None = None
    notes: list[KeptMessage] = Field(default_factory=list)
    budget: list[_Contribution] = Field(default_factory=list)
    candidates: list[_Candidate] = Field(default_factory=list)
    calibration_id: str = ""


def gauge_summary(gauge: GaugeResult) -> dict[str, Any]:
    """Make the table of thickness, U, limits and verdict by the names of files and command line."""
    return {
        "thickness_mm": gauge.thickness_mm,
        "u_mm": gauge.u_mm,
        "U_mm": gauge.U_mm,
        "k": gauge.k,
        "nominal_mm": gauge.nominal_mm,
        "tolerance_mm": gauge.tolerance_mm,
        "deviation_mm": gauge.deviation_mm,
        "verdict": gauge.verdict,
        "flatness_mm": {"upper": gauge.upper.flatness_mm, "lower": gauge.lower.flatness_mm},
        "flatness_u_mm": {"upper": gauge.upper.flatness_u_mm, "lower": gauge.lower.flatness_u_mm},
        "parallelism_deg": None if gauge.parallelism is None else math.degrees(gauge.parallelism),
    }


def write_gauge(path: Path, gauge: GaugeResult, calibration_id: str) -> None:
    """Write a thickness as gauge.json at `path`, its faces' points beside it as gauge.npz; InputError if that fails."""
    write_arrays(path.with_suffix(".npz"), {"upper": gauge.upper.indices, "lower": gauge.lower.indices})
    write_text(
        path,
        to_json(
            {
                **gauge_summary(gauge),
                "complete": not gauge.doubts,
                "doubts": [doubt.fact for doubt in gauge.doubts],
                "at_20": gauge.at_20,
                "rule": kept(gauge.rule),
                "notes": [kept(note) for note in gauge.notes],
                "points": dict(zip(("upper", "lower"), gauge.points_used, strict=True)),
                "normal": gauge.normal,
                "budget": [_row(row, gauge.u_mm) for row in gauge.budget],
                "faces": {"upper": _plane(gauge.upper), "lower": _plane(gauge.lower)},
                "candidates": [asdict(one) for one in gauge.candidates],
                "calibration_id": calibration_id,
                "version": __version__,
            }
        ),
    )


def read_gauge(path: Path, cloud: Cloud) -> GaugeResult:
    """Read a thickness from gauge.json, its faces' points taken from `cloud`; InputError if it is missing or wrong.

    The file's `verdict` is for other programs and is not read: it follows anew from the numbers and `doubts`, so that
    no file, of an earlier version or changed by hand, says more than they prove; one that does not say that it is
    `complete` proves nothing.

    Raises
    ------
    InputError
        If a file is missing, a value is not finite or absurd, or the faces' points are not in the cloud.
    """
    file = _read(path)
    return _gauge(file, _members(path.with_suffix(".npz"), len(cloud)), cloud.points)


def read_thickness(path: Path) -> Characteristic:
    """Read the thickness as a characteristic from gauge.json, without its faces' points; InputError if it is wrong."""
    none = dict.fromkeys(_MEMBERS, np.zeros(0, dtype=np.int64))
    return thickness_characteristic(_gauge(_read(path), none, np.zeros((0, 3))))


def read_lower_face(path: Path) -> LightPlane | None:
    """Read the plane of the lower face in gauge.json; None without the file, InputError if it is damaged."""
    if not path.is_file():
        return None
    none = dict.fromkeys(_MEMBERS, np.zeros(0, dtype=np.int64))
    return _gauge(_read(path), none, np.zeros((0, 3))).lower.plane


def _gauge(file: _GaugeFile, members: dict[str, NDArray[np.int64]], points: Array) -> GaugeResult:
    """What a file says, its faces with the `members` among `points` (N, 3)."""
    doubts = doubts_named(file.doubts, complete=file.complete)
    return GaugeResult(
        thickness_mm=file.thickness_mm,
        u_mm=file.u_mm,
        k=file.k,
        upper=_face(file.faces.upper, members["upper"], (file.flatness_mm.upper, file.flatness_u_mm.upper), points),
        lower=_face(file.faces.lower, members["lower"], (file.flatness_mm.lower, file.flatness_u_mm.lower), points),
        parallelism=None if file.parallelism_deg is None else math.radians(file.parallelism_deg),
        budget=tuple(row.row() for row in file.budget),
        nominal_mm=file.nominal_mm,
        tolerance_mm=file.tolerance_mm,
        doubts=doubts,
        at_20=file.at_20,
        normal=None if file.normal is None else np.array(file.normal),
        rule=file.rule,
        notes=notes_beside(doubts, file.notes),
        candidates=tuple(one.candidate() for one in file.candidates),
    )


def _read(path: Path) -> _GaugeFile:
    tables = read_json(path, todo=_TODO)
    return checked(_GaugeFile, tables, path)


def _row(row: Contribution, u_mm: float) -> dict[str, Any]:
    return row_tables(row, "u_mm") | {"share": row.u_mm**2 / u_mm**2 if u_mm else 0.0}


def _plane(face: Face) -> dict[str, Any]:
    plane = face.plane
    return {
        "normal": plane.normal, "d_mm": plane.d_mm, "pi": plane.pi, "rms_mm": face.rms_mm, "spanned": face.spanned,
    }  # fmt: skip


def _face(face: _Face, indices: NDArray[np.int64], flatness: tuple[float | None, float | None], points: Array) -> Face:
    plane = LightPlane(np.array(face.pi))
    return Face(plane, indices, -plane.distances(points[indices]), flatness[0], face.rms_mm, face.spanned, flatness[1])


def _members(path: Path, count: int) -> dict[str, NDArray[np.int64]]:
    """Indices of the points of each face, checked against a cloud of `count` points."""
    arrays = read_arrays(path, _MEMBERS, todo=_TODO)
    members = {name: np.asarray(arrays[name], dtype=np.int64) for name in _MEMBERS}
    for name, indices in members.items():
        if len(indices) and (indices.min() < 0 or indices.max() >= count):
            raise InputError(
                Message("file.points_beyond_cloud", "{name} names points that the cloud does not have", name=name),
                where=path,
                todo=_TODO,
            )
    return members
