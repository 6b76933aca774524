"""What the width of the light forbids on a sphere: its radius with no noise at all, from sections as they truly are.

Camera, light planes and crossings are exact here and there is no speckle; a stripe is found only as well as its light
lies. Across a stripe the light of a sheet of σ_mm falls on a surface that turns away, so the section's middle is not
where the sheet's middle plane meets the surface (`core.image.stripes.shading`). For every point of every stripe the
picture of
its surroundings is computed by the simulator's own law of light, blurred by the lens, and its centre is found twice:

- as the centroid of the light, which is what a likelihood under speckle trusts (all of the section counts alike);
- as the best Gaussian by least squares, which is what one under even noise trusts (the crest counts).

Nothing in one section tells that it lies uneven: it stays a Gaussian. What the radius is then off by falls with the
square of the light's width and hardly with the camera's resolution. But the surface that has been found tells it, and
`core.scan.bend_correction` takes it off: `solved` is what whole scans of such stripes give, all but without noise,
before and after. `python -m tests.accuracy.sphere_bound` prints both.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from core.inspect.fit.round import sphere_through
from core.scan.bend_correction import corrected_for_bends
from core.scan.reconstruct import reconstruct
from core.scan.results import ScanResult
from core.scan.sweeps.fan_lines import FanLines
from core.simulate.scenario import Scenario
from core.simulate.scene.laser import Sheet, fan_sheets
from core.simulate.scene.stage import WORK_POINT
from tests.accuracy.lit_scan import lit
from tests.accuracy.lit_sections import centres
from tests.scan.centreline_scan import Curve, ExactScan, Noise

GOAL_MM = 0.015
"""Of the radius: 0.03 mm in diameter."""
FAINT = 0.1
"""Noise of the scans that are solved, as a share of what pictures have: next to none."""
ON_SPHERE_MM = 0.3
EVERY = 4
"""Every so many points of a stripe are looked at."""


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
        offsets = centres(exact, thin, curve, on)
        widths.append(offsets[2])
        for found, offset in zip(points, offsets, strict=False):
            rays = exact.rig.camera.rays(curve.uv[on] + offset[:, None] * curve.normal[on])
            found.append(rays / (rays @ sheet.plane.pi)[:, None])
    centroid, gaussian = (sphere_through(np.concatenate(found)).radius - sphere.radius for found in points)
    return SphereBound(light_mm, scale, centroid, gaussian, float(np.median(np.concatenate(widths))))


def _stripes(exact: ExactScan) -> Iterator[tuple[Sheet, Curve]]:
    """The light of every sheet of the scan, the fan's and the sweeps', stripe by stripe."""
    fan = fan_sheets(exact.rig, WORK_POINT)
    yield from ((fan[line], curve) for line, curve in zip(exact.fan_line, exact.fan, strict=True))
    yield from ((sheet, curve) for sheet, curves in zip(exact.sheets, exact.sweeps, strict=True) for curve in curves)


def solved(light_mm: float = 0.22, *, seed: int = 11, scale: float = 0.5, frames: int = 60) -> tuple[float, float]:
    """Errors in mm of the radius of a sphere of 50 mm as a scan gives it that is solved once, and twice."""
    exact = ExactScan.of(Scenario(object="sphere", height_mm=50.0, seed=seed, scale=scale, frames=frames))
    rig, lines = exact.rig, FanLines.settled_as(exact.fan_line)
    faint = Noise.of_twin(scale)
    faint = replace(faint, sweep_px=FAINT * faint.sweep_px, fan_px=FAINT * faint.fan_px)
    features = lit(exact, light_mm).measured(1, faint)
    once = reconstruct(features, rig.camera, rig.fan, fan_lines=lines)
    twice = reconstruct(corrected_for_bends(features, once, rig.camera, rig.fan), rig.camera, rig.fan, fan_lines=lines)
    return _error(exact, once), _error(exact, twice)


def _error(exact: ExactScan, scan: ScanResult) -> float:
    (sphere,) = exact.scene.spheres
    off = np.abs(np.linalg.norm(scan.cloud.points - sphere.centre, axis=1) - sphere.radius)
    on = off < ON_SPHERE_MM
    return sphere_through(scan.cloud.points[on]).radius - sphere.radius


def table(lights_mm: tuple[float, ...] = (0.22, 0.16, 0.11, 0.055), seeds: tuple[int, ...] = (11, 5)) -> list[str]:
    """Errors of the radius by the light's width, in Markdown."""
    lines = [
        "| σ of the light, mm | resolution | σ in the picture, px | radius by centroids, by Gaussians, mm "
        "| scan solved once, twice, mm "
        f"| ≤ {GOAL_MM} once | twice |",
        "|---|---|---|---|---|---|---|",
    ]
    for scale in (0.5, 1.0):
        for light in lights_mm:
            found = [sphere_bound(light, seed=seed, scale=scale) for seed in seeds]
            told = "; ".join(f"{one.centroid_mm:+.4f}, {one.gaussian_mm:+.4f}" for one in found)
            scans = [solved(light, seed=seed, scale=scale) for seed in seeds]
            of_scans = "; ".join(f"{once:+.4f}, {twice:+.4f}" for once, twice in scans)
            kept = " | ".join(_kept(max(abs(scan[k]) for scan in scans)) for k in range(2))
            lines.append(f"| {light:g} | {scale:g} | {found[0].section_px:.2f} | {told} | {of_scans} | {kept} |")
    return lines


def _kept(worst: float) -> str:
    return "possible" if worst <= GOAL_MM else "**not**"


if __name__ == "__main__":
    print("\n".join(table()))
