"""A recording that is watched while it is measured, and the measured scan as it is shown."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

from core.errors import Cancelled, InputError
from core.files.project.data import Accepted
from core.files.project.folder import results_folder
from core.files.results.run_file import read_run, write_run
from core.image.exclusion import Exclusion
from core.messages import Message
from core.pipeline.live.events import ScanDetail
from core.pipeline.project.details import accepted_calibration, show_scan
from core.pipeline.project.results import load_results
from core.pipeline.project.thumbnails import display_picture
from core.pipeline.project.watched_scan import WatchReporter, measure_watched
from core.report.facts.pictures import left_out
from core.scan.features.frames import left_out_notes
from tests.simulated import copy_of


@pytest.fixture(scope="module")
def details(done) -> list[ScanDetail]:
    told: list[ScanDetail] = []
    watched = WatchReporter(done.camera.camera.image_size, told.append)
    for preview in done.watched:
        watched(preview)
    return told


def test_every_frame_is_told_of_once_and_in_order(done, details):
    assert [detail.preview.name for detail in details] == [frame.name for frame in done.summary.frames]
    assert {detail.stage for detail in details} == {"scanning"}
    assert all(detail.preview.renewed is None and detail.preview.fan_lines is None for detail in details)


def test_points_put_together_are_those_of_the_last_renewal_and_of_each_frame_since(done, details):
    shown = 0
    for preview, detail in zip(done.watched, details, strict=True):
        assert detail.renewed == (preview.renewed is not None)
        expected = len(preview.points) if preview.renewed is None else len(preview.renewed)
        assert len(detail.points) == expected
        shown = expected if detail.renewed else shown + expected
    assert shown > 1000


def test_coverage_grows_and_fan_lines_stand_once_they_are_known(details):
    covered = [int(detail.cells.sum()) for detail in details]
    assert covered == sorted(covered) and covered[-1] > covered[0]
    assert (details[-1].cells <= details[-1].lit).all()
    assert 0 < details[-1].share <= 1
    assert all(len(detail.fan_lines) == 3 for detail in details)


def test_measuring_watched_gives_what_measuring_gives_and_can_be_cancelled(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")

    def cancelled(step, _done, _total):
        if step == "frames":
            raise Cancelled

    before = (results_folder(folder) / "cloud.ply").read_bytes()
    with pytest.raises(Cancelled):
        measure_watched(folder, done.project, cancelled, lambda _: None)
    assert (results_folder(folder) / "cloud.ply").read_bytes() == before


def test_without_calibrations_nothing_is_watched_but_told_why(done):
    with pytest.raises(InputError, match="no calibration of the camera"):
        measure_watched(done.folder, replace(done.project, accepted=Accepted()), watch=lambda _: None)


def test_the_look_of_a_scan_says_what_the_measurement_said(done):
    look = show_scan(done.folder)
    assert len(look) == done.summary.points and look.triangles == done.summary.triangles
    assert look.points.dtype == look.sigma.dtype == np.float32
    assert look.frames == done.summary.frames
    assert look.frames_used == sum(frame.used for frame in done.summary.frames)
    assert look.frames_used + sum(len(one.names) for one in left_out(look.frames)) == len(look.frames)
    assert look.median_sigma_mm == pytest.approx(np.median(look.sigma), rel=1e-5)
    assert look.median_sigma_mm < look.sigma_95_mm <= done.project.options.sigma_cut_mm
    assert 0 < look.share < 1 and look.stripe.width_px > 1
    assert not look.problems
    assert look.ground is not None and look.ground.d_mm == load_results(done.folder).gauge.lower.plane.d_mm
    assert len(pickle.dumps(look)) < 40 * len(look) + 20_000


def test_what_is_said_of_frames_left_out_is_shown_with_the_frames_alone(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    run = results_folder(folder) / "run.json"
    record = read_run(run)
    frames = (replace(record.frames[0], used=False, reason=Exclusion.MOVED.message), *record.frames[1:])
    note = Message("scan.rig_not_checked", "Nobody knows.")
    write_run(run, replace(record, frames=frames, notes={"scan": (*left_out_notes(frames), note)}))
    assert show_scan(folder).notes == (note,)


def test_no_result_is_shown_as_none(tmp_path):
    look = show_scan(tmp_path)
    assert len(look) == 0 and look.frames == () and look.stripe is None
    assert np.isnan(look.median_sigma_mm) and look.share == 0


def test_a_damaged_result_is_shown_as_none_with_the_reason(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    (results_folder(folder) / "cloud.ply").write_bytes(b"ply\nnonsense")
    look = show_scan(folder)
    assert len(look) == 0
    assert any("cloud.ply" in str(problem) for problem in look.problems)


def test_accepted_calibrations_come_as_far_as_there_are_any(done):
    camera, fan, _ = accepted_calibration(done.folder, done.project)
    assert camera.image_size == done.camera.camera.image_size and fan.lines == 3
    only_camera = replace(done.project, accepted=replace(done.project.accepted, planes=""))
    assert accepted_calibration(done.folder, only_camera)[1] is None
    assert accepted_calibration(done.folder, replace(done.project, accepted=Accepted())) == (None, None, None)


def test_a_frame_is_shown_reduced_by_a_whole_factor(done, simulated):
    width = done.camera.camera.image_size[0]
    picture, factor = display_picture(simulated / "scan" / "frame0003.png", None, width // 2)
    assert factor == 2 and picture.dtype == np.uint8 and picture.shape[1] == width // 2
