"""Is the σ of the points true? Rendered scans, each measured with calibrations that it shares with no other.

What camera and fan are off by is one draw for all points of a scan, and the sweeps' planes have little more freedom. So
the share of points within 2σ is near 100 % for most calibrations and half of that for a few, differs from one to the
next by 0.11 (standard deviation), and its mean over the few calibrations of a campaign says little of σ; only many do.
The rig is the same for all seeds, so pictures of the target rendered anew are enough: with what they give, the scans of
a few other seeds are solved again. Beside the share stands the RMS of error over σ, which is surer.

    python -m tests.accuracy.points 24

prints what has come out after each of 24 calibrations; a second argument is the scale of the pictures (0.5).
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from core.calibrate.deviations import calibration_deviations
from core.files.recording.recording_set import open_set
from core.files.results.scan_file import read_scan
from core.pipeline.steps.camera_step import camera_step
from core.pipeline.steps.planes_step import planes_step
from core.pipeline.steps.workspace import Calibration, Workspace
from core.scan.common_errors import solve_common
from core.scan.features.extraction import ScanFeatures
from core.scan.reconstruct import reconstruct
from core.simulate.recording import simulate_set
from core.simulate.scenario import Scenario
from core.simulate.truth import Truth
from tests.accuracy.twin import depth_errors, measure

SCAN_SEEDS = (1, 2, 3, 4)
"""Calibrations are of the seeds that follow."""
HEIGHT_MM = 50.0
MISTAKEN = 8.0
"""A point so many σ off is a mistake: it counts against the share, but not for the RMS."""


@dataclass(frozen=True)
class Points:
    """Of every calibration (N,): share of the points within 2σ, and RMS of their errors over σ."""

    within: np.ndarray
    rms: np.ndarray

    @property
    def share(self) -> float:
        """Mean share of the points within 2σ."""
        return float(np.mean(self.within))

    @property
    def share_sd(self) -> float:
        """Standard uncertainty of `share`, from how much calibrations differ."""
        return sd_of_mean(self.within)

    @property
    def normalised(self) -> float:
        """RMS of error over σ: 1 where σ is true."""
        return float(np.sqrt(np.mean(self.rms**2)))

    def __str__(self) -> str:
        return (
            f"{len(self.within)} calibrations: points within 2 sigma {self.share:.1%} +- {self.share_sd:.1%}, "
            f"median {np.median(self.within):.1%}, lowest {np.min(self.within):.1%}; "
            f"error / sigma {self.normalised:.2f} rms"
        )


def sd_of_mean(values: np.ndarray) -> float:
    """Standard uncertainty of the mean of `values` (N,), from how much they differ; NaN of one."""
    return float(np.std(values, ddof=1) / np.sqrt(len(values))) if len(values) > 1 else float("nan")


def run(calibrations: int, scale: float = 0.5) -> Points:
    """Measure so many calibrations."""
    rows = np.array(list(measured(calibrations, scale)))
    return Points(*rows.T)


def measured(calibrations: int, scale: float) -> Iterator[tuple[float, float]]:
    """Share within 2σ and RMS of error over σ, of one calibration after another."""
    with tempfile.TemporaryDirectory(prefix="points-") as folder:
        scans = [_scan(seed, scale, Path(folder) / f"scan{seed}") for seed in SCAN_SEEDS]
        for number in range(calibrations):
            seed = SCAN_SEEDS[-1] + 1 + number
            truth, features = scans[seed % len(scans)]
            calibration = _calibration(seed, scale, Path(folder) / f"calibration{seed}")
            yield shown(*_points(truth, features, calibration))


def shown(errors: np.ndarray, sigma: np.ndarray) -> tuple[float, float]:
    """Share within 2σ and RMS of error over σ of points with `errors` and `sigma` (N,); NaN where it is not known."""
    known = np.isfinite(errors)
    normalised = np.abs(errors[known] / sigma[known])
    sound = normalised[normalised < MISTAKEN]
    return float(np.mean(normalised <= 2)), float(np.sqrt(np.mean(sound**2)))


def _scan(seed: int, scale: float, folder: Path) -> tuple[Truth, ScanFeatures]:
    truth = measure(Scenario(height_mm=HEIGHT_MM, seed=seed, scale=scale), folder).truth
    features = read_scan(folder / "out" / "scan.npz").features
    shutil.rmtree(folder)
    return truth, features


def _calibration(seed: int, scale: float, folder: Path) -> Calibration:
    """From pictures of the targets with this seed's noise and poses; the few frames are not looked at."""
    simulate_set(Scenario(height_mm=HEIGHT_MM, seed=seed, scale=scale, frames=3), folder / "set")
    work = Workspace.open(open_set(folder / "set"), folder / "out")
    camera_step(work)
    planes_step(work)
    calibration = work.calibration()
    shutil.rmtree(folder)
    return calibration


def _points(truth: Truth, features: ScanFeatures, calibration: Calibration) -> tuple[np.ndarray, np.ndarray]:
    """Depth errors and whole σ (N,) in mm of a scan solved with a calibration."""
    camera, fan = calibration.camera.camera, calibration.fan.fan
    scan = reconstruct(features, camera, fan)
    deviations = calibration_deviations(calibration.camera, calibration.fan)
    common = solve_common(scan, camera, fan, deviations)
    cloud = replace(scan.cloud, sigma_common=common.sigma(scan.cloud))
    return depth_errors(truth, cloud), np.hypot(cloud.sigma, cloud.sigma_common)


if __name__ == "__main__":
    rows: list[tuple[float, float]] = []
    for row in measured(int(sys.argv[1]), float(sys.argv[2]) if len(sys.argv) > 2 else 0.5):
        rows.append(row)
        print(f"points within 2 sigma {row[0]:.1%}, error / sigma {row[1]:.2f}", flush=True)
    print(Points(*np.array(rows).T))
