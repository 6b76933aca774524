"""Small pictures for lists."""

import cv2
import numpy as np
import pytest

from core.files.pictures import write_picture
from core.pipeline.project.thumbnails import brightened, display_picture, stripe_thumbnails, thumbnails


def test_a_faint_stripe_is_seen_in_the_small_picture_of_a_frame(tmp_path):
    picture = np.full((600, 960), 25, np.uint8)
    picture[:, 478:484] = 110
    write_picture(tmp_path / "frame.png", picture)
    (plain,), (bright,) = thumbnails([tmp_path / "frame.png"]), stripe_thumbnails([tmp_path / "frame.png"])
    assert plain.shape == bright.shape == (75, 120)
    assert plain.max() < 100
    assert bright.max() == 255 and np.median(bright) == 0
    assert np.all(bright.argmax(axis=1) == plain.argmax(axis=1))


@pytest.mark.parametrize("channel", [None, "red"])
def test_raw_pictures_of_a_mosaic_are_shown_without_its_checkerboard(tmp_path, channel):
    raw = np.full((80, 120), 20, np.uint8)
    raw[::2, ::2] = 180  # the red sites of a red scene
    write_picture(tmp_path / "frame.png", raw)
    as_it_is, _ = display_picture(tmp_path / "frame.png", channel, 120)
    assert np.ptp(as_it_is) == 160, "nobody said that it is raw"
    shown, _ = display_picture(tmp_path / "frame.png", channel, 120, "RGGB")
    (small,) = thumbnails([tmp_path / "frame.png"], channel, "RGGB")
    for picture in (shown, small):
        inner = picture[2:-2, 2:-2]
        assert np.ptp(inner) == 0 and (inner[0, 0] == 180) == (channel == "red")


def test_a_picture_with_colours_is_no_raw_one_whatever_the_rig_says(tmp_path):
    colours = np.zeros((80, 120, 3), np.uint8)
    colours[..., 2] = 200
    cv2.imwrite(str(tmp_path / "frame.png"), colours)
    shown, _ = display_picture(tmp_path / "frame.png", "red", 120, "RGGB")
    assert np.all(shown == 200)


def test_noise_alone_is_not_brightened_to_stripes():
    noise = np.random.default_rng(1).integers(24, 28, (75, 120)).astype(np.uint8)
    assert brightened(noise).max() < 64


def test_a_picture_that_cannot_be_read_has_none(tmp_path):
    (tmp_path / "frame.png").write_bytes(b"nothing")
    assert stripe_thumbnails([tmp_path / "frame.png"]) == (None,)
