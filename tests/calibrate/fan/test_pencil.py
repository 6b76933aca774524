import numpy as np
import pytest

from core.calibrate.fan.pencil import FreePlanes, Pencil, pencil_near, plane_distances
from core.calibrate.fan.pose_equations import inverse
from core.calibrate.levenberg import DenseProblem, Solution, minimise
from core.model import Fan, LightPlane
from tests.paper import PLANES as PAPER

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


def fitted(start: FreePlanes | Pencil, points: list[np.ndarray], sigma: float) -> Solution:
    """Planes by least squares of the points' orthogonal distances."""
    which = np.repeat(np.arange(len(points)), [len(own) for own in points])
    rows = 3 * which[:, None] + np.arange(3)

    def linearise(planes):
        distances, by_pi = plane_distances(planes.pis[which], np.vstack(points))
        return DenseProblem(distances / sigma, np.einsum("ni,nip->np", by_pi, planes.jacobian[rows]) / sigma)

    return minimise(start, linearise, lambda planes, step: planes.moved(step))


def covariance_of(solution: Solution) -> np.ndarray:
    """(P, P) of the local step, for residuals of unit variance."""
    return inverse(solution.linear.jacobian.T @ solution.linear.jacobian)


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


def test_constrained_fit_finds_the_pencil_from_a_distant_start():
    truth = exact_pencil()
    points = points_on(truth.pis, 300, 0.0, 2)
    start = truth.moved(np.array([0.05, -0.08, 15.0, -10.0, 0.05]))
    solution = fitted(start, points, 1.0)
    assert worst_mm(solution.state.pis, truth.pis) < 1e-6


def test_the_constraint_makes_the_planes_more_certain():
    points = points_on(exact_pencil().pis, 200, 0.1, 4)
    free = fitted(FreePlanes(PAPER), points, 0.1)
    tied = fitted(exact_pencil(), points, 0.1)
    spread = tied.state.jacobian @ covariance_of(tied) @ tied.state.jacobian.T
    assert np.trace(spread) < 0.6 * np.trace(covariance_of(free))


@pytest.mark.parametrize("tied", [True, False])
def test_covariance_is_that_of_repeated_fits(tied):
    truth = exact_pencil()
    start = truth if tied else FreePlanes(truth.pis)
    chi2 = []
    for seed in range(40):
        solution = fitted(start, points_on(truth.pis, 60, 0.1, 100 + seed), 0.1)
        covariance = solution.state.jacobian @ covariance_of(solution) @ solution.state.jacobian.T
        error = (solution.state.pis - truth.pis).ravel()
        chi2.append(error @ np.linalg.pinv(covariance, rcond=1e-9, hermitian=True) @ error)
    unknowns = 5 if tied else 9
    assert 0.7 * unknowns < np.mean(chi2) < 1.5 * unknowns


def test_two_planes_always_share_an_axis():
    points = points_on(PAPER[:2], 100, 0.0, 5)
    solution = fitted(pencil_near(PAPER[:2], None), points, 1.0)
    assert worst_mm(solution.state.pis, PAPER[:2]) < 1e-6


def test_distances_and_their_derivatives():
    points = points_on(PAPER, 20, 2.0, 6)[0]
    pis = np.broadcast_to(PAPER[0], points.shape)
    distances, by_pi = plane_distances(pis, points)
    assert distances == pytest.approx(LightPlane(PAPER[0]).distances(points))
    for axis in range(3):
        step = np.zeros(3)
        step[axis] = 1e-8
        numeric = (plane_distances(pis + step, points)[0] - plane_distances(pis - step, points)[0]) / 2e-8
        assert by_pi[:, axis] == pytest.approx(numeric, rel=1e-4, abs=1e-2)
