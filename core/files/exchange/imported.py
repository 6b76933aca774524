"""A camera calibrated by another program, as our own result: what it lacks stays unknown."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from core.calibrate.results import CAMERA_PARAMETERS, CameraCalibration
from core.errors import InputError, WrongValue
from core.findings.table import note_of
from core.messages import Message
from core.model import Camera

COEFFICIENTS_USED = 5
"""Distortion coefficients of our model: k1, k2, p1, p2, k3."""


def imported_camera(
    path: Path, image_size: tuple[int, int], matrix: ArrayLike, distortion: Sequence[float], rms_px: float = math.nan
) -> CameraCalibration:
    """Make a camera's calibration from image size, matrix and distortion that another program wrote to `path`.

    Raises
    ------
    InputError
        If the camera is absurd, or its distortion is not k1, k2, p1, p2, k3.
    """
    coefficients = np.asarray(distortion, dtype=np.float64).ravel()
    if np.any(coefficients[COEFFICIENTS_USED:] != 0):
        raise InputError(
            Message(
                "file.distortion_not_modelled",
                "has {coefficients} distortion coefficients, of which more than k1, k2, p1, p2, k3 are not zero, "
                "and those are all that is modelled here",
                coefficients=len(coefficients),
            ),
            where=path,
            todo=Message(
                "advice.calibrate_with_five_coefficients", "calibrate again with the five-coefficient model (plumb_bob)"
            ),
        )
    values = np.zeros(COEFFICIENTS_USED)
    values[: len(coefficients[:COEFFICIENTS_USED])] = coefficients[:COEFFICIENTS_USED]
    matrix = np.asarray(matrix, dtype=np.float64)
    if matrix.shape != (3, 3) or matrix[1, 0] != 0 or matrix[2].tolist() != [0, 0, 1]:
        raise InputError(
            Message(
                "file.camera_matrix_form",
                "the camera matrix is not of the form [[α, γ, u0], [0, β, v0], [0, 0, 1]]",
            ),
            where=path,
        )
    try:
        camera = Camera(image_size, matrix, values)
    except WrongValue as error:
        raise InputError(
            Message("file.no_camera", "this is no camera: {reason}", reason=error.what), where=path
        ) from error
    size = len(CAMERA_PARAMETERS)
    return CameraCalibration(
        camera=camera,
        covariance=np.zeros((size, size)),
        views=(),
        rms_px=rms_px,
        mean_px=math.nan,
        coverage=math.nan,
        tilt_range=math.nan,
        cross_validation_mm=math.nan,
        notes=(note_of("camera.imported", name=path.name),),
    )
