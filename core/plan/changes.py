"""Which change of a planned rig helps most: each quantity changed by one stated step, and the plan predicted again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from core.errors import InputError
from core.plan.design import Design
from core.plan.predict import Planner, Prediction
from core.progress import Progress, silent, steps

HELPS = 0.97
"""A change that leaves more than this share of U helps nobody."""


@dataclass(frozen=True, slots=True)
class Change:
    """One step: its name, what it makes of the quantity, in words, and how."""

    name: str
    to: Callable[[Design], str]
    make: Callable[[Design], Design]


@dataclass(frozen=True, slots=True)
class Effect:
    """What a change does to U of the thickness, in mm; `reason` says why it cannot be made, and then `U_mm` is None."""

    change: str
    to: str
    before_mm: float
    U_mm: float | None
    reason: str = ""

    @property
    def share(self) -> float:
        """U after the change over U before; infinite where the change cannot be made."""
        return float("inf") if self.U_mm is None else self.U_mm / self.before_mm


def _scaled(name: str, factor: float, label: str, shown: str) -> Change:
    """A quantity made larger or smaller by a factor, and how its value is shown."""
    return Change(
        label,
        lambda design: shown.format(getattr(design, name) * factor),
        lambda design: _with(design, name, getattr(design, name) * factor),
    )


def _twice(name: str, label: str) -> Change:
    """A number of pictures doubled."""
    return Change(
        label,
        lambda design: str(2 * getattr(design, name)),
        lambda design: _with(design, name, 2 * getattr(design, name)),
    )


def _with(design: Design, name: str, value: Any) -> Design:
    return replace(design, **{name: value})


CHANGES = (
    _scaled("baseline_mm", 1.2, "baseline of the fan 20 % longer", "{:.3g} mm"),
    _scaled("baseline_mm", 0.8, "baseline of the fan 20 % shorter", "{:.3g} mm"),
    _scaled("angle_deg", 1.4, "angle between the fan's planes 40 % wider", "{:.3g}°"),
    _scaled("angle_deg", 0.7, "angle between the fan's planes 30 % narrower", "{:.3g}°"),
    _scaled("focal_mm", 1.2, "focal length 20 % longer", "{:.3g} mm"),
    _scaled("focal_mm", 0.8, "focal length 20 % shorter", "{:.3g} mm"),
    _scaled("hand_baseline_mm", 1.2, "hand-held laser 20 % farther aside", "{:.3g} mm"),
    _twice("poses", "poses of the plane target doubled"),
    _twice("views", "views of the camera target doubled"),
    _twice("sweeps", "sweeps doubled"),
    _scaled("speckle", 0.5, "speckle halved", "contrast {:.2g}"),
    _scaled("stripe_grey", 1.5, "stripes half as bright again", "{:.3g} grey levels"),
)
"""The steps that are tried."""


def compare(
    planner: Planner,
    design: Design,
    base: Prediction,
    *,
    scans: int = 1,
    changes: tuple[Change, ...] = CHANGES,
    progress: Progress = silent,
) -> tuple[Effect, ...]:
    """What each of `changes` does to U of `base`, the most helpful first.

    Plan and change are compared on the same `scans` first scans of the plan, so that luck does not decide.
    """
    before = planner.predict(design, base.height_mm, scans)
    effects = []
    for change in steps(changes, progress, "changes of the rig", len(changes)):
        try:
            after = planner.predict(change.make(design), base.height_mm, scans)
        except InputError as error:
            effects.append(Effect(change.name, change.to(design), base.U_mm, None, error.what))
            continue
        effects.append(Effect(change.name, change.to(design), base.U_mm, base.U_mm * after.u_mm / before.u_mm))
    return tuple(sorted(effects, key=lambda effect: effect.share))


def advice(effects: tuple[Effect, ...]) -> str:
    """The change that helps most, in one sentence."""
    best = effects[0] if effects else None
    if best is None or best.U_mm is None or best.share > HELPS:
        return "None of the changes tried helps by more than 3 %."
    return f"Most helps: {best.change} ({best.to}): U {best.before_mm:.3f} → {best.U_mm:.3f} mm."
