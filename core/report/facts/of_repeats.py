"""What is told of repeats: their mean, and how they scatter about it."""

from __future__ import annotations

import math

from core.checks.repeats import RepeatStatistics
from core.messages import decimals_of, label
from core.report.facts.fact import Fact, Reader
from core.states import SPREAD

LEAST_DIGITS = 3
"""Decimals of a length or angle of repeats, where its scatter does not ask for more."""


def repeat_facts(
    statistics: RepeatStatistics, unit: str = "mm", nominal: float | None = None, digits: int = LEAST_DIGITS
) -> list[Fact]:
    """Make the facts on repeats: mean, bias, standard deviation, largest error, RMSE in `unit` to `digits` or more."""
    digits = max(decimals_of(statistics.std_mm), digits)
    several = math.isfinite(statistics.std_mm)
    about_bias, about_rmse = label("Mean less the nominal value"), label("Root mean square of the single errors")
    facts = [
        Fact(label("repeats"), statistics.n, tip=label("Scans in the series"), level=Reader.AUDITOR),
        Fact(label("mean"), statistics.mean_mm, unit, digits, label("Mean of all repeats")),
        Fact(
            SPREAD, statistics.std_mm if several else label("needs two repeats"), unit if several else "", digits,
            label("Standard deviation of one repeat about the mean (over n − 1)"),
        ),
    ]  # fmt: skip
    if statistics.error_mm is None or statistics.rmse_mm is None:
        return [*facts, Fact(label("bias"), label("needs a nominal value"), tip=about_bias)]
    return [
        *facts,
        Fact(label("nominal"), nominal, unit, level=Reader.AUDITOR),
        Fact(label("bias"), statistics.error_mm, unit, digits, about_bias, signed=True),
        Fact(
            label("largest error"), statistics.largest_error_mm, unit, digits,
            label("Largest magnitude of a single error"), Reader.AUDITOR,
        ),
        Fact(label("RMSE"), statistics.rmse_mm, unit, digits, about_rmse, Reader.METROLOGIST),
    ]  # fmt: skip
