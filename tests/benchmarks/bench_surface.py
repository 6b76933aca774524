"""From centrelines to the surface: network, fusion, mesh."""

from __future__ import annotations

import numpy as np

from core.scan.features.crossing_search import all_crossings
from core.scan.features.crossings import CrossingWindow
from core.scan.surface.cloud import Cloud
from core.scan.surface.fusion import fuse
from core.scan.surface.mesh import build_mesh
from core.scan.surface.normals import with_normals
from core.scan.sweeps.locate import locate_together, number_fan_lines, numbered
from core.simulate.scenario import Scenario
from tests.benchmarks.conftest import processor_ms, table
from tests.scan.centreline_scan import ExactScan

SIZE = (3840, 2748)


def test_a_network_of_300_sweeps(capsys):
    exact = ExactScan.of(Scenario(scale=0.5, frames=300))
    features = exact.measured(1)
    camera, fan = exact.rig.camera, exact.rig.fan
    lines = number_fan_lines(features.fan, features.crossings, camera, fan)
    crossings, line = numbered(features.crossings, lines)
    sweeps = [frame.centrelines for frame in features.frames]
    rows = {
        "all crossings found and fitted": processor_ms(
            lambda: all_crossings(features.fan, sweeps, CrossingWindow()), 2
        ),
        "lines of the fan numbered": processor_ms(
            lambda: number_fan_lines(features.fan, features.crossings, camera, fan), 1
        ),
        "300 light planes, with their covariance": processor_ms(
            lambda: locate_together(crossings, line, camera, fan), 1
        ),
    }
    rows["together"] = sum(rows.values())
    shown = {name: f"{ms / 1e3:6.2f} s" + "   (goal: 3 s)" * (name == "together") for name, ms in rows.items()}
    table(capsys, f"Network of 300 sweeps, {len(crossings)} crossings", shown)


def cloud_of(points: int) -> Cloud:
    """Stripes 1,900 px long across a block on a table, each in a sweep of its own."""
    rng = np.random.default_rng(0)
    along, sweep = np.arange(points) % 1900, np.arange(points) // 1900
    v = 400 + along * 1.0
    u = 300 + sweep / (sweep.max() + 1) * 3000 + 0.2 * (v - 1400) * np.sin(0.7 * sweep)
    x, y = (u - 1920) / 4300, (v - 1374) / 4300
    z = 560 - 50.0 * ((u > 1500) & (u < 2300) & (v > 1000) & (v < 1700)) + rng.normal(0, 0.01, points)
    flat = np.zeros(points)
    return Cloud(np.c_[x * z, y * z, z], np.c_[u, v], flat + 0.01, flat + 100.0, sweep, sweep, np.zeros((points, 3)))


def test_fusion_and_mesh_of_five_million_points(capsys):
    rows = {}
    for points in (500_000, 1_000_000, 2_500_000, 5_000_000):
        cloud = cloud_of(points)
        surface = with_normals(fuse(cloud, SIZE))
        fusing = processor_ms(lambda cloud=cloud: fuse(cloud, SIZE), 1)
        meshing = processor_ms(lambda surface=surface: build_mesh(with_normals(surface)), 1)
        rows[f"{points:>9,d} points to {len(surface):,d} cells"] = (
            f"{(fusing + meshing) / 1e3:6.2f} s: fusion {fusing / 1e3:.2f}, mesh {meshing / 1e3:.2f}   (goal: 5 s)"
        )
    table(capsys, "Fusion and mesh", rows)
