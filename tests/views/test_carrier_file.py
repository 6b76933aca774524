"""carrier.toml: what is written is read, and what is wrong is told."""

from dataclasses import replace

import numpy as np
import pytest

from core.errors import InputError
from core.files.recording.carrier_file import read_carrier, write_carrier
from core.inspect.uncertainty.part import TargetTemperature
from tests.views.made import carrier


def test_a_carrier_is_read_as_it_was_written(tmp_path):
    known = replace(carrier(), temperature=TargetTemperature(21.5, 0.5, 23e-6, 1e-6), as_printed=True)
    write_carrier(tmp_path / "carrier.toml", known)
    found = read_carrier(tmp_path / "carrier.toml")
    assert found.positions == pytest.approx(known.positions, abs=1e-6)
    assert found.covariance == pytest.approx(known.covariance, rel=1e-5)
    assert (found.numbers == known.numbers).all()
    assert (found.sides == known.sides).all()
    assert (found.temperature, found.as_printed) == (known.temperature, True)
    assert (found.radius_mm, found.kind, found.name) == (known.radius_mm, known.kind, known.name)


def test_without_a_covariance_each_mark_errs_by_its_own_u(tmp_path):
    text = "radius_mm = 4.0\n[[mark]]\nnumber = 3\nposition_mm = [1, 2, 3]\nu_mm = [0.1, 0.2, 0.3]\n"
    (tmp_path / "carrier.toml").write_text(text, encoding="utf-8")
    assert np.diag(read_carrier(tmp_path / "carrier.toml").covariance) == pytest.approx([0.01, 0.04, 0.09])


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("radius_mm = 4.0", "radius_mm = -1"), "radius_mm is -1, not a length in mm above 0"),
        (("number = 3", "number = 3\nsides = 1"), "sides is an unknown key"),
        (("[[mark]]", "celsius = 25.0\n[[mark]]"), "u_celsius is missing"),
        (("[[mark]]", "covariance_mm2 = [[1.0]]\n[[mark]]"), "covariance_mm2 is not 3 × 3 for 1 marks"),
    ],
)
def test_what_is_wrong_in_it_is_told_with_its_field(tmp_path, change, told):
    text = "radius_mm = 4.0\n[[mark]]\nnumber = 3\nposition_mm = [1, 2, 3]\nu_mm = [0.1, 0.2, 0.3]\n"
    (tmp_path / "carrier.toml").write_text(text.replace(*change), encoding="utf-8")
    with pytest.raises(InputError, match=told):
        read_carrier(tmp_path / "carrier.toml")


def test_a_missing_carrier_is_told(tmp_path):
    with pytest.raises(InputError, match=r"there is no carrier\.toml"):
        read_carrier(tmp_path / "carrier.toml")
