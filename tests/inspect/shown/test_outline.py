"""Outlines of chosen points: few corners round the face they lie on, good enough to measure in."""

import numpy as np
import pytest

from core.errors import InputError
from core.inspect.face_region import inside_polygon, on_face
from core.inspect.faces import faces_in_polygons
from core.inspect.shown.outline import MOST_CORNERS, face_outline, outline_px
from core.scan.surface.normals import with_normals
from tests.inspect.block_scan import NORMAL, TABLE_MM, BlockScan


@pytest.fixture(scope="module")
def scan():
    return BlockScan(height=40.0, sweeps=40)


@pytest.fixture(scope="module")
def cloud(scan):
    return with_normals(scan.measure(np.random.default_rng(0)))


def area(polygon):
    u, v = polygon.T
    return 0.5 * abs(u @ np.roll(v, 1) - v @ np.roll(u, 1))


def stripes(width, height, spacing):
    """Places along upright stripes."""
    u, v = np.meshgrid(np.arange(0, width + 1, spacing), np.arange(0, height + 1, 1.0))
    return np.column_stack([u.ravel(), v.ravel()])


def test_stripes_over_a_rectangle_give_the_rectangle():
    outline = outline_px(stripes(300, 200, 15) + [40, 60])
    assert 4 <= len(outline) <= 8
    assert area(outline) == pytest.approx(300 * 200, rel=0.08)
    assert outline.dtype == np.float64
    assert outline.min(axis=0) == pytest.approx([40, 60], abs=8)
    assert outline.max(axis=0) == pytest.approx([340, 260], abs=8)


def test_the_outline_follows_a_notch():
    places = stripes(300, 300, 6)
    notched = places[~((places[:, 0] > 150) & (places[:, 1] > 150))]
    outline = outline_px(notched)
    assert area(outline) == pytest.approx(0.75 * 300**2, rel=0.06)
    assert not inside_polygon(np.array([[240.0, 240.0]]), outline)[0]


def test_holes_are_filled_and_corners_are_few(scan, cloud):
    outline = outline_px(cloud.uv[~scan.upper])
    assert len(outline) <= MOST_CORNERS
    assert inside_polygon(cloud.uv[scan.upper], outline).all()


def test_ragged_points_still_have_few_corners():
    rng = np.random.default_rng(2)
    angle, radius = rng.uniform(0, 2 * np.pi, 4000), rng.uniform(0, 1, 4000) ** 0.5
    radius *= 200 + 60 * np.sin(11 * angle)
    outline = outline_px(np.column_stack([np.cos(angle), np.sin(angle)]) * radius[:, None] + 400)
    assert 3 <= len(outline) <= MOST_CORNERS


def test_points_on_one_line_have_no_outline():
    line = np.column_stack([np.arange(50.0), 2 * np.arange(50.0)])
    with pytest.raises(InputError, match="on one line"):
        outline_px(line)
    with pytest.raises(InputError, match="on one line"):
        outline_px(line[:2])


def test_a_lasso_round_the_block_means_the_block_though_more_of_the_table_is_behind_it(scan, cloud):
    table = np.flatnonzero(~scan.upper)
    order = table[np.argsort(cloud.uv[table, 1])]
    behind = order[: int(0.4 * len(table))]  # what lies behind the block as seen from a low corner
    chosen = np.concatenate([np.flatnonzero(scan.upper), behind])
    assert len(behind) > np.count_nonzero(scan.upper)
    inside = inside_polygon(cloud.uv, face_outline(cloud, chosen, "upper"))
    assert scan.upper[inside].mean() > 0.97
    assert inside[scan.upper].mean() > 0.8


def test_of_faces_chosen_as_a_whole_the_upper_one_is_nearer_to_the_camera(scan, cloud):
    everything = np.arange(len(cloud))
    upper = inside_polygon(cloud.uv, face_outline(cloud, everything, "upper"))
    lower = inside_polygon(cloud.uv, face_outline(cloud, everything, "lower"))
    assert scan.upper[upper].mean() > 0.97
    assert lower[~scan.upper].mean() > 0.8


def test_the_faces_outlines_give_the_faces_back(scan, cloud):
    upper = face_outline(cloud, np.flatnonzero(scan.upper), "upper")
    lower = face_outline(cloud, np.flatnonzero(~scan.upper), "lower")
    pair = faces_in_polygons(cloud, upper, lower)
    assert scan.upper[pair.upper].all()
    assert not scan.upper[pair.lower].any()
    assert len(pair.upper) > 0.5 * scan.upper.sum()


def test_without_a_plane_face_it_says_so(cloud):
    with pytest.raises(InputError, match="no plane face among the 5 chosen points"):
        face_outline(cloud, np.arange(5), "upper")


def test_a_point_belongs_to_a_face_near_its_plane_and_near_its_points(scan, cloud):
    used = cloud.points[scan.upper]
    height = TABLE_MM - scan.height
    on = on_face(cloud.points, used, NORMAL, height)
    assert on[scan.upper].mean() > 0.99
    assert not on[~scan.upper].any()
    far = used[:3] + 60.0 * np.cross(NORMAL, [0.0, 1.0, 0.0])
    assert not on_face(far, used, NORMAL, height).any()
    assert not on_face(used, used[:2], NORMAL, height).any()
