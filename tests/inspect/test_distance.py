"""The distance of two points: its uncertainty is what drawing both of them again and again gives."""

import numpy as np
import pytest

from core.inspect.distance import point_distance


def test_the_distance_is_euclidean():
    assert point_distance([1, 2, 500], [4, 6, 512], 0.01, 0.01).distance_mm == pytest.approx(13.0)


@pytest.mark.parametrize(
    ("a", "b"),
    [
        ([0.0, 0.0, 500.0], [0.0, 0.0, 550.0]),
        ([-40.0, 20.0, 500.0], [60.0, -10.0, 530.0]),
        ([80.0, 60.0, 480.0], [82.0, 61.0, 560.0]),
        ([-60.0, 0.0, 520.0], [60.0, 0.0, 520.0]),
    ],
)
def test_the_uncertainty_is_the_scatter_of_drawn_points(a, b):
    sigma_a, sigma_b = 0.02, 0.05
    rng = np.random.default_rng(1)
    count = 40_000
    first = np.array(a) * (1 + sigma_a / a[2] * rng.standard_normal((count, 1)))
    second = np.array(b) * (1 + sigma_b / b[2] * rng.standard_normal((count, 1)))
    scatter = np.linalg.norm(second - first, axis=1).std()
    assert point_distance(a, b, sigma_a, sigma_b).u_mm == pytest.approx(scatter, rel=0.02)


def test_it_is_the_same_both_ways():
    a, b = [3.0, 4.0, 500.0], [10.0, -7.0, 540.0]
    there, back = point_distance(a, b, 0.01, 0.03), point_distance(b, a, 0.03, 0.01)
    assert there.distance_mm == pytest.approx(back.distance_mm)
    assert there.u_mm == pytest.approx(back.u_mm)


@pytest.mark.parametrize(
    ("a", "b", "sigma"),
    [
        ([1.0, 2.0, 500.0], [1.0, 2.0, 500.0], 0.01),
        ([1.0, 2.0, -5.0], [1.0, 2.0, 500.0], 0.01),
        ([1.0, 2.0, 500.0], [1.0, 2.0, np.nan], 0.01),
        ([1.0, 2.0, 500.0], [1.0, 2.0, 510.0], -0.01),
        ([1.0, 2.0, 500.0], [1.0, 2.0, 510.0], np.nan),
    ],
)
def test_what_is_no_distance_is_refused(a, b, sigma):
    with pytest.raises(ValueError, match=r"points|σ"):
        point_distance(a, b, sigma, 0.01)
