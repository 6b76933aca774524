"""What is told of a characteristic, as a feature of a plan or the gauge's thickness: all tables of results draw it."""

from __future__ import annotations

import math

from core.inspect.characteristic import Characteristic
from core.messages import Message, decimals_of, label
from core.report.facts.fact import Fact, Reader
from core.report.facts.of_verdict import verdict_fact
from core.report.wording import Words, permitted, result_name, shown_unit, with_unit
from core.states import VERDICT

NOMINAL, PERMITTED, MEASURED = label("nominal"), label("permitted"), label("measured")
EXPANDED, FACTOR, DEVIATION = label("U"), label("k"), label("deviation")
HEADS = (NOMINAL, PERMITTED, MEASURED, EXPANDED, FACTOR, DEVIATION, VERDICT)
"""Of the columns beside the name, as `characteristic_cells` fills them."""


def characteristic_facts(one: Characteristic) -> tuple[Fact, ...]:
    """Make the facts on a characteristic: value with U, nominal value, deviation, and verdict."""
    unit, factor = shown_unit(one)
    digits, U = decimals_of(factor * one.U), factor * one.U if math.isfinite(one.U) else None
    name = Message("told.with_k", "{name} (k = {k:g})", name=result_name(one), k=one.k)
    meaning = label("± is the expanded uncertainty U: k times the standard uncertainty")
    facts = [Fact(name, factor * one.value, unit, digits, one.rule or meaning, U=U)]
    if one.limits is not None and one.deviation is not None:
        nominal = factor * one.limits.nominal
        facts += [
            Fact(
                DEVIATION, factor * one.deviation, unit, digits, label("Measured less the nominal value"),
                signed=True,
            ),
            Fact(NOMINAL, nominal, unit, level=Reader.AUDITOR),
            Fact(
                PERMITTED, permitted(one) or "–", tip=label("Deviations that are permitted"),
                level=Reader.AUDITOR,
            ),
        ]  # fmt: skip
    return (*facts, verdict_fact(one.verdict))


def characteristic_cells(one: Characteristic, words: Words) -> tuple[str, ...]:
    """Write the cells of a characteristic's table row under the columns HEADS; "" where there is no value."""
    unit, _ = shown_unit(one)
    value, *others, verdict = characteristic_facts(one)
    deviation, nominal, allowed = (fact.parts(words)[0] for fact in others) if others else ("", "", "")
    known = one.deviation is not None and math.isfinite(one.deviation)
    measured, U = value.parts(words)
    return (
        with_unit(nominal, unit) if nominal else "",
        allowed,
        with_unit(measured, unit) if math.isfinite(one.value) else measured,
        with_unit(U, unit) if U else words("unknown"),
        words.general(one.k),
        with_unit(deviation, unit) if known else "",
        verdict.text(words) if one.verdict else "",
    )
