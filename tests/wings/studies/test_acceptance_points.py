"""Spheres and planes with known form, against what the guideline's definitions give."""

import numpy as np
import pytest

from core.wings.studies.kinds.acceptance import probed_flatness, probed_sphere

CENTRE, RADIUS = np.array([10.0, -20.0, 550.0]), 15.0


def cap(n=5000, seed=0, *, opening=1.2):
    """Directions on the side of a sphere that faces the camera."""
    rng = np.random.default_rng(seed)
    height, turn = rng.uniform(np.cos(opening), 1, n), rng.uniform(0, 2 * np.pi, n)
    across = np.sqrt(1 - height**2)
    return np.column_stack([across * np.cos(turn), across * np.sin(turn), -height])


def test_a_perfect_sphere_has_its_diameter_and_no_form():
    found = probed_sphere(CENTRE + RADIUS * cap())
    assert found.centre == pytest.approx(CENTRE, abs=1e-8)
    assert found.diameter == pytest.approx(2 * RADIUS, abs=1e-8)
    assert found.form == pytest.approx(0, abs=1e-8)


def test_form_is_the_range_of_the_radial_distances_and_size_their_mean():
    directions = cap()
    wave = 0.01 * np.sign(np.sin(40 * np.arctan2(directions[:, 1], directions[:, 0])))
    found = probed_sphere(CENTRE + (RADIUS + wave)[:, None] * directions)
    assert found.form == pytest.approx(0.02, abs=0.001)
    assert found.diameter == pytest.approx(2 * RADIUS, abs=0.003)


def test_three_points_in_a_thousand_may_be_left_out_and_not_more():
    directions = cap()
    distance = np.full(len(directions), RADIUS)
    distance[:15] += 1.0  # 3 ‰ of 5000
    found = probed_sphere(CENTRE + distance[:, None] * directions)
    assert (found.form, found.points) == (pytest.approx(0, abs=1e-8), 4985)
    distance[15] += 1.0
    assert probed_sphere(CENTRE + distance[:, None] * directions).form == pytest.approx(1.0, abs=0.01)


def test_a_plane_has_the_flatness_it_was_given_whatever_its_tilt():
    rng = np.random.default_rng(2)
    x, y = rng.uniform(-50, 50, (2, 2000))
    points = np.column_stack([x, y, 600 + 0.3 * x - 0.2 * y])
    normal = np.array([-0.3, 0.2, 1]) / np.sqrt(1.13)
    bump = np.where(np.hypot(x, y) < 20, 0.05, 0.0)
    flat, _ = probed_flatness(points)
    bumpy, used = probed_flatness(points + bump[:, None] * normal)
    assert flat == pytest.approx(0, abs=1e-9)
    assert (bumpy, used) == (pytest.approx(0.05, abs=1e-3), 1994)


def test_too_few_points_and_a_flat_sphere_are_refused():
    with pytest.raises(ValueError, match="12 finite points"):
        probed_sphere(np.zeros((5, 3)))
    flat = np.column_stack([np.random.default_rng(0).normal(size=(50, 2)), np.zeros(50)])
    with pytest.raises(ValueError, match="lie in one plane"):
        probed_sphere(flat)
    with pytest.raises(ValueError, match="plane needs"):
        probed_flatness(np.full((50, 3), np.nan))
