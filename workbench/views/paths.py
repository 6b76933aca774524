"""Paths on the screen."""

from __future__ import annotations


def breakable(path: str) -> str:
    """A path that can be wrapped after each separator."""
    return path.replace("/", "/\u200b").replace("\\", "\\\u200b")
