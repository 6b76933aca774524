"""A cross-section: the profile of the points near a plane, with heights, distances and radii in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.inspect.characteristic import Characteristic
from core.inspect.features.measured import FeatureResult, Scene
from core.inspect.features.regions import points_in
from core.inspect.fit.judged_form import ARC, STRETCHES, notes_on_form
from core.inspect.fit.round import with_uneven_light
from core.inspect.fit.shapes import Cylinder, ParallelPlanes, Shape
from core.inspect.fit.surface_fit import fit_surface
from core.inspect.plan.feature_spec import Cut, FeatureSpec, Pixel, Section
from core.inspect.profile import Profile, averaged
from core.messages import Message
from core.model.arrays import Array
from core.scan.surface.cloud import Cloud

NEAREST = 0.05
"""Share of the points, the nearest to a pixel, from which its ray is known; at least FEWEST, as the fit has
three unknowns and points on one stripe hardly differ."""
FEWEST = 100
"""Points from which a pixel's ray is known at least."""


@dataclass(frozen=True, eq=False, slots=True)
class _Plane:
    """The section's plane: a place in it, and the direction its positions run in."""

    origin: Array
    along: Array
    up: Array


def measure_section(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    """Compute the profile of a cross-section and measure the heights, distances and radii asked for in it."""
    if spec.section is None:
        raise InputError(
            Message("feature.section_without_place", "it does not say where to cut"),
            todo=Message("feature.advice_give_line", "give a line in the picture, or a plane"),
        )
    section = spec.section
    plane = _plane(section, scene)
    profile = _profile(spec, section, plane, scene)
    rows = tuple(_cut(spec, cut, profile, scene) for cut in section.cuts)
    used = [profile.between(ends) for cut in section.cuts for ends in _stretches(cut)]
    shown = np.unique(np.concatenate(used)) if used else np.arange(len(profile.indices))
    return FeatureResult(spec, characteristics=rows, indices=np.sort(profile.indices[shown]), profile=profile)


def _plane(section: Section, scene: Scene) -> _Plane:
    if section.line_px is not None:
        first, second = (_ray(scene.cloud, pixel) for pixel in section.line_px)
        normal = np.cross(first, second)
        origin = np.zeros(3)
        towards = second / second[2] - first / first[2]
    else:
        pose = scene.pose_camera_part
        rotation, shift = (np.eye(3), np.zeros(3)) if pose is None else (pose.rotation, pose.translation)
        normal, origin = rotation @ np.array(section.normal), rotation @ np.array(section.point_mm) + shift
        towards = np.cross(rotation[:, 2], normal)
    if np.linalg.norm(normal) < 1e-9 or np.linalg.norm(towards) < 1e-9:
        raise InputError(
            Message("feature.section_without_direction", "its line or plane has no direction"),
            todo=Message("feature.advice_draw_line", "draw a line between two different places"),
        )
    normal = normal / np.linalg.norm(normal)
    planes = scene.planes(0.0)
    facing = -planes[0].normal if planes else np.array([0.0, 0.0, -1.0])
    up = facing - normal * (normal @ facing)
    if np.linalg.norm(up) < 0.1:
        up = np.array([0.0, 0.0, -1.0]) + normal * normal[2]
    up = up / np.linalg.norm(up)
    along = np.cross(up, normal)
    return _Plane(origin, along if along @ towards >= 0 else -along, up)


def _ray(cloud: Cloud, pixel: Pixel) -> Array:
    """The ray (x, y, 1) of a pixel, from those of the measured points around it: linear in the pixel."""
    order = np.argsort(((cloud.uv - np.array(pixel)) ** 2).sum(axis=1))[: max(FEWEST, int(NEAREST * len(cloud)))]
    near = cloud.uv[order]
    rays = cloud.points[order, :2] / cloud.points[order, 2:]
    design = np.column_stack([near - np.array(pixel), np.ones(len(near))])
    return np.append(np.linalg.lstsq(design, rays, rcond=None)[0][2], 1.0)


def _profile(spec: FeatureSpec, section: Section, plane: _Plane, scene: Scene) -> Profile:
    """The points near the plane; heights and positions are measured from where the profile begins at its lowest."""
    cloud = scene.cloud
    indices = points_in(spec.regions[0], spec.filters, scene)
    away = cloud.points[indices] - plane.origin
    indices = indices[np.abs(away @ np.cross(plane.along, plane.up)) <= section.half_width_mm]
    if len(indices) < 2:
        raise InputError(
            Message(
                "feature.few_points_near_section",
                "{n} measured points lie within {half_width_mm:g} mm of its plane",
                n=len(indices),
                half_width_mm=section.half_width_mm,
            ),
            todo=Message("feature.advice_cut_elsewhere", "cut where the scan covers the part, or take more points in"),
        )
    away = cloud.points[indices] - plane.origin
    position, height = away @ plane.along, away @ plane.up
    order = np.argsort(position, kind="stable")
    indices, position, height = indices[order], position[order], height[order]
    start = np.array([position[0], float(np.quantile(height, 0.02))])
    depth = cloud.points[indices]
    sigma = cloud.sigma[indices] * np.abs((depth / depth[:, 2:]) @ plane.up)
    position, height = position - start[0], height - start[1]
    origin = plane.origin + start[0] * plane.along + start[1] * plane.up
    means = averaged(position, height, section.step_mm)
    return Profile(origin, plane.along, plane.up, indices, position, height, sigma, *means)


def _stretches(cut: Cut) -> tuple[tuple[float, float], ...]:
    return (cut.first,) if cut.kind == "radius" else (cut.first, cut.second)


def _cut(spec: FeatureSpec, cut: Cut, profile: Profile, scene: Scene) -> Characteristic:
    """One measurement in the profile."""
    chosen = [profile.between(ends) for ends in _stretches(cut)]
    part = np.repeat(np.arange(len(chosen)), [len(one) for one in chosen])
    indices, position = profile.indices[np.concatenate(chosen)], profile.position[np.concatenate(chosen)]
    if any(len(one) < 3 for one in chosen):
        raise InputError(
            Message("feature.stretch_too_short", "a stretch of {name} holds too few points", name=cut.name),
            todo=Message("feature.advice_longer_stretch", "make it longer"),
        )
    tukey = spec.filters.outliers
    shape: Shape
    across = profile.normal
    names: tuple[Message, ...]
    if cut.kind == "radius":
        round_ = fit_surface(scene.cloud, indices, _circle(profile, chosen[0]), scene.errors, tukey=tukey)
        rows = with_uneven_light(round_, scene.cloud, scene.errors).budget(np.array([0.0, 0.0, 1.0]))
        shape, value, names = round_.shape, round_.shape.radius, (ARC,)
        rule = Message("feature.rule_radius", "radius of the circle of least squares in the section")
    else:
        points = scene.cloud.points
        centres = np.array([points[profile.indices[one]].mean(axis=0) for one in chosen])
        # A height is square to the faces, on which the section's plane leans; a distance of middles lies in that plane.
        ways = np.column_stack([profile.along, profile.normal] if cut.kind == "height" else [profile.along])
        start = ParallelPlanes(profile.up, centres, ways)
        lines = fit_surface(scene.cloud, indices, start, scene.errors, part=part, tukey=tukey)
        value, gradient, rule = _between(lines.shape, profile, cut)
        shape, rows, names = lines.shape, lines.budget(gradient), STRETCHES
        if cut.kind == "height":
            across = shape.axes[:, 1]
    off = (scene.cloud.points[indices] - profile.origin) @ across
    place = np.column_stack([position, off])
    notes = notes_on_form(scene.cloud, indices, shape, scene.errors, names, part, place)
    return scene.characteristic(spec, cut.kind, value, rows, result=cut.name, rule=rule, notes=notes)


def _between(lines: ParallelPlanes, profile: Profile, cut: Cut) -> tuple[float, Array, Message]:
    """Height or distance of the second stretch from the first, and its gradient."""
    height, gradient = lines.height(1, 0)
    if cut.kind == "height":
        rule = Message(
            "feature.rule_height",
            "distance of two parallel faces fitted jointly to two stretches of the section, square to them",
        )
        return height, gradient, rule
    aside = float((lines.centres[1] - lines.centres[0]) @ np.cross(profile.normal, lines.outward_normal))
    length = float(np.hypot(height, aside))
    of_heights = np.array([-1.0, 1.0, 0.0]) * height / max(length, 1e-9)
    middles = Message("feature.rule_middles", "distance of the middles of two stretches of the section")
    return length, of_heights, middles


def _circle(profile: Profile, chosen: NDArray[np.int64]) -> Cylinder:
    """The circle through a stretch of the profile by least algebraic distance."""
    flat = np.column_stack([profile.position[chosen], profile.height[chosen]])
    middle = flat.mean(axis=0)
    centred = flat - middle
    design = np.column_stack([2 * centred, np.ones(len(flat))])
    solved = np.linalg.lstsq(design, (centred**2).sum(axis=1), rcond=None)[0]
    at = middle + solved[:2]
    centre = profile.origin + at[0] * profile.along + at[1] * profile.up
    radius = float(np.sqrt(max(solved[2] + solved[:2] @ solved[:2], 1e-12)))
    return Cylinder.along(centre, profile.normal, radius, turns=False)
