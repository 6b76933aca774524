"""Two clouds of one part: what has changed is told, what has not is not, at the level of detection that is stated."""

from dataclasses import replace

import numpy as np
import pytest

from core.errors import InputError
from core.model import Pose
from core.scan.surface.triangles import Triangles
from core.wings.geometry.comparison.compare import ComparisonScales, SurfacePoints, compare, sampled_surface
from tests.inspect.block_scan import NORMAL, TABLE_MM, BlockScan, axes
from tests.inspect.shape_scan import PIN, PIN_AXIS, PIN_RADIUS, ShapeScan

WEAR_MM = 0.1
USUAL = ComparisonScales()


def scan(seed, wear_mm=0.0, sweeps=60):
    """A block scanned by its own sweeps, with all their errors; a quarter of its upper face worn."""
    block = BlockScan(seed=seed, sweeps=sweeps)
    cloud = block.measure(np.random.default_rng(seed + 100))
    flat = block.points @ axes().T
    worn = block.upper & (flat > 0).all(axis=1)
    rays = cloud.points / np.linalg.norm(cloud.points, axis=1)[:, None]
    points = cloud.points + (wear_mm * worn / (rays @ NORMAL))[:, None] * rays
    cloud = replace(cloud, points=points, normals=np.tile(-NORMAL, (len(cloud), 1)))
    return SurfacePoints.of_cloud(cloud)


def places(found):
    """Which core points lie in the worn quarter, and which elsewhere, a radius from its edge."""
    flat, upper = found.points @ axes().T, found.points @ NORMAL < TABLE_MM - 20
    away = found.diameter_mm / 2
    return upper & (flat > away).all(axis=1), ~upper | (flat < -away).any(axis=1)


def test_wear_of_a_tenth_is_told_where_it_is():
    worn, elsewhere = [], []
    for seed in range(4):
        found = compare(scan(seed + 50, wear_mm=WEAR_MM), scan(seed), USUAL)
        inside, outside = places(found)
        worn += [(found.significant[inside].mean(), np.median(found.deviation[inside]))]
        elsewhere.append(found.significant[outside].mean())
        assert found.lower.share > 0
    shares, depths = np.transpose(worn)
    assert shares.mean() > 0.6
    assert depths.mean() == pytest.approx(-WEAR_MM, abs=0.03)
    assert np.mean(elsewhere) < 0.06


@pytest.mark.accuracy
def test_what_has_not_changed_is_called_changed_in_one_place_of_twenty_at_most():
    shares = [compare(scan(seed + 50), scan(seed), USUAL).significant.mean() for seed in range(24)]
    assert 0.005 < np.mean(shares) < 0.05


def test_a_bent_surface_is_no_deviation_though_the_stripes_lie_beside_each_other():
    def pin(seed, spacing):
        shape = ShapeScan(seed=seed, spacing_px=spacing)
        cloud = shape.measure(np.random.default_rng(seed), noise=0.0)
        keep = shape.on == 1
        exact = replace(cloud.select(keep), points=shape.points[keep])
        return SurfacePoints.of_cloud(exact)

    found = compare(pin(1, 9.0), pin(2, 11.0), USUAL)
    assert found.diameter_mm >= 6  # over which a pin of 15 mm bends by a third of a millimetre
    assert np.quantile(np.abs(found.deviation), 0.8) < 0.001
    # At its ends stripes lie on one side alone; what that may do is in u.
    assert not found.significant.any()
    from_axis = found.points - PIN - np.outer((found.points - PIN) @ PIN_AXIS, PIN_AXIS)
    assert np.linalg.norm(from_axis, axis=1) == pytest.approx(PIN_RADIUS, abs=0.01)


def test_dense_points_of_another_program_are_detected_by_the_published_formula():
    rng = np.random.default_rng(3)

    def plate(height, sd):
        flat = rng.uniform(-20, 20, (20_000, 2))
        points = np.column_stack([flat, height + rng.normal(0, sd, len(flat))])
        return SurfacePoints.bare(points, np.tile([0.0, 0.0, 1.0], (len(points), 1)))

    before, after = plate(0.0, 0.03), plate(0.05, 0.02)
    found = compare(after, before, ComparisonScales(diameter_mm=4.0, registration_mm=0.01))
    middle = np.abs(found.points[:, :2]).max(axis=1) < 17
    n1, n2 = found.counts[middle].T
    lod = 1.96 * np.sqrt(0.02**2 / n1 + 0.03**2 / n2 + 0.01**2)
    assert np.median(found.detectable[middle] / lod) == pytest.approx(1.0, abs=0.1)
    assert found.deviation[middle].mean() == pytest.approx(0.05, abs=0.002)
    assert found.significant[middle].all()


def test_a_point_where_sides_without_normals_meet_is_not_significant():
    """A block's edge in points of another program: those of the flank lie beside those of the top, but deeper."""
    rng = np.random.default_rng(4)
    flat = rng.uniform([-20, -20], [20, 0], (16_000, 2))
    top = np.column_stack([flat, np.zeros(len(flat))])
    flank = np.column_stack([rng.uniform(-20, 20, 16_000), np.zeros(16_000), rng.uniform(-20, 0, 16_000)])
    other = SurfacePoints.bare(np.vstack([top, flank]))
    noise = rng.normal(0, 0.01, len(flat))
    ours = SurfacePoints.bare(top + noise[:, None] * [0.0, 0.0, 1.0], np.tile([0.0, 0.0, 1.0], (len(top), 1)))
    found = compare(ours, other, ComparisonScales(diameter_mm=3.0))
    at_edge = found.points[:, 1] > -1.5
    assert np.abs(found.deviation[at_edge]).max() > 0.1  # what lies there is no one surface
    assert not found.significant[at_edge].any()
    assert found.detectable[~at_edge].max() < 0.02
    assert found.significant[~at_edge].mean() < 0.08


def test_a_tilt_of_one_on_the_other_is_the_registrations_and_not_significant():
    tilted = scan(7)
    turn = Pose.from_vector([0.003, 0.0, 0.0, 0.0, 0.0, 0.0])
    middle = Pose(np.eye(3), tilted.points.mean(axis=0))
    tilted = tilted.moved(middle @ turn @ middle.inverse())
    found = compare(tilted, scan(8), ComparisonScales())
    assert found.registration_mm > 0.05
    assert found.significant.mean() < 0.1


def test_triangles_are_sampled_evenly_and_lie_on_the_surface():
    corners = np.array([[[0, 0, 0], [30, 0, 0], [0, 30, 0]], [[0, 0, 5], [3, 0, 5], [0, 3, 5]]], dtype=float)
    found = sampled_surface(Triangles(corners), 0.25)
    low = found.points[:, 2] == 0
    assert len(found) == pytest.approx((450 + 4.5) / 0.25**2, rel=0.01)
    assert low.mean() == pytest.approx(450 / 454.5, abs=0.01)
    assert np.allclose(found.normals, [0, 0, 1])


def test_deviations_are_taken_over_to_the_points_near_them():
    found = compare(scan(51), scan(1), USUAL)
    points = np.vstack([found.points[:5], [[0.0, 0.0, 0.0]]])
    deviation, significant = found.at(points)
    assert deviation[:5] == pytest.approx(found.deviation[:5])
    assert np.isnan(deviation[5])
    assert not significant[5]


def test_surfaces_that_nowhere_come_near_each_other_are_refused():
    far = scan(1)
    moved = far.moved(Pose(np.eye(3), np.array([0.0, 0.0, 300.0])))
    with pytest.raises(InputError, match=r"nowhere do both surfaces lie within 2 mm"):
        compare(far, moved, USUAL)
