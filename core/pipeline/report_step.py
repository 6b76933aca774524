"""Report step: all results in the folder → report.pdf."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from core import __version__
from core.errors import InputError
from core.files.atomic import write_bytes
from core.files.gauge_file import read_gauge
from core.files.ply import read_cloud, read_mesh
from core.files.recording_set import RecordingSet
from core.files.rig import Rig
from core.files.run_file import RunRecord
from core.files.scan_file import ScanFile, read_scan
from core.image.centreline import Centreline
from core.image.display import in_8_bit
from core.model.arrays import Array
from core.pipeline.workspace import Workspace, check_calibration
from core.progress import Progress, silent
from core.report.content import Overlay, ReportContent
from core.report.pdf import build_report
from core.report.wording import target_in_words
from core.scan.cloud import Cloud

METHOD_IN_WORDS = {
    "network": "all sweeps adjusted together as one network, tied to the fan and to each other by their crossings",
    "three-crossings": "each sweep located from its own crossings with the fan (Sun et al. 2023, section 4)",
}
_SAME_POINT_PX = 0.01

Said = Callable[[ReportContent], ReportContent]
"""Adds what people say to what was measured."""


def report_step(work: Workspace, progress: Progress = silent, said: Said | None = None) -> Path:
    """Put the results in the folder into report.pdf; `said` adds what people say to what was measured.

    Raises
    ------
    InputError
        If a result is missing, damaged, or was measured with another calibration.
    """
    with work.step("report", measures=False):
        write_bytes(work.path("report"), build_report(report_content(work, progress, said), progress))
    return work.path("report")


def report_content(work: Workspace, progress: Progress = silent, said: Said | None = None) -> ReportContent:
    """What the report says; InputError as `report_step`."""
    progress("report", 0, 1)
    calibration = work.calibration()
    cloud_file = read_cloud(work.path("cloud"))
    check_calibration(work.path("cloud"), cloud_file.calibration_id, calibration)
    scan = read_scan(work.path("scan"))
    check_calibration(work.path("scan"), scan.calibration_id, calibration)
    record = work.record()
    gauge = read_gauge(work.path("gauge"), cloud_file.cloud) if work.path("gauge").exists() else None
    content = ReportContent(
        part=work.part or record.part,
        rig=_rig_in_words(work.found.rig, calibration.camera.camera.image_size),
        camera=calibration.camera,
        fan=calibration.fan,
        cloud=cloud_file.cloud,
        mesh=read_mesh(work.path("mesh")),
        gauge=gauge,
        overlay=_overlay(work.found, scan, cloud_file.cloud),
        frames=record.frames,
        hashes=record.inputs,
        settings=_settings_in_words(record),
        notes=record.all_notes,
        method=METHOD_IN_WORDS.get(str(record.settings.get("scan", {}).get("method")), ""),
        version=__version__,
        timestamp=record.measured_at,
    )
    return said(content) if said else content


def _rig_in_words(rig: Rig, image_size: tuple[int, int]) -> Mapping[str, str]:
    lines = f"{rig.lines} lines, {math.degrees(rig.angle):g}° apart" if rig.lines > 1 else "1 line"
    words = {
        "Picture": f"{image_size[0]} × {image_size[1]} px" + (f", {rig.channel} channel" if rig.channel else ""),
        "Camera target": target_in_words(rig.camera_target),
        "Plane target": target_in_words(rig.plane_target),
        "Fixed laser": lines,
    }
    if rig.gauge and rig.gauge.nominal_mm is not None:
        words["Nominal"] = f"{rig.gauge.nominal_mm:g} mm ± {rig.gauge.tolerance_mm:g} mm"
    return words


def _settings_in_words(record: RunRecord) -> Mapping[str, str]:
    words: dict[str, str] = {}
    scan, camera = record.settings.get("scan", {}), record.settings.get("camera", {})
    if "method" in scan:
        words["Method"] = str(scan["method"])
    if "sigma_cut_mm" in scan:
        words["Points kept"] = f"σ up to {scan['sigma_cut_mm']:g} mm"
    if camera:
        fixed = {"γ"} - ({"γ"} if camera.get("skew") else set()) | set(camera.get("fixed", ()))
        free = [name for name in ("α", "β", "γ", "u0", "v0", "k1", "k2", "p1", "p2") if name not in fixed]
        words["Free camera parameters"] = ", ".join(free + (["k3"] if camera.get("k3") else []))
    return words


def _overlay(found: RecordingSet, scan: ScanFile, cloud: Cloud) -> Overlay | None:
    """The frame to show with what was found in it, or None if it is there no more."""
    if scan.shown is None:
        return None
    shown = scan.features.frames[scan.shown]
    try:
        picture = found.read(found.path_of(shown.name))
    except InputError:
        return None  # calibrations and clouds can be reported without the pictures they were made from
    lines = range(max(scan.fan_line, default=-1) + 1)
    return Overlay(
        name=shown.name,
        picture=in_8_bit(picture, 255 if picture.dtype == np.uint8 else max(int(picture.max()), 1)),
        fan=tuple(
            tuple(piece for piece, number in zip(scan.features.fan, scan.fan_line, strict=True) if number == line)
            for line in lines
        ),
        sweep=shown.centrelines,
        sweep_sigma=_sigmas(shown.centrelines, cloud.select(cloud.frame == shown.index)),
        crossings=scan.crossings_used,
    )


def _sigmas(sweep: tuple[Centreline, ...], points: Cloud) -> tuple[Array, ...]:
    """σ of depth at every point of the centrelines, NaN at those that are not in the cloud."""
    if not len(points):
        return tuple(np.full(len(line), np.nan) for line in sweep)
    tree = cKDTree(points.uv)
    sigmas = []
    for line in sweep:
        distance, nearest = tree.query(line.uv)
        sigmas.append(np.where(distance < _SAME_POINT_PX, points.sigma[nearest], np.nan))
    return tuple(sigmas)
