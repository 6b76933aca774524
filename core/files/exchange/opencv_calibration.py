"""Camera calibrations as OpenCV's samples write them: FileStorage, YAML or JSON, and read from them (also XML).

The skew γ stays in the camera matrix. OpenCV's own functions (`projectPoints`, `undistortPoints`) pass over that
element, so that with γ ≠ 0 they are wrong by up to γ·y px at the ray (x, y); the file says so.
"""

from __future__ import annotations

import math
from datetime import datetime
from pathlib import Path

import cv2
import numpy as np

from core.calibrate.results import CameraCalibration
from core.errors import InputError
from core.files.atomic import write_text
from core.files.exchange.calibration_text import first_of, numbers, read_fields
from core.files.exchange.imported import imported_camera
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
    """Write a camera's calibration for OpenCV, as JSON if `path` ends so, else YAML; InputError if that fails."""
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
    """Read a camera's calibration from OpenCV's YAML or JSON (FileStorage); InputError if it holds none.

    Raises
    ------
    InputError
        If it is no such file, lacks matrix, distortion or size, or they are no camera of ours.
    """
    fields = read_fields(path)
    found = {what: numbers(first_of(fields, names)) for what, names in _NAMES.items()}
    for what, count in (("matrix", 9), ("distortion", 0), ("width", 1), ("height", 1)):
        values = found[what]
        if values is None or (count and len(values) != count):
            raise InputError(
                Message("file.opencv_value_missing", "there is no {names}", names=_NAMES[what][0]),
                where=path,
                todo=Message("advice.write_with_opencv", "write it with OpenCV's FileStorage"),
            )
    size = [int(value) for what in ("width", "height") for value in found[what] or ()]
    rms = found["rms"] or [math.nan]
    matrix = np.reshape(found["matrix"] or (), (3, 3))
    return imported_camera(path, (size[0], size[1]), matrix, found["distortion"] or (), rms[0])
