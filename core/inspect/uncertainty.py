"""The uncertainty budget of a measured quantity q (a thickness, a radius), by the GUM.

q follows the misfit of each stretch of a stripe with a gain G_j = ∂q/∂misfit_j. What makes the misfits wrong is in
`core.inspect.generalised.Sources`, cause by cause, with all that is common kept common; so each cause contributes::

    point noise, fan speckle   u² = Σ_j G_j² own_j²            over the stretches of the sweeps, of the fan
    sweep planes               u² = ‖Σ_j G_j sweeps_j‖²         the network's full covariance
    camera, fan calibration    u² = Σ_k (Σ_j G_j common_jk)²    over the displacements of that calibration
    form                       u² = form² ‖Σ_j G_j form_j‖²     what the residuals show beyond all that

and the causes are independent of each other.

References
----------
JCGM 100:2008, Guide to the expression of uncertainty in measurement, 5.2 (correlated input quantities).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from core.inspect.generalised import Sources
from core.inspect.results import Contribution
from core.model.arrays import Array
from core.scan.common_errors import CAMERA, FAN_CALIBRATION, SCALE

__all__ = ["CAMERA", "FAN_CALIBRATION", "FAN_SPECKLE", "FORM", "POINT_NOISE", "SCALE", "SWEEP_PLANES"]

POINT_NOISE = "centreline noise of the sweeps' points"
SWEEP_PLANES = "light planes of the sweeps (network)"
FAN_SPECKLE = "centreline noise of the fan's points (speckle)"
FORM = "form of the faces beyond the stated noise"


def combined(contributions: Iterable[Contribution]) -> float:
    """Combined standard uncertainty in mm of independent contributions."""
    return float(np.sqrt(sum(row.u_mm**2 for row in contributions)))


def budget(
    gains: Array, sources: Sources, *, own: Array | None = None, form_mm: float = 0.0, calibrations: Sequence[str] = ()
) -> tuple[Contribution, ...]:
    """What each cause contributes to q.

    Parameters
    ----------
    gains
        (J,) ∂q/∂misfit of each stretch.
    sources
        Of the same stretches.
    own
        (J,) standard deviations in mm of the stretches' own noise; None: as stated.
    form_mm
        Standard deviation of a patch of the surface beyond all that is named.
    calibrations
        (K,) which calibration each of the common errors comes from.
    """
    own = sources.own if own is None else own
    rows = [_row(POINT_NOISE, gains[~sources.of_fan], np.diag(own[~sources.of_fan]))]
    if sources.sweeps.shape[1]:
        rows.append(_row(SWEEP_PLANES, gains[~sources.of_fan], sources.sweeps[~sources.of_fan]))
    rows.append(_row(FAN_SPECKLE, gains[sources.of_fan], np.diag(own[sources.of_fan])))
    rows.append(_row(FORM, gains, form_mm * sources.form))
    for source in dict.fromkeys(calibrations):
        mine = np.array([one == source for one in calibrations])
        rows.append(_row(source, gains, sources.common[:, mine]))
    return tuple(row for row in rows if row is not None)


def _row(source: str, gains: Array, effects: Array) -> Contribution | None:
    """One row, or None where nothing measured is touched by it; `effects` (J, n) for n independent unit causes."""
    if not len(gains):
        return None
    typical = float(np.median(np.sqrt((effects**2).sum(axis=1))))
    return Contribution(source, float(np.linalg.norm(gains @ effects)), typical)
