"""Poses of a hand-held plate before the camera, as a technician would hold it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from core.model import Camera, Pose
from core.model.arrays import Array

BORDER_PX = 12.0
"""Px that a plate stays within the picture, so that detectors find all of it."""

# How plates are held: as technicians are advised, tilted by about 30° in different directions.
NEAREST_MM, DEPTH_RANGE_MM = 450.0, 200.0
"""Distances of the camera's target: those of the objects, and more."""
LEAST_TILT_DEG, TILT_RANGE_DEG = 5.0, 30.0
"""Tilts of the camera's target, to 35°."""
PLANE_LEAST_TILT_DEG, PLANE_TILT_RANGE_DEG = 8.0, 24.0
"""Tilts of the plane target, to 32°."""
GOLDEN_SHARE = 0.618034
"""Steps by this share spread values evenly whatever their number (golden ratio)."""


def camera_poses(
    camera: Camera, outline: Array, views: int, rng: np.random.Generator, *, nearest_mm: float = NEAREST_MM
) -> list[Pose]:
    """Make `views` poses of a plate with corners `outline` (4, 3) in mm, spread over the picture and tilted up to 35°.

    Distances from `nearest_mm` to 200 mm more (farther where the plate would not fit in), tilt axes all round, a little
    turned. The plate is wholly in each picture.

    Raises
    ------
    ValueError
        If the plate does not fit into the picture at any distance tried.
    """
    poses = []
    for view in range(views):
        across = (view + 0.5) / views
        # irrational steps, unrelated to each other, spread every choice evenly whatever the number of views
        down, tilted, about, away = (0.5 + view * np.sqrt([1.25, 2.0, 3.0, 11.0])) % 1
        tilt = np.radians(LEAST_TILT_DEG + TILT_RANGE_DEG * tilted)
        axis = 2 * np.pi * about + rng.normal(0, 0.1)
        roll = np.radians(rng.normal(0, 6.0)) + (np.pi / 2 if view % 7 == 3 else 0.0)
        distance = nearest_mm + DEPTH_RANGE_MM * away + rng.normal(0, 5.0)
        place = np.array([across, down])
        poses.append(_fitted(camera, outline, 2.4 * (place - 0.5), _turn(tilt, axis, roll), distance))
    return poses


def plane_poses(centres: Sequence[Array], outline: Array, rng: np.random.Generator, *, first: int = 0) -> list[Pose]:
    """Make a pose of a plate for each of `centres` (3,) in mm near its middle, so that the fan shines on it.

    Moved aside by up to a third of the plate, so that lines fall on all parts of it, and tilted to 32°; `outline`
    (K, 3) are the plate's corners in its own frame. `first` is how many poses were made before: these are others.
    """
    size = np.ptp(outline, axis=0)[:2]
    middle = outline.mean(axis=0)
    poses = []
    for pose, centre in enumerate(centres, first):
        angle = 2 * np.pi * pose / max(len(centres), 1)
        shift = size * [0.35 * np.cos(2 * angle + 0.5), 0.22 * np.sin(angle + 0.7)] + rng.normal(0, 3.0, 2)
        tilt = np.radians(PLANE_LEAST_TILT_DEG + PLANE_TILT_RANGE_DEG * (pose * GOLDEN_SHARE % 1))
        rotation = _turn(tilt, 2.4 * pose + rng.normal(0, 0.15), np.radians(rng.normal(0, 9.0)))
        poses.append(Pose(rotation, centre + [*shift, 0.0] - rotation @ middle))
    return poses


def _turn(tilt: float, axis: float, roll: float) -> Array:
    """Facing the camera, rolled in the picture's plane, then tilted about an axis in it."""
    about = np.array([np.cos(axis), np.sin(axis), 0.0])
    turn = Rotation.from_rotvec(tilt * about) * Rotation.from_rotvec([0, 0, roll])
    return np.asarray(turn.as_matrix(), dtype=np.float64)


def _fitted(camera: Camera, outline: Array, place: Array, rotation: Array, distance: float) -> Pose:
    """The plate drawn in from `place` (−1 … 1 over the picture), then back, until it is wholly in the picture."""
    width, height = camera.image_size
    half = np.array([width / camera.matrix[0, 0], height / camera.matrix[1, 1]]) / 2
    middle = rotation @ outline.mean(axis=0)
    for depth in distance * 1.06 ** np.arange(20):
        for pull in np.linspace(1.0, 0.0, 26):
            offset = np.append(place * pull * half * depth, depth)
            pose = Pose(rotation, offset - middle)
            uv = camera.project_pose(pose, outline)
            if (uv > BORDER_PX).all() and (uv < [width - BORDER_PX, height - BORDER_PX]).all():
                return pose
    raise ValueError("the plate does not fit into the picture at any distance tried")
