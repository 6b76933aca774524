"""What is stated of a part, and what that means for its surface as light shows it.

Metal sends back the light that falls on it. Of plastic, wax or ceramic a part of the light comes from below the
surface, and the part is measured too thin by the mean depth of it; a layer of spray makes it opaque, and thicker by
itself. How far below its surface a material is seen is found on a master of it; no preset states a figure for that.

References
----------
ISO 3650:1998, 7.3 (steel of gauge blocks: (11.5 ± 1.0)·10⁻⁶/K). The other coefficients span the usual grades of the
material; u is half of that span over √3.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from core.findings.table import note_of
from core.inspect.causes import Cause
from core.inspect.results import Contribution
from core.messages import Field, Message

SUSPECTED_CELSIUS, SUSPECTED_CELSIUS_SD = 20.0, 3.0
"""Temperature of a part of which nothing is stated, and its standard uncertainty: a room that people work in."""
SUSPECTED_ALPHA, SUSPECTED_ALPHA_SD = 11.5e-6, 2.3e-6
"""Expansion coefficient in 1/K where nothing is stated, and its standard uncertainty."""
SUSPECTED_TARGET_ALPHA, SUSPECTED_TARGET_ALPHA_SD = 13.5e-6, 6e-6
"""Expansion coefficient in 1/K of a calibration target where nothing is stated, and its standard uncertainty: from
borosilicate glass (3.3·10⁻⁶/K) to sandwiches of aluminium (24·10⁻⁶/K, both by their makers)."""
SUSPECTED_LAYER_MM = 0.01
"""What a layer of spray adds where nothing is stated of it, taken as its standard uncertainty: sprays for scanning
leave 2 to 15 µm by their makers' data."""
UNKNOWN_LETS_LIGHT_IN = 0.5
"""Probability that light comes from below a surface of which nothing is stated."""


@dataclass(frozen=True, slots=True)
class Material:
    """Kind of material: whether all light comes from its surface, and its expansion in 1/K with its u."""

    opaque: bool
    alpha: float = SUSPECTED_ALPHA
    u_alpha: float = SUSPECTED_ALPHA_SD


MATERIALS: Mapping[str, Material] = {
    "metal": Material(True, 17e-6, 3.6e-6),
    "steel": Material(True, 11.5e-6, 0.6e-6),
    "aluminium": Material(True, 23e-6, 0.9e-6),
    "ceramic": Material(False, 8e-6, 1.7e-6),
    "plastic": Material(False, 90e-6, 29e-6),
    "wax": Material(False, 200e-6, 58e-6),
    "sprayed": Material(True),
}
"""By the names that rig.toml has. "sprayed" is any material under a layer that lets no light through."""


class Warmth(NamedTuple):
    """Temperature in °C, its standard uncertainty, and whether both are assumed."""

    celsius: float
    u_celsius: float
    assumed: bool

    @classmethod
    def of(cls, celsius: float | None, u_celsius: float | None) -> Warmth:
        """Make a temperature in °C with its standard uncertainty; an assumed one if either is None."""
        if celsius is None or u_celsius is None:
            return cls(SUSPECTED_CELSIUS, SUSPECTED_CELSIUS_SD, assumed=True)
        return cls(celsius, u_celsius, assumed=False)


@dataclass(frozen=True, slots=True)
class TargetTemperature:
    """Temperature of the plane target in its pictures in °C, and its expansion in 1/K; None: nothing is stated.

    It is the scale of all lengths: one that was warm is longer than its drawing says, and all else measured too short.
    """

    celsius: float | None = None
    u_celsius: float | None = None
    alpha: float | None = None
    u_alpha: float | None = None

    @property
    def warmth(self) -> Warmth:
        """Temperature of the plane target, stated or assumed, in °C, with its standard uncertainty."""
        return Warmth.of(self.celsius, self.u_celsius)

    @property
    def expansion(self) -> tuple[float, float]:
        """Expansion coefficient of the plane target and its standard uncertainty in 1/K, stated or assumed."""
        if self.alpha is None or self.u_alpha is None:
            return SUSPECTED_TARGET_ALPHA, SUSPECTED_TARGET_ALPHA_SD
        return self.alpha, self.u_alpha


TARGET_AT_20 = TargetTemperature(20.0, 0.0)
"""Of a target that is as warm as its drawing means, for sure."""


@dataclass(frozen=True, slots=True)
class Part:
    """Statements on a part; None: nothing is stated.

    Parameters
    ----------
    material
        A key of MATERIALS.
    offset_mm, offset_sd_mm
        How far below its surface the part is seen, measured against a master of its material.
    spray_mm, spray_sd_mm
        Thickness of a layer of spray on the upper face of a thickness, less that on the lower one.
    alpha, u_alpha
        Expansion coefficient in 1/K, in place of the material's.
    celsius, u_celsius
        Its temperature while it was scanned.
    Each with its standard uncertainty; one is stated only with the other.
    layers
        How many layers of spray, each as stated or assumed, add up in a thickness.
    target
        How warm the target was by which it is measured.
    """

    material: str | None = None
    offset_mm: float | None = None
    offset_sd_mm: float | None = None
    spray_mm: float | None = None
    spray_sd_mm: float | None = None
    alpha: float | None = None
    u_alpha: float | None = None
    celsius: float | None = None
    u_celsius: float | None = None
    target: TargetTemperature = TargetTemperature()
    layers: int = 1

    @property
    def lets_light_in(self) -> float:
        """Prior probability, by what is stated of the part, that light comes from below its surface.

        Of an offset that was measured it is none: that holds all of it.
        """
        if self.spray_mm is not None or self.offset_mm is not None:
            return 0.0
        return UNKNOWN_LETS_LIGHT_IN if self.material is None else 0.0 if MATERIALS[self.material].opaque else 1.0

    @property
    def warmth(self) -> Warmth:
        """Temperature of the part, stated or assumed, in °C, with its standard uncertainty."""
        return Warmth.of(self.celsius, self.u_celsius)

    @property
    def expansion(self) -> tuple[float, float]:
        """Expansion coefficient of the part and its standard uncertainty in 1/K: stated, the material's, or assumed."""
        if self.alpha is not None and self.u_alpha is not None:
            return self.alpha, self.u_alpha
        known = Material(True) if self.material is None else MATERIALS[self.material]
        return known.alpha, known.u_alpha

    @property
    def expansion_assumed(self) -> bool:
        """Whether the expansion coefficient of the part is assumed, as neither it nor a known material is stated."""
        return self.alpha is None and self.material in (None, "sprayed")

    @property
    def thicker_mm(self) -> float:
        """Correction in mm to a measured thickness: the stated offset less the layer of spray."""
        return (self.offset_mm or 0.0) - self.layers * (self.spray_mm or 0.0)

    @property
    def surface_rows(self) -> tuple[Contribution, ...]:
        """Budget rows of a thickness for the stated offset and the layer of spray; no zero rows."""
        layer, u_layer = self.layers * (self.spray_mm or 0.0), self.layers * (self.spray_sd_mm or 0.0)
        rows = [(Cause.PART_OFFSET, self.offset_sd_mm, self.offset_mm), (Cause.SPRAY, u_layer, layer)]
        if self.material == "sprayed" and self.spray_mm is None:
            rows.append((Cause.SPRAY_ASSUMED, self.layers * SUSPECTED_LAYER_MM, 0.0))
        return tuple(Contribution(source, u, u, value=value) for source, u, value in rows if u)

    @property
    def surface_notes(self) -> tuple[Message, ...]:
        """Notes on the correction by offset and spray that was added to a thickness; () without one."""
        if not self.thicker_mm:
            return ()
        return (
            note_of(
                "part.surface_corrected",
                change_um=self.thicker_mm * 1e3,
                offset_um=(self.offset_mm or 0.0) * 1e3,
                spray_um=self.layers * (self.spray_mm or 0.0) * 1e3,
            ),
        )

    @property
    def assumed(self) -> tuple[Message, ...]:
        """Notes on the material and temperature that are assumed because they are not stated."""
        notes = []
        if self.material is None:
            alpha, u_alpha = self.expansion
            notes.append(
                note_of(
                    "part.material_assumed",
                    field=Field("part.material", whole=True),
                    alpha=alpha * 1e6,
                    u_alpha=u_alpha * 1e6,
                )
            )
        if self.celsius is None:
            notes.append(
                note_of(
                    "part.temperature_assumed",
                    field=Field("part.celsius", whole=True),
                    celsius=SUSPECTED_CELSIUS,
                    u=SUSPECTED_CELSIUS_SD,
                )
            )
        return tuple(notes)
