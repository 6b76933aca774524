"""What is known of the conditions a part was measured under: temperatures, and a master measured like it."""

from __future__ import annotations

from dataclasses import dataclass

from core.findings.proof import SIZE_UNCONFIRMED, Doubts
from core.inspect.causes import Source

REFERENCE_C = 20.0
"""The temperature that lengths on drawings are meant at (ISO 1)."""


@dataclass(frozen=True, slots=True)
class Temperature:
    """Temperature and expansion of a part, in °C and 1/K, each with its standard uncertainty; the scale's likewise."""

    part_celsius: float
    u_part_celsius: float
    alpha: float
    u_alpha: float
    scale_celsius: float = REFERENCE_C
    u_scale_celsius: float = 0.0
    scale_alpha: float = 0.0
    u_scale_alpha: float = 0.0
    celsius_assumed: bool = False
    """Whether the part's temperature is not stated."""
    alpha_assumed: bool = False
    """Whether its expansion is not stated."""
    scale_celsius_assumed: bool = False
    """The same of the scale,"""
    scale_alpha_assumed: bool = False
    """and of its expansion."""


@dataclass(frozen=True, slots=True)
class Master:
    """Known length that was measured like the part.

    Parameters
    ----------
    name
        What it is called.
    certified_mm, u_certified_mm
        Its length at 20 °C and standard uncertainty by its certificate.
    measured_mm
        The same length as measured, at 20 °C if the part's are.
    budget
        What the measured length's uncertainty is made of; causes that camera and fan have in common with the part's
        measurement cancel.
    features
        Names of the features that are compared with it.
    same_calibration
        Whether both were measured with one calibration of camera and fan.
    doubts
        By what facts its measurement proves nothing; () where it was stated by hand.
    """

    name: str
    certified_mm: float
    u_certified_mm: float
    measured_mm: float
    budget: tuple[tuple[Source, float], ...]
    features: tuple[str, ...] = ()
    same_calibration: bool = True
    doubts: Doubts = ()

    @property
    def remaining_doubts(self) -> Doubts:
        """Doubts on the master's measurement (reasons why it proves nothing) that a comparison does not cancel."""
        cancelling = SIZE_UNCONFIRMED.fact if self.same_calibration else ""
        return tuple(doubt for doubt in self.doubts if doubt.fact != cancelling)
