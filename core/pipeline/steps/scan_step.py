"""Scan step: reference and frames → cloud.ply, mesh.ply, scan.npz."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from core.calibrate.change import Change
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.errors import InputError
from core.files.recording.features_file import read_poses
from core.files.recording.options import Options
from core.files.recording.recording_log import lost_frames, read_log
from core.files.recording.recording_set import RecordingSet, require_scan
from core.files.results.fan_file import fan_id
from core.files.results.ply import write_cloud, write_mesh
from core.files.results.scan_file import ScanFile, write_scan
from core.findings.proof import ScanFacts
from core.findings.table import gravest_first
from core.image.stripes.centreline import Centreline
from core.messages import Field, Message, plural_message
from core.model import Camera
from core.pipeline.steps.check_step import assumed_stability, since_calibration
from core.pipeline.steps.kept_features import features_key, kept_features
from core.pipeline.steps.scan_pictures import SeenScan, look_at_scan, require_frames
from core.pipeline.steps.validity import facts_of_the_day, with_size_by_artefact
from core.pipeline.steps.workspace import Calibration, StepLog, Workspace, check_size
from core.progress import Progress, silent
from core.scan import changed_section
from core.scan.bend_correction import reconstruct_twice
from core.scan.common_errors import solve_common
from core.scan.features.extraction import FeatureOptions, FrameFeatures, ReferenceFeatures, ScanFeatures, crossed
from core.scan.features.frames import left_out_notes
from core.scan.features.picture_faults import faults_first
from core.scan.method import Method
from core.scan.network.adjustment import SILENCED
from core.scan.preview.frames import Preview
from core.scan.preview.preflight import other_focus, stripe_width
from core.scan.preview.shown import FramePreview
from core.scan.reconstruct import ReconstructOptions
from core.scan.results import FrameRecord, ScanResult
from core.scan.scan_evidence import scan_evidence
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh
from core.scan.surface.fusion import fuse
from core.scan.surface.mesh import build_mesh
from core.scan.surface.normals import with_normals
from core.second_process import SecondProcess
from core.stage_times import StageTimes, stage


@dataclass(frozen=True, eq=False, slots=True)
class Measured:
    """What the scan step gives in memory; the same is in its files."""

    scan: ScanResult
    mesh: Mesh


def scan_step(
    work: Workspace,
    options: Options | None = None,
    progress: Progress = silent,
    watch: Callable[[FramePreview], None] | None = None,
    earlier: Path | None = None,
    check: Sequence[PoseFeatures] | None = None,
    seen: Callable[[], SeenScan] | None = None,
    beside: SecondProcess | None = None,
) -> Measured:
    """Measure the surface with the calibration in camera.json and planes.json.

    Parameters
    ----------
    work, options, progress
        What is measured, how, and who is told; a StageTimes learns what the stages cost on all threads.
    watch
        Shown each frame with what it would give by itself, in the order of the recording, on this thread.
    earlier
        A scan.npz: where it is of the same pictures, looked at in the same way, they are not looked at again, and there
        is nothing to watch. The results are the same, byte for byte.
    check
        The poses of the interim check, if they have been measured.
    seen
        Gives what the pictures show, if they are looked at already; there is nothing to watch then.
    beside
        A second process that takes the surface over.

    Raises
    ------
    InputError
        If a calibration is missing or wrong, there are no usable frames, or no sweep can be located.
    """
    options = options or Options()
    recording_set = work.recording_set
    require_scan(recording_set)
    require_frames(recording_set, options)
    calibration = with_size_by_artefact(work, work.calibration())
    camera, fan = calibration.camera.camera, calibration.fan.fan
    with work.step("scan") as log:
        log.settings.update(options.scan_settings)
        features = kept_features(earlier, recording_set, options, camera, progress) if earlier is not None else None
        if features is None or features.image_size != camera.image_size:
            looked = seen() if seen else _look(recording_set, calibration, options, progress, watch)
            features = _features(recording_set, looked, camera, progress)
        log.settings.update(recording_set.laser_channel("scan").settings)
        solving = ReconstructOptions(options.method, options.sigma_cut_mm, recording_set.rig.row_time_us)
        with faults_first(features.notes):
            even, scan = reconstruct_twice(features, camera, fan, solving, progress)
        shaped = _begin((scan.cloud, camera.image_size), progress, beside)
        of_scan = partial(scan_evidence, even, scan, camera, fan) if options.method == Method.NETWORK else None
        change = since_calibration(recording_set, calibration, options, progress, of_scan, check)
        section = section_change(work, calibration, features.fan)
        deviations = change.deviations
        if section is not None:
            deviations = (*deviations, section.deviation(features.fan, camera, fan))
        common = solve_common(even, scan, camera, fan, deviations, options.method, progress)
        cloud, mesh = shaped()
        scan = replace(scan, cloud=replace(cloud, sigma_common=common.sigma(cloud)))
        of_section = () if section is None else (section.note,)
        facts = with_facts_of(scan, change, section, facts_of_the_day(work, calibration))
        said = (
            *change.notes,
            *of_section,
            *facts.all_doubts,
            *notes_on_focus(work, calibration, features.fan),
        )
        if calibration.fan.readjusted is not None:
            said = (*said, calibration.fan.readjusted.note)
        notes = (*scan.notes, *said) if scan.moved else (*said, *scan.notes)
        notes = (
            *notes,
            *assumed_stability(recording_set, change, calibration.fan),
            *assumed_shutter(recording_set.rig.row_time_us, scan),
        )
        scan = replace(scan, notes=gravest_first(notes))
        log.frames.extend(scan.frames)
        left_out = left_out_notes(scan.frames)
        said_first = (*scan.notes, *left_out) if scan.moved else (*left_out, *scan.notes)
        log.notes.extend(gravest_first((*said_first, *_lost(recording_set))))
        file = _file(features, scan, calibration.id, features_key(recording_set, options, camera))
        with stage(progress if isinstance(progress, StageTimes) else None, "writing"):
            _write(log, scan, mesh, replace(file, common=common, change_p=change.p, facts=facts))
    return Measured(scan, mesh)


def _begin(
    scanned: tuple[Cloud, tuple[int, int]], progress: Progress, beside: SecondProcess | None
) -> Callable[[], tuple[Cloud, Mesh]]:
    """Have the surface made `beside`, if there is such a process; what is returned waits for it, or makes it."""
    if beside is None:
        return lambda: make_surface(scanned, progress=progress)
    made = beside.submit(make_surface, scanned, progress)
    return lambda: beside.wait(made, progress, "mesh")


def make_surface(scanned: tuple[Cloud, tuple[int, int]], /, *, progress: Progress = silent) -> tuple[Cloud, Mesh]:
    """Give a cloud its normals, and its mesh, for pictures of a size (width, height)."""
    cloud, image_size = scanned
    cloud = with_normals(cloud, progress=progress)
    surface = with_normals(fuse(cloud, image_size, progress=progress), progress=progress)
    return cloud, build_mesh(surface, progress=progress)


def with_facts_of(
    scan: ScanResult, change: Change, section: changed_section.ChangedSection | None, of_planes: ScanFacts
) -> ScanFacts:
    """The facts of the planes and the day, with those that the scan shows itself."""
    return replace(
        of_planes,
        moved=scan.moved,
        drifted=scan.drifted,
        collapsed=scan.collapsed,
        rig_changed=change.surely,
        rig_seems_changed=change.seemingly,
        section_changed=section is not None,
    )


def section_change(
    work: Workspace, calibration: Calibration, fan: Sequence[Centreline]
) -> changed_section.ChangedSection | None:
    """How the fan's stripes are skewed otherwise than in its calibration, if they surely are and its poses are kept.

    A re-adjusted fan rests on stripes of the day.
    """
    of = calibration.fan
    if of.readjusted is not None:
        return None
    try:
        poses = read_poses(work.path("poses"), fan_id(of.fan))
    except InputError:  # `notes_on_focus` tells
        return None
    lines = [pose.centrelines for pose in poses]
    return changed_section.changed_section(lines, fan, calibration.camera.camera, of.fan)


def notes_on_focus(work: Workspace, calibration: Calibration, fan: Sequence[Centreline]) -> tuple[Message, ...]:
    """A note if the fan's stripes are much wider than in its calibration; none where its poses are not kept."""
    of = calibration.fan
    try:
        poses = read_poses(work.path("poses"), fan_id(of.fan) if of.readjusted is None else of.readjusted.of)
    except InputError as error:  # the scan needs nothing of them
        return (error.message,)
    then, now = stripe_width(line for pose in poses for line in pose.centrelines), stripe_width(fan)
    note = None if then is None or now is None else other_focus(now, then)
    return () if note is None else (note,)


def assumed_shutter(row_time_us: float | None, scan: ScanResult) -> tuple[Message, ...]:
    """Give a note if nothing says how the camera reads its rows out: the sweeps of a steady hand do not either."""
    if row_time_us is not None or scan.read_out.moves:
        return ()
    return (
        Message(
            "scan.shutter_assumed",
            "Whether the camera's shutter is global or rolling is not stated ({field}); assumed is a "
            "global one. With a rolling one and a hand that moves, points are off by more than their σ says. State 0 "
            "for a global shutter.",
            field=Field("[camera] row_time_us"),
        ),
    )


def _lost(recording_set: RecordingSet) -> tuple[Message, ...]:
    """A note if frames were lost while a live scan was recorded."""
    try:
        lost = lost_frames(read_log(recording_set.frames[0].parent))
    except InputError as error:
        return (error.message,)
    if not lost:
        return ()
    return (
        plural_message(
            "scan.frames_lost",
            "{n} frame was lost while recording: camera, computer or disk were too slow.",
            "{n} frames were lost while recording: camera, computer or disk were too slow.",
            n=lost,
        ),
    )


def _look(
    recording_set: RecordingSet,
    calibration: Calibration,
    options: Options,
    progress: Progress,
    watch: Callable[[FramePreview], None] | None,
) -> SeenScan:
    """What the reference and all frames show, each of them shown as it comes."""
    camera = calibration.camera.camera

    def watching(reference: ReferenceFeatures) -> Callable[[FrameFeatures], None]:
        preview = Preview(reference, camera, calibration.fan.fan)

        def show(features: FrameFeatures) -> None:
            assert watch is not None
            watch(preview(features))
            while preview.has_more:
                preview.go_on()

        return show

    return look_at_scan(
        (recording_set, options), progress=progress, camera=camera, watching=watching if watch else None
    )


def _features(recording_set: RecordingSet, seen: SeenScan, camera: Camera, progress: Progress) -> ScanFeatures:
    """What the pictures show, with the crossings as this camera sees them."""
    width, height = seen.lines.image_size
    check_size(seen.reference, (height, width), camera)
    recording_set.hashes.update(seen.hashes)
    recording_set.chosen.update(seen.chosen)
    features = crossed(seen.lines, seen.averaged, FeatureOptions(camera=camera), progress)
    return replace(features, notes=(*seen.notes, *features.notes))


def _write(log: StepLog, scan: ScanResult, mesh: Mesh, file: ScanFile) -> None:
    log.gone.update(("profiles", "profile", "profile_table"))
    write_cloud(log.path("cloud"), scan.cloud, file.calibration_id)
    write_scan(log.path("scan"), file)
    write_mesh(log.path("mesh"), mesh, file.calibration_id)


def _file(features: ScanFeatures, scan: ScanResult, calibration_id: str, key: str) -> ScanFile:
    shown = _shown(scan.frames)
    mine = (scan.crossings.a == shown) & scan.crossings.with_fan & (scan.crossing_weights > SILENCED)
    return ScanFile(
        features=features,
        pis=scan.pis,
        covariance=scan.covariance,
        sweep_frames=scan.sweep_frames,
        fan_line=scan.fan_lines.line,
        crossings_used=np.asarray(scan.crossings.uv[mine]),
        shown=shown,
        calibration_id=calibration_id,
        features_key=key,
        speckle=scan.speckle,
        second_bounces=tuple(sorted(scan.second_bounces.pieces)),
        unsure_share=scan.unsure_share,
    )


def _shown(frames: tuple[FrameRecord, ...]) -> int | None:
    """The frame to show: of those that meet most lines of the fan, the one with most points."""
    used = [frame for frame in frames if frame.used]
    return max(used, key=lambda frame: (frame.fan_lines_met, frame.points, -frame.index)).index if used else None
