"""Which change of a planned rig helps most: each quantity changed by one stated step, and the plan predicted again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from core.errors import InputError
from core.messages import Message
from core.progress import Progress, silent, steps
from core.wings.rig_planning.prediction.design import USUAL_CHECK, Design
from core.wings.rig_planning.prediction.predict import Planner, Prediction

WORTHWHILE_SHARE = 0.97
"""A change that leaves more than this share of U is not proposed."""


@dataclass(frozen=True, slots=True)
class Change:
    """Change of one quantity: its name, the new value in words, and the function that makes it."""

    name: Message
    to: Callable[[Design], Message]
    make: Callable[[Design], Design]


@dataclass(frozen=True, slots=True)
class Effect:
    """Effect of a change on U of the thickness, in mm; `reason` says why it cannot be made, and then `U_mm` is None."""

    change: Message
    to: Message
    before_mm: float
    U_mm: float | None
    reason: Message | None = None

    @property
    def share(self) -> float:
        """Ratio of U after the change to U before; infinite where the change cannot be made."""
        return float("inf") if self.U_mm is None else self.U_mm / self.before_mm


def _scaled(key: str, factor: float, name: Message, shown: Callable[[float], Message]) -> Change:
    """The quantity of the design called `key` made larger or smaller by a factor, and how its value is shown."""
    return Change(
        name,
        lambda design: shown(getattr(design, key) * factor),
        lambda design: _with(design, key, getattr(design, key) * factor),
    )


def _twice(key: str, name: Message) -> Change:
    """A number of pictures doubled."""
    return Change(
        name,
        lambda design: Message("plan.number", "{n}", n=2 * getattr(design, key)),
        lambda design: _with(design, key, 2 * getattr(design, key)),
    )


def _with(design: Design, key: str, value: Any) -> Design:
    return replace(design, **{key: value})


def _mm(value: float) -> Message:
    return Message("plan.millimetres", "{value_mm:.3g} mm", value_mm=value)


def _degrees(value: float) -> Message:
    return Message("plan.degrees", "{value_deg:.3g}°", value_deg=value)


def _contrast(value: float) -> Message:
    return Message("plan.contrast", "contrast {value:.2g}", value=value)


def _grey(value: float) -> Message:
    return Message("plan.grey_levels", "{value:.3g} grey levels", value=value)


_MORE_CHECKS = Change(
    Message("plan.change_check", "pictures of a check on the day of the scan: {n} more", n=USUAL_CHECK),
    lambda design: Message("plan.number", "{n}", n=design.check_poses + USUAL_CHECK),
    lambda design: _with(design, "check_poses", design.check_poses + USUAL_CHECK),
)

OF_FAN = (
    _scaled("baseline_mm", 1.2, Message("plan.change_baseline_up", "baseline of the fan 20 % longer"), _mm),
    _scaled("baseline_mm", 0.8, Message("plan.change_baseline_down", "baseline of the fan 20 % shorter"), _mm),
    _scaled("angle_deg", 1.4, Message("plan.change_angle_up", "angle between the fan's planes 40 % wider"), _degrees),
    _scaled(
        "angle_deg", 0.7, Message("plan.change_angle_down", "angle between the fan's planes 30 % narrower"), _degrees
    ),
    _twice("poses", Message("plan.change_poses", "poses of the plane target doubled")),
    _MORE_CHECKS,
)
"""Changes of a fan, its calibration and its check."""
OF_ALL = (
    _scaled("focal_mm", 1.2, Message("plan.change_focal_up", "focal length 20 % longer"), _mm),
    _scaled("focal_mm", 0.8, Message("plan.change_focal_down", "focal length 20 % shorter"), _mm),
    _scaled("hand_baseline_mm", 1.2, Message("plan.change_hand_up", "hand-held laser 20 % farther aside"), _mm),
    _twice("views", Message("plan.change_views", "views of the camera target doubled")),
    _twice("sweeps", Message("plan.change_sweeps", "sweeps doubled")),
    _scaled("speckle", 0.5, Message("plan.change_speckle", "speckle halved"), _contrast),
    _scaled("stripe_grey", 1.5, Message("plan.change_brightness", "stripes half as bright again"), _grey),
)
CHANGES = (*OF_FAN, *OF_ALL)
"""The steps that are tried: as much as one would change on a rig that stands, and within what most parts allow."""


def compare(
    planner: Planner,
    design: Design,
    base: Prediction,
    *,
    scans: int = 1,
    changes: tuple[Change, ...] | None = None,
    progress: Progress = silent,
) -> tuple[Effect, ...]:
    """Predict U of the thickness after each of `changes` to the rig, and sort them by that U, the smallest first.

    None: all that there are for such a rig.
    Plan and change are compared on the same `scans` first scans of the plan, so that luck does not decide.
    """
    before = planner.predict(design, base.height_mm, scans)
    effects = []
    tried = changes if changes is not None else CHANGES if design.has_fan else OF_ALL
    for change in steps(tried, progress, "changes of the rig", len(tried)):
        try:
            after = planner.predict(change.make(design), base.height_mm, scans)
        except InputError as error:
            effects.append(Effect(change.name, change.to(design), base.U_mm, None, error.what))
            continue
        effects.append(Effect(change.name, change.to(design), base.U_mm, base.U_mm * after.u_mm / before.u_mm))
    return tuple(sorted(effects, key=lambda effect: effect.share))


def advice(effects: tuple[Effect, ...]) -> Message:
    """Make the sentence on which change of the rig helps most, or that none of those tried does."""
    best = effects[0] if effects else None
    if best is None or best.U_mm is None or best.share > WORTHWHILE_SHARE:
        return Message(
            "plan.no_change_helps",
            "None of the changes tried helps by more than {percent:.0f} %.",
            percent=100 * (1 - WORTHWHILE_SHARE),
        )
    return Message(
        "plan.best_change",
        "Most helps: {change} ({to}): U {before_mm:.3f} → {after_mm:.3f} mm.",
        change=best.change,
        to=best.to,
        before_mm=best.before_mm,
        after_mm=best.U_mm,
    )
