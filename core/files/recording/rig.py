"""rig.toml: the targets, the laser and the gauge of a recording set, read and written."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from core.acquire.channel import Channel, PlainChannel, is_difference
from core.calibrate.board_shape import BoardTolerance
from core.calibrate.change import STABLE, Stability
from core.calibrate.drift import NO_DRIFT, Air, Drift
from core.errors import InputError, WrongValue
from core.files.complaints import Clash, checked
from core.files.reading import read_toml
from core.files.tables import OptionalDay, ShortText
from core.files.toml_text import toml_text
from core.image.mosaic import Pattern
from core.image.targets import BlackSquare, Charuco, Checkerboard, CircleGrid, Rectangle, Target
from core.image.targets.kinds import DICTIONARIES
from core.inspect.uncertainty.part import MATERIALS, Part, TargetTemperature
from core.messages import Message, label
from core.model.arrays import Array, frozen_array, set_field
from core.model.certificate import Certificate
from core.settings.rig import RIG
from core.settings.setting import Number

_WRITE_ONE = Message("advice.write_as_in_manual", "write one as the manual shows, page Recording sets and files")
_MISSING = Message("rig.missing", "the file is missing; it says what the targets and the laser are")

# The description of a field ends the sentence "… is <value>, not <description>".
_Count = Annotated[int, Field(ge=3, le=500)]
_Length = Annotated[float, Field(gt=0, le=5000, allow_inf_nan=False)]
SMALLEST_PRINTED_MM = 0.5
"""A smaller square, pitch or side of a target is one in metres: half a metre away it would be a pixel or two."""
_A_LENGTH = label("a length in mm above 0 and at most 5000")
_TWO_COUNTS = label("two whole numbers from 3 to 500, [columns, rows]")
_Vertex = Annotated[list[Annotated[float, Field(allow_inf_nan=False)]], Field(min_length=2, max_length=2)]
_Polygon = Annotated[list[_Vertex], Field(min_length=3)]
_A_PLAIN_CHANNEL = '"red", "green" or "blue"'
_A_CHANNEL = label('"red", "green", "blue", or a laser\'s colour: "red-green", "green-red" or "blue-red"')
_A_MOSAIC = label('"RGGB", "BGGR", "GRBG" or "GBRG"')
_A_POLYGON = label("a list of three or more [u, v] in pixels")
_FOUR_CORNERS = label("a list of four [u, v] in pixels")
_TWO_LENGTHS = label("two lengths in mm above 0 and at most 5000, [width, height]")
_Celsius = Annotated[float, Field(ge=-50, le=200, allow_inf_nan=False)]
_UOfCelsius = Annotated[float, Field(ge=0, le=200, allow_inf_nan=False)]
_Alpha = Annotated[float, Field(ge=-1e-4, le=1e-3, allow_inf_nan=False)]
_UOfAlpha = Annotated[float, Field(ge=0, le=1e-3, allow_inf_nan=False)]
_A_TEMPERATURE = label("a temperature in °C from −50 to 200")
_A_TEMPERATURE_DIFFERENCE = label("a temperature, 0 to 200 K")
_AN_ALPHA = label("an expansion coefficient in 1/K, as 11.5e-6")


def _stated(table: str, key: str, default: Any = None) -> Any:
    """The field of a number that is a row of the settings; without a `default` it must be there."""
    kind = RIG[table][key].kind
    assert isinstance(kind, Number)
    limits: dict[str, Any] = {"ge" if kind.also_at else "gt": kind.above, "le": kind.most}
    if kind.decimals:
        limits["allow_inf_nan"] = False
    return Field(default, description=kind.stated, **limits)


class Table(BaseModel):
    """Table of a file that a person writes: unknown keys are errors."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class _Printed(Table):
    """What any target may say of how it was made."""

    scale_sd: float | None = Field(
        None, ge=0, le=0.1, allow_inf_nan=False, description="a standard uncertainty as a share of the size, 0 to 0.1"
    )
    flatness_mm: float | None = Field(None, ge=0, le=100, allow_inf_nan=False, description="a length in mm, 0 to 100")
    margin_mm: float | None = Field(None, ge=0, le=5000, allow_inf_nan=False, description="a length in mm, 0 to 5000")
    celsius: _Celsius | None = Field(None, description=_A_TEMPERATURE)
    u_celsius: _UOfCelsius | None = Field(None, description=_A_TEMPERATURE_DIFFERENCE)
    alpha_per_K: _Alpha | None = Field(None, description=_AN_ALPHA)  # noqa: N815  (as units are written)
    u_alpha_per_K: _UOfAlpha | None = Field(None, description=_AN_ALPHA)  # noqa: N815
    certificate: ShortText = ""
    laboratory: ShortText = ""
    due: OptionalDay = None

    @model_validator(mode="after")
    def _with_u(self) -> _Printed:
        require_pairs(self, WARMTH)
        return self

    @model_validator(mode="after")
    def _in_millimetres(self) -> _Printed:
        for key in ("square_mm", "pitch_mm", "side_mm", "size_mm"):
            stated = getattr(self, key, None)
            value = min(stated) if isinstance(stated, list) else stated
            if value is not None and value < SMALLEST_PRINTED_MM:
                raise Clash(
                    key,
                    Message(
                        "rig.in_metres",
                        "is {value:g}, and no target is that small; lengths are in mm: is it {in_mm:g}?",
                        value=value,
                        in_mm=1e3 * value,
                    ),
                )
        return self

    def of_certificate(self) -> Certificate:
        return Certificate(self.certificate, self.laboratory, self.due)

    def temperature(self) -> TargetTemperature:
        return TargetTemperature(self.celsius, self.u_celsius, self.alpha_per_K, self.u_alpha_per_K)


WARMTH = (("celsius", "u_celsius"), ("alpha_per_K", "u_alpha_per_K"))
"""Keys of a target that go together: how warm it was and how it expands, each with its standard uncertainty."""


CERTIFIED = ("certificate", "laboratory", "due")
"""Keys of a target that its certificate is named by."""


def require_pairs(table: BaseModel, pairs: Sequence[tuple[str, str]]) -> None:
    """Raise Clash if in one of the `pairs` of keys of a table one is stated and the other is not."""
    for pair in pairs:
        missing = [name for name in pair if getattr(table, name) is None]
        if len(missing) == 1:
            other = next(name for name in pair if name != missing[0])
            raise Clash(
                missing[0],
                Message(
                    "rig.go_together",
                    "is missing; {value} and {other} go together, give both or neither",
                    value=missing[0],
                    other=other,
                ),
            )


class _Checkerboard(_Printed):
    kind: Literal["checkerboard"]
    inner_corners: list[_Count] = Field(min_length=2, max_length=2, description=_TWO_COUNTS)
    square_mm: _Length = Field(description=_A_LENGTH)

    def target(self) -> Target:
        columns, rows = self.inner_corners
        return Checkerboard(columns, rows, self.square_mm)


class _Charuco(_Printed):
    kind: Literal["charuco"]
    squares: list[_Count] = Field(min_length=2, max_length=2, description=_TWO_COUNTS)
    square_mm: _Length = Field(description=_A_LENGTH)
    marker_mm: _Length = Field(description="a length in mm above 0 and at most 5000, smaller than square_mm")
    dictionary: str = Field(
        "DICT_4X4_50", pattern=rf"^(?i:{'|'.join(DICTIONARIES)})$", description='one like "DICT_4X4_50"'
    )
    first_id: int = Field(0, ge=0, le=999, description="a whole number, 0 to 999")

    @model_validator(mode="after")
    def _marker_inside_square(self) -> _Charuco:
        if self.marker_mm >= self.square_mm:
            raise Clash(
                "marker_mm",
                Message(
                    "rig.marker_too_large",
                    "is {marker_mm:g}, not smaller than square_mm = {square_mm:g}",
                    marker_mm=self.marker_mm,
                    square_mm=self.square_mm,
                ),
            )
        return self

    def target(self) -> Target:
        columns, rows = self.squares
        return Charuco(columns, rows, self.square_mm, self.marker_mm, self.dictionary.upper(), self.first_id)


class _CircleGrid(_Printed):
    kind: Literal["circle_grid"]
    circles: list[_Count] = Field(min_length=2, max_length=2, description=_TWO_COUNTS)
    pitch_mm: _Length = Field(description=_A_LENGTH)
    asymmetric: bool = Field(False, description="true or false")

    def target(self) -> Target:
        columns, rows = self.circles
        return CircleGrid(columns, rows, self.pitch_mm, self.asymmetric)


class _BlackSquare(_Printed):
    kind: Literal["black_square"]
    side_mm: _Length = Field(description=_A_LENGTH)

    def target(self) -> Target:
        return BlackSquare(self.side_mm)


class _Rectangle(_Printed):
    kind: Literal["rectangle"]
    size_mm: list[_Length] = Field(min_length=2, max_length=2, description=_TWO_LENGTHS)
    line_mm: _Length | None = Field(None, description=_A_LENGTH)
    corners_px: list[_Vertex] | None = Field(None, min_length=4, max_length=4, description=_FOUR_CORNERS)

    def target(self) -> Target:
        width, height = self.size_mm
        corners = None if self.corners_px is None else tuple((u, v) for u, v in self.corners_px)
        return Rectangle(width, height, self.line_mm or 0.0, corners)


_CameraTarget: TypeAlias = Annotated[_Checkerboard | _Charuco | _CircleGrid, Field(discriminator="kind")]
TargetTable: TypeAlias = Annotated[_Checkerboard | _Charuco | _CircleGrid | _BlackSquare, Field(discriminator="kind")]


_NAME = r"^[A-Za-z0-9][A-Za-z0-9_-]{0,39}$"
_A_NAME = label("a name of at most 40 letters, digits, - and _")


class _KnownPlane(Table):
    """What a table [known_planes.NAME] says beside its target."""

    print_of: str | None = Field(None, description='"plane_target" or the name of another known plane')
    region_px: _Polygon | None = Field(None, description=_A_POLYGON)


class _KnownCheckerboard(_KnownPlane, _Checkerboard): ...


class _KnownCharuco(_KnownPlane, _Charuco): ...


class _KnownCircleGrid(_KnownPlane, _CircleGrid): ...


class _KnownBlackSquare(_KnownPlane, _BlackSquare): ...


class _KnownRectangle(_KnownPlane, _Rectangle): ...


_KnownPlaneTable: TypeAlias = Annotated[
    _KnownCheckerboard | _KnownCharuco | _KnownCircleGrid | _KnownBlackSquare | _KnownRectangle,
    Field(discriminator="kind"),
]


class _LaserFan(Table):
    lines: int = _stated("laser_fan", "lines", ...)
    angle_deg: float | None = _stated("laser_fan", "angle_deg")

    @model_validator(mode="after")
    def _angle_of_a_pencil(self) -> _LaserFan:
        if self.lines > 1 and self.angle_deg is None:
            raise Clash(
                "angle_deg",
                Message(
                    "rig.angle_missing",
                    "is missing; a fan of several lines needs the angle between neighbouring lines",
                ),
            )
        return self


class GaugeTable(Table):
    """Table [gauge]."""

    nominal_mm: float | None = _stated("gauge", "nominal_mm")
    tolerance_mm: float | None = _stated("gauge", "tolerance_mm")
    upper_polygon_px: _Polygon | None = Field(None, description=_A_POLYGON)
    lower_polygon_px: _Polygon | None = Field(None, description=_A_POLYGON)

    @model_validator(mode="after")
    def _pairs(self) -> GaugeTable:
        for one, other in (("nominal_mm", "tolerance_mm"), ("upper_polygon_px", "lower_polygon_px")):
            missing = [name for name in (one, other) if getattr(self, name) is None]
            if len(missing) == 1:
                raise Clash(
                    missing[0],
                    Message(
                        "rig.go_together",
                        "is missing; {value} and {other} go together, give both or neither",
                        value=one,
                        other=other,
                    ),
                )
        return self


_Above = Annotated[float, Field(gt=0, allow_inf_nan=False)]
_A_NUMBER = label("a number above 0")
_NOT_NEGATIVE = label("a number not below 0")
_Count1 = Annotated[int, Field(ge=1)]
_A_COUNT = label("a whole number above 0")


class PlanTable(Table):
    """Table [plan] of a rig that is not built yet, for `trisect plan`; other commands ignore it."""

    pixels: list[_Count1] | None = Field(
        None, min_length=2, max_length=2, description="two whole numbers, [width, height] of the pictures"
    )
    pixel_um: _Above | None = Field(None, description="the side of a pixel in µm, above 0")
    focal_mm: _Above | None = Field(None, description="a focal length in mm above 0")
    focal_px: _Above | None = Field(None, description="a focal length in pixels above 0")
    distance_mm: _Length | None = Field(None, description=_A_LENGTH)
    baseline_mm: _Length | None = Field(None, description=_A_LENGTH)
    hand_baseline_mm: _Length | None = Field(None, description=_A_LENGTH)
    heights_mm: list[_Length] | None = Field(None, min_length=1, max_length=20, description="a list of lengths in mm")
    block_mm: list[_Length] | None = Field(
        None, min_length=2, max_length=2, description="two lengths in mm, [along, across] of the blocks"
    )
    views: _Count1 | None = Field(None, description=_A_COUNT)
    poses: _Count1 | None = Field(None, description=_A_COUNT)
    sweeps: _Count1 | None = Field(None, description=_A_COUNT)
    check_poses: int | None = Field(None, ge=0, le=20, description="a whole number, 0 to 20")
    corner_deg: float | None = Field(None, ge=60, le=170, allow_inf_nan=False, description="an angle from 60 to 170")
    speckle: float | None = Field(None, ge=0, allow_inf_nan=False, description="a contrast not below 0")
    stripe_grey: _Above | None = Field(None, description=_A_NUMBER)
    stripe_sigma_mm: _Length | None = Field(None, description=_A_LENGTH)
    electrons_per_grey: _Above | None = Field(None, description=_A_NUMBER)
    read_noise_grey: float | None = Field(None, ge=0, allow_inf_nan=False, description=_NOT_NEGATIVE)
    ambient_grey: float | None = Field(None, ge=0, allow_inf_nan=False, description=_NOT_NEGATIVE)

    @model_validator(mode="after")
    def _one_focal_length(self) -> PlanTable:
        if self.focal_mm is not None and self.focal_px is not None:
            raise Clash(
                "focal_px",
                Message("rig.focal_length_too_many", "is one focal length too many; give focal_mm or focal_px"),
            )
        return self


_Urad = Annotated[float, Field(ge=0, le=1e5, allow_inf_nan=False)]
_Um = Annotated[float, Field(ge=0, le=1e4, allow_inf_nan=False)]
_Px = Annotated[float, Field(ge=0, le=100, allow_inf_nan=False)]
_Ppm = Annotated[float, Field(ge=0, le=1e4, allow_inf_nan=False)]
_AN_ANGLE = label("an angle in µrad, 0 to 100000")
_A_SHIFT = label("a length in µm, 0 to 10000")
_PIXELS = label("a number of pixels, 0 to 100")
_A_SHARE = label("a share in 10⁻⁶, 0 to 10000")


class _Rate(Table):
    """[stability.per_kelvin] and [stability.per_hour]: what is not stated does not change so."""

    turn_urad: _Urad = Field(0.0, description=_AN_ANGLE)
    shift_um: _Um = Field(0.0, description=_A_SHIFT)
    centre_px: _Px = Field(0.0, description=_PIXELS)
    focal_ppm: _Ppm = Field(0.0, description=_A_SHARE)

    def stability(self) -> Stability:
        return Stability(self.turn_urad / 1e6, self.shift_um / 1e3, self.centre_px, self.focal_ppm / 1e6)


class _Stability(Table):
    """[stability]: how far the rig may have changed since its calibration, as standard uncertainties."""

    turn_urad: _Urad | None = Field(None, description=_AN_ANGLE)
    shift_um: _Um | None = Field(None, description=_A_SHIFT)
    centre_px: _Px | None = Field(None, description=_PIXELS)
    focal_ppm: _Ppm | None = Field(None, description=_A_SHARE)
    per_kelvin: _Rate | None = Field(None, description="a table with turn_urad, shift_um, centre_px or focal_ppm")
    per_hour: _Rate | None = Field(None, description="a table with turn_urad, shift_um, centre_px or focal_ppm")

    @model_validator(mode="after")
    def _all_or_none(self) -> _Stability:
        missing = [name for name in _TOTALS if getattr(self, name) is None]
        rates = self.per_kelvin is not None or self.per_hour is not None
        if missing and not (rates and len(missing) == len(_TOTALS)):
            raise Clash(
                missing[0],
                Message(
                    "rig.stability_in_part", "is missing; {names} go together, give all of them", names=tuple(_TOTALS)
                ),
            )
        return self

    def stability(self) -> Stability | None:
        stated = {name: value for name in _TOTALS if (value := getattr(self, name)) is not None}
        return _Rate(**stated).stability() if stated else None

    def drift(self) -> Drift:
        rates = (STABLE if one is None else one.stability() for one in (self.per_kelvin, self.per_hour))
        return Drift(*rates)


_TOTALS = ("turn_urad", "shift_um", "centre_px", "focal_ppm")


class _Air(Table):
    """[air]: how warm it was around the rig."""

    calibrated_celsius: _Celsius | None = Field(None, description=_A_TEMPERATURE)
    checked_celsius: _Celsius | None = Field(None, description=_A_TEMPERATURE)
    scanned_celsius: _Celsius | None = Field(None, description=_A_TEMPERATURE)

    def air(self) -> Air:
        return Air(self.calibrated_celsius, self.checked_celsius, self.scanned_celsius)


class _Camera(Table):
    """[camera]: what the camera's data sheet says."""

    row_time_us: float = _stated("camera", "row_time_us", ...)


class _Channels(Table):
    """[channels]: what each step looks at, where that is not the `channel` of all."""

    camera: PlainChannel | None = Field(None, description=_A_PLAIN_CHANNEL)
    planes: Channel | None = Field(None, description=_A_CHANNEL)
    scan: Channel | None = Field(None, description=_A_CHANNEL)


_HOURS = Annotated[float, Field(ge=0, le=24, allow_inf_nan=False)]


class _Validity(Table):
    """[validity]: how long a calibration holds, and how long a check of it."""

    calibration_days: float | None = _stated("validity", "calibration_days")
    check_days: float | None = _stated("validity", "check_days")
    fresh_hours: _HOURS | None = Field(None, description=label("a number of hours, 0 to 24"))


class _Check(Table):
    """[check]: what a whole run does with a check that fails."""

    readjust: bool = Field(False, description="true or false")


_SD = Annotated[float, Field(ge=0, le=100, allow_inf_nan=False)]
_AN_SD = label("a standard uncertainty in mm, 0 to 100")
_PAIRS = (
    ("offset_mm", "offset_sd_mm"),
    ("spray_mm", "spray_sd_mm"),
    ("alpha_per_K", "u_alpha_per_K"),
    ("celsius", "u_celsius"),
)
"""Keys of [part] that go together: an estimate and its standard uncertainty."""


class _Part(Table):
    """[part]: what is known of the part."""

    material: str | None = Field(None, description=", ".join(f'"{name}"' for name in MATERIALS))
    offset_mm: float | None = Field(None, ge=-10, le=10, allow_inf_nan=False, description="a length in mm, −10 to 10")
    offset_sd_mm: _SD | None = Field(None, description=_AN_SD)
    spray_mm: float | None = Field(None, ge=-10, le=10, allow_inf_nan=False, description="a length in mm, −10 to 10")
    spray_sd_mm: _SD | None = Field(None, description=_AN_SD)
    alpha_per_K: _Alpha | None = Field(None, description=_AN_ALPHA)  # noqa: N815  (as units are written)
    u_alpha_per_K: _UOfAlpha | None = Field(None, description=_AN_ALPHA)  # noqa: N815
    celsius: _Celsius | None = Field(None, description=_A_TEMPERATURE)
    u_celsius: _UOfCelsius | None = Field(None, description=_A_TEMPERATURE_DIFFERENCE)

    @model_validator(mode="after")
    def _known(self) -> _Part:
        if self.material is not None and self.material not in MATERIALS:
            raise Clash(
                "material",
                Message("rig.no_material", "is {value}, none of {known}", value=self.material, known=tuple(MATERIALS)),
            )
        require_pairs(self, _PAIRS)
        return self

    def part(self) -> Part:
        return Part(**{_PART_FIELDS.get(key, key): value for key, value in self.model_dump().items()})


_PART_FIELDS = {"alpha_per_K": "alpha", "u_alpha_per_K": "u_alpha"}
"""What keys of [part] are called inside, where that is something else."""


def part_table(part: Part) -> dict[str, Any]:
    """Make the table [part] of rig.toml for a measured part, with what is stated alone."""
    target = temperature_table(part.target)
    return _of_part_alone(part) | ({"target": target} if target else {})


def _of_part_alone(part: Part) -> dict[str, Any]:
    return _renamed({name: value for name, value in asdict(part).items() if name not in ("target", "layers")})


def temperature_table(target: TargetTemperature) -> dict[str, Any]:
    """Make the part of a target's table in rig.toml that states its temperature; without what is not stated."""
    return _renamed(asdict(target))


def as_calibrated_with(table: Mapping[str, Any]) -> dict[str, Any]:
    """Remove temperature and certificate from a target's table, on which no calibration rests."""
    left_out = {*(key for pair in WARMTH for key in pair), *CERTIFIED}
    return {key: value for key, value in table.items() if key not in left_out}


def _renamed(values: Mapping[str, Any]) -> dict[str, Any]:
    keys = {field: key for key, field in _PART_FIELDS.items()}
    return {keys.get(name, name): value for name, value in values.items() if value is not None}


def part_of(table: Mapping[str, Any], path: Path) -> Part:
    """Make the measured part that a table [part] describes; InputError that names `path` if it is wrong."""
    alone = {name: value for name, value in table.items() if name != "target"}
    target = checked(_Printed, dict(table.get("target", {})), path).temperature()
    return replace(checked(_Part, alone, path).part(), target=target)


class RigTables(Table):
    """Tables of rig.toml, and of project.json under "rig"; a step that needs a missing table raises an error."""

    camera_target: _CameraTarget | None = Field(None, description="a table [camera_target] with kind and sizes")
    plane_target: TargetTable | None = Field(None, description="a table [plane_target] with kind and sizes")
    laser_fan: _LaserFan | None = Field(None, description="a table [laser_fan] with lines and angle_deg")
    known_planes: dict[str, _KnownPlaneTable] | None = Field(
        None, description="tables [known_planes.NAME] with kind and sizes"
    )
    gauge: GaugeTable | None = Field(None, description="a table [gauge]")
    camera: _Camera | None = Field(None, description="a table [camera] with row_time_us")
    channel: Channel | None = Field(None, description=_A_CHANNEL)
    mosaic: Pattern | None = Field(None, description=_A_MOSAIC)
    channels: _Channels | None = Field(None, description="a table [channels] with camera, planes or scan")
    plan: PlanTable | None = Field(None, description="a table [plan]")
    stability: _Stability | None = Field(
        None, description="a table [stability] with turn_urad, shift_um, centre_px and focal_ppm"
    )
    air: _Air | None = Field(
        None, description="a table [air] with calibrated_celsius, checked_celsius or scanned_celsius"
    )
    validity: _Validity | None = Field(
        None, description="a table [validity] with calibration_days, check_days or fresh_hours"
    )
    check: _Check | None = Field(None, description="a table [check] with readjust")
    part: _Part | None = Field(None, description="a table [part]")
    reference_target: TargetTable | None = Field(None, description="a table [reference_target] with kind and sizes")
    name: str | None = Field(None, pattern=_NAME, description=_A_NAME)
    simulated: bool | None = Field(None, description="true or false")


TARGETS = ("camera_target", "plane_target", "reference_target")
"""The tables of rig.toml that describe a target."""
STEP_TABLES = ("camera_target", "plane_target")
"""The tables that one step or another cannot do without."""
PLANE_TARGET = "plane_target"


@dataclass(frozen=True, eq=False, slots=True)
class GaugeSpec:
    """Specification of the gauge: nominal value and tolerance in mm, faces as (N, 2) polygons in pixels."""

    nominal_mm: float | None = None
    tolerance_mm: float | None = None
    upper_polygon_px: Array | None = None
    lower_polygon_px: Array | None = None

    def __post_init__(self) -> None:
        for name in ("upper_polygon_px", "lower_polygon_px"):
            polygon = getattr(self, name)
            if polygon is not None:
                set_field(self, name, frozen_array(polygon, (None, 2), name))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, GaugeSpec):
            return NotImplemented
        return self._values() == other._values()

    def __hash__(self) -> int:
        return hash(self._values())

    def _values(self) -> tuple[object, ...]:
        polygons = (self.upper_polygon_px, self.lower_polygon_px)
        corners = [None if polygon is None else tuple(map(tuple, polygon.tolist())) for polygon in polygons]
        return self.nominal_mm, self.tolerance_mm, *corners


@dataclass(frozen=True, slots=True)
class Channels:
    """Channel of colour pictures for each step; None where it is the common one."""

    camera: PlainChannel | None = None
    planes: Channel | None = None
    scan: Channel | None = None


@dataclass(frozen=True, slots=True)
class Validity:
    """Days for which a calibration is valid, and a check of it; None: without limit.

    `fresh_hours` is within how many hours planes and scan are of one sitting; None: FRESH_HOURS of
    `core.calibrate.sitting`.
    """

    calibration_days: float | None = None
    check_days: float | None = None
    fresh_hours: float | None = None


@dataclass(frozen=True, slots=True)
class ReferenceTarget:
    """Target of known size, with the uncertainty of it."""

    target: Target
    board: BoardTolerance


@dataclass(frozen=True, slots=True)
class KnownPlaneTarget:
    """Target on a known plane, a board that lies beside the part during the scan.

    Parameters
    ----------
    target, board, margin_mm
        What is printed on it, how true that is, and how far the board goes on beyond it (None: not known).
    print_of
        Whose print it is, so that one error of size is common to both: "plane_target", or the name of another known
        plane. None: its own.
    region_px
        Polygon (u, v) in pixels within which the board lies in its pictures; None: anywhere.
    temperature
        Of the board during the scan, by which its size counts; without one it is as warm as the plane target was.
    certificate
        Which stands in the report.
    """

    target: Target
    board: BoardTolerance = field(default_factory=BoardTolerance)
    margin_mm: float | None = None
    print_of: str | None = None
    region_px: tuple[tuple[float, float], ...] | None = None
    temperature: TargetTemperature = field(default_factory=TargetTemperature)
    certificate: Certificate = field(default_factory=Certificate)


@dataclass(frozen=True, slots=True)
class Rig:
    """Content of rig.toml. `angle` between neighbouring lines is in rad (0 with one line).

    With 0 `lines` the rig has no fan: rig.toml states that by having no table [laser_fan].

    `camera_board` and `plane_board` say how true the two targets are, `plane_margin_mm` how far the plate of the second
    goes on beyond what is printed on it, None if that is not known. `channels` are those of steps that look at another
    channel of colour pictures than `channel`, see :meth:`channel_of`. `unstated` are the tables that rig.toml does not
    have: what they would say is as in the paper's rig, and no step may rest on it (:func:`require_tables`).
    """

    camera_target: Target
    plane_target: Target
    lines: int
    angle: float
    gauge: GaugeSpec | None = None
    channel: Channel | None = None
    camera_board: BoardTolerance = field(default_factory=BoardTolerance)
    plane_board: BoardTolerance = field(default_factory=BoardTolerance)
    plane_margin_mm: float | None = None
    unstated: frozenset[str] = frozenset()
    stability: Stability | None = None
    """How far it may have changed since its calibration; None: nothing is stated."""
    drift: Drift = NO_DRIFT
    """How much further for each kelvin and hour."""
    air: Air = field(default_factory=Air)
    """How warm it was."""
    validity: Validity = field(default_factory=Validity)
    name: str = ""
    """What its history is kept by; nothing: each calibration has a history of its own."""
    row_time_us: float | None = None
    """Time from one row of a picture to the next of a rolling shutter, 0 for a global one; None: not stated."""
    channels: Channels = Channels()
    mosaic: Pattern | None = None
    """The colour mosaic of raw pictures; None: pictures are no raw ones."""
    part: Part = field(default_factory=Part)
    """What is measured."""
    reference: ReferenceTarget | None = None
    """What the plane target's size is compared with in pictures of both; None: the camera's target."""
    readjust: bool = False
    """Whether a whole run re-adjusts camera and fan by a check that shows that they have changed."""
    certificates: Mapping[str, Certificate] = field(default_factory=dict, hash=False)
    """By the names of the targets' tables, the certificates that are stated; what they say is only reported."""
    simulated: bool | None = None
    """Whether the pictures are rendered by a program; None: not known."""
    known_planes: Mapping[str, KnownPlaneTarget] = field(default_factory=dict, hash=False)
    """By the names of their tables, the targets on known planes; one without a table is as the plane target."""

    @property
    def has_fan(self) -> bool:
        """Whether the rig has a fan of fixed lines."""
        return self.lines > 0

    @property
    def all_certificates(self) -> dict[str, Certificate]:
        """Stated certificates of targets and of known planes, by their tables: "known_planes.wall"."""
        of_boards = {f"known_planes.{name}": one.certificate for name, one in self.known_planes.items()}
        return {**self.certificates, **{name: one for name, one in of_boards.items() if one.stated}}

    @property
    def one_target(self) -> bool:
        """Whether the rig states the same target for calibrating camera and light planes."""
        stated = self.unstated.isdisjoint({"camera_target", "plane_target"})
        return stated and self.camera_target == self.plane_target

    def channel_of(self, part: str) -> Channel | None:
        """Return the colour channel stated for a part ("camera", "planes", "scan", "check"); None if none is.

        The camera's target cannot be seen in a difference of channels that is stated for all parts.
        """
        own: Channel | None = getattr(self.channels, "planes" if part == "check" else part, None)
        seen = own or self.channel
        return None if part == "camera" and is_difference(seen) else seen

    @property
    def live_channel(self) -> Channel | None:
        """Channel to which colour pictures of live cameras are reduced: one in which targets can be seen."""
        scan = self.channel_of("scan")
        return self.channel_of("camera") if is_difference(scan) else scan

    def with_channel(self, part: str, channel: Channel | None) -> Rig:
        """Set the colour channel in which pictures of `part` are read; None leaves it to be chosen from them."""
        now = {name: self.channel_of(name) for name in ("camera", "planes", "scan")}
        return replace(self, channel=None, channels=Channels(**(now | {part: channel})))  # type: ignore[arg-type]


def default_rig() -> Rig:
    """Make the rig of the published paper: checkerboard, black square, three laser lines 5° apart."""
    return Rig(Checkerboard(17, 12, 10.0), BlackSquare(60.0), lines=3, angle=math.radians(5.0))


def require_tables(rig: Rig, path: Path, *names: str) -> None:
    """Raise InputError if the rig.toml at `path` lacks one of the tables `names`."""
    for name in names:
        if name == "laser_fan" and not rig.has_fan:
            raise InputError(
                Message("rig.no_fan", "it has no table [laser_fan], which states that the rig has no fan"),
                where=path,
                todo=Message("advice.state_fan", "add the table with lines and angle_deg if the rig has one"),
            )
        if name in rig.unstated:
            wanted = RigTables.model_fields[name].description
            raise InputError(
                Message("file.field_missing", "{field} is missing; it must be {wanted}", field=name, wanted=wanted),
                where=path,
            )


def read_rig(path: Path) -> Rig:
    """Read and check a rig.toml as a rig; InputError if it is wrong, but a table may be missing.

    Raises
    ------
    InputError
        If it is missing, is no TOML, has an unknown key, lacks one in a table that is there, or a value has the wrong
        type or is absurd. The sentence names the file, the field and what is allowed.
    """
    return rig_of(read_rig_tables(path), path)


def read_rig_tables(path: Path) -> RigTables:
    """Read and check the tables of a rig.toml, a missing one as None; InputError if it is missing or wrong."""
    return checked(RigTables, _toml(path), path)


def _toml(path: Path) -> dict[str, Any]:
    return read_toml(path, missing=_MISSING, todo=_WRITE_ONE)


def rig_of(tables: RigTables, path: Path, within: str = "") -> Rig:
    """Make the rig that checked `tables` describe; messages name `path` and the field `within` it."""
    rig = default_rig()
    stated: dict[str, Any] = {}
    if tables.camera_target is not None:
        stated["camera_target"] = _target(path, f"{within}camera_target", tables.camera_target)
        stated["camera_board"] = _tolerance(tables.camera_target)
    if tables.plane_target is not None:
        stated["plane_target"] = _target(path, f"{within}plane_target", tables.plane_target)
        stated["plane_board"] = _tolerance(tables.plane_target)
        stated["plane_margin_mm"] = tables.plane_target.margin_mm
    if tables.reference_target is not None:
        reference = _target(path, f"{within}reference_target", tables.reference_target)
        stated["reference"] = ReferenceTarget(reference, _tolerance(tables.reference_target))
        if reference == stated.get("plane_target"):
            raise InputError(
                Message(
                    "rig.targets_alike",
                    "{name} is as the plane target is, and in one picture nothing would tell one from the other",
                    name=f"{within}reference_target",
                ),
                where=path,
                todo=Message(
                    "advice.another_reference", "take a target of another kind, of other counts or of another size"
                ),
            )
    fan = tables.laser_fan
    stated["lines"] = 0 if fan is None else fan.lines
    stated["angle"] = 0.0 if fan is None else math.radians(fan.angle_deg or 0.0)
    if tables.known_planes is not None:
        stated["known_planes"] = _known_planes(path, within, tables.known_planes)
    if tables.stability is not None:
        stated |= {"stability": tables.stability.stability(), "drift": tables.stability.drift()}
    if tables.air is not None:
        stated["air"] = tables.air.air()
    if tables.validity is not None:
        said = tables.validity
        stated["validity"] = Validity(said.calibration_days, said.check_days, said.fresh_hours)
    if tables.check is not None:
        stated["readjust"] = tables.check.readjust
    if tables.camera is not None:
        stated["row_time_us"] = tables.camera.row_time_us
    if tables.channels is not None:
        stated["channels"] = Channels(**tables.channels.model_dump())
    unstated = frozenset(name for name in STEP_TABLES if getattr(tables, name) is None)
    targets = {name: table for name in TARGETS if (table := getattr(tables, name)) is not None}
    certificates = {name: table.of_certificate() for name, table in targets.items()}
    stated["certificates"] = {name: one for name, one in certificates.items() if one.stated}
    return replace(
        rig,
        gauge=_gauge(tables.gauge) if tables.gauge else None,
        channel=tables.channel,
        mosaic=tables.mosaic,
        part=stated_part(tables),
        unstated=unstated,
        name=tables.name or "",
        simulated=tables.simulated,
        **stated,
    )


def stated_part(tables: RigTables) -> Part:
    """Make the measured part, with the plane target's temperature, that checked `tables` of rig.toml state."""
    part = Part() if tables.part is None else tables.part.part()
    return part if tables.plane_target is None else replace(part, target=tables.plane_target.temperature())


def rig_tables(rig: Rig) -> dict[str, Any]:
    """Make the tables of rig.toml for a rig, without those of which it states nothing; values are not checked."""
    tables = {
        "name": rig.name or None,
        "simulated": rig.simulated,
        "channel": rig.channel,
        "mosaic": rig.mosaic,
        "channels": _present(asdict(rig.channels)) or None,
        "camera_target": _target_table(rig.camera_target) | _tolerance_table(rig.camera_board),
        "plane_target": _target_table(rig.plane_target)
        | _tolerance_table(rig.plane_board)
        | _present({"margin_mm": rig.plane_margin_mm})
        | temperature_table(rig.part.target),
        "reference_target": None
        if rig.reference is None
        else _target_table(rig.reference.target) | _tolerance_table(rig.reference.board),
        "laser_fan": _present({"lines": rig.lines, "angle_deg": _in_degrees(rig.angle) if rig.angle else None})
        if rig.has_fan
        else None,
        "known_planes": {name: _known_plane_table(one) for name, one in rig.known_planes.items()} or None,
        "gauge": None if rig.gauge is None else _gauge_table(rig.gauge),
        "stability": _stability_tables(rig.stability, rig.drift) or None,
        "air": _present({f"{name}_celsius": value for name, value in asdict(rig.air).items()}) or None,
        "validity": _present(asdict(rig.validity)) or None,
        "camera": None if rig.row_time_us is None else {"row_time_us": rig.row_time_us},
        "check": {"readjust": True} if rig.readjust else None,
        "part": _of_part_alone(rig.part) or None,
    }
    for name, certificate in rig.certificates.items():
        if isinstance(table := tables[name], dict):
            table |= _certificate_table(certificate)
    return {name: table for name, table in _present(tables).items() if name not in rig.unstated}


def known_planes_to_toml(planes: Mapping[str, KnownPlaneTarget]) -> str:
    """Make the tables [known_planes.NAME] of rig.toml that state these boards."""
    return toml_text({"known_planes": {name: _known_plane_table(one) for name, one in planes.items()}})


def rig_to_toml(rig: Rig) -> str:
    """Make the text of rig.toml from which :func:`read_rig` reads the same rig."""
    return toml_text(rig_tables(rig))


def _target(path: Path, name: str, table: TargetTable | _KnownPlaneTable) -> Target:
    try:
        return table.target()
    except WrongValue as error:  # what only the target itself can judge, as a dictionary of markers
        raise InputError(
            Message("rig.target_wrong", "{name}: {reason}", name=name, reason=error.what), where=path
        ) from error


def known_planes_of(tables: RigTables, path: Path) -> dict[str, KnownPlaneTarget]:
    """Make the boards that the tables [known_planes.NAME] of a rig.toml at `path` state; InputError if one is wrong."""
    return _known_planes(path, "", tables.known_planes or {})


def _known_planes(path: Path, within: str, tables: Mapping[str, _KnownPlaneTable]) -> dict[str, KnownPlaneTarget]:
    for name in tables:
        if re.match(_NAME, name) is None:
            raise InputError(
                Message(
                    "rig.known_plane_name", '{field} has a table "{value}", not {wanted}',
                    field=f"{within}known_planes", value=name, wanted=_A_NAME,
                ),
                where=path,
                todo=Message("advice.rename_plane", "call its pictures so as well"),
            )  # fmt: skip
    planes = {name: _known_plane(path, f"{within}known_planes.{name}", table) for name, table in tables.items()}
    for name, plane in planes.items():
        printed = plane.print_of
        if printed in (None, PLANE_TARGET) or (printed in planes and planes[printed].print_of is None):
            continue
        raise InputError(
            Message(
                "rig.no_such_print",
                "{field} is {value}, neither plane_target nor a known plane that states no print_of itself",
                field=f"{within}known_planes.{name}.print_of",
                value=printed,
            ),
            where=path,
            todo=Message("advice.name_the_print", "name one of these, or leave it out: the print is one of its own"),
        )
    return planes


def _known_plane(path: Path, name: str, table: _KnownPlaneTable) -> KnownPlaneTarget:
    return KnownPlaneTarget(
        _target(path, name, table),
        _tolerance(table),
        table.margin_mm,
        table.print_of,
        None if table.region_px is None else tuple((u, v) for u, v in table.region_px),
        table.temperature(),
        table.of_certificate(),
    )


def _known_plane_table(plane: KnownPlaneTarget) -> dict[str, Any]:
    region = None if plane.region_px is None else [list(vertex) for vertex in plane.region_px]
    return {
        **_target_table(plane.target),
        **_tolerance_table(plane.board),
        **_present({"margin_mm": plane.margin_mm, "print_of": plane.print_of, "region_px": region}),
        **temperature_table(plane.temperature),
        **_certificate_table(plane.certificate),
    }


def _tolerance(table: TargetTable | _KnownPlaneTable) -> BoardTolerance:
    return BoardTolerance(table.flatness_mm, table.scale_sd)


def _tolerance_table(tolerance: BoardTolerance) -> dict[str, Any]:
    return _present({"flatness_mm": tolerance.flatness_mm, "scale_sd": tolerance.scale_sd})


def _certificate_table(certificate: Certificate) -> dict[str, Any]:
    due = None if certificate.due is None else certificate.due.isoformat()
    said = {"certificate": certificate.number, "laboratory": certificate.laboratory, "due": due}
    return {name: value for name, value in said.items() if value}


def _target_table(target: Target) -> dict[str, Any]:
    if isinstance(target, Checkerboard):
        return {
            "kind": "checkerboard",
            "inner_corners": [target.columns, target.rows],
            "square_mm": float(target.square_mm),
        }
    if isinstance(target, Charuco):
        return {
            "kind": "charuco",
            "squares": [target.columns, target.rows],
            "square_mm": float(target.square_mm),
            "marker_mm": float(target.marker_mm),
            "dictionary": target.dictionary_id,
            **({"first_id": target.first_id} if target.first_id else {}),
        }
    if isinstance(target, CircleGrid):
        return {
            "kind": "circle_grid",
            "circles": [target.columns, target.rows],
            "pitch_mm": float(target.pitch_mm),
            "asymmetric": target.asymmetric,
        }
    if isinstance(target, Rectangle):
        corners = None if target.corners_px is None else [list(corner) for corner in target.corners_px]
        return {
            "kind": "rectangle",
            "size_mm": [float(target.width_mm), float(target.height_mm)],
            **_present({"line_mm": target.line_mm or None, "corners_px": corners}),
        }
    return {"kind": "black_square", "side_mm": float(target.side_mm)}


def _gauge(table: GaugeTable) -> GaugeSpec:
    def array(polygon: list[list[float]] | None) -> Array | None:
        return None if polygon is None else np.array(polygon, dtype=np.float64)

    upper, lower = array(table.upper_polygon_px), array(table.lower_polygon_px)
    return GaugeSpec(table.nominal_mm, table.tolerance_mm, upper, lower)


def _gauge_table(gauge: GaugeSpec) -> dict[str, Any]:
    polygons = {"upper_polygon_px": gauge.upper_polygon_px, "lower_polygon_px": gauge.lower_polygon_px}
    return _present(
        {
            "nominal_mm": gauge.nominal_mm,
            "tolerance_mm": gauge.tolerance_mm,
            **{name: None if polygon is None else polygon.tolist() for name, polygon in polygons.items()},
        }
    )


def _stability_tables(stability: Stability | None, drift: Drift) -> dict[str, Any]:
    rates = {"per_kelvin": drift.per_kelvin, "per_hour": drift.per_hour}
    stated = {name: _stability_table(rate) for name, rate in rates.items() if rate != STABLE}
    return {**({} if stability is None else _stability_table(stability)), **stated}


def _stability_table(stability: Stability) -> dict[str, Any]:
    return {
        "turn_urad": round(stability.turn * 1e6, 6),
        "shift_um": round(stability.shift_mm * 1e3, 6),
        "centre_px": stability.centre_px,
        "focal_ppm": round(stability.focal_share * 1e6, 6),
    }


def _present(table: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if value is not None}


def _in_degrees(angle: float) -> float:
    """The shortest number of degrees that is `angle` in rad to the last bit, if there is one."""
    degrees = math.degrees(angle)
    near = (degrees, math.nextafter(degrees, 0), math.nextafter(degrees, math.inf))
    exact = [
        value for value in (*(round(degrees, digits) for digits in range(16)), *near) if math.radians(value) == angle
    ]
    return exact[0] if exact else degrees
