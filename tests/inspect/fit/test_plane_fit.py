"""Fits of one plane and of two parallel planes against analytic truth."""

import numpy as np
import pytest

from core.inspect.fit.plane_fit import _solve, fit_parallel_planes, fit_plane
from tests.shared import REAL_SETS

REAL = REAL_SETS / "gaugeblock"
NORMAL = np.array([0.1, -0.3, 1.0]) / np.linalg.norm([0.1, -0.3, 1.0])
AXES = np.linalg.svd(NORMAL[None, :])[2][1:]


def face(rng, distance, count=400, half=30.0, noise=0.0, offset=(0.0, 0.0)):
    flat = rng.uniform(-half, half, (count, 2)) + offset
    points = distance * NORMAL + flat @ AXES
    depth = points[:, 2:]
    return points * (depth + noise * rng.normal(size=(count, 1))) / depth


def test_exact_points_give_the_exact_plane():
    fit = fit_plane(face(np.random.default_rng(0), 520.0))
    assert fit.normal == pytest.approx(NORMAL, abs=1e-12)
    assert fit.distance == pytest.approx(520.0, abs=1e-9)


def test_exact_points_give_the_exact_thickness_far_from_each_other_sideways():
    rng = np.random.default_rng(1)
    planes = fit_parallel_planes(face(rng, 500.0, offset=(40, 10)), face(rng, 550.0, offset=(-80, 0)))
    assert planes.thickness == pytest.approx(50.0, abs=1e-9)
    assert planes.normal == pytest.approx(NORMAL, abs=1e-12)
    assert planes.tilt_determined


def test_residuals_are_positive_towards_the_camera():
    rng = np.random.default_rng(2)
    points = face(rng, 520.0)
    points[7] -= 0.5 * NORMAL
    assert fit_plane(points).residuals[7] == pytest.approx(0.5, abs=1e-3)


def test_a_quarter_of_wrong_points_does_not_move_the_planes():
    rng = np.random.default_rng(3)
    upper, lower = face(rng, 500.0, noise=0.02), face(rng, 550.0, noise=0.02)
    clean = fit_parallel_planes(upper, lower).thickness
    upper[:100] += rng.uniform(1, 8, (100, 1)) * NORMAL  # all to one side
    planes = fit_parallel_planes(upper, lower)
    assert planes.thickness == pytest.approx(50.0, abs=0.01)
    assert planes.thickness == pytest.approx(clean, abs=0.006)
    assert np.abs(planes.weights[0][:100]).max() == 0


def test_precise_points_count_more():
    rng = np.random.default_rng(4)
    sigma = np.where(np.arange(600) < 300, 0.01, 0.08)
    errors = {"weighted": [], "alike": []}
    for _ in range(60):
        upper, lower = face(rng, 500.0, 600, noise=0), face(rng, 550.0, 600, noise=0)
        for points in (upper, lower):
            points *= 1 + (sigma * rng.normal(size=600) / points[:, 2])[:, None]
        errors["weighted"].append(fit_parallel_planes(upper, lower, sigma, sigma).thickness - 50)
        errors["alike"].append(fit_parallel_planes(upper, lower).thickness - 50)
    assert np.std(errors["weighted"]) < 0.75 * np.std(errors["alike"])


def refit_thickness(planes, upper, lower):
    """Thickness of the same fit with the same weights, so a smooth function of the points, after they have moved."""
    points, face = np.vstack([upper, lower]), np.repeat([0, 1], [len(upper), len(lower)])
    solution = _solve(points, np.concatenate(planes.weights), face, 2, planes.normal, not planes.tilt_determined)
    return float(solution.distances[1] - solution.distances[0])


def test_stated_scale_is_one_where_sigma_is_true():
    rng = np.random.default_rng(5)
    sigma = np.full(3000, 0.03)
    assert fit_plane(face(rng, 500.0, 3000, noise=0.03), sigma).scale == pytest.approx(1.0, abs=0.06)


def test_gains_are_the_derivatives_of_the_thickness():
    rng = np.random.default_rng(6)
    upper, lower = face(rng, 500.0, 40, offset=(20, 0), noise=0.02), face(rng, 550.0, 60, noise=0.02)
    sigma = rng.uniform(0.01, 0.05, 100)
    planes = fit_parallel_planes(upper, lower, sigma[:40], sigma[40:])
    step = 1e-4
    for index in (0, 13, 39):
        moved = upper.copy()
        moved[index] += step * NORMAL
        change = (refit_thickness(planes, moved, lower) - refit_thickness(planes, upper, lower)) / step
        assert change == pytest.approx(planes.gains[0][index], rel=2e-3, abs=1e-5)
    for index in (0, 59):
        moved = lower.copy()
        moved[index] += step * NORMAL
        change = (refit_thickness(planes, upper, moved) - refit_thickness(planes, upper, lower)) / step
        assert change == pytest.approx(planes.gains[1][index], rel=2e-3, abs=1e-5)


def test_refit_of_the_same_points_is_the_same_thickness():
    rng = np.random.default_rng(7)
    upper, lower = face(rng, 500.0, noise=0.02), face(rng, 550.0, noise=0.02)
    planes = fit_parallel_planes(upper, lower)
    assert refit_thickness(planes, upper, lower) == pytest.approx(planes.thickness, abs=1e-6)
    assert refit_thickness(planes, 1.01 * upper, 1.01 * lower) == pytest.approx(1.01 * planes.thickness, abs=1e-6)


def profile(rng, tilt, noise=0.0):
    """One light profile of two faces 20 mm apart; its light plane stands at `tilt` rad from the normal."""
    line, across = AXES
    sheet = np.cos(tilt) * NORMAL + np.sin(tilt) * across  # runs up the light plane
    s = np.linspace(-10, 10, 120)
    lower = 550.0 * NORMAL + (s[:, None] + 18) * line + noise * rng.normal(size=(120, 1)) * sheet
    upper = 550.0 * NORMAL - 20.0 / np.cos(tilt) * sheet + s[:, None] * line + noise * rng.normal(size=(120, 1)) * sheet
    return upper, lower


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_single_profile_with_the_tables_normal(noise):
    upper, lower = profile(np.random.default_rng(8), tilt=0.3, noise=noise)
    planes = fit_parallel_planes(upper, lower, reference_normal=NORMAL)
    assert not planes.tilt_determined
    assert planes.thickness == pytest.approx(20.0, abs=1e-6 + 0.5 * noise)


def test_single_profile_without_reference_measures_in_its_own_plane():
    upper, lower = profile(np.random.default_rng(9), tilt=0.3)
    planes = fit_parallel_planes(upper, lower)
    assert not planes.tilt_determined
    assert planes.thickness == pytest.approx(20.0 / np.cos(0.3), abs=1e-6)


def test_reference_normal_does_not_touch_a_determined_fit():
    rng = np.random.default_rng(10)
    planes = fit_parallel_planes(face(rng, 500.0), face(rng, 550.0), reference_normal=np.array([0.0, 0.0, 1.0]))
    assert planes.thickness == pytest.approx(50.0, abs=1e-9)


def test_too_few_points():
    with pytest.raises(ValueError, match="at least 3 points"):
        fit_plane(np.zeros((2, 3)))
    with pytest.raises(ValueError, match="at least 2 points"):
        fit_parallel_planes(np.ones((1, 3)), np.ones((9, 3)))


@pytest.mark.skipif(not REAL.is_dir(), reason="the real gauge-block profile is not on this machine")
def test_real_gauge_block_profile():
    """Rule: two parallel lines fitted jointly, thickness at right angles to them, along the ground plate's normal.

    The ground's normal is the gradient of the published height over ground, an affine function of the coordinates.
    Extrapolating the baseline gives 19.84, its median 20.07, the authors' rule 19.876.
    """

    def read(name):
        rows = np.genfromtxt(REAL / f"frame_000974_{name}_points.csv", delimiter=",", names=True)
        return np.column_stack([rows["Xc_mm"], rows["Yc_mm"], rows["Zc_mm"]]), rows["Zg_mm"]

    (upper, upper_height), (lower, lower_height) = read("height"), read("baseline")
    both = np.vstack([upper, lower])
    design = np.column_stack([both - both.mean(axis=0), np.ones(len(both))])
    gradient = np.linalg.lstsq(design, np.concatenate([upper_height, lower_height]), rcond=None)[0][:3]
    planes = fit_parallel_planes(upper, lower, reference_normal=gradient)
    assert not planes.tilt_determined
    assert 19.84 < planes.thickness < 20.07
    assert planes.thickness == pytest.approx(19.876, abs=0.05)
    upper[::9] += [0.0, 0.0, 1.5]  # wrong points on the block do not move it
    assert fit_parallel_planes(upper, lower, reference_normal=gradient).thickness == pytest.approx(
        planes.thickness, abs=0.01
    )
