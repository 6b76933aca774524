"""Known planes in simulated sets: boards beside the object, seen where the truth has them, and their effects."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.fan.poses.target_plane import target_plane
from core.errors import InputError
from core.files.pictures import read_picture
from core.files.recording.recording_set import open_set, require_planes
from core.image.targets import detect, estimate_pose
from core.simulate.effects.boards import BoardsBeside
from core.simulate.recording import moved_stage, scan_of, scenario_rig, simulate_set
from core.simulate.scenario import Scenario
from core.simulate.truth import load_truth

SMALL = Scenario(scale=0.25, frames=3, camera_views=1, plane_poses=1, seed=4)
CORNER = replace(SMALL, fan_lines=0, boards=BoardsBeside(corner=True))
PLATE = replace(SMALL, boards=BoardsBeside(plate=True))


def simulated(scenario, folder):
    simulate_set(scenario, folder)
    return open_set(folder), load_truth(folder)


@pytest.fixture(scope="module")
def corner(tmp_path_factory):
    return simulated(CORNER, tmp_path_factory.mktemp("sets") / "corner")


def off_plane(found, truth):
    """Of each board's pose as seen in its picture, how far in mm it puts the middle of the true one off its plane."""
    off = {}
    for plane in found.known_planes:
        picture = read_picture(plane.pictures[0])
        view = detect(plane.target, picture, camera=truth.camera, region_px=plane.stated.region_px)
        seen, true = estimate_pose(view, truth.camera).pose, truth.known_planes[plane.name]
        middle = true.apply(view.points.mean(axis=0)[None])[0]
        off[plane.name] = float((target_plane(seen) @ middle - 1) / np.linalg.norm(target_plane(seen)))
    return off


def test_a_corner_without_fan_is_a_set_of_its_own(corner):
    found, truth = corner
    assert [plane.name for plane in found.known_planes] == ["far", "near"]
    assert {plane.print_of for plane in found.known_planes} == {"near"}
    assert not found.rig.has_fan and found.planes == () and truth.fan is None
    with pytest.raises(InputError, match="which states that the rig has no fan"):
        require_planes(found)
    normals = [truth.known_planes[name].rotation[:, 2] for name in ("near", "far")]
    assert np.degrees(np.arccos(normals[0] @ normals[1])) == pytest.approx(90.0)
    stage, _, _ = scan_of(CORNER)
    assert np.array_equal(stage.still, stage.room_light), "no light of a fan"


def test_boards_are_seen_where_the_truth_has_them(corner):
    assert max(map(abs, off_plane(*corner).values())) < 0.15


def test_the_surface_lies_on_the_boards_where_they_are_seen(corner):
    _, truth = corner
    for pose in truth.known_planes.values():
        middle = pose.apply(np.array([[133.0, 35.0, 0.0]]))
        u, v = np.rint(truth.camera.project(middle)[0]).astype(int)
        depth = float(truth.depth[v, u])
        ray = truth.camera.rays(np.array([[u, v]], float))[0]
        assert target_plane(pose) @ (ray * depth) == pytest.approx(1.0, abs=1e-5)
        assert not truth.table[v, u]


def test_nearly_every_sweep_crosses_both_boards():
    stage, sheets, _ = scan_of(replace(CORNER, frames=60, scale=0.1))
    crossed = []
    for board in stage.scene.boards:
        corners = board.pose.apply(board.pattern.outline)
        sides = np.array([np.sign(corners @ sheet.plane.pi - 1) for sheet in sheets])
        crossed.append(np.abs(sides.sum(axis=1)) < 4)
    assert np.all(crossed[0]) and np.mean(crossed[1]) > 0.9


def test_a_plate_is_the_plane_target_and_outlines_are_told_apart_by_where_they_are(tmp_path):
    found, truth = simulated(PLATE, tmp_path / "plate")
    (plate,) = found.known_planes
    assert (plate.name, plate.target, plate.print_of) == ("plate", found.rig.plane_target, "plane_target")
    assert abs(off_plane(found, truth)["plate"]) < 0.3
    outlined = replace(CORNER, boards=BoardsBeside(corner=True, kind="rectangle"))
    assert max(map(abs, off_plane(*simulated(outlined, tmp_path / "outlined")).values())) < 0.3


def test_larger_boards_seem_nearer_than_they_are(tmp_path):
    found, truth = simulated(replace(CORNER, boards=BoardsBeside(corner=True, larger=0.01)), tmp_path / "large")
    near = truth.known_planes["near"]
    expected = 0.01 * near.rotation[:, 2] @ near.translation
    assert off_plane(found, truth)["near"] == pytest.approx(expected, rel=0.15)


def test_the_first_board_is_bent_and_moved_and_all_others_stay():
    bent = replace(CORNER, moved_frame=2, boards=BoardsBeside(corner=True, bent_mm=0.5, moved_mm=3.0))
    flat, _, _ = scan_of(CORNER)
    stage, _, _ = scan_of(bent)
    near, far = stage.scene.boards
    change = stage.maps.depth - flat.maps.depth
    edge, middle = (near.pose.apply(np.array([[x, 35.0, 0.0]])) for x in (-8.0, 133.0))
    at = [tuple(np.rint(stage.rig.camera.project(one)[0]).astype(int)[::-1]) for one in (edge, middle)]
    forward = 0.5 * (141 / 143) ** 2 / abs(near.pose.rotation[:, 2] @ edge[0] / edge[0, 2])
    assert change[at[0]] == pytest.approx(-forward, rel=0.1)
    assert abs(change[at[1]]) < 1e-3
    later = moved_stage(bent, scenario_rig(bent))
    step = later.scene.boards[0].pose.translation - near.pose.translation
    assert np.linalg.norm(step) == pytest.approx(3.0)
    assert np.array_equal(later.scene.boards[1].pose.translation, far.pose.translation)
    assert [np.array_equal(one.triangles, other.triangles)
            for one, other in zip(later.scene.meshes, stage.scene.meshes, strict=True)] == [True]  # fmt: skip


def test_the_objects_shadow_falls_on_a_plate_behind_it():
    plain, _, _ = scan_of(PLATE)
    shaded, _, _ = scan_of(replace(PLATE, boards=BoardsBeside(plate=True, shaded=True)))
    (plate,) = plain.scene.boards
    u, v = (
        np.rint(plain.rig.camera.project(plate.pose.apply(np.array([[30.0, 105.0, 0], [30.0, -40.0, 0]]))))
        .astype(int)
        .T
    )
    light = shaded.room_light[v, u]
    assert light[0] < 0.75 * light[1]
    light = plain.room_light[v, u]
    assert light[0] > 0.85 * light[1]
