import numpy as np
import pytest

from core.inspect.shown.seen_from import SeenFrom
from core.inspect.shown.view_frame import Ground
from core.model import LightPlane
from core.report.plots.surface_view import left_viewpoint, surface_picture, viewer_axes
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh

TABLE = LightPlane.from_normal([0.1, -0.2, 0.97], 560.0)


def mesh_over_table(height, half=40.0, cells=20):
    """A square mesh whose height above the table is a function of its two coordinates."""
    ground = Ground.of(TABLE, np.zeros((0, 3)))
    a, b = np.meshgrid(np.linspace(-half, half, cells + 1), np.linspace(-half, half, cells + 1))
    local = np.column_stack([a.ravel(), b.ravel(), height(a, b).ravel()])
    points = local @ ground.axes + ground.origin
    index = np.arange(len(points)).reshape(a.shape)
    p, q, r, s = (x.ravel() for x in (index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]))
    triangles = np.vstack([np.column_stack([p, q, r]), np.column_stack([q, s, r])])
    normals = np.tile(-TABLE.normal, (len(points), 1))
    return Mesh(points, normals, np.zeros(len(points)), triangles), ground


def cloud_of(mesh):
    count = len(mesh.vertices)
    zeros = np.zeros(count)
    return Cloud(mesh.vertices, np.zeros((count, 2)), zeros, zeros, zeros, zeros, mesh.normals)


def where(picture, ground_point):
    """Row and column of the picture at which a point of the ground's frame is seen."""
    seen = viewer_axes() @ np.asarray(ground_point, dtype=float)
    left, right, bottom, top = picture.extent
    rows, columns = picture.height.shape
    column = (seen[0] - left) / (right - left) * columns - 0.5
    row = (top - seen[1]) / (top - bottom) * rows - 0.5
    return round(row), round(column)


def test_viewer_stands_above_the_ground():
    axes = viewer_axes()
    assert np.allclose(axes @ axes.T, np.eye(3))
    assert np.linalg.det(axes) == pytest.approx(1)
    assert axes[2, 2] > 0.5
    assert axes[0, 2] == 0


def test_a_plane_is_seen_whole_without_holes_and_at_its_height():
    mesh, ground = mesh_over_table(lambda a, b: 0.1 * a)
    picture = surface_picture(mesh, cloud_of(mesh), ground, 400, 1.6)
    for a, b in ((0, 0), (-35, 30), (35, -30)):
        assert picture.height[where(picture, (a, b, 0.1 * a))] == pytest.approx(0.1 * a, abs=0.1)
    filled = np.isfinite(picture.height)
    inside = filled.cumsum(axis=1).astype(bool) & filled[:, ::-1].cumsum(axis=1)[:, ::-1].astype(bool)
    assert (filled == inside).all()  # convex outline: no gap within any row
    left, right, bottom, top = picture.extent
    area_px = (right - left) * (top - bottom) / picture.height.size
    # foreshortened area of the tilted square
    along = np.array([[80, 0, 8], [0, 80, 0]]) @ viewer_axes()[:2].T
    assert filled.sum() * area_px == pytest.approx(abs(np.linalg.det(along)), rel=0.02)


def test_the_nearer_surface_hides_the_farther():
    low, ground = mesh_over_table(lambda a, b: np.zeros_like(a))
    high, _ = mesh_over_table(lambda a, b: np.full_like(a, 20.0), half=10.0)
    both = Mesh(
        np.vstack([high.vertices, low.vertices]),
        np.vstack([high.normals, low.normals]),
        np.zeros(len(high.vertices) + len(low.vertices)),
        np.vstack([high.triangles, low.triangles + len(high.vertices)]),
    )
    picture = surface_picture(both, cloud_of(both), ground, 400, 1.6)
    assert picture.height[where(picture, (0, 0, 20))] == pytest.approx(20)
    assert picture.height[where(picture, (-30, -30, 0))] == pytest.approx(0, abs=1e-6)


def test_without_triangles_the_points_are_drawn():
    mesh, ground = mesh_over_table(lambda a, b: np.full_like(a, 5.0), cells=60)
    bare = Mesh(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), np.zeros((0, 3), np.int64))
    picture = surface_picture(bare, cloud_of(mesh), ground, 300, 1.6)
    assert np.nanmax(np.abs(picture.height - 5)) < 1e-6
    assert np.isfinite(picture.height).mean() > 0.2


def test_a_face_towards_the_lamp_is_brighter():
    ground = Ground.of(TABLE, np.zeros((0, 3)))
    mesh, _ = mesh_over_table(lambda a, b: np.zeros_like(a))
    tilted = Mesh(mesh.vertices, np.tile(ground.axes[0], (len(mesh.vertices), 1)), mesh.sigma, mesh.triangles)
    bright = np.nanmean(surface_picture(mesh, cloud_of(mesh), ground, 200, 1.6).shade)
    dark = np.nanmean(surface_picture(tilted, cloud_of(tilted), ground, 200, 1.6).shade)
    assert bright > dark + 0.1


def test_nothing_to_draw_is_an_error():
    bare = Mesh(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), np.zeros((0, 3), np.int64))
    with pytest.raises(ValueError, match="neither"):
        surface_picture(bare, cloud_of(bare), Ground.of(None, np.zeros((0, 3))), 100, 1.6)


@pytest.mark.parametrize("aspect", [0.8, 1.5, 2.5])
def test_a_view_left_in_3d_shows_all_that_was_in_sight_from_the_same_side(aspect):
    mesh, ground = mesh_over_table(lambda a, b: 0 * a + 3.0)
    straight = SeenFrom(ground.axes, ground.origin, 60.0, 1.5)
    picture = surface_picture(
        mesh, cloud_of(mesh), ground, 300, aspect, viewpoint=left_viewpoint(straight, ground, aspect)
    )
    left, right, bottom, top = picture.extent
    assert right - left >= 2 * 60.0 * 1.5 - 1e-9 and top - bottom >= 2 * 60.0 - 1e-9
    rows, columns = np.nonzero(np.isfinite(picture.height))
    scale = picture.height.shape[1] / (right - left)
    assert np.ptp(columns) / scale == pytest.approx(80.0, abs=1.5), "from above the square is one of 80 mm"
    assert np.ptp(rows) / scale == pytest.approx(80.0, abs=1.5)
    np.testing.assert_allclose(picture.height[np.isfinite(picture.height)], 3.0, atol=1e-6)
