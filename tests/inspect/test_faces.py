"""The two parallel faces: found among clutter, or given as polygons."""

from dataclasses import replace

import numpy as np
import pytest

from core.errors import InputError, OwnCause
from core.inspect import faces
from core.inspect.conformity import Limits, Verdict
from core.inspect.evaluate import evaluate
from core.inspect.face_region import Region, region_on
from core.inspect.faces import faces_in_polygons, find_faces
from core.inspect.fit.plane_search import FoundPlane, find_planes
from core.inspect.gauge import measure_gauge
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.uncertainty.point_errors import PointErrors
from core.model.arrays import Array
from core.scan.surface.cloud import FAN, Cloud
from core.scan.surface.normals import with_normals
from core.scan.surface.triangulate import join
from tests.inspect.block_scan import FOCAL, HALF, NORMAL, TABLE_MM, BlockScan, axes, cloud_at, pixels, square


@pytest.fixture(scope="module")
def scan():
    return BlockScan(height=40.0, sweeps=40)


def joined(*clouds):
    return Cloud(
        *(
            np.concatenate([getattr(cloud, name) for cloud in clouds])
            for name in ("points", "uv", "sigma", "intensity", "frame", "sweep", "normals")
        )
    )


def sphere(centre, radius, count, rng):
    """Points of the half of a sphere that faces the camera, thinned evenly over the picture."""
    flat = rng.uniform(-radius, radius, (count, 2))
    flat = flat[(flat**2).sum(axis=1) < (0.95 * radius) ** 2]
    z = -np.sqrt(radius**2 - (flat**2).sum(axis=1))
    return centre + np.column_stack([flat, z])


def heights(cloud, indices):
    return TABLE_MM - cloud.points[indices] @ NORMAL


def swept(cloud, *, of_fan):
    """The cloud with so many of its first points of the fan, and the others of sweeps."""
    return replace(cloud, sweep=np.where(np.arange(len(cloud)) < of_fan, FAN, np.maximum(cloud.sweep, 0)))


def test_block_and_table_are_found(scan):
    cloud = scan.measure(np.random.default_rng(0))
    pair = find_faces(cloud)
    assert scan.upper[pair.upper].all()
    assert not scan.upper[pair.lower].any()
    assert len(pair.upper) > 0.7 * scan.upper.sum()


def test_points_near_the_edges_are_left_out(scan):
    cloud = scan.measure(np.random.default_rng(1), noise=1e-4, plane_errors=False)
    for margin in (1.5, 5.0):
        pair = find_faces(cloud, margin_mm=margin)
        outermost = np.abs(cloud.points[pair.upper] @ axes().T).max()
        assert HALF - margin - 1.5 < outermost < HALF - margin + 0.5


@pytest.mark.parametrize("outlined", [False, True])
def test_a_table_that_no_sweep_reaches_is_known_by_the_lines_of_the_fan(scan, outlined):
    """They lie farther apart than any gap between stripes; each is cut at its own ends."""
    cloud = scan.measure(np.random.default_rng(3), noise=1e-4, plane_errors=False)
    seen = cloud.select(scan.upper | (cloud.sweep <= FAN))
    beside = np.array([[-HALF, HALF], [HALF, HALF], [HALF, scan.reach], [-HALF, scan.reach]])
    pair = find_faces(seen)
    if outlined:
        pair = faces_in_polygons(seen, scan.polygons[0], pixels(TABLE_MM * NORMAL + beside @ axes()))
    on_table = seen.select(pair.lower)
    assert set(on_table.sweep.tolist()) == {FAN, FAN - 1, FAN - 2}
    assert np.abs(heights(seen, pair.lower)).max() < 0.1
    along = on_table.points @ axes()[1]
    assert scan.reach - 1.5 - 2 * 0.45 < np.abs(along).max() <= scan.reach - 1.5
    assert len(pair.lower) > (0.4 if outlined else 0.8) * np.count_nonzero(~scan.upper & (cloud.sweep <= FAN))


def test_a_table_that_one_line_alone_reaches_is_no_face(scan):
    """What lies on one line lies in its plane of light as well."""
    cloud = scan.measure(np.random.default_rng(3))
    with pytest.raises(InputError, match="plane face is in view"):
        find_faces(cloud.select(scan.upper | (cloud.sweep == FAN)))


def levels(sweeps, count=2, width=25.0):
    """Levels side by side, 18° from the fan's line amid the one to that amid the next, with sweeps across all."""
    rng = np.random.default_rng(0)
    reach, rise, half = 60.0, width * np.tan(np.radians(18.0)), count * width / 2
    along = np.arange(-reach, reach, 0.2)
    amid = (np.arange(count) + 0.5) * width - half
    lines = [(np.full(len(along), x), along, FAN - k) for k, x in enumerate(amid[:3])]
    for sweep in range(sweeps):
        across = np.arange(-half, half, 0.2)
        lines.append((across, (sweep + 0.5) / sweeps * reach + rng.uniform(-0.6, 0.6) * across, sweep))
    flat = np.vstack([np.column_stack([x, y]) for x, y, _ in lines])
    points = TABLE_MM * NORMAL + flat @ axes() - np.floor((flat[:, :1] + half) / width) * rise * NORMAL
    points += rng.normal(scale=1e-3, size=points.shape)
    stripe = np.repeat([number for *_, number in lines], [len(x) for x, *_ in lines])
    return replace(cloud_at(points), sweep=stripe)


@pytest.mark.parametrize("sweeps", [3, 10, 40])
def test_nothing_is_left_of_a_plane_that_slants_through_lines_of_the_fan_on_swept_levels(sweeps):
    cloud = levels(sweeps)
    normal = NORMAL + np.tan(np.radians(18.0)) * axes()[0]
    normal /= np.linalg.norm(normal)
    distance = float(np.median(cloud.points[cloud.sweep <= FAN] @ normal))
    near = np.flatnonzero(np.abs(cloud.points @ normal - distance) < 0.25)
    assert len(np.unique(cloud.sweep[near][cloud.sweep[near] <= FAN])) == 2
    assert len(region_on(cloud, near, normal, 1.5).indices) == 0
    assert all(abs(plane.normal @ NORMAL) > np.cos(np.radians(1.0)) for plane in find_planes(cloud))


@pytest.mark.parametrize("sweeps", [3, 10, 40])
@pytest.mark.parametrize(("count", "width"), [(2, 18.0), (3, 15.0), (5, 10.0), (5, 6.0)])
def test_no_plane_that_slants_through_treads_narrower_than_a_covered_gap_is_a_face(count, width, sweeps):
    """Lines of the fan on the treads cover such a plane, but most of what sweeps show there lies off it.

    The treads themselves are found where they are swept densely; three sweeps show too little of any.
    """
    found = find_planes(levels(sweeps, count, width))
    assert all(abs(plane.normal @ NORMAL) > np.cos(np.radians(1.0)) for plane in found)
    if sweeps == 40 or (sweeps == 10 and width >= 10.0):
        rise = width * np.tan(np.radians(18.0))
        assert {round((TABLE_MM - plane.distance) / rise) for plane in found} == set(range(count))


def test_single_wrong_points_of_sweeps_on_a_face_that_none_reaches_do_not_matter(scan):
    cloud = scan.measure(np.random.default_rng(3), noise=1e-4, plane_errors=False)
    of_fan = np.flatnonzero(~scan.upper & (cloud.sweep <= FAN))
    stray = np.flatnonzero(~scan.upper & (cloud.sweep > FAN))[::2000]
    assert 2 < len(stray) < 0.01 * len(of_fan)
    alone = region_on(cloud, of_fan, NORMAL, 1.5)
    assert len(alone.indices) > 0.8 * len(of_fan)
    with_stray = region_on(cloud, np.sort(np.concatenate([of_fan, stray])), NORMAL, 1.5)
    assert np.array_equal(with_stray.indices, alone.indices)


def test_wrong_points_do_not_matter(scan):
    cloud = scan.measure(np.random.default_rng(2), outliers=0.15)
    pair = find_faces(cloud)
    assert np.median(heights(cloud, pair.upper)) == pytest.approx(40.0, abs=0.03)
    assert np.median(heights(cloud, pair.lower)) == pytest.approx(0.0, abs=0.03)
    assert np.abs(heights(cloud, pair.upper) - 40).max() < 1.0


def test_a_sphere_beside_the_block_is_no_face(scan):
    rng = np.random.default_rng(3)
    ball = sphere(np.array([55.0, -60.0, 515.0]), 25.0, 6000, rng)
    cloud = joined(scan.measure(rng), cloud_at(ball))
    pair = find_faces(cloud)
    assert scan.upper[pair.upper].all()
    assert len(pair.upper) > 0.6 * scan.upper.sum()


def test_the_same_seed_gives_the_same_faces(scan):
    cloud = scan.measure(np.random.default_rng(4))
    first, second = find_faces(cloud, seed=5), find_faces(cloud, seed=5)
    assert first.upper.tobytes() == second.upper.tobytes()
    assert first.lower.tobytes() == second.lower.tobytes()


def test_another_seed_gives_nearly_the_same_faces(scan):
    cloud = scan.measure(np.random.default_rng(4))
    first, second = find_faces(cloud, seed=5), find_faces(cloud, seed=6)
    assert len(np.setxor1d(first.upper, second.upper)) < 0.03 * len(first.upper)


def test_a_bare_table_is_only_one_face(scan):
    cloud = scan.measure(np.random.default_rng(5))
    with pytest.raises(InputError, match=r"only 1 plane face is in view.*cross both faces") as refused:
        find_faces(swept(cloud.select(~scan.upper), of_fan=0))
    assert not isinstance(refused.value, OwnCause)  # no light of the fan tells that nothing else is there


def test_that_the_fan_meets_but_one_face_is_its_own_cause(scan):
    whole = scan.measure(np.random.default_rng(5))
    table, top = whole.select(~scan.upper), whole.select(scan.upper)
    of_fan = swept(table, of_fan=100)
    with pytest.raises(OwnCause, match="only 1 plane face is in view"):
        find_faces(of_fan)
    few = swept(top.select(np.arange(len(top)) < 8), of_fan=8)  # the fan is on the part, too, but hardly a sweep
    with pytest.raises(InputError, match="only 1 plane face is in view") as refused:
        find_faces(joined(of_fan, few))
    assert not isinstance(refused.value, OwnCause)


@pytest.mark.parametrize("degrees", [4.0, 12.0])
def test_a_face_that_lies_askew_is_named_with_its_angle(scan, degrees):
    cloud = scan.measure(np.random.default_rng(5))
    across = axes()[0]
    leaned = (
        cloud.points - np.where(scan.upper, cloud.points @ across * np.tan(np.radians(degrees)), 0)[:, None] * NORMAL
    )
    with pytest.raises(OwnCause, match=rf"the upper face lies {degrees:.1f}° against the table.*lay the part flat"):
        find_faces(with_normals(replace(cloud, points=leaned, normals=np.zeros_like(cloud.normals))))


def test_a_sphere_on_a_table_has_no_two_parallel_faces(scan):
    rng = np.random.default_rng(6)
    ball = sphere(np.array([0.0, -110.0, 520.0]), 25.0, 6000, rng)
    table = scan.measure(rng).select(~scan.upper)
    with pytest.raises(InputError, match=r"\d plane faces? (is|are) in view"):
        find_faces(joined(table, cloud_at(ball)))


def test_hardly_any_points_are_no_faces():
    with pytest.raises(InputError, match=r"\d plane faces? (is|are) in view"):
        find_faces(cloud_at(np.array([[0.0, 0.0, 500.0], [1.0, 0.0, 500.0]])))
    with pytest.raises(InputError, match=r"\d plane faces? (is|are) in view"):
        find_faces(cloud_at(np.zeros((0, 3))))


def test_polygons_choose_the_faces(scan):
    cloud = scan.measure(np.random.default_rng(7))
    beside = square(TABLE_MM, 14.0) + [0.0, FOCAL * 52 / TABLE_MM]
    pair = faces_in_polygons(cloud, square(TABLE_MM - 40, 12.0), beside)
    assert scan.upper[pair.upper].all()
    assert not scan.upper[pair.lower].any()
    flat = np.abs(cloud.points[pair.upper] @ axes().T).max(axis=1)
    assert 11 < flat.max() < 12.2


def test_a_polygon_may_reach_over_the_edge(scan):
    cloud = scan.measure(np.random.default_rng(8), noise=1e-4, plane_errors=False)
    pair = faces_in_polygons(cloud, square(TABLE_MM - 40, HALF + 5), square(TABLE_MM, 70.0), margin_mm=3.0)
    assert scan.upper[pair.upper].all()
    assert np.abs(cloud.points[pair.upper] @ axes().T).max() < HALF - 2.5


def test_polygons_that_hold_nothing_are_named(scan):
    cloud = scan.measure(np.random.default_rng(9))
    nothing = [[0, 0], [5, 0], [5, 5]]
    with pytest.raises(InputError, match=r"upper_polygon_px.*no plane face"):
        faces_in_polygons(cloud, nothing, square(TABLE_MM, 70.0))
    with pytest.raises(InputError, match=r"lower_polygon_px.*three corners"):
        faces_in_polygons(cloud, square(TABLE_MM - 40, 20.0), [[0, 0], [5, 0]])


def test_polygons_over_one_and_the_same_face_are_refused(scan):
    cloud = scan.measure(np.random.default_rng(0))
    corners = square(TABLE_MM, scan.reach)
    with pytest.raises(InputError, match=r"one and the same face.*over a face of its own"):
        faces_in_polygons(cloud, corners, corners + 2.0)


def test_a_face_with_hardly_a_point_away_from_its_edges_is_none(scan, monkeypatch):
    cloud = scan.measure(np.random.default_rng(7))
    pair = find_faces(cloud)
    sparse = (
        FoundPlane(NORMAL, TABLE_MM - 40.0, Region(pair.upper, 2000.0)),
        FoundPlane(NORMAL, TABLE_MM, Region(pair.lower[:2], 2000.0)),
    )
    monkeypatch.setattr(faces, "find_planes", lambda *_, **__: sparse)
    with pytest.raises(InputError, match=r"\d plane faces? (is|are) in view"):
        find_faces(cloud)


def two_blocks() -> tuple[Cloud, Array]:
    """A block of 40 mm, and beside it on the table another of 25 mm that is about as large."""
    tall = BlockScan(height=40.0, sweeps=30)
    cloud = tall.measure(np.random.default_rng(0))
    beside = tall.points - (TABLE_MM - tall.height) * NORMAL
    flat = beside @ axes().T
    top = cloud.select(tall.upper & (np.abs(flat[:, 0]) < HALF - 4))
    moved = top.points + 15.0 * NORMAL + 75.0 * axes()[1]
    second = replace(top, points=moved, uv=pixels(moved))
    cloud = join(
        [cloud.select(~(np.linalg.norm(cloud.points - moved.mean(axis=0), axis=1) < 55.0) | tall.upper), second]
    )
    return cloud, tall.covariance


def test_of_two_blocks_that_near_the_nominal_is_measured_and_proves_nothing() -> None:
    cloud, covariance = two_blocks()
    for nominal in (40.0, 25.0):
        gauge = measure_gauge(cloud, errors=PointErrors(covariance), nominal_mm=nominal, tolerance_mm=1.0)
        other = 65.0 - nominal
        assert gauge.thickness_mm == pytest.approx(nominal, abs=0.1)
        assert gauge.verdict == Verdict.NOT_PROVEN
        assert [round(one.thickness_mm) for one in gauge.candidates][:1] == [nominal]
        assert other in [round(one.thickness_mm) for one in gauge.candidates]
        assert f"one of {nominal:.1f} mm" in " ".join(map(str, gauge.notes))
        u, v = gauge.candidates[0].upper_px
        amid = cloud.uv[gauge.upper.indices].mean(axis=0)
        assert (u, v) == pytest.approx(tuple(amid), abs=20.0)


def test_a_face_of_a_board_beside_the_part_is_not_meant_where_there_is_another() -> None:
    cloud, _ = two_blocks()
    asked = find_faces(cloud, nominal_mm=25.0)
    assert len(asked.candidates) > 1
    beside = np.zeros(len(cloud), dtype=bool)
    beside[asked.upper] = True
    found = find_faces(cloud, nominal_mm=25.0, beside=beside)
    assert not beside[found.upper].any() and len(found.candidates) < len(asked.candidates)
    alone = find_faces(cloud, nominal_mm=25.0, beside=np.ones(len(cloud), dtype=bool))
    assert np.array_equal(alone.upper, asked.upper), "a part that stands on a board is measured from it"


def test_a_pair_whose_outlines_are_taken_as_regions_is_confirmed() -> None:
    cloud, covariance = two_blocks()
    asked = measure_gauge(cloud, errors=PointErrors(covariance), nominal_mm=40.0, tolerance_mm=1.0)
    other = next(one for one in asked.candidates if round(one.thickness_mm) == 25)
    upper, lower = other.outlines_px
    errors = PointErrors(covariance)
    gauge = measure_gauge(cloud, errors=errors, regions=(upper, lower), nominal_mm=25.0, tolerance_mm=1.0)
    assert gauge.thickness_mm == pytest.approx(25.0, abs=0.1)
    assert not gauge.candidates and "several_faces" not in {doubt.fact for doubt in gauge.doubts}


def test_another_nominal_chooses_another_pair_of_a_plan_again() -> None:
    cloud, covariance = two_blocks()
    before = None
    for nominal in (40.0, 25.0):
        limits = (("thickness", Limits(nominal, -1.0, 1.0)),)
        plan = InspectionPlan((FeatureSpec("block", "thickness", limits=limits),))
        before = evaluate(plan, cloud, errors=PointErrors(covariance), previous=before)
        (row,) = before.characteristics
        assert row.value == pytest.approx(nominal, abs=0.1)
        assert row.verdict == Verdict.NOT_PROVEN
