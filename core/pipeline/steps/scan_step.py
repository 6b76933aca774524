"""Scan step: reference and frames → cloud.ply, mesh.ply, scan.npz."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.pipeline.steps.check_step import check_of_the_day, since_calibration
from core.pipeline.steps.scan.features import boards_of_scan, scan_features, states_no_fan
from core.pipeline.steps.scan.judgement import judged_scan, section_since, solved_scan, stored_poses_of
from core.pipeline.steps.scan.notes import notes_on_scan
from core.pipeline.steps.scan.part_light import part_light, plates_of
from core.pipeline.steps.scan.pictures import SeenScan, require_frames
from core.pipeline.steps.scan.results import Measured, scan_file, write_measured
from core.pipeline.steps.scan.surface import begin_surface
from core.pipeline.steps.validity import facts_of_the_day, with_size_by_artefact
from core.pipeline.steps.workspace import Workspace
from core.progress import Progress, silent
from core.scan.preview.shown import FramePreview
from core.second_process import SecondProcess
from core.settings.options import Options


def scan_step(
    work: Workspace,
    settings: Options | None = None,
    progress: Progress = silent,
    watch: Callable[[FramePreview], None] | None = None,
    earlier: Path | None = None,
    check: Sequence[PoseFeatures] | None = None,
    seen: Callable[[], SeenScan] | None = None,
    beside: SecondProcess | None = None,
) -> Measured:
    """Measure the surface in a scan with the calibration in camera.json and planes.json, and write its results.

    Parameters
    ----------
    work, settings, progress
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
    settings, recording_set = settings or Options(), work.recording_set
    require_frames(recording_set, settings)
    with work.step("scan") as log:
        boards = boards_of_scan(log.pictures, with_size_by_artefact(work, work.calibration()), settings, progress)
        features = scan_features(log.pictures, boards.calibration, settings, progress, watch, earlier, seen)
        log.settings.update(
            {
                **settings.run_settings("scan"),
                **log.pictures.laser_channel("scan").settings,
                **states_no_fan(recording_set.rig),
            }
        )
        solved = solved_scan(
            features, boards.calibration, settings.solving(recording_set.rig.row_time_us), progress, boards.notes
        )
        calibration = solved.calibration
        shaped = begin_surface((solved.scan.cloud, features.image_size), progress, beside)
        checked = (
            check_of_the_day(log.pictures, calibration, settings.plane_stripe, progress, work.kept)
            if check is None
            else check
        )
        logged = recording_set.log("scan")
        change_by = partial(
            since_calibration,
            recording_set,
            calibration,
            checked,
            logged.acquisition(recording_set.frames),
            by_planes=solved.checked,
        )
        kept = stored_poses_of(work, calibration)
        section, of_the_day = (
            section_since(calibration, kept.stripes, features.fan),
            facts_of_the_day(work, calibration, checked=solved.checked),
        )
        judgement = judged_scan(solved, change_by, of_the_day, section, settings.method, progress)
        cloud, mesh = shaped()
        cloud = replace(cloud, sigma_common=judgement.common.sigma(cloud))
        light = part_light(solved, plates_of(kept, calibration))
        notes = notes_on_scan(work, calibration, solved, judgement, kept, light, logged)
        scan = replace(solved.scan, cloud=cloud, notes=notes)
        log.frames.extend(scan.frames)
        log.notes.extend(notes)
        file = scan_file(features, scan, judgement, calibration, log.pictures, settings, light, solved.check)
        write_measured(log, measured := Measured(scan, mesh, solved.check), file, progress)
    return measured
