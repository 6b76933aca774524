"""What a scan's pictures say about the room's light."""

import numpy as np
import pytest

from core.image.stripes.stripe import StripeSettings
from core.scan.features.extraction import FeatureOptions, extract_features

WIDTH = 2.0


def picture(sweep_at=None, light=0.0, seed=0, background=20.0, dtype=np.uint8):
    """Three steep fan lines, and a sweep of slope 0.2 through row `sweep_at`."""
    v, u = np.mgrid[0:240, 0:360].astype(np.float32)
    image = background + light + np.random.default_rng(seed).normal(0, 1.5, u.shape)
    for start in (90, 180, 270):
        image += 120 * np.exp(-((u - start - 0.1 * (v - 120)) ** 2) / (2 * WIDTH**2))
    if sweep_at is not None:
        image += 100 * np.exp(-((v - sweep_at - 0.2 * (u - 180)) ** 2) / (2 * WIDTH**2))
    scale = np.iinfo(dtype).max / 255
    return np.rint(np.clip(image, 0, 255) * scale).astype(dtype)


def features(lights, background=20.0, dtype=np.uint8):
    frames = [
        (f"frame{n}.png", picture(70.0 + 15 * n, light, n + 1, background, dtype)) for n, light in enumerate(lights)
    ]
    return extract_features(picture(background=background, dtype=dtype), frames, len(frames))


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_frames_in_changed_light_are_counted_and_still_used(dtype):
    found = features([0, 0, 14, 10, 0], dtype=dtype)
    assert len(found.faults) == 1
    assert "The room's light changed in 2 of 5 frames, the first frame2.png" in str(found.faults[0])
    assert " % brighter than in the reference" in str(found.faults[0])
    assert all(frame.centrelines for frame in found.frames)
    assert [frame.light_change for frame in found.frames] == pytest.approx([0, 0, 0.7, 0.5, 0], abs=0.03)


def test_darker_is_told_from_brighter():
    found = features([0, -30, 0], background=60.0)
    assert "background is up to 50 % darker than in the reference" in str(found.faults[0])
    assert found.frames[1].light_change == pytest.approx(-0.5, abs=0.02)


def test_light_that_stays_is_no_matter_for_a_note():
    assert features([0, 1, -1, 0]).faults == ()


def test_little_light_more_in_a_dark_room_is_not_felt():
    assert features([0, 3, 3], background=2.0).faults == ()


def test_a_small_share_of_a_bright_background_is_not_felt():
    assert features([0, 9, -9], background=80.0).faults == ()


@pytest.mark.parametrize("told", [0.6, 1.0, 1.6])
def test_a_width_told_wrong_gives_way_to_the_measured_one(told):
    frames = [(f"frame{n}.png", picture(70.0 + 15 * n, seed=n + 1)) for n in range(3)]
    stripe = StripeSettings(told * 4 * WIDTH, 100.0)
    found = extract_features(picture(), frames, len(frames), FeatureOptions(sweep_stripe=stripe, fan_stripe=stripe))
    for used in (found.sweep_stripe, found.fan_stripe):
        assert used.width_px == pytest.approx(4 * WIDTH, rel=0.05)
        assert (used == stripe) == (told == 1.0)
