"""What light does beyond a single way, by its physics: ends of sheets, window, hand, bounces, matter."""

from dataclasses import replace

import numpy as np
import pytest

from core.model import Pose
from core.simulate.effects.transport import Transport
from core.simulate.rays import ray_map
from core.simulate.recording import scan_of
from core.simulate.rig import paper_rig
from core.simulate.scan import LAMP
from core.simulate.scenario import Scenario
from core.simulate.scene.bounce import bounced_light
from core.simulate.scene.laser import laser_light
from core.simulate.scene.objects import gauge_block
from core.simulate.scene.scene import Material, Scene, SurfaceMaps, surface_maps
from core.simulate.scene.stage import table_pose
from core.simulate.scene.walk import walk
from core.simulate.scene.window import hand_hides, visible_window_share, window_places

SMALL = Scenario(scale=0.1, frames=3, noise=0.0, speckle=0.0, texture=0.0)
RIG = paper_rig(0.25)


def light_of(scenario, number=1):
    """The light (h, w) of one sweep alone, before the lens."""
    stage, sheets, _ = scan_of(scenario)
    return stage._sheets_light([sheets[number]]), stage, sheets[number]


def with_transport(**of):
    return replace(SMALL, transport=Transport(**of))


# ---- where a sheet ends


def test_a_sheet_ends_at_the_rim_of_its_housing_and_fades_over_as_much_as_is_stated():
    whole, stage, sheet = light_of(SMALL)
    ended, _, _ = light_of(with_transport(sheet_deg=8.0, edge_deg=4.0))
    towards = stage.maps.points - sheet.emitter
    angle = np.degrees(np.arccos(np.clip(towards @ sheet.axis / np.linalg.norm(towards, axis=2), -1, 1)))
    lit = whole > 1
    share = np.where(lit, ended / np.where(lit, whole, 1), np.nan)
    assert np.allclose(share[lit & (angle < 6)], 1)
    assert np.all(share[lit & (angle > 10)] == 0)
    within = lit & (np.abs(angle - 8) < 0.3)
    assert within.any() and np.allclose(share[within], 0.5, atol=0.15), "half at the rim itself"


# ---- light through the matter


def test_little_light_comes_back_from_dark_matter_and_nearly_all_from_clear_one():
    shares = [walk(albedo).share for albedo in (0.0, 0.5, 0.9, 0.99, 0.999)]
    assert shares[0] == 0.0
    assert shares == sorted(shares)
    # H functions of Chandrasekhar: a half space with isotropic collisions sends back 1 − H(μ)√(1 − ϖ) at μ = 1.
    assert shares[1] == pytest.approx(0.115, abs=0.02)
    assert shares[2] == pytest.approx(0.415, abs=0.03)
    assert shares[3] < 0.9


def test_light_spreads_further_the_clearer_the_matter():
    spread = [np.sqrt(np.mean(walk(albedo).aside ** 2)) for albedo in (0.5, 0.9, 0.99)]
    assert spread == sorted(spread)
    assert walk(0.9).aside.mean() == pytest.approx(0, abs=1e-12), "to both sides alike"


def section(material, depth=0.0):
    """Light of a sheet on a flat face that looks at the camera, along one row: px from its middle, and the light."""
    pose = Pose(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, 500.0]))
    scene = Scene.on_table(Pose(pose.rotation, pose.translation + [0, 0, 50.0]), gauge_block(50.0), material=material)
    maps = surface_maps(scene, RIG.camera)
    _, sheets, _ = scan_of(SMALL)
    row = RIG.camera.image_size[1] // 2
    light = laser_light(sheets[1], scene, maps)[row].astype(float)
    place = np.arange(len(light))
    middle = light @ place / light.sum()
    return light.sum(), middle, np.sqrt(light @ (place - middle) ** 2 / light.sum())


@pytest.mark.parametrize("path_mm", [0.1, 0.4])
def test_a_stripe_on_matter_is_wider_by_the_spread_of_the_walk_and_fainter_by_its_share(path_mm):
    matt, _, narrow = section(Material())
    seen, _, wide = section(Material(scattered=1.0, free_path_mm=path_mm, scatter_albedo=0.9))
    assert seen / matt == pytest.approx(walk(0.9).share, rel=0.03)
    per_mm = RIG.camera.matrix[0, 0] / 500.0
    assert wide**2 - narrow**2 == pytest.approx(np.var(walk(0.9).aside) * (path_mm * per_mm) ** 2, rel=0.5)


def test_light_through_matter_lies_behind_its_surface_as_seen_by_the_camera():
    """Its first collision lies deeper along the beam: to the side away from the laser, as of a lower surface."""
    _, surface, _ = section(Material())
    _, within, _ = section(Material(scattered=1.0, free_path_mm=0.4, scatter_albedo=0.9))
    _, sheets, _ = scan_of(SMALL)
    away = np.sign(sheets[1].axis[0])
    assert (within - surface) * away > 0.1


# ---- surfaces that light each other


def corner(angle_deg=90.0):
    """Maps of two planes that meet under the camera's axis: a floor, and a wall on its right half."""
    rays = ray_map(RIG.camera)
    x = rays[..., 0].astype(float)
    floor = np.full(x.shape, 500.0)
    wall = np.where(x > 1e-6, 30.0 / np.maximum(x, 1e-6), np.inf)
    on_wall = wall < floor
    depth = np.where(on_wall, wall, floor)
    points = (np.dstack([rays, np.ones_like(x)]) * depth[..., None]).astype(np.float32)
    normals = np.where(on_wall[..., None], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]).astype(np.float32)
    return SurfaceMaps(points, normals, np.full(x.shape, 0.5, np.float32)), on_wall


def test_a_patch_lights_another_surface_by_the_form_factor():
    maps, on_wall = corner()
    light = np.zeros(on_wall.shape, np.float32)
    v, u = 340, 300
    assert not on_wall[v, u]
    light[v, u] = 1000.0
    found = bounced_light(light, maps, RIG.camera.focal)
    assert np.all(found[~on_wall][maps.points[..., 0][~on_wall] < 25] < 1e-6), "a plane does not light itself"
    source = maps.points[v, u].astype(float)
    area = source[2] ** 2 / RIG.camera.focal**2
    inside = np.argwhere(on_wall & (maps.points[..., 2] < 400))[::5000]
    for row, column in inside:
        way = maps.points[row, column].astype(float) - source
        square = way @ way
        expected = 0.5 * 1000 * area / np.pi * max(-way[2], 0) * max(way[0], 0) / square**2
        assert found[row, column] == pytest.approx(expected, rel=0.1, abs=1e-7)


def test_a_block_lights_the_table_beside_it_and_a_bare_table_nothing():
    alone, _, _ = light_of(replace(with_transport(bounced=True), object="plane"))
    without, _, _ = light_of(replace(SMALL, object="plane"))
    assert np.allclose(alone, without, atol=1e-3)
    lit, _, _ = light_of(with_transport(bounced=True))
    single, _, _ = light_of(SMALL)
    more = lit - single
    assert more.min() >= 0 and more.max() > 0
    assert more.max() < 0.1 * single.max()


# ---- window and hand


def test_a_window_casts_a_shadow_as_soft_as_it_is_wide():
    pose = table_pose()
    scene = Scene.on_table(pose, gauge_block(50.0))
    maps = surface_maps(scene, paper_rig(0.1).camera)
    edges = []
    for degrees in (1.0, 5.0, 15.0):
        seen = visible_window_share(scene, maps, window_places(LAMP, np.radians(degrees)))
        edges.append(np.mean((seen > 0.02) & (seen < 0.98)))
        assert seen.min() == 0 or degrees > 5
        assert np.mean(seen[~maps.table]) > 0.8, "the upper face sees all of it"
    assert edges == sorted(edges) and edges[-1] > 3 * edges[0]


def test_a_hand_takes_the_share_of_the_window_that_it_stands_before():
    maps, _ = corner()
    towards = np.array([0.0, 0.0, -1.0])
    at = maps.points[340, 300].astype(float)
    for degrees, radius, share in ((10.0, 60.0, 1.0), (20.0, 36.4, 0.25)):
        hand = at + 200.0 * towards
        hidden = hand_hides(maps, towards, np.radians(degrees), (hand, radius))
        expected = min((np.degrees(np.arcsin(radius / 200)) / degrees) ** 2, 1.0)
        assert expected == pytest.approx(share, abs=0.05)
        assert hidden[340, 300] == pytest.approx(expected, abs=0.02)
        assert hidden.min() >= 0 and hidden.max() <= 1
    far = hand_hides(maps, towards, np.radians(10.0), (at + [400.0, 0.0, -200.0], 40.0))
    assert far[340, 300] == 0


def test_the_hand_darkens_frames_and_not_the_reference():
    held = with_transport(window_deg=40.0, hand_mm=250.0)
    stage, sheets, _ = scan_of(held)
    plain, _, _ = scan_of(with_transport(window_deg=40.0))
    assert np.array_equal(stage.reference(), plain.reference())
    darker = plain.frame(0, sheets[0]).astype(int) - stage.frame(0, sheets[0])
    assert darker.min() >= 0 and darker.max() >= 2


# ---- nothing of it where nothing is stated


def test_without_any_of_it_pictures_are_what_they_were():
    stage, sheets, _ = scan_of(replace(SMALL, noise=1.0, speckle=0.18))
    again, _, _ = scan_of(replace(SMALL, noise=1.0, speckle=0.18, transport=Transport()))
    assert np.array_equal(stage.frame(0, sheets[0]), again.frame(0, sheets[0]))


def test_light_falls_with_distance_and_incidence_and_is_wider_on_slanted_faces_where_nothing_is_stated():
    """I ∝ cos θ / ρ along a sheet of one width, and its section on the surface is 1/cos wider."""
    light, stage, sheet = light_of(SMALL)
    points = stage.maps.points.astype(float)
    towards = points - sheet.emitter
    rho = np.linalg.norm(towards, axis=2)
    cosine = -np.einsum("vui,vui->vu", towards, stage.maps.normals) / rho
    off = np.abs(points @ sheet.plane.normal - sheet.plane.d_mm)
    crest = (off < 0.05) & (light > 5)
    angle = np.arccos(np.clip(towards @ sheet.axis / rho, -1, 1))
    beam = sheet.beam
    width = beam.sigma_mm * np.hypot(1, (rho - beam.focus_mm) / beam.rayleigh_mm)
    law = stage.maps.albedo * cosine / (rho * width) * np.exp(-2 * (angle / beam.half_angle) ** 2)
    ratio = light[crest] / law[crest]
    assert np.ptp(law[crest]) > 0.1 * law[crest].mean()
    assert ratio.std() < 0.03 * ratio.mean()
