"""The fan's own points and the sweeps' planes are wrong by the same cells: against sampling."""

import numpy as np
import pytest

from core.image.stripes.lines.smoothing import smooth
from core.image.stripes.runs import arc_length
from core.scan.network.fan_speckle import fan_speckle
from core.simulate.scenario import Scenario
from tests.scan.centreline_scan import ExactScan, Noise

CELL_PX = 40.0
NO_CELLS = np.zeros((0, 2), dtype=np.int64)


@pytest.fixture(scope="module")
def exact():
    return ExactScan.of(Scenario(height_mm=50.0, seed=4, scale=0.5, frames=24))


@pytest.mark.accuracy
def test_means_of_the_fans_points_are_off_by_what_their_cells_say(exact):
    """Of single points the choice of windows, which hangs on their noise, leaves more."""
    camera, fan, noise = exact.rig.camera, exact.rig.fan, Noise.of_twin(0.5)
    rng, errors, told = np.random.default_rng(1), [], []
    for _ in range(10):
        for curve, line in zip(exact.fan, exact.fan_line, strict=True):
            raw = curve.measured(noise.fan_px, noise.correlation_px, rng)
            smoothed = smooth(raw)
            speckle = fan_speckle([smoothed], [fan.planes[line]], camera, CELL_PX, NO_CELLS, np.zeros((0, 0)))
            assert speckle.cell[-1] == arc_length(curve.uv)[-1] // CELL_PX

            def mean(values, cells=speckle.cell, members=speckle.members):
                return np.bincount(cells, values) / members

            z = mean(((raw.uv - curve.uv) * curve.normal).sum(axis=1))
            z /= noise.fan_px * np.sqrt(noise.correlation_px / speckle.members)
            depth, true = (1 / (camera.rays(uv) @ fan.planes[line].pi) for uv in (smoothed.uv, curve.uv))
            along = np.minimum(speckle.first[:, None] + np.arange(speckle.shares.shape[1]), len(z) - 1)
            errors.append(mean(depth - true))
            told.append(mean((speckle.shares * z[along]).sum(axis=1)))
    error, told = np.concatenate(errors), np.concatenate(told)
    assert (error @ told) / (told @ told) == pytest.approx(1.0, abs=0.05)
    assert np.corrcoef(error, told)[0, 1] > 0.9


def test_points_of_the_fan_are_known_again_in_the_picture(exact):
    piece = smooth(exact.fan[0].measured(0.08, 7.2, np.random.default_rng(2)))
    plane = exact.rig.fan.planes[exact.fan_line[0]]
    speckle = fan_speckle([piece], [plane], exact.rig.camera, CELL_PX, NO_CELLS, np.zeros((0, 0)))
    assert np.array_equal(speckle.places(piece.uv[::-7].astype(np.float32)), np.arange(len(piece))[::-7])
    assert (speckle.places(piece.uv + 5 * piece.normal) == -1).all()
    assert len(fan_speckle([piece], [None], exact.rig.camera, CELL_PX, NO_CELLS, np.zeros((0, 0))).cell) == 0
