"""Which channel of colour pictures shows the light of a laser best, where none is stated.

Grey mixes all channels: of a red laser's light a third is left, and the noise of the other two is added. A difference
of two channels is free of what is grey or white, like marks and room light that changes, but has the noise of both, and
in a JPEG it is of coarser pixels and steps.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from core.acquire.channel import CHANNELS, PLAIN_CHANNELS, Channel
from core.acquire.grey import saturated_in, to_grey
from core.files.compression import compression_of
from core.image.background import FEWEST, quantile_reference
from core.image.channel_names import CHANNEL_NAMES
from core.messages import Message

LOOKED_AT = 3
"""Pictures that decide on the channel of a part."""
CLEARLY = 1.5
"""A channel is taken if it is so many times better than grey, and a difference if it is so many times better than the
best of these: less is no reason to leave what everybody expects."""
_LIT_SHARE = 0.002
"""Share of the pixels, the brightest ones of the difference, that are judged as the laser's light."""
_LEAST_NOISE = 0.5
"""Of a difference, in levels of the picture: rounding alone gives as much."""
_REST_QUANTILE, _REST_SD = 0.8, 1.2816
"""Share of the brighter half of a difference that is nothing but the rest, edges and other light included, and how many
standard deviations noise alone is within at that share. The darker half holds the shadow of a mean with light in it."""
_BACKGROUND_PX = 31
"""Width of the mean that stands for a picture without the light, where there is none: many times a stripe's."""


@dataclass(frozen=True, eq=False, slots=True)
class LitPicture:
    """Colour picture (height, width, 3 or 4) in OpenCV's order with the light, and what is known of it.

    `off` is the same without the light, None if there is none; `data` the bytes of its file, for what they tell of
    compression.
    """

    on: NDArray[Any]
    off: NDArray[Any] | None = None
    data: bytes = b""


@dataclass(frozen=True, slots=True)
class LaserChannel:
    """Channel to look at, None for grey, and how many times as well as grey it shows the laser; 1: it is stated."""

    channel: Channel | None = None
    times: float = 1.0

    @property
    def settings(self) -> dict[str, str]:
        """Entry of run.json that names the channel; {} for grey."""
        return {} if self.channel is None else {"channel": self.channel}

    def notes(self, part: str) -> tuple[Message, ...]:
        """Note the colour channel chosen for the pictures of a part; () for grey, or where the channel was stated."""
        if self.channel is None or self.times <= 1:
            return ()
        return (
            Message(
                "set.channel_chosen",
                "The colour pictures in {part} are looked at in their {channel} channel, in which the laser's light "
                "stands out {times:.1f} times as far as in grey. A channel in rig.toml decides otherwise.",
                part=part,
                channel=CHANNEL_NAMES[self.channel],
                times=self.times,
            ),
        )

    def proposal(self, name: str) -> tuple[Message, ...]:
        """Tell the colour channel proposed for the frames of the film `name`; () for grey."""
        if self.channel is None:
            return ()
        return (
            Message(
                "import.channel_proposed",
                "The hand-held laser in {name} stands out best in the {channel} channel, {times:.1f} times as far as "
                "in grey: it is looked at in that one, unless channel in rig.toml states another.",
                name=name,
                channel=CHANNEL_NAMES[self.channel],
                times=self.times,
            ),
        )


def against_background(frames: Sequence[LitPicture]) -> list[LitPicture]:
    """Set frames of a sweep without a picture of the fan alone against what they themselves show behind the sweep.

    Of those given, spread over the scan, three are returned; all as they are if too few make a background.
    """
    if len(frames) < FEWEST or len({frame.on.shape for frame in frames}) > 1:
        return list(frames)
    background = quantile_reference([frame.on for frame in frames])
    return [replace(frame, off=background) for frame in frames[:: max(1, len(frames) // LOOKED_AT)][:LOOKED_AT]]


def laser_channel(pictures: Sequence[LitPicture], *, raw: bool = False) -> LaserChannel:
    """Choose the colour channel in which laser light stands out best; grey unless one is clearly better than that.

    For `raw` pictures a plain channel is chosen in any case: all others are made of pixels that nobody measured.
    """
    if not pictures:
        return LaserChannel()
    grey = _separation(pictures, None)
    among = PLAIN_CHANNELS if raw else CHANNELS
    found = {channel: _separation(pictures, channel) for channel in among}
    plain: Channel = max(PLAIN_CHANNELS, key=lambda channel: found[channel])
    best: Channel = max(among, key=lambda channel: found[channel])
    if found[best] < CLEARLY * max(grey, found[plain]):
        best = plain
    times = found[best] / grey if grey > 0 else 0.0
    return LaserChannel(best, times) if raw or times >= CLEARLY else LaserChannel()


def _separation(pictures: Sequence[LitPicture], channel: Channel | None) -> float:
    """Median over pictures of the light's height over what the rest scatters; saturated light counts for nothing."""
    heights = []
    for picture in pictures:
        level = to_grey(picture.on, channel).astype(np.float32)
        if picture.off is None:
            without = cv2.blur(level, (_BACKGROUND_PX, _BACKGROUND_PX))
        else:
            without = to_grey(picture.off, channel).astype(np.float32)
        difference = level - without
        lit = difference >= np.quantile(difference, 1 - _LIT_SHARE)
        saturated = float(saturated_in(picture.on, channel)[lit].mean())
        median = float(np.median(difference))
        brighter = difference[difference >= median] - median
        scatter = float(np.quantile(brighter, _REST_QUANTILE)) / _REST_SD
        noise = np.hypot(max(scatter, _LEAST_NOISE), compression_of(picture.data, channel).grey)
        heights.append((1 - saturated) * float(np.median(difference[lit])) / noise)
    return float(np.median(heights))
