import numpy as np
import pytest

from core.calibrate.pencil import FreePlanes, Pencil, fit_to_points, pencil_near, plane_through
from core.model import Fan, LightPlane

PAPER = -np.array([[0.922, -7.397, -1.429], [1.321, -9.319, -0.992], [1.986, -12.52, -0.263]]) / 1000
ALPHA = np.deg2rad(5)


def exact_pencil() -> Pencil:
    return pencil_near(PAPER, ALPHA)


def points_on(pis: np.ndarray, count: int, noise: float, seed: int) -> list[np.ndarray]:
    rng = np.random.default_rng(seed)
    points = []
    for pi in pis:
        z, x = rng.uniform(420, 620, count), rng.uniform(-120, 120, count)
        y = (1 - pi[0] * x - pi[2] * z) / pi[1]
        normal = pi / np.linalg.norm(pi)
        points.append(np.column_stack([x, y, z]) + normal * rng.normal(0, noise, count)[:, None])
    return points


def angles(pis: np.ndarray) -> np.ndarray:
    return np.array(Fan(tuple(LightPlane(pi) for pi in pis)).angles)


def worst_mm(pis: np.ndarray, truth: np.ndarray) -> float:
    points = points_on(truth, 200, 0.0, 9)
    return max(np.abs(LightPlane(pi).distances(p)).max() for pi, p in zip(pis, points, strict=True))


def test_the_papers_planes_are_nearly_one_pencil():
    assert worst_mm(pencil_near(PAPER, None).pis, PAPER) < 0.02


def test_fixed_angles_are_kept_whatever_the_step():
    moved = exact_pencil().moved(np.array([0.1, -0.2, 5.0, -3.0, 0.3]))
    assert angles(moved.pis) == pytest.approx([ALPHA, ALPHA], abs=1e-12)


@pytest.mark.parametrize("fixed", [True, False])
def test_jacobian_is_the_derivative_of_the_planes(fixed):
    pencil = pencil_near(PAPER, ALPHA if fixed else None).moved(np.array([0.02, 0.01, 1.0, 2.0, 0.03]))
    jacobian = pencil.jacobian
    assert jacobian.shape == (9, 5 if fixed else 7)
    for column in range(jacobian.shape[1]):
        step = np.zeros(jacobian.shape[1])
        step[column] = 1e-6
        numeric = (pencil.moved(step).pis - pencil.moved(-step).pis).ravel() / 2e-6
        assert np.abs(jacobian[:, column] - numeric).max() < 1e-7 * max(1e-3, np.abs(numeric).max())


def test_a_plane_through_exact_points_is_exact():
    for pi, points in zip(PAPER, points_on(PAPER, 30, 0.0, 1), strict=True):
        assert np.abs(plane_through(points) - pi).max() < 1e-12


def test_constrained_fit_finds_the_pencil_from_a_distant_start():
    truth = exact_pencil()
    points = points_on(truth.pis, 300, 0.0, 2)
    start = truth.moved(np.array([0.05, -0.08, 15.0, -10.0, 0.05]))
    solution = fit_to_points(start, points, [np.ones(300)] * 3)
    assert worst_mm(solution.state.pis, truth.pis) < 1e-6


def test_one_stray_point_in_ten_moves_the_planes_little():
    truth = exact_pencil()
    clean = points_on(truth.pis, 300, 0.05, 3)
    spoilt = [p.copy() for p in clean]
    for p in spoilt:
        p[::10] += [0.0, 4.0, 0.0]
    sigmas = [np.ones(300)] * 3
    assert worst_mm(fit_to_points(FreePlanes(PAPER), clean, sigmas).state.pis, truth.pis) < 0.03
    assert worst_mm(fit_to_points(FreePlanes(PAPER), spoilt, sigmas).state.pis, truth.pis) < 0.06


def test_the_constraint_makes_the_planes_more_certain():
    points, sigmas = points_on(exact_pencil().pis, 200, 0.1, 4), [np.ones(200)] * 3
    free = fit_to_points(FreePlanes(PAPER), points, sigmas)
    tied = fit_to_points(exact_pencil(), points, sigmas)
    spread = tied.state.jacobian @ tied.covariance @ tied.state.jacobian.T
    assert np.trace(spread) < 0.6 * np.trace(free.covariance)


@pytest.mark.parametrize("tied", [True, False])
def test_covariance_is_that_of_repeated_fits(tied):
    truth = exact_pencil()
    start = truth if tied else FreePlanes(truth.pis)
    chi2 = []
    for seed in range(40):
        solution = fit_to_points(start, points_on(truth.pis, 60, 0.1, 100 + seed), [np.full(60, 0.1)] * 3)
        covariance = solution.state.jacobian @ solution.covariance @ solution.state.jacobian.T
        error = (solution.state.pis - truth.pis).ravel()
        chi2.append(error @ np.linalg.pinv(covariance, rcond=1e-9, hermitian=True) @ error)
    unknowns = 5 if tied else 9
    assert 0.7 * unknowns < np.mean(chi2) < 1.5 * unknowns


def test_two_planes_always_share_an_axis():
    points = points_on(PAPER[:2], 100, 0.0, 5)
    solution = fit_to_points(pencil_near(PAPER[:2], None), points, [np.ones(100)] * 2)
    assert worst_mm(solution.state.pis, PAPER[:2]) < 1e-6
