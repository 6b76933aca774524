"""Light that surfaces send on to each other, once: first-order interreflection of the lasers' light.

A patch of area A that sends back B evenly lights a surface at distance d with E = B A cos θ₁ cos θ₂ / (π d²), the form
factor of small patches (Goral et al., Modeling the interaction of light between diffuse surfaces, SIGGRAPH 1984,
doi:10.1145/800031.808601). The light is smooth, so it is reckoned from patches of the lit stripe on every STEP-th pixel
and interpolated. Neither occlusion nor a second bounce is in it.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array
from core.simulate.rays import Map
from core.simulate.scene.scene import SurfaceMaps

STEP = 8
"""Pixels from one at which the light is reckoned to the next."""
LEAST_SHARE = 1e-3
"""Of the brightest pixel's light, from which on a pixel lights others."""
MOST_PATCHES = 400
"""Patches of the stripe that stand for all of it."""
NEAREST_MM = 1.0
"""Patches are no nearer than this to what they light: they have an extent."""


def bounced_light(light: Map, maps: SurfaceMaps, focal_px: float) -> Map:
    """Compute the light (h, w) that surfaces lit by `light` (h, w) reflect to others, as the camera sees it there."""
    sources = np.argwhere(light > LEAST_SHARE * max(float(light.max()), 1e-12))
    if not len(sources):
        return np.zeros_like(light)
    every = max(1, len(sources) // MOST_PATCHES)
    v, u = sources[every // 2 :: every].T
    points, normals = maps.points[v, u].astype(np.float64), maps.normals[v, u].astype(np.float64)
    distance = np.linalg.norm(points, axis=1)
    facing = np.maximum(-np.einsum("ni,ni->n", points, normals) / distance, 0.05)
    area = every * points[:, 2] ** 2 / focal_px**2 * (points[:, 2] / distance) / facing
    power = _evened(light, sources, every) * area / np.pi
    there = maps.points[::STEP, ::STEP].reshape(-1, 3).astype(np.float64)
    up = maps.normals[::STEP, ::STEP].reshape(-1, 3).astype(np.float64)
    sent = np.zeros(len(there))
    for point, normal, each in zip(points, normals, power, strict=True):
        way = there - point
        square = np.maximum((way**2).sum(axis=1), NEAREST_MM**2)
        leaving, arriving = way @ normal, -np.einsum("ni,ni->n", way, up)
        sent += each * np.maximum(leaving, 0) * np.maximum(arriving, 0) / square**2
    height, width = light.shape
    coarse = sent.reshape(maps.points[::STEP, ::STEP].shape[:2]).astype(np.float32)
    from_fine = np.array([[1 / STEP, 0, 0], [0, 1 / STEP, 0]])
    how = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    fine = cv2.warpAffine(coarse, from_fine, (width, height), flags=how, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(maps.albedo * fine, dtype=np.float32)


def _evened(light: Map, sources: NDArray[np.intp], every: int) -> Array:
    """What each of the patches sends back: the mean over the pixels it stands for, in the order of the rows."""
    values = light[sources[:, 0], sources[:, 1]].astype(np.float64)
    patches = len(values[every // 2 :: every])
    starts = np.minimum(np.arange(patches) * every, len(values) - 1)
    sums = np.add.reduceat(values, starts)
    return np.asarray(sums / np.diff(np.append(starts, len(values))) * (len(values) / (patches * every)))
