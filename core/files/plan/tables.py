"""The tables of plan.toml, checked key by key."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from core.errors import WrongValue
from core.files.complaints import Clash
from core.files.recording.rig import Table
from core.inspect.plan.kinds import every_kind, kind_named
from core.messages import Message, label

# The description of a field ends the sentence "… is <value>, not <description>".
_Number = Annotated[float, Field(allow_inf_nan=False)]
_Pair = Annotated[list[_Number], Field(min_length=2, max_length=2)]
_Triple = Annotated[list[_Number], Field(min_length=3, max_length=3)]
_Above = Annotated[float, Field(gt=0, le=5000, allow_inf_nan=False)]
_NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
_A_LENGTH = label("a length in mm above 0 and at most 5000")
_A_NUMBER = label("a finite number")
_NOT_BELOW_0 = label("a number not below 0")
_A_NAME = label("the name of a feature")
_Name = Annotated[str, Field(min_length=1, max_length=80)]


class RegionTable(Table):
    """Region of a feature's points: one of these keys."""

    number: int | None = Field(None, ge=1, le=8, description="a whole number from 1 to 8: the n-th largest plane face")
    polygon_px: list[_Pair] | None = Field(None, min_length=3, description="a list of three or more [u, v] in pixels")
    sphere_mm: list[_Number] | None = Field(
        None, min_length=4, max_length=4, description="four numbers [x, y, z, radius] in mm"
    )
    box_mm: list[_Triple] | None = Field(
        None, min_length=2, max_length=2, description="two corners [[x, y, z], [x, y, z]] in mm, the lower one first"
    )
    points_of: _Name | None = Field(None, description=_A_NAME)
    face_at_px: _Pair | None = Field(None, description="a place [u, v] in pixels on a face")
    face_at_mm: _Triple | None = Field(None, description="a place [x, y, z] in mm on a face, in part coordinates")

    @model_validator(mode="after")
    def _one_of_them(self) -> RegionTable:
        given = [key for key in type(self).model_fields if getattr(self, key) is not None]
        if len(given) != 1:
            named = " and ".join(given) or "none"
            raise Clash(
                "polygon_px",
                Message(
                    "inspection.one_kind_of_region",
                    "or number, sphere_mm, box_mm, points_of, face_at_px or face_at_mm is wanted, one of them, "
                    "not {named}",
                    named=named,
                ),
            )
        return self


class FiltersTable(Table):
    """Filters that select points of a region."""

    sigma_max_mm: _Above | None = Field(None, description=_A_LENGTH)
    margin_mm: _NotNegative = Field(1.5, description=_NOT_BELOW_0)
    outliers: float = Field(4.685, ge=2, le=100, allow_inf_nan=False, description="a number from 2 to 100")
    cell_mm: _NotNegative = Field(0.0, description=_NOT_BELOW_0)


class LimitsTable(Table):
    """Requirement on a result: a nominal value with ± a tolerance, or with a lower and an upper deviation."""

    nominal_mm: _Number | None = Field(None, description=_A_NUMBER)
    tolerance_mm: _NotNegative | None = Field(None, description=_NOT_BELOW_0)
    lower_mm: _Number | None = Field(None, description=_A_NUMBER)
    upper_mm: _Number | None = Field(None, description=_A_NUMBER)
    nominal_deg: _Number | None = Field(None, description=_A_NUMBER)
    tolerance_deg: _NotNegative | None = Field(None, description=_NOT_BELOW_0)
    lower_deg: _Number | None = Field(None, description=_A_NUMBER)
    upper_deg: _Number | None = Field(None, description=_A_NUMBER)

    @property
    def in_degrees(self) -> bool:
        """Whether these limits are of an angle, in degrees, and not of a length."""
        return any(getattr(self, key) is not None for key in type(self).model_fields if key.endswith("_deg"))

    @model_validator(mode="after")
    def _fit_together(self) -> LimitsTable:
        unit = "deg" if self.in_degrees else "mm"
        given = {key for key in type(self).model_fields if getattr(self, key) is not None}
        if any(not key.endswith(unit) for key in given):
            raise Clash(
                "nominal_mm",
                Message(
                    "inspection.limit_units",
                    "is of a length and nominal_deg of an angle; give those of one unit",
                ),
            )
        sides = {f"lower_{unit}", f"upper_{unit}"} & given
        if f"tolerance_{unit}" in given and sides:
            raise Clash(
                f"tolerance_{unit}",
                Message("inspection.limit_twice", "is one limit too many; give it, or lower and upper deviations"),
            )
        if f"tolerance_{unit}" not in given and not sides:
            raise Clash(
                f"tolerance_{unit}",
                Message("inspection.limit_missing", "is missing; without a limit nothing can be decided"),
            )
        lower, upper = getattr(self, f"lower_{unit}"), getattr(self, f"upper_{unit}")
        if lower is not None and upper is not None and lower > upper:
            raise Clash(
                f"lower_{unit}",
                Message(
                    "inspection.above_upper",
                    "is {lower:g}, above upper_{unit} = {upper:g}",
                    lower=lower,
                    unit=unit,
                    upper=upper,
                ),
            )
        return self


class CutTable(Table):
    """Table of one measurement in a section."""

    name: _Name = Field(description="a name")
    kind: Literal["height", "distance", "radius"] = Field(description='"height", "distance" or "radius"')
    first_mm: _Pair = Field(description="two positions [from, to] in mm along the section")
    second_mm: _Pair = Field(default_factory=lambda: [0.0, 0.0], description="two positions [from, to] in mm")


class SectionTable(Table):
    """Table of a cross-section."""

    line_px: list[_Pair] | None = Field(None, min_length=2, max_length=2, description="two pixels [[u, v], [u, v]]")
    point_mm: _Triple | None = Field(None, description="a place [x, y, z] in mm, in part coordinates")
    normal: _Triple | None = Field(None, description="a direction [x, y, z] in part coordinates")
    half_width_mm: _Above = Field(1.0, description=_A_LENGTH)
    step_mm: _Above = Field(0.5, description=_A_LENGTH)
    cuts: list[CutTable] = Field(default_factory=list, description="a list of tables with name, kind and first_mm")

    @model_validator(mode="after")
    def _one_plane(self) -> SectionTable:
        if (self.line_px is None) == (self.point_mm is None or self.normal is None):
            raise Clash(
                "line_px",
                Message("inspection.cut_twice", "or point_mm with normal says where to cut; give one of the two"),
            )
        return self


class DeviationTable(Table):
    """Table of a comparison with a nominal surface."""

    nominal: str = Field(min_length=1, description="the name of a STEP file, or of an STL file in mm, beside this file")
    align: Literal["best fit", "frame", "as measured"] = Field(
        "best fit", description='"best fit", "frame" or "as measured"'
    )
    tolerance_mm: _Above = Field(0.1, description=_A_LENGTH)
    reach_mm: _Above = Field(2.0, description=_A_LENGTH)


class PositionTable(Table):
    """Table of the nominal position of an axis or a centre."""

    at_mm: _Triple = Field(description="a place [x, y, z] in mm, in part coordinates")


class FeatureTable(Table):
    """Table [[feature]]."""

    name: _Name = Field(description="a name of 1 to 80 characters")
    kind: str = Field(description='a kind of feature, as "plane"')
    region: RegionTable | Literal["auto"] | None = Field(None, description='a table as { polygon_px = … }, or "auto"')
    regions: list[RegionTable | Literal["auto"]] | None = Field(
        None, max_length=20, description="a list of regions: upper and lower face, or levels"
    )
    of: list[_Name] = Field(default_factory=list, description="a list of names of features")
    filters: FiltersTable | None = Field(None, description="a table")
    limits: dict[str, LimitsTable] = Field(default_factory=dict, description="a table of limits by result")
    nominal_heights_mm: list[_Number] = Field(default_factory=list, description="a list of heights in mm")
    over: Literal["lowest", "previous"] = Field("lowest", description='"lowest" or "previous"')
    section: SectionTable | None = Field(None, description="a table")
    deviation: DeviationTable | None = Field(None, description="a table")
    position: PositionTable | None = Field(None, description="a table")

    @field_validator("kind")
    @classmethod
    def _known(cls, kind: str) -> str:
        try:
            return kind_named(kind).name
        except KeyError as error:
            known = tuple(one.name for one in every_kind())
            what = Message(
                "feature.no_such_kind", 'there is no kind of feature "{kind}"; the kinds are {known:and}',
                kind=kind, known=known,
            )  # fmt: skip
            raise WrongValue(what) from error

    @model_validator(mode="after")
    def _region_or_regions(self) -> FeatureTable:
        if self.region is not None and self.regions is not None:
            raise Clash("regions", Message("inspection.region_twice", "is one too many; give region or regions"))
        return self


class FrameTable(Table):
    """Table [frame]."""

    primary: _Name = Field(description=_A_NAME)
    secondary: _Name = Field(description=_A_NAME)
    tertiary: str = Field("", description=_A_NAME)


_Celsius = Annotated[float, Field(ge=-50, le=200, allow_inf_nan=False)]
_Alpha = Annotated[float, Field(ge=-1e-4, le=1e-3, allow_inf_nan=False)]
_A_TEMPERATURE = label("a temperature in °C from −50 to 200")
_AN_ALPHA = label("an expansion coefficient in 1/K, as 11.5e-6")


class TemperatureTable(Table):
    """Table [temperature]."""

    part_celsius: _Celsius = Field(description=_A_TEMPERATURE)
    u_part_celsius: _NotNegative = Field(description=_NOT_BELOW_0)
    alpha_per_K: _Alpha = Field(description=_AN_ALPHA)  # noqa: N815  (as units are written)
    u_alpha_per_K: _NotNegative = Field(description=_NOT_BELOW_0)  # noqa: N815
    target_celsius: _Celsius = Field(20.0, description=_A_TEMPERATURE)
    u_target_celsius: _NotNegative = Field(0.0, description=_NOT_BELOW_0)
    target_alpha_per_K: _Alpha = Field(0.0, description=_AN_ALPHA)  # noqa: N815
    u_target_alpha_per_K: _NotNegative = Field(0.0, description=_NOT_BELOW_0)  # noqa: N815


class CauseTable(Table):
    """Table of one row of the budget of a master's measurement."""

    source: _Name = Field(description="what it comes from")
    u_mm: _NotNegative = Field(description=_NOT_BELOW_0)


class MasterTable(Table):
    """Table [master]: its measured value is given as numbers, or taken from an inspection.json of it."""

    name: _Name = Field(description="a name")
    certified_mm: _Above = Field(description=_A_LENGTH)
    u_certified_mm: _NotNegative = Field(description=_NOT_BELOW_0)
    features: list[_Name] = Field(min_length=1, description="a list of names of features")
    measured_mm: _Above | None = Field(None, description=_A_LENGTH)
    budget: list[CauseTable] = Field(default_factory=list, description="a list of { source, u_mm }")
    same_calibration: bool = Field(True, description="true or false")
    doubts: list[_Name] = Field(default_factory=list, description="a list of names of facts, as moved")
    result: str | None = Field(None, description="an inspection.json in which the master was measured")
    characteristic: str | None = Field(None, description="the name of a characteristic in it")

    @model_validator(mode="after")
    def _measured_once(self) -> MasterTable:
        if (self.measured_mm is None) == (self.result is None):
            raise Clash(
                "measured_mm",
                Message(
                    "inspection.master_measured_twice",
                    "or result says what the master measures; give one of the two",
                ),
            )
        if self.measured_mm is not None and not self.budget:
            raise Clash(
                "budget",
                Message(
                    "inspection.master_without_budget",
                    "is missing: how uncertain measured_mm is counts in every U; state it as in "
                    'budget = [{{ source = "measurement of the master", u_mm = 0.005 }}], or give result',
                ),
            )
        if (self.result is None) != (self.characteristic is None):
            raise Clash(
                "characteristic",
                Message("inspection.master_result_incomplete", "and result go together; give both or neither"),
            )
        return self


class PlanTables(Table):
    """Tables of plan.toml."""

    k: float = Field(default=2.0, ge=1, le=5, allow_inf_nan=False, description="a coverage factor from 1 to 5")
    frame: FrameTable | None = Field(default=None, description="a table [frame] with primary and secondary")
    temperature: TemperatureTable | None = Field(default=None, description="a table [temperature]")
    master: MasterTable | None = Field(default=None, description="a table [master]")
    feature: list[FeatureTable] = Field(default_factory=list, description="tables [[feature]]")
