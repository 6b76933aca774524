"""What a project is: what the user decided (undone and redone as a whole), and what has been measured (facts)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime

from core.files.options import Options
from core.files.rig import Rig, default_rig
from core.inspect.inspection_plan import InspectionPlan
from core.report.template import Language, Paper


@dataclass(frozen=True, slots=True)
class ProjectInfo:
    """What the report says of the job. Temperatures in °C, None where nobody took them."""

    name: str = ""
    part: str = ""
    serial: str = ""
    operator: str = ""
    customer: str = ""
    laboratory: str = ""
    air_celsius: float | None = None
    part_celsius: float | None = None
    notes: str = ""


@dataclass(frozen=True, slots=True)
class Sources:
    """The folders of pictures to measure from; nothing where there is none yet.

    Inside the project's folder they are named relative to it, with forward slashes, so that a project can be moved;
    elsewhere in full. `stored_source` and `source_folder` go from one to the other.
    """

    camera: str = ""
    planes: str = ""
    scan: str = ""


@dataclass(frozen=True, slots=True)
class Accepted:
    """Ids of the calibrations to measure with, in the project's history; nothing where none is accepted yet."""

    camera: str = ""
    fan: str = ""


@dataclass(frozen=True, slots=True)
class Repeat:
    """The thickness of one scan in a series of the same part: in mm, with the expanded uncertainty U = k·u."""

    scan: str
    thickness_mm: float
    U_mm: float
    k: float
    calibration_id: str
    measured_at: datetime


@dataclass(frozen=True, slots=True)
class KeptStudy:
    """A study kept in the project: `id` names its folder below studies, `included` puts it into the report."""

    id: str
    kind: str
    title: str
    included: bool = True


@dataclass(frozen=True, slots=True)
class ReportChoices:
    """How the report is made: the sections left out, the paper, the language of its fixed words, the template file.

    `template` is named as `Sources` are: within the project relative to its folder, elsewhere in full; nothing: none.
    """

    hidden: frozenset[str] = frozenset()
    paper: Paper = "A4"
    language: Language = "en"
    template: str = ""


@dataclass(frozen=True, slots=True)
class Project:
    """Everything the user decides. Two projects are equal if every field is, and then have one hash.

    `rejected`: ids of calibrations that were found and are not wanted. `inspection`: the features measured beside the
    thickness; names of nominal surfaces in it are paths within the project's folder, or whole ones.
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


@dataclass(frozen=True, slots=True)
class Done:
    """One finished result: its own key, the keys of all it rests on by their names, and when it was finished."""

    key: str
    rests_on: Mapping[str, str] = field(default_factory=dict, hash=False)
    at: datetime = field(default_factory=lambda: datetime.now().astimezone())


@dataclass(frozen=True, slots=True)
class ProjectFile:
    """What project.json holds; `results` by step.

    Two are equal if project and results are. `created`, `saved`: when the project was made and last written; None if
    that is not known.
    """

    project: Project
    results: Mapping[str, Done] = field(default_factory=dict, hash=False)
    created: datetime | None = field(default=None, compare=False)
    saved: datetime | None = field(default=None, compare=False)


def new_project(name: str) -> Project:
    """A project with nothing measured, for the rig of the paper."""
    return Project(ProjectInfo(name=name))
