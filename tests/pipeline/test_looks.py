"""What is seen of one frame and of one pose."""

import pickle
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.fan.poses.pose_stages import NOT_SEEN
from core.errors import Cancelled, InputError
from core.files.project.data import Accepted
from core.files.project.folder import results_folder
from core.files.recording.recording_set import open_set
from core.files.results.scan_file import read_scan
from core.pipeline.project.details import recall_poses, show_frame, show_pose
from core.pipeline.project.frame_stages import frame_stages
from core.pipeline.steps.scan.pictures import look_at_scan
from core.settings.options import Options
from core.simulate.effects.sensor import SensorEffects
from core.simulate.recording import simulate_set
from core.simulate.scenario import Scenario
from tests.simulated import copy_of


def frame(number):
    return f"scan/frame{number:04d}.png"


def test_a_frame_shows_the_centrelines_and_lines_that_were_measured(done):
    scan = read_scan(results_folder(done.folder) / "scan.npz")
    for number in (0, 7, 15):
        stages = show_frame(done.folder, done.project, frame(number))
        measured = scan.features.frames[number]
        assert (stages.index, stages.name) == (number, measured.name)
        assert [len(piece) for piece in stages.sweep] == [len(piece) for piece in measured.centrelines]
        assert stages.fan_line == scan.fan_line
        assert len(stages.fan) == len(scan.fan_line)


def test_a_raw_frame_shows_the_centrelines_that_its_sites_of_the_lasers_colour_showed(tmp_path):
    sensor = SensorEffects(colour=True, raw=True)
    scenario = Scenario(scale=0.25, frames=4, camera_views=1, plane_poses=1, speckle=0.0, sensor=sensor)
    simulate_set(scenario, tmp_path / "set")
    recording_set = open_set(tmp_path / "set")
    measured = look_at_scan((recording_set, Options())).lines
    for frame in measured.frames:
        stages = frame_stages(recording_set, frame.name)
        assert stages.picture.shape == measured.image_size[::-1]
        assert [piece.uv.tolist() for piece in stages.sweep] == [piece.uv.tolist() for piece in frame.centrelines]
        assert [piece.uv.tolist() for piece in stages.fan] == [piece.uv.tolist() for piece in measured.fan]


def test_every_crossing_of_a_frame_is_good_weak_or_left_out_with_a_sentence(done):
    seen = show_frame(done.folder, done.project, frame(5)).seen
    assert len(seen.crossing_uv) == len(seen.crossing_status) == len(seen.crossing_reason) > 0
    assert set(seen.crossing_status) <= {0, 1, 2}
    assert all(str(reason).endswith(".") for reason in seen.crossing_reason)


def test_difference_and_ridge_are_bright_on_the_sweep_and_dark_on_the_fan(done):
    stages = show_frame(done.folder, done.project, frame(5))
    assert stages.picture.dtype == stages.difference.dtype == stages.ridge.dtype == np.uint8
    assert stages.picture.shape == stages.difference.shape == stages.ridge.shape
    sweep = np.concatenate([piece.uv for piece in stages.sweep]).round().astype(int)
    fan = np.concatenate([piece.uv for piece in stages.fan]).round().astype(int)
    apart = np.abs(fan[:, None] - sweep[None]).max(axis=2).min(axis=1) > 12
    for picture in (stages.difference, stages.ridge):
        on_sweep, on_fan = picture[tuple(sweep.T[::-1])], picture[tuple(fan[apart].T[::-1])]
        assert np.median(on_sweep) > 80
        assert np.median(on_fan) < 20


def test_a_pose_on_which_only_clutter_was_found_shows_what_looks_most_like_a_stripe(done):
    bare = replace(done.poses[0], centrelines=())
    stages = show_pose(done.folder, done.project, bare)
    assert stages.reason.code == "fan.no_straight_stripe"
    assert stages.ridge.shape == stages.picture.shape
    assert show_pose(done.folder, done.project, done.poses[0]).ridge is None


def test_without_calibrations_stripes_are_shown_without_numbers(done):
    stages = show_frame(done.folder, replace(done.project, accepted=Accepted()), frame(5))
    assert stages.seen is None
    assert stages.sweep


def test_before_anything_is_measured_a_frame_can_be_looked_at(simulated):
    stages = frame_stages(open_set(simulated), frame(5))
    assert set(stages.fan_line) == {-1}
    assert stages.sweep
    assert stages.reason is None


def test_a_recording_without_reference_can_be_looked_at(simulated, tmp_path):
    folder = copy_of(simulated, tmp_path / "set")
    (folder / "scan" / "reference.png").unlink()
    assert frame_stages(open_set(folder), frame(5)).sweep


def test_a_frame_left_out_is_shown_all_the_same(done):
    stages = show_frame(done.folder, done.with_options(excluded=frozenset({frame(5)})), frame(5))
    assert stages.left_out
    assert stages.sweep


def test_what_all_frames_share_is_looked_at_once(done):
    told = Counter()

    def progress(step, done, total):
        told[step] += 1

    project = done.with_options(stripe=None, excluded=frozenset({"scan/frame0019.png"}))
    found = open_set_of(done)
    for number in range(4):
        frame_stages(
            found, frame(number), settings=replace(project.options.for_scan, sigma_cut_mm=0.2), progress=progress
        )
    before = dict(told)
    frame_stages(found, frame(6), settings=project.options.for_scan, progress=progress)
    assert told == before


def test_the_first_look_can_be_cancelled_and_begins_anew(done):
    found = open_set_of(done)
    settings = replace(done.project.options.for_scan, excluded=frozenset({frame(0), frame(1)}))

    def stop(step, done, total):
        raise Cancelled

    with pytest.raises(Cancelled):
        frame_stages(found, frame(5), settings=settings, progress=stop)
    assert frame_stages(found, frame(5), settings=settings).sweep


def test_an_unknown_frame_is_named(done):
    with pytest.raises(InputError, match=r"frame0999\.png.*no such frame"):
        show_frame(done.folder, done.project, "scan/frame0999.png")


def test_a_pose_shows_its_corners_and_the_number_of_every_stripe(done):
    for pose in done.poses:
        stages = show_pose(done.folder, done.project, pose, done.fan.fan)
        assert stages.picture.dtype == np.uint8
        assert len(stages.corners) == 4
        assert sorted(stripe.line for stripe in stages.stripes if stripe.line != NOT_SEEN) == [0, 1, 2]
        by_line = {stripe.line: stripe.uv[:, 1].mean() for stripe in stages.stripes}
        assert by_line[0] < by_line[1] < by_line[2]


def test_without_a_fan_stripes_have_no_numbers(done):
    stages = show_pose(done.folder, done.project, done.poses[0])
    assert {stripe.line for stripe in stages.stripes} == {NOT_SEEN}


def test_an_accepted_fan_comes_back_with_all_its_points(done):
    poses, fan = recall_poses(done.folder, done.project)
    assert [pose.name for pose in poses] == [pose.name for pose in done.poses]
    assert np.array_equal(fan.fan.pis, done.fan.fan.pis)
    assert sum(len(points) for pose in fan.poses for points in pose.points) > 1000


def test_looks_can_be_pickled(done):
    stages = show_frame(done.folder, done.project, frame(5))
    assert len(pickle.loads(pickle.dumps(stages)).sweep) == len(stages.sweep)
    pose = show_pose(done.folder, done.project, done.poses[0], done.fan.fan)
    assert len(pickle.loads(pickle.dumps(pose)).stripes) == len(pose.stripes)


def open_set_of(done):
    from core.pipeline.project.workspace import project_set

    return project_set(done.folder, done.project)
