"""What is to be inspected on a part: its features, part coordinates and conditions.

A plan says nothing of one scan, so it is the template for the next part as well. All of it is made of plain values that
can be compared, copied with `dataclasses.replace` and undone.
"""

from __future__ import annotations

from dataclasses import dataclass

from core.errors import InputError
from core.inspect.conditions import Master, Temperature
from core.inspect.feature_spec import DERIVED, ELEMENTS, FeatureSpec


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
        """The features it rests on."""
        return tuple(name for name in (self.primary, self.secondary, self.tertiary) if name)


@dataclass(frozen=True, slots=True)
class InspectionPlan:
    """All features to be inspected.

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
        """The feature called so; KeyError if there is none."""
        return {one.name: one for one in self.features}[name]

    @property
    def names(self) -> tuple[str, ...]:
        """Of the features."""
        return tuple(feature.name for feature in self.features)

    def ordered(self) -> tuple[FeatureSpec, ...]:
        """The features so that each comes after all it rests on.

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
                    f"rests on itself by way of {', '.join(sorted(self._needs(left[0])))}",
                    where=f"feature {left[0].name}",
                    todo="give one of them a region of its own",
                )
            done += ready
            left = [feature for feature in left if feature not in ready]
        return tuple(done)

    def _needs(self, spec: FeatureSpec) -> tuple[str, ...]:
        frame = self.frame.names if self.frame is not None and spec.in_part_coordinates else ()
        return (*spec.needs, *frame)


def _check(spec: FeatureSpec, plan: InspectionPlan) -> None:
    """InputError if a feature cannot be measured whatever the scan."""
    where = f"feature {spec.name}" if spec.name else "feature"
    if not spec.name.strip():
        raise InputError("it has no name", where=where, todo="give it one")
    if plan.names.count(spec.name) > 1:
        raise InputError("two features have this name", where=where, todo="rename one of them")
    for name in plan._needs(spec):
        if name not in plan.names:
            raise InputError(
                f"there is no feature {name!r} for it to rest on", where=where, todo="name one of the plan"
            )
    wanted = DERIVED.get(spec.kind, 0)
    if len(spec.of) != wanted or len(set(spec.of)) != wanted:
        raise InputError(f"{spec.kind} is made of {wanted} other features, not {len(spec.of)}", where=where)
    for name in spec.of:
        if plan.feature(name).kind not in ELEMENTS:
            raise InputError(f"{name} is a {plan.feature(name).kind}, and no {spec.kind} is made of that", where=where)
    if not spec.regions and not wanted:
        raise InputError("it has no region", where=where, todo="draw one, or leave regions out to have it found")
    if (spec.kind == "section") != (spec.section is not None):
        raise InputError("only a section has a section's settings, and it needs them", where=where)
    if (spec.kind == "deviation") != (spec.deviation is not None):
        raise InputError("only a deviation has a nominal surface, and it needs one", where=where)
    for result, _ in spec.limits:
        if result not in spec.results:
            known = ", ".join(spec.results) or "nothing that has limits"
            raise InputError(f"it gives {known}, not {result}", where=where, todo="ask for what it gives")
