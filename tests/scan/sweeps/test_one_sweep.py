import numpy as np
import pytest

from core.scan.network.adjustment import solve_network
from core.scan.sweeps.fan_lines import UNASSIGNED
from core.scan.sweeps.one_sweep import KnownPlanes, judge_plane, locate_one
from tests.scan.synthetic import CAMERA, FAN, Network, network, sweeps

NOISE_PX = 0.05


def against_others(seed: int, count: int = 14, noise_px: float = NOISE_PX, relief: bool = True):
    """The last of `count` sweeps: its crossings, the planes they are with, and its true plane."""
    planes = sweeps(count, seed)
    whole: Network = network(planes, noise_px, seed, relief=relief)
    last = count - 1
    among = (whole.table.a != last) & (whole.table.b != last)
    solved = solve_network(whole.table.select(among), whole.geometry.select(among), whole.line[among], FAN, last)
    to_fan, to_others = whole.table.select((whole.table.a == last) & whole.table.with_fan), whole.table.b == last
    table = to_fan.followed_by(whole.table.select(to_others).swapped())
    rows = np.concatenate([np.flatnonzero((whole.table.a == last) & whole.table.with_fan), np.flatnonzero(to_others)])
    geometry = whole.geometry.select(rows)
    sweep = np.where(table.with_fan, UNASSIGNED, table.b)
    line = whole.line[rows]
    pis = np.where(table.with_fan[:, None], FAN.pis[np.maximum(line, 0)], solved.pis[np.maximum(table.b, 0)])
    return table, geometry, KnownPlanes(pis, sweep, solved.covariance), planes[last]


def depth_errors(pi, true):
    """Errors of depth in mm along the sweep's true stripe on the table, and rays there."""
    uv = np.column_stack([np.full(20, 900.0), np.linspace(200, 1200, 20)])
    rays = CAMERA.rays(uv)
    rays[:, 0] = (1 / 550 - rays[:, 1] * true[1] - true[2]) / true[0]  # on the sweep, 550 mm away
    return 1 / (rays @ pi) - 1 / (rays @ true), rays


def test_a_sweep_is_found_among_those_that_are_known():
    table, geometry, known, true = against_others(3, noise_px=1e-3)
    plane = locate_one(table, geometry, known)
    errors, _ = depth_errors(plane.pi, true)
    assert np.abs(errors).max() < 0.02
    assert np.all(plane.weights > 0.5)


@pytest.mark.accuracy
def test_its_covariance_is_true():
    sizes = []
    for seed in range(40):
        table, geometry, known, true = against_others(seed)
        if len(table) < 6:
            continue
        plane = locate_one(table, geometry, known)
        errors, rays = depth_errors(plane.pi, true)
        sigma = np.sqrt(np.einsum("ni,ij,nj->n", rays, plane.covariance, rays)) * 550**2
        sizes.append(errors[10] / sigma[10])
    assert len(sizes) > 20
    assert np.sqrt(np.mean(np.square(sizes))) == pytest.approx(1.0, abs=0.35)


def test_a_wrong_crossing_is_left_out():
    table, geometry, known, true = against_others(3)
    clean = locate_one(table, geometry, known)
    pis = known.pis.copy()
    pis[0] *= 1.02  # the fan's plane of another line
    plane = locate_one(table, geometry, KnownPlanes(pis, known.sweep, known.covariance))
    assert plane.weights[0] < 0.05
    assert np.abs(depth_errors(plane.pi, true)[0]).max() < 2 * np.abs(depth_errors(clean.pi, true)[0]).max() + 0.1


def test_fewer_than_three_crossings_are_refused():
    table, geometry, known, _ = against_others(3)
    two = np.arange(2)
    with pytest.raises(ValueError, match="2 crossings"):
        locate_one(
            table.select(two), geometry.select(two), KnownPlanes(known.pis[two], known.sweep[two], known.covariance)
        )


def test_the_true_plane_agrees_with_its_crossings():
    table, geometry, known, true = against_others(5)
    judged = judge_plane(true, np.zeros((3, 3)), table, geometry, known)
    assert np.sqrt(np.mean(judged.residuals**2)) < 2
    assert np.array_equal(judged.pi, true)


def test_swapping_a_crossing_twice_changes_nothing():
    table = against_others(3)[0]
    again = table.swapped().swapped()
    assert np.array_equal(again.tangent_a, table.tangent_a)
    assert np.array_equal(again.b, table.b)
