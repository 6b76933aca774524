"""Grades of a calibration and their limits."""

import pytest

from core.calibrate.camera.missing import CAMERA_VIEWS
from core.calibrate.grades import VIEWS, Grade, Limit


@pytest.mark.parametrize(
    ("value", "expected"),
    [(0.0, Grade.POOR), (14.9, Grade.POOR), (15.0, Grade.FAIR), (29.9, Grade.FAIR), (30.0, Grade.GOOD)],
)
def test_a_value_is_good_from_its_limit_on_and_poor_below_half_of_it(value: float, expected: Grade) -> None:
    assert Limit(30.0).grade(value) is expected


def test_what_the_advice_calls_enough_is_what_is_graded_good() -> None:
    assert VIEWS.grade(CAMERA_VIEWS.enough) is Grade.GOOD and VIEWS.grade(CAMERA_VIEWS.enough - 1) is Grade.FAIR
