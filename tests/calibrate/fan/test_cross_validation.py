"""What the poses foretell of each other, by one step from the fit of all, against fits anew."""

import numpy as np
import pytest

from core.calibrate.fan import calibration
from core.calibrate.fan.bundle import solve
from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.calibrate.fan.cross_validation import predict
from core.calibrate.fan.stripe_distances import Stripes
from tests.calibrate.fan_scenes import ALPHA, CAMERA, GRID, PAPER, Noise, features, poses


@pytest.mark.accuracy
@pytest.mark.parametrize(("count", "lines", "corner_px"), [(6, 3, 0.02), (7, 1, 0.02), (9, 3, 0.1)])
def test_one_step_tells_what_fits_anew_tell(monkeypatch, count, lines, corner_px):
    asked = {}

    def remembered(used, on_poses, camera, plate=None):
        asked.update(used=used, poses=on_poses)
        return predict(used, on_poses, camera, plate)

    monkeypatch.setattr(calibration, "predict", remembered)
    seen = features(poses(count, 1), Noise(corner_px), 20, pis=PAPER[:lines], points=GRID)
    result = fit_fan(seen, CAMERA, FanOptions(lines, ALPHA if lines > 1 else None))
    anew = []
    for index, pose in enumerate(asked["poses"]):
        others = [other for number, other in enumerate(asked["poses"]) if number != index]
        planes = solve(asked["used"].planes, others, CAMERA).planes
        off = Stripes([pose.stripes], [pose.pose]).distances(planes, [pose.pose], np.zeros(10)).mm
        anew.append(np.sqrt((off**2).mean()))
    by_step = np.array([pose.prediction_mm for pose in result.poses])
    scale = np.sqrt(np.mean(np.square(anew)))
    assert result.cross_validation_mm == pytest.approx(scale, rel=0.05)
    assert np.abs(by_step - anew).max() < 0.25 * scale
