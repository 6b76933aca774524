"""What a plan foretells, in words: for the command line and the window."""

from __future__ import annotations

import numpy as np

from core.report.wording import Words, grouped
from core.wings.rig_planning.plan_step import PlanResult
from core.wings.rig_planning.prediction.bounds import Bound
from core.wings.rig_planning.prediction.predict import Prediction


def plan_rows(result: PlanResult, words: Words) -> list[tuple[str, str]]:
    """Write what is predicted of a planned rig as rows (name, value) in the language of `words`."""
    rows: list[tuple[str, str]] = []
    for prediction in result.predictions:
        said = words("U = {U:.3f} mm (k = {k:g})", U=prediction.U_mm, k=prediction.k)
        rows.append((words("block {height:g} mm", height=prediction.height_mm), said))
    shown = result.largest
    rows += [(words("u from"), _budget(shown, words)), (words("σ of a depth"), _sigma(shown, words))]
    rows += [(words("not foretold"), words(result.not_foretold))] if result.not_foretold else []
    counts = {"used": shown.sweeps_used, "all": result.design.sweeps, "points": grouped(shown.points)}
    rows.append((words("sweeps"), words("{used} of {all} give {points} points", **counts)))
    for effect in result.effects:
        value = (
            words("U {U:.3f} mm ({percent:+.0f} %)", U=effect.U_mm, percent=100 * (effect.share - 1))
            if effect.U_mm is not None
            else words(effect.reason or "")
        )
        rows.append((words("change"), f"{words(effect.change)} ({words(effect.to)}): {value}"))
    rows += [(words("advice"), words(result.advice))] if result.advice else []
    return rows + [(words("no program below"), _bound(bound, words)) for bound in result.bounds]


def _bound(bound: Bound, words: Words) -> str:
    quantity, unit = words(bound.quantity), bound.unit
    said = words("{quantity}: u {u:.2g} {unit}", quantity=quantity, u=bound.with_speckle, unit=unit)
    if bound.without == bound.with_speckle:
        return said
    return f"{said}, {words('{u:.2g} {unit} without speckle', u=bound.without, unit=unit)}"


def _budget(prediction: Prediction, words: Words) -> str:
    largest = sorted(prediction.budget, key=lambda row: -row.u_mm)
    return ", ".join(
        words("{source} {u:.3f} mm", source=words(row.words), u=row.u_mm)
        for row in largest
        if row.u_mm >= 0.1 * prediction.u_mm
    )


def _sigma(prediction: Prediction, words: Words) -> str:
    own, common = (float(np.nanmedian(part)) for part in (prediction.sigma.own, prediction.sigma.common))
    return words(
        "{own:.3f} mm of each point, {common:.3f} mm common to the scan (medians over the picture)",
        own=own,
        common=common,
    )
