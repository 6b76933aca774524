"""The sentence on the laser's angles has as many digits as their uncertainty."""

import numpy as np

from core.calibrate.fan import verdict
from core.messages import ENGLISH
from core.translations import language


class _Fan:
    angles = np.radians([5.01234, 4.98765])
    angle_sds = np.radians([0.0123, 0.00045])


def test_angles_have_two_digits_of_their_uncertainty_in_every_language(monkeypatch):
    monkeypatch.setattr(verdict, "fan_of", lambda *_: _Fan)
    tied = verdict._Trial(None, 0.5, True)
    free = type("Free", (), {"planes": None, "covariance": None})
    told = verdict._sentence(object(), tied, tied, free, np.radians(5.0), 0.01, False)
    assert "5.012° ± 0.012°, 4.98765° ± 0.00045°" in ENGLISH(told)
    assert "5,012° ± 0,012°" in language("de")(told)
