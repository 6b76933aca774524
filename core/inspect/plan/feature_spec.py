"""One feature to be inspected: source → region → fit → filters → result.

It says nothing of one scan. All of it is made of plain values that can be compared, copied with `dataclasses.replace`
and undone.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

from core.inspect.conformity import Limits

Pixel: TypeAlias = tuple[float, float]
Place: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Auto:
    """Surface found in the cloud: the one of its kind that explains most, or the `number`-th most of planes."""

    number: int = 1


@dataclass(frozen=True, slots=True)
class Polygon:
    """Region of the points seen inside a polygon of the picture; `corners_px` (u, v)."""

    corners_px: tuple[Pixel, ...]


@dataclass(frozen=True, slots=True)
class InSphere:
    """Region of the points within `radius_mm` of a place in part coordinates."""

    centre_mm: Place
    radius_mm: float


@dataclass(frozen=True, slots=True)
class InBox:
    """Region of the points in a box of part coordinates, along its axes."""

    low_mm: Place
    high_mm: Place


@dataclass(frozen=True, slots=True)
class PointsOf:
    """Region of the points that another feature used."""

    feature: str


@dataclass(frozen=True, slots=True)
class FaceAt:
    """Face that goes on from one place, as far as it reaches: a pixel, or a place in part coordinates.

    Of a sphere or a cylinder that surface is meant, of a section or a deviation whichever is there, else a plane face.
    """

    at_px: Pixel | None = None
    at_mm: Place | None = None

    def __post_init__(self) -> None:
        if (self.at_px is None) == (self.at_mm is None):
            raise ValueError("a face is at a pixel or at a place, one of the two")


Region: TypeAlias = Auto | Polygon | InSphere | InBox | PointsOf | FaceAt


@dataclass(frozen=True, slots=True)
class Filters:
    """Filters of the points of a region, and the length in mm below which form counts as noise.

    Parameters
    ----------
    sigma_max_mm
        Points with a larger standard uncertainty are left out; None: none.
    margin_mm
        Points nearer to the edge of a plane face are left out: stripes are biased there.
    outliers
        Points this many robust standard deviations from the fitted surface are left out.
    cell_mm
        Forms shorter than this count as noise; 0: than a fifth of the face's side. An orientation is that of the means
        over cells of this side; 0: of single points, their noise included.
    """

    sigma_max_mm: float | None = None
    margin_mm: float = 1.5
    outliers: float = 4.685
    cell_mm: float = 0.0


@dataclass(frozen=True, slots=True)
class Cut:
    """Measurement in a section, between positions in mm along it.

    `kind` "height": of the line over `second` above that over `first`, square to it. "distance": from the middle of one
    stretch to the middle of the other. "radius": of the circle over `first`.
    """

    name: str
    kind: Literal["height", "distance", "radius"]
    first: tuple[float, float]
    second: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Section:
    """Cross-section: the plane through the camera's ray of two pixels, or through a place of part coordinates.

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
    """Comparison with a nominal surface.

    Parameters
    ----------
    nominal
        Name of the file, STEP or STL in mm.
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
class Position:
    """Place in part coordinates where a cylinder's axis or a sphere's centre should be."""

    at_mm: Place = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class FeatureSpec:
    """Feature to be inspected.

    Parameters
    ----------
    name
        As the technician calls it; unique in a plan.
    kind
        Its name among `core.inspect.plan.kinds`.
    regions
        Where its points are: one, or two (upper, lower) for a thickness, or one for each level of steps.
    of
        Names of the features it is derived from.
    filters
        Which points are used.
    limits
        What is asked of its results, by their names (`core.inspect.plan.kinds.results_of`). Of steps the limits
        "height" go for each step, about its own nominal height.
    nominal_heights
        Of the steps in mm, from the lowest up.
    over
        Steps: each over the "lowest" level, or over the "previous" one.
    section, deviation, position
        Of these kinds.
    """

    name: str
    kind: str
    regions: tuple[Region, ...] = (Auto(),)
    of: tuple[str, ...] = ()
    filters: Filters = Filters()
    limits: tuple[tuple[str, Limits], ...] = ()
    nominal_heights: tuple[float, ...] = ()
    over: Literal["lowest", "previous"] = "lowest"
    section: Section | None = None
    deviation: Deviation | None = None
    position: Position | None = None

    @property
    def needs(self) -> tuple[str, ...]:
        """Names of all other features that have to be measured before this feature."""
        return (*self.of, *(region.feature for region in self.regions if isinstance(region, PointsOf)))

    @property
    def in_part_coordinates(self) -> bool:
        """Whether the feature is defined in part coordinates, so that these must be known before it is measured."""
        placed = self.section is not None and self.section.line_px is None
        framed = self.deviation is not None and self.deviation.align == "frame"
        return placed or framed or self.position is not None or any(map(_is_placed, self.regions))

    def limits_of(self, result: str) -> Limits | None:
        """Return the limits of the result called "diameter", "height 2" and so on; None if it has none."""
        asked = dict(self.limits)
        name, _, number = result.rpartition(" ")
        if not self.nominal_heights or name not in asked or not number.isdigit():
            return asked.get(result)
        step = int(number)
        if step > len(self.nominal_heights):
            return None
        return replace(asked[name], nominal=self.nominal_heights[step - 1])


def _is_placed(region: Region) -> bool:
    """Whether a region is in part coordinates."""
    return isinstance(region, InSphere | InBox) or (isinstance(region, FaceAt) and region.at_mm is not None)
