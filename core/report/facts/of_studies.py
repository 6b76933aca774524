"""What is told of a study: repeats and the type-1 study."""

from __future__ import annotations

import math

from core.messages import Message, label
from core.report.facts.fact import Fact, Grade, Reader
from core.report.wording import decimals_of
from core.states import DECISIONS, SPREAD, VERDICT
from core.study.repeats import RepeatStatistics
from core.study.type1 import LIMIT, Type1Study

LEAST_DIGITS = 3
"""Decimals of a length or angle in a study, where its scatter does not ask for more."""
_GRADES: dict[str, Grade] = {
    "capable": "good", "not capable": "bad",
    "acceptable": "good", "acceptable with reservations": "warn", "not acceptable": "bad",
    "conforming": "good", "not proven": "warn", "not conforming": "bad",
}  # fmt: skip
NO_LIMIT = label("no verdict: no limit is stated")


def verdict_fact(verdict: str) -> Fact:
    """What was decided."""
    return Fact(VERDICT, DECISIONS[verdict] if verdict else NO_LIMIT, grade=_GRADES.get(verdict, ""))


def repeat_facts(statistics: RepeatStatistics, unit: str = "mm", nominal: float | None = None) -> tuple[Fact, ...]:
    """Mean, bias, RMSE, standard deviation and largest error of repeats, all in `unit`."""
    digits = max(decimals_of(statistics.std_mm), LEAST_DIGITS)
    facts = [
        Fact(label("repeats"), statistics.n, tip=label("Scans in the series")),
        Fact(label("mean"), statistics.mean_mm, unit, digits, label("Mean of all repeats")),
    ]
    if nominal is not None:
        facts.append(Fact(label("nominal"), nominal, unit, None, level=Reader.AUDITOR))
    if math.isfinite(statistics.std_mm):
        about = label("Standard deviation of one repeat about the mean (over n − 1)")
        facts.append(Fact(SPREAD, statistics.std_mm, unit, digits, about))
    if statistics.error_mm is not None:
        about = label("Mean less the nominal value")
        facts.append(Fact(label("bias"), statistics.error_mm, unit, digits, about, signed=True))
    if statistics.rmse_mm is not None:
        about = label("Root mean square of the single errors")
        facts.append(Fact(label("RMSE"), statistics.rmse_mm, unit, digits, about, Reader.AUDITOR))
    if statistics.largest_error_mm is not None:
        about = label("Largest magnitude of a single error")
        facts.append(Fact(label("largest error"), statistics.largest_error_mm, unit, digits, about))
    return tuple(facts)


def type1_facts(study: Type1Study) -> tuple[Fact, ...]:
    """Verdict, Cg, Cgk and bias of a type-1 study, and what they rest on."""
    unit, digits = study.unit, max(decimals_of(study.s) + 1, LEAST_DIGITS)
    asked = Message("study.tip_capable", "Capable if Cg and Cgk are {limit:g} or more", limit=LIMIT)
    facts = [
        verdict_fact(study.verdict),
        Fact("Cg", study.cg, digits=2, tip="0.2 T / (6 s)", interval=study.cg_interval),
        Fact("Cgk", study.cgk, digits=2, tip=asked),
        Fact(
            label("bias"), study.bias, unit, digits, label("Mean less the reference value"),
            interval=study.bias_interval, signed=True,
        ),
        Fact(label("repeats"), study.n, level=Reader.AUDITOR),
        Fact(label("mean"), study.mean, unit, digits, label("Mean of all repeats"), Reader.AUDITOR),
        Fact(SPREAD, study.s, unit, digits, label("Standard deviation of one repeat about the mean (over n − 1)")),
        Fact(label("reference value"), study.reference, unit, None, level=Reader.AUDITOR),
        Fact(label("tolerance T"), study.tolerance, unit, None, label("Full width: upper less lower limit")),
        Fact(
            label("smallest T"), study.smallest_tolerance, unit, digits,
            Message("study.tip_smallest", "Smallest tolerance for which Cgk reaches {limit:g}", limit=LIMIT),
            Reader.AUDITOR,
        ),
        Fact(
            label("p of the bias"), float(f"{study.p:.2g}"),
            tip=label("t-test: how probable a bias as large is without any"), level=Reader.METROLOGIST,
        ),
        Fact("t", study.t, digits=2, tip=label("Statistic of the t-test of the bias"), level=Reader.METROLOGIST),
    ]  # fmt: skip
    if study.resolution_share is not None:
        facts.append(
            Fact(
                label("resolution over T"), 100 * study.resolution_share, "%", 1,
                label("At most 5 % of T suffice"), Reader.AUDITOR,
                grade="good" if study.resolution_suffices else "bad",
            )
        )  # fmt: skip
    return tuple(facts)
