"""Which points of a scan a region holds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.inspect.face_region import LARGEST_GAP_MM, inside_polygon
from core.inspect.face_region import Region as Covered
from core.inspect.faces import DRAW_OVER_FACE, face_inside
from core.inspect.features.measured import Scene
from core.inspect.fit.grown_face import FaceKind, GrownFace, grow_face
from core.inspect.fit.plane_search import FEWEST_POINTS
from core.inspect.plan.feature_spec import Auto, FaceAt, Filters, InSphere, PointsOf, Polygon, Region
from core.messages import Message
from core.model.arrays import Array

Indices = NDArray[np.int64]

SEED_PX = 40.0
"""A face goes on from a pixel if a point was measured so near to it: normals look as far for neighbours."""
SEEDS = 4
"""So many of the nearest points are tried: single ones may be strays."""


def points_in(region: Region, filters: Filters, scene: Scene) -> Indices:
    """Select the points of a region whose σ is within the filter's limit; return their indices into the cloud.

    Raises
    ------
    InputError
        If it holds none.
    """
    inside = _inside(region, scene)
    if filters.sigma_max_mm is not None:
        inside = inside & (scene.cloud.sigma <= filters.sigma_max_mm)
    indices = np.flatnonzero(inside)
    if not len(indices):
        raise InputError(
            Message("feature.region_is_empty", "its region holds no measured point"),
            todo=Message("feature.advice_draw_over_scan", "draw it over what the scan covers, or allow a larger σ"),
        )
    return indices


def grown_at(region: FaceAt, scene: Scene, kind: FaceKind | None = None) -> GrownFace:
    """Grow the face that contains the place of `region`, as a shape of the given kind; None: as the simplest that fits.

    Raises
    ------
    InputError
        If there is none, or nothing was measured at that place.
    """
    scene.ensure_normals()
    seen, at, limit = scene.cloud.uv, np.array(region.at_px), SEED_PX
    if region.at_mm is not None:
        seen, at, limit = in_part(scene.cloud.points, scene), np.array(region.at_mm), LARGEST_GAP_MM
    away = np.linalg.norm(seen - at, axis=1)
    if away.min(initial=np.inf) > limit:
        raise InputError(
            Message("feature.nothing_where_clicked", "nothing was measured at the place that was clicked"),
            todo=Message("feature.advice_click_again", "click the face on this scan"),
        )
    nearest = np.argsort(away, kind="stable")[:SEEDS]
    for seed in nearest[:-1]:
        try:
            return grow_face(scene.cloud, int(seed), kind)
        except InputError:
            continue  # a stray point
    return grow_face(scene.cloud, int(nearest[-1]), kind)


def sure_enough(indices: Indices, filters: Filters, scene: Scene) -> Indices:
    """Select those of `indices` whose points have a σ within the filter's limit; return them ascending."""
    allowed = np.inf if filters.sigma_max_mm is None else filters.sigma_max_mm
    return np.sort(indices[scene.cloud.sigma[indices] <= allowed])


def face_in(region: Region, filters: Filters, scene: Scene) -> Indices:
    """Select the points of the plane face in a region, except those near the face's edge; return their indices.

    Raises
    ------
    InputError
        If there is no plane face.
    """
    if isinstance(region, FaceAt):
        grown = grown_at(region, scene, "plane")
        normal = grown.shape.outward(scene.cloud.points[grown.indices[:1]], np.zeros(1, dtype=np.int64))[0]
        inner = Covered.of(scene.cloud.points, grown.indices, normal, filters.margin_mm, smallest_part=0.0)
        face = sure_enough(inner.indices, filters, scene)
        if len(face) < FEWEST_POINTS:
            raise _no_face(len(grown.indices))
        return face
    if isinstance(region, Auto):
        planes = scene.planes(filters.margin_mm)
        if region.number > len(planes):
            raise InputError(
                Message(
                    "feature.no_face_of_number",
                    "the scan shows {n} plane faces, so there is none of number {number}",
                    n=len(planes),
                    number=region.number,
                ),
                todo=Message("feature.advice_draw_on_face", "draw a region on the face"),
            )
        return sure_enough(planes[region.number - 1].region.indices, filters, scene)
    indices = points_in(region, filters, scene)
    if isinstance(region, PointsOf):
        return indices
    scene.ensure_normals()
    inside = np.zeros(len(scene.cloud), dtype=np.bool_)
    inside[indices] = True
    face = face_inside(scene.cloud, inside, margin_mm=filters.margin_mm)
    if len(face) < FEWEST_POINTS:
        raise _no_face(len(indices))
    return np.sort(face)


def _no_face(count: int) -> InputError:
    return InputError(
        Message("feature.region_holds_no_face", "its region holds {n} measured points but no plane face", n=count),
        todo=DRAW_OVER_FACE,
    )


def in_part(points: Array, scene: Scene) -> Array:
    """Transform points (N, 3) in mm from the camera frame into part coordinates; unchanged if there are none."""
    return points if scene.pose_camera_part is None else scene.pose_camera_part.inverse().apply(points)


def _inside(region: Region, scene: Scene) -> NDArray[np.bool_]:
    cloud = scene.cloud
    if isinstance(region, Auto):
        return np.ones(len(cloud), dtype=np.bool_)
    if isinstance(region, Polygon):
        return inside_polygon(cloud.uv, np.array(region.corners_px, dtype=np.float64))
    if isinstance(region, PointsOf | FaceAt):
        of = scene.found[region.feature] if isinstance(region, PointsOf) else grown_at(region, scene)
        inside = np.zeros(len(scene.cloud), dtype=np.bool_)
        inside[of.indices] = True
        return inside
    points = in_part(cloud.points, scene)
    if isinstance(region, InSphere):
        return np.asarray(np.linalg.norm(points - np.array(region.centre_mm), axis=1) <= region.radius_mm)
    return np.asarray(np.all((points >= region.low_mm) & (points <= region.high_mm), axis=1))
