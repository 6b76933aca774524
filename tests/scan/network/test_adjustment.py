from dataclasses import replace

import numpy as np
import pytest

from core.scan.network.adjustment import Network, solve_network
from core.scan.network.geometry import CrossingRays
from tests.scan.synthetic import CAMERA, FAN, network, stripe_rays, sweeps

NOISE_PX = 0.05


def solved(truth: np.ndarray, seed: int, noise_px: float = NOISE_PX):
    scan = network(truth, noise_px, seed, fan_noise_px=0.6 * noise_px)
    return solve_network(scan.table, scan.geometry, scan.line, FAN, len(truth))


def depth_errors(result: Network, truth: np.ndarray, sweep: int) -> tuple[np.ndarray, np.ndarray]:
    """Depth errors in mm along the stripe of one sweep, and the σ stated for them."""
    rays = stripe_rays(truth[sweep])
    squared = 1 / (rays @ truth[sweep]) ** 2
    block = result.covariance[3 * sweep : 3 * sweep + 3, 3 * sweep : 3 * sweep + 3]
    sigma = squared * np.sqrt(np.einsum("ni,ij,nj->n", rays, block, rays))
    return squared * (rays @ (truth[sweep] - result.pis[sweep])), sigma


def all_depth_errors(result: Network, truth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    pairs = [depth_errors(result, truth, sweep) for sweep in range(len(truth))]
    return np.concatenate([e for e, _ in pairs]), np.concatenate([s for _, s in pairs])


def test_without_noise_the_surface_comes_back():
    truth = sweeps(20, 1)
    errors, _ = all_depth_errors(solved(truth, 1, 0.0), truth)
    assert np.abs(errors).max() < 1e-3


@pytest.mark.accuracy
def test_depth_errors_agree_with_their_stated_sigma():
    squares = []
    for seed in range(16):
        truth = sweeps(30, seed)
        errors, sigma = all_depth_errors(solved(truth, seed), truth)
        squares.append(np.median((errors / sigma) ** 2) / 0.4549)  # the median of χ² with one degree of freedom
    assert 0.5 < np.mean(squares) < 1.5


def test_it_does_not_collapse_onto_the_table():
    truth = sweeps(30, 3)
    result = solved(truth, 3)
    errors, _ = all_depth_errors(result, truth)
    assert np.median(np.abs(errors)) < 0.05
    assert not result.fan_silenced


def test_bad_crossings_are_left_out():
    truth = sweeps(30, 4)
    scan = network(truth, NOISE_PX, 4, fan_noise_px=0.03)
    bad = np.random.default_rng(4).choice(len(scan.table), len(scan.table) // 40, replace=False)
    moved = scan.table.uv.copy()
    moved[bad] += 15.0
    table = replace(scan.table, uv=moved)
    result = solve_network(table, CrossingRays.of(table, CAMERA), scan.line, FAN, len(truth))
    assert np.median(result.weights[bad]) < 0.05
    errors, _ = all_depth_errors(result, truth)
    assert np.median(np.abs(errors)) < 0.05


def test_a_sweep_without_fan_crossings_is_held_by_the_others():
    truth = sweeps(30, 5)
    scan = network(truth, NOISE_PX, 5, fan_noise_px=0.03)
    keep = ~((scan.table.a == 7) & scan.table.with_fan)
    table = scan.table.select(keep)
    result = solve_network(table, CrossingRays.of(table, CAMERA), scan.line[keep], FAN, len(truth))
    errors, _ = depth_errors(result, truth, 7)
    assert np.median(np.abs(errors)) < 0.1


def test_on_a_flat_table_alone_the_scale_is_unknown_and_the_covariance_says_so():
    truth = sweeps(20, 6)
    flat = network(truth, NOISE_PX, 6, fan_noise_px=0.03, relief=False)
    relief = network(truth, NOISE_PX, 6, fan_noise_px=0.03)
    spread = [
        np.median(np.diag(solve_network(s.table, s.geometry, s.line, FAN, len(truth)).covariance))
        for s in (flat, relief)
    ]
    assert spread[0] > 100 * spread[1]


def test_without_the_fan_nothing_is_solved():
    truth = sweeps(5, 7)
    scan = network(truth, NOISE_PX, 7)
    keep = ~scan.table.with_fan
    with pytest.raises(ValueError, match="no sweep crosses the fan"):
        solve_network(scan.table.select(keep), CrossingRays.of(scan.table, CAMERA), scan.line[keep], FAN, len(truth))


def test_sweeps_that_cross_each_other_and_never_the_fan_make_no_warning():
    """Nothing holds them: their planes stay zero and equal, and no gradient is left to weigh their crossings by."""
    truth = sweeps(30, 5)
    scan = network(truth, NOISE_PX, 5, fan_noise_px=0.03)
    alone = {7, 8}
    apart = np.array([(a in alone) == (b in alone) for a, b in zip(scan.table.a, scan.table.b, strict=True)])
    keep = np.where(scan.table.with_fan, ~np.isin(scan.table.a, list(alone)), apart)
    table = scan.table.select(keep)
    assert np.any(np.isin(table.a, list(alone)))
    with np.errstate(divide="raise", invalid="raise"):
        result = solve_network(table, CrossingRays.of(table, CAMERA), scan.line[keep], FAN, len(truth))
    assert np.isfinite(result.pis).all()
    assert np.isfinite(result.covariance).all()
    errors, _ = depth_errors(result, truth, 3)
    assert np.median(np.abs(errors)) < 0.1
