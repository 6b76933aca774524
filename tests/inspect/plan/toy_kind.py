"""A kind of feature that only tests know: all that adding one takes besides its entry in the manual."""

import numpy as np
import pytest

from core.inspect.causes import cause_named
from core.inspect.features.measured import FeatureResult, Scene
from core.inspect.features.regions import points_in
from core.inspect.plan import kinds
from core.inspect.plan.feature_kind import FeatureKind, ResultKind, TextField
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.results import Contribution
from core.messages import plain

TOY = FeatureKind(
    "cloudlet",
    "tests.inspect.plan.toy_kind:measure_toy",
    "Cloudlet, spread",
    "How far the points of a region lie apart",
    "mdi6.cloud",
    results=(ResultKind("spread", one_sided=True, expands=True), ResultKind("slope", "angle")),
    fields=(TextField("nominal_heights", "Heights", "A list of numbers."),),
)


def measure_toy(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    indices = points_in(spec.regions[0], spec.filters, scene)
    depth = scene.cloud.points[indices, 2]
    rows = (Contribution(cause_named("noise"), 0.01),)
    return FeatureResult(
        spec,
        characteristics=(
            scene.characteristic(spec, "spread", float(np.ptp(depth)), rows, rule=plain("range of the depths")),
            scene.characteristic(spec, "slope", 0.1, rows, rule=plain("made up")),
        ),
        indices=indices,
    )


@pytest.fixture
def toy(monkeypatch):
    monkeypatch.setattr(kinds, "KINDS", (*kinds.KINDS, TOY))
    return TOY
