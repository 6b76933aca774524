"""planes.json: the fan's calibration."""

from __future__ import annotations

import hashlib
import math
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from core import __version__
from core.calibrate.board_shape import SUSPECTED_SCALE
from core.calibrate.results import CAMERA_PARAMETERS, FanCalibration, PlanePose, Readjustment
from core.calibrate.sitting import Acquisition
from core.errors import InputError, WrongValue
from core.files.complaints import Clash, checked, fitting
from core.files.json_text import write_json
from core.files.reading import read_json
from core.files.results.camera_file import BoardTable, board_shape, board_table, camera_id
from core.files.tables import (
    CountedPose,
    Finite,
    KeptMessage,
    OptionalMessage,
    OrNan,
    PlaneRow,
    ResultFile,
    Row3,
    Time,
    counted_pose,
    kept,
)
from core.image.exclusion import known_exclusion
from core.messages import Command, Message
from core.model import Camera, Fan, LightPlane

_PARAMETERS = len(CAMERA_PARAMETERS)
_CHANGES = 9
"""Turns, shifts, drifts of the picture, and the focal length."""
_ReadjustedSource = Literal[
    "camera", "fan", "assumed fan", "scale", "assumed scale", "change", "assumed change", "readjusted"
]


class _Plane(PlaneRow):
    normal: Row3 | None = None
    d_mm: Finite | None = None
    rms_mm: OrNan = math.nan

    @model_validator(mode="after")
    def _agrees(self) -> _Plane:
        if self.normal is not None and self.d_mm is not None:
            said = [coordinate * self.d_mm for coordinate in self.pi]
            if not np.allclose(said, self.normal, rtol=0, atol=1e-6):
                raise Clash("normal", Message("fan.normal_disagrees", "and d_mm do not agree with pi"))
        return self


class _Angles(ResultFile):
    constrained: list[Finite] = Field(default_factory=list)
    free: list[Finite] = Field(default_factory=list)


class _Pose(CountedPose):
    rms_mm: OrNan = math.nan
    prediction_mm: OrNan = math.nan
    target_rms_px: OrNan = math.nan


class _Camera(ResultFile):
    """The camera that the poses have corrected."""

    matrix: list[Row3] = Field(min_length=3, max_length=3)
    distortion: list[Finite] = Field(min_length=5, max_length=5)
    covariance: list[Annotated[list[Finite], Field(min_length=_PARAMETERS, max_length=_PARAMETERS)]] = Field(
        min_length=_PARAMETERS, max_length=_PARAMETERS
    )


class _Readjusted(ResultFile):
    of: str
    taken_at: Time
    pictures_id: str
    pictures: dict[str, str] = Field(default_factory=dict)
    poses: int
    change: Annotated[list[Finite], Field(min_length=_CHANGES, max_length=_CHANGES)]
    sd: Annotated[list[Finite], Field(min_length=_CHANGES, max_length=_CHANGES)]
    widened: Annotated[list[Finite], Field(min_length=4, max_length=4)]
    p_before: Finite = Field(ge=0, le=1, description="a probability, 0 to 1")
    p_after: Finite = Field(ge=0, le=1, description="a probability, 0 to 1")
    deviations: list[list[Finite]]
    sources: list[_ReadjustedSource]
    before: _Readjusted | None = None


class _Taken(ResultFile):
    """By which camera and when the pictures were taken, by their recording's log."""

    camera: str
    first: Time
    last: Time


class _PlanesFile(ResultFile):
    planes: list[_Plane] = Field(min_length=1, description="a list of one or more light planes")
    free_planes: list[_Plane] = Field(default_factory=list)
    angles_deg: _Angles = Field(default_factory=_Angles)
    covariance: list[list[Finite]] | None = Field(None, description="3N × 3N finite numbers for N planes")
    free_covariance: list[list[Finite]] | None = Field(None, description="3N × 3N finite numbers for N planes")
    by_camera: list[list[Finite]] | None = Field(None, description="3N × 10 finite numbers for N planes")
    scale_sd: Finite | None = Field(None, ge=0, le=0.1, description="a share of the target's size from 0 to 0.1")
    scale_assumed: bool | None = None
    converged: bool | None = None
    points_off_alike: bool | None = None
    flatness_assumed: bool | None = None
    cross_validation_mm: OrNan = math.nan
    stripe_sd_mm: OrNan = math.nan
    corner_scale: OrNan = math.nan
    camera: _Camera | None = None
    board: BoardTable | None = None
    bends: list[Annotated[list[Row3], Field(min_length=3, max_length=3)]] | None = None
    readjusted: _Readjusted | None = None
    taken: _Taken | None = None
    pencil_gap_mm: OrNan = math.nan
    pencil_gap_sd_mm: OrNan = math.nan
    constraint_suits: bool | None = None
    verdict: OptionalMessage = None
    camera_id: str = ""
    poses: list[_Pose] = Field(default_factory=list)
    notes: list[KeptMessage] = Field(default_factory=list)

    @property
    def tells_all_of_u(self) -> bool:
        """Whether all that U is made of is there, a null for what there is none of: what is left out is not known."""
        return {"bends", "by_camera"} <= self.model_fields_set and self.by_camera is not None

    @model_validator(mode="after")
    def _shapes(self) -> _PlanesFile:
        size = 3 * len(self.planes)
        for name in ("covariance", "free_covariance"):
            given = getattr(self, name)
            if given is not None and [len(row) for row in given] != [size] * size:
                raise Clash(
                    name,
                    Message(
                        "fan.covariance_shape",
                        "is not {size} × {size} numbers, as {planes} planes need",
                        size=size,
                        planes=len(self.planes),
                    ),
                )
        if self.by_camera is not None and [len(row) for row in self.by_camera] != [_PARAMETERS] * size:
            raise Clash(
                "by_camera",
                Message(
                    "fan.sensitivity_shape",
                    "is not {size} × {parameters} numbers, as {planes} planes need",
                    size=size,
                    parameters=_PARAMETERS,
                    planes=len(self.planes),
                ),
            )
        if self.bends is not None and len(self.bends) != len(self.planes):
            raise Clash(
                "bends",
                Message(
                    "fan.bends_count",
                    "has {bends} matrices for {planes} planes",
                    bends=len(self.bends),
                    planes=len(self.planes),
                ),
            )
        known = self.readjusted
        while known is not None:
            if [len(row) for row in known.deviations] != [_PARAMETERS + size] * len(known.sources):
                raise Clash(
                    "readjusted",
                    Message(
                        "fan.readjusted_shape",
                        "has deviations that are not {sources} rows of {size} numbers",
                        sources=len(known.sources),
                        size=_PARAMETERS + size,
                    ),
                )
            known = known.before
        if self.free_planes and len(self.free_planes) != len(self.planes):
            raise Clash(
                "free_planes",
                Message(
                    "fan.free_planes_count",
                    "has {free_planes} planes, not {planes} as planes has",
                    free_planes=len(self.free_planes),
                    planes=len(self.planes),
                ),
            )
        return self


def planes_id(fan: Fan) -> str:
    """Compute twelve hex digits that identify a fan's light planes: a hash of them."""
    return hashlib.sha256(fan.pis.astype("<f8").tobytes()).hexdigest()[:12]


_FACTS = ("converged", "flatness_assumed")
"""Known of every calibration whose file tells facts: whether points lie off alike, few poses may leave open."""


def states_all_facts(path: Path) -> bool:
    """Whether a planes.json holds all facts that verdicts depend on; False for an earlier version, or if damaged."""
    try:
        tables = read_json(path)
    except InputError:
        return False
    return all(tables.get(name) is not None for name in _FACTS)


def write_planes(path: Path, calibration: FanCalibration, camera: Camera) -> None:
    """Write the light planes' calibration, and its `camera`, as planes.json; InputError if that fails."""
    degrees = {
        "constrained": [math.degrees(angle) for angle in calibration.angles],
        "free": [math.degrees(angle) for angle in calibration.free_angles],
    }
    write_json(
        path,
        {
            "planes": [
                _plane(plane) | {"rms_mm": rms}
                for plane, rms in zip(calibration.fan.planes, calibration.rms_mm, strict=True)
            ],
            "angles_deg": degrees,
            "cross_validation_mm": calibration.cross_validation_mm,
            "stripe_sd_mm": calibration.stripe_sd_mm,
            "corner_scale": calibration.corner_scale,
            "pencil_gap_mm": calibration.pencil_gap_mm,
            "pencil_gap_sd_mm": calibration.pencil_gap_sd_mm,
            "constraint_suits": calibration.constraint_suits,
            "verdict": kept(calibration.verdict),
            "notes": [kept(note) for note in calibration.notes],
            "free_planes": [_plane(plane) for plane in calibration.free.planes],
            "id": planes_id(calibration.fan),
            "camera_id": camera_id(camera),
            "version": __version__,
            "covariance": calibration.fan.covariance,
            "free_covariance": calibration.free.covariance if calibration.free.has_covariance else None,
            "by_camera": calibration.by_camera,
            "scale_sd": calibration.scale_sd,
            "scale_assumed": calibration.scale_assumed,
            "converged": calibration.converged,
            "points_off_alike": calibration.points_off_alike,
            "flatness_assumed": calibration.flatness_assumed,
            "camera": _corrected_camera(calibration),
            "board": board_table(calibration.board) if calibration.board.values.any() else None,
            "bends": calibration.bends,
            **({} if calibration.taken is None else {"taken": _taken_table(calibration.taken)}),
            **({} if calibration.readjusted is None else {"readjusted": _readjusted_table(calibration.readjusted)}),
            "poses": [_pose(pose) for pose in calibration.poses],
        },
    )


def read_planes(path: Path, camera: Camera) -> FanCalibration:
    """Read the light planes' calibration for `camera` from planes.json; InputError if it is missing or wrong.

    The poses come back without their points, which the file does not keep.

    Raises
    ------
    InputError
        If it is missing, a value is not finite, zero or of a wrong shape, or it belongs to another camera calibration.
    """
    tables = read_json(
        path,
        todo=Message(
            "advice.calibrate_planes_first",
            "calibrate the laser planes first{command}",
            command=Command("trisect planes SET --out DIR"),
        ),
    )
    file = checked(_PlanesFile, tables, path)
    if file.camera_id and file.camera_id != camera_id(camera):
        raise InputError(
            Message(
                "fan.other_camera",
                "camera_id is {camera_id}, but camera.json is {camera_id2}: the camera was calibrated again",
                camera_id=file.camera_id,
                camera_id2=camera_id(camera),
            ),
            where=path,
            todo=Message(
                "advice.calibrate_planes_again",
                "calibrate the laser planes again{command}",
                command=Command("trisect planes SET --out DIR"),
            ),
        )
    with fitting(path):
        return _calibration(file, camera, path)


def _calibration(file: _PlanesFile, camera: Camera, path: Path) -> FanCalibration:
    fan = Fan(
        tuple(LightPlane(np.array(plane.pi)) for plane in file.planes),
        None if file.covariance is None else np.array(file.covariance),
    )
    free = fan
    if file.free_planes:
        free = Fan(
            tuple(LightPlane(np.array(plane.pi)) for plane in file.free_planes),
            None if file.free_covariance is None else np.array(file.free_covariance),
        )
    return FanCalibration(
        fan=fan,
        free=free,
        rms_mm=tuple(plane.rms_mm for plane in file.planes),
        angles=tuple(math.radians(angle) for angle in file.angles_deg.constrained) or fan.angles,
        free_angles=tuple(math.radians(angle) for angle in file.angles_deg.free) or free.angles,
        pencil_gap_mm=file.pencil_gap_mm,
        pencil_gap_sd_mm=file.pencil_gap_sd_mm,
        constraint_suits=file.constraint_suits,
        verdict=file.verdict,
        poses=tuple(_plane_pose(pose) for pose in file.poses),
        notes=tuple(file.notes),
        by_camera=None if file.by_camera is None else np.array(file.by_camera),
        scale_sd=SUSPECTED_SCALE if file.scale_sd is None else file.scale_sd,
        scale_assumed=None if file.scale_sd is None else file.scale_assumed,
        cross_validation_mm=file.cross_validation_mm,
        stripe_sd_mm=file.stripe_sd_mm,
        corner_scale=file.corner_scale,
        camera=_camera(path, file.camera, camera.image_size),
        camera_covariance=None if file.camera is None else np.array(file.camera.covariance),
        board=board_shape(file.board),
        bends=None if file.bends is None else np.array(file.bends),
        readjusted=_readjusted(file.readjusted),
        converged=file.converged if file.tells_all_of_u else None,
        points_off_alike=file.points_off_alike,
        flatness_assumed=file.flatness_assumed,
        taken=None if file.taken is None else Acquisition(file.taken.camera, file.taken.first, file.taken.last),
    )


def _taken_table(taken: Acquisition) -> dict[str, str]:
    return {"camera": taken.camera, "first": taken.first.isoformat(), "last": taken.last.isoformat()}


def _readjusted_table(known: Readjustment) -> dict[str, Any]:
    return {
        "of": known.of,
        "taken_at": known.taken_at.isoformat(),
        "pictures_id": known.pictures_id,
        "pictures": dict(known.hashes),
        "poses": known.poses,
        "change": known.change,
        "sd": known.sd,
        "widened": known.widened,
        "p_before": known.p_before,
        "p_after": known.p_after,
        "deviations": known.deviations,
        "sources": list(known.sources),
        "before": None if known.before is None else _readjusted_table(known.before),
    }


def _readjusted(file: _Readjusted | None) -> Readjustment | None:
    if file is None:
        return None
    return Readjustment(
        of=file.of,
        taken_at=file.taken_at,
        pictures_id=file.pictures_id,
        hashes=file.pictures,
        poses=file.poses,
        change=np.array(file.change),
        sd=np.array(file.sd),
        widened=np.array(file.widened),
        p_before=file.p_before,
        p_after=file.p_after,
        deviations=np.array(file.deviations),
        sources=tuple(file.sources),
        before=_readjusted(file.before),
    )


def _corrected_camera(calibration: FanCalibration) -> dict[str, Any] | None:
    camera = calibration.camera
    if camera is None:
        return None
    return {
        "matrix": camera.matrix,
        "distortion": camera.distortion,
        "covariance": calibration.camera_covariance,
        "id": camera_id(camera),
    }


def _camera(path: Path, table: _Camera | None, image_size: tuple[int, int]) -> Camera | None:
    if table is None:
        return None
    try:
        return Camera(image_size, np.array(table.matrix), np.array(table.distortion))
    except WrongValue as error:
        raise InputError(
            Message("fan.camera_invalid", "camera is none: {reason}", reason=error.what),
            where=path,
            todo=Message("advice.solve_planes_again", "calibrate the laser planes again"),
        ) from error


def _plane(plane: LightPlane) -> dict[str, Any]:
    return {"normal": plane.normal, "d_mm": plane.d_mm, "pi": plane.pi}


def _pose(pose: PlanePose) -> dict[str, Any]:
    return counted_pose(
        pose, rms_mm=pose.rms_mm, prediction_mm=pose.prediction_mm, target_rms_px=pose.target_rms_px
    ) | {"points": [len(points) for points in pose.points]}


def _plane_pose(pose: _Pose) -> PlanePose:
    return PlanePose(
        name=pose.name,
        pose=pose.pose(),
        target_rms_px=pose.target_rms_px,
        points=(),
        distances=(),
        rms_mm=pose.rms_mm,
        used=pose.used,
        prediction_mm=pose.prediction_mm,
        exclusion=known_exclusion(pose.reason),
    )
