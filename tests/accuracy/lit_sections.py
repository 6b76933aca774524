"""Where the centre of a stripe's light is seen on a sphere, pixel by pixel from the simulator's own law of light."""

from __future__ import annotations

import numpy as np

from core.simulate.scene.laser import Sheet
from tests.scan.centreline_scan import Curve, ExactScan

REACH = 5.0
"""How far a section is followed, in σ of what the lens makes of it."""
ACROSS, ALONG, STEPS = 61, 9, 12


def centres(exact: ExactScan, sheet: Sheet, curve: Curve, on: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How far (px) along its normal the centre of the light lies from each true point `on` a stripe: by the centroid,
    by the best Gaussian; and that Gaussian's σ."""
    blur = exact.rig.blur_px
    widest = np.hypot(blur, 1.5 * sheet.beam.sigma_mm * exact.rig.camera.focal / curve.points[on, 2].mean())
    x = np.linspace(-REACH, REACH, ACROSS) * widest
    y = np.linspace(-3.0, 3.0, ALONG) * blur
    tangent = np.column_stack([-curve.normal[on, 1], curve.normal[on, 0]])
    uv = curve.uv[on, None, None, :] + x[:, None, None] * curve.normal[on, None, None, :]
    uv = uv + y[:, None] * tangent[:, None, None, :]
    light = _light(exact, sheet, uv.reshape(-1, 2)).reshape(len(on), ACROSS, ALONG)
    along = np.exp(-0.5 * (y / blur) ** 2)
    across = np.exp(-0.5 * ((x[:, None] - x) / blur) ** 2)
    section = (light @ (along / along.sum())) @ across.T
    centroid = (section @ x) / section.sum(axis=1)
    return centroid, *_gaussians(section / section.max(axis=1, keepdims=True), x, centroid)


def _light(exact: ExactScan, sheet: Sheet, uv: np.ndarray) -> np.ndarray:
    """Light (N,) that the sphere seen at pixels `uv` (N, 2) sends back, by the law of `core.simulate.scene.laser`."""
    (sphere,) = exact.scene.spheres
    rays = exact.rig.camera.rays(uv)
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    middle = rays @ sphere.centre
    root = middle**2 - sphere.centre @ sphere.centre + sphere.radius**2
    points = (middle - np.sqrt(np.maximum(root, 0)))[:, None] * rays
    towards = points - sheet.emitter
    distance = np.linalg.norm(towards, axis=1)
    cosine = -((points - sphere.centre) * towards).sum(axis=1) / (sphere.radius * distance)
    beam = sheet.beam
    sigma = beam.sigma_mm * np.hypot(1, (distance - beam.focus_mm) / beam.rayleigh_mm)
    angle = np.arccos(np.clip(towards @ sheet.axis / distance, -1, 1))
    profile = np.exp(-0.5 * (sheet.plane.distances(points) / sigma) ** 2 - 2 * (angle / beam.half_angle) ** 2)
    return np.where((root > 0) & (cosine > 0), profile * cosine / (distance * sigma), 0.0)


def _gaussians(section: np.ndarray, x: np.ndarray, start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Centre and σ (M,) of the Gaussian of least squares for each section (M, W), by Gauss–Newton."""
    centre = start.copy()
    width = np.sqrt(np.maximum((section * (x - centre[:, None]) ** 2).sum(axis=1) / section.sum(axis=1), 1e-3))
    height = np.ones(len(section))
    for _ in range(STEPS):
        t = (x - centre[:, None]) / width[:, None]
        shape = np.exp(-0.5 * t**2)
        slope = height[:, None] * shape * t / width[:, None]
        design = np.stack([shape, slope, slope * t], axis=2)
        misfit = section - height[:, None] * shape
        across = design.transpose(0, 2, 1)
        step = np.linalg.solve(across @ design, across @ misfit[..., None])
        height, centre, width = height + step[:, 0, 0], centre + step[:, 1, 0], np.abs(width + step[:, 2, 0])
    return centre, width
