"""The accuracy table: what was measured beside what the paper states and what this project promises."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.accuracy.cases import FULL, HALF, Case, calibration_key

Figures = Mapping[str, Any]
Chosen = Sequence[Figures]


@dataclass(frozen=True, slots=True)
class Row:
    """One line: what it is, which scans it is of, how its figure is taken, and the limit it should keep."""

    title: str
    group: str
    scale: float
    figure: Callable[[Chosen], float]
    paper: str = "–"
    goal: str = ""
    keeps: Callable[[float], bool] = lambda _: True
    form: str = "{:.3f} mm"


def largest_error(chosen: Chosen) -> float:
    """Largest |error| in mm."""
    return max(abs(each["error"]) for each in chosen)


def scatter(chosen: Chosen) -> float:
    """Standard deviation (n − 1) of the errors in mm."""
    return float(np.std([each["error"] for each in chosen], ddof=1)) if len(chosen) > 1 else float("nan")


def mean_error(chosen: Chosen) -> float:
    """|mean error| in mm."""
    return abs(float(np.mean([each["error"] for each in chosen])))


def median_depth(chosen: Chosen) -> float:
    """Largest of the scans' median depth errors in mm."""
    return max(each["median_depth"] for each in chosen)


def within_expanded(chosen: Chosen) -> float:
    """Share of the results with |error| ≤ 2 u."""
    return float(np.mean([abs(each["error"]) <= 2 * each["u"] for each in chosen]))


def rms_over_u(chosen: Chosen) -> float:
    """Root mean square of error / u: 1 where u is honest."""
    return float(np.sqrt(np.mean([(each["error"] / each["u"]) ** 2 for each in chosen])))


def form(chosen: Chosen) -> float:
    """Largest range of 95 % of the residuals in mm."""
    return max(each["form"] for each in chosen)


def at_most(limit: float) -> Callable[[float], bool]:
    """The goal of a figure that should be small."""
    return lambda value: value <= limit


def between(low: float, high: float) -> Callable[[float], bool]:
    """The goal of a share that should be neither too small nor too large."""
    return lambda value: low <= value <= high


SHARE = "{:.1%}"

ROWS = (
    Row("wide block, largest thickness error", "wide", FULL, largest_error, "0.163 mm", "≤ 0.030 mm", at_most(0.030)),
    Row("wide block, scatter (STD)", "wide", FULL, scatter, "0.110 mm", "≤ 0.015 mm", at_most(0.015)),
    Row("wide block, &#124;error&#124; ≤ U", "wide", FULL, within_expanded, "–", "≥ 90 %", between(0.9, 1.0), SHARE),
    Row("wide block, RMS of error / u", "wide", FULL, rms_over_u, "–", "about 1", between(0.7, 1.3), "{:.2f}"),
    Row("narrow block, largest thickness error", "narrow", FULL, largest_error, "–", "≤ 0.030 mm", at_most(0.030)),
    Row("re-placed and recalibrated, mean", "replaced", FULL, mean_error, "0.03 mm", "≤ 0.010 mm", at_most(0.010)),
    Row("the same, largest", "replaced", FULL, largest_error),
    Row("mask, median depth error", "mask", FULL, median_depth, "–", "≤ 0.04 mm", at_most(0.04)),
    Row("sphere of 50 mm, diameter error", "sphere", FULL, largest_error, "–", "≤ 0.03 mm", at_most(0.03)),
    Row("sphere of 50 mm, form (95 %)", "sphere", FULL, form, "–", "≤ 0.12 mm", at_most(0.12)),
    Row("wide block, largest thickness error", "wide", HALF, largest_error, "–", "≤ 0.045 mm", at_most(0.045)),
    Row("wide block, &#124;error&#124; ≤ U", "wide", HALF, within_expanded, "–", "≥ 90 %", between(0.9, 1.0), SHARE),
    Row("wide block, RMS of error / u", "wide", HALF, rms_over_u, "–", "about 1", between(0.7, 1.3), "{:.2f}"),
    Row("narrow block, largest thickness error", "narrow", HALF, largest_error),
    Row("mask, median depth error", "mask", HALF, median_depth, "–", "≤ 0.06 mm", at_most(0.06)),
    Row("sphere of 50 mm, diameter error", "sphere", HALF, largest_error),
    Row("sphere of 50 mm, form (95 %)", "sphere", HALF, form),
)


def table(cases: Sequence[Case], results: Mapping[str, Figures]) -> list[str]:
    """The lines of the table in Markdown; rows without a scan are left out."""
    lines = [
        "| | scans | the paper, stated | its procedure, same pictures | goal | measured | |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in ROWS:
        mine = [case for case in cases if case.group == row.group and case.scenario.scale == row.scale]
        if not mine:
            continue
        value = row.figure([results[case.name] for case in mine])
        kept = "" if not row.goal else "met" if row.keeps(value) else "**missed**"
        size = "full" if row.scale == FULL else "half"
        lines.append(
            f"| {row.title}, {size} resolution | {len(mine)} | {row.paper} | {_papers(row, mine, results)} "
            f"| {row.goal or '–'} | {row.form.format(value)} | {kept} |"
        )
    return lines


def within_2_sigma(cases: Sequence[Case], results: Mapping[str, Figures], scale: float) -> np.ndarray:
    """Share of the points within two of their standard uncertainties of the truth, of every calibration (N,).

    A calibration's error is one draw for all points of its scans, so it counts once, however many scans share it.
    """
    shares: dict[tuple[int, float], list[float]] = {}
    for case in cases:
        if case.scenario.scale == scale:
            shares.setdefault(calibration_key(case.scenario), []).append(results[case.name]["within_2_sigma"])
    return np.array([np.mean(each) for each in shares.values()])


def _papers(row: Row, mine: Sequence[Case], results: Mapping[str, Figures]) -> str:
    """What the paper's procedure makes of the same pictures, where it was tried and the row's figure can be taken.

    A thickness is that of the sweeps' points, as in the paper, and then with the fan's own as well.
    """
    tried = [results[case.name]["paper"] for case in mine if case.paper]
    if tried and row.figure is largest_error:
        of_sweeps, with_fan = (_told(row, key, tried, len(mine)) for key in ("error_of_sweeps", "error"))
        return f"{of_sweeps}; with the fan's own points {with_fan}"
    return _told(row, "median_depth", tried, len(mine)) if tried and row.figure is median_depth else "–"


def _told(row: Row, key: str, tried: Chosen, scans: int) -> str:
    """The row's figure of the paper's procedure, which was tried on some of so many scans, from what `key` names."""
    found = [{"error": each[key], "median_depth": each[key]} for each in tried if key in each]
    if not found:
        return f"none in {len(tried)} scans"
    told = row.form.format(row.figure(found))
    return told if len(found) == len(tried) == scans else f"{told} ({len(found)} of {len(tried)} scans)"
