"""Every way to measure a height errs as much as it says: scans of one block drawn anew, error over stated u about 1.

Spheres, cylinders, their distances and angles are in test_shape_features, flatness in test_evaluate, deviations from a
nominal surface in test_deviation.
"""

import numpy as np
import pytest

from core.inspect.evaluate import evaluate
from core.inspect.plan.feature_spec import Cut, FeatureSpec, InSphere, Polygon, Section
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.uncertainty.point_errors import PointErrors
from tests.inspect.block_scan import NORMAL, TABLE_MM, BlockScan

SEEDS = range(5)
BLOCK = BlockScan(sweeps=12)
TOP, BELOW = (Polygon(tuple((float(u), float(v)) for u, v in polygon)) for polygon in BLOCK.polygons)
X, Y, Z = ((TABLE_MM - 40.0) * NORMAL).tolist()
CUT = Section(
    line_px=((760.0, 1300.0), (1400.0, 1350.0)),
    half_width_mm=3.0,
    cuts=(Cut("rise", "height", (2.0, 20.0), (50.0, 70.0)),),
)
PLAN = InspectionPlan(
    (
        FeatureSpec("block", "thickness", (TOP, BELOW)),
        FeatureSpec("step", "steps"),
        FeatureSpec("cut", "section", section=CUT),
        FeatureSpec("table", "plane"),
        FeatureSpec("spot", "point", (InSphere((X, Y, Z), 8.0),)),
        FeatureSpec("spot over table", "distance", of=("spot", "table")),
    )
)
HEIGHTS = ("block thickness", "step height 1", "cut rise", "spot over table distance")


@pytest.fixture(scope="module")
def relative():
    """Errors over stated standard uncertainties, by the characteristic."""
    errors, found = PointErrors(BLOCK.covariance), {name: [] for name in HEIGHTS}
    for seed in SEEDS:
        inspection = evaluate(PLAN, BLOCK.measure(np.random.default_rng(seed)), errors=errors)
        assert inspection.problems == ()
        for row in inspection.characteristics:
            if row.name in found:
                found[row.name].append((row.value - 40.0) / row.u)
    return found


@pytest.mark.accuracy
@pytest.mark.parametrize("name", HEIGHTS)
def test_errors_of_heights_are_as_large_as_stated(relative, name):
    assert len(relative[name]) == len(SEEDS)
    spread = float(np.sqrt(np.mean(np.square(relative[name]))))
    assert 0.4 < spread < 1.7, relative[name]


@pytest.mark.accuracy
def test_all_together_they_are_neither_too_sure_nor_too_unsure(relative):
    together = float(np.sqrt(np.mean(np.square(list(relative.values())))))
    assert 0.6 < together < 1.35, relative
