"""Join step: the clouds of all views and the marks in their pictures → one cloud, the joint, the thickness across."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from core.errors import InputError
from core.files.atomic import write_bytes
from core.files.json_text import to_json
from core.files.recording.carrier_file import read_carrier
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import CARRIER, FIRST_VIEW, VIEWS, further_views
from core.files.results.joint_file import joint_table, write_joint
from core.files.results.ply import read_cloud, write_cloud
from core.files.results.scan_file import read_scan
from core.image.background import quantile_reference, sample_indices
from core.inspect.results import GaugeResult
from core.messages import Message
from core.pipeline.steps.gauge_step import of_part, point_errors
from core.pipeline.steps.scan_step import scan_step
from core.pipeline.steps.workspace import Calibration, Workspace, check_calibration
from core.progress import Progress, silent
from core.settings.options import Options
from core.views.carrier import Carrier
from core.views.joined_cloud import JoinedCloud, View, join_clouds
from core.views.joint import join
from core.views.joint_check import JointCheck, check_joint, overlaps_of
from core.views.marks_seen import MarksSeen, see_marks
from core.views.thickness import faces_across, require_turned, thickness_across


@dataclass(frozen=True, eq=False, slots=True)
class JoinResult:
    """Joined views of a set, what speaks against the joint, and the thickness from the first view to the last."""

    joined: JoinedCloud
    check: JointCheck
    thickness: GaugeResult


def view_workspaces(work: Workspace) -> dict[str, Workspace]:
    """Open a workspace for each view of a set, the first that of its own scan, with the set's calibration.

    Raises
    ------
    InputError
        If a view is called as the first one, or a folder cannot be made.
    """
    found = {FIRST_VIEW: work}
    for name, view in further_views(work.recording_set).items():
        found[name] = Workspace.open(view, work.out / VIEWS / name, work.part)
        for result in ("camera", "planes"):
            _take_over(work, found[name], result)
    return found


def _take_over(work: Workspace, view: Workspace, result: str) -> None:
    """Copy a result of the calibration, with the arrays beside it, into the folder of a view."""
    path = work.path(result)
    for one in (path, path.with_suffix(".npz")):
        if one.exists():
            target = view.out / one.name
            if not target.exists() or target.read_bytes() != one.read_bytes():
                write_bytes(target, one.read_bytes())


def marks_of(work: Workspace, carrier: Carrier, view: str) -> MarksSeen:
    """Find the marks of the carrier in the picture of a view with the fan alone, or what is dark in all its frames."""
    pictures = PictureReader(work.recording_set)
    reference = work.recording_set.reference
    if reference is not None:
        return see_marks(pictures.read_board(reference), carrier, view)
    frames = work.recording_set.frames
    return see_marks(
        quantile_reference([pictures.read_board(frames[k]) for k in sample_indices(len(frames))]), carrier, view
    )


def join_step(work: Workspace, settings: Options | None = None, progress: Progress = silent) -> JoinResult:
    """Join the views of a set by the marks of its carrier, and write joined.ply and joint.json.

    A view that has not been measured, or was of other pictures or by another calibration, is measured first, with the
    calibration in camera.json and planes.json; a further view also if it was measured with other `settings`.

    Raises
    ------
    InputError
        As `joined_views`, or if there is no further view.
    """
    places = view_workspaces(work)
    if len(places) < 2:
        raise InputError(
            Message("views.no_views", "there is no further view of the part to join"),
            where=work.recording_set.rig_file.parent / VIEWS,
            todo=Message("views.advice_take_views", "turn the part over with its carrier, scan it again, and put the "
                         "pictures into a folder of their own in there"),
        )  # fmt: skip
    id_ = work.calibration().id
    for name, place in places.items():
        if not _is_scanned(place, None if name == FIRST_VIEW else settings or Options(), id_, progress):
            scan_step(place, settings, progress)
    with work.step("join") as log:
        result = joined_views(work, progress)
        joint = result.joined.joint
        log.settings["carrier"] = joint.carrier.name
        log.settings["views"] = joint_table(joint)
        log.notes.extend(result.thickness.notes)
        write_cloud(log.path("joined"), result.joined.cloud, work.calibration().id)
        write_joint(log.path("joint"), result.check, result.thickness, work.calibration().id)
    return result


def _is_scanned(view: Workspace, settings: Options | None, calibration_id: str, progress: Progress) -> bool:
    """Whether a view's results are of its pictures as they are, of this calibration and, if given, these settings."""
    if not view.path("cloud").exists() or not view.path("scan").exists():
        return False
    if read_scan(view.path("scan")).calibration_id != calibration_id:
        return False
    seen, record = view.recording_set, view.record()
    told = {"excluded": [], **record.settings.get("scan", {})}
    if settings is not None:
        wanted = {"excluded": [], **json.loads(to_json(settings.run_settings("scan")))}
        if any(told.get(name) != value for name, value in wanted.items()):
            return False
    names = {seen.name_of(path): path for path in seen.frames}
    if [frame.name for frame in record.frames] != list(names):
        return False
    used = [path for name, path in names.items() if name not in told["excluded"]]
    paths = seen.with_further(used if seen.reference is None else [seen.reference, *used])
    pictures = PictureReader(seen)
    pictures.take_hashes(paths, progress)
    return all(record.inputs.get(name) == digest for name, digest in pictures.named_hashes(paths))


def joined_views(work: Workspace, progress: Progress = silent) -> JoinResult:
    """Join the measured views of a set by the marks of their carrier, and measure the thickness across them.

    Views of the first one's side come before those of the other: the thickness goes from the first view to the last.

    Raises
    ------
    InputError
        If a result or carrier.toml is missing or wrong, or the marks do not hold a view.
    """
    carrier = read_carrier(work.recording_set.rig_file.parent / CARRIER)
    calibration = work.calibration()
    places = view_workspaces(work)
    seen = turned_last(carrier, [marks_of(place, carrier, name) for name, place in places.items()])
    joint = join(carrier, seen, calibration.camera.camera)
    views = [_view(places[name], name, calibration) for name in joint.views]
    joined = join_clouds(joint, views, scale_sd=calibration.fan.scale_sd)
    require_turned(joint)
    faces = faces_across(joined, progress)
    points = joined.cloud.points[np.concatenate([faces.upper, faces.lower])]
    up = joint.poses[0].rotation[:, 2]
    check = check_joint(joint, calibration.camera.camera, points.mean(axis=0), up, overlaps_of(joined))
    joined = replace(joined, errors=replace(joined.errors, joint_doubts=check.doubts))
    spec = work.recording_set.rig.gauge
    gauge = thickness_across(
        joined,
        faces=faces,
        nominal_mm=None if spec is None else spec.nominal_mm,
        tolerance_mm=None if spec is None else spec.tolerance_mm,
        progress=progress,
    )
    gauge = of_part(gauge, work.recording_set.rig.part)
    return JoinResult(joined, check, replace(gauge, notes=(*gauge.notes, *check.notes)))


def turned_last(carrier: Carrier, seen: Sequence[MarksSeen]) -> list[MarksSeen]:
    """Sort views so that those of the first one's side of the carrier come first; else they keep their order."""
    sides = [float(carrier.sides[carrier.index_of(view.numbers)].mean()) > 0.5 if len(view) else False for view in seen]
    return [view for _, view in sorted(zip(sides, seen, strict=True), key=lambda one: one[0] != sides[0])]


def _view(work: Workspace, name: str, calibration: Calibration) -> View:
    file, scan = read_cloud(work.path("cloud")), read_scan(work.path("scan"))
    check_calibration(work.path("cloud"), file.calibration_id, calibration)
    check_calibration(work.path("scan"), scan.calibration_id, calibration)
    return View(name, file.cloud, replace(point_errors(scan), part=work.recording_set.rig.part))
