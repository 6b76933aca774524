"""The geometry that inspection.json and the points beside it hold, for CAD."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from pydantic import Field

from core.errors import InputError
from core.files.complaints import checked
from core.files.reading import read_json
from core.files.results.inspection_file import AGAIN, read_inspection
from core.files.tables import Finite, ResultFile, Row3
from core.inspect.geometry import Geometry, Shape, SphereShape, curves, cylinder, moved, outlines
from core.inspect.shown.view_frame import ViewFrame
from core.messages import Message
from core.model import Pose
from core.model.arrays import Array


class _Shape(ResultFile):
    """Planes have a normal and centres, spheres and cylinders a centre and a radius, cylinders a direction, too."""

    normal: Row3 | None = None
    centres: list[Row3] = Field(default_factory=list)
    centre: Row3 | None = None
    direction: Row3 | None = None
    radius_mm: Finite | None = Field(default=None, gt=0)


class _Section(ResultFile):
    origin_mm: Row3
    along: Row3
    up: Row3
    step_mm: Finite = Field(gt=0)


class _Feature(ResultFile):
    name: str
    shape: _Shape | None = None
    section: _Section | None = None


class _Pose(ResultFile):
    rotation: list[Row3] = Field(min_length=3, max_length=3)
    translation_mm: Row3

    def pose(self) -> Pose:
        return Pose(np.array(self.rotation), np.array(self.translation_mm))


class _GeometryFile(ResultFile):
    features: list[_Feature] = Field(default_factory=list)
    pose_camera_part: _Pose | None = None


def read_geometry(inspection: Path, points: Array, frame: ViewFrame) -> Geometry:
    """Read the features in `inspection`, inspection.json, as geometry to draw, in `frame`; InputError if that fails.

    Parameters
    ----------
    inspection
        inspection.json.
    points
        (N, 3) of the cloud it was made from, in the camera frame.
    frame
        That it is given in.

    Raises
    ------
    InputError
        If it is missing or damaged, of another cloud, of an older version where it has a section, or holds nothing
        that could be drawn.
    """
    file = read_inspection(inspection)
    tables = checked(_GeometryFile, read_json(inspection), inspection)
    if any(len(used) and not 0 <= used.min() <= used.max() < len(points) for used in file.points.values()):
        raise InputError(
            Message("file.other_cloud", "is of another scan than the cloud beside it"), where=inspection, todo=AGAIN
        )
    drawn: list[Shape] = []
    for one in tables.features:
        used = points[file.points.get(one.name, np.zeros(0, dtype=np.int64))]
        if one.shape is not None and len(used):
            drawn += _shape(one.name, one.shape, used)
        if one.name in file.sections:
            if one.section is None:
                raise InputError(
                    Message("file.section_without_place", "does not say where the section {name} lies", name=one.name),
                    where=inspection,
                    todo=AGAIN,
                )
            at = one.section
            axes = np.array([at.along, at.up])
            drawn += curves(one.name, np.array(at.origin_mm), axes, file.sections[one.name], at.step_mm)
    if not drawn:
        raise InputError(
            Message("file.nothing_to_draw", "holds no plane, sphere, cylinder or section that could be drawn"),
            where=inspection,
        )
    return Geometry(tuple(moved(drawn, frame.pose_camera_frame.inverse())), frame.kind)


def read_part_frame(inspection: Path) -> Pose | None:
    """Read the pose of the part frame in the camera frame from inspection.json; None if there is no file or no pose.

    Raises
    ------
    InputError
        If it is damaged.
    """
    if not inspection.is_file():
        return None
    found = checked(_GeometryFile, read_json(inspection, todo=AGAIN), inspection).pose_camera_part
    return None if found is None else found.pose()


def _shape(name: str, shape: _Shape, used: Array) -> list[Shape]:
    if shape.normal is not None and shape.centres:
        return [*outlines(name, np.array(shape.normal), np.array(shape.centres), used)]
    if shape.centre is None or shape.radius_mm is None:
        return []
    if shape.direction is None:
        return [SphereShape(name, np.array(shape.centre), shape.radius_mm)]
    return [cylinder(name, np.array(shape.centre), np.array(shape.direction), shape.radius_mm, used)]
