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
    assert (found.radius_mm, found.name) == (known.radius_mm, known.name)


def test_a_carrier_is_of_the_rigs_scale_only_where_that_is_stated(tmp_path):
    text = "radius_mm = 4.0\n[[mark]]\nnumber = 3\nposition_mm = [1, 2, 3]\nu_mm = [0.1, 0.2, 0.3]\n"
    for head, scaled in (("", False), ("scaled_by_target = false\n", False), ("scaled_by_target = true\n", True)):
        (tmp_path / "carrier.toml").write_text(head + text, encoding="utf-8")
        assert read_carrier(tmp_path / "carrier.toml").scaled_by_target is scaled


def test_without_a_covariance_each_mark_errs_by_its_own_u(tmp_path):
    text = "radius_mm = 4.0\n[[mark]]\nnumber = 3\nposition_mm = [1, 2, 3]\nu_mm = [0.1, 0.2, 0.3]\n"
    (tmp_path / "carrier.toml").write_text(text, encoding="utf-8")
    assert np.diag(read_carrier(tmp_path / "carrier.toml").covariance) == pytest.approx([0.01, 0.04, 0.09])


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("radius_mm = 4.0", "radius_mm = -1"), "radius_mm is -1, not a length in mm above 0"),
        (("radius_mm", 'kind = "ball"\nradius_mm'), 'kind is "ball", not "ring": balls are not found in views yet'),
        (("number = 3", "number = 3\nsides = 1"), "sides is an unknown key"),
        (("[[mark]]", "celsius = 25.0\n[[mark]]"), "u_celsius is missing"),
        (("number = 3", "number = 61"), r"there is no coded ring 61: their numbers are 0 to 60; have the marks"),
        (("number = 3", "number = 1" + 30 * "0"), r"mark\[0\]\.number is 10+, not a whole number from 0 to 999"),
        (("0.2, 0.3", "0.0, 0.3"), r"mark\[0\]\.u_mm\[1\] is 0.0, but .* three lengths in mm above 0, up to 100"),
        (("0.2, 0.3", "-0.2, 0.3"), r"mark\[0\]\.u_mm\[1\] is -0.2, but .* three lengths in mm above 0, up to 100"),
        (("0.2, 0.3", "1e200, 0.3"), r"u_mm\[1\] is 1e\+200, but .* up to 100"),
        (("0.2, 0.3", "nan, 0.3"), r"u_mm\[1\] is NaN, but .* up to 100"),
        (("[1, 2, 3]", "[1, 2, 3e30]"), r"position_mm\[2\] is 3e\+30, but .*within 10 m"),
        (
            ("[[mark]]", "covariance_mm2 = [[1e9]]\n[[mark]]"),
            r"covariance_mm2\[0\]\[0\] is 1000000000.0, but .* rows of numbers",
        ),
        (
            ("[[mark]]", "covariance_mm2 = [[0, 0, 0], [0, 1, 0], [0, 0, 1]]\n[[mark]]"),
            "covariance_mm2 is no covariance",
        ),
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
