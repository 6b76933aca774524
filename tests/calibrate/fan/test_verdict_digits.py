"""The sentence on the laser's angles has as many digits as their uncertainty."""

import numpy as np
import pytest

from core.calibrate.fan import verdict
from core.calibrate.fan.pencil import FreePlanes
from core.messages import ENGLISH
from core.translations import language


class _Fan:
    angles = np.radians([5.01234, 4.98765])
    angle_sds = np.radians([0.0123, 0.00045])


def test_angles_have_two_digits_of_their_uncertainty_in_every_language(monkeypatch):
    monkeypatch.setattr(verdict, "fan_of", lambda *_: _Fan)
    tied = verdict._Trial(None, 0.5, True)
    free = type("Free", (), {"planes": None, "covariance": None})
    told = verdict._sentence(object(), tied, tied, free, np.radians(5.0), (0.012345, 0.00123), False)
    assert "5.012° (u = 0.012°), 4.98765° (u = 0.00045°)" in ENGLISH(told)
    assert "up to 0.0123 mm" in ENGLISH(told) and "0,0123 mm" in language("de")(told)


def test_how_far_planes_miss_one_axis_is_as_uncertain_as_they_are_there():
    """A plane at 1000 mm, known to 0.01 mm at its middle, against one that is 0.2 mm nearer."""
    pis, near = np.array([[0.0, 0.0, 1e-3]]), np.array([[0.0, 0.0, 1 / 999.8]])
    free = type("Free", (), {"planes": FreePlanes(pis), "covariance": np.diag([0.0, 0.0, 1e-8**2])})
    gap, sd = verdict._gap(free, FreePlanes(near), [np.array([[0.0, 0.0, 1000.0]])])
    assert gap == pytest.approx(0.2) and sd == pytest.approx(0.01)
