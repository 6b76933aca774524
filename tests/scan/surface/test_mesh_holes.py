"""Holes filled on request and marked, and meshes of fewer triangles with the error stated."""

import numpy as np
import pytest

from core.errors import InputError
from core.scan.surface.decimation import decimate, decimate_to
from core.scan.surface.fused_surface import Mesh
from core.scan.surface.mesh import vertex_normals
from core.scan.surface.mesh_holes import fill_holes, holes
from core.scan.surface.triangles import ProximityQuery, Triangles


def surface(height, side=41, without=()):
    """A mesh of unit squares in front of the camera, z = 500 − height; `without` (middle, half side): missing."""
    x, y = np.meshgrid(np.arange(side) - side // 2.0, np.arange(side) - side // 2.0)
    vertices = np.column_stack([x.ravel(), y.ravel(), (500 - height(x, y)).ravel()])
    a = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    middle = vertices[a, :2] + 0.5
    kept = a[~np.any([np.abs(middle - place).max(axis=1) < half for place, half in without] or [a < 0], axis=0)]
    # seen from the camera, which looks along z, (b − a) × (c − a) points towards it: −z
    triangles = np.vstack(
        [np.column_stack([kept, kept + side, kept + 1]), np.column_stack([kept + 1, kept + side, kept + side + 1])]
    )
    return Mesh(vertices, vertex_normals(vertices, triangles), np.full(len(vertices), 0.01), triangles)


def bowl(x, y):
    return 0.01 * (x**2 + y**2)


HOLED = surface(bowl, without=[((0.0, 0.0), 3.0), ((12.0, -11.0), 1.5)])


def test_only_small_holes_are_filled_and_marked():
    assert sorted(len(ring) for ring in holes(HOLED)) == [8, 24]
    small = fill_holes(HOLED, 5.0)
    assert small.filled.sum() == 8 - 2
    assert len(holes(small)) == 1
    both = fill_holes(HOLED, 10.0)
    assert holes(both) == []
    assert both.filled.sum() == (8 - 2) + (24 - 2)
    assert np.array_equal(both.triangles[: len(HOLED.triangles)], HOLED.triangles)
    assert not both.filled[: len(HOLED.triangles)].any()
    facing = both.triangles[both.filled]
    a, b, c = (both.vertices[facing[:, corner]] for corner in range(3))
    assert (np.cross(b - a, c - a)[:, 2] <= 1e-9).all()


def test_measured_vertices_are_those_of_measured_triangles():
    filled = fill_holes(HOLED, 10.0)
    assert np.array_equal(filled.measured, HOLED.measured)
    assert not filled.measured.all()  # the middles of the holes have vertices that no triangle uses


def test_the_outer_edge_and_a_rim_over_a_step_stay_open():
    assert holes(surface(bowl)) == []
    step = surface(lambda x, y: np.where(x > 0, 30.0, 0.0), without=[((0.0, 0.0), 2.0)])
    assert len(holes(step)) == 1
    assert fill_holes(step, 100.0).filled.sum() == 0


def test_the_stated_error_of_a_decimated_mesh_is_that_of_its_worst_vertex():
    whole = surface(lambda x, y: 3 * np.sin(x / 6) * np.cos(y / 7))
    result = decimate(whole, 400)
    assert len(result.mesh.triangles) < 450
    corners = result.mesh.vertices[result.mesh.triangles]
    away = np.abs(ProximityQuery(Triangles(corners)).nearest(whole.vertices).distance)
    assert len(corners) > 360
    assert max(result.largest_mm, result.edge_mm) == pytest.approx(away.max())
    assert 0 < result.most_mm < result.largest_mm < 0.3
    assert (result.mesh.normals[:, 2] < 0).all()


def test_fewest_triangles_for_an_error():
    whole = surface(lambda x, y: 3 * np.sin(x / 6) * np.cos(y / 7))
    fine, coarse = decimate_to(whole, 0.02), decimate_to(whole, 0.2)
    assert max(fine.largest_mm, fine.edge_mm) <= 0.02
    assert max(coarse.largest_mm, coarse.edge_mm) <= 0.2
    assert len(coarse.mesh.triangles) < len(fine.mesh.triangles) < len(whole.triangles)


@pytest.mark.parametrize(("height", "most_mm"), [(lambda x, y: 0 * x, 1e-3), (bowl, 0.1)])
@pytest.mark.parametrize("without", [[], [((3.0, 2.0), 5.0)]])
def test_the_border_stays_when_decimated(height, most_mm, without):
    """A flat square must stay that square, and a hole in it that hole: no quadric of a plane says so."""
    whole = surface(height, without=without)
    result = decimate(whole, 60)
    assert result.edge_mm < most_mm
    assert 40 < len(result.mesh.triangles) < 80
    corners = result.mesh.vertices[result.mesh.triangles]
    used = np.unique(whole.triangles)
    assert np.abs(ProximityQuery(Triangles(corners)).nearest(whole.vertices[used]).distance).max() < 0.5
    assert flat_area(result.mesh) == pytest.approx(flat_area(whole), rel=0.005)


def flat_area(mesh):
    a, b, c = (mesh.vertices[mesh.triangles[:, corner], :2] for corner in range(3))
    return 0.5 * np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]).sum()


def test_pieces_that_touch_in_one_corner_keep_their_borders():
    whole = surface(lambda x, y: 0 * x, without=[((-10.5, 10.5), 10.5), ((10.5, -10.5), 10.5)])
    result = decimate(whole, 40)
    assert result.edge_mm < 1e-3
    assert flat_area(result.mesh) == pytest.approx(flat_area(whole), rel=1e-3)


def test_filled_triangles_stay_marked_when_decimated():
    result = decimate(fill_holes(HOLED, 10.0), 600)
    middles = result.mesh.vertices[result.mesh.triangles].mean(axis=1)[result.mesh.filled]
    assert len(middles)
    near = np.minimum(np.abs(middles[:, :2]).max(axis=1), np.abs(middles[:, :2] - [12, -11]).max(axis=1))
    assert near.max() < 5.0


def test_absurd_wishes_are_refused():
    with pytest.raises(InputError, match="no surface"):
        decimate(HOLED, 2)
    with pytest.raises(InputError, match="allow more"):
        decimate_to(HOLED, 0.0)
