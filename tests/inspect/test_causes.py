"""Causes are known again by what earlier versions called them."""

import pytest

from core.inspect.causes import Cause, cause_named


@pytest.mark.parametrize(
    ("earlier", "cause"),
    [
        ("centreline noise of the sweeps' points", Cause.POINT_NOISE),
        ("light planes of the sweeps (network)", Cause.SWEEP_PLANES),
        ("centreline noise of the fan's points (speckle)", Cause.FAN_SPECKLE),
        ("form of the faces beyond the stated noise", Cause.FORM),
    ],
)
def test_a_cause_is_known_by_what_it_was_called_before(earlier, cause):
    assert cause_named(earlier) == cause_named(str(cause)) == cause
