"""camera.json: the camera's calibration, readable by people and by other programs."""

from __future__ import annotations

import hashlib
import math
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, model_validator

from core import __version__
from core.calibrate.board_shape import SHAPE_PARAMETERS, Board, BoardShape
from core.calibrate.camera.settled import has_settled
from core.calibrate.results import CAMERA_PARAMETERS, CameraCalibration, ViewQuality
from core.files.complaints import Clash, checked, fitting
from core.files.json_text import rounded, write_json
from core.files.reading import read_json
from core.files.tables import (
    CountedPose,
    Finite,
    KeptMessage,
    OrNan,
    ResultFile,
    Row2,
    Row3,
    counted_pose,
    kept,
)
from core.image.exclusion import known_exclusion
from core.image.targets.target_view import TargetView
from core.messages import Command, Message
from core.model import Camera
from core.model.camera import DISTORTION_NAMES


class _Distortion(ResultFile):
    k1: Finite = Field(description="a finite number")
    k2: Finite = Field(description="a finite number")
    p1: Finite = Field(description="a finite number")
    p2: Finite = Field(description="a finite number")
    k3: Finite = Field(0.0, description="a finite number")


class _View(CountedPose):
    rms_px: OrNan = math.nan
    mean_px: OrNan = math.nan
    tilt_deg: OrNan = math.nan
    points_mm: list[Row3]
    uv_px: list[Row2]
    sigma_px: list[Finite]
    residuals_px: list[Annotated[list[Finite | None], Field(min_length=2, max_length=2)]]
    counted: list[bool] = Field(default_factory=list)

    @model_validator(mode="after")
    def _as_many_of_each(self) -> _View:
        for name in ("uv_px", "sigma_px", "residuals_px", *(["counted"] if self.counted else [])):
            if len(getattr(self, name)) != len(self.points_mm):
                raise Clash(name, Message("camera.view_lengths", "is not of as many points as points_mm"))
        return self


class BoardTable(ResultFile):
    """Table of the shape of the target."""

    shape: list[Finite] = Field(min_length=4, max_length=4, description="four finite numbers")
    covariance: list[Annotated[list[Finite], Field(min_length=4, max_length=4)]] = Field(
        min_length=4, max_length=4, description="4 × 4 finite numbers"
    )
    middle_mm: Row2
    half_mm: Row2


class _CameraFile(ResultFile):
    image_size: list[Annotated[int, Field(ge=1, le=100_000)]] = Field(
        min_length=2, max_length=2, description="[width, height] in pixels"
    )
    matrix: list[Row3] = Field(min_length=3, max_length=3, description="3 × 3 finite numbers")
    distortion: _Distortion = Field(description="a table of k1, k2, p1, p2")
    covariance: list[list[Finite]] | None = Field(None, description="10 × 10 finite numbers")
    rms_px: OrNan = math.nan
    mean_px: OrNan = math.nan
    coverage: OrNan = math.nan
    tilt_range_deg: OrNan = math.nan
    cross_validation_mm: OrNan = math.nan
    board: BoardTable | None = None
    hot_pixels: Annotated[int, Field(ge=0)] | None = None
    converged: bool | None = None
    views: list[_View] = Field(default_factory=list)
    notes: list[KeptMessage] = Field(default_factory=list)

    @model_validator(mode="after")
    def _is_a_camera(self) -> _CameraFile:
        for i in range(2):
            if self.matrix[i][i] <= 0:
                raise Clash(
                    f"matrix[{i}][{i}]",
                    Message(
                        "camera.focal_length_not_positive",
                        "is {matrix:g}, but a focal length in pixels is above 0",
                        matrix=self.matrix[i][i],
                    ),
                )
        if self.matrix[1][0] != 0 or self.matrix[2] != [0, 0, 1]:
            raise Clash(
                "matrix", Message("camera.matrix_form", "is not of the form [[α, γ, u0], [0, β, v0], [0, 0, 1]]")
            )
        size = len(CAMERA_PARAMETERS)
        if self.covariance is not None and [len(row) for row in self.covariance] != [size] * size:
            raise Clash("covariance", Message("camera.covariance_shape", "is not {size} × {size} numbers", size=size))
        return self


def camera_id(camera: Camera) -> str:
    """Compute twelve hex digits that identify a camera's parameters: a hash, kept by files made with them."""
    numbers = np.concatenate([camera.image_size, camera.matrix.ravel(), camera.distortion])
    return hashlib.sha256(numbers.astype("<f8").tobytes()).hexdigest()[:12]


def write_camera(path: Path, calibration: CameraCalibration) -> None:
    """Write a camera's calibration as camera.json; InputError if it cannot be written."""
    camera = calibration.camera
    write_json(
        path,
        {
            "image_size": camera.image_size,
            "matrix": camera.matrix,
            "distortion": dict(zip(DISTORTION_NAMES, camera.distortion.tolist(), strict=True)),
            "rms_px": calibration.rms_px,
            "mean_px": calibration.mean_px,
            "sd": dict(calibration.sd),
            "coverage": calibration.coverage,
            "tilt_range_deg": math.degrees(calibration.tilt_range),
            "cross_validation_mm": calibration.cross_validation_mm,
            "hot_pixels": calibration.hot_pixels,
            "converged": calibration.converged,
            "notes": [kept(note) for note in calibration.notes],
            "id": camera_id(camera),
            "version": __version__,
            "parameters": CAMERA_PARAMETERS,
            "covariance": calibration.covariance,
            "board": board_table(calibration.board),
            "views": [_view(quality) for quality in calibration.views],
        },
    )


def read_camera(path: Path) -> CameraCalibration:
    """Read a camera's calibration from camera.json, also without uncertainties; InputError if missing or wrong.

    Raises
    ------
    InputError
        If it is missing, or a value is not finite, absurd or of a wrong shape; names file and field.
    """
    tables = read_json(
        path,
        todo=Message(
            "advice.calibrate_camera_first",
            "calibrate the camera first{command}",
            command=Command("trisect camera SET --out DIR"),
        ),
    )
    file = checked(_CameraFile, tables, path)
    with fitting(path):
        calibration = _calibration(file)
        if calibration.converged is None and has_settled(calibration):  # an earlier version's, whose views show it
            calibration = replace(calibration, converged=True)
        return calibration


def _calibration(file: _CameraFile) -> CameraCalibration:
    distortion = file.distortion
    camera = Camera(
        (file.image_size[0], file.image_size[1]),
        np.array(file.matrix),
        np.array([distortion.k1, distortion.k2, distortion.p1, distortion.p2, distortion.k3]),
    )
    size = len(CAMERA_PARAMETERS)
    return CameraCalibration(
        camera=camera,
        covariance=np.zeros((size, size)) if file.covariance is None else np.array(file.covariance),
        views=tuple(_quality(view) for view in file.views),
        rms_px=file.rms_px,
        mean_px=file.mean_px,
        coverage=file.coverage,
        tilt_range=math.radians(file.tilt_range_deg),
        cross_validation_mm=file.cross_validation_mm,
        notes=tuple(file.notes),
        board=board_shape(file.board),
        hot_pixels=file.hot_pixels,
        converged=file.converged,
    )


def board_table(shape: BoardShape) -> dict[str, Any]:
    """Make the table of camera.json or planes.json that holds a target's shape."""
    return {
        "parameters": SHAPE_PARAMETERS,
        "shape": shape.values,
        "sd": shape.sd,
        "covariance": shape.covariance,
        "middle_mm": shape.board.middle,
        "half_mm": shape.board.half,
        "departure_mm": shape.departure_mm,
    }


def board_shape(table: BoardTable | None) -> BoardShape:
    """Make a target's shape from a file's `table`; flat if that is None."""
    if table is None:
        return BoardShape()
    board = Board(np.array(table.middle_mm), np.array(table.half_mm))
    return BoardShape(board, np.array(table.shape), np.array(table.covariance))


def _view(quality: ViewQuality) -> dict[str, Any]:
    tilt_deg = math.degrees(quality.tilt)
    return counted_pose(quality, rms_px=quality.rms_px, mean_px=quality.mean_px, tilt_deg=tilt_deg) | {
        "points_mm": rounded(quality.view.points, 6),
        "uv_px": rounded(quality.view.uv, 6),
        "sigma_px": rounded(quality.view.sigma, 6),
        "residuals_px": rounded(quality.residuals, 6),
        "counted": quality.counted,
    }


def _quality(view: _View) -> ViewQuality:
    return ViewQuality(
        view=TargetView(
            np.array(view.points_mm).reshape(-1, 3),
            np.array(view.uv_px).reshape(-1, 2),
            np.array(view.sigma_px),
            view.name,
        ),
        pose=view.pose(),
        residuals=np.array(view.residuals_px, dtype=np.float64).reshape(-1, 2),
        rms_px=view.rms_px,
        mean_px=view.mean_px,
        tilt=math.radians(view.tilt_deg),
        used=view.used,
        exclusion=known_exclusion(view.reason),
        counted=np.array(view.counted, dtype=np.bool_),
    )
