"""A cloud as a table for spreadsheets and other programs: one head line that names columns with their units."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from core.files.atomic import write_bytes
from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud

POINT_COLUMNS = {
    "x_camera_mm": "%.6f",
    "y_camera_mm": "%.6f",
    "z_camera_mm": "%.6f",
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
"""Columns of a cloud, their frame and unit in their names, and how their values are written: lengths to 1 nm."""

_ROWS_AT_ONCE = 20_000
"""Points that are made into text at a time: a few megabytes, however large the cloud is."""


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
