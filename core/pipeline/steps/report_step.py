"""Report step: all results in the folder → report.pdf."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any, Literal

import numpy as np
from scipy.spatial import cKDTree

from core import __version__
from core.checks.artefact_check import ArtefactCheck
from core.errors import InputError
from core.files.arrays_file import read_arrays
from core.files.atomic import write_bytes
from core.files.project.calibration_store import IMPORTED
from core.files.reading import file_hash, read_json
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import RIG
from core.files.recording.rig import Rig, rig_to_toml
from core.files.recording.set_listing import taken_at
from core.files.results.camera_file import camera_id
from core.files.results.check_file import InterimCheck, read_check
from core.files.results.gauge_file import read_gauge
from core.files.results.inspection_file import MEMBERS, InspectionFile, read_inspection
from core.files.results.planes_file import planes_id
from core.files.results.ply import read_cloud, read_mesh
from core.files.results.profile_file import read_profiles_file
from core.files.results.run_file import RunRecord, read_run
from core.files.results.scan_file import ScanFile, read_scan
from core.files.step_graph import FILES
from core.image.display import in_8_bit
from core.image.stripes.centreline import Centreline
from core.inspect.plan.feature_spec import Deviation
from core.inspect.results import GaugeResult
from core.inspect.step_height import profile_axes
from core.messages import Command, Message, label
from core.model import Camera
from core.model.arrays import Array
from core.pipeline.steps.brought_sections import with_brought_sections
from core.pipeline.steps.validity import history_of
from core.pipeline.steps.workspace import Calibration, Workspace, check_calibration, read_calibration, states_fan
from core.progress import Progress, silent
from core.report.content import CalibrationMark, Deviations, LightProfiles, Overlay, ReportContent
from core.report.wording import Words, target_in_words
from core.scan.method import Method
from core.scan.surface.cloud import FAN, Cloud
from core.scan.surface.fused_surface import Mesh
from core.second_process import SecondProcess
from core.settings.options import settings_of

METHOD_IN_WORDS: dict[str, str] = {
    Method.NETWORK: label(
        "all sweeps adjusted together as one network, tied to the fan and to each other by their crossings"
    ),
    Method.THREE_CROSSINGS: label(
        "each sweep located from its own crossings with the fan (Sun et al. 2023, section 4)"
    ),
}
BY_PLANES_ALONE = label(
    "all sweeps adjusted together as one network, tied to known planes and to each other by their crossings"
)
"""Of the network where there is no fan."""
WITHOUT_SWEEPS = label("no sweeps: steps on the light profiles of the fixed fan alone")
METHODS = (label("network"), label("three-crossings"))
"""As the settings name them."""
ATTACHED = ("camera", "planes", "check", "gauge", "profile", "inspection", "comparison")
"""Results that a report has with it as they are, for programs to read; run.json ends after the report only."""
RIG_ID = 12
"""Hex digits of a rig's hash that name it."""

_SAME_POINT_PX = 0.01
"""A point of a centreline and one of the cloud that are nearer than this in the picture are the same."""

Said = Callable[[ReportContent], ReportContent]
"""Adds what people say to what was measured."""


def report_step(
    work: Workspace, progress: Progress = silent, said: Said | None = None, beside: SecondProcess | None = None
) -> Path:
    """Write the results in the folder into report.pdf; `said` adds the user's texts. Return its path.

    The process `beside` draws it, if there is one.

    Raises
    ------
    InputError
        If a result is missing, damaged, or was measured with another calibration.
    """
    with work.step("report", measures=False) as log:
        content = report_content(work, log.pictures, progress, said)
        if beside is None:
            data = draw_report(content, progress=progress)
        else:
            data = beside.wait(beside.submit(draw_report, content, progress), progress, "report")
        write_bytes(log.path("report"), data)
    return work.path("report")


def prepare_report(_: object, /, *, progress: Progress = silent) -> None:
    """Import the modules that draw and typeset a report, in a process that is idle until there is one."""
    from core.report.pdf import prepare

    prepare()


def draw_report(content: ReportContent, /, *, progress: Progress = silent) -> bytes:
    """Draw a report of `content` and return the PDF's bytes; the modules needed are imported only here."""
    from core.report.pdf import build_report

    return build_report(content, progress)


def report_content(
    work: Workspace, pictures: PictureReader, progress: Progress = silent, said: Said | None = None
) -> ReportContent:
    """Collect the content of the report from the results and the pictures they come from.

    InputError as `report_step`.
    """
    progress("report", 0, 1)
    content = results_content(work.out, work.part, work.record())
    rig = work.recording_set.rig
    scan = None if content.profiles else read_scan(work.path("scan"))
    content = replace(
        content,
        rig_id=content.rig_id or hashlib.sha256(rig_to_toml(rig).encode()).hexdigest()[:RIG_ID],
        overlay=_overlay(pictures, scan, content.cloud) if scan else None,
        attachments={FILES[one]: work.path(one).read_bytes() for one in ATTACHED if work.path(one).exists()},
        artefacts=_artefacts(work),
        certificates=rig.all_certificates,
        reported=datetime.now().astimezone().date(),
    )
    content = said(content) if said else content
    channel = work.record().settings.get("scan", {}).get("channel") or rig.channel_of("scan")
    words = Words.of(content.language)
    return replace(
        content,
        rig=_rig_in_words(rig, content.camera.camera.image_size, channel, words),
        part_celsius=rig.part.celsius if content.part_celsius is None else content.part_celsius,
    )


def _artefacts(work: Workspace) -> tuple[ArtefactCheck, ...]:
    """Known artefacts that were measured with the same calibrations; none where the rig's history cannot be read."""
    calibration = work.calibration()
    try:
        history = history_of(work.recording_set.rig, calibration.id)
    except InputError:
        return ()  # facts_of_the_day has told it
    return history.artefacts(calibration.id, taken_at(work.recording_set.frames))


def results_content(out: Path, part: str = "", record: RunRecord | None = None) -> ReportContent:
    """Collect a report's content from the results in the folder `out` alone, without pictures and rig.

    `record` is what is known of the run; None: what run.json says.

    Raises
    ------
    InputError
        If a result is missing, damaged, or was measured with another calibration.
    """
    record = record or read_run(out / FILES["run"])
    calibration = read_calibration(out, has_fan=states_fan(record))
    gauge_path = out / FILES["gauge"]
    profiled = (out / FILES["profile"]).exists()
    scan = None if profiled else _scan(out, calibration)
    cloud, mesh = _profiled(out, calibration) if scan is None else _scanned(out, calibration)
    gauge = read_gauge(gauge_path, cloud) if gauge_path.exists() else None
    method = str(record.settings.get("scan", {}).get("method"))
    content = ReportContent(
        part=part or record.part,
        rig={},
        camera=calibration.camera,
        fan=calibration.fan,
        cloud=cloud,
        mesh=mesh,
        gauge=gauge,
        calibrations=_marks(out, record, calibration),
        rig_id=record.inputs.get(RIG, "")[:RIG_ID],
        frames=record.frames,
        hashes=record.inputs,
        settings=_settings_in_words(record, profiled=profiled),
        notes=record.all_notes,
        method=WITHOUT_SWEEPS if profiled else method_in_words(method, has_fan=calibration.fan.fan.lines > 0),
        version=__version__,
        timestamp=record.measured_at,
        simulated=record.simulated,
        profiles=_light_profiles(out, cloud, gauge) if profiled and gauge else None,
        known_planes=() if scan is None else scan.planes,
        plane_check=None if scan is None else scan.plane_check,
    )
    content = replace(with_inspection(content, out), check=_check(out, calibration))
    return with_brought_sections(content, out)


def method_in_words(method: str, *, has_fan: bool) -> str:
    """Describe how sweeps were located by a `method` of the settings; without a fan, known planes alone do that."""
    return METHOD_IN_WORDS.get(method, "") if has_fan else BY_PLANES_ALONE


def _check(out: Path, calibration: Calibration) -> InterimCheck | None:
    """The interim check of these calibrations; None where there is none."""
    path = out / FILES["check"]
    check = read_check(path) if path.exists() else None
    return check if check is not None and check.calibration_id == calibration.id else None


def _scan(out: Path, calibration: Calibration) -> ScanFile:
    scan = read_scan(out / FILES["scan"])
    check_calibration(out / FILES["scan"], scan.calibration_id, calibration)
    return scan


def _scanned(out: Path, calibration: Calibration) -> tuple[Cloud, Mesh]:
    cloud_file = read_cloud(out / FILES["cloud"])
    check_calibration(out / FILES["cloud"], cloud_file.calibration_id, calibration)
    return cloud_file.cloud, read_mesh(out / FILES["mesh"])


def _profiled(out: Path, calibration: Calibration) -> tuple[Cloud, Mesh]:
    """The points of the picture that is shown, which stand first in the file, and no mesh."""
    file = read_cloud(out / FILES["profiles"])
    check_calibration(out / FILES["profiles"], file.calibration_id, calibration)
    none = np.zeros((0, 3))
    shown = file.cloud.select(file.cloud.frame == file.cloud.frame[0])
    return shown, Mesh(none, none, np.zeros(0), none.astype(np.int64))


def _light_profiles(out: Path, cloud: Cloud, gauge: GaugeResult) -> LightProfiles | None:
    file = read_profiles_file(out / FILES["profile"])
    normal = gauge.normal
    if normal is None:
        return None
    along, up = profile_axes(normal, cloud)
    foot = float(np.mean(cloud.points[gauge.lower.indices] @ up))
    position, height = cloud.points @ along, cloud.points @ up - foot
    numbers = FAN + 1 - cloud.sweep
    given = [one for one in file.pictures if one.reason is None]
    shown = next(one for one in given if one.index == file.shown)
    return LightProfiles(
        shown.name,
        tuple((int(n), position[numbers == n], height[numbers == n]) for n in np.unique(numbers)),
        shown.thickness_mm,
        np.array([one.thickness_mm for one in given]),
        np.array([one.own_mm for one in given]),
        file.thickness_mm,
        file.U_mm,
    )


def _marks(out: Path, record: RunRecord, calibration: Calibration) -> tuple[CalibrationMark, ...]:
    """Which calibrations these are, and since when."""
    ids: dict[Literal["camera", "planes"], str] = {"camera": camera_id(calibration.camera.camera)}
    if calibration.fan.fan.lines:
        ids["planes"] = planes_id(calibration.fan.fan)
    return tuple(
        CalibrationMark(name, mark, file_hash(out / FILES[name]), record.made_at.get(name))
        for name, mark in ids.items()
    )


def _rig_in_words(rig: Rig, image_size: tuple[int, int], channel: str | None, words: Words) -> Mapping[str, str]:
    size = {"width": image_size[0], "height": image_size[1]}
    angle = words.general(math.degrees(rig.angle))
    said = {
        label("Picture"): words("{width} × {height} px, {channel} channel", **size, channel=channel)
        if channel
        else words("{width} × {height} px", **size),
    }
    if "camera_target" not in rig.unstated:
        said[label("Camera target")] = target_in_words(rig.camera_target, words)
    if "plane_target" not in rig.unstated:
        said[label("Plane target")] = target_in_words(rig.plane_target, words)
    if rig.reference is not None:
        said[label("Reference target")] = target_in_words(rig.reference.target, words)
    if rig.has_fan:
        said[label("Fixed laser")] = (
            words("{n} lines, {angle}° apart", n=rig.lines, angle=angle) if rig.lines > 1 else words("1 line")
        )
    return said


def _settings_in_words(record: RunRecord, *, profiled: bool) -> Mapping[str, Message | str]:
    words: dict[str, Message | str] = {}
    scan = {} if profiled else record.settings.get("scan", {})
    camera = record.settings.get("camera", {})
    for row in settings_of("scan"):
        if row.setting.reported is not None and row.key in scan:
            title, worded = row.setting.reported
            words[title] = worded(scan[row.key])
    if camera and IMPORTED not in camera:
        fixed = {"γ"} - ({"γ"} if camera.get("skew") else set()) | set(camera.get("fixed", ()))
        free = [name for name in ("α", "β", "γ", "u0", "v0", "k1", "k2", "p1", "p2") if name not in fixed]
        written = ", ".join(free + (["k3"] if camera.get("k3") else []))
        words[label("Free camera parameters")] = written.translate(str.maketrans("0123", "₀₁₂₃"))
    return words


def _overlay(pictures: PictureReader, scan: ScanFile, cloud: Cloud) -> Overlay | None:
    """The frame to show with what was found in it, or None if it is there no more."""
    if scan.shown is None:
        return None
    shown = scan.features.frames[scan.shown]
    try:
        picture = pictures.read(pictures.recording_set.path_of(shown.name))
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


_AGAIN = Message(
    "advice.inspect_scan_again",
    "inspect the scan again{command}",
    command=Command("trisect inspect SET --plan plan.toml --out DIR"),
)


def with_inspection(content: ReportContent, out: Path) -> ReportContent:
    """Add every characteristic in the inspection.json of `out` to a report's content, if there is such a file.

    Raises
    ------
    InputError
        If it is damaged, or of another scan than the one reported.
    """
    path = out / FILES["inspection"]
    if not path.exists():
        return content
    file = read_inspection(path)
    calibration = "-".join(mark.id for mark in content.calibrations)
    if file.calibration_id and file.calibration_id != calibration:
        raise InputError(
            Message(
                "report.of_other_calibration",
                "is of a scan with calibration {calibration_id}, but this one has {calibration}",
                calibration_id=file.calibration_id,
                calibration=calibration,
            ),
            where=path,
            todo=_AGAIN,
        )
    beyond = [name for name, indices in file.points.items() if len(indices) and indices.max() >= len(content.cloud)]
    if beyond:
        raise InputError(
            Message("file.points_beyond_cloud", "{name} names points that the cloud does not have", name=beyond[0]),
            where=path,
            todo=_AGAIN,
        )
    return replace(
        content,
        inspected=file.characteristics,
        unmeasured=file.unmeasured,
        points={name: indices for name, indices in file.points.items() if len(indices)},
        features=file.features,
        control_frames=file.control_frames,
        datums=file.datums,
        seen_at=_seen_at(read_json(path).get("plan"), file),
        sections={name: profile for name, profile in file.sections.items() if len(profile)},
        deviations=_deviations(path, file, content.camera.camera),
        notes=tuple(dict.fromkeys((*content.notes, *file.notes, *file.problems))),
    )


def _deviations(path: Path, file: InspectionFile, camera: Camera) -> tuple[Deviations, ...]:
    """The comparisons with nominal surfaces, as the camera sees them."""
    arrays_path = path.with_suffix(".npz")
    compared = [(number, name) for number, (name, kind) in enumerate(file.kinds.items()) if kind == "deviation"]
    if not compared or not arrays_path.exists():
        return ()
    arrays, plan = read_arrays(arrays_path, MEMBERS, todo=_AGAIN), read_json(path).get("plan")
    shown = []
    for number, name in compared:
        table = arrays.get(f"deviation_{number}", np.zeros((0, 4)))
        if len(table):
            uv = camera.project(table[:, :3])
            shown.append(Deviations(name, uv, table[:, 3], _tolerance(plan, name)))
    return tuple(shown)


def _seen_at(plan: Any, file: InspectionFile) -> dict[str, str]:
    """Of features that used no points of their own, the first one they were derived from that did."""
    features: Sequence[Any] = plan.get("feature", ()) if isinstance(plan, Mapping) else ()
    derived = {one["name"]: one.get("of", ()) for one in features if isinstance(one, Mapping) and "name" in one}
    used = {name for name, indices in file.points.items() if len(indices)}
    return {
        name: next(one for one in of if one in used)
        for name, of in derived.items()
        if name not in used and used.intersection(of)
    }


def _tolerance(plan: Any, name: str) -> float:
    """The tolerance a plan states for the comparison of this name, or the usual one."""
    features: Sequence[Any] = plan.get("feature", ()) if isinstance(plan, Mapping) else ()
    for one in features:
        if isinstance(one, Mapping) and one.get("name") == name and "deviation" in one:
            return float(one["deviation"]["tolerance_mm"])
    return Deviation("").tolerance_mm
