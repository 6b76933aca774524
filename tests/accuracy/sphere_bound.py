"""What the width of the light forbids on a sphere: its radius with no noise at all, from sections as they truly are.

Camera, light planes and crossings are exact here and there is no speckle; a stripe is found only as well as its light
lies. Across a stripe the light of a sheet of σ_mm falls on a surface that turns away, so the section's middle is not
where the sheet's middle plane meets the surface (`core.image.shading`). For every point of every stripe the picture of
its surroundings is computed by the simulator's own law of light, blurred by the lens, and its centre is found twice:

- as the centroid of the light, which is what a likelihood under speckle trusts (all of the section counts alike);
- as the best Gaussian by least squares, which is what one under even noise trusts (the crest counts).

Nothing in one section tells that it lies uneven: it stays a Gaussian. What the radius is then off by falls with the
square of the light's width and hardly with the camera's resolution: `python -m tests.accuracy.sphere_bound`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from core.inspect.sphere import through
from core.simulate.laser import Sheet, fan_sheets
from core.simulate.scenario import Scenario
from core.simulate.stage import WORK_POINT
from tests.scan.centreline_scan import Curve, ExactScan

GOAL_MM = 0.015
"""Of the radius: 0.03 mm in diameter."""
EVERY = 4
"""Every so many points of a stripe are looked at."""
REACH = 5.0
"""How far a section is followed, in σ of what the lens makes of it."""
ACROSS, ALONG, STEPS = 61, 9, 12


@dataclass(frozen=True)
class SphereBound:
    """Errors of the radius in mm for light of σ `light_mm`, by centroids and by Gaussians, and the σ in px."""

    light_mm: float
    scale: float
    centroid_mm: float
    gaussian_mm: float
    section_px: float


def sphere_bound(
    light_mm: float = 0.22, *, seed: int = 11, scale: float = 0.5, diameter_mm: float = 50.0
) -> SphereBound:
    """Of the scan of a sphere, as `core.simulate` would render it, with light of σ `light_mm` at its focus."""
    exact = ExactScan.of(Scenario(object="sphere", height_mm=diameter_mm, seed=seed, scale=scale, frames=60))
    (sphere,) = exact.scene.spheres
    points: list[list[np.ndarray]] = [[], []]
    widths = []
    for sheet, curve in _stripes(exact):
        on = np.flatnonzero(np.abs(np.linalg.norm(curve.points - sphere.centre, axis=1) - sphere.radius) < 1e-3)[
            ::EVERY
        ]
        if not len(on):
            continue
        thin = replace(sheet, beam=replace(sheet.beam, sigma_mm=light_mm))
        offsets = _centres(exact, thin, curve, on)
        widths.append(offsets[2])
        for found, offset in zip(points, offsets, strict=False):
            rays = exact.rig.camera.rays(curve.uv[on] + offset[:, None] * curve.normal[on])
            found.append(rays / (rays @ sheet.plane.pi)[:, None])
    centroid, gaussian = (through(np.concatenate(found)).radius - sphere.radius for found in points)
    return SphereBound(light_mm, scale, centroid, gaussian, float(np.median(np.concatenate(widths))))


def _stripes(exact: ExactScan) -> Iterator[tuple[Sheet, Curve]]:
    """The light of every sheet of the scan, the fan's and the sweeps', stripe by stripe."""
    fan = fan_sheets(exact.rig, WORK_POINT)
    yield from ((fan[line], curve) for line, curve in zip(exact.fan_line, exact.fan, strict=True))
    yield from ((sheet, curve) for sheet, curves in zip(exact.sheets, exact.sweeps, strict=True) for curve in curves)


def _centres(exact: ExactScan, sheet: Sheet, curve: Curve, on: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
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
    """Light (N,) that the sphere seen at pixels `uv` (N, 2) sends back, by the law of `core.simulate.laser`."""
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


def table(lights_mm: tuple[float, ...] = (0.22, 0.16, 0.11, 0.055), seeds: tuple[int, ...] = (11, 5)) -> list[str]:
    """Errors of the radius by the light's width, in Markdown."""
    lines = [
        "| σ of the light, mm | resolution | σ in the picture, px | radius by centroids, by Gaussians, mm "
        f"| ≤ {GOAL_MM} |",
        "|---|---|---|---|---|",
    ]
    for scale in (0.5, 1.0):
        for light in lights_mm:
            found = [sphere_bound(light, seed=seed, scale=scale) for seed in seeds]
            told = "; ".join(f"{one.centroid_mm:+.4f}, {one.gaussian_mm:+.4f}" for one in found)
            worst = max(max(abs(one.centroid_mm), abs(one.gaussian_mm)) for one in found)
            keeps = "possible" if worst <= GOAL_MM else "**not**"
            lines.append(f"| {light:g} | {scale:g} | {found[0].section_px:.2f} | {told} | {keeps} |")
    return lines


if __name__ == "__main__":
    print("\n".join(table()))
