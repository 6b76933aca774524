"""What `trisect plan` does: predict, and say it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from core.cli import output
from core.cli.measuring import Shown
from core.errors import InputError
from core.pipeline.plan_step import PlanResult, plan, plan_values, write_plan
from core.plan.bounds import Bound
from core.plan.predict import Prediction
from core.progress import Progress
from core.report.wording import grouped


def run_plan(
    rig: Path,
    out: Path | None,
    *,
    scans: int,
    changes: bool,
    sigma_cut: float,
    bounds: bool = False,
    progress: Progress,
) -> Shown:
    """Predict, write what is asked for, and return what to say."""
    if scans < 1:
        raise InputError(f"{scans} scans cannot be drawn", where="--scans", todo="give 1 or more")
    if not sigma_cut > 0:
        raise InputError(f"{sigma_cut:g} mm cuts every point", where="--sigma-cut", todo="give a length above 0")
    result = plan(rig, scans=scans, changes=changes, sigma_cut_mm=sigma_cut, bounds=bounds, progress=progress)
    files: Mapping[str, Path] = {} if out is None else write_plan(result, out)
    return Shown(_rows(result), plan_values(result), files=files)


def _rows(result: PlanResult) -> output.Rows:
    rows: output.Rows = []
    for prediction in result.predictions:
        rows.append((f"block {prediction.height_mm:g} mm", f"U = {prediction.U_mm:.3f} mm (k = {prediction.k:g})"))
    shown = result.largest
    rows += [("u from", _budget(shown)), ("σ of a depth", _sigma(shown))]
    rows.append(("sweeps", f"{shown.sweeps_used} of {result.design.sweeps} give {grouped(shown.points)} points"))
    for effect in result.effects:
        value = f"U {effect.U_mm:.3f} mm ({effect.share - 1:+.0%})" if effect.U_mm is not None else effect.reason
        rows.append(("change", f"{effect.change} ({effect.to}): {value}"))
    rows += [("advice", result.advice)] if result.advice else []
    return rows + [("no program below", _bound(bound)) for bound in result.bounds]


def _bound(bound: Bound) -> str:
    without = "" if bound.without == bound.with_speckle else f", {bound.without:.2g} {bound.unit} without speckle"
    return f"{bound.quantity}: u {bound.with_speckle:.2g} {bound.unit}{without}"


def _budget(prediction: Prediction) -> str:
    largest = sorted(prediction.budget, key=lambda row: -row.u_mm)
    return ", ".join(f"{row.source} {row.u_mm:.3f} mm" for row in largest if row.u_mm >= 0.1 * prediction.u_mm)


def _sigma(prediction: Prediction) -> str:
    own, common = (float(np.nanmedian(part)) for part in (prediction.sigma.own, prediction.sigma.common))
    return f"{own:.3f} mm of each point, {common:.3f} mm common to the scan (medians over the picture)"
