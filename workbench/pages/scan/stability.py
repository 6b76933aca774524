"""How stable the rig is, as the scan page's settings show it: in the units of rig.toml."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from core.calibrate.change import DEFAULT_STABILITY, Stability
from core.messages import label

_PER_UNIT: Mapping[str, float] = {"turn": 1e6, "shift_mm": 1e3, "centre_px": 1.0, "focal_share": 1e6}
"""Of each field of a Stability: its unit here over the field's own."""


class StabilityField(NamedTuple):
    """One number that the page asks for."""

    key: str
    name: str
    """A fixed word, not yet in the window's language."""
    unit: str
    decimals: int
    usual: float
    """What is assumed where nothing is stated."""


STABILITY: tuple[StabilityField, ...] = tuple(
    StabilityField(key, name, unit, decimals, round(getattr(DEFAULT_STABILITY, key) * _PER_UNIT[key], 6))
    for key, name, unit, decimals in (
        ("turn", label("Laser turned"), "µrad", 0),
        ("shift_mm", label("Laser shifted"), "µm", 1),
        ("centre_px", label("Picture drifted"), "px", 2),
        ("focal_share", label("Focal length"), "× 10⁻⁶", 0),
    )
)
"""In the order they are shown."""


def shown(stability: Stability | None) -> dict[str, float | None]:
    """The values by key; None where nothing is stated."""
    if stability is None:
        return dict.fromkeys(_PER_UNIT)
    return {key: round(getattr(stability, key) * factor, 6) for key, factor in _PER_UNIT.items()}


def stated(stability: Stability | None, key: str, value: Any) -> Stability | None:
    """The stability with one value changed; without a value nothing is stated any more, and all is assumed."""
    if value is None:
        return None
    return replace(stability or DEFAULT_STABILITY, **{key: value / _PER_UNIT[key]})
