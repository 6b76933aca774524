"""One call from a recording set to results, and one for each step on the way."""

from core.pipeline.camera_step import camera_step
from core.pipeline.gauge_step import gauge_step
from core.pipeline.options import METHODS, Options
from core.pipeline.planes_step import planes_step
from core.pipeline.report_step import report_step
from core.pipeline.run import RunResult, run
from core.pipeline.scan_step import Measured, scan_step
from core.pipeline.workspace import FILES, Workspace

__all__ = [
    "FILES",
    "METHODS",
    "Measured",
    "Options",
    "RunResult",
    "Workspace",
    "camera_step",
    "gauge_step",
    "planes_step",
    "report_step",
    "run",
    "scan_step",
]
