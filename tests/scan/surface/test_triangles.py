"""The nearest place of a surface whose triangles are of very different sizes."""

import tracemalloc

import numpy as np
import pytest

from core.scan.surface.triangles import ProximityQuery, Triangles

MANY_MB = 300


@pytest.fixture(scope="module")
def wavy():
    """A fine wavy sheet over one huge triangle, as a scanned part over its table."""
    u, v = np.meshgrid(np.linspace(0, 100, 450), np.linspace(0, 80, 450))
    places = np.stack([u, v, 2 * np.sin(u / 7) + np.cos(v / 5)], axis=-1)
    a, b, c, d = places[:-1, :-1], places[:-1, 1:], places[1:, :-1], places[1:, 1:]
    fine = [np.stack(corners, axis=-2).reshape(-1, 3, 3) for corners in ((a, b, c), (b, d, c))]
    table = np.array([[[-300.0, -300.0, -40.0], [300.0, -300.0, -40.0], [0.0, 300.0, -40.0]]])
    return Triangles(np.concatenate([*fine, table])), places.reshape(-1, 3)


def test_one_huge_triangle_among_many_small_ones_costs_no_memory(wavy):
    surface, places = wavy
    points = places[::8] + np.random.default_rng(0).normal(0, 0.05, places[::8].shape)
    around = ProximityQuery(surface)
    tracemalloc.start()
    near = around.nearest(points, 2.0)
    peak = tracemalloc.get_traced_memory()[1] / 1e6
    tracemalloc.stop()
    assert peak < MANY_MB
    assert np.abs(near.distance).max() < 0.4


def test_it_is_the_nearest_of_all_whatever_its_size(wavy):
    rng = np.random.default_rng(1)
    size = 10.0 ** rng.uniform(-2, 2, 300)
    corners = rng.uniform(-50, 50, (300, 1, 3)) + size[:, None, None] * rng.normal(size=(300, 3, 3))
    surface, points = Triangles(corners), rng.uniform(-80, 80, (200, 3))
    found = ProximityQuery(surface).nearest(points)
    weights = rng.dirichlet((0.5, 0.5, 0.5), 400)  # places strewn over each triangle, corners and edges too
    strewn = np.einsum("wk,tkd->twd", weights, corners).reshape(-1, 3)
    best = np.array([np.linalg.norm(strewn - point, axis=1).min() for point in points])
    assert (np.abs(found.distance) <= best + 1e-9).all()
    assert np.linalg.norm(points - found.foot, axis=1) == pytest.approx(np.abs(found.distance))
