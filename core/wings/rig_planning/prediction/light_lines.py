"""Where the stripes of a sheet of light lie in the picture, exactly: its plane cut with flat faces, seen by the camera.

On each face the cut is a straight segment. It is followed in steps of one pixel; points that the camera or the laser
does not see are left out, and so is what the extraction leaves out at the ends of a stripe.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.image.stripes.runs import arc_length
from core.image.stripes.stripe import PIXEL_VARIANCE
from core.model import Camera, Pose
from core.model.arrays import Array, runs_of
from core.simulate.scene.laser import Sheet
from core.simulate.scene.scene import Scene, Sphere

END_IN_FILTERS = 2.5
"""What the extraction leaves out at either end of a stripe, in σ of its filter."""
SHORTEST_IN_FILTERS = 7.0
"""Shorter stretches are no stripe to it."""
_FINE_STEPS = 200
"""Points of a cut by which its length in pixels is measured."""
_CLEAR = 1e-4
"""A surface does not hide itself: shadow rays end this share of their length before it."""
_GRAZING = 0.02
"""Cosine of the light on a face below which there is no stripe to speak of."""


@dataclass(frozen=True, eq=False, slots=True)
class FlatFace:
    """Convex flat face.

    Parameters
    ----------
    corners
        (K, 3) in mm in the camera frame, in order round it.
    normal
        (3,) unit normal to the outside.
    albedo
        Of its surface.
    """

    corners: Array
    normal: Array
    albedo: float

    def cut(self, sheet: Sheet) -> Array | None:
        """Intersect the face with a light sheet's plane: ends (2, 3) in mm of the segment; None if they do not meet."""
        off = self.corners @ sheet.plane.pi - 1
        following = np.roll(off, -1)
        crossed = np.flatnonzero((off < 0) != (following < 0))
        if len(crossed) != 2:
            return None
        share = off[crossed] / (off[crossed] - following[crossed])
        start = self.corners[crossed]
        return np.asarray(start + share[:, None] * (np.roll(self.corners, -1, axis=0)[crossed] - start))

    def seen_along(self, rays: Array) -> Array:
        """Compute the points (N, 3) in mm where camera rays (N, 3) meet the face's plane."""
        return np.asarray(rays * ((self.normal @ self.corners[0]) / (rays @ self.normal))[:, None])


@dataclass(frozen=True, eq=False, slots=True)
class LitLine:
    """Unbroken stretch of a stripe: `uv` (N, 2) in pixels about one pixel apart, exact; `normal` (N, 2) across it.

    `height` (N,) of its cross-section in grey levels and `width` (N,) its Gaussian σ in pixels; `points` (N, 3) in mm;
    `face` the number of the face it lies on.
    """

    uv: Array
    normal: Array
    height: Array
    width: Array
    points: Array
    face: int

    def __len__(self) -> int:
        return len(self.uv)

    def select(self, keep: slice) -> LitLine:
        """Select the points of the stripe that the slice `keep` covers."""
        return LitLine(
            self.uv[keep], self.normal[keep], self.height[keep], self.width[keep], self.points[keep], self.face
        )


def faces_of(scene: Scene, table: Pose, reach_mm: float) -> tuple[FlatFace, ...]:
    """List the flat faces of a scene: the table, a square of half side `reach_mm`, then the faces of its meshes."""
    square = reach_mm * np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
    faces = [FlatFace(table.apply(square), table.rotation[:, 2], scene.table_albedo)]
    for mesh in scene.meshes:
        for first, second in mesh.triangles.reshape(-1, 2, 3, 3):
            normal = np.cross(first[1] - first[0], first[2] - first[0])
            corners = np.array([first[0], first[1], first[2], second[2]])
            faces.append(FlatFace(corners, normal / np.linalg.norm(normal), mesh.albedo))
    return tuple(faces)


def lit_lines(
    sheet: Sheet, faces: Sequence[FlatFace], occluders: Array, camera: Camera, blur_px: float, filter_px: float
) -> tuple[LitLine, ...]:
    """Compute the stripes that one light sheet draws on `faces`, less what `occluders` (T, 3, 3) in mm hide or shade.

    Parameters
    ----------
    blur_px
        Gaussian σ of lens and pixel.
    filter_px
        σ of the extraction's filter: it decides what is left out at the ends, and what is too short.
    """
    lines: list[LitLine] = []
    for number, face in enumerate(faces):
        ends = face.cut(sheet)
        if ends is None or float(face.normal @ ends.mean(axis=0)) >= 0:
            continue
        line, lit = _followed(sheet, face, number, ends, occluders, camera, blur_px)
        if line is None:
            continue
        for first, last in runs_of(lit):
            end = round(END_IN_FILTERS * filter_px)
            if last - first - 2 * end >= SHORTEST_IN_FILTERS * filter_px:
                lines.append(line.select(slice(first + end, last - end)))
    return tuple(lines)


def lit_ball(sheet: Sheet, ball: Sphere, number: int, camera: Camera, blur_px: float) -> tuple[LitLine, ...]:
    """Compute the stripe that one light sheet draws on a ball, as on face `number`; nothing hides or shades it."""
    off = float(sheet.plane.distances(ball.centre[None])[0])
    if abs(off) >= ball.radius:
        return ()
    across = np.linalg.svd(sheet.plane.normal[None])[2][1:]
    turn = np.linspace(0, 2 * np.pi, _FINE_STEPS * 20, endpoint=False)
    circle = np.column_stack([np.cos(turn), np.sin(turn)]) @ across * np.sqrt(ball.radius**2 - off**2)
    points = ball.centre - off * sheet.plane.normal + circle
    outwards = (points - ball.centre) / ball.radius
    towards = points - sheet.emitter
    cosine = -np.einsum("ni,ni->n", towards, outwards) / np.linalg.norm(towards, axis=1)
    lit = (cosine > _GRAZING) & (np.einsum("ni,ni->n", points, outwards) < 0)
    shift = int(np.flatnonzero(~lit)[0])  # a stripe does not begin in the middle
    points, outwards, towards, cosine, lit = (
        np.roll(a, -shift, axis=0) for a in (points, outwards, towards, cosine, lit)
    )
    lines = []
    for first, last in runs_of(lit):
        arc = arc_length(camera.project(points[first:last]))
        at = first + np.unique(
            np.round(np.interp(np.arange(0.0, arc[-1]), arc, np.arange(last - first))).astype(np.intp)
        )
        if len(at) < 3:
            continue
        uv = camera.project(points[at])
        tangent = np.gradient(uv, axis=0)
        tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
        normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
        aside = camera.rays(uv + normal)
        depth = np.einsum("ni,ni->n", outwards[at], points[at]) / np.einsum("ni,ni->n", outwards[at], aside)
        step = aside * depth[:, None] - points[at]
        gap = np.abs(step @ sheet.plane.normal)
        height, width = _section(sheet, towards[at], cosine[at] * ball.albedo, gap, blur_px)
        lines.append(LitLine(uv, normal, height, width, points[at], number))
    return tuple(lines)


def _followed(
    sheet: Sheet, face: FlatFace, number: int, ends: Array, occluders: Array, camera: Camera, blur_px: float
) -> tuple[LitLine | None, NDArray[np.bool_]]:
    """The cut with a face in steps of a pixel, and which of its points are lit, seen and in the picture."""
    nothing = np.zeros(0, dtype=np.bool_)
    share = _even_steps(camera, ends)
    if len(share) < 2:
        return None, nothing
    points = ends[0] + share[:, None] * (ends[1] - ends[0])
    uv = camera.project(points)
    tangent = np.gradient(uv, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    inside = ((uv >= 0) & (uv <= np.array(camera.image_size) - 1)).all(axis=1)
    towards = points - sheet.emitter
    cosine = -(towards @ face.normal) / np.linalg.norm(towards, axis=1)
    lit = inside & (cosine > _GRAZING)
    lit[lit] = _free(np.zeros(3), points[lit], occluders) & _free(sheet.emitter, points[lit], occluders)
    step = face.seen_along(camera.rays(uv + normal)) - points
    height, width = _section(sheet, towards, cosine * face.albedo, np.abs(step @ sheet.plane.normal), blur_px)
    return LitLine(uv, normal, height, width, points, number), lit


def _section(sheet: Sheet, towards: Array, reflected: Array, gap_mm: Array, blur_px: float) -> tuple[Array, Array]:
    """Height and σ in px of the cross-section, as `core.simulate.scene.laser` lights it and the lens blurs it.

    `gap_mm` (N,) is how much farther from the sheet's middle a point one pixel aside lies.
    """
    beam = sheet.beam
    rho = np.linalg.norm(towards, axis=1)
    sigma = beam.sigma_mm * np.hypot(1, (rho - beam.focus_mm) / beam.rayleigh_mm)
    angle = np.arccos(np.clip(towards @ sheet.axis / rho, -1, 1))
    crest = beam.peak_grey * beam.focus_mm * beam.sigma_mm / (rho * sigma) * reflected
    crest = np.maximum(crest * np.exp(-2 * (angle / beam.half_angle) ** 2), 1e-6)
    own = sigma / np.maximum(gap_mm, 1e-9)
    width = np.sqrt(own**2 + blur_px**2 + PIXEL_VARIANCE)
    return crest * own / width, width


def _even_steps(camera: Camera, ends: Array) -> Array:
    """Shares (N,) of the way between two points (2, 3), one pixel apart in the picture, while in front of it."""
    coarse = np.linspace(0, 1, _FINE_STEPS)
    points = ends[0] + coarse[:, None] * (ends[1] - ends[0])
    ahead = points[:, 2] > 1.0
    half = np.array(camera.image_size) / np.diag(camera.matrix)[:2]  # twice the picture: the lens model ends somewhere
    near = ahead & (np.abs(points[:, :2]) <= half * np.maximum(points[:, 2:], 1.0)).all(axis=1)
    if np.count_nonzero(near) < 2:
        return np.zeros(0)
    coarse, uv = coarse[near], camera.project(points[near])
    arc = arc_length(uv)
    return np.asarray(np.interp(np.arange(0.0, arc[-1]), arc, coarse), dtype=np.float64)


def _free(origin: Array, points: Array, triangles: Array) -> NDArray[np.bool_]:
    """Which of `points` (N, 3) nothing hides from `origin` (Möller–Trumbore against all `triangles` (T, 3, 3))."""
    free = np.ones(len(points), dtype=np.bool_)
    rays = points - origin
    for corner, second, third in triangles:
        one, other = second - corner, third - corner
        p = np.cross(rays, other)
        determinant = p @ one
        flat = np.abs(determinant) < 1e-12
        scale = 1 / np.where(flat, 1.0, determinant)
        start = origin - corner
        a = (p @ start) * scale
        q = np.cross(start, one)
        b = (rays @ q) * scale
        t = float(other @ q) * scale
        free &= flat | (a < 0) | (a > 1) | (b < 0) | (a + b > 1) | (t <= 0) | (t >= 1 - _CLEAR)
    return free
