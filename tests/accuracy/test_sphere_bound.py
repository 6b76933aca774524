"""How well the radius of a sphere can be known with light of some width, without any noise."""

from tests.accuracy.sphere_bound import GOAL_MM, sphere_bound


def test_light_as_wide_as_the_papers_makes_a_sphere_of_50_mm_too_small_by_the_goal_whatever_the_resolution():
    half, full = (sphere_bound(0.22, scale=scale) for scale in (0.5, 1.0))
    for bound in (half, full):
        assert -0.022 < bound.centroid_mm < bound.gaussian_mm < -0.8 * GOAL_MM
    assert abs(full.centroid_mm - half.centroid_mm) < 0.004


def test_narrow_light_leaves_room_for_the_goal():
    assert abs(sphere_bound(0.055).centroid_mm) < 0.4 * GOAL_MM
