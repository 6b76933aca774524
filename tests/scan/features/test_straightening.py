"""Crossings as a lens without distortion would show them."""

import numpy as np
import pytest

from core.scan.features.crossing_search import all_crossings
from core.scan.features.crossings import CrossingWindow
from core.scan.features.straightening import bent_back, straightened
from core.simulate.scenario import Scenario
from tests.scan.centreline_scan import ExactCrossings, ExactScan


@pytest.fixture(scope="module")
def scan():
    return ExactScan.of(Scenario(scale=0.5, frames=30))


def test_light_on_a_flat_face_becomes_a_straight_line(scan):
    pieces = [curve.measured(1e-6, 7.0, np.random.default_rng(1)) for curve in scan.fan]
    for piece, straight in zip(pieces, straightened(pieces, scan.rig.camera), strict=True):
        bends = []
        for line in (piece, straight):
            fitted = np.polynomial.Polynomial.fit(line.uv[:, 0], line.uv[:, 1], 1)
            bends.append(np.abs(fitted(line.uv[:, 0]) - line.uv[:, 1]).max())
        assert bends[1] < 1e-4
        assert bends[0] > 100 * bends[1]


def test_back_in_the_picture_crossings_lie_where_lines_meet(scan):
    """Without noise both ways find the same places, tangents and σ."""
    camera, rng = scan.rig.camera, np.random.default_rng(1)
    fan = [curve.measured(1e-6, 7.0, rng) for curve in scan.fan]
    sweeps = [[curve.measured(1e-6, 7.0, rng) for curve in curves] for curves in scan.sweeps]
    window = CrossingWindow(half_length_px=10.0)
    plain = all_crossings(fan, sweeps, window)
    straight = [straightened(pieces, camera) for pieces in sweeps]
    there = all_crossings(straightened(fan, camera), straight, window)
    back = bent_back(there, camera)
    assert len(back) == len(plain)
    assert np.abs(back.uv - plain.uv).max() < 2e-3
    assert np.abs(back.tangent_a - plain.tangent_a).max() < 1e-3
    assert np.abs(there.uv - plain.uv).max() > 0.5
    assert np.abs(np.linalg.norm(back.tangent_b, axis=1) - 1).max() < 1e-12


@pytest.mark.accuracy
def test_the_lens_leaves_no_common_error_in_crossings_with_the_fan(scan):
    """The mean error of all crossings with the fan over many scans: with distorted lines half a standard deviation."""
    true = ExactCrossings.of(scan).table
    names = np.column_stack([true.a, true.b, true.piece_a, true.piece_b]).tolist()
    keys = {tuple(name): m for m, name in enumerate(names)}
    off = []
    for seed in range(16):
        table = scan.measured(seed, smoothed=False).crossings
        names = np.column_stack([table.a, table.b, table.piece_a, table.piece_b]).tolist()
        for m, name in enumerate(names):
            k = keys.get(tuple(name))
            if table.b[m] < 0 and k is not None and np.linalg.norm(table.uv[m] - true.uv[k]) < 2:
                across = np.array([-true.tangent_b[k, 1], true.tangent_b[k, 0]])
                off.append((table.uv[m] - true.uv[k]) @ across / table.sigma_b[m])
    assert len(off) > 200
    assert abs(np.mean(off)) < 0.22
