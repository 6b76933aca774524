"""Calibrations: the camera by views of a flat target, the light planes by pictures of a target in the fan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from core.calibrate.board_shape import BoardTolerance
from core.calibrate.camera import calibration
from core.calibrate.camera.options import CameraOptions
from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.calibrate.fan.poses.plane_pose import ExtraPictures, measure_plane_pose
from core.calibrate.results import CameraCalibration, FanCalibration
from core.errors import InputError
from core.image.stripes.noise import UNCOMPRESSED, Compression
from core.image.targets import Target
from core.image.targets.target_view import TargetView
from core.messages import Message
from core.pipeline.steps.planes_step import check_agreement
from core.progress import Progress, silent
from trisect.pictures import checked_picture, same_size, size_of_camera

_EDGE_PX = 1.0
"""A point may be found so far in px beyond the middles of a picture's outermost pixels."""
_GIVE_SIZE = Message("api.advice_image_size", "give (width, height) of the pictures in whole px")


def calibrate_camera(
    views: Sequence[TargetView],
    image_size: tuple[int, int],
    *,
    tolerance: BoardTolerance | None = None,
    skew: bool | None = None,
    k3: bool | None = None,
    progress: Progress = silent,
) -> CameraCalibration:
    """Calibrate the camera, its intrinsics and distortion, from views of a flat target that it took.

    Parameters
    ----------
    views
        At least three, differently tilted, as `find_target` gives them.
    image_size
        (width, height) of the pictures in px.
    tolerance
        How true the target is; None: nothing is known of it, and what is assumed is in the uncertainty.
    skew, k3
        Whether to solve for them; None: decided by the views.
    progress
        Called with how far it is.

    Returns
    -------
    CameraCalibration
        The `camera` with the covariance of its parameters, and how each view fits.

    Raises
    ------
    InputError
        If fewer than three views can be used, they do not determine the camera (all in parallel), show different
        targets, or have points outside pictures of this size.

    References
    ----------
    Z. Zhang, A flexible new technique for camera calibration, 2000, doi:10.1109/34.888718; the paper, section 2.1.

    Examples
    --------
    >>> views = [find_target(read_picture(path), small.rig.camera_target, name=path.stem) for path in small.camera]
    >>> camera = calibrate_camera(views, (768, 550))
    >>> camera.rms_px < 0.1
    True
    """
    if len(image_size) != 2 or not all(isinstance(side, int | np.integer) and side > 0 for side in image_size):
        raise InputError(
            Message("api.no_image_size", "{size} is no size of pictures", size=str(image_size)),
            where="image_size",
            todo=_GIVE_SIZE,
        )
    _check_views(views, *image_size)
    known = BoardTolerance() if tolerance is None else tolerance
    options = CameraOptions(skew=skew, k3=k3)
    return calibration.calibrate_camera(views, image_size, options, progress, tolerance=known)


def _check_views(views: Sequence[TargetView], width: int, height: int) -> None:
    """InputError if one was not seen in pictures of this size, or shows another target than the first one."""
    known: tuple[str, Target] | None = None
    for number, view in enumerate(views):
        name = view.name or f"view {number + 1}"
        outside = ((view.uv < -_EDGE_PX) | (view.uv > [width - 1 + _EDGE_PX, height - 1 + _EDGE_PX])).any(axis=1)
        for u, v in view.uv[outside][:1]:
            raise InputError(
                Message(
                    "api.point_outside",
                    "{view} has a point at ({u:.0f}, {v:.0f}) px, outside pictures of {width} × {height} px",
                    view=name, u=u, v=v, width=width, height=height,
                ),
                where="image_size",
                todo=_GIVE_SIZE,
            )  # fmt: skip
        if view.target is None:
            continue
        known = known or (name, view.target)
        if view.target != known[1]:
            raise InputError(
                Message(
                    "api.other_target",
                    "this view shows {target} and {first} shows {other}, but the shape of one target is solved for",
                    target=str(view.target), first=known[0], other=str(known[1]),
                ),
                where=name,
                todo=Message("api.advice_one_target", "give views of one target"),
            )  # fmt: skip


def calibrate_fan(
    pairs: Sequence[tuple[ArrayLike, ArrayLike | None]],
    target: Target,
    camera: CameraCalibration,
    *,
    lines: int = 3,
    angle: float | None = None,
    tolerance: BoardTolerance | None = None,
    compression: Compression = UNCOMPRESSED,
    progress: Progress = silent,
) -> FanCalibration:
    """Calibrate the light planes of the fixed laser from pictures of a flat target held into its light.

    Parameters
    ----------
    pairs
        For each pose of the target the picture with the fan on, and one of the same pose with it off (None: there is
        none); each (height, width) uint8 or uint16.
    target
        What is printed on it.
    camera
        The calibrated camera.
    lines
        How many light planes the laser has.
    angle
        Between neighbouring planes in rad, as its maker states it; None: not known.
    tolerance
        How true the target is; None: nothing is known of it, and what is assumed is in the uncertainty.
    compression
        Of the files, by `compression_of`.
    progress
        Called with how far it is.

    Returns
    -------
    FanCalibration
        The `fan` with the covariance of its planes, angles, residuals, and `notes` on what is assumed or wrong.

    Raises
    ------
    InputError
        If an array is no picture, no pose is usable, fewer lines are seen than there are, the poses are too alike, or
        most of them do not agree: leave out those that are wrong.

    References
    ----------
    The paper, section 2.2, with all planes of one pencil solved for together.

    Examples
    --------
    >>> views = [find_target(read_picture(path), small.rig.camera_target, name=path.stem) for path in small.camera]
    >>> pairs = [(read_picture(pose.on), read_picture(pose.off)) for pose in small.planes]
    >>> fan = calibrate_fan(pairs, small.rig.plane_target, calibrate_camera(views, (768, 550)), angle=small.rig.angle)
    >>> len(fan.fan.planes), max(fan.rms_mm) < 0.1
    (3, True)
    """
    if lines < 1 or (angle is not None and not 0 < angle < np.pi / 2):
        raise InputError(
            Message(
                "api.no_laser", "{lines} lines with {angle} rad between them cannot be", lines=lines, angle=str(angle)
            ),
            where="lines, angle",
            todo=Message("api.advice_laser", "give one line or more, and the angle in rad, as radians(5.0)"),
        )
    known = FanOptions(lines, angle, "auto", BoardTolerance() if tolerance is None else tolerance)
    poses, beside = [], ExtraPictures(None, compression)
    for number, (on, off) in enumerate(pairs):
        progress("plane poses", number, len(pairs))
        name = f"pose {number + 1}"
        lit = checked_picture(on, name)
        size_of_camera(lit, camera.camera, f"{name}, camera")
        dark = None if off is None else checked_picture(off, name)
        if dark is not None:
            same_size(lit, dark, name)
        poses.append(measure_plane_pose(name, lit, dark, target, camera.camera, beside=beside))
    fan = fit_fan(poses, camera.camera, known, progress)
    check_agreement(fan, decided=False)
    return replace(fan, stripes=tuple(pose.centrelines for pose in poses))
