"""Positions by the measured cross-section, where a picture's stripes have surely none that is Gaussian.

The section is measured about a first curve and the curve is moved by the section's likelihood, twice. Whether that is
worth it says the one half of the stripes of the other: with the weights that its own section asks for, its places must
scatter clearly less than with those used otherwise. So what is not known well enough is not used.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.image.stripes.curve import smooth_curve
from core.image.stripes.likelihood.cut_model import Light
from core.image.stripes.likelihood.influence import DEGREE
from core.image.stripes.likelihood.measured_section import (
    BINS,
    GROUPS,
    Surroundings,
    add_departures,
    departs,
    gaussian_section,
    section_from,
)
from core.image.stripes.likelihood.refinement import Refined, StripeModel, cuts_of, refine
from core.image.stripes.noise import NoiseModel
from core.image.stripes.runs import arc_length
from core.image.stripes.speckle import Speckle
from core.image.stripes.tracing.seeds import Picture
from core.model.arrays import Array

# Held by tests/image/stripes/likelihood/test_measured_section.py.
_ROUNDS = 2  # of measuring the section and moving the curve
_WORTH = 1.06  # variance of the places without the measured section over that with it
_LOOKED_AT = 600  # cuts, about, that tell whether a section may be no Gaussian
_LEAST_APART = 4  # cuts from one of these to the next; saves time
_SAMPLE = 8  # points: every so many tell a median over sections


@dataclass(frozen=True, eq=False, slots=True)
class StripePicture:
    """Stripes of a picture before their refinement, and the scatter of its grey values."""

    picture: Picture
    state: NDArray[np.uint8]
    stripes: list[StripeModel]
    noise: NoiseModel
    speckle: Speckle
    filter_px: float

    def refined(self, stripes: list[StripeModel]) -> list[Refined]:
        """Move the points of these stripes to their likeliest places in this picture."""
        return [
            refine(self.picture, self.state, stripe, self.noise, self.speckle, self.filter_px) for stripe in stripes
        ]


def by_measured_section(lit: StripePicture, lines: list[Refined]) -> list[Refined] | None:
    """Locate stripes by the cross-section measured in their picture; None to keep their places by a Gaussian.

    Parameters
    ----------
    lit
        The picture and its stripes.
    lines
        Their places by the Gaussian likelihood, to be kept if this finds nothing better.
    """
    if not lines or lit.noise.compression.grey > 0:
        return None  # what compression leaves of a section is another in each of its blocks
    curves = [line.run for line in lines]
    count = sum(map(len, curves))
    if not departs(_departures(lit, curves, max(_LEAST_APART, count // _LOOKED_AT))):
        return None
    around = _surroundings(lit)
    height = _median_of([stripe.sections.height for stripe in lit.stripes])
    if height <= 0:
        return None
    section, found = None, lines
    for _ in range(_ROUNDS):
        curves = [
            smooth_curve(line.run, arc_length(line.run), stripe.weight, lit.filter_px)
            for line, stripe in zip(found, lit.stripes, strict=True)
        ]
        groups = _departures(lit, curves, 1)
        if section is None and not _is_worth_it(groups, around, height):
            return None
        section = section_from(groups.sum(axis=0), around)
        if section is None:
            return None
        found = lit.refined(
            [stripe._replace(curve=curve, measured=section) for stripe, curve in zip(lit.stripes, curves, strict=True)]
        )
    return found


def _surroundings(lit: StripePicture) -> Surroundings:
    background, width = (
        _median_of([figures[which] for figures in (stripe.sections for stripe in lit.stripes)]) for which in (2, 1)
    )
    return Surroundings(background, width, lit.noise, lit.speckle, lit.filter_px)


def _median_of(figures: list[Array]) -> float:
    return float(np.median(np.concatenate([one[::_SAMPLE] for one in figures])))


def _departures(lit: StripePicture, curves: list[Array], every: int) -> Array:
    """What stripes along these curves (N, 5) depart from a Gaussian, (GROUPS, 3, BINS), by every so many cuts."""
    sums, first, total = np.zeros((GROUPS, 3, BINS)), 0, sum(map(len, curves))
    scatter = (lit.noise.read_grey**2, lit.noise.grey_per_electron)
    for stripe, curve in zip(lit.stripes, curves, strict=True):
        figures = np.column_stack(stripe.sections)
        light = Light(figures, np.zeros(len(curve), np.int64), np.zeros((1, DEGREE + 1)), scatter)
        cuts = cuts_of(curve, arc_length(curve))
        part = (first, total, every)
        add_departures(lit.picture, lit.state, curve, cuts, stripe.clear, light, part, sums)
        first += len(curve)
    return sums


def _is_worth_it(groups: Array, around: Surroundings, height: float) -> bool:
    """Whether the section of each half of the stripes makes the places of the other half scatter less."""
    halves = [section_from(groups[k::2].sum(axis=0), around) for k in range(2)]
    usual, gain = gaussian_section(around).weights(height).solved, 1.0
    for mine, other in (halves, halves[::-1]):
        if mine is None or other is None:
            return False
        gain *= other.variance_by(usual, height) / other.variance_by(mine.weights(height).solved, height)
    return gain > _WORTH**2
