"""Report step: all results in the folder → report.pdf."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from core import __version__
from core.errors import InputError
from core.files.atomic import write_bytes
from core.files.camera_file import camera_id
from core.files.fan_file import fan_id
from core.files.gauge_file import read_gauge
from core.files.pictures import read_bytes
from core.files.ply import read_cloud, read_mesh
from core.files.recording_set import RIG, RecordingSet
from core.files.rig import Rig, rig_to_toml
from core.files.run_file import RunRecord, read_run
from core.files.scan_file import ScanFile, read_scan
from core.image.centreline import Centreline
from core.image.display import in_8_bit
from core.model.arrays import Array
from core.pipeline.reported_inspection import with_inspection
from core.pipeline.workspace import FILES, Calibration, Workspace, check_calibration, read_calibration
from core.progress import Progress, silent
from core.report.content import CalibrationMark, Overlay, ReportContent
from core.report.language import Words
from core.report.pdf import build_report
from core.report.wording import target_in_words
from core.scan.cloud import Cloud

METHOD_IN_WORDS = {
    "network": "all sweeps adjusted together as one network, tied to the fan and to each other by their crossings",
    "three-crossings": "each sweep located from its own crossings with the fan (Sun et al. 2023, section 4)",
}
RIG_ID = 12
"""Hex digits of a rig's hash that name it."""

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
    content = results_content(work.out, work.part, work.record())
    rig = work.found.rig
    content = replace(
        content,
        rig_id=content.rig_id or hashlib.sha256(rig_to_toml(rig).encode()).hexdigest()[:RIG_ID],
        overlay=_overlay(work.found, read_scan(work.path("scan")), content.cloud),
    )
    content = said(content) if said else content
    return replace(content, rig=_rig_in_words(rig, content.camera.camera.image_size, Words(content.language)))


def results_content(out: Path, part: str = "", record: RunRecord | None = None) -> ReportContent:
    """What the results in the folder `out` say by themselves, without the pictures and the rig they come from.

    `record` is what is known of the run; None: what run.json says.

    Raises
    ------
    InputError
        If a result is missing, damaged, or was measured with another calibration.
    """
    calibration = read_calibration(out)
    cloud_file = read_cloud(out / FILES["cloud"])
    check_calibration(out / FILES["cloud"], cloud_file.calibration_id, calibration)
    scan = read_scan(out / FILES["scan"])
    check_calibration(out / FILES["scan"], scan.calibration_id, calibration)
    record = record or read_run(out / FILES["run"])
    gauge_path = out / FILES["gauge"]
    content = ReportContent(
        part=part or record.part,
        rig={},
        camera=calibration.camera,
        fan=calibration.fan,
        cloud=cloud_file.cloud,
        mesh=read_mesh(out / FILES["mesh"]),
        gauge=read_gauge(gauge_path, cloud_file.cloud) if gauge_path.exists() else None,
        calibrations=_marks(out, record, calibration),
        rig_id=record.inputs.get(RIG, "")[:RIG_ID],
        frames=record.frames,
        hashes=record.inputs,
        settings=_settings_in_words(record),
        notes=record.all_notes,
        method=METHOD_IN_WORDS.get(str(record.settings.get("scan", {}).get("method")), ""),
        version=__version__,
        timestamp=record.measured_at,
    )
    return with_inspection(content, out)


def _marks(out: Path, record: RunRecord, calibration: Calibration) -> tuple[CalibrationMark, ...]:
    """Which calibrations these are, and since when."""
    camera, fan = (hashlib.sha256(read_bytes(out / FILES[name])).hexdigest() for name in ("camera", "planes"))
    return (
        CalibrationMark("camera", camera_id(calibration.camera.camera), camera, record.made_at.get("camera")),
        CalibrationMark("fan", fan_id(calibration.fan.fan), fan, record.made_at.get("planes")),
    )


def _rig_in_words(rig: Rig, image_size: tuple[int, int], words: Words) -> Mapping[str, str]:
    size = {"width": image_size[0], "height": image_size[1]}
    picture = "{width} × {height} px, {channel} channel" if rig.channel else "{width} × {height} px"
    angle = words.general(math.degrees(rig.angle))
    said = {
        "Picture": words.known(picture).format(**size, channel=rig.channel),
        "Camera target": target_in_words(rig.camera_target, words),
        "Plane target": target_in_words(rig.plane_target, words),
        "Fixed laser": words("{n} lines, {angle}° apart", n=rig.lines, angle=angle)
        if rig.lines > 1
        else words("1 line"),
    }
    if rig.gauge and rig.gauge.nominal_mm is not None and rig.gauge.tolerance_mm is not None:
        nominal, tolerance = words.general(rig.gauge.nominal_mm), words.general(rig.gauge.tolerance_mm)
        said["Nominal"] = f"{nominal} mm ± {tolerance} mm"
    return said


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
