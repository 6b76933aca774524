"""What the 3D view reckons for drawing: projection, samples, colours, choices, shapes."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from core.inspect.shown.view_frame import FrameKind, ViewFrame
from core.model import Camera, LightPlane, Pose
from workbench.views.scene.camera import FROM_CAMERA, Orientation, SceneCamera, from_origin
from workbench.views.scene.chooser import Outline, nearest_point, points_inside
from workbench.views.scene.cloud import CHUNK, SceneCloud
from workbench.views.scene.colours import UNKNOWN, Colouring, table, ticks
from workbench.views.scene.contents import Scene, as_mesh
from workbench.views.scene.passes import TRIANGLES, Part, all_parts, gather, quick_pass, size, whole_passes
from workbench.views.scene.shapes import frustum, ground_grid, plane_patch

SIZE = (800, 600)
RNG = np.random.default_rng(7)
BOX = RNG.random((500, 3)) * [80, 60, 40] + [-40, -30, 400]


def looking(view: str) -> SceneCamera:
    back, up = FROM_CAMERA.direction(view)
    return SceneCamera.looking(back, up, (0, 0, 420), 300)


# ---- camera


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("view", ["front", "back", "left", "right", "top", "bottom", "iso"])
def test_a_fitted_view_shows_everything_and_wastes_little(view, parallel):
    camera = looking(view)
    camera = SceneCamera(camera.focal, camera.axes, camera.distance, parallel=parallel).fitted(BOX, SIZE, (100, 0))
    screen, depth = camera.project(BOX, SIZE)
    assert (depth > 0).all()
    assert (screen >= 0).all() and (screen[:, 0] <= SIZE[0] - 100).all() and (screen[:, 1] <= SIZE[1]).all()
    assert max(np.ptp(screen[:, 0]) / (SIZE[0] - 100), np.ptp(screen[:, 1]) / SIZE[1]) > 0.7


@pytest.mark.parametrize(
    ("view", "right", "up"),
    [
        ("top", (1, 0, 0), (0, -1, 0)),
        ("front", (1, 0, 0), (0, 0, -1)),
        ("back", (-1, 0, 0), (0, 0, -1)),
        ("left", (0, 1, 0), (0, 0, -1)),
        ("right", (0, -1, 0), (0, 0, -1)),
        ("bottom", (-1, 0, 0), (0, -1, 0)),
    ],
)
def test_standard_views_of_the_camera_frame(view, right, up):
    axes = looking(view).axes
    assert_allclose(axes[0], right, atol=1e-12)
    assert_allclose(axes[1], up, atol=1e-12)


def test_projection_is_that_of_a_pinhole():
    camera = SceneCamera.looking((0, 0, -1), (0, -1, 0), (0, 0, 500), 500)
    focal = 300 / np.tan(camera.view_angle / 2)
    screen, depth = camera.project([[10, 20, 400], [0, 0, -5]], SIZE)
    assert_allclose(screen[0], [400 + focal * 10 / 400, 300 + focal * 20 / 400])
    assert_allclose(depth, [400, -5])
    assert np.isnan(screen[1]).all()


def test_switching_the_projection_changes_no_size_where_the_view_turns_about():
    camera = looking("iso")
    points = np.array([camera.focal, camera.focal + 5 * camera.axes[0]])
    flat = SceneCamera(camera.focal, camera.axes, camera.distance, parallel=True)
    assert_allclose(camera.project(points, SIZE)[0], flat.project(points, SIZE)[0])


def test_zooming_keeps_what_is_under_the_cursor():
    camera = looking("top")
    at = np.array([[20.0, 10, 420]])
    before = camera.project(at, SIZE)[0][0]
    after = camera.zoomed(1.7, tuple(before), SIZE).project(at, SIZE)[0][0]
    assert_allclose(after, before, atol=1e-9)


def test_a_drag_moves_the_scene_with_the_mouse():
    camera = looking("front")
    middle = camera.focal[None]
    moved = camera.panned(30, -12, SIZE).project(middle, SIZE)[0][0]
    assert_allclose(moved, [430, 288])


def test_turning_stops_at_the_poles_and_stays_upright():
    camera = looking("front")
    for _ in range(30):
        camera = camera.orbited(17, 40, FROM_CAMERA.up)
    assert_allclose(camera.axes[2] @ FROM_CAMERA.up, 1, atol=1e-6)
    assert_allclose(camera.axes @ camera.axes.T, np.eye(3), atol=1e-12)


def test_what_the_camera_sees_fills_the_view_with_its_picture():
    real = Camera((1280, 1024), np.array([[2200.0, 0, 700], [0, 2200, 480], [0, 0, 1]]))
    pyramid = frustum(real, 600)
    seen = from_origin(BOX, SIZE, pyramid)
    assert_allclose(seen.position, 0, atol=1e-9)
    screen, _ = seen.project(pyramid[1:], SIZE)
    assert (screen > 0).all() and (screen < SIZE).all()
    assert np.ptp(screen[:, 1]) / SIZE[1] > 0.9 or np.ptp(screen[:, 0]) / SIZE[0] > 0.9


PART = ViewFrame(FrameKind.PART, Pose.from_vector([2.9, 0.3, -0.1, 12.0, -7.0, 440.0]))


@pytest.mark.parametrize(
    ("view", "right", "up"),
    [("top", "+x", "+y"), ("front", "+x", "+z"), ("right", "+y", "+z"), ("bottom", "-x", "+y")],
)
def test_standard_views_of_a_part_have_its_z_up(view, right, up):
    back, upward = Orientation.of(PART).direction(view)
    axes = SceneCamera.looking(back, upward, (0, 0, 420), 300).axes
    for seen, (sign, name) in zip(axes, (right, up), strict=False):
        assert_allclose(seen, float(f"{sign}1") * PART.axes["xyz".index(name)], atol=1e-12)


def test_a_view_turned_by_hand_looks_in_another_frame_as_it_did():
    first, second = FROM_CAMERA, Orientation.of(PART)
    camera = looking("iso").orbited(70, -15, first.up)
    turned = camera.turned(first, second)
    assert_allclose(second.axes @ turned.axes.T, first.axes @ camera.axes.T, atol=1e-12)
    assert_array_equal(turned.focal, camera.focal)


def test_the_grid_counts_from_the_origin_of_its_frame():
    lines, step = ground_grid(BOX, Orientation.of(PART))
    ends = PART.coordinates(np.vstack(lines.lines))
    assert_allclose(ends[:, :2], np.round(ends[:, :2] / step) * step, atol=1e-9)
    assert np.ptp(ends[:, 2]) < 1e-9 and ends[0, 2] < PART.coordinates(BOX)[:, 2].min()


# ---- cloud


def cloud_of(count: int) -> SceneCloud:
    points = np.column_stack([np.arange(count), np.zeros(count), np.full(count, 500.0)])
    return SceneCloud(points, np.arange(count, dtype=float), Colouring("n", "mm"))


def numbers(cloud: SceneCloud, chunk: int) -> np.ndarray:
    """Which of the given points are in a chunk."""
    return np.arange(cloud.given)[cloud.rows(chunk)]


@pytest.mark.parametrize("count", [0, 1, 999, CHUNK, CHUNK + 1, 200_003])
def test_every_point_is_in_one_chunk(count):
    cloud = cloud_of(count)
    drawn = np.concatenate([np.empty(0, dtype=np.int64), *(numbers(cloud, k) for k in range(cloud.chunks))])
    assert_array_equal(np.sort(drawn), np.arange(count))
    assert all(len(numbers(cloud, k)) == cloud.size(k) <= CHUNK for k in range(cloud.chunks))


def test_a_chunk_is_a_fair_sample_of_the_whole():
    share = np.histogram(numbers(cloud_of(400_000), 3), bins=20, range=(0, 400_000))[0] / CHUNK
    assert_allclose(share, 1 / 20, atol=0.02)


def test_points_that_are_not_finite_are_never_drawn_and_keep_their_numbers():
    points = BOX.copy()
    points[[3, 77]] = np.nan
    cloud = SceneCloud(points, None, Colouring())
    assert cloud.given == 500 and np.isfinite(cloud.corners).all()
    assert_array_equal(cloud.chunk(0)[0], np.delete(BOX, [3, 77], axis=0).astype(np.float32))
    assert len(cloud.chunk(0)[1]) == 498
    assert not SceneCloud(np.full((3, 3), np.nan), None, Colouring()).drawable


def test_a_growing_cloud_has_every_point_once_and_changes_only_its_last_chunk():
    cloud = SceneCloud(np.empty((0, 3)), np.empty(0), Colouring("σ", "mm", (0, 1)))
    for k in range(60):
        cloud.add(np.full((1000, 3), k), np.full(1000, 0.5))
    serial, sizes = cloud.serial, [cloud.size(k) for k in range(cloud.chunks)]
    cloud.add(np.ones((10, 3)), np.zeros(10))
    assert cloud.serial == serial
    assert [cloud.size(k) for k in range(cloud.chunks)][:-1] == sizes[:-1]
    drawn = np.concatenate([numbers(cloud, k) for k in range(cloud.chunks)])
    assert_array_equal(np.sort(drawn), np.arange(60_010))
    assert_allclose(cloud.corners, [[0, 0, 0], [59, 59, 59]])


def test_a_sample_of_a_growing_cloud_holds_its_newest_points():
    cloud = cloud_of(30_000)
    cloud.add(np.full((5, 3), 1e6), np.zeros(5))
    assert (cloud.sample() == 1e6).any()


def test_points_without_values_do_not_join_a_cloud_with_values():
    with pytest.raises(ValueError, match="values"):
        cloud_of(10).add(np.zeros((2, 3)), None)


# ---- colours


def test_ends_of_the_bar_are_one_and_ninety_nine_percent_and_arrows_tell_of_the_rest():
    colouring = Colouring("σ", "mm").limited(np.linspace(0, 100, 1001))
    assert_allclose(colouring.limits, [1, 99])
    assert colouring.clipped == (True, True)
    assert Colouring("σ", "mm", (0, 100)).limited(np.linspace(0, 100, 11)).clipped == (False, False)


def test_deviations_are_symmetric_about_zero():
    low, high = Colouring("dev", "mm", colour_map="deviation").limited(np.linspace(-1, 3, 1000)).limits
    assert low == -high


def test_values_become_colours_of_the_map_and_nan_is_grey():
    colouring = Colouring("σ", "mm", (0.0, 1.0))
    colours = colouring.of(np.array([0, 1, 5, -5, np.nan, np.inf]))
    first, last = table("viridis")[0], table("viridis")[-1]
    assert_array_equal(colours, [first, last, last, first, UNKNOWN, last])


def test_a_constant_value_has_a_colour():
    assert Colouring("z", "mm").limited(np.full(5, 2.0)).of(np.full(5, 2.0)).shape == (5, 3)


@pytest.mark.parametrize(
    ("low", "high", "texts"),
    [
        (0, 0.05, ["0.00", "0.02", "0.04"]),
        (-1, 1, ["−1.0", "−0.5", "0.0", "0.5", "1.0"]),
        (480, 520, ["480", "490", "500", "510", "520"]),
    ],
)
def test_ticks_are_round_numbers_told_apart(low, high, texts):
    assert ticks(low, high, 5)[1] == texts


@pytest.mark.parametrize(("low", "high"), [(-0.036, 0.036), (-1.9, 1.9), (0.3, 0.6)])
def test_a_bar_however_low_has_two_ticks_which_tell_its_scale(low, high):
    values, texts = ticks(low, high, 2)
    assert len(values) >= 2 and len(set(texts)) == len(texts)
    assert low - 1e-9 <= min(values) and max(values) <= high + 1e-9


# ---- choosing


def test_a_click_takes_the_nearest_point_within_reach():
    camera = looking("top").fitted(BOX, SIZE)
    screen, _ = camera.project(BOX, SIZE)
    at = screen[42] + [1.0, 0.5]
    wanted = np.argmin(np.hypot(*(screen - at).T))
    chosen = nearest_point(BOX, camera, SIZE, tuple(at))
    assert chosen is not None and np.hypot(*(screen[chosen] - screen[wanted])) <= 3
    assert nearest_point(BOX, camera, SIZE, (-500, -500)) is None


def test_a_click_takes_what_is_in_front():
    camera = looking("top")
    points = np.array([[0, 0, 450.0], [0, 0, 400.0], [0.01, 0, 450.0]])
    assert nearest_point(points, camera, SIZE, (400, 300)) == 1


def crossing_number(spots, outline):
    """Even-odd rule, point by point."""
    inside = []
    for x, y in spots:
        odd = False
        for (x0, y0), (x1, y1) in zip(outline, np.roll(outline, -1, axis=0), strict=True):
            if (y0 > y) != (y1 > y) and x > x0 + (y - y0) * (x1 - x0) / (y1 - y0):
                odd = not odd
        inside.append(odd)
    return np.array(inside)


@pytest.mark.parametrize(
    "outline",
    [
        [(200, 100), (600, 130), (560, 500), (210, 460)],
        [(200.3, 100.7), (600.2, 480.1), (600.8, 120.4), (190.6, 470.9)],
        [(300 + 150 * np.cos(a) * (1 + 0.4 * np.cos(7 * a)), 300 + 150 * np.sin(a)) for a in np.linspace(0, 6.2, 90)],
    ],
)
def test_a_region_holds_exactly_the_points_seen_inside_its_outline(outline):
    camera = looking("top").fitted(BOX, SIZE)
    spots = camera.project(BOX, SIZE)[0]
    inside = points_inside(BOX, camera, SIZE, Outline(outline))
    assert_array_equal(inside, crossing_number(spots, np.array(outline)))
    assert 0 < inside.sum() < len(BOX)


def test_points_behind_the_viewer_are_in_no_region():
    camera = SceneCamera.looking((0, 0, -1), (0, -1, 0), (0, 0, 500), 500)
    everything = Outline([(0, 0), (800, 0), (800, 600), (0, 600)])
    assert_array_equal(
        points_inside(np.array([[0, 0, 400.0], [0, 0, -400.0]]), camera, SIZE, everything), [True, False]
    )


# ---- passes


def hills(side: int) -> Scene:
    x, y = np.meshgrid(np.arange(side, dtype=float), np.arange(side, dtype=float))
    vertices = np.column_stack([x.ravel(), y.ravel(), 5 * np.sin(x / 9).ravel()])
    k = np.arange(side * side).reshape(side, side)
    a, b, c, d = (part.ravel() for part in (k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]))
    scene = Scene()
    scene.mesh = as_mesh(
        vertices, np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])]), None, Colouring()
    )
    return scene


def test_the_parts_of_a_mesh_have_all_its_triangles():
    scene = hills(200)
    assert scene.mesh is not None
    parts = [gather(scene, part) for part in all_parts(scene)]
    centres = np.vstack([part.points[part.triangles].mean(axis=1) for part in parts])
    assert_allclose(centres, scene.mesh.vertices[scene.mesh.triangles].mean(axis=1), atol=1e-3)
    assert all(size(scene, part) <= TRIANGLES for part in all_parts(scene))


def test_in_motion_a_coarse_mesh_stands_for_a_large_one():
    scene = hills(200)
    assert quick_pass(scene, 30_000, made).parts == (Part("coarse", 0),)
    coarse = gather(scene, Part("coarse", 0))
    assert 1000 < len(coarse.triangles) < 25_000
    assert_allclose(np.ptp(coarse.points, axis=0), np.ptp(scene.mesh.vertices, axis=0), atol=4)
    assert list(quick_pass(hills(50), 30_000, made).parts) == all_parts(hills(50))


def made(part: Part) -> bool:
    return True


def test_the_passes_of_a_picture_hold_every_part_once_and_smooth_the_solid_ones():
    scene = hills(200)
    scene.cloud = cloud_of(150_000)
    passes = whole_passes(scene, 60_000, made)
    assert [part for one in passes for part in one.parts] == all_parts(scene)
    assert [one.first for one in passes] == [True] + [False] * (len(passes) - 1)
    assert [one.last for one in passes] == [False] * (len(passes) - 1) + [True]
    (smooth,) = [one for one in passes if one.smooth]
    assert all(part.kind == "mesh" for one in passes[: passes.index(smooth) + 1] for part in one.parts)
    assert all(part.kind == "cloud" for one in passes[passes.index(smooth) + 1 :] for part in one.parts)
    assert all(sum(size(scene, part) for part in one.parts) < 60_000 + CHUNK for one in passes)


def test_a_pass_gathers_few_new_parts():
    scene = Scene(cloud=cloud_of(500_000))
    assert len(quick_pass(scene, 1e9, lambda _: False).parts) == 3
    assert {len(one.parts) for one in whole_passes(scene, 1e9, lambda _: False)} <= {1, 2, 3}
    assert len(whole_passes(scene, 1e9, made)) == 1


def test_normals_are_perpendicular_to_the_surface():
    flat = hills(30)
    flat.mesh = as_mesh(flat.mesh.vertices * [1, 1, 0], flat.mesh.triangles, None, Colouring())
    assert_allclose(np.abs(gather(flat, all_parts(flat)[0]).normals), np.tile([0, 0, 1], (900, 1)), atol=1e-6)


def test_a_mesh_whose_triangles_name_missing_vertices_is_refused():
    with pytest.raises(ValueError, match="vertex"):
        as_mesh(np.zeros((3, 3)), [[0, 1, 3]], None, Colouring())


# ---- shapes


def test_a_pyramid_ends_at_the_corners_of_the_picture():
    camera = Camera((640, 480), np.array([[900.0, 3, 320], [0, 905, 240], [0, 0, 1]]))
    pyramid = frustum(camera, 500)
    assert_allclose(pyramid[0], 0)
    assert_allclose(camera.project(pyramid[1:]), [[0, 0], [639, 0], [639, 479], [0, 479]], atol=1e-9)


@pytest.mark.parametrize("normal", [(0.95, 0.05, 0.3), (0.1, 0.9, -0.4)])
def test_a_patch_lies_on_its_plane_between_the_depths(normal):
    camera = Camera((640, 480), np.array([[900.0, 0, 320], [0, 900, 240], [0, 0, 1]]))
    plane = LightPlane.from_normal(np.array(normal) / np.linalg.norm(normal), np.array(normal) @ [5, 5, 450] + 1e-9)
    patch = plane_patch(plane, camera, (400, 500))
    assert_allclose(patch @ plane.pi, 1)
    assert_allclose(patch[:, 2], [400, 400, 500, 500])
    first, second = patch[1] - patch[0], patch[2] - patch[3]
    assert first @ second > 0  # the corners go round


def test_a_plane_across_the_axis_has_no_patch():
    camera = Camera((640, 480), np.array([[900.0, 0, 320], [0, 900, 240], [0, 0, 1]]))
    with pytest.raises(ValueError, match="across"):
        plane_patch(LightPlane(np.array([0, 0, 1 / 450])), camera, (400, 500))
