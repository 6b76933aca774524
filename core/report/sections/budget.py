"""The uncertainty budget of a characteristic (GUM): one row an input, u_c, ν_eff, k and U."""

from __future__ import annotations

import math

from reportlab.lib.units import mm
from reportlab.platypus import Flowable, Table, TableStyle

from core.inspect.characteristic import Characteristic
from core.inspect.uncertainty.coverage import effective_dof
from core.messages import capital, label
from core.report.layout.blocks import ShareBar, heads, plain_table, ruled_table
from core.report.layout.style import MUTED, TEXT_WIDTH, ReportLook, color
from core.report.wording import decimals_of, shown_unit

WIDTHS = [size * mm for size in (18, 19, 20, 17, 19, 11, 20)]
"""Value, distribution, u of input, sensitivity, contribution, degrees of freedom, share; the rest is the source's."""

DISTRIBUTIONS = (label("normal"), label("rectangular"), label("triangular"), label("arcsine"), label("t"))
"""Of an input, as a budget names them."""

BAR = 9 * mm
"""Length of the bar of a whole share."""

SMALL = 1e-3
"""Below it a power of ten says more than zeros."""

NONE = 1e-20
"""An input of a smaller share of the variance has no influence: what is left of its sensitivity is rounding."""

MANY = 1000
"""More degrees of freedom are written as infinitely many: the factor k is the same."""


def budget_table(look: ReportLook, one: Characteristic) -> Table:
    """Where the uncertainty comes from, how it combines, and what that gives.

    Sensitivity is |c|, in the result's unit per unit of the input; contribution |c|·u(x); share of the variance.
    """
    unit, factor = shown_unit(one)
    words = look.words
    decimals = decimals_of(factor * one.u) + 1
    variance = sum(row.u_mm**2 for row in one.budget if math.isfinite(row.u_mm)) or 1.0
    rows: list[list[Flowable]] = [
        [
            *heads(look, "Input", "value", "distribution", "u(x)", "sensitivity", numbers=(1, 3, 4)),
            look.text(words.in_unit(words("u of it"), unit), "head_number"),
            look.text("ν", "head_number"),
            look.text(words.in_unit(words("share"), "%"), "head_number"),
        ]
    ]
    for row in one.budget:
        share = row.u_mm**2 / variance if math.isfinite(row.u_mm) else math.nan
        u = factor * row.u_mm
        tiny = math.isfinite(u) and 0 < u < 0.5 * 10.0**-decimals
        shown = f"<\u00a0{words.fixed(10.0**-decimals, decimals)}" if tiny else words.fixed(u, decimals)
        own = "" if row.point_mm is None else f"{_rounded(look, row.point_mm)} {row.unit}"
        value = "" if row.value is None else f"{words.general(row.value)} {row.unit}"
        sensitivity = (
            "" if row.sensitivity is None else _rounded(look, 0.0 if share < NONE else factor * row.sensitivity)
        )
        source = words.known(row.source)
        rows.append(
            [
                look.text(capital(source), "small"),
                look.text(value, "number"),
                look.say(row.distribution, "small"),
                look.text(own, "number"),
                look.text(sensitivity, "number"),
                look.text(shown, "number"),
                look.text(_dof(look, row.dof), "number"),
                _share(look, share),
            ]
        )
    return _closed(look, one, rows, decimals)


def _closed(look: ReportLook, one: Characteristic, rows: list[list[Flowable]], decimals: int) -> Table:
    """With the rows of u, ν_eff and U below."""
    unit, factor = shown_unit(one)
    words = look.words
    U = words.fixed(factor * one.U, decimals_of(factor * one.U))
    last = (
        (words("Combined standard uncertainty u"), words.fixed(factor * one.u, decimals), "small", "number"),
        (words("Effective degrees of freedom ν_eff"), _dof(look, effective_dof(one.budget)), "small", "number"),
        (
            words.in_unit(words("Expanded uncertainty U = k·u, k = {k}", k=words.general(one.k)), unit),
            U,
            "small_strong",
            "number_strong",
        ),
    )
    for name, value, style, number in last:
        blanks = [look.text("", "small") for _ in range(4)]
        rows.append([look.text(name, style), *blanks, look.text(value, number), look.text(""), look.text("")])
    table = ruled_table(rows, [TEXT_WIDTH - sum(WIDTHS), *WIDTHS])
    line = -len(last) - 1
    spans = [("SPAN", (0, row), (4, row)) for row in range(-len(last), 0)]
    table.setStyle(TableStyle([("LINEBELOW", (0, line), (-1, line), 0.6, color(MUTED)), *spans]))
    return table


def _share(look: ReportLook, share: float) -> Flowable:
    """The share in figures with a bar before it."""
    if not math.isfinite(share):
        return look.text("", "number")
    cells = [[ShareBar(look, share, BAR), look.text(look.words.fixed(100 * share, 0), "number")]]
    table = plain_table(cells, [BAR, WIDTHS[-1] - BAR])
    sides = ("LEFTPADDING", "RIGHTPADDING", "TOPPADDING", "BOTTOMPADDING")
    table.setStyle(TableStyle([(side, (0, 0), (-1, -1), 0) for side in sides]))
    return table


def _rounded(look: ReportLook, u: float) -> str:
    """To two digits."""
    return look.words.general(float(f"{u:.1e}")) if 0 < u < SMALL else look.words.fixed(u, decimals_of(u))


def _dof(look: ReportLook, dof: float) -> str:
    if dof > MANY and math.isfinite(dof):
        return f"> {MANY}"
    return "∞" if math.isinf(dof) else look.words.fixed(dof, 0 if dof >= 10 else 1)
