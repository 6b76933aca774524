"""The face that goes on from one point: grown over the surface from there, as a plane, a sphere or a cylinder.

The start is the plane that explains most of the points around. In each round the face is fitted again to the points
that lie on it, are connected with the one clicked, and are no farther from it than twice as far as before: a fit is
never trusted far outside of what it rests on. A plane whose residuals follow a curved surface is none, and one of few
points may be none; the paraboloid through them says where a sphere and a cylinder start. The simplest of the three that
the points allow is taken.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.inspect.face_region import connected_with
from core.inspect.fit.plane_fit import LINE_LIKE
from core.inspect.fit.plane_search import FEWEST_POINTS, LIKE_NORMALS
from core.inspect.fit.round import CYLINDER_RADII_MM, SPHERE_RADII_MM
from core.inspect.fit.shapes import Cylinder, ParallelPlanes, Shape, Sphere, nearest_to
from core.messages import Message
from core.model.arrays import Array
from core.model.directions import square_to
from core.scan.surface.cloud import Cloud

FaceKind: TypeAlias = Literal["plane", "sphere", "cylinder"]
"""Of a face, by the names of the kinds of features that measure it."""
KINDS: tuple[FaceKind, ...] = ("plane", "sphere", "cylinder")

SIGMAS, LEAST_MM = 5.0, 0.1
"""A point belongs to a face within so many of its σ, added in squares to what a face's form may be."""
ELSEWHERE = 4.0
"""Points farther off than so many times that are of something else: gaps in which they lie are not bridged."""
NEIGHBOURS = 150
"""Points about the seed that decide the start, or more:"""
START_MM = 3.0
"""they reach so far at least."""
HYPOTHESES = 100
"""So many of their normals are tried, and planes through the seed and two of them."""
ROUNDS = 12
"""Of fits: from 6 mm on, doubled in each, the reach grows to 12 m."""
BOWED = 0.5
"""A plane is none if a curved surface explains more than this share of its residuals' variance; light planes that err,
each by itself, leave a bow of a fifth at most."""
MORE = 1.2
"""A sphere or cylinder holds so many times the points of the strip of it that lies in a plane, at least."""
SPHERE_ENOUGH = 0.9
"""A sphere is taken if it holds this share of the points that the cylinder does: it has a parameter less."""

FLATTEST = 1e-4
"""In 1/mm: a radius of 10 m, far above all that is looked for."""


@dataclass(frozen=True, eq=False, slots=True)
class GrownFace:
    """Face grown from a point: its shape and the points on it.

    Parameters
    ----------
    kind
        What it is.
    indices
        (n,) into the cloud, ascending.
    shape
        About where it lies in the camera frame, by plain least squares.
    rms_mm
        Root mean square of the distances from it.
    """

    kind: FaceKind
    indices: NDArray[np.int64]
    shape: Shape
    rms_mm: float


def grow_face(cloud: Cloud, seed: int, kind: FaceKind | None = None) -> GrownFace:
    """Grow the face around the point with the index `seed`, as a plane, sphere or cylinder; None: the simplest.

    Parameters
    ----------
    cloud
        With normals.
    seed
        Index of a point amid the face; near its edge the larger of the faces that meet there is taken.
    kind
        What the face is; None: the simplest that the points allow.

    Raises
    ------
    InputError
        If no face goes on from there, or none of that kind.
    """
    around = _around(cloud, seed)
    start = _start(cloud, seed, around)
    plane = None if start is None else _grown(cloud, seed, "plane", start, 2 * START_MM)
    if start is None or kind == "plane":
        if plane is None:
            raise _refused("plane")
        return plane
    if plane is None or len(plane.indices) < NEIGHBOURS:
        strip, bend = around, _Bend.of(cloud.points[around], start)
    else:
        strip, bend = plane.indices, _Bend.of(cloud.points[plane.indices], plane.shape)
        if kind is None and bend.explains < BOWED:
            return plane
    reach = float(np.linalg.norm(cloud.points[strip] - cloud.points[seed], axis=1).max())

    def tried(name: FaceKind, shape: Shape | None) -> GrownFace | None:
        return None if shape is None or kind not in (None, name) else _grown(cloud, seed, name, shape, reach)

    round_ = tried("sphere", bend.sphere), tried("cylinder", bend.cylinder)
    found = _simplest(plane if kind is None else None, [face for face in round_ if face is not None])
    if found is None:
        raise _refused(kind or "plane")
    return found


def _refused(kind: FaceKind) -> InputError:
    what = {
        "plane": Message("feature.no_face_grows", "no face goes on from the place that was clicked"),
        "sphere": Message("feature.no_sphere_grows", "the surface at the place that was clicked is no sphere"),
        "cylinder": Message("feature.no_cylinder_grows", "the surface at the place that was clicked is no cylinder"),
    }
    return InputError(what[kind], todo=Message("feature.advice_click_amid_face", "click amid a face, or draw a region"))


def _simplest(plane: GrownFace | None, round_: list[GrownFace]) -> GrownFace | None:
    """Of a plane and what it may be a strip of, fewest parameters first, the first that holds the points."""
    most = max((len(face.indices) for face in round_), default=0)
    if plane is not None and most < MORE * len(plane.indices):
        return plane
    return next((face for face in round_ if len(face.indices) >= SPHERE_ENOUGH * most), None)


def _around(cloud: Cloud, seed: int) -> NDArray[np.int64]:
    """The points about the seed, and as many more whose normals are known."""
    away = np.linalg.norm(cloud.points - cloud.points[seed], axis=1)
    known = np.flatnonzero(cloud.normals.any(axis=1))
    return np.union1d(_nearest(away, np.arange(len(away))), _nearest(away, known))


def _nearest(away: Array, of: NDArray[np.int64]) -> NDArray[np.int64]:
    """Those `of` the points that are the nearest NEIGHBOURS, or within START_MM."""
    if not len(of):
        return of
    last = min(NEIGHBOURS, len(of)) - 1
    return of[away[of] <= max(START_MM, float(np.partition(away[of], last)[last]))]


def _start(cloud: Cloud, seed: int, around: NDArray[np.int64]) -> ParallelPlanes | None:
    """The plane by the seed that explains most of the points around: with the normal of one, or through two of them.

    Normals fail where few stripes cross a narrow face, and planes through points where there is but one stripe.
    """
    apart, normals = cloud.points[around] - cloud.points[seed], cloud.normals[around]
    known = np.asarray(normals.any(axis=1))
    a, b = np.random.default_rng(0).integers(len(around), size=(2, HYPOTHESES))
    through = np.cross(apart[a], apart[b])
    size = np.linalg.norm(through, axis=1)
    sound = size > 0.2 * np.linalg.norm(apart[a], axis=1) * np.linalg.norm(apart[b], axis=1)  # not nearly on one line
    through = through[sound] / size[sound, None]
    through *= np.where(through @ cloud.points[seed] > 0, -1.0, 1.0)[:, None]  # towards the camera
    tried = np.vstack([normals[known][:: max(1, int(known.sum()) // HYPOTHESES)], through])
    off = apart @ tried.T
    like: NDArray[np.bool_] = (normals @ tried.T > LIKE_NORMALS) | ~known[:, None]
    like &= np.abs(off) <= 2 * _tolerance(cloud)[around, None]  # the seed errs, too
    if not like.any():
        return None
    best = int(np.argmax(like.sum(axis=0)))
    shift = float(np.median(off[like[:, best], best]))
    return ParallelPlanes.through(tried[best], cloud.points[seed] + shift * tried[best])


def _grown(cloud: Cloud, seed: int, kind: FaceKind, shape: Shape, reach: float) -> GrownFace | None:
    """The face of this kind, from a start that is good within `reach` mm of the seed.

    None if too few points are on it, or the seed is not: it is a stray point, or the fit went astray.
    """
    away = np.linalg.norm(cloud.points - cloud.points[seed], axis=1)
    tolerance = _tolerance(cloud)
    face: GrownFace | None = None
    for _ in range(ROUNDS):
        on = _on(cloud, seed, shape, np.flatnonzero(away <= reach))
        fitted = _fitted(shape, cloud.points[on]) if len(on) >= FEWEST_POINTS else None
        if fitted is None or _rms(fitted, cloud.points[on]) > tolerance[on].max():
            break  # a fit that went astray: the last good one counts
        settled = face is not None and reach > away.max() and np.array_equal(on, face.indices)
        shape, face = fitted, GrownFace(kind, on, fitted, _rms(fitted, cloud.points[on]))
        if settled:
            break
        reach *= 2
    held = face is not None and _rms(face.shape, cloud.points[[seed]]) <= 2 * tolerance[seed]
    return face if held else None


def _rms(shape: Shape, points: Array) -> float:
    """Root mean square of the distances of points (n, 3) from a shape, in mm."""
    return float(np.sqrt(np.mean(shape.misfit(points, np.zeros(len(points), dtype=np.int64)) ** 2)))


def _on(cloud: Cloud, seed: int, shape: Shape, near: NDArray[np.int64]) -> NDArray[np.int64]:
    """Those of the points `near` that lie on a shape and are connected with the seed."""
    points, normals, part = cloud.points[near], cloud.normals[near], np.zeros(len(near), dtype=np.int64)
    outward, tolerance = shape.outward(points, part), _tolerance(cloud)[near]
    facing, known = (normals * outward).sum(axis=1), normals.any(axis=1)
    misfit = np.abs(shape.misfit(points, part))
    side = 1.0 if facing[misfit <= tolerance].sum() >= 0 else -1.0  # a shaft, or a bore
    on = (misfit <= tolerance) & ((side * facing > LIKE_NORMALS) | ~known)
    if not on.any():
        return near[:0]
    middle = outward[on].mean(axis=0)
    return connected_with(cloud.points, near[on], near[misfit > ELSEWHERE * tolerance], middle, cloud.points[seed])


def _fitted(shape: Shape, points: Array) -> Shape | None:
    """The shape of least squares, its place amid the points; None if its radius is none that is looked for."""
    part, middle = np.zeros(len(points), dtype=np.int64), points.mean(axis=0)
    match shape:
        case ParallelPlanes():
            plane = nearest_to(shape, points, part, least=LINE_LIKE)
            off = float(plane.misfit(middle[None], part[:1])[0])
            return replace(plane, centres=(middle - off * plane.outward_normal)[None])
        case Cylinder():
            tube = nearest_to(shape, points, part)
            if not CYLINDER_RADII_MM[0] <= tube.radius <= CYLINDER_RADII_MM[1]:
                return None
            return replace(tube, centre=tube.centre + tube.direction * (tube.direction @ (middle - tube.centre)))
        case Sphere():
            ball = nearest_to(shape, points, part)
            return ball if SPHERE_RADII_MM[0] <= ball.radius <= SPHERE_RADII_MM[1] else None
    raise TypeError(f"{shape} does not grow")


def _tolerance(cloud: Cloud) -> Array:
    """(N,) mm within which each point belongs to a face."""
    return np.hypot(SIGMAS * cloud.sigma, LEAST_MM)


@dataclass(frozen=True, eq=False, slots=True)
class _Bend:
    """The paraboloid through points about a plane.

    Parameters
    ----------
    explains
        Share of the variance of their heights.
    sphere, cylinder
        Of its curvature; None where it has none.
    """

    explains: float
    sphere: Sphere | None
    cylinder: Cylinder | None

    @classmethod
    def of(cls, points: Array, plane: Shape) -> _Bend:
        """Of `points` (n, 3) and the plane."""
        assert isinstance(plane, ParallelPlanes)
        height = plane.misfit(points, np.zeros(len(points), dtype=np.int64))
        axes = square_to(plane.outward_normal)
        flat = (points - plane.centres[0]) @ axes
        x, y = flat.T / (size := float(np.abs(flat).max()))
        design = np.column_stack([np.ones(len(x)), x, y, x**2 / 2, x * y, y**2 / 2])
        solved = np.linalg.lstsq(design, height, rcond=None)[0]
        explains = 1 - float(np.var(height - design @ solved) / max(float(np.var(height)), 1e-12))
        curvature, ways = np.linalg.eigh(solved[[3, 4, 4, 5]].reshape(2, 2) / size**2)
        strongest = int(np.argmax(np.abs(curvature)))
        place = plane.centres[0] + solved[0] * plane.outward_normal
        outward = plane.outward_normal - axes @ (solved[1:3] / size)
        outward /= np.linalg.norm(outward)
        mean, most = float(curvature.mean()), float(curvature[strongest])
        if min(abs(mean), abs(most)) < FLATTEST:
            return cls(explains, None, None)
        axis = axes @ ways[:, 1 - strongest]
        across = outward - axis * (axis @ outward)
        tube = Cylinder.along(place + across / np.linalg.norm(across) / most, axis, abs(1 / most))
        return cls(explains, Sphere(place + outward / mean, abs(1 / mean)), tube)
