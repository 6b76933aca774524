"""All notes of a scan, in one order."""

from __future__ import annotations

from collections.abc import Sequence

from core.errors import InputError
from core.files.recording.features_file import read_poses
from core.files.recording.recording_log import FolderLog
from core.files.results.planes_file import planes_id
from core.findings.table import gravest_first, note_of
from core.image.stripes.centreline import Centreline
from core.messages import Field, Message
from core.pipeline.steps.check_step import assumed_stability
from core.pipeline.steps.scan.judgement import Judgement, Solved
from core.pipeline.steps.scan.part_light import notes_on_part_light
from core.pipeline.steps.workspace import Calibration, Workspace
from core.scan.features.frames import left_out_notes
from core.scan.part_light import PartLight
from core.scan.preview.preflight import other_focus, stripe_width
from core.scan.results import ScanResult


def notes_on_scan(
    work: Workspace,
    calibration: Calibration,
    solved: Solved,
    judgement: Judgement,
    light: PartLight | None,
    log: FolderLog,
) -> tuple[Message, ...]:
    """All that is told of a scan, the gravest first; `light` is that on its part, `log` that of its recording."""
    recording_set, readjusted, scan = work.recording_set, calibration.fan.readjusted, solved.scan
    return gravest_first(
        (
            *judgement.notes,
            *left_out_notes(scan.frames),
            *notes_on_focus(work, calibration, solved.features.fan),
            *notes_on_part_light(light),
            *(() if readjusted is None else (readjusted.note,)),
            *scan.notes,
            *assumed_stability(recording_set, judgement.change, calibration.fan),
            *assumed_shutter(recording_set.rig.row_time_us, scan),
            *log.notes,
            *notes_on_lost_frames(log.lost),
            *recording_set.not_read("scan"),
        )
    )


def notes_on_focus(work: Workspace, calibration: Calibration, fan: Sequence[Centreline]) -> tuple[Message, ...]:
    """A note if the fan's stripes are much wider than in its calibration; none where its poses are not kept."""
    of = calibration.fan
    try:
        poses = read_poses(work.path("poses"), planes_id(of.fan) if of.readjusted is None else of.readjusted.of)
    except InputError as error:  # the scan needs nothing of them
        return (error.message,)
    then, now = stripe_width(line for pose in poses for line in pose.centrelines), stripe_width(fan)
    note = None if then is None or now is None else other_focus(now, then)
    return () if note is None else (note,)


def assumed_shutter(row_time_us: float | None, scan: ScanResult) -> tuple[Message, ...]:
    """Give a note if nothing says how the camera reads its rows out: the sweeps of a steady hand do not either."""
    if row_time_us is not None or scan.read_out.moves:
        return ()
    return (note_of("scan.shutter_assumed", field=Field("[camera] row_time_us")),)


def notes_on_lost_frames(lost: int) -> tuple[Message, ...]:
    """A note if frames were lost while a live scan was recorded."""
    return (note_of("scan.frames_lost", n=lost),) if lost else ()
