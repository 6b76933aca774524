"""What is to be inspected on a part: its features, part coordinates and conditions.

A plan says nothing of one scan, so it is the template for the next part as well. All of it is made of plain values that
can be compared, copied with `dataclasses.replace` and undone.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from core.errors import InputError
from core.inspect.plan.conditions import Master, Temperature
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.kinds import kind_of, results_of
from core.messages import Message


@dataclass(frozen=True, slots=True)
class PartFrame:
    """Part coordinates by 3-2-1: z out of the `primary` plane, x out of the `secondary` plane or along its axis.

    z = 0 on the primary feature. The origin lies on the secondary plane or axis, and on the `tertiary` plane, or beside
    the tertiary point; without one, beside the middle of the secondary feature. Names of features.
    """

    primary: str
    secondary: str
    tertiary: str = ""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the two or three features that define the part coordinates."""
        return tuple(name for name in (self.primary, self.secondary, self.tertiary) if name)


@dataclass(frozen=True, slots=True)
class InspectionPlan:
    """Plan of all features to be inspected.

    Parameters
    ----------
    features
        In the order they are shown and reported.
    frame
        Part coordinates; None: those of the camera.
    temperature
        Of the part; None: lengths are stated as measured, not at 20 °C.
    master
        A known length that was measured too; None: no comparison.
    k
        Coverage factor.
    """

    features: tuple[FeatureSpec, ...] = ()
    frame: PartFrame | None = None
    temperature: Temperature | None = None
    master: Master | None = None
    k: float = 2.0

    def feature(self, name: str) -> FeatureSpec:
        """Find the feature called `name`; KeyError if there is none."""
        return {one.name: one for one in self.features}[name]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the features of the plan, in order."""
        return tuple(feature.name for feature in self.features)

    def ordered(self) -> tuple[FeatureSpec, ...]:
        """Order the features so that each comes after all features it depends on.

        Raises
        ------
        InputError
            If two have one name, one rests on a feature that is not there, is of no use to it, or on itself, or what it
            needs is missing. The sentence names the feature.
        """
        for spec in self.features:
            _check(spec, self)
        done: list[FeatureSpec] = []
        left = list(self.features)
        while left:
            known = {feature.name for feature in done}
            ready = [feature for feature in left if set(self._needs(feature)) <= known]
            if not ready:
                raise InputError(
                    Message(
                        "feature.rests_on_itself",
                        "rests on itself by way of {names}",
                        names=sorted(self._needs(left[0])),
                    ),
                    where=f"feature {left[0].name}",
                    todo=Message("feature.advice_own_region", "give one of them a region of its own"),
                )
            done += ready
            left = [feature for feature in left if feature not in ready]
        return tuple(done)

    def asks_the_same(self, name: str, other: InspectionPlan) -> bool:
        """Whether the plan `other` defines the feature `name`, those it depends on and the part as this plan does."""
        whole = [replace(plan, features=()) for plan in (self, other)]
        return whole[0] == whole[1] and self._asked(name) == other._asked(name) != {}

    def _asked(self, name: str) -> dict[str, FeatureSpec]:
        """A feature and all that it or the part's coordinates rest on, by their names, as far as they are there."""
        known, asked = {one.name: one for one in self.features}, dict[str, FeatureSpec]()
        left = [name, *(self.frame.names if self.frame is not None else ())] if name in known else []
        while left:
            one = left.pop()
            if one in known and one not in asked:
                asked[one] = known[one]
                left += known[one].needs
        return asked

    def _needs(self, spec: FeatureSpec) -> tuple[str, ...]:
        frame = self.frame.names if self.frame is not None and spec.in_part_coordinates else ()
        return (*spec.needs, *frame)


def _check(spec: FeatureSpec, plan: InspectionPlan) -> None:
    """InputError if a feature cannot be measured whatever the scan."""
    where = f"feature {spec.name}" if spec.name else "feature"
    if not spec.name.strip():
        raise InputError(
            Message("feature.no_name", "it has no name"),
            where=where,
            todo=Message("feature.advice_give_name", "give it one"),
        )
    if plan.names.count(spec.name) > 1:
        raise InputError(
            Message("feature.name_twice", "two features have this name"),
            where=where,
            todo=Message("feature.advice_rename", "rename one of them"),
        )
    for name in plan._needs(spec):
        if name not in plan.names:
            raise InputError(
                Message("feature.rests_on_nothing", "there is no feature '{name}' for it to rest on", name=name),
                where=where,
                todo=Message("feature.advice_name_of_plan", "name one of the plan"),
            )
    kind = kind_of(spec)
    if kind.missing:  # what it needs only its wing knows
        return
    wanted = kind.made_of
    if len(spec.of) != wanted or len(set(spec.of)) != wanted:
        raise InputError(
            Message(
                "feature.made_of_others",
                "{kind} is made of {wanted} other features, not {n}",
                kind=spec.kind,
                wanted=wanted,
                n=len(spec.of),
            ),
            where=where,
        )
    for name in spec.of:
        if kind_of(plan.feature(name)).element is None:
            raise InputError(
                Message(
                    "feature.not_made_of_that",
                    "{name} is a {of_kind}, and no {kind} is made of that",
                    name=name,
                    of_kind=plan.feature(name).kind,
                    kind=spec.kind,
                ),
                where=where,
            )
    if not spec.regions and not wanted:
        raise InputError(
            Message("feature.no_region", "it has no region"),
            where=where,
            todo=Message("feature.advice_draw_region", "draw one, or leave regions out to have it found"),
        )
    if (kind.settings == "section") != (spec.section is not None):
        raise InputError(
            Message("feature.section_settings", "only a section has a section's settings, and it needs them"),
            where=where,
        )
    if (kind.settings == "deviation") != (spec.deviation is not None):
        raise InputError(
            Message("feature.deviation_settings", "only a deviation has a nominal surface, and it needs one"),
            where=where,
        )
    if (kind.settings == "position") != (spec.position is not None):
        raise InputError(
            Message("feature.position_settings", "only a position has a true place, and it needs one"),
            where=where,
        )
    for result, _ in spec.limits:
        results = results_of(spec)
        if result not in results:
            raise InputError(
                Message("feature.gives_others", "it gives {known}, not {name}", known=tuple(results), name=result)
                if results
                else Message("feature.gives_nothing", "it gives nothing that has limits, not {name}", name=result),
                where=where,
                todo=Message("feature.advice_ask_for_results", "ask for what it gives"),
            )
