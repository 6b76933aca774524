"""Steger's line point, whatever the width of the filter, and in pictures narrower than what is read at once."""

import numpy as np
import pytest

from core.compiled import compiled
from core.image.stripes.tracing.linking import Hysteresis, link
from core.image.stripes.tracing.ridge import (
    COLUMNS_AT_ONCE,
    Detector,
    kernel_radius,
    kernel_table,
    ridge_at,
    ridge_response,
)


@compiled()
def _ridge_at(picture, width, u, v, detector):
    return ridge_at(picture, width, u, v, detector)


@pytest.mark.parametrize("filter_px", [1.2, 3.4, 4.2, 9.0])  # 11 to 73 pixels wide: less than COLUMNS_AT_ONCE, and more
@pytest.mark.parametrize("kind", [np.int16, np.float32])
def test_a_point_is_where_the_crest_is_and_as_strong_as_the_law_says(filter_px, kind):
    size, place, angle, stripe_px = 120, 60.3, 0.3, 0.75 * filter_px
    v, u = np.mgrid[:size, :size]
    nu, nv = np.cos(angle), np.sin(angle)
    away = (u - place) * nu + (v - 60.0) * nv
    picture = (1000 * np.exp(-0.5 * (away / stripe_px) ** 2)).astype(kind)
    detector = Detector(kernel_radius(filter_px), kernel_table(filter_px), np.empty(3 * COLUMNS_AT_ONCE, np.float32))
    across, found_u, found_v, offset = _ridge_at(picture.reshape(-1), size, place, 60.0, detector)
    assert -across == pytest.approx(ridge_response(1000.0, stripe_px, filter_px), rel=0.01)
    assert abs(found_u * nu + found_v * nv) == pytest.approx(1.0, abs=1e-4)
    assert abs(offset) < 0.01


def test_a_picture_narrower_than_a_detector_reads_at_once_shows_its_line():
    u = np.arange(20)
    picture = np.tile((200 * np.exp(-0.5 * ((u - 9.4) / 1.0) ** 2)).astype(np.int16), (60, 1))
    (run,) = link(picture, np.zeros(picture.shape, np.uint8), 1.0, 1.4, Hysteresis(60.0, 20.0, 4.0, 0.0, 0.5))
    assert len(run) > 35
    assert np.abs(run[:, 0] - 9.4).max() < 0.01
