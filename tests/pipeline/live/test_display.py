"""Live pictures made small for the window."""

from dataclasses import replace

import numpy as np
import pytest

from core.files.recording.rig import default_rig
from core.pipeline.live.display import Display


def raw(dtype, level: int) -> np.ndarray:
    """A red scene behind an RGGB mosaic: bright at the red sites alone, with a brighter stripe."""
    picture = np.full((48, 64), level // 10, dtype)
    picture[::2, ::2] = level
    picture[:, 30:36] *= 2
    return picture


@pytest.mark.parametrize(("dtype", "level"), [(np.uint8, 100), (np.uint16, 30_000)])
@pytest.mark.parametrize("width_px", [64, 32, 21])
@pytest.mark.parametrize("channel", [None, "red"])
def test_a_raw_mosaic_is_shown_without_its_checkerboard(dtype, level, width_px, channel):
    rig = default_rig()
    as_it_comes, scale = Display.of(rig, width_px).reduced(raw(dtype, level))
    seen = replace(rig, mosaic="RGGB", channel=channel)
    shown, same = Display.of(seen, width_px).reduced(raw(dtype, level))
    assert (shown.shape, same) == (as_it_comes.shape, scale)
    even = shown[2:-2, 2 : 20 // scale].astype(float)
    assert even.std() < 0.02 * even.mean()
    if scale == 1:
        rough = as_it_comes[2:-2, 2:20].astype(float)
        assert rough.std() > 0.5 * rough.mean(), "so it would be seen"
    stripe = shown[4:-4, 33 // scale].astype(float).mean()
    assert stripe > 1.5 * even.mean()
