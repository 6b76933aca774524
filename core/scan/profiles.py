"""Light profiles: what the fan's lines alone measure in one picture, without any sweep."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.image.stripes.centreline import Centreline
from core.model import Camera, Fan
from core.scan.features.extraction import refined
from core.scan.features.reference import FeatureOptions, Picture, read_reference
from core.scan.surface.cloud import FAN, Cloud
from core.scan.surface.triangulate import join, triangulate
from core.scan.sweeps.fan_lines import UNASSIGNED, possible_fan_lines


@dataclass(frozen=True, eq=False, slots=True)
class Profiles:
    """Profiles in one picture of the fan alone: the fan's centrelines, their line numbers, and their points in space.

    `pieces` are the fan's centrelines, averaged along themselves, `line` the number of each (UNASSIGNED where it is not
    known); `cloud` their points, `Cloud.frame` the picture's number, in order along each piece.
    """

    pieces: tuple[Centreline, ...]
    line: tuple[int, ...]
    cloud: Cloud


def read_profiles(
    picture: Picture, frame: int, camera: Camera, fan: Fan, options: FeatureOptions | None = None
) -> Profiles:
    """Extract the fan's lines in a `picture` (H, W) of the fan alone, and triangulate their points on the fan's planes.

    The fan's lines are numbered by their order across the fan; where that leaves a choice, by the depth nearest to
    their neighbours'. A line that is numbered wrongly lies on no face with the others.

    Raises
    ------
    InputError
        If it shows no line.
    """
    pieces = refined(read_reference(picture, options).fan)
    line = possible_fan_lines(pieces, camera, fan)[0].line
    none = np.zeros((3, 3))
    clouds = [
        triangulate(piece, fan.planes[number].pi, none, camera, frame, FAN - number)
        for piece, number in zip(pieces, line, strict=True)
        if number != UNASSIGNED
    ]
    return Profiles(pieces, line, join(clouds))
