"""Hot pixels: found in pictures of different scenes, and nothing else taken for them."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import open_set
from core.image.hot_pixels import hot_pixels, standing_out
from core.pipeline.steps.camera_step import see_views, solve_camera
from core.simulate.recording import simulate_set
from tests.simulated import SMALL

HOT = ((40, 31), (7, 90), (80, 62))


def pictures(scale=1, dtype=np.uint8, glint_sigma=0.0):
    """Eight plates that move over a background, with hot pixels or blurred points of light that do not."""
    rng, found = np.random.default_rng(4), []
    for k in range(8):
        light = np.full((120, 160), 30.0)
        cv2.rectangle(light, (30 + 5 * k, 20 + 4 * k), (90 + 5 * k, 70 + 4 * k), 180.0, -1)
        light = cv2.GaussianBlur(light, (0, 0), 0.8)
        points = np.zeros_like(light)
        for v, u in HOT:
            points[v, u] = 60.0 if not glint_sigma else 400.0
        light += cv2.GaussianBlur(points, (0, 0), glint_sigma) if glint_sigma else points
        light += rng.normal(0, 1.5, light.shape)
        found.append(np.clip(np.rint(light * scale), 0, np.iinfo(dtype).max).astype(dtype))
    return found


@pytest.mark.parametrize(("scale", "dtype"), [(1, np.uint8), (257, np.uint16)])
def test_pixels_that_shine_in_all_pictures_are_found_and_nothing_else(scale, dtype):
    places = hot_pixels([standing_out(picture) for picture in pictures(scale, dtype)])
    assert {divmod(place, 160) for place in places.tolist()} == set(HOT)


@pytest.mark.parametrize("sigma", [0.5, 0.8])
def test_a_point_of_light_that_a_lens_blurs_is_none(sigma):
    assert len(hot_pixels([standing_out(picture) for picture in pictures(glint_sigma=sigma)])) == 0


def test_a_few_pictures_tell_nothing():
    assert len(hot_pixels([standing_out(picture) for picture in pictures()[:3]])) == 0


def test_a_picture_of_another_depth_is_refused():
    with pytest.raises(ValueError, match="uint8 or uint16"):
        standing_out(np.zeros((4, 4), np.float32))


def test_a_camera_with_hot_pixels_is_told_and_one_without_is_not(simulated, tmp_path):
    scene = replace(SMALL, camera_views=6, plane_poses=0, frames=0)
    simulate_set(replace(scene, sensor=replace(scene.sensor, hot_share=0.002)), tmp_path / "hot")
    for place, share, told in ((simulated, 0.0, 0), (tmp_path / "hot", 0.002, 1)):
        seen = see_views(PictureReader(open_set(place)))
        notes = [note for note in solve_camera(seen).notes if note.code == "camera.hot_pixels"]
        assert len(notes) == told
        size = seen.size[0] * seen.size[1]
        assert 0.7 * share * size <= seen.hot <= 1.1 * share * size
