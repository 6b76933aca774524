"""All that a report prints, gathered in one frozen value: the report itself computes no measurement."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import date, datetime, timedelta
from itertools import chain
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.calibrate.results import CameraCalibration, FanCalibration
from core.checks.artefact_check import ArtefactCheck
from core.checks.repeats import RepeatStatistics, repeat_statistics
from core.door import Origin
from core.findings.table import gravest_first
from core.image.stripes.centreline import Centreline
from core.inspect.characteristic import Characteristic
from core.inspect.plan.control_frame import ControlFrame
from core.inspect.result_list import ResultList
from core.inspect.results import GaugeResult
from core.inspect.shown.seen_from import SeenFrom
from core.messages import Message, label
from core.model.arrays import Array, frozen_array, set_field
from core.model.certificate import Certificate
from core.report.facts.fact import Fact, named
from core.report.facts.of_camera import camera_facts, parameter_facts
from core.report.facts.of_checks import Check, artefact_facts, check_facts
from core.report.facts.of_gauge import gauge_facts
from core.report.facts.of_planes import planes_facts
from core.report.facts.of_scan import plane_check_facts, plane_tables, scan_facts, sigma_of
from core.report.facts.table import FactTable
from core.report.template import SECTIONS, Paper, ReportTemplate, sections
from core.report.wording import ENGLISH, Words, result_name
from core.scan.known_planes.points_on_planes import PlaneAgreement
from core.scan.plane_check import PlaneCheck
from core.scan.results import FrameRecord
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh

MOST_CALLOUTS = 10
"""On the picture of the surface; the table of results has all."""


@dataclass(frozen=True, slots=True)
class CalibrationMark:
    """Calibration a result rests on: its id, the SHA-256 of its file, and when it was made (None: not known)."""

    of: Literal["camera", "planes"]
    id: str
    sha256: str
    made_at: datetime | None = None

    def age(self, at: datetime) -> timedelta | None:
        """Compute the age of the calibration at the time `at`; None if it is not known when it was made."""
        return None if self.made_at is None else at - self.made_at


@dataclass(frozen=True, slots=True)
class Evidence:
    """SHA-256 in hex that is printed behind the settings, and the sentence that says of what it is."""

    text: Message
    sha256: str


@dataclass(frozen=True, slots=True)
class RepeatLine:
    """Scan out of several of the same part: its thickness and U = k·u in mm, and the calibration it rests on."""

    scan: str
    thickness_mm: float
    U_mm: float
    k: float
    calibration_id: str
    measured_at: datetime


@dataclass(frozen=True, eq=False, slots=True)
class Overlay:
    """Frame with the stripes and crossings found in it.

    Parameters
    ----------
    name
        The frame, for the caption.
    picture
        (height, width) grey levels, uint8.
    fan
        For each line of the fan its centrelines; a line may have none.
    sweep
        Centrelines of the hand-moved laser in this frame.
    sweep_sigma
        For each centreline of `sweep` its (N,) standard uncertainty of depth in mm; NaN where there is none.
    crossings
        (M, 2) pixels of the crossings that were used.

    Raises
    ------
    ValueError
        If the picture is not a two-dimensional uint8 array or a shape does not match.
    """

    name: str
    picture: NDArray[np.uint8]
    fan: tuple[tuple[Centreline, ...], ...]
    sweep: tuple[Centreline, ...]
    sweep_sigma: tuple[Array, ...]
    crossings: Array

    def __post_init__(self) -> None:
        if self.picture.ndim != 2 or self.picture.dtype != np.uint8:
            raise ValueError(f"picture is {self.picture.dtype} {self.picture.shape}, not a grey uint8 picture")
        if [len(line) for line in self.sweep] != [len(sigma) for sigma in self.sweep_sigma]:
            raise ValueError("sweep_sigma does not match the points of sweep")
        set_field(self, "crossings", frozen_array(np.reshape(self.crossings, (-1, 2)), (None, 2), "crossings"))


@dataclass(frozen=True, eq=False, slots=True)
class Deviations:
    """Deviations of places of the surface from the nominal one.

    Parameters
    ----------
    name
        Of the feature.
    uv
        (N, 2) pixels they are seen at.
    deviation
        (N,) in mm, outwards positive.
    tolerance_mm
        What colours and marks are shares of.
    """

    name: str
    uv: Array
    deviation: Array
    tolerance_mm: float


@dataclass(frozen=True, eq=False, slots=True)
class LightProfiles:
    """Profiles of the fan alone on a part, without any sweep.

    Parameters
    ----------
    name
        The picture whose profiles are drawn.
    lines
        For each line its number, and position and height over the lower face (N,) in mm of its points.
    step_mm
        Height of the upper face in that picture.
    thickness_mm, own_mm
        (P,) what each picture gives, with the standard uncertainty that is its own.
    mean_mm, U_mm
        Of all pictures together.
    """

    name: str
    lines: tuple[tuple[int, Array, Array], ...]
    step_mm: float
    thickness_mm: Array
    own_mm: Array
    mean_mm: float
    U_mm: float


@dataclass(frozen=True, slots=True)
class BroughtSection:
    """Section of the report from a wing.

    Parameters
    ----------
    title
        Its heading in English.
    facts
        What it tells.
    origin
        The package it comes from; None: the program itself.
    name
        By which it is left out.
    """

    title: str
    facts: tuple[Fact, ...]
    origin: Origin | None = None
    name: str = ""


@dataclass(frozen=True, eq=False, slots=True)
class ReportedStudy:
    """A study as the report prints it: a wing reads it from its file.

    Parameters
    ----------
    kind
        What its kind is called, in English.
    name
        Of what it measured: fixed words (`label`), or a name as the user gave it; "": it has none.
    facts, tables, notes
        What it tells.
    figure
        Draws its chart, given a `core.report.layout.style.ReportLook` and the width in mm; None: it has none. It goes
        to another process, and so is a function of a module, or a `partial` of one.
    """

    kind: str
    name: str
    facts: tuple[Fact, ...]
    tables: tuple[FactTable, ...] = ()
    notes: tuple[Message, ...] = ()
    figure: Callable[[Any, float], Any] | None = None

    def title(self, words: Words = ENGLISH) -> str:
        """Write the title of the study: 'Gauge R&R', 'Series: thickness'."""
        kind = words(self.kind)
        return words("{name}: {value}", name=kind, value=self.name) if self.name else kind


@dataclass(frozen=True, eq=False, slots=True)
class ReportContent:
    """Content of a report: everything that is printed. The same content gives the same bytes.

    Parameters
    ----------
    part, serial, laboratory, operator, customer
        Names for the title block; an empty one is left out (an empty `part` is printed as "not named").
    air_celsius, part_celsius
        Temperatures in °C as the project or rig.toml state them, or None; here they are printed only.
    remarks
        The operator's own words; may have several lines.
    rig
        Description of the rig in printing order: {"Camera target": "checkerboard, 17 × 12 inner corners, 10 mm"}.
    camera, fan
        The calibrations used.
    cloud, mesh
        The measured surface in the camera frame; the mesh may be without triangles.
    known_planes, plane_check
        How the scan's points agree with the known planes in it, and the fan with these; None where it was not compared.
    gauge
        The thickness, or None for a scan without two faces.
    inspected
        Every characteristic of an inspection; empty where there was none.
    unmeasured
        Whether a feature with limits could not be measured.
    points
        By name, which points of the cloud a face or a feature rests on: indices.
    features
        By a characteristic's name, which feature it comes from.
    control_frames
        By a characteristic's name, what is asked of it after ISO 1101.
    datums
        By a feature's name, its letter as a datum.
    seen_at
        By a feature's name, which one's points show where it is, if not its own: of a distance the first of its two.
    sections
        By a feature's name, its profile: (M, 2) position along it and height, in mm.
    deviations
        Comparisons with nominal surfaces.
    below_results
        Of the wings, what stands below the results, each by the name under which the workbook has it.
    studies
        Studies of the way of measuring, and of series of parts.
    check
        Interim check of these calibrations; None where there is none.
    artefacts
        Known artefacts measured with these calibrations, each as nearest in time to this result.
    brought
        Sections of the wings.
    calibrations
        Which calibrations the result rests on.
    rig_id
        Names the rig: twelve hex digits of the hash of its description.
    overlay
        One frame of the scan, or None.
    frames
        Every frame of the recording, in order.
    hashes
        {path relative to the recording set: SHA-256 in hex} of every input.
    settings
        Settings that led to the result, in printing order.
    notes
        Warnings and remarks for the reader of the report.
    limits
        What else this result does not cover, printed below what holds for every result.
    method
        How the sweeps were located, in words.
    version
        Version of the software.
    timestamp
        When the measurement was evaluated.
    view
        How the surface was left in 3D; None where it was never turned.
    reported
        The day on which the report is made; None: it is not said, and the same content gives the same report.
    certificates
        Of targets and known planes, by their tables in rig.toml; of one that is not there none is stated.
    repeats
        Scans of the same part to be compared, in the order of measuring; this one may be among them.
    hidden
        Names out of `core.report.template.sections` that are left out; the last page says so.
    paper, language
        What the report is printed on, and the language of its fixed words.
    template
        The company's own in it.
    evidence
        What wings have printed behind the settings, so that it can be compared later.
    attachments
        By name, the JSON files of the results as they are, to go into the file.
    simulated
        Whether the scan's pictures are rendered by a program; None: not known.

    Raises
    ------
    ValueError
        If `hidden` has a name of no section.
    """

    rig: Mapping[str, str]
    camera: CameraCalibration
    fan: FanCalibration
    cloud: Cloud
    mesh: Mesh
    hashes: Mapping[str, str]
    version: str
    timestamp: datetime
    gauge: GaugeResult | None = None
    inspected: tuple[Characteristic, ...] = ()
    unmeasured: bool = False
    points: Mapping[str, NDArray[np.int64]] = field(default_factory=dict)
    features: Mapping[str, str] = field(default_factory=dict)
    control_frames: Mapping[str, ControlFrame] = field(default_factory=dict)
    datums: Mapping[str, str] = field(default_factory=dict)
    seen_at: Mapping[str, str] = field(default_factory=dict)
    sections: Mapping[str, Array] = field(default_factory=dict)
    deviations: tuple[Deviations, ...] = ()
    below_results: Mapping[str, BroughtSection] = field(default_factory=dict)
    studies: tuple[ReportedStudy, ...] = ()
    check: Check | None = None
    artefacts: tuple[ArtefactCheck, ...] = ()
    brought: tuple[BroughtSection, ...] = ()
    calibrations: tuple[CalibrationMark, ...] = ()
    rig_id: str = ""
    overlay: Overlay | None = None
    profiles: LightProfiles | None = None
    frames: tuple[FrameRecord, ...] = ()
    settings: Mapping[str, Message | str] = field(default_factory=dict)
    notes: tuple[Message, ...] = ()
    limits: tuple[Message, ...] = ()
    known_planes: tuple[PlaneAgreement, ...] = ()
    plane_check: PlaneCheck | None = None
    method: str = ""
    part: str = ""
    serial: str = ""
    laboratory: str = ""
    operator: str = ""
    customer: str = ""
    air_celsius: float | None = None
    part_celsius: float | None = None
    remarks: str = ""
    repeats: tuple[RepeatLine, ...] = ()
    hidden: frozenset[str] = frozenset()
    paper: Paper = "A4"
    language: str = "en"
    template: ReportTemplate = field(default_factory=ReportTemplate)
    evidence: tuple[Evidence, ...] = ()
    attachments: Mapping[str, bytes] = field(default_factory=dict)
    simulated: bool | None = None
    view: SeenFrom | None = None
    reported: date | None = None
    certificates: Mapping[str, Certificate] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if unknown := self.hidden - sections().keys():
            raise ValueError(f"{', '.join(sorted(unknown))}: no section of that name can be left out")

    @property
    def inputs_digest(self) -> str:
        """SHA-256 in hex over the hashes of all input files: one line `hash path` each, sorted by path."""
        lines = "".join(f"{self.hashes[path]}  {path}\n" for path in sorted(self.hashes))
        return hashlib.sha256(lines.encode()).hexdigest()

    @property
    def settings_digest(self) -> str:
        """SHA-256 in hex over version, method and settings: one line `name=value` each, sorted by name."""
        lines = [f"version={self.version}", f"method={self.method}"]
        lines += [f"{name}={value}" for name, value in sorted(self.settings.items())]
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()

    @property
    def results(self) -> ResultList:
        """List of all results, with the verdict on the part."""
        return ResultList.of(self.gauge, self.inspected, unmeasured=self.unmeasured)

    @property
    def characteristics(self) -> tuple[Characteristic, ...]:
        """Measured characteristics of the part: the gauge's thickness first, then those of the inspection."""
        return self.results.rows

    @property
    def points_used(self) -> Mapping[str, NDArray[np.int64]]:
        """Indices into the cloud of the points that each face or feature rests on, by the face's or feature's name."""
        if self.gauge is None:
            return self.points
        faces = {label("Upper face"): self.gauge.upper.indices, label("Lower face"): self.gauge.lower.indices}
        return {**faces, **self.points}

    @property
    def shown_at(self) -> tuple[tuple[Characteristic, NDArray[np.int64]], ...]:
        """Worst characteristic of each feature with its points' indices; at most MOST_CALLOUTS, worst first.

        The gauge's thickness is shown on its upper face.
        """
        found: dict[str, tuple[Characteristic, NDArray[np.int64]]] = {}
        for one in sorted(self.characteristics, key=lambda one: one.room):
            feature = self.features.get(one.name, "")
            indices = self.points.get(self.seen_at.get(feature, feature))
            if indices is None and self.gauge is not None and one.kind == "thickness" and not feature:
                indices = self.gauge.upper.indices
            if indices is not None and len(indices):
                found.setdefault(feature, (one, indices))
        return tuple(found.values())[:MOST_CALLOUTS]

    @property
    def view_shown(self) -> SeenFrom | None:
        """View of the surface that the user chose in 3D; None if there is none, or nothing of the surface is in it."""
        points = self.mesh.vertices if len(self.mesh.triangles) else self.cloud.points
        return self.view if self.view is not None and self.view.in_sight(np.asarray(points)).any() else None

    @property
    def at_reference(self) -> bool:
        """Whether any characteristic is corrected to 20 °C, or it is not known whether it is."""
        return any(one.at_20 is not False for one in self.characteristics)

    @property
    def report_id(self) -> str:
        """Name of this report: from the inputs' hashes, the settings and the software version, never random.

        The same pictures evaluated with other settings give another report and so another name; and so do other
        words of the user or other sections.
        """
        lines = [self.inputs_digest, self.version, self.method, self.part, self.serial]
        lines += [f"{name}={value}" for name, value in sorted(self.settings.items())]
        choices = {name: getattr(self, name) for name in ("customer", "air_celsius", "part_celsius", "remarks")}
        choices |= {"repeats": self.repeats, "hidden": sorted(self.hidden)}
        choices |= {
            "language": "" if self.language == "en" else self.language,
            "template": self.template.words,
            "studies": [(one.facts, one.tables, one.notes) for one in self.studies],
            "artefacts": self.artefacts,
            "compared": tuple(chain.from_iterable(one.facts for one in self.below_results.values())),
            "brought": self.brought,
            "view": "" if self.view_shown is None else self.view_shown.words,
            "certificates": sorted(self.certificates.items()),
            "inspected": [(one.name, one.kind, one.value, one.u, one.k, one.limits) for one in self.inspected],
        }
        lines += [f"{name}: {value!r}" for name, value in choices.items() if value not in ("", None, (), [])]
        digest = hashlib.sha256("\n".join(lines).encode()).hexdigest().upper()
        return "TR-" + "-".join(digest[start : start + 4] for start in (0, 4, 8))

    @property
    def nominal_mm(self) -> float | None:
        """Nominal value of the thickness in mm; None if none was given."""
        return self.gauge.nominal_mm if self.gauge else None

    @property
    def repeat_statistics(self) -> RepeatStatistics | None:
        """Statistics of the thicknesses of repeated scans; None without repeated scans."""
        thicknesses = [repeat.thickness_mm for repeat in self.repeats]
        return repeat_statistics(thicknesses, self.nominal_mm) if thicknesses else None

    @property
    def printable(self) -> Mapping[str, str]:
        """Name and heading of each section that this report has content for, sections that are hidden included."""
        missing = {
            "view": self.view_shown is None,
            "frame": self.overlay is None,
            "profiles": self.profiles is None,
            "sections": not self.sections,
            "points": not self.points_used or not len(self.cloud),
            "maps": self.gauge is None and not len(self.cloud),
            "deviation": not self.deviations,
            "budget": not any(one.budget for one in self.characteristics),
            "repeats": not self.repeats,
            "studies": not self.studies,
            "artefacts": not self.artefacts,
            "remarks": not self.remarks.strip(),
            "inputs": not self.hashes,
        }
        headings = dict(SECTIONS)
        headings["maps"] = label(
            "Residuals of both faces" if self.gauge else "Depth and its uncertainty over the picture"
        )
        brought = {one.name: one.title for one in (*self.below_results.values(), *self.brought)}
        return {name: heading for name, heading in headings.items() if not missing.get(name, False)} | brought

    @property
    def facts(self) -> Mapping[str, tuple[Fact, ...]]:
        """Facts (name, value, unit) on each part of the work, by its name: "camera", "planes", "scan", …."""
        artefacts = (named(one.artefact.id, artefact_facts(one)) for one in self.artefacts)
        house = {
            "camera": (*camera_facts(self.camera), *parameter_facts(self.camera)),
            "planes": planes_facts(self.fan) if self.has_fan else (),
            "check": () if self.check is None else check_facts(self.check),
            "artefact": tuple(chain(*artefacts)),
            "scan": self.scan_facts,
            "thickness": () if self.gauge is None else gauge_facts(self.gauge),
        }
        return house | {name: one.facts for name, one in self.below_results.items() if name not in house}

    @property
    def scan_facts(self) -> tuple[Fact, ...]:
        """Facts (name, value, unit) on the scan: frames, points, σ, and how the fan agrees with known planes."""
        cloud = self.cloud
        extent = np.ptp(cloud.points, axis=0) if len(cloud) else None
        triangles = len(self.mesh.triangles)
        of_scan = scan_facts(self.frames, len(cloud), triangles, sigma_of(cloud.sigma), extent_mm=extent)
        return (*of_scan, *plane_check_facts(self.plane_check))

    @property
    def plane_tables(self) -> tuple[FactTable, ...]:
        """The table of the known planes in the scan; () if there are none."""
        return plane_tables(self.known_planes, self.plane_check)

    @property
    def has_fan(self) -> bool:
        """Whether there is a fan; without one, known planes alone are what the scan was measured by."""
        return self.fan.fan.lines > 0

    @property
    def all_notes(self) -> tuple[Message, ...]:
        """Notes of the report, the results and both calibrations, each once, the gravest first."""
        of_gauge = self.gauge.notes if self.gauge else ()
        of_each = [
            Message("report.note_of_result", "{name}: {note}", name=result_name(one), note=note)
            for one in self.inspected
            for note in one.notes
        ]
        every = (*self.notes, *of_gauge, *of_each, *self.camera.notes, *self.fan.all_notes)
        return gravest_first({str(note): note for note in every}.values())
