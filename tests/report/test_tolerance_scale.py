import math

import pytest

from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Limits
from core.report.tolerance_scale import ToleranceScale

LIMITS = Limits(50.0, -0.1, 0.2)


def result(value=50.05, u=0.01, limits=LIMITS, **more):
    return Characteristic("thickness", "thickness", value, u, limits=limits, doubts=(), **more)


def test_the_nominal_value_is_in_the_middle_and_everything_is_on_the_scale_in_its_order():
    scale = ToleranceScale.of(result())
    assert scale.share(0.0) == 0.5
    places = [scale.share(x) for x in (scale.lower, 0.0, scale.deviation - scale.U, scale.deviation, scale.upper)]
    assert places == sorted(places) and places[0] > 0 and places[-1] < 1


def test_a_value_far_outside_is_on_the_scale_with_its_interval_and_an_open_side_reaches_its_end():
    scale = ToleranceScale.of(result(value=53.0, limits=Limits(50.0, -math.inf, 0.2)))
    assert scale.share(scale.deviation + scale.U) < 1 and scale.share(scale.lower) == 0 and scale.limits == (0.2,)


def test_an_angle_is_on_it_in_degrees():
    angle = result(
        value=math.radians(90.5), u=math.radians(0.05), quantity="angle", limits=Limits(math.radians(90), -1, 1)
    )
    assert ToleranceScale.of(angle).deviation_text() == "deviation +0.50 ° ± 0.10 °"


@pytest.mark.parametrize("one", [result(limits=None), result(u=math.inf), result(value=math.nan)])
def test_there_is_none_without_limits_or_where_something_is_not_known(one):
    assert ToleranceScale.of(one) is None
