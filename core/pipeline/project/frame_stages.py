"""Every stage from a picture to its crossings, for looking at one frame of a recording after another."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from core.errors import InputError
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import RecordingSet
from core.image.display import in_8_bit, white_level
from core.image.exclusion import Reason
from core.image.mosaic import Sites
from core.image.stripes.ridge_picture import ridge_strength
from core.image.stripes.stripe import StripeSettings
from core.messages import Message
from core.model import Camera, Fan
from core.pipeline.steps.scan.pictures import at_sites, feature_options, of_whole, reference_picture, used_frames
from core.progress import Progress, StepProgress, silent
from core.scan.features.extraction import (
    LOOK_AHEAD,
    FrameReader,
    ReferenceFeatures,
    choose_sweep_stripe,
    read_reference,
)
from core.scan.preview.frames import Preview, PreviewOptions
from core.scan.preview.shown import FrameStages, SettledScan
from core.scan.sweeps.fan_lines import UNASSIGNED, FanLines, possible_fan_lines
from core.settings.options import Options

STRIPE_AT = 160.0
"""Difference and ridge strength are shown so that a rather faint stripe has this grey level."""


def frame_stages(
    recording_set: RecordingSet,
    name: str,
    camera: Camera | None = None,
    fan: Fan | None = None,
    settings: Options | None = None,
    progress: Progress = silent,
    settled: SettledScan | None = None,
) -> FrameStages:
    """Compute one frame of a recording at every stage of processing.

    What all frames have in common is kept until another recording is looked at.

    Parameters
    ----------
    found
        The recording.
    name
        The frame within it, as "scan/frame0007.png".
    camera, fan
        The calibrations, if there are any: without both of them there are no line numbers and crossings.
    settings
        Width and contrast of the stripes, and what is left out.
    progress
        Called with how far it is where the recording is looked at for the first time.
    settled
        What a measurement with these options has settled; found anew without it.

    Raises
    ------
    InputError
        If there is no such frame, it cannot be read or has another size than the reference, or there is no reference
        and no fan line in it.
    """
    settings = settings or Options()
    path = recording_set.path_of(name)
    if path not in recording_set.frames:
        raise InputError(Message("project.no_such_frame", "there is no such frame in the recording"), where=name)
    index = recording_set.frames.index(path)
    pictures = PictureReader(recording_set)
    common = _common(_Recording.of(pictures, settings, settled, progress))
    picture = pictures.read(path)
    base, sites = common.shown.base, common.sites
    if picture.shape != base.shape:
        raise InputError(
            Message(
                "project.picture_size_of_reference",
                "the picture has {shape2} × {shape} pixels, but the reference has {shape22} × {shape3}",
                shape2=picture.shape[1],
                shape=picture.shape[0],
                shape22=base.shape[1],
                shape3=base.shape[0],
            ),
            where=path,
        )
    move_limit_px = at_sites(feature_options(settings), sites).move_limit_px
    reader = FrameReader(common.reference, common.stripe, move_limit_px)
    features = reader((index, (name, sites.of(picture)))).in_whole_picture(sites)
    stripe = sites.stripe_in_whole_picture(common.stripe or common.reference.stripe)
    brighter = STRIPE_AT / stripe.contrast
    difference = picture.astype(np.float32) - base
    lines = _lines(common, camera, fan, settled)
    return FrameStages(
        index=index,
        name=name,
        picture=in_8_bit(picture, common.brightest),
        difference=in_8_bit(difference, 255 / brighter),
        ridge=in_8_bit(ridge_strength(difference, stripe), 255 / brighter),
        brighter=brighter,
        sweep=features.centrelines,
        fan=common.shown.fan,
        fan_line=lines.line if lines else (UNASSIGNED,) * len(common.shown.fan),
        seen=Preview(common.shown, camera, fan, PreviewOptions(thin=1), lines)(features)
        if camera and fan and fan.lines
        else None,
        shift_px=features.shift_px,
        left_out=name in settings.excluded,
        reason=features.reason,
        bounced=tuple(piece for frame, piece in settled.second_bounces if frame == index) if settled else (),
    )


@dataclass(frozen=True, slots=True)
class _Common:
    """What all frames of a recording have in common; `brightest` is white in their pictures.

    `reference` and `stripe` are in px of the `sites` that are looked at, `shown` is the reference in px of the whole
    picture.
    """

    reference: ReferenceFeatures
    stripe: StripeSettings | None
    shown: ReferenceFeatures
    sites: Sites
    brightest: float


@dataclass(frozen=True, slots=True)
class _Recording:
    """A recording as a key: equal if what its frames have in common is."""

    reference: Path | None
    written_ns: int
    taken: tuple[Path, ...]
    channel: str | None
    sites: Sites
    stripe: StripeSettings | None
    settled: SettledScan | None
    has_fan: bool
    pictures: PictureReader = field(compare=False)
    settings: Options = field(compare=False)
    progress: Progress = field(compare=False)

    @classmethod
    def of(
        cls, pictures: PictureReader, settings: Options, settled: SettledScan | None, progress: Progress
    ) -> _Recording:
        recording_set = pictures.recording_set
        reference = recording_set.reference
        written = reference.stat().st_mtime_ns if reference is not None and reference.exists() else 0
        taken = tuple(used_frames(recording_set, settings)) or recording_set.frames
        seen = taken if reference is None else taken[:LOOK_AHEAD]
        return cls(
            reference,
            written,
            seen,
            pictures.laser_channel("scan").channel,
            pictures.sites("scan"),
            settings.stripe,
            settled,
            recording_set.rig.has_fan,
            pictures,
            settings,
            progress,
        )


@lru_cache(maxsize=2)
def _common(recording: _Recording) -> _Common:
    pictures, settings, settled, sites = recording.pictures, recording.settings, recording.settled, recording.sites
    told = StepProgress(recording.progress)
    told("reference", 0, 2)
    picture, _ = reference_picture(pictures, None, settings, told.within_step)
    looking = feature_options(settings)
    if settled:
        looking = feature_options(Options(stripe=settled.fan_stripe))
    looking = replace(looking, has_fan=recording.has_fan)
    reference = read_reference(sites.of(picture), at_sites(looking, sites))
    told("reference", 1, 2)
    stripe = sites.stripe_of(settled.sweep_stripe if settled else settings.stripe)
    if stripe is None:
        stream = pictures.stream(recording.taken[:LOOK_AHEAD])
        ahead = [(name, sites.of(picture)) for name, picture in stream if not isinstance(picture, Reason)]
        stripe = choose_sweep_stripe(ahead, reference, told.within_step)
    told("reference", 2, 2)
    return _Common(reference, stripe, of_whole(reference, sites, picture), sites, white_level(picture))


def _lines(common: _Common, camera: Camera | None, fan: Fan | None, settled: SettledScan | None) -> FanLines | None:
    """The numbers of the fan's centrelines: the settled ones if they are of these very pieces, else the likeliest."""
    pieces = common.shown.fan
    if settled and len(settled.fan_line) == len(pieces):
        return FanLines.settled_as(settled.fan_line)
    return possible_fan_lines(pieces, camera, fan)[0] if camera and fan and fan.lines else None
