"""Profile step: pictures of the fan alone → profiles.ply, profiles.csv, profile.json, gauge.json."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from core.errors import InputError, NoThickness
from core.files.pictures import compression_of
from core.files.recording.recording_set import RecordingSet
from core.files.recording.rig import GaugeSpec, part_table, require_tables
from core.files.results.gauge_file import write_gauge
from core.files.results.ply import write_cloud
from core.files.results.profile_file import PictureStep, write_profiles, write_profiles_csv
from core.files.step_graph import resting_on
from core.findings.table import note_of
from core.image.exclusion import Reason, message_of
from core.inspect.face_region import inside_polygon
from core.inspect.gauge import adjusted
from core.inspect.results import GaugeResult
from core.inspect.step_height import KnownTilt, Step, measure_steps, profile_axes, step_of
from core.inspect.uncertainty.point_errors import PointErrors
from core.messages import Message, as_json
from core.pipeline.steps.check_step import assumed_stability, check_of_the_day, since_calibration
from core.pipeline.steps.gauge_step import PART, of_part
from core.pipeline.steps.scan.judgement import SectionChange, facts_of, section_since, stored_poses_of
from core.pipeline.steps.scan.pictures import feature_options, used_frames
from core.pipeline.steps.validity import facts_of_the_day, with_size_by_artefact
from core.pipeline.steps.workspace import Calibration, StepLog, Workspace, check_size
from core.progress import Progress, silent
from core.scan.common_errors import CommonErrors
from core.scan.features.frames import FrameRecord
from core.scan.features.picture_faults import mosaic_of
from core.scan.profiles import Profiles, read_profiles
from core.scan.surface.cloud import Cloud
from core.scan.surface.triangulate import join
from core.settings.options import Options, StatedTilt

STAGE_SD = float(np.radians(0.1))
"""Standard uncertainty in rad of a stage's normal that a plate lying on it shows: thickness of its paper, burrs under
it; its pose itself is known ten times better."""
_REPLACED = ("cloud", "scan", "mesh", "report", *resting_on("cloud"))
"""Results of a scan, which would not be of the part that these profiles are of."""


@dataclass(frozen=True, eq=False, slots=True)
class MeasuredProfiles:
    """Results of measuring by the fan's profiles, in memory; its files hold the same."""

    gauge: GaugeResult
    pictures: tuple[PictureStep, ...]
    cloud: Cloud


def profile_step(
    work: Workspace,
    settings: Options | None = None,
    tilt: StatedTilt | None = None,
    progress: Progress = silent,
) -> MeasuredProfiles:
    """Measure a thickness as the height of a step in pictures of the fan alone, with camera.json and planes.json.

    Every picture of the set's scan shows the fan alone and the part; with a reference, that is the one picture.

    Parameters
    ----------
    work, settings, progress
        What is measured, how, and who is told.
    tilt
        Of the faces, for a fan of one line; others show it themselves.

    Raises
    ------
    InputError
        If a calibration is missing, a fan of one line is not told how the faces stand, or no picture gives a step.
    """
    settings, found = settings or Options(), work.recording_set
    require_tables(found.rig, found.rig_file, "laser_fan")
    paths = _pictures(found, settings)
    calibration = with_size_by_artefact(work, work.calibration())
    camera, fan = calibration.camera.camera, calibration.fan.fan
    known, spec = _known(calibration, tilt), found.rig.gauge or GaugeSpec()
    if fan.lines == 1 and known is None:
        raise InputError(
            Message("profile.one_line", "the fan has one line, which does not show how the faces are tilted"),
            where="profile",
            todo=Message(
                "profile.advice_tilt",
                "name the pose of the plane target that lay on the stage (--stage planes/NAME), or say how well the "
                "light plane stands at right angles on the faces (--tilt-sd DEGREES)",
            ),
        )
    part = found.rig.part
    with work.step("profile") as log:
        channel = log.pictures.laser_channel("scan")
        log.settings.update({**settings.run_settings("scan"), **channel.settings, **_tilt_settings(tilt)})
        looking = replace(feature_options(settings), compression=compression_of(paths[0], channel.channel))
        check = check_of_the_day(log.pictures, calibration, settings.plane_stripe, progress, work.kept)
        logged = found.log("scan")
        change = since_calibration(found, calibration, check, logged.acquisition(found.frames))
        section, kept = SectionChange(surely=None), stored_poses_of(work, calibration)
        seen: list[Profiles] = []
        steps, pictures = [], []
        stream = log.pictures.stream(paths)
        for index, (name, picture) in enumerate(stream):
            progress("profiles", index, len(paths))
            if isinstance(picture, Reason):
                pictures.append(PictureStep.none(index, name, message_of(picture)))
                continue
            check_size(paths[index], picture.shape, camera)
            try:
                profiles = read_profiles(picture, index, camera, fan, looking)
            except InputError as error:
                pictures.append(PictureStep.none(index, name, error.what))
                continue
            if not seen:  # pictures of one place have one speckle: together they tell no more than the first
                section = section_since(calibration, kept.stripes, profiles.pieces)
                common = CommonErrors.of_fan(camera, fan, (*change.deviations, *section.deviations))
                finer = mosaic_of(profiles.pieces, picture).too_fine
                facts = facts_of(facts_of_the_day(work, calibration), change, section, finer)
            seen.append(profiles)
            errors = replace(PointErrors.of_fan(profiles.pieces, common), part=part, facts=facts)
            step = step_of(_within(profiles.cloud, spec), errors, known)
            pictures.append(_row(index, name, step))
            steps += [] if isinstance(step, Message) else [step]
        progress("profiles", len(paths), len(paths))
        if not steps:
            raise _nothing(pictures)
        gauge = measure_steps(
            steps,
            one_line=not steps[0].faces.planes.tilt_determined,
            nominal_mm=spec.nominal_mm,
            tolerance_mm=spec.tolerance_mm,
        )
        shown = next(one for one in steps if one.faces.planes.normal is gauge.normal)
        cloud = _cloud(seen, shown.frame, common)
        gauge = adjusted(gauge, part.thicker_mm, part.surface_rows, part.surface_notes)
        gauge = of_part(gauge, part)
        notes = (
            *channel.notes("scan"),
            *change.notes,
            *section.notes,
            *kept.notes,
            *gauge.notes,
            *_assumed(fan.lines, tilt, shown),
            *assumed_stability(found, change, calibration.fan),
            *logged.notes,
        )
        gauge = replace(gauge, notes=notes)
        log.frames.extend(_records(pictures, seen))
        log.notes.extend(notes)
        rule = None if gauge.rule is None else as_json(gauge.rule)
        log.settings[PART] = part_table(part)
        log.settings.update({"nominal_mm": spec.nominal_mm, "tolerance_mm": spec.tolerance_mm, "rule": rule})
        _write(log, gauge, pictures, shown, cloud, calibration)
    return MeasuredProfiles(gauge, tuple(pictures), cloud)


def _within(cloud: Cloud, spec: GaugeSpec) -> Cloud:
    """The points in the regions of both faces, where such are given; else all."""
    if spec.upper_polygon_px is None or spec.lower_polygon_px is None:
        return cloud
    return cloud.select(
        inside_polygon(cloud.uv, spec.upper_polygon_px) | inside_polygon(cloud.uv, spec.lower_polygon_px)
    )


def _pictures(recording_set: RecordingSet, settings: Options) -> list[Path]:
    if recording_set.reference is not None:
        return [recording_set.reference]
    taken = used_frames(recording_set, settings)
    if taken:
        return taken
    raise InputError(
        Message("profile.no_pictures", "there are no pictures of the part under the fan"),
        where=recording_set.where("scan"),
        todo=Message("profile.advice_record", "record one or more, the hand-held laser off"),
    )


def _known(calibration: Calibration, tilt: StatedTilt | None) -> KnownTilt | None:
    """What is stated of the tilt, with the stage's normal from its pose."""
    if tilt is None:
        return None
    if not tilt.stage:
        return None if tilt.sd is None else KnownTilt(None, tilt.sd)
    name = tilt.stage.removeprefix("planes/")
    pose = next((one for one in calibration.fan.poses if one.name.removeprefix("planes/") == name and one.used), None)
    if pose is None:
        raise InputError(
            Message("profile.no_such_pose", "planes.json has no pose {name} that was used", name=name),
            where="--stage",
            todo=Message(
                "profile.advice_stage",
                "name one of {poses}",
                poses=tuple(one.name for one in calibration.fan.poses if one.used),
            ),
        )
    x, y, z = pose.pose.rotation[:, 2]
    return KnownTilt((float(x), float(y), float(z)), STAGE_SD if tilt.sd is None else tilt.sd)


def _tilt_settings(tilt: StatedTilt | None) -> dict[str, object]:
    if tilt is None:
        return {}
    return {"stage": tilt.stage, "tilt_sd_deg": None if tilt.sd is None else float(np.degrees(tilt.sd))}


def _row(index: int, name: str, step: Step | Message) -> PictureStep:
    if isinstance(step, Message):
        return PictureStep.none(index, name, step)
    points = len(step.pair.upper), len(step.pair.lower)
    return PictureStep(index, name, step.thickness_mm, step.own_mm, points)


def _nothing(pictures: Sequence[PictureStep]) -> NoThickness:
    reasons = [one.reason for one in pictures if one.reason is not None]
    return NoThickness(
        Message(
            "profile.nothing",
            "none of {n} pictures gives a step; the most common reason: {reason}",
            n=len(pictures),
            reason=max(reasons, key=lambda one: [str(other) for other in reasons].count(str(one))),
        ),
        where="profile",
        todo=Message(
            "profile.advice_both_faces",
            "let at least one line of the fan run over both faces, a few millimetres on each",
        ),
    )


def _cloud(seen: Sequence[Profiles], shown: int, common: CommonErrors) -> Cloud:
    """All points, those of the picture shown first, as gauge.json counts them."""
    ordered = sorted(seen, key=lambda one: int(one.cloud.frame[0]) != shown)
    cloud = join([one.cloud for one in ordered])
    return replace(cloud, sigma_common=common.sigma(cloud))


_ONE_LINE_ON_PART = note_of("profile.one_line_on_part")


def _assumed(lines: int, tilt: StatedTilt | None, shown: Step) -> tuple[Message, ...]:
    """What the thickness takes for granted."""
    resting = note_of("profile.assumes_rest")
    if shown.faces.planes.tilt_determined or tilt is None:
        upper = np.unique(shown.cloud.sweep[shown.pair.upper])
        return (resting,) if len(upper) > 1 else (resting, _ONE_LINE_ON_PART)
    sd = float(np.degrees(STAGE_SD if tilt.sd is None else tilt.sd))
    if tilt.stage:
        how = note_of("profile.assumes_stage", stage=tilt.stage, sd_deg=sd)
    else:
        how = note_of("profile.assumes_square", sd_deg=sd)
    return resting, how


def _records(pictures: Sequence[PictureStep], seen: Sequence[Profiles]) -> list[FrameRecord]:
    of_frame = {int(one.cloud.frame[0]): one for one in seen if len(one.cloud)}
    records = []
    for one in pictures:
        profiles = of_frame.get(one.index)
        records.append(
            FrameRecord(
                one.index,
                one.name,
                one.reason is None,
                one.reason,
                stripes=len(profiles.pieces) if profiles else 0,
                stripe_px=sum(map(len, profiles.pieces)) if profiles else 0,
                points=len(profiles.cloud) if profiles else 0,
                sigma_mm=float(np.median(profiles.cloud.sigma)) if profiles else float("nan"),
            )
        )
    return records


def _write(
    log: StepLog,
    gauge: GaugeResult,
    pictures: Sequence[PictureStep],
    shown: Step,
    cloud: Cloud,
    calibration: Calibration,
) -> None:
    log.gone.update(_REPLACED)
    write_cloud(log.path("profiles"), cloud, calibration.id)
    along, up = profile_axes(shown.faces.planes.normal, shown.cloud)
    foot = -shown.faces.planes.lower_distance
    write_profiles_csv(log.path("profile_table"), cloud, cloud.points @ along, cloud.points @ up - foot)
    write_profiles(log.path("profile"), gauge, pictures, shown.frame, calibration.id)
    write_gauge(log.path("gauge"), gauge, calibration.id)
