"""Channels of colour pictures in which a laser is looked at. Light to import: the command line needs them."""

from __future__ import annotations

from typing import Final, Literal, get_args

PlainChannel = Literal["red", "green", "blue"]
"""One of a colour picture's channels."""
Channel = Literal[PlainChannel, "red-green", "green-red", "blue-red"]
"""The same, or a laser's colour as a difference of two: what is grey or white is dark in it, in any light."""
PLAIN_CHANNELS: Final = get_args(PlainChannel)
CHANNELS: Final = get_args(Channel)


def is_difference(channel: str | None) -> bool:
    """Whether a channel is a difference of two colours, in which targets cannot be seen; not for None."""
    return channel is not None and channel not in PLAIN_CHANNELS
