"""The channels of colour pictures in words."""

from __future__ import annotations

from collections.abc import Mapping

from core.messages import Message

CHANNEL_NAMES: Mapping[str, Message] = {
    "red": Message("set.channel_red", "red"),
    "green": Message("set.channel_green", "green"),
    "blue": Message("set.channel_blue", "blue"),
    "red-green": Message("set.channel_red_green", "red − green"),
    "green-red": Message("set.channel_green_red", "green − red"),
    "blue-red": Message("set.channel_blue_red", "blue − red"),
}
"""By what rig.toml calls them."""
