"""Small pictures for lists."""

import numpy as np

from core.files.pictures import write_picture
from core.pipeline.project.thumbnails import brightened, stripe_thumbnails, thumbnails


def test_a_faint_stripe_is_seen_in_the_small_picture_of_a_frame(tmp_path):
    picture = np.full((600, 960), 25, np.uint8)
    picture[:, 478:484] = 110
    write_picture(tmp_path / "frame.png", picture)
    (plain,), (bright,) = thumbnails([tmp_path / "frame.png"]), stripe_thumbnails([tmp_path / "frame.png"])
    assert plain.shape == bright.shape == (75, 120)
    assert plain.max() < 100
    assert bright.max() == 255 and np.median(bright) == 0
    assert np.all(bright.argmax(axis=1) == plain.argmax(axis=1))


def test_noise_alone_is_not_brightened_to_stripes():
    noise = np.random.default_rng(1).integers(24, 28, (75, 120)).astype(np.uint8)
    assert brightened(noise).max() < 64


def test_a_picture_that_cannot_be_read_has_none(tmp_path):
    (tmp_path / "frame.png").write_bytes(b"nothing")
    assert stripe_thumbnails([tmp_path / "frame.png"]) == (None,)
