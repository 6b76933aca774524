"""Advice on what a set of views of the target lacks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.calibrate.camera.coverage import REGIONS, empty_regions, tilt_range
from core.image.targets import TargetNotFound, estimate_pose
from core.image.targets.target_view import TargetView
from core.messages import Message, plural_message
from core.model import Camera, Pose
from core.model.arrays import Array

# What a good series has; the advice of Zhang 2000, §5 (angles to 45°, different directions).
# tests/calibrate/camera/test_capture.py holds them.
GOOD_TILT = float(np.deg2rad(30.0))
"""rad: largest angle between two views."""
GOOD_SECOND_TILT = float(np.deg2rad(12.0))
"""rad: range of tilts about the axis they are smallest about."""
GOOD_DISTANCES = 1.15
"""Ratio of the farthest to the nearest view's distance."""
MOST_SENTENCES = 4
"""Told at a time."""

_USUAL_FOCAL = 1.25
"""Focal length of a camera as most are, in the picture's longer sides."""

_TOP, _MIDDLE, _BOTTOM = REGIONS[1::3]
_PLACES = (
    Message("picture.upper_left_corner", "upper left corner"),
    _TOP,
    Message("picture.upper_right_corner", "upper right corner"),
    Message("picture.left_side", "left side"),
    _MIDDLE,
    Message("picture.right_side", "right side"),
    Message("picture.lower_left_corner", "lower left corner"),
    _BOTTOM,
    Message("picture.lower_right_corner", "lower right corner"),
)
"""What the regions of a picture are called after 'reaches', in the order of `core.calibrate.camera.coverage`."""


@dataclass(frozen=True, slots=True)
class Series:
    """Kind of a series of pictures, and how many are enough.

    Parameters
    ----------
    thing, pictures
        What is shown to the camera, and what its pictures are called.
    enough
        Number of pictures that is enough.
    everywhere
        Whether they should reach all regions of the picture.
    """

    thing: Message
    pictures: Message
    enough: int
    everywhere: bool


CAMERA_VIEWS = Series(Message("target.board", "board"), Message("target.views", "views"), 10, everywhere=True)
PLANE_POSES = Series(Message("target.target", "target"), Message("target.poses", "poses"), 8, everywhere=False)
"""The series of the two calibrations, with the numbers that are advised for them."""


@dataclass(frozen=True, eq=False, slots=True)
class ViewGeometry:
    """Geometry of one view: the target's unit `normal` (3,), its `distance` in mm and its pose."""

    normal: Array
    distance: float
    pose: Pose

    def angle_to(self, other: ViewGeometry) -> float:
        """Compute the angle in rad, 0 to π/2, between the target's planes in this view and in `other`."""
        sine = np.linalg.norm(np.cross(self.normal, other.normal))
        return float(np.arctan2(sine, abs(self.normal @ other.normal)))


def typical_camera(image_size: tuple[int, int]) -> Camera:
    """Make a camera of typical focal length without distortion, to estimate tilts before the true one is known."""
    width, height = image_size
    focal = _USUAL_FOCAL * max(width, height)
    return Camera(
        image_size, np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]]), np.zeros(5)
    )


def view_geometry(view: TargetView, camera: Camera) -> ViewGeometry | None:
    """Estimate normal, distance and pose of the target in `view`; None if no pose explains its points."""
    try:
        pose = estimate_pose(view, camera).pose
    except (TargetNotFound, ValueError):
        return None
    middle = pose.apply(view.points.mean(axis=0)[None])[0]
    return ViewGeometry(pose.rotation[:, 2], float(np.linalg.norm(middle)), pose)


def what_is_missing(
    views: Sequence[TargetView], image_size: tuple[int, int], camera: Camera | None = None
) -> tuple[Message, ...]:
    """Advise in at most four sentences which views to record next; () when there are enough good ones.

    `camera` tells the tilts; without it, a usual one does (they come out right within some degrees).
    """
    camera = camera or typical_camera(image_size)
    return missing_from(views, [view_geometry(view, camera) for view in views], image_size)


def missing_from(
    views: Sequence[TargetView],
    geometries: Sequence[ViewGeometry | None],
    image_size: tuple[int, int],
    series: Series = CAMERA_VIEWS,
) -> tuple[Message, ...]:
    """Advise in at most four sentences what to record next, by the views' known `geometries`; () if enough."""
    wanted = {"enough": series.enough, "pictures": series.pictures}
    if not views:
        return (Message("advice.record_first", "Record at least {enough} {pictures}; there is none.", **wanted),)
    sentences: list[Message] = []
    if len(views) < series.enough:
        sentences.append(
            plural_message(
                "advice.record_more",
                "Record at least {enough} {pictures}; there is {n}.",
                "Record at least {enough} {pictures}; there are {n}.",
                n=len(views),
                **wanted,
            )
        )
    if series.everywhere and (empty := empty_regions(np.concatenate([view.uv for view in views]), image_size, _PLACES)):
        sentences.append(_unreached(empty))
    known = [geometry for geometry in geometries if geometry is not None]
    if len(known) > 1:
        sentences += _on_tilts(known, series)
    return tuple(sentences[:MOST_SENTENCES])


def _on_tilts(geometries: Sequence[ViewGeometry], series: Series) -> list[Message]:
    """Advise on the tilts and distances of the views."""
    largest = tilt_range([geometry.pose for geometry in geometries])
    sentences = []
    named = {"thing": series.thing, "pictures": series.pictures}
    if largest < GOOD_TILT:
        sentences.append(
            Message(
                "advice.tilt_more",
                "Tilt the {thing} more: the largest angle between two {pictures} is {tilt:.0f}°, {good:.0f}° is good.",
                tilt=np.rad2deg(largest),
                good=np.rad2deg(GOOD_TILT),
                **named,
            )
        )
    elif _second_tilt(geometries) < GOOD_SECOND_TILT:
        sentences.append(
            Message(
                "advice.tilt_other_way",
                "Tilt the {thing} the other way too: all {pictures} are tilted about the same axis.",
                **named,
            )
        )
    distances = [geometry.distance for geometry in geometries]
    if max(distances) < GOOD_DISTANCES * min(distances):
        sentences.append(
            Message(
                "advice.vary_distance",
                "Hold the {thing} nearer and farther: the distances of all {pictures} are within {range:.0f} %, "
                "{good:.0f} % is good.",
                range=100 * (max(distances) / min(distances) - 1),
                good=100 * (GOOD_DISTANCES - 1),
                **named,
            )
        )
    return sentences


def _second_tilt(geometries: Sequence[ViewGeometry]) -> float:
    """Range in rad of the tilts in the direction in which they vary least."""
    normals = np.array([geometry.normal * np.sign(geometry.normal[2]) for geometry in geometries])
    slopes = normals[:, :2] / np.maximum(normals[:, 2:], 1e-3)
    least = np.linalg.svd(slopes - slopes.mean(axis=0))[2][1]
    along = slopes @ least
    return float(np.arctan(along.max()) - np.arctan(along.min()))


def _unreached(places: Sequence[Message]) -> Message:
    """Name the regions that no view reaches; of more than three, the first two and the number of the others."""
    if len(places) > 3:
        return Message(
            "advice.reach_many",
            "No view reaches the {first}, the {second} and {n} other parts of the picture.",
            first=places[0],
            second=places[1],
            n=len(places) - 2,
        )
    if len(places) == 3:
        return Message(
            "advice.reach_three",
            "No view reaches the {first}, the {second} and the {third} of the picture.",
            first=places[0],
            second=places[1],
            third=places[2],
        )
    if len(places) == 2:
        return Message(
            "advice.reach_two",
            "No view reaches the {first} and the {second} of the picture.",
            first=places[0],
            second=places[1],
        )
    return Message("advice.reach_one", "No view reaches the {first} of the picture.", first=places[0])
