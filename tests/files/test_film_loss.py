"""What films lose, by their own word or as assumed, covers how far lines in their frames are off."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from core.acquire.grey import to_grey
from core.files.film import film_pictures, read_film
from core.files.jpeg import compression_by
from core.image.background import quantile_reference
from core.image.stripes.extraction import choose_settings, extract_centrelines
from core.image.stripes.noise import UNCOMPRESSED, estimate_noise
from tests.films import write_film

pytestmark = pytest.mark.accuracy

WIDTH, HEIGHT, FRAMES = 640, 360, 30


def place(number, v):
    """Where the line of a frame is, px, along v: slanted and bent."""
    return 40 + (WIDTH - 80) * number / FRAMES + 0.12 * (v - HEIGHT / 2) + 6 * np.sin(v / 80)


@pytest.fixture(scope="module")
def pictures():
    rng = np.random.default_rng(1)
    room = cv2.GaussianBlur(rng.normal(0, 1, (HEIGHT, WIDTH)), (0, 0), 6)
    room = 70 + 12 * room / room.std()
    v, u = np.mgrid[0:HEIGHT, 0:WIDTH].astype(float)
    made = []
    for number in range(FRAMES):
        line = 100 * np.exp(-((u - place(number, v)) ** 2) / (2 * 1.8**2))
        colours = np.dstack([room + share * line for share in (0.03, 0.06, 1.0)])
        noisy = colours + rng.normal(0, 2.5, colours.shape)
        made.append(np.clip(np.rint(noisy), 0, 255).astype(np.uint8))
    return made


@pytest.mark.parametrize("channel", [None, "red"])
@pytest.mark.parametrize(
    ("name", "coding", "least", "most"),
    [
        ("a.avi", "FFV1", 0.8, 1.25),
        ("a.avi", "MJPG", 0.3, 1.1),
        ("a.mp4", "mp4v", 0.1, 0.8),
        ("a.mp4", "vp09", 0.1, 0.8),
    ],
)
def test_lines_in_a_films_frames_are_off_by_no_more_than_their_sigma(
    tmp_path, pictures, name, coding, least, most, channel
):
    film, _ = read_film(write_film(tmp_path / name, pictures, coding, 30.0))
    seen = [to_grey(picture, channel) for _, picture in film_pictures(film)]
    background = quantile_reference(seen[::2]).astype(np.float32)
    loss = UNCOMPRESSED if film.loss is None else compression_by(film.loss.components, channel)
    noise = replace(estimate_noise(background), compression=loss).of_difference(float(np.median(background)))
    ratios = []
    for number in range(3, FRAMES, 5):
        difference = seen[number] - background
        stripe = choose_settings(difference, 255.0)
        for line in extract_centrelines(difference, stripe, noise=noise, saturated=seen[number] == 255):
            off = line.uv[:, 0] - place(number, line.uv[:, 1])
            ratios += list((off / line.sigma)[np.abs(off) < 3])
    assert len(ratios) > 1500
    assert least < np.sqrt(np.mean(np.square(ratios))) < most
