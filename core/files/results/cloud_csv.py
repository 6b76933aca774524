"""A cloud as a table for spreadsheets and other programs: one head line that names columns with their units."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from core.files.atomic import write_bytes
from core.inspect.shown.view_frame import CAMERA_FRAME, FrameKind, ViewFrame
from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud

PLACES: Mapping[FrameKind, tuple[str, str, str]] = {
    FrameKind.CAMERA: ("x_camera_mm", "y_camera_mm", "z_camera_mm"),
    FrameKind.GROUND: ("x_face_mm", "y_face_mm", "height_over_face_mm"),
    FrameKind.PART: ("x_part_mm", "y_part_mm", "z_part_mm"),
}
"""Names of the columns of places, in the frame they are in: the camera's, the lower face's, the part's."""
_COLUMNS = {
    **dict.fromkeys(("sigma_mm", "nx", "ny", "nz"), "%.6f"),
    "intensity_grey": "%.3f",
    **dict.fromkeys(("frame", "sweep"), "%d"),
    **dict.fromkeys(("image_u_px", "image_v_px"), "%.4f"),
}

_ROWS_AT_ONCE = 20_000
"""Points that are made into text at a time: a few megabytes, however large the cloud is."""


def point_columns(kind: FrameKind) -> dict[str, str]:
    """Map the column names of a point cloud's CSV file, in a frame of this kind, to the formats of their values."""
    return {**dict.fromkeys(PLACES[kind], "%.6f"), **_COLUMNS}


def write_points_csv(path: Path, cloud: Cloud, frame: ViewFrame = CAMERA_FRAME, progress: Progress = silent) -> None:
    """Write a point cloud as CSV, a line for each point, coordinates in `frame`; InputError if that fails.

    Frame −1 is the reference, measured by the fan itself.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    columns = point_columns(frame.kind)
    row = ",".join(columns.values()) + "\n"
    text = io.BytesIO()
    text.write((",".join(columns) + "\n").encode())
    places, normals = frame.coordinates(cloud.points), frame.directions(cloud.normals)
    for start in range(0, len(cloud), _ROWS_AT_ONCE):
        progress("points as a table", start, len(cloud))
        end = start + _ROWS_AT_ONCE
        part = cloud.select(np.arange(start, min(end, len(cloud))))
        values = np.column_stack(
            [places[start:end], part.sigma, normals[start:end], part.intensity, part.frame, part.sweep, part.uv]
        )
        text.write((row * len(part) % tuple(values.ravel().tolist())).encode())
    progress("points as a table", len(cloud), len(cloud))
    write_bytes(path, text.getbuffer())
