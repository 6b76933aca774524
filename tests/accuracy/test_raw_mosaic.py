"""A colour camera's raw mosaic: is a thickness by the sites that see the laser as true as it says, and what is lost?

Whole sets at half the full size, against the same rig with a sensor without a mosaic.
"""

import numpy as np
import pytest

from core.simulate.effects.sensor import SensorEffects
from core.simulate.scenario import Scenario
from tests.accuracy.twin import calibrated_once, measure

RAW, GREY = SensorEffects(colour=True, raw=True), SensorEffects()
MOST_LOST = 2.5
"""Times the σ of points with all pixels: a quarter of them gives 2, and stripes half as wide in their px some more."""

LEAST_WITHIN = 0.88
"""Share of the points within 2 σ: one calibration decides about all points of its scan, so 95 % hold over many only."""


@pytest.mark.accuracy
def test_a_raw_mosaic_measures_as_true_as_it_says(tmp_path, tmp_path_factory, seed=1):
    sigmas = []
    for name, sensor in (("grey", GREY), ("raw", RAW)):
        calibrated = calibrated_once(tmp_path_factory, Scenario(scale=0.5, sensor=sensor, seed=seed))
        found = measure(Scenario(scale=0.5, frames=48, sensor=sensor, seed=seed), tmp_path / name, calibrated)
        error = found.gauge.thickness_mm - 50.0
        depth, sigma = found.depth_errors(), found.cloud.sigma
        within = np.abs(depth[np.isfinite(depth)]) <= 2 * sigma[np.isfinite(depth)]
        print(
            f"{name}: {1e3 * error:+.0f} ± {1e3 * found.gauge.U_mm:.0f} µm, {len(depth)} points, "
            f"σ {1e3 * np.median(sigma):.0f} µm, {within.mean():.1%} within 2 σ"
        )
        assert abs(error) <= found.gauge.U_mm
        assert within.mean() > LEAST_WITHIN
        sigmas.append(np.median(sigma))
    assert sigmas[1] < MOST_LOST * sigmas[0]
