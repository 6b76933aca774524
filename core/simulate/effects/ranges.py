"""Limits of the numbers of a scenario."""

from __future__ import annotations

from collections.abc import Iterable

from core.errors import InputError
from core.messages import Message


def require_ranges(described: object, ranges: Iterable[tuple[str, float, float]]) -> None:
    """Raise InputError if a field of `described` is outside its range, given as (name, lowest, highest)."""
    for name, low, high in ranges:
        if not low <= getattr(described, name) <= high:
            raise InputError(
                Message(
                    "simulate.out_of_range",
                    "{value} is not between {low} and {high}",
                    value=getattr(described, name),
                    low=low,
                    high=high,
                ),
                where=name,
            )
