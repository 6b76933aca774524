"""One call for every kind of target."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from core.image.targets.black_square import detect_black_square
from core.image.targets.charuco import detect_charuco
from core.image.targets.checkerboard import detect_checkerboard
from core.image.targets.circle_grid import detect_circle_grid
from core.image.targets.kinds import BlackSquare, Charuco, Checkerboard, CircleGrid, Rectangle, Target
from core.image.targets.picture import Picture, check_exposure, only_within
from core.image.targets.rectangle import detect_rectangle
from core.image.targets.target_view import TargetView
from core.model import Camera


def detect(
    target: Target,
    picture: Picture,
    name: str = "",
    camera: Camera | None = None,
    *,
    thorough: bool = True,
    plane_only: bool = False,
    region_px: ArrayLike | None = None,
) -> TargetView:
    """Find the points of `target` in `picture` (H, W) to sub-pixel; TargetNotFound if it is not seen.

    Parameters
    ----------
    picture
        (H, W) grey levels, uint8 or uint16.
    name
        The picture's name, for messages.
    camera
        If given, the black square's edges are fitted as straight lines in undistorted rays and the circles' perspective
        is taken from the rays; without it, in pixels (good only while distortion bends an edge by less than the noise).
    thorough
        Whether to take a second or more over a checkerboard that is hard to find: not for live pictures.
    plane_only
        Whether the target's plane is enough: any part of a checkerboard will do then that has one pose before `camera`.
    region_px
        Polygon (K, 2) in px within which alone the target is looked for; None: everywhere.

    Raises
    ------
    TargetNotFound
        If the picture does not show the whole target (ChArUco: at least six corners, not all in one line; checkerboard:
        a part whose corners are known by the ends it shows); the sentence tells no target at all, a target of another
        size, a part of one, and an empty picture from each other. If `region_px` lies outside of the picture.
    ValueError
        If the picture is not 2-D uint8 or uint16.
    """
    check_exposure(picture, name)
    if region_px is not None:
        picture = only_within(picture, np.asarray(region_px, dtype=np.float64), name)
    match target:
        case Checkerboard():
            view = detect_checkerboard(target, picture, name, camera if plane_only else None, thorough=thorough)
        case Charuco():
            view = detect_charuco(target, picture, name)
        case CircleGrid():
            view = detect_circle_grid(target, picture, name, camera)
        case BlackSquare():
            view = detect_black_square(target, picture, name, camera)
        case Rectangle():
            view = detect_rectangle(target, picture, name, camera)
    return replace(view, target=target)
