"""Advice on exposure: what stripes show, and the settings that follow."""

import numpy as np
import pytest

from core.acquire.source import Capabilities, SourceSettings
from core.image.exposure import Exposure, stripe_exposure
from core.image.stripes.centreline import Centreline
from core.pipeline.live.events import LiveAdvice
from core.pipeline.live.exposure import LOOKED_AT, ExposureAdviser, advised

CAN = Capabilities(exposure_ms=(0.1, 60.0), gain_db=(0.0, 24.0))


def stripe(level, saturated=0.0, count=400):
    """A stripe `level` of white high, a share of it overexposed."""
    along = np.arange(count, dtype=float)
    return Centreline(
        np.column_stack([along, np.full(count, 20.0)]),
        np.tile([0.0, 1.0], (count, 1)),
        np.full(count, 2.0),
        np.full(count, 255 * level),
        np.full(count, 0.1),
        along < saturated * count,
    )


def test_a_well_exposed_stripe_stays_as_it_is():
    assert stripe_exposure([stripe(0.5)], 255).is_good
    assert advised(stripe_exposure([stripe(0.5)], 255), SourceSettings(exposure_ms=4), CAN) == LiveAdvice()


@pytest.mark.parametrize(("level", "factor"), [(0.05, 4.0), (0.95, 0.5 / 0.95)])
def test_a_stripe_too_faint_or_bright_is_put_right_in_one_step(level, factor):
    exposure = stripe_exposure([stripe(level)], 255)
    assert exposure.factor == pytest.approx(factor)


def test_a_saturated_stripe_is_stepped_down_until_it_is_not():
    exposure_ms, light = 32.0, 0.12  # of white for each ms
    for _ in range(8):
        level = light * exposure_ms
        exposure = stripe_exposure([stripe(min(level, 1.0), 0.9 if level > 1 else 0.0)], 255)
        advice = advised(exposure, SourceSettings(exposure_ms=exposure_ms), CAN)
        if advice.settings is None:
            break
        exposure_ms = advice.settings.exposure_ms
    assert advice.sentence is None
    assert 0.1 <= light * exposure_ms <= 0.75


def test_too_little_of_a_stripe_says_nothing():
    assert stripe_exposure([stripe(0.9, count=20)], 255) is None
    assert stripe_exposure([], 255) is None


def test_the_sentence_says_what_to_set():
    advice = advised(Exposure(0.9, 0.35, 0.5), SourceSettings(exposure_ms=8.0), CAN)
    assert str(advice.sentence) == "35% of the stripe are overexposed: set the exposure time to 4 ms."
    assert advice.settings == SourceSettings(exposure_ms=4.0)


def test_where_the_frame_rate_leaves_no_time_gain_makes_up_for_it():
    told = SourceSettings(exposure_ms=40.0, gain_db=3.0, rate_hz=20.0)
    advice = advised(Exposure(0.125, 0.0, 4.0), told, CAN)
    assert advice.settings == SourceSettings(exposure_ms=50.0, gain_db=13.1)
    assert "exposure time to 50 ms and set the gain to 13.1 dB" in str(advice.sentence)


def test_where_nothing_is_known_of_the_camera_a_person_is_told_what_to_do():
    advice = advised(Exposure(0.08, 0.0, 4.0), SourceSettings(), CAN)
    faint = "The stripe is faint, at 8% of white: expose longer, or open the aperture or bring more light."
    assert (str(advice.sentence), advice.settings) == (faint, None)


def test_advice_rests_on_several_pictures_and_is_told_once():
    adviser, told = ExposureAdviser(), SourceSettings(exposure_ms=8.0)

    def news(level, saturated=0.0):
        return adviser.watch([stripe(level, saturated)], 255, told, CAN)

    first = [news(0.9, 0.5) for _ in range(LOOKED_AT)]
    assert [advice is not None for advice in first] == [False] * (LOOKED_AT - 1) + [True]
    assert first[-1].settings == SourceSettings(exposure_ms=4.0)
    assert news(0.9, 0.5) is None
    adviser.forget()
    after = [news(0.5) for _ in range(LOOKED_AT)]
    assert after[-1] == LiveAdvice()
    assert after[:-1] == [None] * (LOOKED_AT - 1)


def test_one_shining_picture_makes_no_advice():
    adviser = ExposureAdviser()
    seen = [adviser.watch([stripe(0.5 if n % 4 else 0.9, 0.0 if n % 4 else 0.4)], 255, SourceSettings(), CAN)
            for n in range(20)]  # fmt: skip
    assert seen == [None] * 20
