"""Plates drawn larger than they are said to be, or bowed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from core.model import Pose
from core.model.arrays import Array
from core.simulate.rays import Map
from core.simulate.scene.patterns import Pattern

_ROUNDS = 4
"""Rounds in which the point of a bowed plate that a ray meets is found: the last moves it by less than 1e-6 mm."""


def scaled(pattern: Pattern, larger: float) -> Pattern:
    """Multiply all lengths of the printed pattern by 1 + `larger`."""
    if not larger:
        return pattern
    dots = None if pattern.dots is None else pattern.dots * (1 + larger)
    return replace(
        pattern,
        x_edges=pattern.x_edges * (1 + larger),
        y_edges=pattern.y_edges * (1 + larger),
        dots=dots,
        dot_radius=pattern.dot_radius * (1 + larger),
    )


def rays_to_bowed(pattern: Pattern, pose: Pose, rays: Map, bow_mm: float) -> Map:
    """Compute the rays (h, w, 2) that meet a flat plate where `rays` meet it bowed by `bow_mm`: to draw it bowed."""
    if not bow_mm:
        return rays
    on_plate, met = _met_on_bowed(pattern, pose, rays, bow_mm)
    on_plate[..., 2] = 0.0
    flat = on_plate @ pose.rotation.T + pose.translation
    met &= flat[..., 2] > 0
    seen = flat[..., :2] / np.where(met, flat[..., 2], 1.0)[..., None]
    return np.where(met[..., None], seen, rays).astype(np.float32)


def points_on_bowed(pattern: Pattern, pose: Pose, rays: Map, points: Map, bow_mm: float) -> Map:
    """Compute points (h, w, 3) in mm where `rays` meet the bowed plate; else `points`, those on the flat one."""
    if not bow_mm:
        return points
    on_plate, met = _met_on_bowed(pattern, pose, rays, bow_mm)
    return np.where(met[..., None], on_plate @ pose.rotation.T + pose.translation, points).astype(np.float32)


def _met_on_bowed(pattern: Pattern, pose: Pose, rays: Map, bow_mm: float) -> tuple[Array, NDArray[np.bool_]]:
    """Where rays meet the bowed plate, (h, w, 3) in its own frame, and whether they do."""
    x0, x1 = pattern.x_edges[[0, -1]]
    middle, half = (x0 + x1) / 2, (x1 - x0) / 2
    ahead = np.dstack([rays, np.ones(rays.shape[:2])]).astype(np.float64)
    facing, along = ahead @ pose.rotation[:, 2], float(pose.rotation[:, 2] @ pose.translation)
    met = facing > 1e-6
    facing = np.where(met, facing, 1.0)
    height = np.zeros(rays.shape[:2])
    for _ in range(_ROUNDS):
        on_plate = (ahead * ((along + height) / facing)[..., None] - pose.translation) @ pose.rotation
        height = -bow_mm * np.minimum(((on_plate[..., 0] - middle) / half) ** 2, 4.0)
    return on_plate, met
