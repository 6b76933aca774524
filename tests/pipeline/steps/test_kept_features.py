"""A scan solved again with other settings: the same bytes as from its pictures, without looking at them."""

from dataclasses import replace

import numpy as np
import pytest

from core.errors import Cancelled
from core.files.pictures import read_picture, write_picture
from core.files.project.folder import results_folder
from core.files.results.run_file import read_run
from core.files.results.scan_file import read_scan
from core.pipeline.project.measuring import measure_scan
from tests.simulated import copy_of

RESULTS = ("cloud.ply", "mesh.ply", "scan.npz", "gauge.json", "gauge.npz")


def stages_of(folder, project, watch=None):
    """Measure; returns the stages gone through."""
    stages = {}
    measure_scan(folder, project, lambda step, *_: stages.setdefault(step), watch)
    return list(stages)


def looks_at_frames(folder, project):
    """Whether measuring begins with the pictures; once it has, it need not go on."""

    def leave(step, *_):
        if step == "frames":
            raise Cancelled

    try:
        measure_scan(folder, project, leave)
    except Cancelled:
        return True
    return False


def contents(folder):
    results = results_folder(folder)
    return {name: (results / name).read_bytes() for name in RESULTS if (results / name).exists()}


@pytest.fixture
def own(done, tmp_path):
    """A project of its own, with its own recording, measured: folder and project."""
    folder = copy_of(done.folder, tmp_path / "project")
    recording = copy_of(done.project.sources.scan, folder / "recordings" / "scan")
    project = replace(done.project, sources=replace(done.project.sources, scan=str(recording)))
    return folder, project


@pytest.mark.parametrize(
    "changes",
    [
        {"sigma_cut_mm": 0.12},
        pytest.param({"method": "three-crossings", "sigma_cut_mm": 2.0}, marks=pytest.mark.accuracy),
    ],
)
def test_another_cut_or_method_gives_the_bytes_of_a_full_run_without_looking_at_a_frame(done, tmp_path, changes):
    project = done.with_options(**changes)
    quick = copy_of(done.folder, tmp_path / "quick")
    full = copy_of(done.folder, tmp_path / "full")
    (results_folder(full) / "scan.npz").unlink()
    watched = []
    assert "frames" not in stages_of(quick, project, watched.append)
    assert watched == []
    assert "frames" in stages_of(full, project)
    assert contents(quick) == contents(full)
    assert contents(quick)["cloud.ply"] != contents(done.folder)["cloud.ply"]
    the_record_names_the_same_pictures_notes_and_frames(quick, full)


def the_record_names_the_same_pictures_notes_and_frames(quick, full):
    one, other = (read_run(results_folder(folder) / "run.json") for folder in (quick, full))
    assert one.inputs == other.inputs
    assert one.notes == other.notes
    assert one.settings == other.settings
    assert repr(one.frames) == repr(other.frames)


@pytest.mark.accuracy
def test_a_frame_that_was_changed_on_the_disk_is_looked_at_again(own):
    folder, project = own
    measure_scan(folder, project)
    finer, coarser = (replace(project, options=replace(project.options, sigma_cut_mm=cut)) for cut in (0.2, 0.25))
    assert not looks_at_frames(folder, finer)
    frame = sorted((folder / "recordings" / "scan").glob("frame*.png"))[2]
    picture = read_picture(frame).copy()
    picture[0, 0] += np.uint8(1)
    write_picture(frame, picture)
    assert looks_at_frames(folder, coarser)


def test_measured_again_with_nothing_changed_the_pictures_are_looked_at_again(done, tmp_path):
    assert looks_at_frames(copy_of(done.folder, tmp_path / "project"), done.project)


@pytest.mark.accuracy
def test_measured_again_with_nothing_changed_the_results_are_the_same(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    assert "frames" in stages_of(folder, done.project)
    assert contents(folder) == contents(done.folder)


@pytest.mark.parametrize(
    "change", [{"excluded": frozenset({"scan/frame0001.png"})}, {"stripe": "set"}], ids=["left out", "stripe"]
)
def test_what_the_pictures_are_looked_at_with_is_never_taken_over(done, tmp_path, change):
    folder = copy_of(done.folder, tmp_path / "project")
    if "stripe" in change:
        seen = read_scan(results_folder(folder) / "scan.npz").features.sweep_stripe
        change = {"stripe": replace(seen, width_px=1.1 * seen.width_px)}
    assert looks_at_frames(folder, done.with_options(**change))


def test_a_damaged_or_older_scan_file_is_passed_over(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    scan = results_folder(folder) / "scan.npz"
    scan.write_bytes(scan.read_bytes()[:1000])
    assert looks_at_frames(folder, done.with_options(sigma_cut_mm=0.2))
