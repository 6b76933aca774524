"""comparison.json: what a comparison of two surfaces came to; comparison.ply and .csv beside it: every core point."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core import __version__
from core.errors import InputError, words_of
from core.files.atomic import write_bytes
from core.files.complaints import checked_json
from core.files.json_text import write_json
from core.files.reading import read_bytes, read_json
from core.files.results.cloud_csv import PLACES
from core.files.results.frame_text import frame_comments
from core.files.results.ply_format import Ply, parse_ply, ply_bytes
from core.files.tables import RESULT, Finite, OrNan, Probability
from core.inspect.shown.view_frame import CAMERA_FRAME, ViewFrame
from core.messages import Command, Message
from core.model.arrays import Array
from core.wings.geometry.comparison.compare import Comparison
from core.wings.geometry.comparison.shown import Alignment, Changed

NAME = "comparison.json"
"""Among the results of a scan."""
SCHEMA = 1
"""Version of the file's layout."""
_TODO = Message("advice.compare_first", "compare the scan first{command}", command=Command("trisect compare OTHER DIR"))
_POINT = [
    *[(axis, "f4") for axis in "xyz"],  # as cloud.ply has them: filters of PCL drop points in double
    *[(axis, "f4") for axis in ("nx", "ny", "nz")],
    *[("deviation", "f4"), ("sigma", "f4"), ("lod95", "f4"), ("significant", "u1")],
    *[("points", "i4"), ("points_other", "i4")],
]
_COLUMNS = {
    **dict.fromkeys(("nx", "ny", "nz"), "%.6f"),
    **dict.fromkeys(("deviation_mm", "u_mm", "lod95_mm"), "%.6f"),
    **dict.fromkeys(("significant", "points", "points_other"), "%d"),
}


@dataclass(frozen=True, slots=True)
class ChangedPart:
    """Changed part of the surface: its share of all core points, mean and most extreme deviation in mm."""

    share: Probability
    mean_mm: OrNan
    extreme_mm: OrNan
    __pydantic_config__ = RESULT

    @classmethod
    def of(cls, changed: Changed) -> ChangedPart:
        """Make comparison.json's entry of a changed part of the surface."""
        return cls(changed.share, changed.mean_mm, changed.extreme_mm)


@dataclass(frozen=True, slots=True)
class ComparisonFile:
    """Content of comparison.json.

    Parameters
    ----------
    other
        Name of the surface compared with.
    alignment
        "as measured", "frame" or "best fit".
    core_points
        How many places were compared.
    lower, higher
        Where material is missing, and where there is more, significantly.
    lod95_mm
        Median of the level of detection.
    diameter_mm, reach_mm, registration_mm
        As they were used.
    calibration_id
        Of the scan.
    """

    other: str
    alignment: Alignment
    core_points: int
    lower: ChangedPart
    higher: ChangedPart
    lod95_mm: Finite
    diameter_mm: Finite
    reach_mm: Finite
    registration_mm: Finite
    calibration_id: str = ""
    __pydantic_config__ = RESULT

    @classmethod
    def of(cls, comparison: Comparison, other: str, alignment: Alignment, calibration_id: str) -> ComparisonFile:
        """Make the content of comparison.json from a comparison with the surface named `other`."""
        return cls(
            other,
            alignment,
            len(comparison),
            ChangedPart.of(comparison.lower),
            ChangedPart.of(comparison.higher),
            float(np.median(comparison.detectable)),
            comparison.diameter_mm,
            comparison.reach_mm,
            comparison.registration_mm,
            calibration_id,
        )

    def values(self) -> dict[str, Any]:
        """Return the values of comparison.json by name, also printed for machines."""
        numbers = {name: getattr(self, name) for name in self.__slots__ if name not in ("lower", "higher")}
        parts = {
            name: {key: getattr(part, key) for key in ("share", "mean_mm", "extreme_mm")}
            for name, part in (("lower", self.lower), ("higher", self.higher))
        }
        return {"schema_version": SCHEMA, **numbers, **parts, "version": __version__}


def write_comparison(path: Path, file: ComparisonFile) -> None:
    """Write the summary of a comparison as comparison.json; InputError if it cannot be written."""
    write_json(path, file.values())


def read_comparison(path: Path) -> ComparisonFile:
    """Read the summary of a comparison from comparison.json; InputError if it is missing, no JSON, or wrong."""
    return checked_json(ComparisonFile, read_json(path, todo=_TODO), path)


def write_comparison_ply(path: Path, comparison: Comparison, other: str) -> None:
    """Write a comparison's core points as PLY: place, normal, deviation, its σ, level of detection, significance.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    rows = np.empty(len(comparison), dtype=_POINT)
    for (name, _), column in zip(_POINT, _columns(comparison).T, strict=True):
        rows[name] = column
    comments = (
        f"Trisect {__version__}",
        "unit mm",
        *frame_comments(CAMERA_FRAME),
        f"deviation: from {other} along the normal, in mm; positive where there is more material",
        "sigma: standard uncertainty of the deviation, registration and all; lod95: 1.96 of it; "
        "significant: 1 where the deviation is beyond it",
    )
    write_bytes(path, ply_bytes(Ply({"vertex": rows}, comments)))


def write_comparison_csv(path: Path, comparison: Comparison) -> None:
    """Write a comparison's core points as CSV, a line each; InputError if it cannot be written."""
    _write_table(path, _columns(comparison), CAMERA_FRAME)


def write_comparison_ply_in(path: Path, source: Path, frame: ViewFrame) -> None:
    """Copy comparison.ply at `source` to `path`, in `frame` instead of its own; InputError if that fails.

    Raises
    ------
    InputError
        If it cannot be read, or `path` not be written.
    """
    rows, comments = _read_points(source)
    rows = rows.copy()
    for names, turned in ((("x", "y", "z"), frame.coordinates), (("nx", "ny", "nz"), frame.directions)):
        moved = turned(np.column_stack([rows[name].astype(np.float64) for name in names]))
        for name, column in zip(names, moved.T, strict=True):
            rows[name] = column
    old = frame_comments(CAMERA_FRAME)
    kept = [line for line in comments if line not in old]
    write_bytes(path, ply_bytes(Ply({"vertex": rows}, (*kept[:2], *frame_comments(frame), *kept[2:]))))


def write_comparison_csv_in(path: Path, source: Path, frame: ViewFrame) -> None:
    """Copy comparison.csv at `source` to `path`, in `frame` instead of its own; InputError if that fails."""
    try:
        head, *rows = [line.split(",") for line in read_bytes(source).decode().splitlines()]
        values = np.array(rows, dtype=np.float64).reshape(-1, len(head))
    except ValueError as error:
        raise _damaged(source, words_of(error)) from error
    if len(head) != len(_POINT):
        raise _damaged(source, f"{len(head)} columns")
    moved = [frame.coordinates(values[:, :3]), frame.directions(values[:, 3:6]), values[:, 6:]]
    _write_table(path, np.hstack(moved), frame)


def _read_points(path: Path) -> tuple[NDArray[Any], Sequence[str]]:
    """Rows and comments of comparison.ply; InputError if it is damaged."""
    try:
        data = parse_ply(read_bytes(path))
        return data.elements["vertex"][[name for name, _ in _POINT]], data.comments
    except (ValueError, KeyError) as error:
        raise _damaged(path, words_of(error)) from error


def _damaged(path: Path, reason: str | Message) -> InputError:
    return InputError(
        Message("file.no_comparison", "this is no table of a comparison ({reason})", reason=reason),
        where=path,
        todo=_TODO,
    )


def _write_table(path: Path, values: Array, frame: ViewFrame) -> None:
    columns = {**dict.fromkeys(PLACES[frame.kind], "%.6f"), **_COLUMNS}
    text = io.StringIO()
    text.write(",".join(columns) + "\n")
    np.savetxt(text, values, fmt=list(columns.values()), delimiter=",")
    write_bytes(path, text.getvalue().encode())


def _columns(comparison: Comparison) -> Array:
    detectable, counts = comparison.detectable, comparison.counts.astype(np.float64)
    significant = comparison.significant.astype(np.float64)
    return np.column_stack(
        [
            *[comparison.points, comparison.normals, comparison.deviation, comparison.sigma, detectable],
            *[significant, counts],
        ]
    )
