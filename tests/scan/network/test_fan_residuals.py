"""Sweeps and fan that disagree by place are told, and ideal networks are not accused."""

import numpy as np
import pytest

from core.model import Camera
from core.scan.network.adjustment import Network, solve_network
from core.scan.network.fan_residuals import judge_fan_cells, judge_network
from core.scan.network.geometry import CrossingRays
from tests.scan.synthetic import CAMERA, FAN, network, sweeps


def solved(seed: int, camera: Camera = CAMERA, stated: float = 1.0) -> Network:
    """Of 30 sweeps with noise of 0.05 px, seen through `camera`, whose noise is stated so many times as large."""
    truth = sweeps(30, seed)
    scan = network(truth, 0.05, seed, fan_noise_px=0.03)
    table = scan.table.select(np.arange(len(scan.table)))
    for name in ("sigma_a", "sigma_b", "share_a", "share_b"):
        object.__setattr__(table, name, getattr(table, name) * stated)
    return solve_network(table, CrossingRays.of(table, camera), scan.line, FAN, len(truth))


def codes(result: Network) -> list[str]:
    return [note.code for note in judge_network(result.scale, result.fan_off, CAMERA.image_size)[1]]


def test_ideal_networks_are_not_accused_and_chance_is_as_rare_as_stated() -> None:
    found = [solved(seed) for seed in range(12)]
    assert [codes(one) for one in found] == [[]] * 12
    p = np.array([judge_fan_cells(one.fan_off, CAMERA.image_size).p for one in found])
    assert 0.2 < np.median(p) < 0.95
    size = [one.fan_off.z @ one.fan_off.z / np.trace(one.fan_off.covariance) for one in found]
    assert np.mean(size) == pytest.approx(1.0, abs=0.3)


def test_a_lens_that_is_not_as_calibrated_is_told_by_place() -> None:
    distortion = CAMERA.distortion + np.array([0.05, *np.zeros(len(CAMERA.distortion) - 1)])
    bent = Camera(CAMERA.image_size, CAMERA.matrix, distortion)
    assert all(codes(solved(seed, bent)) == ["scan.fan_off_in_region"] for seed in (0, 1, 5))


def test_noise_that_is_stated_half_of_the_truth_is_told_as_that() -> None:
    result = solved(1, stated=0.5)
    assert codes(result) == ["scan.crossings_scatter"]
    assert result.scale == pytest.approx(1.9, rel=0.15)
