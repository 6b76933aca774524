"""What the pictures of a scan show: the reference and all frames, reduced to centrelines. Needs no calibration."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.files.pictures import Picture, compression_of
from core.files.recording.laser_channel import LaserChannel
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import RecordingSet, require_scan
from core.files.recording.set_listing import FURTHER
from core.findings.table import note_of
from core.image.background import FEWEST, quantile_reference, sample_indices
from core.image.exclusion import Exclusion, Reason
from core.image.mosaic import Sites
from core.image.stripes.bracket import Exposure, fused
from core.image.stripes.told_width import stated_width_notes
from core.messages import Message
from core.model import Camera
from core.pipeline.steps.workspace import check_size
from core.progress import Progress, silent, steps
from core.scan.features.board_print import marks_on_board
from core.scan.features.extraction import (
    LOOK_AHEAD,
    FeatureOptions,
    Frame,
    FrameFeatures,
    FurtherExposures,
    ReferenceFeatures,
    SeenLines,
    choose_sweep_stripe,
    exposed,
    extract_lines,
    read_reference,
    saturated_pixels,
)
from core.scan.features.overexposure import notes_on_shine
from core.scan.features.picture_faults import faults_of, mosaic_of
from core.second_process import SecondProcess
from core.settings.options import Options
from core.stage_times import StageTimes


@dataclass(frozen=True, eq=False, slots=True)
class SeenScan:
    """Centrelines of a scan's pictures, with the hashes and channels read, which another `PictureReader` takes over.

    `averaged` are the same `lines`, averaged along themselves; `notes`, `faults` and `too_fine_for_mosaic` are those of
    `ScanFeatures`; `reference` is the picture that shows the fan alone, or the first of those it was made from.
    """

    lines: SeenLines
    averaged: SeenLines
    notes: tuple[Message, ...]
    faults: tuple[Message, ...]
    too_fine_for_mosaic: bool
    reference: Path
    hashes: Mapping[str, str]
    channels: Mapping[str, LaserChannel]


def look_at_scan(
    job: tuple[RecordingSet, Options],
    /,
    *,
    progress: Progress = silent,
    camera: Camera | None = None,
    watching: Callable[[ReferenceFeatures], Callable[[FrameFeatures], None]] | None = None,
    coming: Iterable[Path] | None = None,
) -> SeenScan:
    """Extract the centrelines of the reference and all frames of a scan.

    Parameters
    ----------
    job
        The set, and how it is looked at.
    progress
        A StageTimes learns what the stages cost on all threads.
    camera
        If it is known: it must have pictures of this size.
    watching
        Gives what is shown each frame, once the reference is read.
    coming
        All frames as they are recorded, in their order, where the set has the first ones only; none is left out.

    Raises
    ------
    InputError
        If the reference shows no line of the fan, or no frame a sweep.
    """
    found, settings = job
    pictures = PictureReader(found)
    times = progress if isinstance(progress, StageTimes) else None
    channel = pictures.laser_channel("scan")
    compression = compression_of(found.frames[0], channel.channel)
    looking = replace(feature_options(settings), compression=compression, has_fan=found.rig.has_fan)
    progress("reference", 0, 1)
    picture, note = reference_picture(pictures, camera, settings, progress)
    sites = pictures.sites("scan")
    marks = _marks(pictures, picture)
    looking = replace(at_sites(looking, sites), marks=None if marks is None else sites.of(marks))
    reference = read_reference(sites.of(picture), looking)
    further = _further_exposures(pictures, settings, looking, reference)
    factor = 1.0
    if further:
        fan, exposures = fused(_fan_seen(reference), [_fan_seen(each.reference) for each in further.values()])
        reference = replace(reference, fan=fan)
        factor = float(np.nanmax([1.0, *(each.factor for each in exposures)]))
    progress("reference", 1, 1)
    frames, total = stream_frames(pictures, settings, times, coming), len(found.frames)
    shown = of_whole(reference, sites, picture)
    watch = watching(shown) if watching else None
    seen = extract_lines(reference, _seen_at(sites, frames), total, looking, progress, watch, times, further)
    lines, averaged = (replace(each, image_size=shown.image_size) for each in seen)
    of_width = stated_width_notes(settings.stripe, lines.stripes)
    sweeps = [piece for frame in lines.frames for piece in frame.centrelines]
    shine = notes_on_shine(lines.fan, sweeps, factor * reference.full_scale)
    mosaic = mosaic_of(reference.fan, reference.base)
    notes, faults = (*channel.notes("scan"), *note, *of_width), (*faults_of(reference, mosaic), *shine)
    path = found.reference or used_frames(found, settings)[0]
    return SeenScan(lines, averaged, notes, faults, mosaic.too_fine, path, pictures.hashes, pictures.channels)


def _marks(pictures: PictureReader, reference: Picture) -> NDArray[np.bool_] | None:
    """What is printed on the boards beside a fan; None where there are none. Those not found are told elsewhere."""
    found = pictures.recording_set
    marks: NDArray[np.bool_] | None = None
    for board in found.known_planes if found.rig.has_fan else ():
        for path in board.pictures:
            with suppress(InputError):
                seen = pictures.read_board(path)
                if seen.shape == reference.shape:
                    mine = marks_on_board(board.target, seen, reference, board.stated.region_px)
                    marks = mine if marks is None else marks | mine
                    break
    return marks


def begin_looking(
    recording_set: RecordingSet, settings: Options, progress: Progress, beside: SecondProcess | None
) -> Callable[[], SeenScan] | None:
    """Start to extract a scan's centrelines in the process `beside`; return a function that waits for them.

    None where there is no such process.
    """
    if beside is None:
        return None
    seen = beside.submit(look_at_scan, (recording_set, settings), progress)
    return lambda: beside.wait(seen, progress, "frames")


def at_sites(looking: FeatureOptions, sites: Sites) -> FeatureOptions:
    """Convert options given in px of whole pictures to pictures of `sites` of a colour mosaic alone, in px of these."""
    return replace(
        looking,
        sweep_stripe=sites.stripe_of(looking.sweep_stripe),
        fan_stripe=sites.stripe_of(looking.fan_stripe),
        move_limit_px=looking.move_limit_px / sites.period,
        sites=sites,
    )


def of_whole(reference: ReferenceFeatures, sites: Sites, picture: Picture) -> ReferenceFeatures:
    """Convert what was read from the `sites` of a picture with the fan alone to px of the whole `picture`."""
    return replace(reference, base=picture, fan=sites.in_whole_picture(reference.fan))


def _seen_at(sites: Sites, frames: Iterable[Frame]) -> Iterator[Frame]:
    """The frames at these sites alone."""
    return ((name, each if isinstance(each, Reason) else sites.of(each)) for name, each in frames)


def _fan_seen(reference: ReferenceFeatures) -> Exposure:
    """The fan in a picture of it alone, as one of several exposures."""
    return exposed(reference.base, reference.fan, saturated_pixels(reference.base))


def _further_exposures(
    pictures: PictureReader, settings: Options, looking: FeatureOptions, first: ReferenceFeatures
) -> dict[int, FurtherExposures]:
    """The further exposures of the frames by their number, those with a picture of the fan alone to go with them.

    That one is made of them where it is not there, as the first one's would be.
    """
    of_number = {number: _exposures(pictures, settings, looking, first, number) for number in FURTHER}
    return {number: each for number, each in of_number.items() if each is not None}


def _exposures(
    pictures: PictureReader, settings: Options, looking: FeatureOptions, first: ReferenceFeatures, number: int
) -> FurtherExposures | None:
    """Those of one number; None if there are none, or no picture of the fan alone."""
    recording_set = pictures.recording_set
    shots = {recording_set.name_of(path): path for path in used_frames(recording_set, settings)}
    shots = {name: path for name, path in shots.items() if number in recording_set.further.get(path, {})}
    if not shots:
        return None
    again = [recording_set.further[path][number] for path in shots.values()]
    sample = list(pictures.stream([again[i] for i in sample_indices(len(again))]))
    readable = [picture for _, picture in sample if not isinstance(picture, Reason)]
    base = None if recording_set.reference is None else pictures.read_further(recording_set.reference, number)
    if base is None:
        if len(readable) < FEWEST:
            return None
        base = quantile_reference(readable)
    sites = pictures.sites("scan")
    reference = read_reference(sites.of(base), replace(looking, fan_stripe=None), first)
    stripe = choose_sweep_stripe(list(_seen_at(sites, sample[:LOOK_AHEAD])), reference)

    def read(name: str) -> Picture | None:
        try:
            picture = pictures.read_further(shots[name], number) if name in shots else None
        except InputError:
            return None  # damaged: the first exposure is there
        return None if picture is None else sites.of(picture)

    return FurtherExposures(reference, stripe, read)


def feature_options(settings: Options) -> FeatureOptions:
    """Make the options of extracting features from a scan's pictures, out of those of the whole measurement."""
    return FeatureOptions(sweep_stripe=settings.stripe, fan_stripe=settings.stripe)


def stream_frames(
    pictures: PictureReader,
    settings: Options,
    times: StageTimes | None = None,
    coming: Iterable[Path] | None = None,
) -> Iterator[Frame]:
    """Yield the frames that are used in the order of the recording, or those whose paths are `coming`.

    Frames left out by hand are not read.
    """
    recording_set = pictures.recording_set
    if coming is not None:
        yield from pictures.stream(coming, times)
        return
    taken = pictures.stream(used_frames(recording_set, settings), times)
    for path in recording_set.frames:
        name = recording_set.name_of(path)
        if name in settings.excluded:
            yield name, Exclusion.BY_HAND
            continue
        _, picture = next(taken)
        yield name, picture


def require_frames(recording_set: RecordingSet, settings: Options) -> None:
    """Raise InputError if a set has no frames, or all of them are left out by hand."""
    require_scan(recording_set)
    if not used_frames(recording_set, settings):
        raise InputError(
            Message(
                "scan.all_frames_left_out", "all {frames} frames are left out by hand", frames=len(recording_set.frames)
            ),
            where="scan",
            todo=Message("advice.take_some_in", "take some of them in again"),
        )


def used_frames(recording_set: RecordingSet, settings: Options) -> list[Path]:
    """List the paths of the frames that are not left out by hand."""
    return [path for path in recording_set.frames if recording_set.name_of(path) not in settings.excluded]


def reference_picture(
    pictures: PictureReader, camera: Camera | None, settings: Options, progress: Progress = silent
) -> tuple[Picture, list[Message]]:
    """Read the picture with the fan alone, or make it from the frames; return it with notes on how it was made.

    Raises
    ------
    InputError
        If there is none and the frames are too few to make one from, or it has another size than the camera's.
    """
    recording_set = pictures.recording_set
    if recording_set.reference is not None:
        reference = pictures.read(recording_set.reference)
        if camera is not None:
            check_size(recording_set.reference, reference.shape, camera)
        return reference, []
    taken = used_frames(recording_set, settings)
    sample = [taken[index] for index in sample_indices(len(taken))]
    stream = steps(pictures.stream(sample), progress, "reference", len(sample))
    readable = [picture for _, picture in stream if not isinstance(picture, Reason)]
    if len(readable) < FEWEST:
        raise InputError(
            Message(
                "scan.too_few_frames_for_reference",
                "there is no reference.png, and {pictures} readable frames are too few to make one from",
                pictures=len(readable),
            ),
            where=recording_set.where("scan"),
            todo=Message("advice.record_reference", "record reference.png with the fan alone, or more frames"),
        )
    if camera is not None:
        check_size(sample[0], readable[0].shape, camera)
    note = note_of("scan.no_reference", n=len(readable))
    return quantile_reference(readable), [note]
