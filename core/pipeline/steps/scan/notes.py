"""All notes of a scan, in one order."""

from __future__ import annotations

from collections.abc import Sequence

from core.files.recording.recording_log import FolderLog
from core.findings.table import gravest_first, note_of
from core.image.stripes.centreline import Centreline
from core.messages import Field, Message
from core.pipeline.steps.check_step import assumed_stability
from core.pipeline.steps.scan.judgement import Judgement, Solved, StoredPoses
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
    kept: StoredPoses,
    light: PartLight | None,
    log: FolderLog,
) -> tuple[Message, ...]:
    """Collect all notes on a scan, the gravest first, from its solution, judgement, calibration and recording.

    `kept` are the poses of its calibration, `light` is that on its part, `log` that of its recording.
    """
    recording_set, readjusted, scan = work.recording_set, calibration.fan.readjusted, solved.scan
    return gravest_first(
        (
            *judgement.notes,
            *solved.notes,
            *left_out_notes(scan.frames),
            *kept.notes,
            *notes_on_focus(kept, solved.features.fan),
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


def notes_on_focus(kept: StoredPoses, fan: Sequence[Centreline]) -> tuple[Message, ...]:
    """Make a note if the fan's stripes are much wider than in its calibration; () if not, or no poses are stored."""
    then, now = stripe_width(line for lines in kept.stripes for line in lines), stripe_width(fan)
    note = None if then is None or now is None else other_focus(now, then)
    return () if note is None else (note,)


def assumed_shutter(row_time_us: float | None, scan: ScanResult) -> tuple[Message, ...]:
    """Make a note that a global shutter is assumed, if no row time is stated and no rolling one shows; else ()."""
    if row_time_us is not None or scan.read_out.moves:
        return ()
    return (note_of("scan.shutter_assumed", field=Field("[camera] row_time_us")),)


def notes_on_lost_frames(lost: int) -> tuple[Message, ...]:
    """Make a note if frames were lost while a live scan was recorded; () if none was."""
    return (note_of("scan.frames_lost", n=lost),) if lost else ()
