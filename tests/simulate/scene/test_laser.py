"""Stripes, before and after the lens, against where plane and sphere really meet the sheet."""

from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

from core.model import LightPlane, Pose
from core.simulate.blur import blurred
from core.simulate.rays import ray_map
from core.simulate.rig import paper_rig
from core.simulate.scenario import Scenario
from core.simulate.scene.laser import Sheet, fan_sheets, laser_light
from core.simulate.scene.objects import box
from core.simulate.scene.scene import MATT, Material, Mesh, Scene, Sphere, surface_maps
from core.simulate.scene.stage import WORK_POINT, build_scene, table_pose

RIG = paper_rig(0.5)
CAMERA = RIG.camera
RAYS = ray_map(CAMERA)


def sweep_sheet(tilt: float = 0.2, emitter=(-230.0, 10.0, 30.0)) -> Sheet:
    emitter = np.array(emitter)
    normal = np.cross(WORK_POINT - emitter, [-np.sin(tilt), np.cos(tilt), 0.0])
    return Sheet(LightPlane(normal / (normal @ emitter)), emitter, WORK_POINT - emitter, RIG.sweep_beam)


def crest(values: np.ndarray, start: int) -> float:
    """Where the logarithm of a profile is highest, by a polynomial through its upper part."""
    top = np.flatnonzero(values > 0.05 * values.max())
    middle = top.mean()
    curve = np.polynomial.Polynomial.fit(top - middle, np.log(values[top]), 5 if len(top) > 7 else 3)
    roots = curve.deriv().roots()
    real = roots[np.abs(roots.imag) < 1e-9].real
    return start + middle + real[np.abs(real).argmin()]


def centroid(values: np.ndarray, start: int) -> float:
    return start + float((values * np.arange(len(values))).sum() / values.sum())


def across(light: np.ndarray, axis: int, at: int, guess: float) -> tuple[np.ndarray, int]:
    """A piece of a column (axis 0) or row (axis 1) of `light` about `guess`."""
    start = round(guess) - 14
    line = light[:, at] if axis == 0 else light[at]
    return line[start : start + 29].astype(float), start


def meeting(depth_of_ray, plane: LightPlane, axis: int, at: int, low: float, high: float) -> float:
    """Where along a column or row the surface lies in the plane."""

    def off(t: float) -> float:
        ray = CAMERA.rays([[at, t] if axis == 0 else [t, at]])[0]
        return float(plane.distances((ray * depth_of_ray(ray))[None])[0])

    return brentq(off, low, high, xtol=1e-9)


def table_depth(ray: np.ndarray) -> float:
    pose = table_pose()
    up = pose.rotation[:, 2]
    return float((up @ pose.translation) / (ray @ up))


@pytest.mark.accuracy
@pytest.mark.parametrize("line", [0, 1, 2])
@pytest.mark.parametrize("measure", [crest, centroid])
def test_fan_lines_on_the_table_are_where_the_planes_meet_it(line, measure):
    scene = Scene.on_table(table_pose())
    maps = surface_maps(scene, CAMERA, RAYS)
    sheet = fan_sheets(RIG, WORK_POINT)[line]
    light = laser_light(sheet, scene, maps)
    if measure is centroid:
        light = blurred(light, RIG.blur_px)
    errors = []
    for column in range(100, 1700, 40):  # nearer the emitter the light itself falls off across the stripe
        true = meeting(table_depth, sheet.plane, 0, column, 600, 1370)
        errors.append(measure(*across(light, 0, column, true)) - true)
    assert np.abs(np.mean(errors)) < 0.0007
    assert np.abs(errors).max() < 0.001


@pytest.mark.parametrize("tilt", [-0.6, 0.0, 0.5])
def test_sweep_on_the_table_is_where_its_plane_meets_it(tilt):
    scene = Scene.on_table(table_pose())
    maps = surface_maps(scene, CAMERA, RAYS)
    sheet = sweep_sheet(tilt)
    light = laser_light(sheet, scene, maps)
    errors = []
    for row in range(500, 1300, 40):
        true = meeting(table_depth, sheet.plane, 1, row, 100, 1800)
        errors.append(crest(*across(light, 1, row, true)) - true)
    assert np.abs(errors).max() < 0.001


def test_stripe_on_a_sphere_is_where_its_plane_meets_it():
    centre, radius = np.array([0.0, 54.0, 530.0]), 25.0
    scene = Scene(None, spheres=(Sphere(centre, radius),))
    maps = surface_maps(scene, CAMERA, RAYS)
    sheet = sweep_sheet(0.1)
    light = laser_light(sheet, scene, maps)

    def sphere_depth(ray: np.ndarray) -> float:
        a, b, c = ray @ ray, ray @ centre, centre @ centre - radius**2
        return (b - np.sqrt(max(b * b - a * c, 0.0))) / a

    # shading moves the crest for real; taking out the cosine of incidence (found here on its own) leaves the sheet
    columns = np.arange(1920)
    errors = []
    for row in range(830, 960, 5):
        rays = CAMERA.rays(np.column_stack([columns, np.full(len(columns), row)]))
        depth = np.array([sphere_depth(ray) for ray in rays])
        points = rays * depth[:, None]
        towards = sheet.emitter - points
        cosine = ((points - centre) / radius * towards).sum(axis=1) / np.linalg.norm(towards, axis=1)
        peak = int(light[row].argmax())
        if light[row, peak] < 30:
            continue
        true = meeting(sphere_depth, sheet.plane, 1, row, peak - 3, peak + 3)
        piece, start = across(light, 1, row, true)
        errors.append(crest(piece / cosine[start : start + 29], start) - true)
    assert len(errors) > 15
    assert np.abs(errors).max() < 0.001


def test_width_of_the_stripe_follows_the_beam():
    scene = Scene.on_table(table_pose())
    maps = surface_maps(scene, CAMERA, RAYS)
    sheet = sweep_sheet(0.0)
    light = laser_light(sheet, scene, maps)
    row = 900
    true = meeting(table_depth, sheet.plane, 1, row, 100, 1800)
    piece, start = across(light, 1, row, true)
    at = np.arange(start, start + 29) - true
    width = np.sqrt((piece * at**2).sum() / piece.sum())
    points = maps.points[row, round(true) : round(true) + 2].astype(float)
    off_per_pixel = np.diff(sheet.plane.distances(points))[0]
    rho = np.linalg.norm(points[0] - sheet.emitter)
    beam = sheet.beam
    sigma = beam.sigma_mm * np.hypot(1, (rho - beam.focus_mm) / beam.rayleigh_mm)
    assert width == pytest.approx(abs(sigma / off_per_pixel), rel=0.003)


def test_light_falls_with_incidence_albedo_and_distance():
    def peak(pose: Pose, albedo: float) -> float:
        scene = Scene(pose, table_albedo=albedo)
        return float(laser_light(sheet, scene, surface_maps(scene, CAMERA, RAYS)).max())

    sheet = replace(sweep_sheet(0.0), beam=replace(RIG.sweep_beam, half_angle=10.0))
    towards = (sheet.emitter - WORK_POINT) / np.linalg.norm(sheet.emitter - WORK_POINT)
    face_on = np.linalg.svd(towards[None])[2]
    frontal = Pose(np.column_stack([face_on[1], np.cross(towards, face_on[1]), towards]), WORK_POINT)
    distance = np.linalg.norm(sheet.emitter - WORK_POINT)
    beam = sheet.beam
    thick = np.hypot(1, (distance - beam.focus_mm) / beam.rayleigh_mm)
    expected = beam.peak_grey * beam.focus_mm / (distance * thick)
    assert peak(frontal, 1.0) == pytest.approx(expected, rel=0.01)
    assert peak(frontal, 0.5) == pytest.approx(expected / 2, rel=0.01)


def test_a_block_casts_its_shadow_where_rays_from_the_emitter_graze_its_rim():
    pose = table_pose()
    scene = Scene.on_table(pose, box((-30, -40, 0), (30, 40, 50)))
    maps = surface_maps(scene, CAMERA, RAYS)
    sheet = fan_sheets(RIG, WORK_POINT)[1]
    light = laser_light(sheet, scene, maps)
    local = pose.inverse().apply(maps.points.reshape(-1, 3)).reshape(maps.points.shape)
    emitter = pose.inverse().apply(sheet.emitter[None])[0]
    # in table coordinates the ray over the rim at x = −30, z = 50 comes down to the table at x_end
    ends = local[..., 0][(light > 5) & maps.table & (local[..., 0] < -30)]
    x_end = emitter[0] + (-30 - emitter[0]) * emitter[2] / (emitter[2] - 50)
    assert x_end < -50
    assert ends.max() == pytest.approx(x_end, abs=0.35)  # a pixel is 0.22 mm here
    assert ends.max() <= x_end + 0.01


def test_a_sphere_casts_a_shadow_and_is_dark_behind():
    pose = table_pose()
    ball = Sphere(np.array([0.0, 0.0, 25.0]), 25.0)
    scene = Scene.on_table(pose, ball)
    maps = surface_maps(scene, CAMERA, RAYS)
    sheet = sweep_sheet(0.0)
    light = laser_light(sheet, scene, maps)
    lit = np.argwhere(light > 1)
    points = maps.points[tuple(lit.T)].astype(float)
    centre = scene.spheres[0].centre
    towards = points - sheet.emitter
    along = (towards @ (centre - sheet.emitter)[:, None])[:, 0] / (towards**2).sum(axis=1)
    nearest = np.linalg.norm(sheet.emitter + along[:, None] * towards - centre, axis=1)
    on_ball = ~maps.table[tuple(lit.T)]
    assert on_ball.sum() > 200
    behind = ~on_ball & (along < 1)
    assert nearest[behind].min() > 24.9
    facing = ((points - centre) * towards).sum(axis=1)[on_ball]
    assert facing.max() <= 0


def test_an_object_does_not_shade_itself_where_it_faces_the_laser():
    scene = Scene.on_table(table_pose(), box((-30, -30, 0), (30, 30, 50)))
    maps = surface_maps(scene, CAMERA, RAYS)
    sheet = sweep_sheet(0.0)
    light = laser_light(sheet, scene, maps)
    off = np.abs((maps.points @ sheet.plane.normal) - sheet.plane.d_mm)
    up = scene.pose_cam_table.rotation[:, 2]
    top = ((maps.points - scene.pose_cam_table.translation) @ up > 49.99) & (off < 0.2)
    assert top.sum() > 200
    assert (light[top] > 50).all()


@cache
def section_of(material: Material) -> tuple[np.ndarray, np.ndarray]:
    """Rows about a fan line on a facing plate of this material, and the light in them at one column."""
    corners = np.array([[-80.0, -80, 500], [80, -80, 500], [80, 80, 500], [-80, 80, 500]])
    plate = Mesh(corners[[[0, 2, 1], [0, 3, 2]]])
    scene = Scene(None, (plate,), material=material)
    sheet = fan_sheets(RIG, WORK_POINT)[1]
    light = laser_light(sheet, scene, surface_maps(scene, CAMERA, RAYS))[:, 960].astype(float)
    return np.arange(len(light)), light


def test_light_from_below_moves_a_section_by_its_mean_depth():
    matt, inner = section_of(MATT), section_of(Material(inner_share=0.35, inner_mm=0.8))
    middle = [float(rows @ light / light.sum()) for rows, light in (matt, inner)]
    at = np.array([960.0, middle[0]])
    ray = CAMERA.rays(at[None])[0]
    pi = fan_sheets(RIG, WORK_POINT)[1].plane.pi
    slope = (pi[:2] @ CAMERA.ray_jacobian(ray[None])[0])[1]
    depth = -(500.0**2) * slope * (middle[1] - middle[0])
    assert depth == pytest.approx(0.35 * 0.4, rel=0.05)
    assert inner[1].sum() == pytest.approx(matt[1].sum(), rel=0.01)


def test_a_glossy_plate_is_bright_where_it_mirrors_the_laser_into_the_camera():
    matt, glossy = section_of(MATT)[1], section_of(Material(gloss=5.0, gloss_rad=0.2))[1]
    assert glossy.sum() > 1.2 * matt.sum()
    assert section_of(Material(gloss=5.0, gloss_rad=0.01))[1].sum() == pytest.approx(matt.sum(), rel=0.01)


def test_a_lay_as_rough_along_as_across_is_none():
    none, same = (section_of(Material(gloss=5.0, gloss_rad=0.2, along_rad=rad))[1] for rad in (0.0, 0.2))
    assert same == pytest.approx(none, rel=1e-6)


def test_a_ground_plate_mirrors_across_its_lay_and_hardly_along_it():
    def brightness(lay):
        return section_of(Material(gloss=5.0, gloss_rad=0.2, along_rad=0.03, lay=tuple(lay)))[1].sum()

    emitter = fan_sheets(RIG, WORK_POINT)[1].emitter
    rows, light = section_of(MATT)
    seen = CAMERA.rays(np.array([[960.0, float(rows @ light / light.sum())]]))[0] * 500.0
    half = -seen / np.linalg.norm(seen) + (emitter - seen) / np.linalg.norm(emitter - seen)
    tilted = np.array([half[0], half[1], 0.0]) / np.hypot(*half[:2])
    across = np.array([-tilted[1], tilted[0], 0.0])
    even = section_of(Material(gloss=5.0, gloss_rad=0.2))[1].sum()
    assert brightness(across) == pytest.approx(even, rel=0.03)
    assert brightness(tilted) == pytest.approx(light.sum(), rel=0.03)
    assert brightness(-across) == pytest.approx(brightness(across))
    turned = [np.cos(at) * across + np.sin(at) * tilted for at in np.radians([0, 30, 60, 90])]
    assert all(one >= other for one, other in pairwise(map(brightness, turned)))


def test_the_lay_turns_with_the_part():
    found = [build_scene(Scenario(gloss=5.0, gloss_along_deg=2.0, lay_deg=lay, yaw_deg=yaw))[0].material.lay
             for lay, yaw in ((30.0, 10.0), (10.0, 30.0), (0.0, 0.0))]  # fmt: skip
    assert found[0] == pytest.approx(found[1])
    table = table_pose().rotation
    assert found[2] == pytest.approx(table[:, 0])
    assert np.dot(found[0], table[:, 2]) == pytest.approx(0, abs=1e-12)
