"""What a set of views of the target lacks, in words a technician can act on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.calibrate.coverage import empty_regions, tilt_range
from core.image.target_view import TargetView
from core.image.targets import TargetNotFound, estimate_pose
from core.model import Camera, Pose
from core.model.arrays import Array

GOOD_TILT = float(np.deg2rad(30.0))
GOOD_SECOND_TILT = float(np.deg2rad(12.0))
"""Range of tilts about the axis they are smallest about."""
GOOD_DISTANCES = 1.15
"""Ratio of the farthest to the nearest view's distance."""
MOST_SENTENCES = 4

_USUAL_FOCAL = 1.25  # of the picture's longer side

_PLACES = {
    "upper left": "upper left corner",
    "top": "top",
    "upper right": "upper right corner",
    "left": "left side",
    "middle": "middle",
    "right": "right side",
    "lower left": "lower left corner",
    "bottom": "bottom",
    "lower right": "lower right corner",
}


@dataclass(frozen=True, slots=True)
class Series:
    """What is being recorded: a `thing` shown in `enough` many `pictures`, which should reach `everywhere` or not."""

    thing: str
    pictures: str
    enough: int
    everywhere: bool


CAMERA_VIEWS = Series("board", "views", 10, everywhere=True)
PLANE_POSES = Series("target", "poses", 8, everywhere=False)


@dataclass(frozen=True, eq=False, slots=True)
class ViewGeometry:
    """How the target stands in one view: its unit `normal` (3,), and its `distance` in mm."""

    normal: Array
    distance: float
    pose: Pose

    def angle_to(self, other: ViewGeometry) -> float:
        """Angle in rad between the planes of two views, 0 to π/2."""
        sine = np.linalg.norm(np.cross(self.normal, other.normal))
        return float(np.arctan2(sine, abs(self.normal @ other.normal)))


def stand_in_camera(image_size: tuple[int, int]) -> Camera:
    """A camera as most are, to tell tilts by as long as the true one is not known."""
    width, height = image_size
    focal = _USUAL_FOCAL * max(width, height)
    return Camera(
        image_size, np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]]), np.zeros(5)
    )


def view_geometry(view: TargetView, camera: Camera) -> ViewGeometry | None:
    """How the target stands in `view`, or None if no pose explains it."""
    try:
        pose = estimate_pose(view, camera).pose
    except (TargetNotFound, ValueError):
        return None
    middle = pose.apply(view.points.mean(axis=0)[None])[0]
    return ViewGeometry(pose.rotation[:, 2], float(np.linalg.norm(middle)), pose)


def what_is_missing(
    views: Sequence[TargetView], image_size: tuple[int, int], camera: Camera | None = None
) -> tuple[str, ...]:
    """At most four sentences on what to record next; none when there are enough good views.

    `camera` tells the tilts; without it, a usual one does (they come out right within some degrees).
    """
    camera = camera or stand_in_camera(image_size)
    return missing_from(views, [view_geometry(view, camera) for view in views], image_size)


def missing_from(
    views: Sequence[TargetView],
    geometries: Sequence[ViewGeometry | None],
    image_size: tuple[int, int],
    series: Series = CAMERA_VIEWS,
) -> tuple[str, ...]:
    """The same, with what is known already of how the target stands in each view."""
    if not views:
        return (f"Record at least {series.enough} {series.pictures}; there is none.",)
    sentences: list[str] = []
    if len(views) < series.enough:
        there = f"there is {len(views)}" if len(views) == 1 else f"there are {len(views)}"
        sentences.append(f"Record at least {series.enough} {series.pictures}; {there}.")
    empty = empty_regions(np.concatenate([view.uv for view in views]), image_size) if series.everywhere else []
    if empty:
        sentences.append(f"No view reaches the {_listed([_PLACES[name] for name in empty])} of the picture.")
    known = [geometry for geometry in geometries if geometry is not None]
    if len(known) > 1:
        sentences += _on_tilts(known, series)
    return tuple(sentences[:MOST_SENTENCES])


def _on_tilts(geometries: Sequence[ViewGeometry], series: Series) -> list[str]:
    largest = tilt_range([geometry.pose for geometry in geometries])
    sentences = []
    if largest < GOOD_TILT:
        sentences.append(
            f"Tilt the {series.thing} more: the largest angle between two {series.pictures} is "
            f"{np.rad2deg(largest):.0f}°, {np.rad2deg(GOOD_TILT):.0f}° is good."
        )
    elif _second_tilt(geometries) < GOOD_SECOND_TILT:
        sentences.append(
            f"Tilt the {series.thing} the other way too: all {series.pictures} are tilted about the same axis."
        )
    distances = [geometry.distance for geometry in geometries]
    if max(distances) < GOOD_DISTANCES * min(distances):
        sentences.append(
            f"Hold the {series.thing} nearer and farther: the distances of all {series.pictures} are within "
            f"{100 * (max(distances) / min(distances) - 1):.0f} %, {100 * (GOOD_DISTANCES - 1):.0f} % is good."
        )
    return sentences


def _second_tilt(geometries: Sequence[ViewGeometry]) -> float:
    """Range in rad of the tilts in the direction in which they vary least."""
    normals = np.array([geometry.normal * np.sign(geometry.normal[2]) for geometry in geometries])
    slopes = normals[:, :2] / np.maximum(normals[:, 2:], 1e-3)
    least = np.linalg.svd(slopes - slopes.mean(axis=0))[2][1]
    along = slopes @ least
    return float(np.arctan(along.max()) - np.arctan(along.min()))


def _listed(names: Sequence[str]) -> str:
    """One sentence's worth of names; of more than three, the first two and how many others."""
    if len(names) > 3:
        return f"{names[0]}, the {names[1]} and {len(names) - 2} other parts"
    return names[0] if len(names) == 1 else f"{', the '.join(names[:-1])} and the {names[-1]}"
