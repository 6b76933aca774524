"""The two ways of locating sweeps."""

from __future__ import annotations

from typing import Literal

Method = Literal["network", "three-crossings"]
"""All sweeps adjusted together, or each frame from its own crossings with the fan, as the paper does."""

METHODS: tuple[Method, ...] = ("network", "three-crossings")
