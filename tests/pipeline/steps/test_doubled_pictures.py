"""Pictures that are in a set twice count once: a camera or a film repeats frames, and files are copied."""

import shutil
from pathlib import Path
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from core.files.pictures import read_picture
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import open_set
from core.files.recording.set_listing import pictures_in
from core.files.results.ply import read_cloud
from core.files.results.scan_file import read_scan
from core.image.exclusion import Exclusion
from core.pipeline.steps.camera_step import camera_step
from core.pipeline.steps.check_step import measure_check
from core.pipeline.steps.planes_step import measure_poses, planes_step
from core.pipeline.steps.scan_step import scan_step
from core.pipeline.steps.workspace import Workspace, read_calibration
from core.settings.options import Options
from tests.simulated import copy_of

COARSE = Options(sigma_cut_mm=0.3)


def measured(folder: Path, out: Path):
    work = Workspace.open(open_set(folder), out)
    return camera_step(work), planes_step(work), scan_step(work, COARSE), work.record()


@pytest.fixture(scope="module")
def both(tiny_set, tiny_measured, tmp_path_factory):
    """The results of a set, and of one in which every picture is twice: as copy, and written anew as another kind."""
    folder = tmp_path_factory.mktemp("doubled")
    twice = copy_of(tiny_set, folder / "set")
    for part in ("camera", "planes", "scan"):
        for number, path in enumerate(pictures_in(twice / part)):
            if path.stem == "reference":
                continue
            name, off = path.stem.removesuffix("_off"), "_off" if path.stem.endswith("_off") else ""
            again = path.with_name(f"{name}z{off}.png")
            if number % 2:
                shutil.copy(path, again)
            else:
                write_as_bmp(path, again.with_suffix(".bmp"))
    known = read_calibration(tiny_measured)
    cloud, facts = read_cloud(tiny_measured / "cloud.ply").cloud, read_scan(tiny_measured / "scan.npz").facts
    once = SimpleNamespace(cloud=cloud, facts=facts)
    return (known.camera, known.fan, once), measured(twice, folder / "twice")


def write_as_bmp(path: Path, to: Path) -> None:
    to.write_bytes(cv2.imencode(".bmp", read_picture(path))[1].tobytes())


def test_views_that_are_there_twice_give_the_camera_and_its_sd_as_once(both):
    (once, *_), (twice, *_) = both
    assert np.array_equal(once.camera.matrix, twice.camera.matrix)
    assert np.array_equal(once.covariance, twice.covariance)


def test_poses_that_are_there_twice_give_the_planes_and_their_sd_as_once(both):
    (_, once, *_), (_, twice, *_) = both
    assert np.array_equal(once.fan.pis, twice.fan.pis)
    assert np.array_equal(once.fan.covariance, twice.fan.covariance)
    assert len(twice.poses) == 2 * len(once.poses)


def test_frames_that_are_there_twice_give_the_same_points(both):
    (*_, once), (*_, twice, _) = both
    assert np.array_equal(once.cloud.points, twice.scan.cloud.points)
    assert np.array_equal(once.cloud.sigma, twice.scan.cloud.sigma.astype(np.float32)), "as it is kept"
    assert once.facts.moved == twice.scan.moved


@pytest.mark.parametrize(
    ("step", "code", "count", "names"),
    [
        ("camera", "camera.views_repeated", 6, ("camera/view00z.bmp", "camera/view05z.png")),
        ("planes", "fan.poses_left_out", 4, ("pose00z", "pose03z")),
        ("scan", "scan.many_frames_without_points", 8, ("scan/frame0000z.bmp", "scan/frame0002z.bmp")),
    ],
)
def test_each_step_tells_it_once_with_the_names(both, step, code, count, names):
    _, (*_, record) = both
    told = [note for note in record.notes[step] if str(Exclusion.REPEATED.message) in str(note)]
    assert [note.code for note in told] == [code]
    assert told[0].values["n"] == count
    assert all(name in str(told[0]) for name in names)


def test_a_pose_of_the_check_that_is_one_picture_twice_counts_once(tiny_set, both, tmp_path):
    (camera, *_), _ = both
    folder = copy_of(tiny_set, tmp_path / "set")
    for path in (folder / "planes").iterdir():
        if not path.stem.startswith(("pose00", "pose01")):
            path.unlink()
    shutil.copytree(folder / "planes", folder / "check")
    shutil.copy(folder / "check" / "pose00.png", folder / "check" / "pose99.png")
    found = open_set(folder)
    poses = measure_check(PictureReader(found), camera.camera)
    assert [pose.name for pose in poses if pose.exclusion is Exclusion.REPEATED] == ["pose99"]
    assert not any(pose.exclusion is Exclusion.REPEATED for pose in measure_poses(PictureReader(found), camera.camera))
