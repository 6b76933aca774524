"""The tables of rig.toml, checked key by key."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, model_validator

from core.files.complaints import Clash
from core.image.targets import BlackSquare, Charuco, Checkerboard, CircleGrid, Target

# The description of a field ends the sentence "… is <value>, not <description>".
_Count = Annotated[int, Field(ge=3, le=500)]
_Length = Annotated[float, Field(gt=0, le=5000, allow_inf_nan=False)]
_A_LENGTH = "a length in mm above 0 and at most 5000"
_TWO_COUNTS = "two whole numbers from 3 to 500, [columns, rows]"
_Vertex = Annotated[list[Annotated[float, Field(allow_inf_nan=False)]], Field(min_length=2, max_length=2)]
_Polygon = Annotated[list[_Vertex], Field(min_length=3)]
_A_POLYGON = "a list of three or more [u, v] in pixels"


class Table(BaseModel):
    """A table of a file a person writes: unknown keys are misspelt ones."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class _Printed(Table):
    """What any target may say of how it was made."""

    scale_sd: float = Field(
        0.0, ge=0, le=0.1, allow_inf_nan=False, description="a standard uncertainty as a share of the size, 0 to 0.1"
    )
    flatness_mm: float | None = Field(None, ge=0, le=100, allow_inf_nan=False, description="a length in mm, 0 to 100")


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
    marker_mm: _Length = Field(description=_A_LENGTH + ", smaller than square_mm")
    dictionary: str = Field(
        "DICT_4X4_50", pattern=r"^DICT_(4X4|5X5|6X6|7X7)_(50|100|250|1000)$", description='one like "DICT_4X4_50"'
    )

    @model_validator(mode="after")
    def _marker_inside_square(self) -> _Charuco:
        if self.marker_mm >= self.square_mm:
            raise Clash("marker_mm", f"is {self.marker_mm:g}, not smaller than square_mm = {self.square_mm:g}")
        return self

    def target(self) -> Target:
        columns, rows = self.squares
        return Charuco(columns, rows, self.square_mm, self.marker_mm, self.dictionary)


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


_CameraTarget: TypeAlias = Annotated[_Checkerboard | _Charuco | _CircleGrid, Field(discriminator="kind")]
TargetTable: TypeAlias = Annotated[_Checkerboard | _Charuco | _CircleGrid | _BlackSquare, Field(discriminator="kind")]


class _LaserFan(Table):
    lines: int = Field(ge=1, le=20, description="a whole number from 1 to 20")
    angle_deg: float | None = Field(
        None, gt=0, le=45, allow_inf_nan=False, description="an angle between neighbouring lines above 0 and at most 45"
    )

    @model_validator(mode="after")
    def _angle_of_a_pencil(self) -> _LaserFan:
        if self.lines > 1 and self.angle_deg is None:
            raise Clash("angle_deg", "is missing; a fan of several lines needs the angle between neighbouring lines")
        return self


class GaugeTable(Table):
    """[gauge]."""

    nominal_mm: _Length | None = Field(None, description=_A_LENGTH)
    tolerance_mm: _Length | None = Field(None, description=_A_LENGTH)
    upper_polygon_px: _Polygon | None = Field(None, description=_A_POLYGON)
    lower_polygon_px: _Polygon | None = Field(None, description=_A_POLYGON)

    @model_validator(mode="after")
    def _pairs(self) -> GaugeTable:
        for one, other in (("nominal_mm", "tolerance_mm"), ("upper_polygon_px", "lower_polygon_px")):
            missing = [name for name in (one, other) if getattr(self, name) is None]
            if len(missing) == 1:
                raise Clash(missing[0], f"is missing; {one} and {other} go together, give both or neither")
        return self


_Above = Annotated[float, Field(gt=0, allow_inf_nan=False)]
_A_NUMBER = "a number above 0"
_NOT_NEGATIVE = "a number not below 0"
_Count1 = Annotated[int, Field(ge=1)]
_A_COUNT = "a whole number above 0"


class PlanTable(Table):
    """[plan]: what `trisect plan` wants to know of a rig that is not built yet; other commands pass it by."""

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
    speckle: float | None = Field(None, ge=0, allow_inf_nan=False, description="a contrast not below 0")
    stripe_grey: _Above | None = Field(None, description=_A_NUMBER)
    stripe_sigma_mm: _Length | None = Field(None, description=_A_LENGTH)
    electrons_per_grey: _Above | None = Field(None, description=_A_NUMBER)
    read_noise_grey: float | None = Field(None, ge=0, allow_inf_nan=False, description=_NOT_NEGATIVE)
    ambient_grey: float | None = Field(None, ge=0, allow_inf_nan=False, description=_NOT_NEGATIVE)

    @model_validator(mode="after")
    def _one_focal_length(self) -> PlanTable:
        if self.focal_mm is not None and self.focal_px is not None:
            raise Clash("focal_px", "is one focal length too many; give focal_mm or focal_px")
        return self


class RigTables(Table):
    """What rig.toml holds, and project.json under "rig"."""

    camera_target: _CameraTarget = Field(description="a table [camera_target] with kind and sizes")
    plane_target: TargetTable = Field(description="a table [plane_target] with kind and sizes")
    laser_fan: _LaserFan = Field(description="a table [laser_fan] with lines and angle_deg")
    gauge: GaugeTable | None = Field(None, description="a table [gauge]")
    channel: Literal["red", "green", "blue"] | None = Field(None, description='"red", "green" or "blue"')
    plan: PlanTable | None = Field(None, description="a table [plan]")


class PlannedRigTables(Table):
    """The same of a rig that is only planned: nothing need be said, and then it is the paper's."""

    camera_target: _CameraTarget | None = Field(None, description="a table [camera_target] with kind and sizes")
    plane_target: TargetTable | None = Field(None, description="a table [plane_target] with kind and sizes")
    laser_fan: _LaserFan | None = Field(None, description="a table [laser_fan] with lines and angle_deg")
    gauge: GaugeTable | None = Field(None, description="a table [gauge]")
    channel: Literal["red", "green", "blue"] | None = Field(None, description='"red", "green" or "blue"')
    plan: PlanTable | None = Field(None, description="a table [plan]")
