import numpy as np

from core.simulate.rig import paper_rig
from core.simulate.scenario import Scenario
from core.simulate.scene.image import generator
from core.simulate.scene.stage import WORK_POINT, aim_of, build_scene
from core.simulate.sweep import hand_sweeps, sweep_range

RIG = paper_rig(0.5)
SCENE, _ = build_scene(Scenario())
SHEETS = hand_sweeps(RIG, sweep_range(SCENE, aim_of(SCENE)), 60, generator(1, "sweeps"))


def image_direction(plane) -> np.ndarray:
    """Direction of the plane's stripe in the picture, on a surface square to the view at the work point."""
    along = np.cross(plane.normal, [0.0, 0.0, 1.0])[:2]
    return along / np.linalg.norm(along)


def test_the_hand_stays_beside_the_camera_on_both_sides_and_out_of_the_picture():
    sides = []
    for sheet in SHEETS:
        x, y, z = sheet.emitter
        assert 150 < np.hypot(x, y) < 350
        assert -50 < z < 130
        sides.append(np.sign(x))
    assert 15 < np.sum(np.array(sides) > 0) < 45


def test_every_stripe_crosses_the_fan_lines_at_35_degrees_and_more():
    fan = image_direction(RIG.fan.planes[1])
    for sheet in SHEETS:
        assert np.degrees(np.arccos(abs(image_direction(sheet.plane) @ fan))) > 33


def test_stripes_of_different_passes_cross_each_other():
    directions = np.array([image_direction(sheet.plane) for sheet in SHEETS])
    angles = np.degrees(np.arccos(np.clip(np.abs(directions @ directions.T), 0, 1)))
    assert (angles > 30).mean() > 0.35


def test_stripes_sweep_over_the_object_and_the_table_on_both_sides():
    x = []
    for sheet in SHEETS:
        middle = WORK_POINT + [0, 0, 25]
        direction = image_direction(sheet.plane)
        across = np.array([1.0, 0.0, 0.0])
        x.append((sheet.plane.d_mm - middle @ sheet.plane.normal) / (across @ sheet.plane.normal))
        assert abs(direction[1]) > 0.5
    assert min(x) < -50
    assert max(x) > 50
    assert np.sort(np.diff(np.sort(x))).max() < 20


def test_emitter_and_axis_lie_in_their_plane():
    for sheet in SHEETS:
        assert abs(sheet.plane.distances(sheet.emitter[None])[0]) < 1e-9
        assert abs(sheet.axis @ sheet.plane.normal) < 1e-12


def test_number_of_frames_is_what_was_asked():
    for frames in (0, 1, 3, 7, 200):
        reach = sweep_range(SCENE, aim_of(SCENE))
        assert len(hand_sweeps(RIG, reach, frames, generator(1, "sweeps"))) == frames
