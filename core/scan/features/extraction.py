"""Pictures to features: the fan's centrelines once, each frame's sweep centrelines, and where they cross.

Frames stream: one is decoded, subtracted, reduced to its centrelines and forgotten.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import cv2
import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.image.exclusion import Exclusion, Reason
from core.image.stripes.bracket import Exposure, Exposures, fused
from core.image.stripes.centreline import Centreline
from core.image.stripes.extraction import extract_centrelines
from core.image.stripes.lines.smoothing import smooth
from core.image.stripes.settings import choose_settings
from core.image.stripes.shading import shading_sigma
from core.image.stripes.stripe import StripeSettings
from core.image.stripes.told_width import as_measured
from core.messages import Message
from core.progress import Progress, StepProgress, silent, steps
from core.scan.features.board_print import without_marks
from core.scan.features.crossing_search import all_crossings
from core.scan.features.crossings import CrossingTable
from core.scan.features.frames import FrameFeatures, light_faults, notes_on
from core.scan.features.reference import FeatureOptions, Picture, ReferenceFeatures, check_reference, read_reference
from core.scan.features.straightening import bent_back, straightened
from core.stage_times import StageTimes, stage
from core.threads import ordered_map

__all__ = [
    "LOOK_AHEAD",
    "FeatureOptions",
    "Frame",
    "FrameFeatures",
    "FrameReader",
    "FurtherExposures",
    "ReferenceFeatures",
    "ScanFeatures",
    "SeenLines",
    "choose_sweep_stripe",
    "crossed",
    "exposed",
    "extract_features",
    "extract_lines",
    "gather",
    "read_reference",
    "refined",
    "saturated_pixels",
]

Frame = tuple[str, Picture | Reason]
"""A frame's name and its picture, or what excludes it."""

LOOK_AHEAD = 8
"""How many frames are looked at for the stripe's width and contrast when they are not given."""


@dataclass(frozen=True, eq=False, slots=True)
class ScanFeatures:
    """Centrelines and crossings of all pictures of a scan, in the order of the recording: `frames[i].index == i`.

    `faults` tell what is wrong with the pictures themselves, which may be why what is made of them is refused; `notes`
    whatever else they tell. `too_fine_for_mosaic` is whether the fan's stripes are too fine for the
    tiles of a colour mosaic; None: not known.
    """

    image_size: tuple[int, int]
    fan: tuple[Centreline, ...]
    frames: tuple[FrameFeatures, ...]
    crossings: CrossingTable
    sweep_stripe: StripeSettings | None
    fan_stripe: StripeSettings
    notes: tuple[Message, ...] = ()
    faults: tuple[Message, ...] = ()
    too_fine_for_mosaic: bool | None = None


@dataclass(frozen=True, eq=False, slots=True)
class SeenLines:
    """Centrelines of a scan's pictures that have not been crossed yet, which takes no camera.

    `stripes` are the fan's and the sweeps', as they were looked for.
    """

    image_size: tuple[int, int]
    fan: tuple[Centreline, ...]
    frames: tuple[FrameFeatures, ...]
    stripes: tuple[StripeSettings, StripeSettings | None]


def extract_features(
    reference: Picture | ReferenceFeatures,
    frames: Iterable[Frame],
    total: int,
    options: FeatureOptions | None = None,
    progress: Progress = silent,
    watch: Callable[[FrameFeatures], None] | None = None,
    times: StageTimes | None = None,
) -> ScanFeatures:
    """Extract the centrelines of a scan's pictures and cross them; parameters and errors as of `extract_lines`."""
    return crossed(*extract_lines(reference, frames, total, options, progress, watch, times), options, progress)


def extract_lines(
    reference: Picture | ReferenceFeatures,
    frames: Iterable[Frame],
    total: int,
    options: FeatureOptions | None = None,
    progress: Progress = silent,
    watch: Callable[[FrameFeatures], None] | None = None,
    times: StageTimes | None = None,
    further: Mapping[int, FurtherExposures] | None = None,
) -> tuple[SeenLines, SeenLines]:
    """Extract the centrelines of a scan's pictures: first as they are, second averaged along themselves.

    Parameters
    ----------
    reference
        The picture with the fan alone, or what has been read from it.
    frames
        In the order of the recording; read once.
    total
        How many there are, for progress.
    watch
        Shown the features of each frame as they come, in the order of the recording, on the calling thread.
    times
        Learns what the stages cost.
    further
        Further exposures of frames, by their number.

    Raises
    ------
    InputError
        If the reference shows no fan line, or no frame shows a sweep.
    """
    options = options or FeatureOptions()
    sites = options.sites
    progress = told = StepProgress(progress)
    progress("frames", 0, total)
    seen = reference if isinstance(reference, ReferenceFeatures) else read_reference(reference, options)
    stream = iter(frames)
    ahead = _look_ahead(stream)
    progress("frames", 0, total)
    if options.sweep_stripe is not None:
        sweep_stripe: StripeSettings | None = _told_sweep_stripe(ahead, seen, options.sweep_stripe)
    else:
        sweep_stripe = choose_sweep_stripe(ahead, seen, told.within_step)
    reader = FrameReader(seen, sweep_stripe, options.move_limit_px, times, further or {})

    def look(item: tuple[int, Frame]) -> tuple[FrameFeatures, FrameFeatures]:
        features = reader(item).in_whole_picture(sites)
        with stage(times, "smoothing"):
            return features, _averaged(features)

    found: list[FrameFeatures] = []
    averaged: list[FrameFeatures] = []
    numbered = enumerate(_handed_on(ahead, stream))
    for features, smooth_features in ordered_map(look, numbered, idle=lambda: told.within_step("frames", 0, total)):
        progress("frames", len(found), total)
        found.append(features)
        averaged.append(smooth_features)
        if watch is not None:
            watch(features)
    progress("frames", len(found), total)
    _require_sweeps(found)
    fan, stripes = (
        sites.in_whole_picture(seen.fan),
        (sites.stripe_in_whole_picture(seen.stripe), sites.stripe_in_whole_picture(sweep_stripe)),
    )
    lines = SeenLines(seen.image_size, fan, tuple(found), stripes)
    return lines, replace(lines, fan=refined(fan), frames=tuple(averaged))


def gather(
    image_size: tuple[int, int],
    fan: tuple[Centreline, ...],
    frames: Sequence[FrameFeatures],
    stripes: tuple[StripeSettings, StripeSettings | None],
    options: FeatureOptions | None = None,
    progress: Progress = silent,
    smoothed: bool = True,
) -> ScanFeatures:
    """Make a scan's features: cross its centrelines as extracted, then, if `smoothed`, average them along themselves.

    `stripes` are the fan's and the sweeps'; of the `options` window and camera count here; without `smoothed` the
    centrelines stay as they are.
    """
    seen = SeenLines(image_size, fan, tuple(frames), stripes)
    if not smoothed:
        return crossed(seen, seen, options, progress)
    step, total = StepProgress(progress), len(seen.frames)
    idle = partial(step.within_step, "smoothing", 0, total)
    averaged = tuple(steps(ordered_map(_averaged, seen.frames, idle=idle), step, "smoothing", total))
    return crossed(seen, replace(seen, fan=refined(fan), frames=averaged), options, progress)


def crossed(
    seen: SeenLines, kept: SeenLines, options: FeatureOptions | None = None, progress: Progress = silent
) -> ScanFeatures:
    """Cross the centrelines in `seen`; return these crossings and the centrelines in `kept` as features of a scan.

    Of the `options` window and camera count here.
    """
    options = options or FeatureOptions()
    window, camera = options.window, options.camera
    lines = [frame.centrelines for frame in seen.frames]
    if camera is None:
        crossings = all_crossings(seen.fan, lines, window, progress)
    else:
        straight = [straightened(pieces, camera) for pieces in lines]
        crossings = bent_back(all_crossings(straightened(seen.fan, camera), straight, window, progress), camera)
    of_fan, of_sweeps = seen.stripes
    found = notes_on(seen.frames), light_faults(seen.frames)
    return ScanFeatures(seen.image_size, kept.fan, kept.frames, crossings, of_sweeps, of_fan, *found)


def refined(pieces: tuple[Centreline, ...]) -> tuple[Centreline, ...]:
    """Average centrelines along themselves, and widen their σ by what uneven brightness adds."""
    smoothed = (smooth(piece) for piece in pieces)
    return tuple(replace(piece, sigma=np.hypot(piece.sigma, shading_sigma(piece))) for piece in smoothed)


def _averaged(frame: FrameFeatures) -> FrameFeatures:
    return replace(frame, centrelines=refined(frame.centrelines))


def _look_ahead(frames: Iterator[Frame]) -> list[Frame]:
    """The first frames, of which LOOK_AHEAD are neither left out by hand nor repeated."""
    ahead: list[Frame] = []
    wanted = LOOK_AHEAD
    for name, picture in frames:
        ahead.append((name, picture))
        wanted -= picture is not Exclusion.BY_HAND and picture is not Exclusion.REPEATED
        if not wanted:
            break
    return ahead


def _handed_on(ahead: list[Frame], frames: Iterator[Frame]) -> Iterator[Frame]:
    """The frames that were looked at ahead, each forgotten as it is handed on, and the others."""
    while ahead:
        yield ahead.pop(0)
    yield from frames


def choose_sweep_stripe(
    frames: Sequence[Frame], reference: ReferenceFeatures, progress: Progress = silent
) -> StripeSettings | None:
    """Choose the median width and contrast of the sweeps' stripe in `frames`; None if none of them shows a stripe."""
    seen = []
    for _, picture in steps(frames, progress, "stripe", len(frames)):
        if not isinstance(picture, Reason) and picture.shape == reference.base.shape:
            difference = reference.of_lasers(picture).difference.astype(np.float32, copy=False)
            settings = choose_settings(without_marks(difference, reference.marks), reference.full_scale)
            if settings is not None:
                seen.append(settings)
    if not seen:
        return None
    return replace(
        seen[0],
        width_px=float(np.median([s.width_px for s in seen])),
        contrast=float(np.median([s.contrast for s in seen])),
    )


def _told_sweep_stripe(frames: Sequence[Frame], reference: ReferenceFeatures, told: StripeSettings) -> StripeSettings:
    """The stripe that was `told`, with the width that `frames` show where that is quite another."""

    def look(stripe: StripeSettings) -> tuple[Centreline, ...]:
        reader = FrameReader(reference, stripe)
        return tuple(piece for item in enumerate(frames) for piece in reader(item).centrelines)

    return as_measured(told, look)[0]


def _require_sweeps(frames: list[FrameFeatures]) -> None:
    if any(frame.centrelines for frame in frames):
        return
    reasons = [frame.reason for frame in frames if frame.reason is not None]
    none = Message("scan.no_frames", "there are no frames")
    raise InputError(
        Message(
            "scan.no_sweep",
            "none of the {n} frames shows a usable sweep; the most common reason: {reason}",
            n=len(frames),
            reason=max(sorted(set(reasons), key=str), key=reasons.count) if reasons else none,
        ),
        where="scan",
        todo=Message(
            "scan.advice_record_again",
            "record the scan again with the hand-held laser on and object and camera at rest",
        ),
    )


@dataclass(frozen=True, eq=False, slots=True)
class FurtherExposures:
    """One series of further exposures of a scan's pictures, shorter or longer than the first, sharing one number.

    `reference` is what the one of the fan alone shows, `stripe` the sweeps' in them, None if none shows any; `read`
    gives the one of a frame by that frame's name, None if it has none.
    """

    reference: ReferenceFeatures
    stripe: StripeSettings | None
    read: Callable[[str], Picture | None]

    def of(self, name: str) -> Exposure | None:
        """Extract the sweep from the further exposure of the frame `name`; None if missing or of another size.

        None as well where no exposure of the series shows a stripe.
        """
        picture = self.read(name)
        if picture is None or self.stripe is None or picture.shape != self.reference.base.shape:
            return None
        difference = self.reference.of_lasers(picture).difference
        saturated = saturated_pixels(picture)
        lines = extract_centrelines(difference, self.stripe, noise=self.reference.noise, saturated=saturated)
        return exposed(picture, lines, saturated)


@dataclass(frozen=True, eq=False, slots=True)
class FrameReader:
    """Reader that extracts the features of frames, compared with one reference; several threads may call it."""

    reference: ReferenceFeatures
    stripe: StripeSettings | None
    move_limit_px: float = FeatureOptions().move_limit_px
    times: StageTimes | None = None
    further: Mapping[int, FurtherExposures] = field(default_factory=dict)

    def __call__(self, item: tuple[int, Frame]) -> FrameFeatures:
        index, (name, picture) = item
        if isinstance(picture, Reason):
            return FrameFeatures(index, name, (), picture)
        base, full_scale, fan = self.reference.base, self.reference.full_scale, self.reference.fan
        if picture.shape != base.shape:
            return FrameFeatures(index, name, (), _sizes_differ(picture, base))
        if nothing := _shows_nothing(picture, full_scale):
            return FrameFeatures(index, name, (), nothing)
        with stage(self.times, "difference"):
            seen = self.reference.of_lasers(picture)
            difference = seen.difference
            check = check_reference(difference, fan)
            light = self.reference.light_change(seen)
        if check.lost:
            return FrameFeatures(index, name, (), Exclusion.WITHOUT_FAN, check.shift_px, light)
        if check.shift_px > self.move_limit_px:
            return FrameFeatures(index, name, (), Exclusion.MOVED, check.shift_px, light, check.shifts_px)
        if self.stripe is None:
            return FrameFeatures(index, name, (), Exclusion.WITHOUT_STRIPE, check.shift_px, light, check.shifts_px)
        with stage(self.times, "extraction"):
            saturated = saturated_pixels(picture)
            pieces = extract_centrelines(
                difference,
                self.stripe,
                noise=self.reference.noise,
                saturated=saturated,
                ignore=self.reference.marks,
            )
            others = {number: more for number, each in self.further.items() if (more := each.of(name)) is not None}
        exposures: dict[int, Exposures] = {}
        if others:
            pieces, told = fused(exposed(picture, pieces, saturated), list(others.values()))
            exposures = dict(zip(others, told, strict=True))
        exclusion = None if pieces else Exclusion.WITHOUT_STRIPE
        return FrameFeatures(
            index, name, pieces, exclusion, check.shift_px, light, check.shifts_px, exposures, seen.gain
        )


def exposed(picture: Picture, lines: Sequence[Centreline], saturated: NDArray[np.bool_]) -> Exposure:
    """Collect a picture's centrelines, `saturated` pixels (H, W) and mean grey level over full scale."""
    return Exposure(lines, saturated, float(picture[::4, ::4].mean()) / np.iinfo(picture.dtype).max)


def saturated_pixels(picture: Picture) -> NDArray[np.bool_]:
    """Find the mask (H, W) of the pixels that have the largest value the picture's type can hold."""
    highest = np.iinfo(picture.dtype).max
    _, found = cv2.threshold(picture, highest - 1, 1, cv2.THRESH_BINARY)
    return np.asarray(found, dtype=np.uint8).view(np.bool_)


def _shows_nothing(picture: Picture, full_scale: float) -> Message | None:
    """Why a picture without any contrast is of no use; None if it has some."""
    sample = picture[::61, ::67]
    if sample.max() <= 0.01 * full_scale or sample.min() >= 0.99 * full_scale:
        sample = picture[::4, ::4]
    if sample.max() <= 0.01 * full_scale:
        return Message("scan.frame_black", "the picture is all black")
    if sample.min() >= 0.99 * full_scale:
        return Message("scan.frame_white", "the picture is all white")
    return None


def _sizes_differ(picture: Picture, base: Picture) -> Message:
    (height, width), (base_height, base_width) = picture.shape, base.shape
    return Message(
        "scan.frame_size",
        "its size {width} × {height} differs from the reference's {base_width} × {base_height}",
        width=width,
        height=height,
        base_width=base_width,
        base_height=base_height,
    )
