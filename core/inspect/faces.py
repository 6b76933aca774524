"""The two parallel faces of a part, found in the cloud or given as polygons in the picture.

Of all pairs of parallel planes (`core.inspect.fit.plane_search`) the pair whose smaller face is largest wins. Where
others are of like size (two parts on a table, a part with a step), the one nearest to the nominal thickness does, and
all of them are kept: only a person knows which one was meant.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import InputError, OwnCause
from core.inspect.face_region import inside_polygon, region_on
from core.inspect.fit.plane_search import (
    FEWEST_POINTS,
    POINT_CLOUD,
    FoundPlane,
    find_planes,
    largest_plane,
    points_on,
    search_tolerance,
)
from core.inspect.results import Corners, PairCandidate
from core.inspect.shown.outline import outline_px
from core.messages import Field, Message, plural_message
from core.progress import Progress, silent
from core.scan.surface.cloud import FAN, Cloud

DRAW_OVER_FACE = Message("feature.advice_draw_over_face", "draw it over a face that the scan covers")


_REGION_FIELDS = {
    "upper": Message("gauge.where_upper_region", "[gauge] upper_polygon_px"),
    "lower": Message("gauge.where_lower_region", "[gauge] lower_polygon_px"),
}


def region_field(face: str) -> Message:
    """Return the name of the rig.toml field that holds the polygon of a face, "upper" or "lower"."""
    return _REGION_FIELDS[face]


SMALLEST_MM2 = 60.0
"""A face found by itself is at least this large inside its margin."""
SAME_FACE = 0.5
"""Two polygons hold one face if they share more than this part of the points of the smaller one."""
PARALLEL = np.radians(2.0)
"""Faces are parallel within this angle; larger angles are another feature, not a worse gauge block."""
ASKEW = np.radians(20.0)
"""Faces that should be parallel lie against each other by less: a part on a burr, a chip or its edge, no side of it."""
ONE_PLANE = 0.98
"""Share of the fan's own points on the only face from which on no other is in view: they need no sweep to be known."""


LIKE_SIZE = 0.25
"""Pairs whose smaller face has this share of the largest one's area could as well be meant."""


class OneFace(OwnCause):
    """Error that only one face is in view: the fan's own points of the cloud lie on no other."""


@dataclass(frozen=True, eq=False, slots=True)
class FacePair:
    """Indices into the cloud of the points on the face nearer to the camera and on the other.

    `candidates` are all pairs that could be meant, this one first, where it was chosen among several by itself.
    """

    upper: NDArray[np.int64]
    lower: NDArray[np.int64]
    candidates: tuple[PairCandidate, ...] = ()


def find_faces(
    cloud: Cloud,
    *,
    margin_mm: float = 1.5,
    nominal_mm: float | None = None,
    beside: NDArray[np.bool_] | None = None,
    seed: int = 0,
    progress: Progress = silent,
) -> FacePair:
    """Find the two largest parallel faces of a cloud; of pairs of similar size, the one nearest to `nominal_mm` apart.

    Parameters
    ----------
    cloud
        Normals are estimated when it has none.
    margin_mm
        Points nearer than this to the edge of their face are left out: stripes are biased there.
    nominal_mm
        Thickness of the pair that is meant; None: the largest is taken.
    beside
        (N,) which points lie on boards beside the part: a pair with such a face counts only where there is no other.
    seed
        Of the random search; the same seed gives the same faces.
    progress
        Called with how far it is.

    Raises
    ------
    InputError
        If there are no two parallel faces.
    """
    planes = find_planes(cloud, margin_mm=margin_mm, seed=seed, progress=progress)
    large = [
        plane
        for plane in planes
        if plane.region.area_mm2 >= SMALLEST_MM2 and len(plane.region.indices) >= FEWEST_POINTS
    ]
    tolerance = search_tolerance(cloud)
    pairs = [
        (a, b)
        for a, b in combinations(large, 2)
        if abs(a.normal @ b.normal) > np.cos(PARALLEL) and abs(a.distance - b.distance) > 2 * tolerance
    ]
    if not pairs:
        raise _no_pair(cloud, large, tolerance)
    if beside is not None:
        pairs = [pair for pair in pairs if not any(_mostly(beside, plane) for plane in pair)] or pairs
    pairs.sort(key=lambda pair: sorted(plane.region.area_mm2 for plane in pair), reverse=True)
    least = LIKE_SIZE * min(plane.region.area_mm2 for plane in pairs[0])
    found = [_Pair.of(cloud, *pair) for pair in pairs if min(plane.region.area_mm2 for plane in pair) >= least]
    alike = [found[0], *(one for one in found[1:] if one.candidate.thickness_mm > 2 * tolerance)]
    if nominal_mm is not None:
        alike.sort(key=lambda one: abs(one.candidate.thickness_mm - nominal_mm))
    candidates = tuple(one.outlined(cloud) for one in alike) if len(alike) > 1 else ()
    return FacePair(alike[0].upper.region.indices, alike[0].lower.region.indices, candidates)


def _mostly(flags: NDArray[np.bool_], plane: FoundPlane) -> bool:
    """Whether most points of a face are flagged."""
    return bool(np.mean(flags[plane.region.indices]) > 0.5)


def _no_pair(cloud: Cloud, faces: list[FoundPlane], tolerance: float) -> InputError:
    """Why no two of the `faces` are parallel: there is but one, the largest two near it lie askew, or none of both."""
    if len(faces) < 2:
        own = cloud.points[cloud.sweep <= FAN]
        on = [np.abs(own @ face.normal - face.distance) < 2 * tolerance for face in faces if len(own)]
        kind = OneFace if on and np.mean(on) > ONE_PLANE else InputError
        return kind(
            plural_message(
                "gauge.too_few_faces",
                "only {n} plane face is in view, so there is no thickness to measure",
                "{n} plane faces are in view, so there is no thickness to measure",
                n=len(faces),
            ),
            where=POINT_CLOUD,
            todo=Message(
                "gauge.advice_both_in_view",
                "let the fan and the sweeps cross both faces, the part and the table beside it: a part that fills the "
                "picture needs a rig farther away",
            ),
        )
    askew = [(a, b) for a, b in combinations(faces, 2) if PARALLEL <= _angle(a, b) < ASKEW]
    if askew:
        pair = max(askew, key=lambda pair: min(plane.region.area_mm2 for plane in pair))
        return OwnCause(
            Message(
                "gauge.faces_askew",
                "the upper face lies {deg:.1f}° against the table or the face below, and only faces within {most:.0f}° "
                "of parallel have a thickness",
                deg=np.degrees(_angle(*pair)),
                most=np.degrees(PARALLEL),
            ),
            where=POINT_CLOUD,
            todo=Message(
                "gauge.advice_lay_flat",
                "lay the part flat, without chips or burrs under it, and scan again; if it lies flat as it is, take "
                "check pictures of the plane target: a rig that changed slants faces, too; a part that is so gets a "
                "feature for the angle",
            ),
        )
    return InputError(
        Message(
            "gauge.no_parallel_faces",
            "among {n} plane faces no two are parallel, so there is no thickness to measure",
            n=len(faces),
        ),
        where=POINT_CLOUD,
        todo=Message(
            "gauge.advice_outline_faces",
            "scan both faces, or outline them as [gauge] upper_polygon_px and {lower}",
            lower=Field("gauge.lower_polygon_px"),
        ),
    )


def _angle(one: FoundPlane, other: FoundPlane) -> float:
    """Angle in rad between two planes."""
    return float(np.arccos(min(abs(float(one.normal @ other.normal)), 1.0)))


@dataclass(frozen=True, eq=False, slots=True)
class _Pair:
    """Two parallel planes, the one nearer to the camera first."""

    upper: FoundPlane
    lower: FoundPlane
    candidate: PairCandidate

    @classmethod
    def of(cls, cloud: Cloud, one: FoundPlane, other: FoundPlane) -> _Pair:
        upper, lower = sorted((one, other), key=lambda plane: plane.distance)
        places = [cloud.uv[plane.region.indices].mean(axis=0) for plane in (upper, lower)]
        amid = cloud.points[upper.region.indices].mean(axis=0)
        candidate = PairCandidate(
            abs(float(lower.distance - lower.normal @ amid)),
            (len(upper.region.indices), len(lower.region.indices)),
            (float(places[0][0]), float(places[0][1])),
            (float(places[1][0]), float(places[1][1])),
        )
        return cls(upper, lower, candidate)

    def outlined(self, cloud: Cloud) -> PairCandidate:
        """The candidate with the outlines of its faces."""
        upper, lower = (_corners(cloud, plane) for plane in (self.upper, self.lower))
        return replace(self.candidate, outlines_px=(upper, lower))


def _corners(cloud: Cloud, plane: FoundPlane) -> Corners:
    """The outline of a face in the picture, to a tenth of a pixel; none where its points lie on one line there."""
    try:
        outline = outline_px(cloud.uv[plane.region.indices])
    except InputError:
        return ()
    return tuple((round(float(u), 1), round(float(v), 1)) for u, v in outline)


def faces_in_polygons(
    cloud: Cloud,
    upper_polygon_px: ArrayLike,
    lower_polygon_px: ArrayLike,
    *,
    margin_mm: float = 1.5,
) -> FacePair:
    """Find the upper and the lower face: the largest plane inside each of two polygons (n ≥ 3, 2) in pixels.

    A polygon may reach over the edge of its face: the margin is taken from the face's own edge, not from the polygon's.

    Raises
    ------
    InputError
        If a polygon has fewer than 3 corners or holds no plane face, naming it, or both hold the same one.
    """
    chosen = []
    for face, polygon in (("upper", upper_polygon_px), ("lower", lower_polygon_px)):
        corners = np.asarray(polygon, dtype=np.float64)
        if corners.ndim != 2 or corners.shape[1:] != (2,) or len(corners) < 3 or not np.isfinite(corners).all():
            raise InputError(
                Message("gauge.polygon_corners", "a region needs at least three corners [u, v]"),
                where=region_field(face),
            )
        inside = inside_polygon(cloud.uv, corners)
        indices = face_inside(cloud, inside, margin_mm=margin_mm)
        if len(indices) < FEWEST_POINTS:
            raise InputError(
                Message(
                    "gauge.polygon_holds_no_face",
                    "the region holds {n} measured points but no plane face",
                    n=inside.sum(),
                ),
                where=region_field(face),
                todo=DRAW_OVER_FACE,
            )
        chosen.append(indices)
    if len(np.intersect1d(chosen[0], chosen[1])) > SAME_FACE * min(map(len, chosen)):
        raise InputError(
            Message("gauge.one_face_twice", "both regions hold one and the same face"),
            where=region_field("upper"),
            todo=Message("gauge.advice_two_faces", "draw each of them over a face of its own"),
        )
    return FacePair(chosen[0], chosen[1])


def face_inside(cloud: Cloud, inside: NDArray[np.bool_], *, margin_mm: float = 1.5) -> NDArray[np.int64]:
    """Find the largest plane among the points marked in `inside` (N,); return their indices, less a margin."""
    part = cloud.select(inside)
    tolerance = search_tolerance(part)
    plane = largest_plane(part, tolerance, 0.0, seed=0)
    if plane is None:
        return np.empty(0, dtype=np.int64)
    near = points_on(cloud, plane, tolerance)
    face = region_on(cloud, near, plane.normal, margin_mm, smallest_part=0.0)
    return face.indices[inside[face.indices]]
