"""The view of the target that would add most to those taken, to be shown in the live picture."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from core.calibrate.camera.missing import ViewGeometry
from core.model import Camera, Pose
from core.model.arrays import Array

# Held by tests/calibrate/camera/test_wanted_view.py: a series that follows the wanted views lacks nothing at its end.
_TILTS_DEG = ((0, 0), (25, 0), (-25, 0), (0, 25), (0, -25), (18, 18), (18, -18), (-18, 18), (-18, -18))
"""About the picture's axes: angles of 50° between two of them, in all directions."""
_PLACES = (0.25, 0.5, 0.75)
"""Of the picture's width and height: the target's middle."""
_NEARER = (0.8, 1.0, 1.25)
"""Times the median distance of the views taken."""
_MARGIN = 0.01
"""Share of the picture's width that is kept free at its borders."""
_GRID = 12
"""Points across and down the target that say which part of the picture it covers."""
_ENOUGH_TURNED, _ENOUGH_NEARER = float(np.deg2rad(30.0)), float(np.log(1.2))
"""Angle in rad, and logarithm of a ratio of distances, beyond which a view is not more different."""
_FOR_TILT, _FOR_DISTANCE = 0.5, 0.2
"""What these are worth; a whole picture newly covered is worth 1."""


def next_view_outline(
    extent: Array,
    camera: Camera,
    taken: Sequence[ViewGeometry],
    adds: Callable[[ViewGeometry, Array], float | None],
    middle: Array | None = None,
) -> Array | None:
    """Compute the outline (5, 2) in px of the target at the pose that adds most to the views taken; None if none adds.

    Parameters
    ----------
    extent
        (2, 2) smallest and largest x, y of the target's points in mm.
    camera
        As well as it is known.
    taken
        Geometry of the views taken, at least one.
    adds
        Share of the picture that a view of this geometry would newly cover with points at these pixels (N, 2); None if
        it would not be taken.
    middle
        (2,) pixel where the target's middle has to be; None: anywhere.

    Returns
    -------
    (5, 2) corners in pixels, the first one again at the end; None if no view within the picture adds anything.
    """
    low, high = extent
    sides = [np.linspace(low[axis], high[axis], _GRID) for axis in (0, 1)]
    points = np.stack([*(each.ravel() for each in np.meshgrid(*sides)), np.zeros(_GRID**2)], axis=1)
    best, outline = 0.0, None
    for pose in _candidates(points.mean(axis=0), camera, taken, middle):
        uv = camera.project_pose(pose, points)
        if not _within(uv, camera):
            continue
        geometry = ViewGeometry(
            pose.rotation[:, 2], float(np.linalg.norm(pose.apply(points.mean(axis=0)[None])[0])), pose
        )
        covers = adds(geometry, uv)
        if covers is None:
            continue
        worth = covers + _difference(geometry, taken)
        if worth > best:
            best, outline = worth, uv.reshape(_GRID, _GRID, 2)
    return None if outline is None else outline[[0, 0, -1, -1, 0], [0, -1, -1, 0, 0]]


def _candidates(
    middle_mm: Array, camera: Camera, taken: Sequence[ViewGeometry], middle: Array | None
) -> Iterator[Pose]:
    """Poses of a target with this middle (3,), at a `middle` pixel (2,) or all over the picture."""
    usual = float(np.median([view.distance for view in taken]))
    size = np.array(camera.image_size, dtype=np.float64)
    places = [np.array([x, y]) * size for y in _PLACES for x in _PLACES] if middle is None else [middle]
    for place in places:
        ray = camera.rays(place[None])[0]
        ray /= np.linalg.norm(ray)
        for tilt in _TILTS_DEG:
            rotation = np.asarray(Rotation.from_euler("xy", tilt, degrees=True).as_matrix())
            for nearer in _NEARER:
                yield Pose(rotation, usual * nearer * ray - rotation @ middle_mm)


def _within(uv: Array, camera: Camera) -> bool:
    margin = _MARGIN * camera.image_size[0]
    return bool(np.all(uv > margin) and np.all(uv < np.array(camera.image_size) - 1 - margin))


def _difference(view: ViewGeometry, taken: Sequence[ViewGeometry]) -> float:
    """How different a view is from the one most like it, in tilt and in distance."""
    turned = min(view.angle_to(other) for other in taken)
    nearer = min(abs(float(np.log(view.distance / other.distance))) for other in taken)
    return _FOR_TILT * min(turned / _ENOUGH_TURNED, 1.0) + _FOR_DISTANCE * min(nearer / _ENOUGH_NEARER, 1.0)
