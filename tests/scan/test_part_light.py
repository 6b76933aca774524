"""Stripes on the part that are wider than on the table: seen of light from below, not of distance, slant and blur."""

import numpy as np
import pytest

from core.image.stripes.centreline import Centreline
from core.model import Fan, Pose
from core.pipeline.steps.scan.part_light import notes_on_part_light
from core.scan.footprint import footprint
from core.scan.part_light import ENOUGH_POINTS, Blur, PartLight, blur_of, light_on_part
from core.scan.surface.cloud import Cloud
from core.simulate.effects.setup import Setup
from core.simulate.rig import paper_rig
from core.simulate.sweep import SweepRange, hand_sweeps

RIG = paper_rig(0.25)
CAMERA, SIGMA_MM, BLUR = RIG.camera, 0.22, Blur(0.9, 0.004, 540.0)
TABLE_MM, TOP_MM = 560.0, 510.0
FRAMES = 20


def plane(depth_mm, slant=(0.05, -0.03)):
    """A plane that leans by this slant, at this depth on the camera's axis."""
    return np.array([slant[0], slant[1], 1.0]) / depth_mm


TABLE, TOP = plane(TABLE_MM), plane(TOP_MM)


def stripe(sheet, surface, below_mm2=0.0, noise=0.01, rng=None):
    """What is seen of a sheet π on a surface, as light from this variance of depths, in mm², widens it; and points."""
    v = np.arange(200.0, 500.0)
    u = np.full(len(v), 480.0)
    for _ in range(40):  # π·r = ρ·r, by the secant of one pixel
        here, next_ = (CAMERA.rays(np.column_stack([u + step, v])) @ (sheet - surface) for step in (0.0, 1.0))
        u = u - here / (next_ - here)
    uv = np.column_stack([u, v])
    rays, per_mm = CAMERA.rays(uv), footprint(uv, sheet, surface, CAMERA)
    inverse_depth = rays @ sheet
    square = (SIGMA_MM * per_mm) ** 2 + BLUR.at(1 / inverse_depth)
    square += below_mm2 * (per_mm * inverse_depth / np.linalg.norm(sheet)) ** 2
    width = np.sqrt(square) * (1 + noise * rng.standard_normal(len(v)) + noise * rng.standard_normal())
    inside = (uv[:, 0] > 0) & (uv[:, 0] < 960)
    ones = np.ones(len(v))
    line = Centreline(uv, np.column_stack([ones, 0 * ones]), width, 100 * ones, 0.05 * ones, np.zeros(len(v), bool))
    return line.select(inside), (rays / inverse_depth[:, None])[inside]


def scan(below_mm2=0.0, setup=None, seed=1):
    """Stripes with their sheets, and the points, of a scan of a part over a table."""
    rng = np.random.default_rng(seed)
    reach = SweepRange((0.0, 0.0, TOP_MM), 50.0)
    seen, points = [], []
    for sheet in hand_sweeps(RIG, reach, FRAMES, rng, setup or Setup()):
        on_table, there = stripe(sheet.plane.pi, TABLE, rng=rng)
        on_part, here = stripe(sheet.plane.pi, TOP, below_mm2, rng=rng)
        seen.append(([on_table, on_part], sheet.plane.pi))
        points += [there, here]
    at = np.vstack(points)
    count = len(at)
    index = np.zeros(count, dtype=np.int64)
    nothing = np.zeros(count)
    return seen, Cloud(at, CAMERA.project(at), nothing, nothing, index, index, np.zeros((count, 3)))


def traced(uv, sheet, surface, thick_mm=0.01):
    """Px between the two edges of a sheet so thick where they meet the surface, square to the stripe, for each mm."""
    away, found = 1 / np.linalg.norm(sheet), []
    normal = sheet * away
    along = np.cross(normal, surface)
    along /= np.linalg.norm(along)
    for ray in CAMERA.rays(uv):
        middle = ray / (ray @ sheet)
        of_planes = np.stack([normal, surface, along])
        edges = [np.linalg.solve(of_planes, [away + s * thick_mm / 2, 1.0, along @ middle]) for s in (-1, 1)]
        first, second, back, on = CAMERA.project(np.stack([*edges, middle - 0.05 * along, middle + 0.05 * along]))
        stripe_u, stripe_v = (on - back) / np.linalg.norm(on - back)
        found.append(abs((second - first) @ [-stripe_v, stripe_u]) / thick_mm)
    return np.array(found)


@pytest.mark.parametrize("setup", [Setup(), Setup(hand_aside=1.7)], ids=["as usual", "oblique sheets"])
@pytest.mark.parametrize("surface", [TABLE, TOP, plane(TOP_MM, (0.9, 0.4))], ids=["table", "part", "steep"])
def test_a_sheet_is_as_wide_as_rays_traced_to_its_two_edges_say(setup, surface):
    rng = np.random.default_rng(2)
    for sheet in hand_sweeps(RIG, SweepRange((0.0, 0.0, TOP_MM), 50.0), 6, rng, setup):
        pi = sheet.plane.pi
        uv = stripe(pi, surface, rng=rng)[0].uv[::10]
        assert footprint(uv, pi, surface, CAMERA) == pytest.approx(traced(uv, pi, surface), rel=1e-3)


@pytest.mark.parametrize("setup", [Setup(), Setup(hand_aside=1.7)], ids=["as usual", "oblique sheets"])
@pytest.mark.parametrize("seed", range(1, 6))
def test_of_a_matt_part_nothing_is_said_however_the_sheets_meet_it(setup, seed):
    light = light_on_part(*scan(setup=setup, seed=seed), CAMERA, BLUR)
    assert abs(light.wider) < 0.02
    assert not light.surely and light.behind_mm == 0


@pytest.mark.parametrize("share", [0.2, 0.35, 0.5])
def test_light_from_below_is_seen_and_its_mean_lies_within_what_is_told(share):
    """Evenly from 0 to 1.2 mm: variance D² (f/3 − f²/4), mean f D/2."""
    deep = 1.2
    light = light_on_part(*scan(deep**2 * (share / 3 - share**2 / 4)), CAMERA, BLUR)
    assert light.surely
    assert share * deep / 2 <= light.behind_mm < 2.5 * deep / 2


def test_a_part_that_fills_the_picture_is_not_taken_for_the_table():
    seen, cloud = scan(0.15)
    on_part = np.abs(cloud.points @ TOP - 1) < 1e-6
    few = cloud.select(on_part | (np.arange(len(cloud)) % 4 == 0))
    light = light_on_part(seen, few, CAMERA, BLUR)
    assert np.allclose(light.table, TABLE, atol=1e-7)
    assert light.surely


def test_of_very_many_points_some_tell_where_table_and_part_lie():
    seen, cloud = scan(0.15)
    many = cloud.select(np.arange(5 * len(cloud)) % len(cloud))
    assert len(many) > 2 * ENOUGH_POINTS
    few, all_ = (light_on_part(seen, one, CAMERA, BLUR) for one in (cloud, many))
    assert all_.behind_mm == pytest.approx(few.behind_mm, rel=1e-6)
    assert np.allclose(all_.table, TABLE, atol=1e-7)


def test_nothing_is_said_of_a_table_alone_nor_by_few_frames():
    seen, cloud = scan(0.15)
    assert light_on_part(seen[:5], cloud, CAMERA, BLUR) is None
    on_table = np.abs(cloud.points @ TABLE - 1) < 1e-6
    assert light_on_part(seen, cloud.select(on_table), CAMERA, BLUR) is None


def test_without_a_known_blur_a_nearer_part_is_not_told_for_the_blur_that_is_taken_for_the_sheet():
    light = light_on_part(*scan(), CAMERA, None)
    assert light.wider < 0 and not light.surely


def test_the_calibration_s_plates_tell_the_blur_and_how_it_changes_with_depth():
    rng = np.random.default_rng(3)
    fan = Fan(tuple(one.plane for one in hand_sweeps(RIG, SweepRange((0.0, 0.0, TOP_MM), 30.0), 3, rng)))
    plates = []
    for depth in np.linspace(470.0, 620.0, 10):
        normal = np.array([*rng.uniform(-0.5, 0.5, 2), 1.0])
        normal /= np.linalg.norm(normal)
        aside = np.cross([0.0, 1.0, 0.0], normal) / np.hypot(normal[0], normal[2])
        pose = Pose(np.column_stack([aside, np.cross(normal, aside), normal]), np.array([0.0, 0.0, depth]))
        plate = normal / (normal @ pose.translation)
        plates.append((pose, [stripe(pi, plate, noise=0.003, rng=rng)[0] for pi in fan.pis]))
    found = blur_of(plates, CAMERA, fan)
    depths = np.array([TOP_MM, TABLE_MM])
    assert found.at(depths) == pytest.approx(BLUR.at(depths), abs=0.1)
    assert found.per_mm == pytest.approx(BLUR.per_mm, abs=0.002)
    assert blur_of(plates[:2], CAMERA, fan) is None


def test_the_note_tells_twice_the_standard_error_as_u():
    (note,) = notes_on_part_light(PartLight(0.2, 0.01, 0.3, TABLE))
    assert note.values["U"] == pytest.approx(2.0)
    assert "(20.0 ± 2.0) % wider" in str(note)
