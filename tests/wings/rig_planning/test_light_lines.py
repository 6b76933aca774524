from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from core.image.stripes.extraction import extract_centrelines
from core.image.stripes.noise import NoiseModel
from core.image.stripes.stripe import StripeSettings
from core.model.arrays import runs_of
from core.simulate.blur import blurred
from core.simulate.scene.laser import laser_light
from core.simulate.scene.scene import surface_maps
from core.wings.rig_planning.prediction.light_lines import faces_of, lit_lines
from core.wings.rig_planning.prediction.seen_stripes import SeenStripes
from tests.wings.rig_planning.small import SMALL

HEIGHT = 50.0


@pytest.fixture(scope="module")
def seen():
    """Two sweeps over a block: as planned, and as the twin renders them without noise."""
    design, rig = SMALL, SMALL.rig()
    scene = design.scene(HEIGHT)
    faces = faces_of(scene, design.table(), 2 * design.distance_mm)
    filter_px = SeenStripes.of_hand(design).filter_px
    maps = surface_maps(scene, rig.camera)
    pairs = []
    for sheet in design.sweeps_over(scene, seed=1)[2:12:5]:
        planned = lit_lines(sheet, faces, scene.occluders, rig.camera, rig.blur_px, filter_px)
        picture = blurred(laser_light(sheet, scene, maps), rig.blur_px)
        found = extract_centrelines(picture, StripeSettings(5.0, 30.0), noise=NoiseModel(0.05))
        pairs.append((planned, found))
    return pairs


def test_stripes_lie_where_the_twin_shows_them(seen):
    for planned, found in seen:
        true = np.vstack([line.uv for line in planned])
        normal = np.vstack([line.normal for line in planned])
        at = np.vstack([line.uv for line in found])
        distance, nearest = cKDTree(true).query(at)
        across = np.einsum("ni,ni->n", at - true[nearest], normal[nearest])[distance < 1.5]
        assert np.mean(distance < 1.5) > 0.9, "what the camera sees was planned"
        assert np.sqrt(np.mean(across**2)) < 0.03
        back = cKDTree(at).query(true)[0]
        assert np.mean(back < 1.5) > 0.9, "what was planned is seen"


def test_stripes_are_as_bright_and_as_wide_as_the_twins(seen):
    for planned, found in seen:
        tree = cKDTree(np.vstack([line.uv for line in found]))
        strength = np.concatenate([line.strength for line in found])
        width = np.concatenate([line.width for line in found])
        uv = np.vstack([line.uv for line in planned])
        distance, nearest = tree.query(uv)
        near = distance < 1.0
        heights = np.concatenate([line.height for line in planned])[near]
        assert np.median(strength[nearest[near]] / heights) == pytest.approx(1.0, abs=0.05)
        widths = np.concatenate([line.width for line in planned])[near]
        assert np.median(width[nearest[near]] / widths) == pytest.approx(1.0, abs=0.08)


def test_a_stripe_stops_where_the_block_hides_the_table():
    design, rig = SMALL, SMALL.rig()
    scene = design.scene(HEIGHT)
    faces = faces_of(scene, design.table(), 2 * design.distance_mm)
    sheet = design.sweeps_over(scene, seed=1)[6]
    hidden = lit_lines(sheet, faces[:1], scene.occluders, rig.camera, rig.blur_px, 2.0)
    bare = lit_lines(sheet, faces[:1], scene.occluders[:0], rig.camera, rig.blur_px, 2.0)

    assert len(hidden) >= 2
    assert len(bare) == 1
    assert sum(map(len, hidden)) < 0.9 * sum(map(len, bare))


def test_points_lie_on_sheet_and_face_and_one_pixel_apart():
    design, rig = SMALL, SMALL.rig()
    scene = design.scene(HEIGHT)
    faces = faces_of(scene, design.table(), 2 * design.distance_mm)
    sheet = design.sweeps_over(scene, seed=1)[6]
    lines = lit_lines(sheet, faces, scene.occluders, rig.camera, rig.blur_px, 2.0)

    assert {0} < {line.face for line in lines}, "table and block"
    for line in lines:
        face = faces[line.face]
        assert np.abs(sheet.plane.distances(line.points)).max() < 1e-9
        assert np.abs((line.points - face.corners[0]) @ face.normal).max() < 1e-9
        assert np.linalg.norm(np.diff(line.uv, axis=0), axis=1) == pytest.approx(1.0, abs=0.02)


def test_a_longer_lens_sees_only_what_is_in_its_picture():
    design = replace(SMALL, focal_mm=20.0)
    scene = design.scene(HEIGHT)
    faces = faces_of(scene, design.table(), 2 * design.distance_mm)
    rig = design.rig()
    lines = [
        line
        for sheet in design.sweeps_over(scene, seed=1)
        for line in lit_lines(sheet, faces, scene.occluders, rig.camera, rig.blur_px, 2.0)
    ]

    assert lines
    for line in lines:
        assert ((line.uv >= 0) & (line.uv <= np.array(design.pixels) - 1)).all()


def test_runs_are_the_unbroken_stretches():
    assert runs_of(np.array([1, 1, 0, 1, 0, 0, 1, 1, 1], bool)) == [(0, 2), (3, 4), (6, 9)]
    assert runs_of(np.zeros(4, bool)) == []
