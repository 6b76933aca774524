"""Pictures to features: the fan's centrelines once, each frame's sweep centrelines, and where they cross.

Frames stream: one is decoded, subtracted, reduced to its centrelines and forgotten.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from core.calibrate.results import LEFT_OUT
from core.errors import InputError
from core.image.centreline import Centreline
from core.image.shading import shading_sigma
from core.image.smoothing import smooth
from core.image.stripe import StripeSettings
from core.image.stripe_settings import choose_settings
from core.progress import Progress, Told, silent, steps
from core.scan.crossing_search import all_crossings
from core.scan.crossings import CrossingTable
from core.scan.feature_notes import notes_on
from core.scan.frame_reader import LOST, MOVED, NO_STRIPE, Frame, FrameFeatures, FrameReader
from core.scan.reference import Picture
from core.scan.reference_features import FeatureOptions, ReferenceFeatures, read_reference
from core.scan.straightening import bent_back, straightened
from core.stage_times import StageTimes
from core.threads import ordered_map

__all__ = [
    "LOOK_AHEAD",
    "LOST",
    "MOVED",
    "NO_STRIPE",
    "FeatureOptions",
    "Frame",
    "FrameFeatures",
    "FrameReader",
    "ReferenceFeatures",
    "ScanFeatures",
    "choose_sweep_stripe",
    "extract_features",
    "gather",
    "read_reference",
]

LOOK_AHEAD = 8
"""How many frames are looked at for the stripe's width and contrast when they are not given."""


@dataclass(frozen=True, eq=False, slots=True)
class ScanFeatures:
    """All that a scan's pictures show; frames in the order of the recording, `frames[i].index == i`."""

    image_size: tuple[int, int]
    fan: tuple[Centreline, ...]
    frames: tuple[FrameFeatures, ...]
    crossings: CrossingTable
    sweep_stripe: StripeSettings | None
    fan_stripe: StripeSettings
    notes: tuple[str, ...] = ()


def extract_features(
    reference: Picture | ReferenceFeatures,
    frames: Iterable[Frame],
    total: int,
    options: FeatureOptions | None = None,
    progress: Progress = silent,
    watch: Callable[[FrameFeatures], None] | None = None,
    times: StageTimes | None = None,
) -> ScanFeatures:
    """Reduce a scan to features.

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

    Raises
    ------
    InputError
        If the reference shows no fan line, or no frame shows a sweep.
    """
    options = options or FeatureOptions()
    progress = told = Told(progress)
    progress("frames", 0, total)
    seen = reference if isinstance(reference, ReferenceFeatures) else read_reference(reference, options)
    stream = iter(frames)
    ahead = _look_ahead(stream)
    progress("frames", 0, total)
    sweep_stripe = options.sweep_stripe or choose_sweep_stripe(ahead, seen, told.again)
    reader = FrameReader(seen, sweep_stripe, options.move_limit_px, times)
    found: list[FrameFeatures] = []
    numbered = enumerate(chain(ahead, stream))
    for features in ordered_map(reader, numbered, idle=lambda: told.again("frames", 0, total)):
        progress("frames", len(found), total)
        found.append(features)
        if watch is not None:
            watch(features)
    progress("frames", len(found), total)
    _require_sweeps(found)
    stripes = seen.stripe, sweep_stripe
    return gather(seen.image_size, seen.fan, found, stripes, options, progress)


def gather(
    image_size: tuple[int, int],
    fan: tuple[Centreline, ...],
    frames: Sequence[FrameFeatures],
    stripes: tuple[StripeSettings, StripeSettings | None],
    options: FeatureOptions | None = None,
    progress: Progress = silent,
    smoothed: bool = True,
) -> ScanFeatures:
    """Centrelines as they were extracted to a scan's features: crossed, and then averaged along themselves.

    `stripes` are the fan's and the sweeps'; of the `options` window and camera count here; without `smoothed` the
    centrelines stay as they are.
    """
    options = options or FeatureOptions()
    window, camera = options.window, options.camera
    lines = [frame.centrelines for frame in frames]
    if camera is None:
        crossings = all_crossings(fan, lines, window, progress)
    else:
        straight = [straightened(pieces, camera) for pieces in lines]
        crossings = bent_back(all_crossings(straightened(fan, camera), straight, window, progress), camera)
    if smoothed:
        fan = _refined(fan)
        frames = [
            replace(frame, centrelines=_refined(frame.centrelines))
            for frame in steps(frames, progress, "smoothing", len(frames))
        ]
    return ScanFeatures(image_size, fan, tuple(frames), crossings, stripes[1], stripes[0], notes_on(frames))


def _refined(pieces: tuple[Centreline, ...]) -> tuple[Centreline, ...]:
    """Averaged along themselves, and as uncertain as uneven brightness makes them."""
    smoothed = (smooth(piece) for piece in pieces)
    return tuple(replace(piece, sigma=np.hypot(piece.sigma, shading_sigma(piece))) for piece in smoothed)


def _look_ahead(frames: Iterator[Frame]) -> list[Frame]:
    """The first frames, of which LOOK_AHEAD are not left out by hand."""
    ahead: list[Frame] = []
    wanted = LOOK_AHEAD
    for name, picture in frames:
        ahead.append((name, picture))
        wanted -= not isinstance(picture, str) or picture != LEFT_OUT
        if not wanted:
            break
    return ahead


def choose_sweep_stripe(
    frames: Sequence[Frame], reference: ReferenceFeatures, progress: Progress = silent
) -> StripeSettings | None:
    """The median width and contrast of the sweep's stripe in `frames`; None when none of them shows a stripe."""
    seen = []
    for _, picture in steps(frames, progress, "stripe", len(frames)):
        if not isinstance(picture, str) and picture.shape == reference.base.shape:
            difference = reference.difference(picture).astype(np.float32, copy=False)
            settings = choose_settings(difference, reference.full_scale)
            if settings is not None:
                seen.append(settings)
    if not seen:
        return None
    return replace(
        seen[0],
        width_px=float(np.median([s.width_px for s in seen])),
        contrast=float(np.median([s.contrast for s in seen])),
    )


def _require_sweeps(frames: list[FrameFeatures]) -> None:
    if any(frame.centrelines for frame in frames):
        return
    reasons = [frame.reason for frame in frames]
    common = max(sorted(set(reasons)), key=reasons.count) if reasons else "there are no frames"
    raise InputError(
        f"none of the {len(frames)} frames shows a usable sweep; the most common reason: {common}",
        where="scan",
        todo="record the scan again with the hand-held laser on and object and camera at rest",
    )
