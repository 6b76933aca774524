"""Planes of colour pictures whose channels show the laser at different places."""

import cv2
import numpy as np
import pytest

from core.files.pictures import decode_colours
from core.files.recording import picture_reader
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import open_set
from core.pipeline.steps.planes_step import measure_poses, solve_planes
from core.simulate.rig import paper_rig
from tests.simulated import TINY, copy_of

CAMERA = paper_rig(scale=TINY.scale).camera
TOLD = "fan.channels_differ"


def in_colour(folder, to, aside_px):
    """The set with its poses in colour: a red laser, its light lower in green by so many px, and a little in blue."""
    folder = copy_of(folder, to)
    for path in sorted((folder / "planes").glob("pose*.png")):
        if path.stem.endswith("_off"):
            continue
        beside = path.with_name(f"{path.stem}_off.png")
        on, off = (cv2.imread(str(one), cv2.IMREAD_UNCHANGED) for one in (path, beside))
        light = on.astype(np.float32) - off
        moved = cv2.warpAffine(light, np.array([[1, 0, 0], [0, 1, aside_px]], np.float32), light.shape[::-1])
        channels = [off + share * one for share, one in ((0.05, light), (0.8, moved), (1.0, light))]
        cv2.imwrite(str(path), np.clip(np.round(np.dstack(channels)), 0, 255).astype(np.uint8))
        cv2.imwrite(str(beside), np.dstack([off] * 3))
    return open_set(folder)


def test_of_grey_pictures_there_are_no_other_channels(tiny_set):
    assert all(pose.others == {} for pose in measure_poses(PictureReader(open_set(tiny_set)), CAMERA))


@pytest.mark.parametrize("make", [lambda folder, _: open_set(folder), lambda folder, to: in_colour(folder, to, 0.0)])
def test_each_picture_of_a_pose_is_decoded_once_in_grey_and_in_colour(tiny_set, tmp_path, monkeypatch, make):
    found = make(tiny_set, tmp_path / "set")
    pictures = PictureReader(found)
    pictures.laser_channel("planes")  # looks at three of them
    decoded = []

    def decode(data, path, *mosaic):
        decoded.append(path.name)
        return decode_colours(data, path, *mosaic)

    monkeypatch.setattr(picture_reader, "decode_colours", decode)
    measure_poses(pictures, CAMERA)
    assert sorted(decoded) == sorted(path.name for pair in found.planes for path in (pair.on, pair.off))


@pytest.mark.parametrize(("aside_px", "told"), [(0.0, False), (1.0, True)])
def test_planes_of_a_set_in_colour_tell_whether_its_channels_agree(tiny_set, tmp_path, aside_px, told):
    found = in_colour(tiny_set, tmp_path / "set", aside_px)
    poses = measure_poses(PictureReader(found), CAMERA)
    assert any("green" in pose.others for pose in poses)
    assert not any("blue" in pose.others for pose in poses)
    fan = solve_planes(poses, CAMERA, found.rig)
    assert (TOLD in {note.code for note in fan.notes}) == told
