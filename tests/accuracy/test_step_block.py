"""The 40/50/60/70 stepped block: every level found, every height as near to the truth as stated."""

import numpy as np
import pytest

from core.inspect.evaluate import evaluate
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.uncertainty.point_errors import PointErrors
from core.scan.reconstruct import reconstruct
from core.scan.surface.normals import with_normals
from core.scan.sweeps.fan_lines import FanLines
from core.simulate.scenario import Scenario
from tests.scan.centreline_scan import ExactScan

HEIGHTS = np.array([40.0, 50.0, 60.0, 70.0])


@pytest.mark.accuracy
def test_heights_of_all_levels_are_as_sure_as_they_say():
    exact = ExactScan.of(Scenario(object="steps", seed=5, scale=0.5, frames=60))
    plan = InspectionPlan((FeatureSpec("block", "steps", nominal_heights=tuple(HEIGHTS)),))
    relative = []
    for seed in range(5):
        features = exact.measured(seed=seed)
        scan = reconstruct(features, exact.rig.camera, exact.rig.fan, fan_lines=FanLines.settled_as(exact.fan_line))
        errors = PointErrors.of_scan(features, scan.covariance, None, scan.speckle)
        rows = evaluate(plan, with_normals(scan.cloud), errors=errors).characteristics
        assert len(rows) == len(HEIGHTS)
        found, stated = np.array([row.value for row in rows]), np.array([row.u for row in rows])
        assert np.abs(found - HEIGHTS).max() < 0.05
        relative.append((found - HEIGHTS) / stated)
    assert 0.6 < np.sqrt(np.mean(np.square(relative))) < 1.5
