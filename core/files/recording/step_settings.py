"""The settings of each step: what it is told, and what run.json says it was told. `Options` makes them."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from core.calibrate.camera.adjustment import CameraOptions
from core.image.stripes.stripe import StripeSettings
from core.scan.method import Method

SIGMA_CUT_MM = 0.05
"""Points with a larger standard uncertainty of depth are left out, if nothing else is said."""


@dataclass(frozen=True, slots=True)
class CameraSettings:
    """What the camera's calibration is told: which parameters are free, and the views left out by hand."""

    parameters: CameraOptions = field(default_factory=CameraOptions)
    excluded: frozenset[str] = frozenset()

    @property
    def told(self) -> Mapping[str, Any]:
        """The same for run.json."""
        one = self.parameters
        told = {"skew": one.skew, "k3": one.k3, "fixed": sorted(one.fixed), "outliers": one.outliers}
        return {**told, **excluded_told(self.excluded)}


@dataclass(frozen=True, slots=True)
class PlanesSettings:
    """What the calibration of the light planes is told.

    Parameters
    ----------
    stripe
        Width and contrast of the stripes on the plane target; None: chosen from the pictures.
    excluded
        Poses left out by hand, as "planes/pose02".
    constrain
        Hold the planes to one pencil where that suits the laser; else they are free.
    adjust_camera
        Let the poses correct the camera, in one adjustment with the planes.
    accept_few_poses
        Use the planes even though fewer than half of the poses agree with them.
    """

    stripe: StripeSettings | None = None
    excluded: frozenset[str] = frozenset()
    constrain: bool = True
    adjust_camera: bool = False
    accept_few_poses: bool = False


@dataclass(frozen=True, slots=True)
class ScanSettings:
    """What a scan, or a profile of the fan alone, is told.

    Parameters
    ----------
    method
        How sweeps are located.
    sigma_cut_mm
        Points with a larger standard uncertainty of depth are left out.
    stripe
        Width and contrast of the stripes; None: chosen from the pictures, for each laser.
    excluded
        Frames left out by hand, as "scan/frame0007.png".
    check_stripe
        As `stripe` on the plane target, in the pictures of the interim check.
    """

    method: Method = Method.NETWORK
    sigma_cut_mm: float = SIGMA_CUT_MM
    stripe: StripeSettings | None = None
    excluded: frozenset[str] = frozenset()
    check_stripe: StripeSettings | None = None

    @property
    def told(self) -> Mapping[str, Any]:
        """The same for run.json, but for what the check is told."""
        stripe = "automatic" if self.stripe is None else stripe_told(self.stripe)
        told = {"method": self.method, "sigma_cut_mm": self.sigma_cut_mm, "stripe": stripe}
        return {**told, **excluded_told(self.excluded)}


def stripe_told(stripe: StripeSettings) -> dict[str, float]:
    """For run.json the stripe that was stated."""
    return {"width_px": stripe.width_px, "contrast": stripe.contrast}


def excluded_told(names: Collection[str]) -> Mapping[str, Any]:
    """For run.json what is left out by hand; nothing if nothing is."""
    return {"excluded": tuple(sorted(names))} if names else {}
