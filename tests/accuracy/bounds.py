"""Do the goals of accuracy ask for more than the pictures hold? Cramér–Rao bounds of the paper's rig against them.

    python -m tests.accuracy.bounds

prints two tables: the bounds of rig planning at full and at half resolution, and each goal beside the least that
a program at the bound would leave. A goal below that cannot be met by any program; one above it can, unless something
that is no noise forbids it (of a ball `tests.accuracy.sphere_bound`: light that lies unevenly on round flanks).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.integrate import quad
from scipy.stats import norm

from core.wings.rig_planning.prediction.bounds import BALL_MM, FREE_FORM_MM, Bound, bounds_of
from core.wings.rig_planning.prediction.design import Design

HEIGHTS_MM = (40.0, 50.0, 60.0, 70.0)
RIGS = {"full": Design(), "half": Design(pixels=(1920, 1374), pixel_um=3.34)}
MEDIAN = float(norm.ppf(0.75))
"""Median of |x| for a standard normal x."""


@dataclass(frozen=True)
class Goal:
    """A goal in mm, and the least that a program at the bounds would leave in its place."""

    name: str
    goal_mm: float
    least_mm: float

    @property
    def forbidden(self) -> bool:
        """Whether no program can meet it, more often than not."""
        return self.least_mm > self.goal_mm


def expected_largest(count: int) -> float:
    """Expected largest |x| of so many standard normal x."""
    return float(quad(lambda x: 1 - (2 * norm.cdf(x) - 1) ** count, 0, 10)[0])


def goals(bounds: Mapping[str, tuple[Bound, ...]]) -> list[Goal]:
    """The goals for thickness, mask and ball, with the bounds of each of RIGS."""

    def u(rig: str, quantity: str) -> float:
        return next(bound.with_speckle for bound in bounds[rig] if str(bound.quantity) == quantity)

    def thickness(rig: str) -> float:
        return float(np.sqrt(np.mean([u(rig, f"thickness of {height:g} mm") ** 2 for height in HEIGHTS_MM])))

    def depth(rig: str) -> float:
        parts = (
            f"depth of a point of free form, {FREE_FORM_MM:g} mm of stripe",
            "depth on a sweep from its light plane, camera and fan known",
            "depth on the fan's lines, from camera and fan",
        )
        return MEDIAN * float(np.sqrt(sum(u(rig, part) ** 2 for part in parts)))

    largest = expected_largest(20)
    return [
        Goal("largest thickness error of 20 scans, full resolution", 0.030, largest * thickness("full")),
        Goal("STD of the same", 0.015, thickness("full")),
        Goal("mean of 10 re-placed, recalibrated scans, full resolution", 0.010, thickness("full") / np.sqrt(10)),
        Goal("largest thickness error of 20 scans, half resolution", 0.045, largest * thickness("half")),
        Goal("mask, median depth error, full resolution", 0.040, depth("full")),
        Goal("mask, median depth error, half resolution", 0.060, depth("half")),
        Goal(
            f"ball of {BALL_MM:g} mm, diameter, full resolution",
            0.030,
            u("full", f"diameter of a ball of {BALL_MM:g} mm"),
        ),
    ]


def table(bounds: Mapping[str, tuple[Bound, ...]]) -> list[str]:
    """Both tables, in Markdown."""
    lines = [
        "| least u of | unit | full: no speckle | full: speckle | half: no speckle | half: speckle |",
        "|---" * 6 + "|",
    ]
    for full, half in zip(bounds["full"], bounds["half"], strict=True):
        figures = (full.without, full.with_speckle, half.without, half.with_speckle)
        lines.append(f"| {full.quantity} | {full.unit} | " + " | ".join(f"{figure:.2g}" for figure in figures) + " |")
    lines += ["", "| goal | mm | at the bounds, mm | |", "|---|---|---|---|"]
    for goal in goals(bounds):
        verdict = "**forbidden**" if goal.forbidden else "possible"
        lines.append(f"| {goal.name} | {goal.goal_mm:.3f} | {goal.least_mm:.4f} | {verdict} |")
    return lines


def all_bounds() -> dict[str, tuple[Bound, ...]]:
    """The bounds of RIGS."""
    return {name: bounds_of(design, HEIGHTS_MM) for name, design in RIGS.items()}


if __name__ == "__main__":
    print("\n".join(table(all_bounds())))
