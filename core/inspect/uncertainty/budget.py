"""The uncertainty budget of a measured quantity q (a thickness, a radius), by the GUM.

q follows the misfit of each stretch of a stripe with a gain G_j = ∂q/∂misfit_j. What makes the misfits wrong is in
`core.inspect.uncertainty.error_sources.Sources`, cause by cause, with all that is common kept common; so each cause
contributes::

    point noise                u² = Σ_j G_j² own_j²            over the stretches of the sweeps
    fan speckle                u² = ‖Σ_j G_j speckle_j‖²        by the fan's own points and through the network,
                                  + Σ_j G_j² own_j²            over the stretches of the fan
    sweep planes               u² = ‖Σ_j G_j sweeps_j‖²         the network's covariance but for the fan's speckle
    camera, fan calibration    u² = Σ_k (Σ_j G_j common_jk)²    over the displacements of that calibration
    skewed light               u  = ½ |Σ_j G_j behind_j|        where sections are surely skewed: U holds all of it
    light from below           u² = ‖Σ_j G_j below_j‖²          where they are not, face by face
    form                       u² = form² ‖Σ_j G_j form_j‖²     what the residuals show beyond all that

and the causes are independent of each other. Where it is not known what the network owes to the fan's speckle, it
stays in the sweep planes.

References
----------
JCGM 100:2008, Guide to the expression of uncertainty in measurement, 5.2 (correlated input quantities).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from core.inspect.causes import Cause, Source
from core.inspect.results import Contribution
from core.inspect.uncertainty.error_sources import Sources
from core.model.arrays import Array

UNKNOWNS = 4
"""Of a fit: two parallel planes, or a sphere. The form's size is found from as many patches less."""


def combined(contributions: Iterable[Contribution]) -> float:
    """Compute the combined standard uncertainty of independent contributions: the root of the sum of squares."""
    return float(np.sqrt(sum(row.u_mm**2 for row in contributions)))


@dataclass(frozen=True, eq=False, slots=True)
class Effect:
    """Effect of one cause on p quantities measured in one scan: their errors are factor·ζ, ζ of unit variance.

    Parameters
    ----------
    source
        The cause.
    factor
        (p, n).
    shared
        Whether the same ζ acts on everything measured in the scan (light planes, calibrations); else it is the
        quantities' own (noise of their points, form of their surface).
    point_mm
        Standard uncertainty in mm that the cause gives to a typical point, across the surface.
    dof
        Degrees of freedom of all this.
    """

    source: Source
    factor: Array
    shared: bool
    point_mm: float
    dof: float = math.inf


def budget(
    gains: Array,
    sources: Sources,
    *,
    own: Array | None = None,
    form_mm: float = 0.0,
    calibrations: Sequence[Source] = (),
) -> tuple[Contribution, ...]:
    """Compute the uncertainty budget of a quantity q with derivatives `gains` (J,) by the residuals of J stripe pieces.

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
    of_q = effects(gains[None, :], sources, own=own, form_mm=form_mm, calibrations=calibrations)
    return budget_of([(np.ones(1), of_q)])


def effects(
    gains: Array,
    sources: Sources,
    *,
    own: Array | None = None,
    form_mm: float = 0.0,
    calibrations: Sequence[Source] = (),
) -> tuple[Effect, ...]:
    """Compute the effect of each cause of error on p quantities with derivatives `gains` (p, J) by J stripe pieces."""
    own = sources.own if own is None else own
    swept, of_fan = ~sources.of_fan, sources.of_fan
    found = []
    if swept.any():
        found.append(_noise(Cause.POINT_NOISE, gains[:, swept], own[swept]))
        if sources.sweeps.shape[1]:
            found.append(_effect(Cause.SWEEP_PLANES, gains[:, swept], sources.sweeps[swept], shared=True))
    if sources.speckle.shape[1]:
        found.append(_effect(Cause.FAN_SPECKLE, gains, sources.speckle, shared=True))
    if of_fan.any():
        found.append(_noise(Cause.FAN_SPECKLE, gains[:, of_fan], own[of_fan]))
    patches = max(sources.form.shape[1] - UNKNOWNS, 1)  # what the form's size was found from
    found.append(replace(_effect(Cause.FORM, gains, form_mm * sources.form, shared=False), dof=float(patches)))
    for source in dict.fromkeys(calibrations):
        mine = np.array([one == source for one in calibrations])
        found.append(_effect(source, gains, sources.common[:, mine], shared=True))
    if sources.behind.any():
        found.append(_effect(Cause.SKEWED_LIGHT, gains, sources.behind / 2, shared=True))
    if sources.below.any():
        found.append(_effect(sources.cause_below, gains, sources.below, shared=sources.below_in_all))
    return tuple(found)


def budget_of(parts: Sequence[tuple[Array, Sequence[Effect]]]) -> tuple[Contribution, ...]:
    """Compute the uncertainty budget of a quantity that depends on several groups of quantities of one scan.

    Parameters
    ----------
    parts
        Of each group the gradient (p,) by which the quantity follows it, and what acts on it. Groups rest on
        different points, so what is not shared is independent between them.

    Returns
    -------
    tuple of Contribution
        One a cause; `point_mm` is the largest of the groups', `dof` the smallest.
    """
    rows = []
    for source in dict.fromkeys(effect.source for _, of_part in parts for effect in of_part):
        mine = [(gradient, one) for gradient, of_part in parts for one in of_part if one.source == source]
        moved = [gradient @ one.factor for gradient, one in mine]
        shared = [by for by, (_, one) in zip(moved, mine, strict=True) if one.shared]
        alone = [by for by, (_, one) in zip(moved, mine, strict=True) if not one.shared]
        together = np.concatenate([*alone, sum(shared[1:], start=shared[0])] if shared else alone)
        point_mm, dof = max(one.point_mm for _, one in mine), min(one.dof for _, one in mine)
        rows.append(Contribution(source, float(np.linalg.norm(together)), point_mm, dof=dof))
    return tuple(rows)


def _noise(source: Source, gains: Array, own: Array) -> Effect:
    """Of noise independent between stretches: any root of its covariance does."""
    scaled = gains * own
    values, vectors = np.linalg.eigh(scaled @ scaled.T)
    return Effect(source, vectors * np.sqrt(np.maximum(values, 0.0)), shared=False, point_mm=float(np.median(own)))


def _effect(source: Source, gains: Array, acting: Array, *, shared: bool) -> Effect:
    """Of n independent unit causes, `acting` (J, n) on the stretches."""
    typical = float(np.median(np.sqrt((acting**2).sum(axis=1))))
    return Effect(source, gains @ acting, shared, typical)
