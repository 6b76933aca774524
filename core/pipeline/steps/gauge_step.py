"""Gauge step: cloud.ply, scan.npz and the calibrations → gauge.json."""

from __future__ import annotations

from core.errors import InputError
from core.files.gauge_file import read_gauge, write_gauge
from core.files.ply import read_cloud
from core.files.rig import GaugeSpec
from core.files.scan_file import ScanFile, read_scan
from core.inspect.gauge import measure_gauge
from core.inspect.point_errors import PointErrors
from core.inspect.results import GaugeResult
from core.model.arrays import Array
from core.pipeline.workspace import Workspace, check_calibration
from core.progress import Progress, silent


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
        gauge = measure_gauge(
            cloud,
            errors=point_errors(scan),
            regions=_regions(spec),
            nominal_mm=spec.nominal_mm,
            tolerance_mm=spec.tolerance_mm,
            progress=progress,
        )
        log.settings.update({"nominal_mm": spec.nominal_mm, "tolerance_mm": spec.tolerance_mm, "rule": gauge.rule})
        log.notes.extend(gauge.notes)
        work.clear(("gauge", "faces"))  # two files: better none than one of each measurement
        write_gauge(work.path("gauge"), gauge, calibration.id)
    return read_gauge(work.path("gauge"), cloud)


def point_errors(scan: ScanFile) -> PointErrors:
    """How the errors of a scan's points hang together."""
    return PointErrors.of_scan(scan.features, scan.covariance, scan.common, scan.speckle)


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
