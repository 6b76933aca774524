import numpy as np
import pytest

from core.scan.network.sweep_plane import solve_sweep_plane

PI = np.array([0.004, 0.0005, 0.0018])
SPREAD = np.array([[-0.05, -0.1, 1], [0.04, 0.02, 1], [-0.02, 0.12, 1], [0.08, -0.03, 1], [0.0, 0.05, 1]])


def test_three_crossings_give_the_papers_plane():
    rays = SPREAD[:3]
    plane = solve_sweep_plane(rays, rays @ PI, np.full(3, 1e-7))
    assert plane.pi == pytest.approx(PI, rel=1e-4)


def test_one_bad_crossing_among_five_is_found_and_left_out():
    depths = SPREAD @ PI
    depths[3] += 1e-5
    plane = solve_sweep_plane(SPREAD, depths, np.full(5, 1e-7))
    assert plane.used.tolist() == [True, True, True, False, True]
    assert plane.pi == pytest.approx(PI, rel=1e-4)


def test_collinear_crossings_leave_one_direction_free_and_the_covariance_says_so():
    along = np.linspace(-0.1, 0.1, 5)
    rays = np.column_stack([0.3 * along, along, np.ones(5)])
    plane = solve_sweep_plane(rays, rays @ PI, np.full(5, 1e-7))
    on_the_line = np.array([0.015, 0.05, 1])
    off_it = np.array([0.1, 0.0, 1])
    assert plane.condition > 1e6
    assert np.sqrt(on_the_line @ plane.covariance @ on_the_line) < 1e-7
    assert np.sqrt(off_it @ plane.covariance @ off_it) > 1e-3


def test_the_covariance_is_that_of_repeated_noise():
    rng = np.random.default_rng(1)
    sigma = 2e-7
    planes = [solve_sweep_plane(SPREAD, SPREAD @ PI + rng.normal(0, sigma, 5), np.full(5, sigma)) for _ in range(400)]
    errors = np.array([plane.pi - PI for plane in planes if plane.used.all()])
    stated = planes[0].covariance
    mean = np.mean([e @ np.linalg.solve(stated, e) for e in errors]) / 3
    assert mean == pytest.approx(1, abs=0.15)


def test_two_crossings_are_refused():
    with pytest.raises(ValueError, match="2 crossings"):
        solve_sweep_plane(SPREAD[:2], SPREAD[:2] @ PI, np.full(2, 1e-7))
