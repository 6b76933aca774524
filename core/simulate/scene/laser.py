"""Line lasers as sheets of light: Gaussian across, from a real emitter, shadowed by what stands in the way.

Light on a surface point X at distance ρ from the emitter, d off the sheet's middle and φ off its axis:

    I = peak · ρ₀σ₀/(ρ σ(ρ)) · exp(−d²/2σ(ρ)²) · exp(−2 φ²/φ₀²) · cos θ,    σ(ρ) = σ₀ √(1 + ((ρ − ρ₀)/ρ_R)²)

with θ the angle of incidence; 0 where θ ≥ 90° or something is in the way. Only pixels within 4.5 σ of the sheet are
looked at. A laser may have another section than the Gaussian (`core.simulate.effects.laser`). Of an object whose
material takes light in, a share is that of the points behind, down to a depth, seen through it along the pixel's ray
(without refraction), or wanders through it (`core.simulate.scene.walk`); one that is glossy adds a lobe about the
mirrored light, which is narrower along a lay. A housing may cut a sheet off at its ends.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled
from core.model import LightPlane
from core.model.arrays import Array, frozen_array, set_field
from core.simulate.rays import Map
from core.simulate.rig import Beam, Rig
from core.simulate.scene.scene import MATT, TILE, Material, Scene, SurfaceMaps
from core.simulate.scene.shadow import ShadowCaster
from core.simulate.scene.walk import FARTHEST_PATHS, walk

REACH_SIGMAS = 4.5
"""σ from the sheet's middle beyond which light is left out: 4e-5 of the crest."""
FARTHEST_FROM_FOCUS_MM = 400.0
"""Distance from its focus at which a sheet is rendered at most; its width there is looked at."""
_DEPTHS, _DEPTH_SHARES = np.polynomial.legendre.leggauss(8)
"""Depths from −1 to 1, and their weights, that stand for all those from which light comes back."""
_LEAST_COSINE = 0.1
"""Of the angle at which light leaves a surface: beyond, what comes from below is not followed further."""
_LEAST_LAY = 0.02
"""Share of a lay that lies in a face: with less of it, the face is cut across it."""
BOW_SEEN_TO = 0.6
"""Angle in rad beside the camera's viewing direction to which the light of a bowed sheet is rendered."""


@dataclass(frozen=True, eq=False, slots=True)
class Sheet:
    """Sheet of laser light: its plane, its emitter (3,) on that plane in mm, its axis (3,) and its beam.

    `rows` (height, 4) is for a laser that moves while the camera reads its rows out: unit normal and distance in mm of
    the plane that each row of the picture sees; `plane` then is that of the middle row.
    """

    plane: LightPlane
    emitter: Array
    axis: Array
    beam: Beam
    rows: Array | None = None

    def __post_init__(self) -> None:
        emitter = np.asarray(self.emitter, dtype=np.float64)
        emitter = emitter - self.plane.distances(emitter[None])[0] * self.plane.normal
        axis = np.asarray(self.axis, dtype=np.float64)
        axis = axis - (axis @ self.plane.normal) * self.plane.normal
        set_field(self, "emitter", frozen_array(emitter, (3,), "emitter"))
        set_field(self, "axis", frozen_array(axis / np.linalg.norm(axis), (3,), "axis"))

    def off_light(self, points: Array, row: NDArray[np.intp]) -> Array:
        """Compute signed distances (N,) in mm of `points` (N, 3) in picture rows `row` from the sheet's middle."""
        if self.rows is not None:
            return np.asarray((points * self.rows[row, :3]).sum(axis=1) - self.rows[row, 3], dtype=np.float64)
        off = self.plane.distances(points)
        if not self.beam.bow:
            return off
        normal = self.plane.normal
        ahead = np.array([0.0, 0.0, 1.0]) - normal[2] * normal
        ahead /= np.linalg.norm(ahead)
        towards = points - self.emitter
        angle = np.arctan2(towards @ np.cross(normal, ahead), towards @ ahead)
        return np.asarray(off - 0.5 * self.beam.bow * angle**2 * np.linalg.norm(towards, axis=1), dtype=np.float64)


def fan_sheets(rig: Rig, aim: Array) -> tuple[Sheet, ...]:
    """Make the sheets of light of the rig's fan, one for each line in order, their middles towards `aim` (3,) in mm."""
    return tuple(Sheet(plane, rig.fan_emitter, aim - rig.fan_emitter, rig.fan_beam) for plane in rig.fan.planes)


def laser_light(
    sheet: Sheet,
    scene: Scene,
    maps: SurfaceMaps,
    out: Map | None = None,
    reached: Callable[[Array], NDArray[np.bool_]] | None = None,
) -> Map:
    """Compute the light (height, width), in 8-bit grey levels, of one laser sheet that each pixel's point reflects.

    Added to `out` when it is given. Neither lens nor speckle are in it yet. `reached` says which points (N, 3) light
    gets to; without it, those that nothing shades.
    """
    light = np.zeros(maps.albedo.shape, np.float32) if out is None else out
    beam = sheet.beam
    widest = beam.sigma_mm * np.hypot(1, max(1.0, FARTHEST_FROM_FOCUS_MM / beam.rayleigh_mm))
    inner = _farthest_mm(scene.material)
    reach = REACH_SIGMAS * beam.section.reach * widest + _largest_bow(beam) + _largest_shift(sheet) + inner
    v, u = _near(maps, sheet.plane, reach)
    points = maps.points[v, u].astype(np.float64)
    towards = points - sheet.emitter
    rho = np.linalg.norm(towards, axis=1)
    cosine = -np.einsum("ni,ni->n", towards, maps.normals[v, u]) / rho
    lit = cosine > 0
    v, u, points, towards, rho, cosine = v[lit], u[lit], points[lit], towards[lit], rho[lit], cosine[lit]
    if reached is None:
        reached = ShadowCaster.near_plane(scene, sheet.plane, sheet.emitter, sheet.axis, reach).visible
    open_sky = reached(points)
    sigma = beam.sigma_mm * np.hypot(1, (rho - beam.focus_mm) / beam.rayleigh_mm)
    angle = np.arccos(np.clip(towards @ sheet.axis / rho, -1, 1))
    strength = beam.peak_grey * beam.focus_mm * beam.sigma_mm / (rho * sigma)
    across = beam.section.across(sheet.off_light(points, v) / sigma)
    shine = maps.albedo[v, u] * cosine
    if scene.material != MATT:
        matt = maps.table if maps.matt is None else maps.matt
        mine = ~matt[v, u] if matt.size else np.ones(len(v), np.bool_)
        normals, row = maps.normals[v[mine], u[mine]], v[mine]
        if scene.material.scattered:
            across[mine] = _wandered(scene.material, sheet, points[mine], normals, row, sigma[mine])
        elif scene.material.inner_share:
            across[mine] = _through(scene.material, sheet, points[mine], normals, row, sigma[mine])
        if scene.material.gloss:
            shine[mine] += maps.albedo[v[mine], u[mine]] * _gloss(scene.material, points[mine], towards[mine], normals)
    profile = across * np.exp(-2 * (angle / beam.half_angle) ** 2)
    if beam.end_angle:
        profile *= _within_end(angle, beam)
    light[v, u] += (strength * profile * shine * open_sky).astype(np.float32)
    return light


def _through(
    material: Material, sheet: Sheet, points: Array, normals: Map, row: NDArray[np.intp], sigma: Array
) -> Array:
    """Light (N,) across a sheet at points (N, 3) where a share comes from behind them, 1 at its crest."""
    rays = points / np.linalg.norm(points, axis=1)[:, None]
    inwards = np.maximum(-np.einsum("ni,ni->n", rays, normals), _LEAST_COSINE)
    per_mm = rays / inwards[:, None]  # along the ray, for each mm of depth
    found = (1 - material.inner_share) * sheet.beam.section.across(sheet.off_light(points, row) / sigma)
    for place, share in zip(_DEPTHS, _DEPTH_SHARES, strict=True):
        off = sheet.off_light(points + material.inner_mm * (1 + place) / 2 * per_mm, row)
        found += material.inner_share * share / 2 * sheet.beam.section.across(off / sigma)
    return np.asarray(found)


def _farthest_mm(material: Material) -> float:
    """How far in mm from where it entered light comes out of an object at most."""
    if material.scattered:
        return 2 * FARTHEST_PATHS * material.free_path_mm
    return material.inner_mm if material.inner_share else 0.0


def _wandered(
    material: Material, sheet: Sheet, points: Array, normals: Map, row: NDArray[np.intp], sigma: Array
) -> Array:
    """Light (N,) across a sheet at points (N, 3) where a share has wandered through the matter, 1 at its crest."""
    photons = walk(material.scatter_albedo)
    outward = normals.astype(np.float64)
    aside = sheet.plane.normal - (outward @ sheet.plane.normal)[:, None] * outward
    aside /= np.maximum(np.linalg.norm(aside, axis=1), _LEAST_COSINE)[:, None]
    found = (1 - material.scattered) * sheet.beam.section.across(sheet.off_light(points, row) / sigma)
    for depth, along, weight in zip(photons.depth, photons.aside, photons.weight, strict=True):
        began = points + material.free_path_mm * (along * aside - depth * outward)
        found += material.scattered * weight * sheet.beam.section.across(sheet.off_light(began, row) / sigma)
    return np.asarray(found)


def _within_end(angle: Array, beam: Beam) -> Array:
    """Share (N,) of the light at these angles beside a sheet's axis that the rim of its housing lets pass."""
    rise = np.clip((beam.end_angle + beam.end_fade / 2 - angle) / beam.end_fade, 0.0, 1.0)
    return np.asarray(rise**2 * (3 - 2 * rise))


def _gloss(material: Material, points: Array, towards: Array, normals: Map) -> Array:
    """Mirrored light (N,) at points (N, 3), by the tilt of the surface that would mirror the laser into the camera."""
    half = -points / np.linalg.norm(points, axis=1)[:, None] - towards / np.linalg.norm(towards, axis=1)[:, None]
    cosine = np.einsum("ni,ni->n", half, normals) / np.linalg.norm(half, axis=1)
    tilt = np.arccos(np.clip(cosine, -1.0, 1.0))
    if not material.along_rad:
        return np.asarray(material.gloss * np.exp(-0.5 * (tilt / material.gloss_rad) ** 2))
    along = _along_lay(half, normals, np.array(material.lay))
    square = along * (tilt / material.along_rad) ** 2 + (1 - along) * (tilt / material.gloss_rad) ** 2
    return np.asarray(material.gloss * np.exp(-0.5 * square))


def _along_lay(half: Array, normals: Map, lay: Array) -> Array:
    """Square (N,) of the cosine between the lay and the way a surface tilts to have the normals `half` (N, 3).

    A face on which the lay stands upright is taken to have it along the direction that is left.
    """
    flat = lay - (normals @ lay)[:, None] * normals
    upright = np.linalg.norm(flat, axis=1) < _LEAST_LAY
    flat[upright] = np.cross(normals[upright], np.roll(lay, 1))
    flat /= np.maximum(np.linalg.norm(flat, axis=1), _LEAST_LAY)[:, None]
    along = np.einsum("ni,ni->n", half, flat) ** 2
    across = np.einsum("ni,ni->n", half, np.cross(normals, flat)) ** 2
    return np.asarray(along / np.maximum(along + across, np.finfo(np.float64).tiny))


def _largest_bow(beam: Beam) -> float:
    """How far in mm the light of a beam leaves its plane at most, where anything is looked at."""
    return 0.5 * abs(beam.bow) * BOW_SEEN_TO**2 * (beam.focus_mm + FARTHEST_FROM_FOCUS_MM)


def _largest_shift(sheet: Sheet) -> float:
    """How far in mm a moving sheet leaves its middle plane at most, where anything is looked at."""
    if sheet.rows is None:
        return 0.0
    turned = np.linalg.norm(sheet.rows[:, :3] - sheet.plane.normal, axis=1)
    shifted = np.abs(sheet.rows[:, 3] - sheet.rows[:, :3] @ sheet.emitter)
    return float((shifted + turned * (sheet.beam.focus_mm + FARTHEST_FROM_FOCUS_MM)).max())


def _near(maps: SurfaceMaps, plane: LightPlane, reach: float) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Rows and columns of the pixels whose point is within `reach` mm of the plane, tile by tile."""
    ends = maps.tiles * plane.normal
    nearest = np.minimum(ends[0], ends[1]).sum(axis=-1) - plane.d_mm
    farthest = np.maximum(ends[0], ends[1]).sum(axis=-1) - plane.d_mm
    tiles = np.argwhere((nearest < reach) & (farthest > -reach))
    rows, columns = _near_in_tiles(tiles, maps.points, plane.normal, plane.d_mm, reach)
    return rows, columns


@compiled()
def _near_in_tiles(tiles, points, normal, distance, reach):  # type: ignore[no-untyped-def]
    height, width = points.shape[:2]
    rows, columns = np.empty(len(tiles) * TILE * TILE, np.int64), np.empty(len(tiles) * TILE * TILE, np.int64)
    count = 0
    for i in range(len(tiles)):
        for v in range(tiles[i, 0] * TILE, min(height, (tiles[i, 0] + 1) * TILE)):
            for u in range(tiles[i, 1] * TILE, min(width, (tiles[i, 1] + 1) * TILE)):
                z = points[v, u, 2]
                off = points[v, u, 0] * normal[0] + points[v, u, 1] * normal[1] + z * normal[2] - distance
                if z > 0 and abs(off) < reach:
                    rows[count] = v
                    columns[count] = u
                    count += 1
    return rows[:count], columns[:count]
