"""The one table of steps: everything the frame knows about the pages."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from PySide6.QtCore import QT_TRANSLATE_NOOP

from workbench.bench import Bench
from workbench.pages.camera_page import CameraPage
from workbench.pages.camera_presenter import CameraPresenter
from workbench.pages.inspect_page import InspectPage
from workbench.pages.inspect_presenter import InspectPresenter
from workbench.pages.planes_page import PlanesPage
from workbench.pages.planes_presenter import PlanesPresenter
from workbench.pages.presenter import StepPresenter
from workbench.pages.project_page import ProjectPage
from workbench.pages.project_presenter import ProjectPresenter
from workbench.pages.report_page import ReportPage
from workbench.pages.report_presenter import ReportPresenter
from workbench.pages.scan_page import ScanPage
from workbench.pages.scan_presenter import ScanPresenter
from workbench.pages.step_page import StepPage


@dataclass(frozen=True, slots=True)
class Step:
    """One step of the wizard: `name` as in `workbench.step_state.ORDER`, `icon` of qtawesome, `help` one line."""

    name: str
    title: str
    icon: str
    help: str
    presenter: Callable[[Bench], StepPresenter]
    page: Callable[..., StepPage]


STEPS: tuple[Step, ...] = (
    Step(
        "project",
        str(QT_TRANSLATE_NOOP("Steps", "Project")),
        "mdi6.clipboard-text-outline",
        str(QT_TRANSLATE_NOOP("Steps", "What is measured, by whom and for whom: the fields the report prints.")),
        ProjectPresenter,
        ProjectPage,
    ),
    Step(
        "camera",
        str(QT_TRANSLATE_NOOP("Steps", "Camera")),
        "mdi6.camera-outline",
        str(QT_TRANSLATE_NOOP("Steps", "Show the camera its target from many sides; it learns how it sees.")),
        CameraPresenter,
        CameraPage,
    ),
    Step(
        "planes",
        str(QT_TRANSLATE_NOOP("Steps", "Laser planes")),
        "mdi6.laser-pointer",
        str(QT_TRANSLATE_NOOP("Steps", "Hold the plate into the three-line laser at different distances.")),
        PlanesPresenter,
        PlanesPage,
    ),
    Step(
        "scan",
        str(QT_TRANSLATE_NOOP("Steps", "Scan")),
        "mdi6.line-scan",
        str(QT_TRANSLATE_NOOP("Steps", "Sweep the single line by hand over the part; nothing else may move.")),
        ScanPresenter,
        ScanPage,
    ),
    Step(
        "inspect",
        str(QT_TRANSLATE_NOOP("Steps", "Inspect")),
        "mdi6.ruler-square",
        str(QT_TRANSLATE_NOOP("Steps", "Look at the surface, measure the thickness, judge how sure it is.")),
        InspectPresenter,
        InspectPage,
    ),
    Step(
        "report",
        str(QT_TRANSLATE_NOOP("Steps", "Report")),
        "mdi6.file-certificate-outline",
        str(QT_TRANSLATE_NOOP("Steps", "Read the pages, choose what is in them, hand them over.")),
        ReportPresenter,
        ReportPage,
    ),
)
