"""Where no stripe is found on a pose, a picture shows why."""

from dataclasses import replace

import numpy as np
import pytest

from core.errors import InputError
from core.files.pictures import read_picture, write_picture
from core.files.recording.recording_set import open_set
from core.image.stripes.stripe import StripeSettings
from core.pipeline.steps.planes_step import planes_step
from core.pipeline.steps.workspace import RIDGES, Workspace
from core.settings.options import Options
from tests.simulated import copy_of

TOO_FAINT = Options(plane_stripe=StripeSettings(8.0, 1000.0))


@pytest.fixture
def work(tiny_set, tiny_measured, tmp_path):
    """A set of which pose01 was taken with the fan off, and a calibrated camera."""
    folder = copy_of(tiny_set, tmp_path / "set")
    off = read_picture(folder / "planes" / "pose01_off.png")
    noise = np.random.default_rng(1).normal(0, 1, off.shape)
    write_picture(folder / "planes" / "pose01.png", np.clip(np.round(off + noise), 0, 255).astype(np.uint8))
    workspace = Workspace.open(open_set(folder), tmp_path / "out")
    workspace.path("camera").write_bytes((tiny_measured / "camera.json").read_bytes())
    return workspace


def ridges(work: Workspace) -> list[str]:
    return sorted(path.name for path in (work.out / RIDGES).glob("*"))


def test_the_pose_without_a_stripe_has_its_picture_in_place_of_older_ones_and_a_note_tells_of_it(work):
    work.put_ridges({"of an older set": np.zeros((2, 3), np.uint8)})
    planes_step(work)
    assert ridges(work) == ["pose01-ridge.png"]
    ridge = read_picture(work.out / RIDGES / "pose01-ridge.png")
    assert ridge.shape == read_picture(work.recording_set.planes[1].on).shape
    assert ridge.max() >= 250
    assert "fan.ridges_written" in [note.code for note in work.record().notes["planes"]]
    clearing_takes_them_away(work)


def test_pictures_are_there_where_no_planes_came_of_it_and_the_error_says_so(work):
    with pytest.raises(InputError, match=r"none of the .* look at the pictures in planes/"):
        planes_step(work, TOO_FAINT)
    assert ridges(work) == [f"{pair.name}-ridge.png" for pair in work.recording_set.planes]
    assert not work.path("planes").exists()


def clearing_takes_them_away(work: Workspace) -> None:
    (work.out / RIDGES / "of somebody else.txt").touch()
    work.clear()
    assert ridges(work) == ["of somebody else.txt"]


def test_where_every_pose_has_its_stripes_there_is_no_folder(work, tiny_set):
    whole = replace(work, recording_set=open_set(tiny_set))
    whole.put_ridges({"pose00": np.zeros((2, 3), np.uint8)})
    planes_step(whole)
    assert not (work.out / RIDGES).exists()
