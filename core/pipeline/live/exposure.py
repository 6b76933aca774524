"""Advice on exposure while a camera runs: what the stripes show, turned into settings the camera has."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from statistics import median

from core.acquire.source import Capabilities, SourceSettings
from core.image.exposure import Exposure, stripe_exposure
from core.image.stripes.centreline import Centreline
from core.messages import Message
from core.pipeline.live.events import LiveAdvice

LOOKED_AT = 9
"""Advice rests on so many pictures: one that shines or one in shadow does not count."""


class ExposureAdviser:
    """Adviser on the exposure of a live source, by the stripes in its latest pictures."""

    def __init__(self) -> None:
        self._seen: deque[Exposure] = deque(maxlen=LOOKED_AT)
        self._told = LiveAdvice()

    def forget(self) -> None:
        """Forget the exposures of the pictures so far, as the settings of the source have changed."""
        self._seen.clear()

    def watch(
        self, stripes: Sequence[Centreline], full_scale: float, told: SourceSettings, can: Capabilities
    ) -> LiveAdvice | None:
        """Return the advice on exposure after one more picture; None if it is still that given last.

        Parameters
        ----------
        stripes
            Of a picture.
        full_scale
            Largest grey level it can hold.
        told, can
            What the source has been told, and what it can be told.
        """
        exposure = stripe_exposure(stripes, full_scale)
        if exposure is None:
            return None
        self._seen.append(exposure)
        if len(self._seen) < LOOKED_AT:
            return None
        advice = advised(_typical(self._seen), told, can)
        news, self._told = advice != self._told, advice
        return advice if news else None


def advised(exposure: Exposure, told: SourceSettings, can: Capabilities) -> LiveAdvice:
    """Make advice on an `exposure`: one sentence and new settings, exposure time before gain; empty if it is good."""
    if exposure.is_good:
        return LiveAdvice()
    why = _why(exposure)
    settings = _settings(exposure.factor, told, can)
    if settings is None:
        by_hand = (
            Message("live.expose_longer", "expose longer, or open the aperture or bring more light")
            if exposure.factor > 1
            else Message("live.expose_shorter", "expose shorter, or close the aperture or take less light")
        )
        return LiveAdvice(_advice(why, by_hand))
    parts = []
    if settings.exposure_ms is not None:
        time = Message("live.set_exposure", "set the exposure time to {time_ms:g} ms", time_ms=settings.exposure_ms)
        parts.append(time)
    if settings.gain_db is not None:
        parts.append(Message("live.set_gain", "set the gain to {gain_db:g} dB", gain_db=settings.gain_db))
    return LiveAdvice(_advice(why, *parts), settings)


def _why(exposure: Exposure) -> Message:
    if exposure.saturated and exposure.factor < 1:
        return Message("live.overexposed", "{share:.0%} of the stripe are overexposed", share=exposure.saturated)
    if exposure.factor < 1:
        return Message("live.stripe_bright", "The stripe is bright, at {share:.0%} of white", share=exposure.level)
    return Message("live.stripe_faint", "The stripe is faint, at {share:.0%} of white", share=exposure.level)


def _advice(why: Message, *todo: Message) -> Message:
    return Message("live.exposure_advice", "{why}: {todo:and}.", why=why, todo=todo)


def _typical(seen: Sequence[Exposure]) -> Exposure:
    """The medians of what was seen; the factor is one that was really wanted, or 1."""
    factors = sorted(one.factor for one in seen)
    return Exposure(
        median(one.level for one in seen), median(one.saturated for one in seen), factors[len(factors) // 2]
    )


def _settings(factor: float, told: SourceSettings, can: Capabilities) -> SourceSettings | None:
    """Settings that change the light by `factor`; None where what is set now is not known, or nothing can be set."""
    if told.exposure_ms is None or can.exposure_ms is None:
        return None
    low, high = can.exposure_ms
    if told.rate_hz:
        high = min(high, 1000.0 / told.rate_hz)
    wanted = told.exposure_ms * factor
    exposure_ms = float(f"{min(max(wanted, low), max(high, low)):.3g}")
    left = wanted / exposure_ms
    gain_db = None
    if abs(left - 1) > 0.1 and told.gain_db is not None and can.gain_db is not None:
        gain_db = round(min(max(told.gain_db + 20 * math.log10(left), can.gain_db[0]), can.gain_db[1]), 1)
    if exposure_ms == told.exposure_ms and gain_db in (None, told.gain_db):
        return None
    return SourceSettings(exposure_ms=None if exposure_ms == told.exposure_ms else exposure_ms, gain_db=gain_db)
