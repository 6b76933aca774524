"""Delaunay's triangulation against Qhull's, and where rounding could break it."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull, Delaunay

from core.scan.surface.delaunay import delaunay


def ordered(triangles):
    corners = np.sort(triangles, axis=1)
    return corners[np.lexsort(corners.T[::-1])]


def areas(uv, triangles):
    a, b, c = (uv[triangles[:, k]] for k in range(3))
    return 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])


def stripes(rng, count):
    """Points along slightly bent lines side by side, as a scan leaves them: nearly on lines, many nearly on circles."""
    along, line = np.arange(count) % 200, np.arange(count) // 200
    return np.column_stack([7.0 * line + 0.02 * along * np.sin(line), along]) + rng.normal(0, 0.01, (count, 2))


@pytest.mark.parametrize("seed", range(4))
def test_the_triangles_are_those_of_qhull(seed):
    rng = np.random.default_rng(seed)
    for uv in (rng.random((2000, 2)) * [3840, 2748], stripes(rng, 3000)):
        assert np.array_equal(ordered(delaunay(uv)), ordered(Delaunay(uv).simplices))


@pytest.mark.parametrize("seed", range(4))
def test_far_clusters_and_narrow_strips_are_covered_but_for_slivers_along_the_rim(seed):
    """Rounded to the lattice a nearly straight rim may have a sliver of a triangle more or less."""
    rng = np.random.default_rng(seed)
    clusters = np.vstack([rng.normal(0, 1, (300, 2)), rng.normal([4000, 100], 2, (300, 2))])
    for uv in (clusters, rng.random((500, 2)) * [1e4, 30]):
        found = {tuple(one) for one in ordered(delaunay(uv)).tolist()}
        expected = {tuple(one) for one in ordered(Delaunay(uv).simplices).tolist()}
        assert len(found ^ expected) < 0.02 * len(expected)
        assert areas(uv, delaunay(uv)).sum() == pytest.approx(ConvexHull(uv).volume, rel=1e-5)


@pytest.mark.parametrize("size", [(2, 2), (9, 9), (1, 3), (40, 25)])
def test_a_lattice_where_all_neighbours_lie_on_circles_and_lines_is_covered_once(size):
    u, v = np.meshgrid(np.arange(size[0]) * 4.0, np.arange(size[1]) * 4.0)
    uv = np.random.default_rng(1).permutation(np.column_stack([u.ravel(), v.ravel()]))
    triangles = delaunay(uv)
    assert len(triangles) == 2 * (size[0] - 1) * (size[1] - 1)
    assert np.allclose(areas(uv, triangles), 8.0, rtol=1e-6)


def test_points_on_a_circle_and_its_middle_are_joined():
    turn = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    uv = np.vstack([100 * np.column_stack([np.cos(turn), np.sin(turn)]), [[0.0, 0.0]]])
    triangles = delaunay(uv)
    assert areas(uv, triangles).sum() == pytest.approx(ConvexHull(uv).volume, rel=1e-6)
    assert len(triangles) == 60


def test_doubled_points_are_used_once_and_nothing_overlaps():
    rng = np.random.default_rng(3)
    uv = np.repeat(rng.random((300, 2)) * 100, 2, axis=0)
    triangles = delaunay(uv)
    assert len(np.unique(triangles)) == 300
    assert (areas(uv, triangles) > -1e-3).all()
    assert areas(uv, triangles).sum() == pytest.approx(ConvexHull(uv).volume, rel=1e-5)


def test_points_on_one_line_or_in_one_place_have_no_triangle():
    line = np.arange(30.0)
    for uv in (np.column_stack([line, line]), np.column_stack([line, 0 * line]), np.zeros((9, 2)), np.zeros((0, 2))):
        assert delaunay(uv).shape == (0, 3)


def test_one_point_off_a_line_is_joined_to_all_of_it():
    uv = np.vstack([np.column_stack([np.arange(30.0), np.zeros(30)]), [[3.0, 5.0]]])
    triangles = delaunay(uv)
    assert len(triangles) == 29
    assert (triangles == 30).any(axis=1).all()


def test_the_same_points_give_the_same_triangles_and_each_runs_anticlockwise():
    uv = stripes(np.random.default_rng(5), 1000)
    triangles = delaunay(uv)
    assert triangles.tobytes() == delaunay(uv.copy()).tobytes()
    assert (areas(uv, triangles) > 0).all()


def test_what_is_not_finite_is_refused():
    with pytest.raises(ValueError, match="finite"):
        delaunay(np.array([[0.0, 0.0], [1.0, np.nan], [0.0, 1.0]]))
