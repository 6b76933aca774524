"""How stable the rig is, as the scan page's settings show it: in the units of rig.toml."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from core.calibrate.change import DEFAULT_STABILITY, Stability
from core.calibrate.drift import USUAL_KELVINS, Drift
from core.files.recording.rig import Rig
from core.messages import label

_PER_UNIT: Mapping[str, float] = {"turn": 1e6, "shift_mm": 1e3, "centre_px": 1.0, "focal_share": 1e6}
"""Of each field of a Stability: its unit here over the field's own."""


class StabilityField(NamedTuple):
    """Field of the page for one number."""

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


def usual_per_kelvin(one: StabilityField) -> float:
    """Return the assumed change per kelvin, in the field's unit, of a rig for which none is stated."""
    return one.usual / USUAL_KELVINS


def drift_key(rate: str, key: str) -> str:
    """Return the form's key of the number `key` of a drift "per_kelvin" or "per_hour"."""
    return f"{rate}.{key}"


def shown(stability: Stability | None) -> dict[str, float | None]:
    """Return the stated stability of a rig by key, in the form's units; None where nothing is stated."""
    if stability is None:
        return dict.fromkeys(_PER_UNIT)
    return {key: round(getattr(stability, key) * factor, 6) for key, factor in _PER_UNIT.items()}


def stated(stability: Stability | None, key: str, value: Any) -> Stability | None:
    """Return the stability with one value changed; None, nothing stated, if the value is None."""
    if value is None:
        return None
    return replace(stability or DEFAULT_STABILITY, **{key: value / _PER_UNIT[key]})


def drift_shown(drift: Drift) -> dict[str, float | None]:
    """Return the stated drift per kelvin and per hour by key, in the form's units; None where none is stated."""
    return {
        drift_key(rate, key): round(getattr(getattr(drift, rate), key) * factor, 6) or None
        for rate in ("per_kelvin", "per_hour")
        for key, factor in _PER_UNIT.items()
    }


def drift_stated(drift: Drift, key: str, value: Any) -> Drift:
    """Return the drift with one value changed; None removes that value."""
    rate, name = key.split(".")
    return replace(drift, **{rate: replace(getattr(drift, rate), **{name: (value or 0.0) / _PER_UNIT[name]})})


def rig_shown(rig: Rig) -> dict[str, float | None]:
    """Return all fields of the form on a rig's stability and drift; None where nothing is stated."""
    return {**shown(rig.stability), **drift_shown(rig.drift), "calibrated_celsius": rig.air.calibrated}


def rig_stated(rig: Rig, key: str, value: Any) -> Rig:
    """Return the rig with one field of its stability or drift changed."""
    if key == "calibrated_celsius":
        return replace(rig, air=replace(rig.air, calibrated=value))
    if "." in key:
        return replace(rig, drift=drift_stated(rig.drift, key, value))
    return replace(rig, stability=stated(rig.stability, key, value))
