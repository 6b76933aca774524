"""Advice on exposure while a camera runs: what the stripes show, turned into settings the camera has."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from statistics import median

from core.acquire.source import Capabilities, SourceSettings
from core.image.centreline import Centreline
from core.image.exposure import Exposure, stripe_exposure
from core.live.events import LiveAdvice

LOOKED_AT = 9
"""Advice rests on so many pictures: one that shines or one in shadow does not count."""


class ExposureAdviser:
    """Watches how the stripes of a live source are exposed."""

    def __init__(self) -> None:
        self._seen: deque[Exposure] = deque(maxlen=LOOKED_AT)
        self._told = LiveAdvice("", None)

    def forget(self) -> None:
        """The source was told other settings: what was seen before does not count."""
        self._seen.clear()

    def watch(
        self, stripes: Sequence[Centreline], full_scale: float, told: SourceSettings, can: Capabilities
    ) -> LiveAdvice | None:
        """What to advise after this picture too; None if that is no news.

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
    """One sentence and the settings it speaks of, exposure time before gain; neither where all is well."""
    if exposure.is_good:
        return LiveAdvice("", None)
    why = (
        f"{exposure.saturated:.0%} of the stripe are overexposed"
        if exposure.saturated and exposure.factor < 1
        else f"The stripe is {'bright' if exposure.factor < 1 else 'faint'}, at {exposure.level:.0%} of white"
    )
    settings = _settings(exposure.factor, told, can)
    if settings is None:
        more, less = "open the aperture or bring more light", "close the aperture or take less light"
        by_hand = f"{'expose longer, or ' + more if exposure.factor > 1 else 'expose shorter, or ' + less}"
        return LiveAdvice(f"{why}: {by_hand}.", None)
    parts = []
    if settings.exposure_ms is not None:
        parts.append(f"set the exposure time to {settings.exposure_ms:g} ms")
    if settings.gain_db is not None:
        parts.append(f"set the gain to {settings.gain_db:g} dB")
    return LiveAdvice(f"{why}: {' and '.join(parts)}.", settings)


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
