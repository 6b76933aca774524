"""From the rig.toml of a rig that is only planned to what it will measure, and which change of it helps most."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from core import __version__
from core.calibrate.change import DEFAULT_STABILITY
from core.files.atomic import make_folder, write_bytes, write_text
from core.files.json_text import rounded, to_json
from core.messages import Message, as_json
from core.progress import Progress, silent
from core.settings.options import Options
from core.wings.rig_planning.plan_map import plan_map_png
from core.wings.rig_planning.prediction.bounds import Bound, bounds_of
from core.wings.rig_planning.prediction.changes import Effect, advice, compare
from core.wings.rig_planning.prediction.design import Design, PlanError
from core.wings.rig_planning.prediction.from_rig import read_design, read_stated
from core.wings.rig_planning.prediction.predict import Planner, Prediction, light_not_foretold

PLAN_FILE, MAP_FILE = "plan.json", "sigma.png"


@dataclass(frozen=True, eq=False, slots=True)
class PlanResult:
    """Result of a plan: one prediction for each height, and effects of changes on that of the largest height.

    `advice` is empty when no changes were tried, `bounds` when they were not asked for; `not_foretold` says what U has
    besides in a scan.
    """

    design: Design
    predictions: tuple[Prediction, ...]
    effects: tuple[Effect, ...]
    advice: Message | None
    bounds: tuple[Bound, ...] = ()
    not_foretold: Message | None = None

    @property
    def largest(self) -> Prediction:
        """Prediction for the block of the largest height, by which changes of the rig are judged."""
        return max(self.predictions, key=lambda prediction: prediction.height_mm)


def plan(
    rig: Path,
    *,
    scans: int = 2,
    changes: bool = True,
    options: Options | None = None,
    bounds: bool = False,
    progress: Progress = silent,
) -> PlanResult:
    """Predict what the planned rig in the rig.toml at `rig`, or in the folder `rig`, will measure.

    Parameters
    ----------
    scans
        How many scans are drawn for the prediction; changes are compared on the first of them.
    changes
        Whether to try which change helps most.
    options
        What the scan is told of it; None: what is usual.
    bounds
        Whether to say also what no program could do better.

    Raises
    ------
    InputError
        If rig.toml is wrong, or the rig cannot measure.
    """
    design = read_design(rig)
    part, stability = read_stated(rig)
    if bounds and not design.has_fan:
        raise PlanError(
            Message("plan.no_bounds_without_fan", "bounds are known for a rig with a fan only"),
            where="--bounds",
            todo=Message("plan.advice_without_bounds", "leave --bounds out, or add the table [laser_fan]"),
        )
    planner = Planner(progress, (options or Options()).for_plan.solving(), part, stability)
    predictions = tuple(planner.predict(design, height, scans) for height in design.heights_mm)
    base = max(predictions, key=lambda prediction: prediction.height_mm)
    effects = compare(planner, design, base, progress=progress) if changes else ()
    reckoned = DEFAULT_STABILITY if stability is None else stability
    limits = bounds_of(design, stability=reckoned, progress=progress) if bounds else ()
    said = advice(effects) if changes else None
    return PlanResult(design, predictions, effects, said, limits, light_not_foretold(part))


def write_plan(result: PlanResult, folder: Path) -> Mapping[str, Path]:
    """Write plan.json and sigma.png, the map of σ, into `folder`, and return the paths of both.

    Raises
    ------
    InputError
        If the folder cannot be made or written to.
    """
    make_folder(folder)
    files = {"plan": folder / PLAN_FILE, "sigma": folder / MAP_FILE}
    shown = result.largest
    title = Message(
        "plan.map_title", "Standard uncertainty of depth, block of {height_mm:g} mm", height_mm=shown.height_mm
    )
    picture = plan_map_png(shown.sigma.own, shown.sigma.common, result.design.pixels, str(title))
    write_bytes(files["sigma"], picture)
    write_text(files["plan"], to_json({**plan_values(result), "sigma_map": _sigma_map(shown)}))
    return files


def plan_values(result: PlanResult) -> dict[str, Any]:
    """Convert the prediction of a planned rig to the values of plan.json; lengths in mm, angles in degrees."""
    return {
        "version": __version__,
        "design": _design(result.design),
        "thickness": [_prediction(prediction) for prediction in result.predictions],
        "advice": None if result.advice is None else as_json(result.advice),
        "changes": [
            {
                "change": as_json(effect.change),
                "to": as_json(effect.to),
                "U_mm": effect.U_mm,
                "reason": None if effect.reason is None else as_json(effect.reason),
            }
            for effect in result.effects
        ],
        "bounds": [_bound(bound) for bound in result.bounds],
        "not_foretold": None if result.not_foretold is None else as_json(result.not_foretold),
    }


def _design(design: Design) -> dict[str, Any]:
    """The quantities of a design; of its boards, their names."""
    left_out = ("camera_target", "plane_target", "boards")
    values = {one.name: getattr(design, one.name) for one in fields(design) if one.name not in left_out}
    return {**values, "boards": [name for name, _ in design.boards]}


def _bound(bound: Bound) -> dict[str, Any]:
    return {
        "quantity": as_json(bound.quantity),
        "unit": bound.unit,
        "without": bound.without,
        "with_speckle": bound.with_speckle,
    }


def _prediction(prediction: Prediction) -> dict[str, Any]:
    return {
        "height_mm": prediction.height_mm,
        "u_mm": prediction.u_mm,
        "U_mm": prediction.U_mm,
        "k": prediction.k,
        "budget": [{"source": as_json(row.words), "u_mm": row.u_mm} for row in prediction.budget],
        "sigma_own_mm": float(np.nanmedian(prediction.sigma.own)),
        "sigma_common_mm": float(np.nanmedian(prediction.sigma.common)),
        "sweeps_used": prediction.sweeps_used,
        "points": prediction.points,
    }


def _sigma_map(prediction: Prediction) -> dict[str, Any]:
    sigma = prediction.sigma
    return {
        "height_mm": prediction.height_mm,
        "cell_px": sigma.cell_px,
        "own_mm": rounded(sigma.own, 5),
        "common_mm": rounded(sigma.common, 5),
    }
