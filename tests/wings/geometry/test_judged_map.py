"""A dent stands out of a map of deviations; an ideal part is not accused."""

import numpy as np
import pytest
import trimesh

from core.inspect.evaluate import evaluate
from core.inspect.plan.feature_spec import Deviation, FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.scan.surface.triangles import Triangles
from tests.inspect.fit.test_judged_form import AROUND_BALL, SEEDS, SHAPES, dented, notes
from tests.inspect.shape_scan import BALL, BALL_RADIUS


def map_of_ball(too_large_mm: float = 0.0) -> tuple[InspectionPlan, dict[str, Triangles]]:
    """A comparison with a ball that is smaller than the one scanned by so much in radius, and that ball."""
    compared = Deviation("ball.stl", "as measured", 0.1, 1.0)
    mesh = trimesh.creation.icosphere(subdivisions=5, radius=BALL_RADIUS - too_large_mm)
    nominals = {"ball.stl": Triangles(np.asarray(mesh.triangles) + BALL)}
    return InspectionPlan((FeatureSpec("map", "deviation", (AROUND_BALL,), deviation=compared),)), nominals


@pytest.mark.parametrize(("depth_mm", "word"), [(0.3, "too low"), (-0.3, "too high")])
def test_a_dent_stands_out_of_a_deviation_map(depth_mm: float, word: str) -> None:
    plan, nominals = map_of_ball(0.05)
    (note,) = notes(evaluate(plan, dented(3, depth_mm), errors=SHAPES.errors, nominals=nominals), "map")
    assert note.code == "form.off_nominal"
    assert "upper left" in str(note)
    assert word in str(note)
    assert 0.03 < note.values["mm"] < 0.3


@pytest.mark.parametrize("seed", SEEDS)
def test_an_ideal_map_is_not_accused(seed: int) -> None:
    cloud, (plan, nominals) = SHAPES.measure(np.random.default_rng(seed)), map_of_ball(0.05)
    assert notes(evaluate(plan, cloud, errors=SHAPES.errors, nominals=nominals), "map") == []
