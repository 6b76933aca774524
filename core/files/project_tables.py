"""The tables of project.json, checked key by key."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from core.files.inspection_plan_tables import PlanTables
from core.files.rig_tables import RigTables, Table


def _aware(value: object) -> object:
    if not isinstance(value, str):
        return value
    time = datetime.fromisoformat(value)
    if time.tzinfo is None:
        raise ValueError("no time zone")
    return time


_A_TIME = "a date and time with its zone, as in 2025-01-31T12:00:00+00:00"
Time = Annotated[datetime, BeforeValidator(_aware), Field(description=_A_TIME)]
_Finite = Annotated[float, Field(allow_inf_nan=False)]
_Above0 = Annotated[float, Field(gt=0, allow_inf_nan=False)]
_Celsius = Annotated[float, Field(ge=-273.15, le=2000, allow_inf_nan=False)]
_Id = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]*$")]
_Name = Annotated[str, Field(pattern=r"^(camera|planes|scan)/.")]
_A_TEMPERATURE = "a temperature in °C, or null"
_AN_ID = "the id of a calibration: letters, digits, - and _"


class InfoTable(Table):
    """Under "info"."""

    name: str = ""
    part: str = ""
    serial: str = ""
    operator: str = ""
    customer: str = ""
    laboratory: str = ""
    air_celsius: _Celsius | None = Field(default=None, description=_A_TEMPERATURE)
    part_celsius: _Celsius | None = Field(default=None, description=_A_TEMPERATURE)
    notes: str = ""


class SourcesTable(Table):
    """Under "sources"."""

    camera: str = ""
    planes: str = ""
    scan: str = ""


class CameraOptionsTable(Table):
    """Under "camera" of the options."""

    skew: bool = True
    fixed: list[Literal["k1", "k2", "p1", "p2"]] = Field(
        default_factory=list, description="a list of those of k1, k2, p1, p2 that are fixed to 0"
    )
    k3: bool = False
    outliers: Literal["keep", "gross", "all"] = Field(default="gross", description='"keep", "gross" or "all"')


class StripeTable(Table):
    """Under "stripe" of the options."""

    width_px: _Above0 = Field(description="a width in pixels above 0")
    contrast: _Above0 = Field(description="a number of grey levels above 0")


class OptionsTable(Table):
    """Under "options"."""

    method: Literal["network", "three-crossings"] = Field(
        default="network", description='"network" or "three-crossings"'
    )
    sigma_cut_mm: Annotated[float, Field(gt=0, le=10, allow_inf_nan=False)] = Field(
        default=0.05, description="a length in mm above 0 and at most 10"
    )
    camera: CameraOptionsTable = CameraOptionsTable()
    part: str = ""
    stripe: StripeTable | None = Field(default=None, description="a table of width_px and contrast, or null")
    excluded: list[_Name] = Field(
        default_factory=list,
        description='a list of pictures as "camera/view00.png", "planes/pose00", "scan/frame0000.png"',
    )
    constrain_fan: bool = True
    adjust_camera: bool = False


class AcceptedTable(Table):
    """Under "accepted"."""

    camera: _Id = Field(default="", description=_AN_ID)
    fan: _Id = Field(default="", description=_AN_ID)


class RepeatTable(Table):
    """One of "repeats"."""

    scan: str
    thickness_mm: _Finite = Field(description="a length in mm")
    U_mm: Annotated[float, Field(ge=0, allow_inf_nan=False)] = Field(description="a length in mm, 0 or above")
    k: _Above0 = Field(description="a number above 0")
    calibration_id: str
    measured_at: Time = Field(description=_A_TIME)


class ReportTable(Table):
    """Under "report"."""

    hidden: list[str] = Field(default_factory=list, description="a list of names of sections")
    paper: Literal["A4", "Letter"] = Field(default="A4", description='"A4" or "Letter"')
    language: Literal["en", "de"] = Field(default="en", description='"en" or "de"')
    template: str = ""


class StudyTable(Table):
    """One of "studies"."""

    id: Annotated[str, Field(pattern=r"^[0-9a-f]+$")] = Field(description="the name of a folder below studies")
    kind: Literal["repeats", "type1", "grr", "acceptance"] = Field(
        description='"repeats", "type1", "grr" or "acceptance"'
    )
    title: str
    included: bool = True


class DoneTable(Table):
    """One of "results"."""

    key: str
    rests_on: dict[str, str] = Field(default_factory=dict, description="a table of texts")
    at: Time = Field(description=_A_TIME)


class ProjectTables(Table):
    """All of project.json."""

    schema_version: int
    version: str = ""
    created: Time | None = Field(default=None, description=_A_TIME)
    saved: Time | None = Field(default=None, description=_A_TIME)
    info: InfoTable = Field(description="a table of name, part, …")
    rig: RigTables = Field(description="a table as in rig.toml")
    sources: SourcesTable = SourcesTable()
    options: OptionsTable = OptionsTable()
    accepted: AcceptedTable = AcceptedTable()
    rejected: list[_Id] = Field(default_factory=list, description="a list of ids of calibrations")
    repeats: list[RepeatTable] = Field(default_factory=list)
    report: ReportTable = ReportTable()
    inspection: PlanTables = PlanTables()
    studies: list[StudyTable] = Field(default_factory=list)
    results: dict[str, DoneTable] = Field(default_factory=dict)
