"""How much further a rig may have changed, the warmer and the later it is than when it was calibrated.

What changes a rig that stays as warm as it was (a knock, a lamp changed) is its stability; warmth and time add to that,
independently and in proportion::

    s² = s₀² + (s_K · ΔT)² + (s_h · Δt)²

for turn, shift, drift of the picture and focal length each. A rig of which nothing is stated has a default that holds
for `USUAL_KELVINS` (`core.calibrate.change`); where it is stated to be warmer than that, that grows in proportion.

Between a check of the day and the scan the same goes on, d ~ N(0, D): the check's pictures speak of x − d. With the
normal equations N x = g of the check, of covariance Σ, and d marginalised::

    G = I − N (D⁻¹ + N)⁻¹,   N' = G N,   g' = G g,   Σ' = G (Σ + N D N) Gᵀ

References
----------
Koch, K.-R., Parameter Estimation and Hypothesis Testing in Linear Models (1999), 3.2 (prior information).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.calibrate.change import DEFAULT_STABILITY, STABLE, Evidence, Stability
from core.calibrate.deviations import Deviation

USUAL_KELVINS = 5.0
"""Between calibration and measurement where no temperature is stated; the default stability holds for as much."""
KELVINS_WITHIN_DAY = 2.0
"""Between a check and a scan of the same day where no temperature is stated."""
USUAL_HOURS = 24.0
"""Between calibration and measurement where no picture of the calibration is there to tell."""


@dataclass(frozen=True, slots=True)
class Drift:
    """Standard uncertainties of the change of a rig per kelvin and per hour; 0 where nothing is stated."""

    per_kelvin: Stability = STABLE
    per_hour: Stability = STABLE

    def over(self, apart: Apart) -> Stability:
        """Compute how far a rig may drift over a difference of temperature and time (standard uncertainties)."""
        kelvins, hours = [apart.kelvins] * 4, [apart.hours] * 4
        return together(self.per_kelvin.times(*kelvins), self.per_hour.times(*hours))


NO_DRIFT = Drift()
"""Nothing is stated of warmth and time."""


@dataclass(frozen=True, slots=True)
class Air:
    """Temperature in °C of the air around the rig when it was calibrated, checked and used; None: not stated."""

    calibrated: float | None = None
    checked: float | None = None
    scanned: float | None = None


@dataclass(frozen=True, slots=True)
class Apart:
    """Kelvins and hours between two times, not below 0; those assumed are not known from temperatures and pictures."""

    kelvins: float
    hours: float
    kelvins_assumed: bool = False
    hours_assumed: bool = False


def apart(one: float | None, other: float | None, hours: float | None, usual_kelvins: float) -> Apart:
    """Compute how far two states of a rig lie apart in kelvins and `hours`, with usual values for what is None."""
    unknown = one is None or other is None
    return Apart(
        usual_kelvins if one is None or other is None else abs(one - other),
        USUAL_HOURS if hours is None else abs(hours),
        unknown,
        hours is None,
    )


def together(*parts: Stability) -> Stability:
    """Add independent standard uncertainties of a rig's change in quadrature."""
    return Stability(
        math.hypot(*(one.turn for one in parts)),
        math.hypot(*(one.shift_mm for one in parts)),
        math.hypot(*(one.centre_px for one in parts)),
        math.hypot(*(one.focal_share for one in parts)),
    )


def stability_after(stated: Stability | None, drift: Drift, since: Apart) -> Stability | None:
    """Compute how far a rig may have changed `since` its calibration; None where the default applies."""
    if drift != NO_DRIFT:
        return together(DEFAULT_STABILITY if stated is None else stated, drift.over(since))
    if stated is not None or since.kelvins_assumed or since.kelvins <= USUAL_KELVINS:
        return stated
    return DEFAULT_STABILITY.times(*[since.kelvins / USUAL_KELVINS] * 4)


def widened_evidence(evidence: Evidence, deviations: Sequence[Deviation], since: Stability) -> Evidence:
    """Weaken the normal equations `evidence` by how much the rig may have changed since its pictures were taken."""
    if since == STABLE:
        return evidence
    variance = np.zeros(len(deviations))
    variance[[one.source == "change" for one in deviations]] = since.over_default**2
    known = evidence.information
    spread = variance[:, None] * np.eye(len(variance))
    gain = np.eye(len(variance)) - known @ spread @ np.linalg.inv(np.eye(len(variance)) + known @ spread)
    scatter = gain @ (evidence.scatter + known @ spread @ known) @ gain.T
    return Evidence(gain @ known, scatter, gain @ evidence.gradient)
