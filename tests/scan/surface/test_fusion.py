"""Fusion in the picture's grid, and normals from the neighbours in the picture."""

import tracemalloc

import numpy as np
import pytest

from core.errors import Cancelled, InputError
from core.scan.surface.cloud import FAN
from core.scan.surface.fusion import fuse, with_normals
from tests.scan.stripes_on_planes import SIZE, cloud_of, on_plane, stripes


def test_weighted_mean_of_independent_sweeps():
    surface = fuse(cloud_of([[10.1, 10.2]] * 2, [500.0, 500.06], [0.02, 0.04], [0, 1]), SIZE, cell_px=2)
    weights = np.array([1 / 0.02**2, 1 / 0.04**2])
    assert len(surface) == 1
    assert surface.points[0, 2] == pytest.approx(weights @ [500.0, 500.06] / weights.sum(), abs=1e-9)
    assert surface.sigma[0] == pytest.approx(weights.sum() ** -0.5, rel=1e-12)
    assert surface.count[0] == 2


def test_points_of_one_sweep_count_as_one_observation():
    surface = fuse(cloud_of([[10, 10], [10.4, 10], [10.2, 10.3]], 500.0, 0.03, 4), SIZE, cell_px=2)
    assert surface.sigma[0] == pytest.approx(0.03)
    assert surface.count[0] == 3
    many_against_one = fuse(
        cloud_of([[10, 10]] * 4, [500.0, 500.0, 500.0, 500.06], 0.03, [0, 0, 0, 1]), SIZE, cell_px=2
    )
    assert many_against_one.points[0, 2] == pytest.approx(500.03, abs=1e-9)


def test_stated_sigma_is_the_scatter_of_fused_depths():
    rng = np.random.default_rng(1)
    cells, sweeps, in_sweep = 4000, 3, 2
    uv = np.stack(np.meshgrid(np.arange(80) * 2.0 + 100.5, np.arange(50) * 2.0 + 100.5), -1).reshape(-1, 2)
    uv = np.repeat(uv, sweeps * in_sweep, axis=0)
    sweep = np.tile(np.repeat(np.arange(sweeps), in_sweep), cells)
    shared = np.repeat(rng.normal(0, 0.03, cells * sweeps), in_sweep)  # one error per sweep and cell
    surface = fuse(cloud_of(uv, 500 + shared, 0.03, sweep), SIZE, cell_px=2)
    assert len(surface) == cells
    assert (surface.points[:, 2] - 500).std() == pytest.approx(surface.sigma.mean(), rel=0.05)


def test_a_depth_edge_is_not_averaged_and_the_majority_stays():
    depth = [500.0, 540.0, 540.02, 540.01]
    surface = fuse(cloud_of([[10, 10]] * 4, depth, 0.03, [0, 1, 2, 3]), SIZE, cell_px=2)
    assert surface.points[0, 2] == pytest.approx(540.01, abs=1e-6)
    assert surface.member.tolist() == [-1, 0, 0, 0]


def test_of_two_equal_layers_the_nearer_stays():
    surface = fuse(cloud_of([[10, 10]] * 2, [540.0, 500.0], 0.03, [0, 1]), SIZE, cell_px=2)
    assert surface.points[0, 2] == pytest.approx(500.0)


def test_grid_holds_the_depths_in_place():
    surface = fuse(
        cloud_of([[0, 0], [479.4, 359.4], [7.0, 2.0]], [500.0, 510.0, 520.0], 0.03, [0, FAN, FAN - 1]), SIZE, 4
    )
    assert surface.shape == (90, 120)
    assert surface.depth[0, 0] == pytest.approx(500)
    assert surface.depth[-1, -1] == pytest.approx(510)
    assert surface.depth[0, 1] == pytest.approx(520)
    assert surface.valid.sum() == 3
    assert np.isnan(surface.depth[~surface.valid]).all()


def test_unusable_points_are_left_out_and_none_at_all_is_said():
    surface = fuse(cloud_of([[10, 10], [20, 20]], [500.0, np.nan]), SIZE)
    assert surface.member.tolist() == [0, -1]
    with pytest.raises(InputError, match="no point with a depth"):
        fuse(cloud_of([[10, 10]], [np.nan]), SIZE)
    with pytest.raises(InputError, match="no point with a depth"):
        fuse(cloud_of(np.zeros((0, 2)), np.zeros(0)), SIZE)


def test_fusing_can_be_cancelled():
    def stop(step, done, total):
        raise Cancelled

    with pytest.raises(Cancelled):
        fuse(cloud_of([[10, 10]], 500.0), SIZE, progress=stop)


def test_fusing_copies_no_points():
    """A point of the cloud has 104 bytes; fusing it takes three numbers: its cell, its place in order, its member."""
    rng, used = np.random.default_rng(1), []
    for count in (400_000, 800_000):
        cloud = cloud_of(rng.random((count, 2)) * 40, 500.0, 0.03, np.arange(count) % 50)
        tracemalloc.start()
        fuse(cloud, SIZE, cell_px=2)
        used.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert (used[1] - used[0]) / 400_000 < 27


@pytest.mark.parametrize("of_surface", [False, True])
def test_normals_of_a_tilted_plane(of_surface):
    normal = np.array([0.2, -0.35, 1.0])
    normal /= np.linalg.norm(normal)
    uv, index = stripes()
    depth = on_plane(uv, normal, 500.0) + np.random.default_rng(2).normal(0, 0.02, len(uv))
    cloud = cloud_of(uv, depth, 0.02, index)
    found = with_normals(fuse(cloud, SIZE, 2) if of_surface else cloud).normals
    known = found.any(axis=1)
    assert known.mean() > 0.95
    angle = np.arccos(np.clip(found[known] @ -normal, -1, 1))
    assert np.quantile(angle, 0.95) < np.radians(2)
    assert np.linalg.norm(found[known], axis=1) == pytest.approx(1.0)


def test_normals_hold_beside_a_depth_edge_and_against_wrong_points():
    rng = np.random.default_rng(3)
    uv, index = stripes()
    upper = np.abs(uv - [240, 180]).max(axis=1) < 90
    depth = np.where(upper, 500.0, 540.0) + rng.normal(0, 0.02, len(uv))
    wrong = rng.random(len(uv)) < 0.05
    depth[wrong] += rng.uniform(-3, 3, wrong.sum())
    found = with_normals(cloud_of(uv, depth, 0.02, index)).normals
    known = found.any(axis=1) & ~wrong
    assert known.sum() > 0.9 * (~wrong).sum()
    angle = np.arccos(np.clip(-found[known, 2], -1, 1))
    assert np.quantile(angle, 0.98) < np.radians(3)


def test_a_single_stripe_determines_no_normal():
    rows = np.arange(20.0, 340.0)
    uv = np.column_stack([200 + 0.2 * rows, rows])
    assert not with_normals(cloud_of(uv, 500.0)).normals.any()


def test_few_points_have_no_normals():
    assert not with_normals(cloud_of([[10, 10], [20, 20]], 500.0)).normals.any()
    assert len(with_normals(cloud_of(np.zeros((0, 2)), np.zeros(0)))) == 0
