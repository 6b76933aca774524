"""Which channel of colour pictures shows the light of a laser best, where nobody has said it.

Grey mixes all channels: of a red laser's light a third is left, and the noise of the other two is added.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, get_args

import cv2
import numpy as np
from numpy.typing import NDArray

from core.acquire.grey import Channel, to_grey
from core.messages import Message
from core.model.robust import mad_sd

CLEARLY = 1.5
"""A channel is taken if it is so many times better than grey: less is no reason to leave what everybody expects."""
_LIT_SHARE = 0.002
"""Share of the pixels, the brightest ones of the difference, that are judged as the laser's light."""
_LEAST_NOISE = 0.5
"""Of a difference, in levels of the picture: rounding alone gives as much."""
_BACKGROUND_PX = 31
"""Width of the mean that stands for a picture without the light, where there is none: many times a stripe's."""

_NAMES = {
    "red": Message("set.channel_red", "red"),
    "green": Message("set.channel_green", "green"),
    "blue": Message("set.channel_blue", "blue"),
}


@dataclass(frozen=True, slots=True)
class LaserChannel:
    """The channel to look at, None for grey, and how many times as well as grey it shows the laser; 1: it is stated."""

    channel: Channel | None = None
    times: float = 1.0

    def notes(self, part: str) -> tuple[Message, ...]:
        """Which channel was chosen for the pictures of a part of a set; nothing where it was stated."""
        if self.channel is None or self.times <= 1:
            return ()
        return (
            Message(
                "set.channel_chosen",
                "The colour pictures in {part} are looked at in their {channel} channel, in which the laser's light "
                "stands out {times:.1f} times as far as in grey. A channel in rig.toml decides otherwise.",
                part=part,
                channel=_NAMES[self.channel],
                times=self.times,
            ),
        )


def laser_channel(pictures: Sequence[tuple[NDArray[Any], NDArray[Any] | None]]) -> LaserChannel:
    """The channel in which the light stands out farthest from the noise, if clearly farther than in grey.

    Parameters
    ----------
    pictures
        Colour pictures (height, width, 3 or 4) in OpenCV's order with the light, each with the same one without it, or
        None.
    """
    if not pictures:
        return LaserChannel()
    grey = _contrast(pictures, None)
    found = {channel: _contrast(pictures, channel) for channel in get_args(Channel)}
    best: Channel = max(found, key=lambda channel: found[channel])
    times = found[best] / grey if grey > 0 else 0.0
    return LaserChannel(best, times) if times >= CLEARLY else LaserChannel()


def _contrast(pictures: Sequence[tuple[NDArray[Any], NDArray[Any] | None]], channel: Channel | None) -> float:
    """Median over pictures of the light's height over the noise; saturated light counts for nothing."""
    heights = []
    for on, off in pictures:
        light = to_grey(on, channel)
        level = light.astype(np.float32)
        without = cv2.blur(level, (_BACKGROUND_PX, _BACKGROUND_PX)) if off is None else to_grey(off, channel)
        difference = level - without
        lit = difference >= np.quantile(difference, 1 - _LIT_SHARE)
        saturated = float((light[lit] == np.iinfo(light.dtype).max).mean())
        noise = mad_sd(np.asarray(difference - np.median(difference), dtype=np.float64))
        heights.append((1 - saturated) * float(np.median(difference[lit])) / max(noise, _LEAST_NOISE))
    return float(np.median(heights))
