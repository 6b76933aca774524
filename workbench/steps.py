"""The one table of steps: everything the frame knows about the pages."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from core.messages import label
from workbench.bench import Bench
from workbench.pages.camera.page import CameraPage
from workbench.pages.camera.presenter import CameraPresenter
from workbench.pages.inspect.page import InspectPage
from workbench.pages.inspect.presenter import InspectPresenter
from workbench.pages.planes.page import PlanesPage
from workbench.pages.planes.presenter import PlanesPresenter
from workbench.pages.presenter import StepPresenter
from workbench.pages.project.page import ProjectPage
from workbench.pages.project.presenter import ProjectPresenter
from workbench.pages.report.page import ReportPage
from workbench.pages.report.presenter import ReportPresenter
from workbench.pages.scan.page import ScanPage
from workbench.pages.scan.presenter import ScanPresenter
from workbench.pages.step_page import StepPage
from workbench.step_state import TITLES


@dataclass(frozen=True, slots=True)
class Step:
    """Step of the wizard.

    `name` as in `workbench.step_state.ORDER`, `icon` of qtawesome, `help` one line, `manual` its page of the manual.
    """

    name: str
    icon: str
    help: str
    manual: str
    presenter: Callable[[Bench], StepPresenter]
    page: Callable[..., StepPage]

    @property
    def title(self) -> str:
        """Name of the step in the window's language."""
        return TITLES[self.name]


STEPS: tuple[Step, ...] = (
    Step(
        "project",
        "mdi6.clipboard-text-outline",
        label("What is measured, by whom and for whom: the fields the report prints."),
        "projects",
        ProjectPresenter,
        ProjectPage,
    ),
    Step(
        "camera",
        "mdi6.camera-outline",
        label("Show the camera its target from many sides; it learns how it sees."),
        "calibrate-camera",
        CameraPresenter,
        CameraPage,
    ),
    Step(
        "planes",
        "mdi6.laser-pointer",
        label("Hold the plate into the three-line laser at different distances."),
        "calibrate-planes",
        PlanesPresenter,
        PlanesPage,
    ),
    Step(
        "scan",
        "mdi6.line-scan",
        label("Sweep the single line by hand over the part; nothing else may move."),
        "scan",
        ScanPresenter,
        ScanPage,
    ),
    Step(
        "inspect",
        "mdi6.ruler-square",
        label("Look at the surface, measure the thickness, judge how sure it is."),
        "inspect",
        InspectPresenter,
        InspectPage,
    ),
    Step(
        "report",
        "mdi6.file-certificate-outline",
        label("Read the pages, choose what is in them, hand them over."),
        "report",
        ReportPresenter,
        ReportPage,
    ),
)
