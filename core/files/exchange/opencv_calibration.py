"""Camera calibrations as OpenCV's samples write them: FileStorage, YAML or JSON, and read from them (also XML).

The skew γ stays in the camera matrix. OpenCV's own functions (`projectPoints`, `undistortPoints`) pass over that
element, so that with γ ≠ 0 they are wrong by up to γ·y px at the ray (x, y); the file says so.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from core.calibrate.results import CameraCalibration
from core.errors import InputError
from core.files.atomic import write_text
from core.files.exchange.imported import imported_camera
from core.files.reading import read_bytes
from core.messages import Message

_NAMES = {
    "matrix": ("camera_matrix", "cameraMatrix", "Camera_Matrix", "K", "M1"),
    "distortion": ("distortion_coefficients", "distCoeffs", "Distortion_Coefficients", "dist_coeffs", "D", "D1"),
    "width": ("image_width", "image_Width", "width"),
    "height": ("image_height", "image_Height", "height"),
    "rms": ("avg_reprojection_error", "Avg_Reprojection_Error", "reprojection_error"),
}
"""Under which names OpenCV's samples and those who follow them keep it, the commonest first."""

SKEW_NOTE = (
    "camera_matrix[0][1] is the skew in px; cv2.projectPoints and cv2.undistortPoints pass over it. sd: standard "
    "deviations of alpha, beta, gamma, u0, v0, k1, k2, p1, p2, k3."
)


def write_opencv(path: Path, calibration: CameraCalibration, at: datetime) -> None:
    """Write `path`, as JSON if it ends in .json, else as YAML; InputError if it cannot be written."""
    camera = calibration.camera
    form = cv2.FileStorage_FORMAT_JSON if path.suffix.lower() == ".json" else cv2.FileStorage_FORMAT_YAML
    storage = cv2.FileStorage("", cv2.FileStorage_WRITE | cv2.FileStorage_MEMORY | form)
    storage.write("calibration_time", at.isoformat(timespec="seconds"))
    storage.write("image_width", camera.image_size[0])
    storage.write("image_height", camera.image_size[1])
    storage.write("camera_matrix", np.array(camera.matrix))
    storage.write("distortion_coefficients", np.array(camera.distortion)[None, :])
    if math.isfinite(calibration.rms_px):
        storage.write("avg_reprojection_error", calibration.rms_px)
    storage.write("sd", np.array(list(calibration.sd.values()))[None, :])
    storage.write("note", SKEW_NOTE)
    write_text(path, storage.releaseAndGetString())


def read_opencv(path: Path) -> CameraCalibration:
    """Read a calibration that OpenCV's FileStorage holds.

    Raises
    ------
    InputError
        If it is no such file, lacks matrix, distortion or size, or they are no camera of ours.
    """
    text = read_bytes(path).decode("utf-8", "replace")
    try:
        storage = cv2.FileStorage(text, cv2.FileStorage_READ | cv2.FileStorage_MEMORY)
        found = {what: _first(storage, names) for what, names in _NAMES.items()}
        matrix, distortion = _matrix(found["matrix"]), _matrix(found["distortion"])
        width, height = (_real(found[side]) for side in ("width", "height"))
        rms = _real(found["rms"])
    except (cv2.error, SystemError, ValueError) as error:
        raise InputError(
            Message("file.no_opencv_storage", "this is no file of OpenCV's FileStorage that can be read"),
            where=path,
        ) from error
    for what, value in (("matrix", matrix), ("distortion", distortion), ("width", width), ("height", height)):
        if value is None:
            raise InputError(
                Message("file.opencv_value_missing", "there is no {names}", names=_NAMES[what][0]),
                where=path,
                todo=Message("advice.write_with_opencv", "write it with OpenCV's FileStorage"),
            )
    size = (int(width or 0), int(height or 0))
    coefficients = [] if distortion is None else [float(value) for value in distortion.ravel()]
    return imported_camera(path, size, np.eye(3) if matrix is None else matrix, coefficients, rms or math.nan)


def _first(storage: Any, names: Sequence[str]) -> Any:
    nodes = (storage.getNode(name) for name in names)
    return next((node for node in nodes if not node.empty()), None)


def _matrix(node: Any) -> Any:
    """An OpenCV matrix, or a list of numbers; None where there is none."""
    if node is None:
        return None
    if node.isSeq():
        return np.array([node.at(place).real() for place in range(node.size())])
    return node.mat()


def _real(node: Any) -> float | None:
    return None if node is None else float(node.real())
