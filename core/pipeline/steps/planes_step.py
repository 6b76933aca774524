"""Planes step: pictures of the plane target with the fan on (and off) → planes.json."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from core.acquire.channel import PLAIN_CHANNELS, is_difference
from core.acquire.grey import has_colours, to_grey
from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.calibrate.fan.poses.plane_pose import ExtraPictures, measure_plane_pose
from core.calibrate.fan.poses.pose_features import PoseFeatures, usual_stripe
from core.calibrate.fan.verdict import Constrained
from core.calibrate.results import CameraCalibration, FanCalibration
from core.errors import InputError
from core.files.pictures import Picture, compression_of
from core.files.recording.features_file import write_poses
from core.files.recording.laser_channel import LaserChannel
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import RecordingSet, require_planes
from core.files.recording.rig import Rig
from core.files.recording.set_listing import FURTHER, PlanePair
from core.files.results.camera_file import read_camera
from core.files.results.planes_file import planes_id, read_planes, write_planes
from core.image.exclusion import Exclusion
from core.image.mosaic import ALL_SITES
from core.image.repeated import Repeats, pixels_of
from core.image.stripes.exchanged import EXCHANGED, PAIRS_TRIED, are_exchanged, light_off_over_on
from core.image.stripes.noise import Compression
from core.image.stripes.stripe import StripeSettings
from core.image.stripes.told_width import stated_width_notes
from core.messages import Command, Message
from core.model import Camera
from core.pipeline.steps.no_stripe import also_look_at_ridges, write_ridges
from core.pipeline.steps.target_sizes import with_compared_sizes
from core.pipeline.steps.workspace import Workspace, check_size
from core.progress import Progress, silent
from core.second_process import SecondProcess, shared_map
from core.settings.options import STRIPE, Options, run_exclusions, run_value
from core.stage_times import stage

FOLDER = "planes/"
"""In front of a pose's name where pictures of all kinds are named, as in the options."""
_EXCHANGE = Message("advice.exchange_names", "give each NAME its NAME_off's name, and the other way round")


def planes_step(
    work: Workspace,
    settings: Options | None = None,
    progress: Progress = silent,
    beside: SecondProcess | None = None,
) -> FanCalibration:
    """Calibrate the fan of a set with the camera in camera.json, and write planes.json.

    The process `beside` takes some of the poses.

    Raises
    ------
    InputError
        If camera.json is missing or wrong, the pictures have another size, or the poses do not determine the fan.
    """
    settings = settings or Options()
    require_planes(work.recording_set)
    given = read_camera(work.path("camera"))
    camera = given.camera
    with work.step("planes") as log:
        log.settings.update(plane_run_settings(work.recording_set.rig, settings))
        log.settings.update(log.pictures.laser_channel("planes").settings)
        poses = measure_poses(log.pictures, camera, progress, settings.plane_stripe, beside)
        ridges = write_ridges(work, log.pictures, poses, camera, settings.plane_stripe)
        try:
            calibration = solve_planes(poses, camera, work.recording_set.rig, settings, progress, given)
        except InputError as error:
            raise (error if ridges is None else also_look_at_ridges(error)) from None
        check_agreement(calibration, settings.accept_few_poses)
        calibration = with_acquisition(calibration, work.recording_set)
        calibration, sizes = with_compared_sizes(calibration, log.pictures, camera)
        log.notes.extend(sizes)
        log.notes.extend(note for pose in poses for note in pose.notes)
        log.notes.extend((*calibration.all_notes, *work.recording_set.not_read("planes")))
        log.notes.extend(() if ridges is None else (ridges,))
        write_planes(log.path("planes"), calibration, camera)
        write_poses(log.path("poses"), planes_id(calibration.fan), poses)
    return read_planes(work.path("planes"), camera)


def check_agreement(calibration: FanCalibration, decided: bool) -> None:
    """Raise InputError if the planes rest on a minority of the poses, unless it was `decided` that they may."""
    if calibration.minority is not None and not decided:
        raise InputError(
            calibration.minority,
            where="planes",
            todo=Message(
                "advice.few_poses_agree",
                "look at the poses left out, the target's size and the camera; or decide to use these planes{command}",
                command=Command("--accept-few-poses"),
            ),
        )


def measure_poses(
    pictures: PictureReader,
    camera: Camera,
    progress: Progress = silent,
    stripe: StripeSettings | None = None,
    beside: SecondProcess | None = None,
) -> tuple[PoseFeatures, ...]:
    """Find plane target and stripes in every pose; `stripe` is the stripes' width and contrast (None: estimated).

    A few are read at a time.

    The process `beside` takes some of them.

    Raises
    ------
    InputError
        If there are no poses, their pictures have another size than the camera's, or on and off are exchanged.
    """
    recording_set = pictures.recording_set
    require_planes(recording_set)
    part = recording_set.part_of(recording_set.planes[0].on)  # an interim check has its pictures in a folder of its own
    chosen = pictures.laser_channel(part)
    measure = partial(_measure, recording_set, pictures.channels, camera, stripe)
    features: list[PoseFeatures] = []
    total, pairs = len(recording_set.planes), sum(pair.off is not None for pair in recording_set.planes)
    progress("plane poses", 0, total)
    poses = shared_map(
        measure, recording_set.planes, beside, lambda: progress("plane poses", len(features), total), progress
    )
    repeats, ratios = Repeats(), list[float]()
    for pose, hashes, (pixels, ratio) in poses:
        pictures.learn(hashes, {})
        ratios += [] if ratio is None else [ratio]
        if len(ratios) == min(PAIRS_TRIED, pairs) > 1 and are_exchanged(ratios):
            raise InputError(EXCHANGED, where=recording_set.where(part), todo=_EXCHANGE)
        features.append(PoseFeatures(pose.name, None, (), Exclusion.REPEATED) if repeats.is_repeat(*pixels) else pose)
        progress("plane poses", len(features), total)
    of_all = (*chosen.notes(part), *stated_width_notes(stripe, [usual_stripe(features)]))
    features[0] = replace(features[0], notes=(*of_all, *features[0].notes))
    return tuple(features)


def _measure(
    recording_set: RecordingSet,
    channels: Mapping[str, LaserChannel],
    camera: Camera,
    stripe: StripeSettings | None,
    pair: PlanePair,
    /,
    *,
    progress: Progress,
) -> tuple[PoseFeatures, Mapping[str, str], tuple[tuple[bytes, ...], float | None]]:
    """Target and stripes of one pose, the hashes of its pictures, and what these are known by.

    That are their pixels, and how much more of the light the off picture has; None: there is none, or it is damaged.
    """
    pictures = PictureReader(recording_set, channels)
    try:
        with stage(progress, "decoding"):
            lit = pictures.read_colours(pair.on)
            unlit = pictures.read_colours(pair.off) if pair.off is not None else None
            beside = _beside(pictures, pair, lit, unlit)
    except InputError as error:
        return PoseFeatures(pair.name, None, (), error.reason), pictures.hashes, ((), None)
    channel = pictures.laser_channel(recording_set.part_of(pair.on)).channel
    on, off = to_grey(lit, channel), None if unlit is None else to_grey(unlit, channel)
    pixels = tuple(pixels_of(picture) for picture in (on, off) if picture is not None)
    features = _pose_features(pictures, camera, stripe, pair, (on, off, beside), progress)
    ratio = None if off is None else light_off_over_on(on, off)
    if features.view is not None and not features.target_moved and ratio is not None and are_exchanged([ratio]):
        features = replace(features, centrelines=(), exclusion=EXCHANGED)  # between dark lines there seem to be some
    return features, pictures.hashes, (pixels, ratio)


def _pose_features(
    pictures: PictureReader,
    camera: Camera,
    stripe: StripeSettings | None,
    pair: PlanePair,
    read: tuple[Picture, Picture | None, ExtraPictures],
    progress: Progress,
) -> PoseFeatures:
    on, off, beside = read
    check_size(pair.on, on.shape, camera)
    if off is not None and off.dtype != on.dtype:
        reason = Message("fan.depths_differ", "the pictures with the fan on and off differ in depth (8 or 16 bit)")
        return PoseFeatures(pair.name, None, (), reason)
    rig = pictures.recording_set.rig
    with stage(progress, "plane poses"):
        return measure_plane_pose(pair.name, on, off, rig.plane_target, camera, stripe, rig.plane_margin_mm, beside)


def _beside(pictures: PictureReader, pair: PlanePair, lit: Picture, unlit: Picture | None) -> ExtraPictures:
    """What there is of a pose beside its two pictures, which are `lit` and `unlit` as their files have them."""
    part = pictures.recording_set.part_of(pair.on)
    channel = pictures.laser_channel(part).channel
    compression, further = compression_of(pair.on, channel), list[tuple[Picture, Picture | None]]()
    for number in FURTHER:
        on = pictures.read_further(pair.on, number)
        if on is not None:
            further.append((on, None if pair.off is None else pictures.read_further(pair.off, number)))
    sites = pictures.sites(part)
    others = _other_channels(pictures, pair, lit, unlit) if part == "planes" else {}
    if not is_difference(channel) and sites == ALL_SITES:
        return ExtraPictures(None, compression, further, others=others)
    dark = pictures.read_target(pair.off) if pair.off is not None else None
    return ExtraPictures((pictures.read_target(pair.on), dark), compression, further, sites, others)


def _other_channels(
    pictures: PictureReader, pair: PlanePair, lit: Picture, unlit: Picture | None
) -> Mapping[str, tuple[Picture, Picture, Compression]]:
    """A pair of colour pictures in each channel but the one in use; nothing of raw ones: most sites do not see it."""
    raw = pictures.recording_set.rig.mosaic is not None
    if raw or unlit is None or not (has_colours(lit) and has_colours(unlit)) or lit.dtype != unlit.dtype:
        return {}
    used = pictures.laser_channel("planes").channel
    return {
        channel: (to_grey(lit, channel), to_grey(unlit, channel), compression_of(pair.on, channel))
        for channel in PLAIN_CHANNELS
        if channel != used
    }


def solve_planes(
    poses: Sequence[PoseFeatures],
    camera: Camera,
    rig: Rig,
    settings: Options | None = None,
    progress: Progress = silent,
    calibration: CameraCalibration | None = None,
) -> FanCalibration:
    """Calibrate the fan's light planes from all poses but those left out by hand.

    The camera's `calibration` is needed where the settings have the camera adjusted; without it, it is not. What it
    says of the shape of a target that both steps use holds here as well.

    Raises
    ------
    InputError
        If the poses do not determine the fan.
    """
    settings = settings or Options()
    excluded = {name.removeprefix(FOLDER) for name in settings.excluded}
    adjusted = calibration.covariance if calibration is not None and settings.adjust_camera else None
    known = fan_options(rig, settings)
    if calibration is not None and rig.one_target:
        known = replace(known, board=calibration.board)
    return fit_fan(poses, camera, known, progress, excluded, adjusted)


def with_acquisition(calibration: FanCalibration, recording_set: RecordingSet) -> FanCalibration:
    """Add to a fan's calibration by which camera and when its pictures were taken, as their log tells."""
    log = recording_set.log("planes")
    taken = log.acquisition([path for pair in recording_set.planes for path in (pair.on, pair.off) if path is not None])
    return replace(calibration, taken=taken, notes=(*calibration.notes, *log.notes))


def fan_options(rig: Rig, settings: Options) -> FanOptions:
    """Make the options of calibrating the fan: lines, angle, target, and whether its planes may share one line."""
    constrained: Constrained = "auto" if settings.constrain_fan else "never"
    return FanOptions(rig.lines, rig.angle or None, constrained, rig.plane_board)


def plane_run_settings(rig: Rig, settings: Options) -> dict[str, object]:
    """Collect the settings that a fan was calibrated with, for run.json."""
    fan = fan_options(rig, settings)
    told: dict[str, object] = {"lines": fan.lines, "angle_rad": fan.angle, "constrained": fan.constrained}
    told |= {"scale_sd": fan.target.size_sd, "flatness_mm": fan.target.flatness_sd_mm}
    if settings.plane_stripe is not None:
        told["stripe"] = run_value(STRIPE, settings.plane_stripe)
    if settings.adjust_camera:
        told["camera"] = "adjusted"
    return {**told, **run_exclusions(settings.excluded)}
