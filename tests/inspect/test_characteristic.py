import math

import pytest

from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Limits


@pytest.mark.parametrize(("value", "u"), [(math.nan, 0.01), (50.0, math.nan), (math.nan, math.nan)])
def test_what_is_not_known_proves_nothing(value, u):
    assert (
        Characteristic("thickness", "thickness", value, u, limits=Limits(50.0, -0.2, 0.2), doubts=()).verdict
        == "not proven"
    )


def test_without_limits_there_is_no_verdict():
    assert Characteristic("thickness", "thickness", 50.0, math.nan, doubts=()).verdict == ""


def test_a_form_has_an_upper_limit_only():
    form = Characteristic("flatness", "flatness", 0.01, 0.004, limits=Limits(0.0, -math.inf, 0.05), doubts=())
    assert (form.verdict, form.deviation) == ("conforming", 0.01)
