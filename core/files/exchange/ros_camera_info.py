"""Camera calibrations as ROS keeps them: the YAML of `camera_info_manager`, distortion model plumb_bob.

ROS has no skew: a camera with γ ≠ 0 is not written, since everything that reads the file would take it for zero.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.calibrate.results import CameraCalibration
from core.errors import InputError
from core.files.atomic import write_text
from core.files.exchange.calibration_text import numbers, read_fields
from core.files.exchange.imported import imported_camera
from core.messages import Message

MODELS = ("plumb_bob", "rational_polynomial")
"""Models that can be read; of the second only what the first could say."""


def write_camera_info(path: Path, calibration: CameraCalibration) -> None:
    """Write a camera's calibration as ROS's camera_info YAML file; InputError if it has skew, or that fails.

    Raises
    ------
    InputError
        If the camera has a skew, or the file cannot be written.
    """
    camera = calibration.camera
    matrix, skew = camera.matrix, float(camera.matrix[0, 1])
    if skew != 0:
        raise InputError(
            Message(
                "file.camera_info_without_skew",
                "ROS's camera_info has no skew, and this camera's is {skew:.3g} px",
                skew=skew,
            ),
            where=path,
            todo=Message(
                "advice.calibrate_without_skew", "calibrate without it (--no-skew), or hand over the OpenCV file"
            ),
        )
    projection = [[*row, 0.0] for row in matrix.tolist()]
    lines = [
        f"image_width: {camera.image_size[0]}",
        f"image_height: {camera.image_size[1]}",
        "camera_name: camera",
        *_matrix("camera_matrix", matrix.tolist()),
        "distortion_model: plumb_bob",
        *_matrix("distortion_coefficients", [camera.distortion.tolist()]),
        *_matrix("rectification_matrix", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        *_matrix("projection_matrix", projection),
    ]
    write_text(path, "\n".join(lines) + "\n")


def read_camera_info(path: Path) -> CameraCalibration:
    """Read a camera's calibration from ROS's camera_info YAML file; InputError if it holds none.

    Raises
    ------
    InputError
        If it is no such file, lacks a key, or has another distortion model.
    """
    file = read_fields(path)
    model = file.get("distortion_model", MODELS[0])
    if model not in MODELS:
        raise InputError(
            Message(
                "file.distortion_model",
                "distortion_model is {model!r}, and only {models} can be used here",
                model=str(model)[:40],
                models=MODELS[0],
            ),
            where=path,
        )
    size = tuple(_numbers(path, file, key, 1)[0] for key in ("image_width", "image_height"))
    matrix = _numbers(path, file, "camera_matrix", 9)
    distortion = _numbers(path, file, "distortion_coefficients", 0)
    return imported_camera(path, (int(size[0]), int(size[1])), [matrix[0:3], matrix[3:6], matrix[6:9]], distortion)


def _numbers(path: Path, file: Mapping[str, Any], key: str, count: int) -> list[float]:
    """The numbers under a key, `count` of them (0: any): by themselves, in a list, or as `data` of a matrix."""
    values = numbers(file.get(key))
    if values is None or (count and len(values) != count):
        wanted = "a number" if count == 1 else f"{count} numbers" if count else "a list of numbers"
        raise InputError(Message("file.value_wrong", "{key} is not {wanted}", key=key, wanted=wanted), where=path)
    return values


def _matrix(key: str, rows: list[list[float]]) -> list[str]:
    data = ", ".join(repr(value) for row in rows for value in row)
    return [f"{key}:", f"  rows: {len(rows)}", f"  cols: {len(rows[0])}", f"  data: [{data}]"]
