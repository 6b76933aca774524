"""Gauge step: cloud.ply and the calibrations → gauge.json."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from core.calibrate.fan import FanOptions, fit_fan, same_model
from core.errors import InputError
from core.files.fan_file import fan_id
from core.files.gauge_file import read_gauge, write_gauge
from core.files.ply import read_cloud
from core.files.poses_file import read_poses
from core.files.rig import GaugeSpec
from core.files.scan_file import ScanFile, read_scan
from core.image.centreline import Centreline
from core.inspect.gauge import GaugeFit, fit_gauge, measure_gauge
from core.inspect.remeasure import calibration_changes
from core.inspect.results import GaugeResult
from core.model import Camera, Fan
from core.model.arrays import Array
from core.pipeline.options import Options
from core.pipeline.workspace import Calibration, Workspace, check_calibration
from core.progress import Progress, Told, silent
from core.scan.cloud import FAN, Cloud
from core.scan.fan_lines import FanLines
from core.scan.reconstruct import ReconstructOptions, reconstruct

_NO_CUT_MM = 1e6


def gauge_step(work: Workspace, progress: Progress = silent) -> GaugeResult:
    """Measure the thickness of the cloud in the folder and write gauge.json.

    Raises
    ------
    InputError
        If a result is missing, damaged or of another calibration, or there are no two parallel faces.
    """
    with work.step("gauge") as log:
        calibration = work.calibration()
        file = read_cloud(work.path("cloud"))
        check_calibration(work.path("cloud"), file.calibration_id, calibration)
        scan = read_scan(work.path("scan"))
        check_calibration(work.path("scan"), scan.calibration_id, calibration)
        cloud, spec = file.cloud, work.found.rig.gauge or GaugeSpec()
        fit = fit_gauge(cloud, regions=_regions(spec), progress=progress)
        of_camera, of_fan = _calibration_changes(work, calibration, scan, cloud, fit, progress)
        gauge = measure_gauge(
            cloud,
            fit=fit,
            nominal_mm=spec.nominal_mm,
            tolerance_mm=spec.tolerance_mm,
            sweep_covariance=scan.covariance,
            camera_changes=of_camera,
            fan_changes=of_fan,
            correlation_px=_correlation([piece for frame in scan.features.frames for piece in frame.centrelines]),
            speckle_px=_correlation(scan.features.fan),
            progress=progress,
        )
        log.settings.update({"nominal_mm": spec.nominal_mm, "tolerance_mm": spec.tolerance_mm, "rule": gauge.rule})
        log.notes.extend(gauge.notes)
        if not work.path("poses").exists():
            log.notes.append(
                f"{work.path('poses').name} is missing, so the fan was not calibrated anew with displaced cameras; "
                "U is larger than it need be."
            )
        work.clear(("gauge", "faces"))  # two files: better none than one of each measurement
        write_gauge(work.path("gauge"), gauge, calibration.id)
    return read_gauge(work.path("gauge"), cloud)


def gauge_if_possible(work: Workspace, progress: Progress = silent) -> tuple[GaugeResult | None, str]:
    """As `gauge_step`, but a part without two parallel faces is no error: then a sentence says why."""
    try:
        return gauge_step(work, progress), ""
    except InputError as error:
        sentence = f"No thickness was measured: {error}"
        with work.step("gauge") as log:
            log.notes.append(sentence)
        return None, sentence


def _regions(spec: GaugeSpec) -> tuple[Array, Array] | None:
    if spec.upper_polygon_px is None or spec.lower_polygon_px is None:
        return None
    return spec.upper_polygon_px, spec.lower_polygon_px


def _correlation(pieces: Sequence[Centreline]) -> float:
    """Length in pixels over which the noise of a typical point counts as one: the median over all points."""
    lengths = np.array([len(piece) for piece in pieces])
    correlations = np.array([piece.correlation_px for piece in pieces])
    return float(np.median(np.repeat(correlations, lengths))) if len(pieces) else 1.0


def _calibration_changes(
    work: Workspace,
    calibration: Calibration,
    scan: ScanFile,
    cloud: Cloud,
    fit: GaugeFit,
    progress: Progress,
) -> tuple[Array | None, Array | None]:
    """Changes of the thickness for one-σ displaced cameras and fans; None where their covariance is not known.

    A displaced camera calibrates the fan anew, because the fan was calibrated through it and makes up for part of its
    error; that needs the poses' features in planes.npz.
    """
    camera, fan = calibration.camera.camera, calibration.fan.fan
    refit = _refit_fan(work, calibration)
    told = Told(progress)
    method = work.record().settings.get("scan", {}).get("method", Options().method)
    options = Options(method)

    def measure(displaced: Camera, given: Fan) -> float:
        used = refit(displaced, told.again) if displaced is not camera and refit is not None else given
        return fit.thickness_of(_measured_again(scan, cloud, displaced, used, options, told.again))

    of_camera, of_fan = calibration_changes(measure, camera, calibration.camera.covariance, fan, progress=told)
    return of_camera if len(of_camera) else None, of_fan if len(of_fan) else None


def _refit_fan(work: Workspace, calibration: Calibration) -> Callable[[Camera, Progress], Fan] | None:
    """How to calibrate the fan with another camera, if the poses' features are at hand."""
    poses = read_poses(work.path("poses"), fan_id(calibration.fan.fan))
    if not poses:
        return None
    rig = work.found.rig
    used = {pose.name for pose in calibration.fan.poses if pose.used}
    options = same_model(FanOptions(rig.lines, rig.angle or None), calibration.fan)
    return lambda camera, progress: (
        fit_fan([pose for pose in poses if pose.name in used], camera, options, progress).fan
    )


def _measured_again(
    scan: ScanFile, cloud: Cloud, camera: Camera, fan: Fan, options: Options, progress: Progress
) -> Array:
    """The cloud's points (N, 3) with another camera and fan: its sweeps solved again, the same pixels triangulated."""
    solving = ReconstructOptions(method=options.method, sigma_cut_mm=_NO_CUT_MM)
    lines = FanLines.settled_as(scan.fan_line)
    again = reconstruct(scan.features, camera, fan, solving, progress, fan_lines=lines)
    place = np.searchsorted(again.sweep_frames, scan.sweep_frames)
    swept = cloud.sweep >= 0
    pis = np.empty((len(cloud), 3))
    pis[swept] = again.pis[place[cloud.sweep[swept]]]
    pis[~swept] = fan.pis[FAN - cloud.sweep[~swept]]
    rays = camera.rays(cloud.uv)
    points: Array = rays / np.einsum("ni,ni->n", rays, pis)[:, None]
    return points
