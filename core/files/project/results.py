"""What the steps of a project give: the answer of a scan, and everything that lies among the results."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from core.calibrate.results import CameraCalibration, FanCalibration
from core.files.results.profile_file import PictureStep
from core.inspect.results import GaugeResult
from core.messages import Message
from core.scan.features.frames import FrameRecord
from core.scan.preview.shown import SettledScan
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh


@dataclass(frozen=True, eq=False, slots=True)
class ScanSummary:
    """Summary of what a scan measured.

    Parameters
    ----------
    frames
        What became of every frame.
    points, triangles
        How many the cloud and the mesh have.
    gauge
        The thickness; None if there is none, and `no_gauge` says why.
    notes
        Sentences for the technician, of all steps.
    calibration_id
        Names the calibrations the scan was measured with.
    files
        The results, by their names in `core.files.step_graph.FILES`.
    """

    frames: tuple[FrameRecord, ...]
    points: int
    triangles: int
    gauge: GaugeResult | None
    no_gauge: Message | None
    notes: tuple[Message, ...]
    calibration_id: str
    files: Mapping[str, Path]


@dataclass(frozen=True, eq=False, slots=True)
class ProjectResults:
    """Results that are there and belong together; None or nothing for those that do not.

    Parameters
    ----------
    camera, fan
        The calibrations the scan was measured with; the fan's poses are without their points.
    cloud, mesh, gauge, frames
        The scan and the thickness.
    settled
        What the scan has settled on, for looking at its frames.
    notes
        Sentences for the technician, of all steps.
    calibration_id
        Names the two calibrations.
    files
        Everything that is there, by its name in `core.files.step_graph.FILES`.
    problems
        Why a result that is there is not among them.
    """

    camera: CameraCalibration | None = None
    fan: FanCalibration | None = None
    cloud: Cloud | None = None
    mesh: Mesh | None = None
    gauge: GaugeResult | None = None
    frames: tuple[FrameRecord, ...] = ()
    settled: SettledScan | None = None
    notes: tuple[Message, ...] = ()
    calibration_id: str = ""
    files: Mapping[str, Path] = field(default_factory=dict)
    problems: tuple[Message, ...] = ()


@dataclass(frozen=True, eq=False, slots=True)
class ProfilesSummary:
    """Result of measuring profiles: the thickness, the result of each picture, the notes, and the report."""

    gauge: GaugeResult
    pictures: tuple[PictureStep, ...]
    notes: tuple[Message, ...]
    report: Path
