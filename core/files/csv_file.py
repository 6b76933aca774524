"""Tables for spreadsheets and other programs: one head line that names columns with their units, points in numbers."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from core.files.atomic import write_bytes, write_text
from core.files.project_data import Repeat
from core.inspect.results import GaugeResult
from core.progress import Progress, silent
from core.scan.cloud import Cloud

POINT_COLUMNS = {
    "x_mm": "%.6f",
    "y_mm": "%.6f",
    "z_mm": "%.6f",
    "sigma_mm": "%.6f",
    "nx": "%.6f",
    "ny": "%.6f",
    "nz": "%.6f",
    "intensity_grey": "%.3f",
    "frame": "%d",
    "sweep": "%d",
    "image_u_px": "%.4f",
    "image_v_px": "%.4f",
}
"""Columns of a cloud, in the camera frame, and how their values are written: lengths to 1 nm."""

_ROWS_AT_ONCE = 20_000


def write_points_csv(path: Path, cloud: Cloud, progress: Progress = silent) -> None:
    """Write one line for each point of `cloud`: POINT_COLUMNS. Frame −1 is the reference, measured by the fan itself.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    row = ",".join(POINT_COLUMNS.values()) + "\n"
    text = io.BytesIO()
    text.write((",".join(POINT_COLUMNS) + "\n").encode())
    for start in range(0, len(cloud), _ROWS_AT_ONCE):
        progress("points as a table", start, len(cloud))
        part = cloud.select(np.arange(start, min(start + _ROWS_AT_ONCE, len(cloud))))
        columns = np.column_stack(
            [part.points, part.sigma, part.normals, part.intensity, part.frame, part.sweep, part.uv]
        )
        text.write((row * len(part) % tuple(columns.ravel().tolist())).encode())
    progress("points as a table", len(cloud), len(cloud))
    write_bytes(path, text.getbuffer())


def write_gauge_csv(path: Path, gauge: GaugeResult, calibration_id: str = "") -> None:
    """Write a thickness as lines of quantity, value, unit: the result, its verdict and its uncertainty budget.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    upper, lower = gauge.points_used
    rows = [
        ("thickness", gauge.thickness_mm, "mm"),
        ("standard uncertainty u", gauge.u_mm, "mm"),
        ("expanded uncertainty U = k u", gauge.U_mm, "mm"),
        ("coverage factor k", gauge.k, ""),
        ("nominal", gauge.nominal_mm, "mm"),
        ("tolerance", gauge.tolerance_mm, "mm"),
        ("deviation", gauge.deviation_mm, "mm"),
        ("verdict", gauge.verdict, ""),
        ("flatness of the upper face", gauge.upper.flatness_mm, "mm"),
        ("flatness of the lower face", gauge.lower.flatness_mm, "mm"),
        ("angle between the faces", math.degrees(gauge.parallelism), "deg"),
        ("points on the upper face", upper, ""),
        ("points on the lower face", lower, ""),
        *((f"u from {row.source}", row.u_mm, "mm") for row in gauge.budget),
        ("calibration", calibration_id, ""),
    ]
    _write(path, ("quantity", "value", "unit"), rows)


def write_repeats_csv(path: Path, repeats: Sequence[Repeat]) -> None:
    """Write one line for each thickness of a series; InputError if it cannot be written."""
    rows = [
        (one.scan, one.measured_at.isoformat(), one.thickness_mm, one.U_mm, one.k, one.calibration_id)
        for one in repeats
    ]
    _write(path, ("scan", "measured_at", "thickness_mm", "U_mm", "k", "calibration"), rows)


def _write(path: Path, head: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Numbers as Python writes them: short, and exact when read back. What is not known stays empty."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(head)
    table.writerows(rows)
    write_text(path, text.getvalue())
