"""What is told of an uncertainty budget (GUM): what each input contributes, what is known of it, and u, ν_eff and U."""

from __future__ import annotations

import math
from dataclasses import replace

from core.inspect.causes import CALIBRATIONS, Cause
from core.inspect.characteristic import Characteristic
from core.inspect.plan.kinds import expands
from core.inspect.results import Contribution
from core.inspect.uncertainty.coverage import effective_dof
from core.messages import Message, decimals_of, label
from core.report.facts.fact import Fact, Reader
from core.report.wording import shown_unit

DISTRIBUTIONS = (label("normal"), label("rectangular"), label("triangular"), label("arcsine"), label("t"))
"""Of an input, as a budget names them."""

INPUT = label("Input")
VALUE, DISTRIBUTION, OF_INPUT, SENSITIVITY = label("value"), label("distribution"), "u(x)", label("sensitivity")
CONTRIBUTION, FREEDOM, SHARE = label("u of it"), "ν", label("share")
"""What stands in the columns of a budget, its inputs first."""

SMALL = 1e-3
"""Below it a power of ten says more than zeros."""

NONE = 1e-20
"""An input of a smaller share of the variance has no influence: what is left of its sensitivity is rounding."""

EFFECTIVE = label("effective degrees of freedom ν_eff")

MANY = 1000
"""More degrees of freedom are told as such: the factor k is the same."""


def budget_facts(one: Characteristic) -> tuple[Fact, ...]:
    """Make the facts on an uncertainty budget: the contribution |c|·u(x) of each input, then u, ν_eff and U."""
    unit, factor = shown_unit(one)
    digits = _digits(one)
    root = label("Root of the sum of squares of all rows (k = 1)")
    about_U = Message("told.expanded", "expanded uncertainty U = k·u, k = {k:g}", k=one.k)
    contributions = (replace(_contribution(one, row), label=row.words) for row in reported_rows(one))
    return (
        *contributions,
        Fact(label("combined standard uncertainty u"), factor * one.u, unit, digits, root),
        freedom_fact(EFFECTIVE, effective_dof(one.budget)),
        Fact(about_U, factor * one.U, unit, decimals_of(factor * one.U), level=Reader.AUDITOR),
    )


ALWAYS_TOLD = (
    (Cause.SCALE, Cause.SCALE_ASSUMED),
    (Cause.SCALE_TEMPERATURE, Cause.SCALE_TEMPERATURE_ASSUMED),
    (Cause.PART_TEMPERATURE, Cause.PART_TEMPERATURE_ASSUMED),
)
"""What every length follows, as stated and as assumed: a reader misses the row where it is nothing."""


def reported_rows(one: Characteristic) -> tuple[Contribution, ...]:
    """Return the rows of a characteristic's uncertainty budget; for a length also rows of 0 for size and temperature.

    Of a budget that is not of this program's causes, of a comparison, which they cancel in, and of one of which it is
    not known whether temperatures are in it, the rows alone.
    """
    causes = {row.source for row in one.budget}
    if not expands(one) or one.by_master or one.at_20 is None or causes.isdisjoint(CALIBRATIONS.values()):
        return one.budget
    return (*one.budget, *(Contribution(pair[0], 0.0) for pair in ALWAYS_TOLD if causes.isdisjoint(pair)))


def largest_row(one: Characteristic) -> tuple[Contribution, float] | None:
    """Find the budget row that contributes most to u, and its share of u² (0 to 1); None if u is 0 or not known."""
    variance = sum(row.u_mm**2 for row in one.budget)
    if not 0 < variance < math.inf:
        return None
    row = max(one.budget, key=lambda row: row.u_mm)
    return row, row.u_mm**2 / variance


def input_cells(one: Characteristic) -> tuple[tuple[Fact, ...], ...]:
    """Make the table rows of an uncertainty budget, one for each input, each a tuple of facts.

    A row has value, distribution, u(x), sensitivity |c|, contribution, freedom, share of variance.
    """
    _, factor = shown_unit(one)
    variance = sum(row.u_mm**2 for row in one.budget if math.isfinite(row.u_mm)) or 1.0
    return tuple(_cells(one, row, factor, row.u_mm**2 / variance) for row in reported_rows(one))


def _cells(one: Characteristic, row: Contribution, factor: float, share: float) -> tuple[Fact, ...]:
    slope = row.sensitivity
    if slope is not None:
        slope = 0.0 if share < NONE else factor * slope
    return (
        Fact(VALUE, row.value, row.unit),
        Fact(DISTRIBUTION, row.distribution),
        _rounded(OF_INPUT, row.point_mm, row.unit),
        _rounded(SENSITIVITY, slope),
        _contribution(one, row),
        freedom_fact(FREEDOM, row.dof),
        Fact(SHARE, 100 * share if math.isfinite(share) else None, "%", 0),
    )


def _contribution(one: Characteristic, row: Contribution) -> Fact:
    unit, factor = shown_unit(one)
    about = label("Standard uncertainty (k = 1)")
    return Fact(CONTRIBUTION, factor * row.u_mm, unit, _digits(one), about, above_zero=True)


def _digits(one: Characteristic) -> int:
    """One more than u has: a row may be small."""
    _, factor = shown_unit(one)
    return decimals_of(factor * one.u) + 1


def _rounded(name: str, value: float | None, unit: str = "") -> Fact:
    """To two digits."""
    if value is None or not 0 < value < SMALL:
        return Fact(name, value, unit, None if value is None else decimals_of(value))
    return Fact(name, value, unit, significant=2)


def freedom_fact(name: str, dof: float, level: Reader = Reader.AUDITOR) -> Fact:
    """Make the fact on a number of degrees of freedom; a very large finite one is shown as "> MANY"."""
    many = MANY < dof < math.inf
    value = Message("told.more_than", "> {number}", number=MANY) if many else dof
    return Fact(name, value, digits=0 if dof >= 10 else 1, level=level)
