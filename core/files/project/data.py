"""What a project is: what the user decided (undone and redone as a whole), and what has been measured (facts)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from datetime import datetime
from typing import Annotated, Any

from pydantic import ConfigDict, Field

from core.checks.artefact_check import Artefact
from core.files.recording.rig import Rig, default_rig
from core.files.tables import Finite, KeptMessage, Time
from core.inspect.plan.inspection_plan import InspectionPlan
from core.report.template import Paper
from core.settings.options import Options
from core.translations import languages

# What project.json may hold in a field is checked as it is annotated here; `core.files.complaints` tells the rest.
_CHECKED = ConfigDict(extra="forbid", strict=True)
_Celsius = Annotated[
    Annotated[float, Field(ge=-273.15, le=2000, allow_inf_nan=False)] | None,
    Field(description="a temperature in °C, or null"),
]
Id = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]*$", description="the id of a calibration: letters, digits, - and _")]


@dataclass(frozen=True, slots=True)
class ProjectInfo:
    """Data of the job that the report states. Temperatures in °C, None where nobody took them."""

    name: str = ""
    part: str = ""
    serial: str = ""
    operator: str = ""
    customer: str = ""
    laboratory: str = ""
    air_celsius: _Celsius = None
    part_celsius: _Celsius = None
    notes: str = ""
    __pydantic_config__ = _CHECKED


@dataclass(frozen=True, slots=True)
class Sources:
    """Folders of pictures to measure from; "" where there is none yet.

    Inside the project's folder they are named relative to it, with forward slashes, so that a project can be moved;
    elsewhere in full. `stored_source` and `source_folder` go from one to the other.
    """

    camera: str = ""
    planes: str = ""
    scan: str = ""
    check: str = ""
    __pydantic_config__ = _CHECKED


EARLIER_CALIBRATIONS = {"fan": "planes"}
"""What the steps of calibrating were called where calibrations are kept and accepted, up to schema 10."""


@dataclass(frozen=True, slots=True)
class Accepted:
    """Ids of the calibrations to measure with, in the project's history; "" where none is accepted yet."""

    camera: Id = ""
    planes: Id = ""
    __pydantic_config__ = _CHECKED


@dataclass(frozen=True, slots=True)
class Repeat:
    """Thickness of one scan in a series of the same part: in mm, with the expanded uncertainty U = k·u.

    `doubts` are the facts by which it proves nothing; none of repeats that were added before these were kept.
    """

    scan: str
    thickness_mm: Annotated[Finite, Field(description="a length in mm")]
    U_mm: Annotated[Finite, Field(ge=0, description="a length in mm, 0 or above")]
    k: Annotated[Finite, Field(gt=0, description="a number above 0")]
    calibration_id: str
    measured_at: Time
    doubts: tuple[str, ...] = ()
    __pydantic_config__ = _CHECKED

    @property
    def values(self) -> dict[str, Any]:
        """Values of the repeated measurement by their names in files; `doubts` is left out if empty."""
        values = asdict(self)
        return values if self.doubts else {name: value for name, value in values.items() if name != "doubts"}


@dataclass(frozen=True, slots=True)
class KeptStudy:
    """Study stored in the project: `id` names its folder below studies, `title` its kind and input.

    `included` puts it into the report.
    """

    id: Annotated[str, Field(pattern=r"^[0-9a-f]+$", description="the name of a folder below studies")]
    kind: Annotated[
        str,
        Field(
            pattern="^(repeats|type1|grr|acceptance|series)$",
            description='"repeats", "type1", "grr", "acceptance" or "series"',
        ),
    ]
    title: KeptMessage
    included: bool = True
    __pydantic_config__ = _CHECKED


@dataclass(frozen=True, slots=True)
class ReportChoices:
    """Options of the report: the sections left out, the paper, the language of its fixed words, the template file.

    `language`: nothing is that of the window or command that makes it. `template` is named as `Sources` are: within the
    project relative to its folder, elsewhere in full; nothing: none.
    """

    hidden: Annotated[frozenset[str], Field(description="a list of names of sections")] = frozenset()
    paper: Annotated[Paper, Field(description='"A4" or "Letter"')] = "A4"
    language: Annotated[
        str,
        Field(
            pattern=f"^({'|'.join(languages())}|)$", description=" or ".join(f'"{one}"' for one in (*languages(), ""))
        ),
    ] = ""
    template: str = ""
    __pydantic_config__ = _CHECKED


@dataclass(frozen=True, slots=True)
class Project:
    """All settings and choices of the user. Two projects are equal if every field is, and then have one hash.

    `rejected`: ids of calibrations that were found and are not wanted. `inspection`: the features measured beside the
    thickness; names of nominal surfaces in it are paths within the project's folder, or whole ones. `artefacts`: those
    that its rig is checked by, beside the user's own. `callouts`: by features, how far (right, down) in pixels the
    plate with its result was dragged from its place on the surface. `plate_beside`: whether the plane target is left
    beside the part, so that live scans are checked by it; None: not answered yet.
    """

    info: ProjectInfo = field(default_factory=ProjectInfo)
    rig: Rig = field(default_factory=default_rig)
    sources: Sources = field(default_factory=Sources)
    options: Options = field(default_factory=Options)
    accepted: Accepted = field(default_factory=Accepted)
    rejected: frozenset[str] = frozenset()
    repeats: tuple[Repeat, ...] = ()
    report: ReportChoices = field(default_factory=ReportChoices)
    inspection: InspectionPlan = field(default_factory=InspectionPlan)
    studies: tuple[KeptStudy, ...] = ()
    artefacts: tuple[Artefact, ...] = ()
    callouts: Mapping[str, tuple[float, float]] = field(default_factory=dict, hash=False)
    plate_beside: bool | None = None

    def printed_in(self, language: str) -> Project:
        """Set the language of the project's report to `language`, unless the project states one."""
        return replace(self, report=replace(self.report, language=self.report.language or language))


@dataclass(frozen=True, slots=True)
class Done:
    """Record of one finished result: its key, the keys of all it rests on by their names, and when it was finished."""

    key: str
    rests_on: Annotated[Mapping[str, str], Field(description="a table of texts")] = field(
        default_factory=dict, hash=False
    )
    at: Time = field(default_factory=lambda: datetime.now().astimezone())
    __pydantic_config__ = _CHECKED


@dataclass(frozen=True, slots=True)
class ProjectFile:
    """Content of project.json; `results` by step.

    Two are equal if project and results are. `created`, `saved`: when the project was made and last written; None if
    that is not known.
    """

    project: Project
    results: Mapping[str, Done] = field(default_factory=dict, hash=False)
    created: datetime | None = field(default=None, compare=False)
    saved: datetime | None = field(default=None, compare=False)


def new_project(name: str) -> Project:
    """Make a project called `name`, with nothing measured, for the rig of the published paper."""
    return Project(ProjectInfo(name=name))


def new_project_without_fan(name: str) -> Project:
    """Make a project called `name`, with nothing measured, for a camera and a line laser; no board is stated yet."""
    project = new_project(name)
    return replace(project, rig=replace(project.rig, lines=0, angle=0.0))
