"""A scan is read frame by frame: how many pictures are in memory does not depend on how many there are."""

import os
import threading
import weakref

import numpy as np
import pytest

from core.image.stripes.stripe import StripeSettings
from core.scan.features.extraction import LOOK_AHEAD, FeatureOptions, extract_features

WIDTH, HEIGHT = 240, 160
STRIPE = StripeSettings(6.0, 100.0)


def picture(*places):
    u = np.arange(WIDTH)
    row = 20 + sum(150 * np.exp(-0.5 * ((u - place) / 1.5) ** 2) for place in places)
    noise = np.random.default_rng(round(sum(places))).normal(0, 1, (HEIGHT, WIDTH))
    return np.clip(np.round(row + noise), 0, 255).astype(np.uint8)


def most_alive(count):
    """Most pictures alive at once while `count` frames are read."""
    lock, alive, most = threading.Lock(), [0], [0]

    def gone():
        with lock:
            alive[0] -= 1

    def frames():
        for k in range(count):
            shot = picture(60, 100 + k % 80)
            with lock:
                alive[0] += 1
                most[0] = max(most[0], alive[0])
            weakref.finalize(shot, gone)
            yield f"frame{k}", shot
            del shot

    found = extract_features(picture(60), frames(), count, FeatureOptions(sweep_stripe=STRIPE, fan_stripe=STRIPE))
    assert sum(bool(frame.centrelines) for frame in found.frames) > 0.8 * count
    return most[0]


@pytest.mark.parametrize("count", [40, 80])
def test_pictures_in_memory_do_not_grow_with_the_scan(count):
    waiting = 2 * min(4, os.cpu_count() or 1)
    assert most_alive(count) <= LOOK_AHEAD + waiting + 6
