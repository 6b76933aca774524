"""Results of the calibrations, with their own quality."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime

import numpy as np
from numpy.typing import NDArray

from core.calibrate.board_shape import BoardShape, size_assumed
from core.calibrate.sitting import Acquisition
from core.findings.table import note_of
from core.image.exclusion import Excludable, Exclusion, Reason
from core.image.stripes.centreline import Centreline
from core.image.targets.target_view import TargetView
from core.messages import Message
from core.model import Camera, Fan, Pose
from core.model.arrays import Array

CAMERA_PARAMETERS = ("alpha", "beta", "gamma", "u0", "v0", "k1", "k2", "p1", "p2", "k3")
"""Names and order of the camera's parameters in covariances."""


@dataclass(frozen=True, eq=False, slots=True)
class ViewQuality(Excludable):
    """Quality of one view: how it fits the calibrated camera.

    Residuals are observed − predicted, (N, 2) in pixels. `counted` (N,) is False for single corners left out as
    misfound; `rms_px` and `mean_px` are of the residual vectors' lengths of those that count. `tilt` is the angle in
    rad between the target's normal and the optical axis. A view that was left out says why in `exclusion`; if not even
    a pose could be found for it, its residuals are NaN.
    """

    view: TargetView
    pose: Pose
    residuals: Array
    rms_px: float
    mean_px: float
    tilt: float
    used: bool
    exclusion: Reason | None = None
    counted: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=np.bool_))

    @property
    def name(self) -> str:
        """Name of the view's picture."""
        return self.view.name


@dataclass(frozen=True, eq=False, slots=True)
class CameraCalibration:
    """A calibrated camera with its covariance and quality.

    `covariance` is (10, 10) in the order of CAMERA_PARAMETERS, zero rows for fixed parameters.
    `rms_px` is the root mean square of the residual vectors' lengths over used views, `mean_px` their mean length
    (the paper judges by this one). `coverage` is the share (0…1) of the picture's cells that hold a corner;
    `tilt_range` the largest angle in rad between two views' target normals. `cross_validation_mm` is the RMS
    distance between the points that cameras solved from odd and from even views give over the work volume, NaN when
    there are too few views for two cameras. `notes` are for the technician. `board` is the shape of the
    target as all views together tell it, which the residuals have taken into account. `hot_pixels` is the number of
    pixels that shine by themselves in all pictures, `converged` whether it was solved to the end
    (`core.calibrate.camera.settled`); None where that is not known.
    """

    camera: Camera
    covariance: Array
    views: tuple[ViewQuality, ...]
    rms_px: float
    mean_px: float
    coverage: float
    tilt_range: float
    cross_validation_mm: float
    notes: tuple[Message, ...] = ()
    board: BoardShape = field(default_factory=BoardShape)
    hot_pixels: int | None = None
    converged: bool | None = None

    @property
    def sd(self) -> Mapping[str, float]:
        """Standard deviation of each camera parameter, by its name."""
        return {name: float(max(self.covariance[i, i], 0.0) ** 0.5) for i, name in enumerate(CAMERA_PARAMETERS)}

    @property
    def ranked(self) -> tuple[ViewQuality, ...]:
        """Views in the order of their RMS residual, the smallest first; those left out come last."""
        return tuple(sorted(self.views, key=lambda quality: (not quality.used, np.nan_to_num(quality.rms_px, nan=1e9))))


@dataclass(frozen=True, eq=False, slots=True)
class PlanePose(Excludable):
    """One pose of the plane target in the fan's calibration.

    `points[k]` are the (n_k, 3) points in mm in the camera frame on fan line k, `distances[k]` their signed
    distances in mm from the plane in use; both empty for a line this pose does not show. `pose` is the target's pose
    after it was adjusted together with the fan, `target_rms_px` how well the target alone fits its own pose. A pose
    that was left out says why in `exclusion`; where none could be found it is the identity and the RMS are NaN.
    `prediction_mm` is the RMS distance of its stripes from the light planes that the other poses give, the target where
    its own points put it; NaN where that is not known.
    """

    name: str
    pose: Pose
    target_rms_px: float
    points: tuple[Array, ...]
    distances: tuple[Array, ...]
    rms_mm: float
    used: bool
    exclusion: Reason | None = None
    prediction_mm: float = math.nan


@dataclass(frozen=True, eq=False, slots=True)
class Readjustment:
    """Record of moving camera and fan to the pictures of a check (`core.calibrate.readjustment`).

    Parameters
    ----------
    of
        The id of camera and fan before.
    taken_at, pictures_id, hashes, poses
        When the newest picture was taken, what names them all, SHA-256 by their names, and how many poses say
        something.
    change, sd
        (9,) what was found to have changed and its standard uncertainty: turns of the fan about the camera's axes (3)
        in rad and its shifts (3) in mm, shifts of the picture (2) in px, and the focal length as a share of it.
    widened
        (4,) how many times larger turns, shifts, drifts and changes of the focal length were reckoned with than the
        rig's stability has them.
    p_before, p_after
        Probability that noise and the calibrations' uncertainty would set the stripes so far off as they were before,
        and as they are now.
    deviations, sources
        (K, 10 + 3N) steps of the camera's parameters and the fan's π, one standard uncertainty each, independent of
        each other: all that is uncertain of them now; and the source of each.
    before
        That of the calibrations before, if they were re-adjusted themselves.
    """

    of: str
    taken_at: datetime
    pictures_id: str
    hashes: Mapping[str, str]
    poses: int
    change: Array
    sd: Array
    widened: Array
    p_before: float
    p_after: float
    deviations: Array
    sources: tuple[str, ...]
    before: Readjustment | None = None

    @property
    def note(self) -> Message:
        """Note on how far a re-adjustment moves laser and picture, and on the agreement before and after it."""
        turn, shift, drift, focal = np.split(np.asarray(self.change), [3, 6, 8])
        return note_of(
            "fan.readjusted",
            poses=self.poses,
            date=self.taken_at.astimezone(),
            turn_urad=1e6 * float(np.linalg.norm(turn)),
            shift_um=1e3 * float(np.linalg.norm(shift)),
            drift_px=float(np.linalg.norm(drift)),
            focal_ppm=1e6 * float(focal[0]),
            p_before=self.p_before,
            p_after=self.p_after,
        )


@dataclass(frozen=True, eq=False, slots=True)
class FanCalibration:
    """A calibrated fan with its covariance and quality.

    `fan` is the result to use (constrained when the constraint suits the laser), `free` the planes fitted each on
    its own; their covariances take the camera as known. `rms_mm` per line. `angles` (rad) between neighbouring planes
    of the constrained and the free fit. `pencil_gap_mm` is the largest distance of the free planes from those of one
    pencil, its angles free, within the work volume, `pencil_gap_sd_mm` its standard deviation; `constraint_suits` None
    where there is no constraint (one line).
    `stripe_sd_mm` is the standard deviation of a whole stripe from its plane beyond the stripe's own noise
    (flatness of the plate, lens), `corner_scale` the factor by which the target's points scatter more than they state.
    `by_camera` (3N, 10) is how the stacked π of `fan` follow a change of the camera's parameters, the pictures the
    same; None where that is not known. `scale_sd` is the standard uncertainty of the target's size, as a share of it:
    no picture shows it, and all lengths have it in common.
    `cross_validation_mm` is the RMS of the poses' prediction errors. `camera` and `camera_covariance` are the camera
    that the target's poses have corrected, which belongs to this fan; None where it was left as it is. `board` is the
    shape of the plane target where its flatness is uncertain; else it is flat. `bends` (N, 3, 3) are how the light was
    seen to be off its planes, as in `Fan`: one standard uncertainty, for what bends it is not known; None where it is
    straight. `readjusted` where camera and fan were moved since by the pictures of a check.

    Facts, None where they are not known: `converged`, whether planes and poses were solved to the end;
    `points_off_alike`, whether the target's points lie off alike in all poses, which U need not contain (nor is it
    known where they seem to, in poses too few to tell);
    `scale_assumed`, whether nobody has stated how true the target's size is, nor a comparison with another size has
    confirmed it; `flatness_assumed`, whether nobody has stated how flat the target is; `taken`, by which camera and
    when its pictures were taken, by their recording's log.

    `stripes` are the fan's in each of its poses, as arrays were calibrated; of a recording set planes.npz keeps them.
    """

    fan: Fan
    free: Fan
    rms_mm: tuple[float, ...]
    angles: tuple[float, ...]
    free_angles: tuple[float, ...]
    pencil_gap_mm: float
    constraint_suits: bool | None
    verdict: Message | None
    poses: tuple[PlanePose, ...]
    notes: tuple[Message, ...] = ()
    pencil_gap_sd_mm: float = math.nan
    stripe_sd_mm: float = math.nan
    corner_scale: float = math.nan
    by_camera: Array | None = None
    scale_sd: float = 0.0
    scale_assumed: bool | None = None
    cross_validation_mm: float = math.nan
    camera: Camera | None = None
    camera_covariance: Array | None = None
    board: BoardShape = field(default_factory=BoardShape)
    bends: Array | None = None
    readjusted: Readjustment | None = None
    converged: bool | None = None
    points_off_alike: bool | None = None
    flatness_assumed: bool | None = None
    taken: Acquisition | None = None
    stripes: tuple[tuple[Centreline, ...], ...] = ()

    @property
    def all_notes(self) -> tuple[Message, ...]:
        """Notes of the calibration, with one that the target's size is assumed, if so."""
        unstated = self.scale_assumed is not False and self.scale_sd > 0
        size = (size_assumed("plane_target", self.scale_sd),) if unstated else ()
        return tuple(dict.fromkeys((*self.notes, *size)))

    @property
    def minority(self) -> Message | None:
        """Warning that fewer than half of the poses with target and stripes are used; None if more are."""
        speaking = [
            pose
            for pose in self.poses
            if pose.used or (np.isfinite(pose.rms_mm) and pose.exclusion is not Exclusion.BY_HAND)
        ]
        used = sum(pose.used for pose in speaking)
        if 2 * used >= len(speaking):
            return None
        return Message(
            "fan.minority",
            "only {used} of the {all} poses that show target and stripes agree on the laser planes",
            used=used,
            all=len(speaking),
        )

    def camera_used(self, given: CameraCalibration) -> CameraCalibration:
        """Return the camera to use with this fan: `given`, or as the fan's calibration has corrected it."""
        if self.camera is None or self.camera_covariance is None:
            return given
        return replace(given, camera=self.camera, covariance=self.camera_covariance)


NO_FAN = FanCalibration(
    Fan(()),
    Fan(()),
    rms_mm=(),
    angles=(),
    free_angles=(),
    pencil_gap_mm=math.nan,
    constraint_suits=None,
    verdict=None,
    poses=(),
    by_camera=np.zeros((0, len(CAMERA_PARAMETERS))),
    scale_assumed=False,
    converged=True,
    points_off_alike=False,
    flatness_assumed=False,
)
"""Of a rig that has no fan: nothing of it is uncertain."""


@dataclass(frozen=True, eq=False, slots=True)
class ProposedReadjustment:
    """Proposed re-adjustment of camera and fan, with its effects.

    Parameters
    ----------
    camera, fan
        As they would be.
    offset_px, offset_mm
        RMS distances of the stripes from where they are expected, before and after.
    step_mm, correction_mm, u_mm
        A step of this height would be measured larger by `correction_mm`, and what camera and fan leave uncertain of it
        (standard uncertainty).
    """

    camera: CameraCalibration
    fan: FanCalibration
    offset_px: tuple[float, float]
    offset_mm: tuple[float, float]
    step_mm: float
    correction_mm: float
    u_mm: float

    @property
    def record(self) -> Readjustment:
        """Record of the proposed re-adjustment, as the fan states it."""
        assert self.fan.readjusted is not None
        return self.fan.readjusted
