"""The calibrations a plan will give: views and poses of the plates held as in the twin, solved by the real solvers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.calibrate.camera.calibration import calibrate_camera
from core.calibrate.camera.options import CameraOptions
from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.results import CameraCalibration, FanCalibration
from core.image.stripes.centreline import Centreline
from core.image.targets import BlackSquare, Target
from core.image.targets.target_view import TargetView
from core.messages import Message
from core.model import Camera, Pose
from core.model.arrays import Array, runs_of
from core.progress import Progress, silent
from core.simulate.calibration import PLANE_GREY
from core.simulate.poses import camera_poses, plane_poses
from core.simulate.scene.boards import WHITE, printed
from core.simulate.scene.image import generator
from core.simulate.scene.laser import fan_sheets
from core.simulate.scene.patterns import Pattern
from core.simulate.scene.stage import TABLE_DEPTH_MM
from core.simulate.scene.targets import fan_centres, room_shade
from core.wings.rig_planning.prediction.design import Design, PlanError
from core.wings.rig_planning.prediction.light_lines import FlatFace, LitLine, lit_lines
from core.wings.rig_planning.prediction.seen_stripes import SeenStripes

CORNER_PX = 0.020
"""Error in pixels per coordinate of a target's points: what the detectors leave on the twin's pictures, whatever their
resolution."""
EDGE_PX = 0.10
"""Error in pixels of one pixel's length of a black square's edge; a straight line through the edge averages it."""
STATED = 1.1
"""What the detectors state is larger by this factor."""
NEAREST_VIEW, NEAREST_POSE, FARTHEST_POSE = 450.0 / TABLE_DEPTH_MM, 430.0 / TABLE_DEPTH_MM, 620.0 / TABLE_DEPTH_MM
"""Where the plates are held, over the distance of the table."""
EDGE_IN_WIDTHS = 3.0
"""Points nearer to an edge of the plate's print than this many σ of the stripe are left out, as the real ones are."""
DARK = 0.4
"""Darker print than this share of white carries no stripe of use."""


def plan_camera(design: Design, seed: int, progress: Progress = silent) -> CameraCalibration:
    """Calibrate the camera from the planned number of simulated views.

    Raises
    ------
    InputError
        If the target does not fit into the picture, or the views do not determine the camera.
    """
    camera, target = design.camera(), design.camera_target
    noise = generator(seed, "corner noise")
    views = [view_of(f"view{i:02d}", camera, pose, target, noise) for i, pose in enumerate(view_poses(design, seed))]
    return calibrate_camera(views, camera.image_size, CameraOptions(skew=True, k3=False), progress)


def view_poses(design: Design, seed: int) -> list[Pose]:
    """Draw random poses of the camera target in the camera frame, one for each planned view.

    Raises
    ------
    InputError
        If it does not fit into the picture.
    """
    outline, rng = printed(design.camera_target).outline, generator(seed, "camera poses")
    nearest = NEAREST_VIEW * design.distance_mm
    try:
        return camera_poses(design.camera(), outline, design.views, rng, nearest_mm=nearest)
    except ValueError as error:
        raise PlanError(
            Message(
                "plan.target_too_large",
                "the target does not fit into the picture at any distance up to three times the table's, so the camera "
                "could not be calibrated",
            ),
            where="[camera_target]",
            todo=Message("plan.advice_smaller_target", "plan a smaller target, a shorter focal_mm or more pixels"),
        ) from error


def plan_fan(design: Design, camera: Camera, seed: int, progress: Progress = silent) -> FanCalibration:
    """Calibrate the fan from the planned number of simulated poses, with the calibrated `camera`.

    Raises
    ------
    InputError
        If the fan meets the target in too few poses to be calibrated.
    """
    options = FanOptions(design.lines, np.radians(design.angle_deg) if design.lines > 1 else None)
    return fit_fan(_plates_seen(design, seed, design.poses, "plate noise"), camera, options, progress)


def plan_check(design: Design, seed: int) -> list[PoseFeatures]:
    """Simulate the planned pictures of an interim check: the plane target in the fan on the day of the scan."""
    return _plates_seen(design, seed, design.check_poses, "check noise")


def _plates_seen(design: Design, seed: int, count: int, what: str) -> list[PoseFeatures]:
    """What `count` pictures of the plane target in the fan show; `what` names their noise."""
    true, target = design.camera(), design.plane_target
    stripes = SeenStripes.of_plates(design)
    noise = generator(seed, what)
    features = []
    for number, (pose, pieces) in enumerate(plates_under_fan(design, seed, count)):
        view = view_of(f"pose{number:02d}", true, pose, target, noise)
        tried = stripes.tried(pieces, WHITE * float(room_shade(pose, PLANE_GREY)))  # each pose has its own sharpness
        features.append(_features(view, tuple(tried.centreline(piece, noise) for piece in pieces), true))
    return features


def plates_under_fan(design: Design, seed: int, count: int) -> list[tuple[Pose, list[LitLine]]]:
    """Draw `count` random poses of the plane target, each with the fan's stripes on its light parts."""
    rig, plate = design.rig(), printed(design.plane_target)
    near, far = NEAREST_POSE * design.distance_mm, FARTHEST_POSE * design.distance_mm
    poses = plane_poses(fan_centres(rig, count, near, far), plate.outline, generator(seed, "plane poses"))
    filter_px, nothing = SeenStripes.of_plates(design).filter_px, np.empty((0, 3, 3))
    return [
        (
            pose,
            [
                piece
                for sheet in fan_sheets(rig, pose.translation)
                for piece in on_plate(
                    lit_lines(sheet, (face_of(plate, pose),), nothing, rig.camera, rig.blur_px, filter_px), plate, pose
                )
            ],
        )
        for pose in poses
    ]


def _features(view: TargetView, centrelines: tuple[Centreline, ...], camera: Camera) -> PoseFeatures:
    inside = ((view.uv > 0) & (view.uv < np.array(camera.image_size) - 1)).all()
    if not inside:
        return PoseFeatures(
            view.name,
            None,
            (),
            Message("design.target_cut_off", "the target would not be wholly in the picture"),
        )
    dark = None if centrelines else Message("design.no_stripe", "no stripe would fall on the target")
    return PoseFeatures(view.name, view, centrelines, dark)


def view_of(name: str, camera: Camera, pose: Pose, target: Target, rng: np.random.Generator) -> TargetView:
    """Simulate what the detector would find of a target; what it states is a little more than the errors drawn."""
    uv = camera.project_pose(pose, target.points)
    if isinstance(target, BlackSquare):
        covariance = square_covariance(uv, EDGE_PX)
        error = (np.linalg.cholesky(covariance) @ rng.standard_normal(2 * len(uv))).reshape(-1, 2)
        sigma = STATED * np.sqrt(np.diag(covariance).reshape(-1, 2).mean(axis=1))
        return TargetView(target.points, uv + error, sigma, name, STATED**2 * covariance)
    found = uv + CORNER_PX * rng.standard_normal(uv.shape)
    return TargetView(target.points, found, np.full(len(uv), STATED * CORNER_PX), name)


def square_covariance(uv: Array, edge_px: float) -> Array:
    """Compute the covariance (8, 8) in px² of a square's corners `uv` (4, 2), found by fitting lines to its edges.

    `edge_px` is the error of one pixel's length of an edge.

    A line fitted to n points of standard deviation s has variance 4 s²/n at its ends, and −2 s²/n between them.
    """
    following = np.roll(uv, -1, axis=0)
    length = np.linalg.norm(following - uv, axis=1)
    normals = np.column_stack([uv[:, 1] - following[:, 1], following[:, 0] - uv[:, 0]]) / length[:, None]
    ends = np.zeros((8, 8))  # of edge k: its start in row 2k, its end in row 2k + 1
    by_ends = np.zeros((8, 8))
    for k in range(4):
        ends[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = edge_px**2 / length[k] * np.array([[4.0, -2.0], [-2.0, 4.0]])
        meeting = np.linalg.inv(normals[[k - 1, k]])
        by_ends[2 * k : 2 * k + 2, [2 * ((k - 1) % 4) + 1, 2 * k]] = meeting
    return np.asarray(by_ends @ ends @ by_ends.T, dtype=np.float64)


def face_of(plate: Pattern, pose: Pose) -> FlatFace:
    """Make the face of a printed plate in its `pose`."""
    return FlatFace(pose.apply(plate.outline), -pose.rotation[:, 2], WHITE)


def on_plate(lines: tuple[LitLine, ...], plate: Pattern, pose: Pose) -> list[LitLine]:
    """Select the stretches of stripes on the light parts of a printed plate."""
    kept = []
    for line in lines:
        margin = int(np.ceil(EDGE_IN_WIDTHS * float(np.median(line.width))))
        for first, last in runs_of(_light(plate, pose.inverse().apply(line.points)[:, :2])):
            start, end = first + margin * (first > 0), last - margin * (last < len(line))
            if end - start > 2 * margin:
                kept.append(line.select(slice(start, end)))
    return kept


def _light(plate: Pattern, xy: Array) -> NDArray[np.bool_]:
    """Whether the plate's print is light at places (N, 2) in mm on it."""
    column = np.clip(np.searchsorted(plate.x_edges, xy[:, 0]) - 1, 0, plate.albedo.shape[1] - 1)
    row = np.clip(np.searchsorted(plate.y_edges, xy[:, 1]) - 1, 0, plate.albedo.shape[0] - 1)
    light = plate.albedo[row, column] > DARK * WHITE
    if plate.dots is not None:
        for dot in plate.dots:
            light &= np.hypot(*(xy - dot).T) > plate.dot_radius
    return np.asarray(light, dtype=np.bool_)
