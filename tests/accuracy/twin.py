"""Sets rendered with hidden truth, measured the way a user would, and compared."""

import shutil
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from core.calibrate.results import CAMERA_PARAMETERS, CameraCalibration
from core.files.recording.recording_set import open_set
from core.files.results.camera_file import read_camera
from core.files.results.gauge_file import read_gauge
from core.files.results.ply import read_cloud
from core.files.results.scan_file import read_scan
from core.inspect.results import GaugeResult
from core.inspect.uncertainty.point_errors import PointErrors
from core.pipeline.steps.camera_step import camera_step
from core.pipeline.steps.gauge_step import gauge_step, point_errors
from core.pipeline.steps.planes_step import planes_step
from core.pipeline.steps.scan_step import scan_step
from core.pipeline.steps.workspace import Workspace
from core.scan.surface.cloud import Cloud
from core.simulate.recording import simulate_set
from core.simulate.scenario import Scenario
from core.simulate.truth import Truth, load_truth
from tests.shared import made_once


@dataclass
class Measured:
    """A finished measurement beside the truth it was rendered from."""

    truth: Truth
    camera: CameraCalibration
    cloud: Cloud
    gauge: GaugeResult | None
    errors: PointErrors

    def depth_errors(self) -> np.ndarray:
        """Measured minus true depth of every point in mm; NaN within two pixels of a depth edge."""
        return depth_errors(self.truth, self.cloud)

    def camera_errors(self) -> dict[str, float]:
        """Error of each camera parameter in its own stated standard deviations."""
        found, true = (
            np.array([c.matrix[0, 0], c.matrix[1, 1], c.matrix[0, 1], c.matrix[0, 2], c.matrix[1, 2], *c.distortion])
            for c in (self.camera.camera, self.truth.camera)
        )
        return {
            name: (found[i] - true[i]) / self.camera.sd[name]
            for i, name in enumerate(CAMERA_PARAMETERS)
            if self.camera.sd[name] > 0
        }


def depth_errors(truth: Truth, cloud: Cloud) -> np.ndarray:
    """Measured minus true depth of every point of a cloud in mm; NaN within two pixels of a depth edge."""
    u, v = cloud.uv.T
    depth = truth.depth.astype(float)
    true = map_coordinates(depth, [v, u], order=1, mode="nearest")
    near = [
        map_coordinates(depth, [v + dv, u + du], order=1, mode="nearest")
        for du, dv in ((2, 0), (-2, 0), (0, 2), (0, -2))
    ]
    errors = cloud.points[:, 2] - true
    errors[np.abs(np.array(near) - true).max(axis=0) > 2.0] = np.nan
    return errors


def calibrated_once(tmp_path_factory: pytest.TempPathFactory, scenario: Scenario) -> Path:
    """A folder with the pictures of a scenario's calibrations and their results, made once for all test processes.

    What is scanned and how does not matter, so `scenario` states nothing of it.
    """
    without_scan = replace(scenario, frames=0)

    def make(folder: Path) -> None:
        simulate_set(without_scan, folder / "set")
        work = Workspace.open(open_set(folder / "set"), folder / "out")
        camera_step(work)
        planes_step(work)

    return made_once(tmp_path_factory, f"calibrated-{without_scan.key}", make)


def measure(scenario: Scenario, folder: Path, calibrated: Path | None = None) -> Measured:
    """Render `scenario` and measure it in `folder`; with `calibrated`, a folder measured earlier, its calibration is
    taken over, pictures and results."""
    recording, out = folder / "set", folder / "out"
    simulate_set(scenario, recording, calibration_from=calibrated / "set" if calibrated else None)
    work = Workspace.open(open_set(recording), out)
    if calibrated:
        for name in ("camera.json", "planes.json", "planes.npz"):
            shutil.copy(calibrated / "out" / name, out / name)
    else:
        camera_step(work)
        planes_step(work)
    scan_step(work)
    gauged = scenario.object in ("block", "narrow-block", "steps")
    if gauged:
        gauge_step(work)
    cloud = read_cloud(work.path("cloud")).cloud
    return Measured(
        load_truth(recording),
        read_camera(work.path("camera")),
        cloud,
        read_gauge(work.path("gauge"), cloud) if gauged else None,
        point_errors(read_scan(work.path("scan"))),
    )
