import math
from dataclasses import replace

import pytest

from core.inspect.causes import cause_named
from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Limits
from core.inspect.results import Contribution
from core.messages import plain
from tests.report.report_samples import block_content

INF = math.inf


@pytest.fixture(scope="session")
def content():
    """An inspection with a characteristic of every sort: of a length, a form, an angle, one-sided, not known."""
    budget = (
        Contribution(cause_named("noise, hand laser"), 0.004, 0.02),
        Contribution(cause_named("temperature of the part"), 0.003, 0.5, "rectangular", 8.0, 20.4, "°C"),
    )
    rows = (
        Characteristic("thickness", "thickness", 50.0123, 0.005, limits=Limits(50, -0.2, 0.2), budget=budget,
                       rule=plain("distance of two parallel planes"), doubts=()),
        Characteristic("Ebenheit größer", "flatness", 0.031, 0.004, limits=Limits(0, -INF, 0.05), doubts=()),
        Characteristic("flatness, free", "flatness", 0.031, 0.004, doubts=()),
        Characteristic("top to side", "angle", math.radians(89.95), math.radians(0.02), "angle", 3.0,
                       Limits(math.radians(90), math.radians(-0.2), math.radians(0.2)), doubts=()),
        Characteristic("=step(2)", "step height", 10.2, 0.01, limits=Limits(10, -0.05, 0.05), doubts=()),
        Characteristic("ball", "sphere diameter", 50.0, 0.02, limits=Limits(50, -0.1, INF), doubts=()),
        Characteristic("gap\nof two", "distance", math.nan, math.nan, limits=Limits(3, -INF, 0.03), doubts=()),
    )  # fmt: skip
    return replace(block_content(), gauge=None, inspected=rows, rig_id="0123456789ab")
