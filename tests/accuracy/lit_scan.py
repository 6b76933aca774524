"""Exact scans of a sphere as light of some width shows them: centrelines where the light's centroid lies.

    scan = lit(ExactScan.of(Scenario("sphere", 50.0, seed, scale)))
    features = scan.measured(seed=1)

Stripes on the sphere lie beside their light planes, as `tests.accuracy.lit_sections` computes it pixel by pixel from
the simulator's law of light; their width and strength follow the slant, as they do in pictures.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.simulate.scene.laser import Sheet, fan_sheets
from core.simulate.scene.stage import WORK_POINT
from tests.accuracy.lit_sections import centres
from tests.scan.centreline_scan import Curve, ExactScan

EVERY = 6
"""The centre of the light is computed at every so many points of a stripe."""


def lit(exact: ExactScan, light_mm: float = 0.22) -> ExactScan:
    """The scan with every stripe where light of σ `light_mm` at its focus is seen."""

    def wide(sheet: Sheet) -> Sheet:
        return replace(sheet, beam=replace(sheet.beam, sigma_mm=light_mm))

    fan = [wide(sheet) for sheet in fan_sheets(exact.rig, WORK_POINT)]
    return replace(
        exact,
        fan=tuple(_lit(exact, fan[line], curve) for line, curve in zip(exact.fan_line, exact.fan, strict=True)),
        sweeps=tuple(
            tuple(_lit(exact, wide(sheet), curve) for curve in curves)
            for sheet, curves in zip(exact.sheets, exact.sweeps, strict=True)
        ),
    )


def _lit(exact: ExactScan, sheet: Sheet, curve: Curve) -> Curve:
    (sphere,) = exact.scene.spheres
    outward = (curve.points - sphere.centre) / sphere.radius
    of_sphere = np.abs(np.linalg.norm(outward, axis=1) - 1) < 1e-4
    assert exact.scene.pose_cam_table is not None
    table = exact.scene.pose_cam_table.rotation[:, 2]
    normal = np.where(of_sphere[:, None], outward, table)
    rays = curve.points / curve.points[:, 2:]
    jacobian = exact.rig.camera.ray_jacobian(rays)
    ray = np.column_stack([np.einsum("nij,nj->ni", jacobian, curve.normal), np.zeros(len(rays))])
    depth = -curve.points[:, 2] * (normal * ray).sum(axis=1) / (normal * rays).sum(axis=1)
    slope = (depth[:, None] * rays + curve.points[:, 2:] * ray) @ sheet.plane.normal
    towards = sheet.emitter - curve.points
    distance = np.linalg.norm(towards, axis=1)
    beam = sheet.beam
    sigma = beam.sigma_mm * np.hypot(1, (distance - beam.focus_mm) / beam.rayleigh_mm)
    angle = np.arccos(np.clip(-towards @ sheet.axis / distance, -1, 1))
    own = sigma / np.abs(slope)
    width = np.hypot(own, exact.rig.blur_px)
    light = (normal * towards).sum(axis=1) / distance**2 / sigma * np.exp(-2 * (angle / beam.half_angle) ** 2)
    off = np.zeros(len(curve.uv))
    on = np.flatnonzero(of_sphere)
    if len(on):
        some = on[::EVERY]
        off[on] = np.interp(on, some, centres(exact, sheet, curve, some)[0])
    strength = 1e7 * np.maximum(light, 1e-9) * own / width
    return replace(curve, uv=curve.uv + off[:, None] * curve.normal, width=width, strength=strength)
