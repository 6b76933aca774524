"""Flat printed patterns drawn into the picture, with exact shares in every pixel an edge cuts.

A pattern is a grid of cells between straight edges along x and along y, plus round dots. The share of a pixel on one
side of an edge is that of a half-plane cutting a unit square: exact for one edge, so edges and corners are unbiased at
any phase and angle.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from core.compiled import compiled, inlined
from core.image.targets.coded_rings import CODE_FROM, CODE_TO
from core.model import Pose
from core.model.arrays import Array, frozen_array, set_field
from core.simulate.rays import Map

SUB = 5
"""Samples along each side of a pixel that a code ring is drawn by."""


@dataclass(frozen=True, eq=False, slots=True)
class Pattern:
    """Printed plate in its own frame (mm, z = 0 on its face, z pointing into the plate, away from the camera).

    Parameters
    ----------
    x_edges, y_edges
        (Nx,), (Ny,) where cells meet, ascending, in mm. The outermost are the plate's own edges.
    albedo
        (Ny − 1, Nx − 1) of the cells.
    background
        Albedo of what is seen beside the plate.
    dots
        (N, 2) centres of round dots on top of the cells, in mm.
    dot_radius, dot_albedo
        Of all dots.
    rings, codes
        (R, 2) middles in mm of code rings, and (R, S) which of their sectors are dark: `core.image.targets.coded_rings`
        of discs of `dot_radius`.
    """

    x_edges: Array
    y_edges: Array
    albedo: Array
    background: float = 0.03
    dots: Array | None = None
    dot_radius: float = 0.0
    dot_albedo: float = 0.0
    rings: Array | None = None
    codes: Array | None = None

    def __post_init__(self) -> None:
        set_field(self, "x_edges", frozen_array(self.x_edges, (None,), "x_edges"))
        set_field(self, "y_edges", frozen_array(self.y_edges, (None,), "y_edges"))
        shape = (len(self.y_edges) - 1, len(self.x_edges) - 1)
        set_field(self, "albedo", frozen_array(self.albedo, shape, "albedo"))
        dots: ArrayLike = np.empty((0, 2)) if self.dots is None else self.dots
        set_field(self, "dots", frozen_array(dots, (None, 2), "dots"))

    def on(self, background: float) -> Pattern:
        """Lay the plate on something of another albedo."""
        return replace(self, background=background)

    @property
    def outline(self) -> Array:
        """Corners (4, 3) of the plate in mm, in order round it."""
        (x0, x1), (y0, y1) = self.x_edges[[0, -1]], self.y_edges[[0, -1]]
        return np.array([[x0, y0, 0], [x1, y0, 0], [x1, y1, 0], [x0, y1, 0]])


def draw_pattern(pattern: Pattern, pose_cam_target: Pose, rays: Map) -> tuple[Map, Map]:
    """Compute for each pixel the point (h, w, 3) in mm on a plate, in the camera frame, and the plate's albedo (h, w).

    Where the plate is not seen, points are 0 and the albedo is the background's.
    """
    padded = np.pad(pattern.albedo, 1, constant_values=pattern.background)
    dots = np.empty((0, 2)) if pattern.dots is None else pattern.dots
    points, albedo = _draw_cells(
        pattern.x_edges, pattern.y_edges, padded, pose_cam_target.rotation, pose_cam_target.translation, rays
    )
    dot = (pattern.dot_radius, pattern.dot_albedo)
    if pattern.rings is not None and pattern.codes is not None:
        codes = np.asarray(pattern.codes, dtype=np.bool_)
        place = pose_cam_target.rotation, pose_cam_target.translation
        _draw_codes((np.asarray(pattern.rings), codes), (*dot, CODE_FROM, CODE_TO), place, rays, points, albedo)
    if len(dots):
        _draw_dots(dots, dot, pose_cam_target.rotation, pose_cam_target.translation, rays, points, albedo)
    return points, albedo


@inlined()
def _on_plate(x, y, rotation, translation):  # type: ignore[no-untyped-def]
    """Plate coordinates and depth of the point at which ray (x, y, 1) meets the plate; depth 0 if it does not."""
    facing = rotation[0, 2] * x + rotation[1, 2] * y + rotation[2, 2]
    along = rotation[0, 2] * translation[0] + rotation[1, 2] * translation[1] + rotation[2, 2] * translation[2]
    if facing <= 1e-6 or along <= 0:
        return 0.0, 0.0, 0.0
    z = along / facing
    dx, dy, dz = z * x - translation[0], z * y - translation[1], z - translation[2]
    px = rotation[0, 0] * dx + rotation[1, 0] * dy + rotation[2, 0] * dz
    py = rotation[0, 1] * dx + rotation[1, 1] * dy + rotation[2, 1] * dz
    return px, py, z


@inlined()
def _share(distance, gradient_u, gradient_v):  # type: ignore[no-untyped-def]
    """Share of a pixel beyond a straight edge.

    `distance` from the edge to the pixel's centre in mm, its gradient in mm per pixel. The projection of a unit square
    on the edge's normal is a trapezium; this is its running integral.
    """
    a, b = abs(gradient_u), abs(gradient_v)
    long, short = max(a, b), min(a, b)
    outer, inner = (long + short) / 2, (long - short) / 2
    if distance <= -outer:
        return 0.0
    if distance >= outer:
        return 1.0
    if distance < -inner:
        return (distance + outer) ** 2 / (2 * long * short)
    if distance > inner:
        return 1.0 - (outer - distance) ** 2 / (2 * long * short)
    return 0.5 + distance / long


@inlined()
def _widest_step(rays):  # type: ignore[no-untyped-def]
    """Largest step of a ray coordinate from pixel to pixel, looked for here and there: distortion is smooth."""
    height, width = rays.shape[:2]
    widest = 0.0
    for v in range(0, height - 1, 16):
        for u in range(0, width - 1, 16):
            for k in range(2):
                here = rays[v, u, k]
                widest = max(widest, abs(rays[v, u + 1, k] - here), abs(rays[v + 1, u, k] - here))
    return widest


@inlined()
def _stepped(ascending, i, value):  # type: ignore[no-untyped-def]
    """How many of `ascending` are below `value`, looked for from `i` on: the neighbouring pixel's answer."""
    while i < len(ascending) and ascending[i] < value:
        i += 1
    while i > 0 and ascending[i - 1] >= value:
        i -= 1
    return i


@compiled()
def _draw_cells(x_edges, y_edges, cells, rotation, translation, rays):  # type: ignore[no-untyped-def]
    height, width = rays.shape[:2]
    points = np.zeros((height, width, 3), np.float32)
    albedo = np.full((height, width), cells[0, 0], np.float32)
    x_middles, y_middles = (x_edges[1:] + x_edges[:-1]) / 2, (y_edges[1:] + y_edges[:-1]) / 2
    step = 2 * _widest_step(rays)
    i = j = 0
    for v in range(height):
        below = v + 1 if v + 1 < height else v - 1
        for u in range(width):
            x, y = rays[v, u, 0], rays[v, u, 1]
            px, py, z = _on_plate(x, y, rotation, translation)
            if z == 0.0 or px < x_edges[0] - 5 or px > x_edges[-1] + 5 or py < y_edges[0] - 5 or py > y_edges[-1] + 5:
                continue
            i, j = _stepped(x_middles, i, px), _stepped(y_middles, j, py)  # nearest edges
            off_x, off_y = px - x_edges[i], py - y_edges[j]
            facing = rotation[0, 2] * x + rotation[1, 2] * y + rotation[2, 2]
            reach = step * z * (1 + x * x + y * y) / facing  # no pixel is wider on the plate
            xu, yu, xv, yv = px, py, px, py
            if min(abs(off_x), abs(off_y)) < reach:
                right = u + 1 if u + 1 < width else u - 1
                xu, yu, _ = _on_plate(rays[v, right, 0], rays[v, right, 1], rotation, translation)
                xv, yv, _ = _on_plate(rays[below, u, 0], rays[below, u, 1], rotation, translation)
            right_share = _share(off_x, xu - px, xv - px)
            lower_share = _share(off_y, yu - py, yv - py)
            upper = cells[j, i] * (1 - right_share) + cells[j, i + 1] * right_share
            lower = cells[j + 1, i] * (1 - right_share) + cells[j + 1, i + 1] * right_share
            albedo[v, u] = upper * (1 - lower_share) + lower * lower_share
            if x_edges[0] < px < x_edges[-1] and y_edges[0] < py < y_edges[-1]:
                points[v, u, 0], points[v, u, 1], points[v, u, 2] = z * rays[v, u, 0], z * rays[v, u, 1], z
    return points, albedo


@compiled()
def _draw_codes(coded, dot, place, rays, points, albedo):  # type: ignore[no-untyped-def]
    """Code rings by SUB × SUB samples a pixel: only their levels are read, no edge of them is measured."""
    rings, codes = coded
    radius, dark, code_from, code_to = dot
    rotation, translation = place
    height, width = rays.shape[:2]
    sectors = codes.shape[1]
    for v in range(height):
        below = v + 1 if v + 1 < height else v - 1
        for u in range(width):
            if points[v, u, 2] == 0:
                continue
            px, py, _ = _on_plate(rays[v, u, 0], rays[v, u, 1], rotation, translation)
            for k in range(len(rings)):
                x, y = px - rings[k, 0], py - rings[k, 1]
                if x * x + y * y > (1.2 * code_to * radius) ** 2:
                    continue
                right = u + 1 if u + 1 < width else u - 1
                xu, yu, _ = _on_plate(rays[v, right, 0], rays[v, right, 1], rotation, translation)
                xv, yv, _ = _on_plate(rays[below, u, 0], rays[below, u, 1], rotation, translation)
                inked = 0
                for i in range(SUB * SUB):
                    a, b = (i % SUB + 0.5) / SUB - 0.5, (i // SUB + 0.5) / SUB - 0.5
                    sx, sy = x + a * (xu - px) + b * (xv - px), y + a * (yu - py) + b * (yv - py)
                    from_middle = np.hypot(sx, sy) / radius
                    if code_from < from_middle < code_to:
                        sector = int(np.arctan2(sy, sx) / (2 * np.pi) * sectors + sectors) % sectors
                        inked += codes[k, sector]
                albedo[v, u] += inked / (SUB * SUB) * (dark - albedo[v, u])


@compiled()
def _draw_dots(dots, dot, rotation, translation, rays, points, albedo):  # type: ignore[no-untyped-def]
    radius, dark = dot
    height, width = rays.shape[:2]
    for v in range(height):
        below = v + 1 if v + 1 < height else v - 1
        for u in range(width):
            if points[v, u, 2] == 0:
                continue
            px, py, _ = _on_plate(rays[v, u, 0], rays[v, u, 1], rotation, translation)
            right = u + 1 if u + 1 < width else u - 1
            nearest = 0
            for k in range(1, len(dots)):
                if (px - dots[k, 0]) ** 2 + (py - dots[k, 1]) ** 2 < (px - dots[nearest, 0]) ** 2 + (
                    py - dots[nearest, 1]
                ) ** 2:
                    nearest = k
            here = np.hypot(px - dots[nearest, 0], py - dots[nearest, 1])
            if here > 1.5 * radius:
                continue
            xu, yu, _ = _on_plate(rays[v, right, 0], rays[v, right, 1], rotation, translation)
            xv, yv, _ = _on_plate(rays[below, u, 0], rays[below, u, 1], rotation, translation)
            along_u = np.hypot(xu - dots[nearest, 0], yu - dots[nearest, 1]) - here
            along_v = np.hypot(xv - dots[nearest, 0], yv - dots[nearest, 1]) - here
            share = _share(radius - here, along_u, along_v)
            albedo[v, u] += share * (dark - albedo[v, u])
