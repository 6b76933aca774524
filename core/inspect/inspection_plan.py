"""What is to be inspected on a part: features, each with source → region → fit → filters → result.

A plan says nothing of one scan, so it is the template for the next part as well. All of it is made of plain values that
can be compared, copied with `dataclasses.replace` and undone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

from core.errors import InputError
from core.inspect.characteristic import Limits
from core.inspect.conditions import Master, Temperature

Kind = Literal[
    "plane", "sphere", "cylinder", "point", "thickness", "steps", "distance", "angle", "section", "deviation"
]
Pixel: TypeAlias = tuple[float, float]
Place: TypeAlias = tuple[float, float, float]

RESULTS: Mapping[Kind, tuple[str, ...]] = {
    "plane": ("flatness",),
    "sphere": ("diameter", "form"),
    "cylinder": ("diameter", "form"),
    "point": (),
    "thickness": ("thickness",),
    "steps": ("height",),
    "distance": ("distance",),
    "angle": ("angle",),
    "section": (),
    "deviation": ("profile", "mean"),
}
"""What each kind of feature gives: the names that limits are asked by. A section gives what its cuts are called."""

DERIVED: Mapping[Kind, int] = {"distance": 2, "angle": 2}
"""Kinds made from so many other features instead of points."""

ELEMENTS: tuple[Kind, ...] = ("plane", "sphere", "cylinder", "point")
"""Kinds that others can be derived from."""


@dataclass(frozen=True, slots=True)
class Auto:
    """Found in the cloud: the surface of this kind that explains most, or the `number`-th most of planes."""

    number: int = 1


@dataclass(frozen=True, slots=True)
class Polygon:
    """All points seen inside a polygon of the picture; `corners_px` (u, v)."""

    corners_px: tuple[Pixel, ...]


@dataclass(frozen=True, slots=True)
class InSphere:
    """All points within `radius_mm` of a place in part coordinates."""

    centre_mm: Place
    radius_mm: float


@dataclass(frozen=True, slots=True)
class InBox:
    """All points in a box of part coordinates, along its axes."""

    low_mm: Place
    high_mm: Place


@dataclass(frozen=True, slots=True)
class PointsOf:
    """The points another feature used."""

    feature: str


Region: TypeAlias = Auto | Polygon | InSphere | InBox | PointsOf


@dataclass(frozen=True, slots=True)
class Filters:
    """Which points of a region are used, and what the form is the spread of.

    Parameters
    ----------
    sigma_max_mm
        Points with a larger standard uncertainty are left out; None: none.
    margin_mm
        Points nearer to the edge of a plane face are left out: stripes are biased there.
    outliers
        Points this many robust standard deviations from the fitted surface are left out.
    cell_mm
        Form is the spread of the means over cells of this side; 0: of single points, their noise included.
    """

    sigma_max_mm: float | None = None
    margin_mm: float = 1.5
    outliers: float = 4.685
    cell_mm: float = 0.0


@dataclass(frozen=True, slots=True)
class Cut:
    """One measurement in a section: between positions in mm along it.

    `kind` "height": of the line over `second` above that over `first`, square to it. "distance": from the middle of one
    stretch to the middle of the other. "radius": of the circle over `first`.
    """

    name: str
    kind: Literal["height", "distance", "radius"]
    first: tuple[float, float]
    second: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Section:
    """A cross-section: the plane through the camera's ray of two pixels, or through a place of part coordinates.

    Parameters
    ----------
    line_px
        Two pixels; positions run from where the first is seen to where the second is. None: the plane by `point_mm`,
        `normal` in part coordinates.
    half_width_mm
        Points so near to the plane are taken for points in it.
    step_mm
        Length along the section over which the shown profile is averaged.
    cuts
        What is measured in it.
    """

    line_px: tuple[Pixel, Pixel] | None = None
    point_mm: Place = (0.0, 0.0, 0.0)
    normal: Place = (0.0, 1.0, 0.0)
    half_width_mm: float = 1.0
    step_mm: float = 0.5
    cuts: tuple[Cut, ...] = ()


@dataclass(frozen=True, slots=True)
class Deviation:
    """A comparison with a nominal surface.

    Parameters
    ----------
    nominal
        Name of the STL file, in mm.
    align
        "best fit" to the surface; "frame": the file's coordinates are part coordinates (3-2-1); "as measured": they
        are those of the camera.
    tolerance_mm
        What the classes of colours and marks are shares of.
    reach_mm
        Points farther from the nominal surface do not belong to the part (a table, a clamp).
    """

    nominal: str
    align: Literal["best fit", "frame", "as measured"] = "best fit"
    tolerance_mm: float = 0.1
    reach_mm: float = 2.0


@dataclass(frozen=True, slots=True)
class FeatureSpec:
    """One feature.

    Parameters
    ----------
    name
        As the technician calls it; unique in a plan.
    kind
        What it is.
    regions
        Where its points are: one, or two (upper, lower) for a thickness, or one for each level of steps.
    of
        Names of the features it is derived from.
    filters
        Which points are used.
    limits
        What is asked of its results, by their names in `results`. Of steps the limits "height" go for each step, about
        its own nominal height.
    nominal_heights
        Of the steps in mm, from the lowest up.
    over
        Steps: each over the "lowest" level, or over the "previous" one.
    section, deviation
        Of these kinds.
    """

    name: str
    kind: Kind
    regions: tuple[Region, ...] = (Auto(),)
    of: tuple[str, ...] = ()
    filters: Filters = Filters()
    limits: tuple[tuple[str, Limits], ...] = ()
    nominal_heights: tuple[float, ...] = ()
    over: Literal["lowest", "previous"] = "lowest"
    section: Section | None = None
    deviation: Deviation | None = None

    @property
    def results(self) -> tuple[str, ...]:
        """What it gives: the names that limits are asked by."""
        return RESULTS[self.kind] if self.section is None else tuple(cut.name for cut in self.section.cuts)

    @property
    def needs(self) -> tuple[str, ...]:
        """Names of all features it rests on."""
        return (*self.of, *(region.feature for region in self.regions if isinstance(region, PointsOf)))

    @property
    def in_part_coordinates(self) -> bool:
        """Whether it can only be measured once the part's frame is known."""
        placed = self.section is not None and self.section.line_px is None
        framed = self.deviation is not None and self.deviation.align == "frame"
        return placed or framed or any(isinstance(region, InSphere | InBox) for region in self.regions)

    def limits_of(self, result: str) -> Limits | None:
        """What is asked of one of its results, as "diameter" or "height 2"; None: nothing."""
        asked = dict(self.limits)
        if self.kind != "steps":
            return asked.get(result)
        limits, step = asked.get("height"), int(result.rpartition(" ")[2])
        if limits is None or step > len(self.nominal_heights):
            return None
        return replace(limits, nominal=self.nominal_heights[step - 1])


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
