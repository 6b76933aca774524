"""Pictures to features: the fan's centrelines once, each frame's sweep centrelines, and where they cross.

Frames stream: one is decoded, subtracted, reduced to its centrelines and forgotten.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from core.calibrate.results import LEFT_OUT
from core.errors import InputError
from core.image.centreline import Centreline
from core.image.noise import NoiseModel, estimate_noise
from core.image.shading import shading_sigma
from core.image.smoothing import smooth
from core.image.stripe import StripeSettings
from core.image.stripe_settings import choose_settings
from core.image.stripes import extract_centrelines
from core.model import Camera
from core.progress import Progress, Told, silent, steps
from core.scan.crossings import CrossingTable, CrossingWindow, all_crossings
from core.scan.reference import Picture, check_reference
from core.scan.straightening import bent_back, straightened
from core.threads import ordered_map

MOVED = "object or camera moved during the scan: the fan's light lies elsewhere than in the reference"
LOST = "the fan's light is gone: object or camera moved far during the scan, or the three-line laser was off"
NO_STRIPE = "no stripe of the hand-held laser"

LIGHT_SHARE, LIGHT_FLOOR = 0.2, 0.02
"""A change of the background counts as one of the room's light from this share of it, and of the full scale, on."""

LOOK_AHEAD = 8
"""How many frames are looked at for the stripe's width and contrast when they are not given."""


@dataclass(frozen=True, slots=True)
class FeatureOptions:
    """How pictures become features; None means chosen from the pictures.

    A frame in which a stretch of the fan has moved by more than `move_limit_px` since the reference is left out. With
    a `camera`, centrelines are crossed as they would be without its distortion.
    """

    sweep_stripe: StripeSettings | None = None
    fan_stripe: StripeSettings | None = None
    window: CrossingWindow = field(default_factory=CrossingWindow)
    move_limit_px: float = 0.3
    camera: Camera | None = None


@dataclass(frozen=True, eq=False, slots=True)
class FrameFeatures:
    """The sweep's centrelines in one frame, or the `reason` there are none.

    Against the reference: `shift_px` of the fan's light, and `light_change` of the background as a share of it, 0 where
    it is too small to tell.
    """

    index: int
    name: str
    centrelines: tuple[Centreline, ...]
    reason: str = ""
    shift_px: float = 0.0
    light_change: float = 0.0


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


Frame = tuple[str, Picture | str]
"""A frame's name and its picture, or the sentence that says why it could not be read."""


def extract_features(
    reference: Picture | ReferenceFeatures,
    frames: Iterable[Frame],
    total: int,
    options: FeatureOptions | None = None,
    progress: Progress = silent,
    watch: Callable[[FrameFeatures], None] | None = None,
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
    reader = FrameReader(seen, sweep_stripe, options.move_limit_px)
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
    return gather(seen.image_size, seen.fan, found, stripes, options.window, progress, camera=options.camera)


def gather(
    image_size: tuple[int, int],
    fan: tuple[Centreline, ...],
    frames: Sequence[FrameFeatures],
    stripes: tuple[StripeSettings, StripeSettings | None],
    window: CrossingWindow,
    progress: Progress = silent,
    smoothed: bool = True,
    camera: Camera | None = None,
) -> ScanFeatures:
    """Centrelines as they were extracted to a scan's features: crossed, and then averaged along themselves.

    `stripes` are the fan's and the sweeps'; without `smoothed` the centrelines stay as they are; `camera` as in
    FeatureOptions.
    """
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
    return ScanFeatures(image_size, fan, tuple(frames), crossings, stripes[1], stripes[0], _notes(frames))


@dataclass(frozen=True, eq=False, slots=True)
class ReferenceFeatures:
    """What the picture with the fan alone shows, and what frames are compared with.

    `base` (H, W) is the picture, `full_scale` its largest possible grey level, `noise` that of a frame minus the
    picture; `fan` the fan's centrelines, `stripe` how they were looked for.
    """

    base: NDArray[np.float32]
    full_scale: float
    noise: NoiseModel
    fan: tuple[Centreline, ...]
    stripe: StripeSettings

    @property
    def image_size(self) -> tuple[int, int]:
        """(width, height) in pixels."""
        height, width = self.base.shape
        return width, height

    def light_change(self, grey: float) -> float:
        """A change of the background by `grey` levels as a share of it; 0 where stripes do not feel it."""
        background = max(float(np.median(self.base[::16, ::16])), 1.0)
        if abs(grey) < max(LIGHT_SHARE * background, LIGHT_FLOOR * self.full_scale):
            return 0.0
        return grey / background


def read_reference(picture: Picture, options: FeatureOptions | None = None) -> ReferenceFeatures:
    """The fan's centrelines in the picture with the fan alone.

    Raises
    ------
    InputError
        If it shows no fan line.
    """
    options = options or FeatureOptions()
    full_scale = _full_scale(picture)
    base = picture.astype(np.float32)
    noise = estimate_noise(base)
    stripe, fan = _fan_centrelines(base, full_scale, noise, options)
    return ReferenceFeatures(base, full_scale, noise.of_difference(float(np.median(base))), fan, stripe)


@dataclass(frozen=True, eq=False, slots=True)
class FrameReader:
    """A frame and its number to features, against one reference; called from several threads."""

    reference: ReferenceFeatures
    stripe: StripeSettings | None
    move_limit_px: float = FeatureOptions().move_limit_px

    def __call__(self, item: tuple[int, Frame]) -> FrameFeatures:
        index, (name, picture) = item
        if isinstance(picture, str):
            return FrameFeatures(index, name, (), picture)
        base, full_scale, fan = self.reference.base, self.reference.full_scale, self.reference.fan
        if picture.shape != base.shape:
            return FrameFeatures(index, name, (), _sizes_differ(picture, base))
        if nothing := _shows_nothing(picture, full_scale):
            return FrameFeatures(index, name, (), nothing)
        difference = picture.astype(np.float32)
        difference -= base
        check = check_reference(difference, fan)
        light = self.reference.light_change(check.light)
        if check.lost:
            return FrameFeatures(index, name, (), LOST, check.shift_px, light)
        if check.shift_px > self.move_limit_px:
            return FrameFeatures(index, name, (), MOVED, check.shift_px, light)
        if self.stripe is None:
            return FrameFeatures(index, name, (), NO_STRIPE, check.shift_px, light)
        saturated = picture >= full_scale
        pieces = extract_centrelines(difference, self.stripe, noise=self.reference.noise, saturated=saturated)
        reason = "" if pieces else NO_STRIPE
        return FrameFeatures(index, name, pieces, reason, check.shift_px, light)


def _refined(pieces: tuple[Centreline, ...]) -> tuple[Centreline, ...]:
    """Averaged along themselves, and as uncertain as uneven brightness makes them."""
    smoothed = (smooth(piece) for piece in pieces)
    return tuple(replace(piece, sigma=np.hypot(piece.sigma, shading_sigma(piece))) for piece in smoothed)


def _full_scale(picture: Picture) -> float:
    return float(np.iinfo(picture.dtype).max)


def _fan_centrelines(
    base: NDArray[np.float32], full_scale: float, noise: NoiseModel, options: FeatureOptions
) -> tuple[StripeSettings, tuple[Centreline, ...]]:
    settings = options.fan_stripe or choose_settings(base, full_scale)
    fan = () if settings is None else extract_centrelines(base, settings, noise=noise, saturated=base >= full_scale)
    if settings is None or not fan:
        raise InputError(
            "shows no line of the fan, so nothing can be measured",
            where="scan reference",
            todo="switch the three-line laser on, expose longer, or darken the room",
        )
    return settings, fan


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
    base = reference.base
    seen = []
    for _, picture in steps(frames, progress, "stripe", len(frames)):
        if not isinstance(picture, str) and picture.shape == base.shape:
            settings = choose_settings(picture.astype(np.float32) - base, reference.full_scale)
            if settings is not None:
                seen.append(settings)
    if not seen:
        return None
    return replace(
        seen[0],
        width_px=float(np.median([s.width_px for s in seen])),
        contrast=float(np.median([s.contrast for s in seen])),
    )


def _shows_nothing(picture: Picture, full_scale: float) -> str:
    """Why a picture without any contrast is of no use, or nothing."""
    sample = picture[::4, ::4]
    if sample.max() <= 0.01 * full_scale:
        return "the picture is all black"
    if sample.min() >= 0.99 * full_scale:
        return "the picture is all white"
    return ""


def _sizes_differ(picture: Picture, base: NDArray[np.float32]) -> str:
    (height, width), (base_height, base_width) = picture.shape, base.shape
    return f"its size {width} × {height} differs from the reference's {base_width} × {base_height}"


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


def _notes(frames: Sequence[FrameFeatures]) -> tuple[str, ...]:
    return _moved_notes(frames) + _light_notes(frames)


def _light_notes(frames: Sequence[FrameFeatures]) -> tuple[str, ...]:
    changed = [frame for frame in frames if frame.light_change]
    if not changed:
        return ()
    most = max(changed, key=lambda frame: abs(frame.light_change))
    which = "brighter" if most.light_change > 0 else "darker"
    return (
        f"The room's light changed in {len(changed)} of {len(frames)} frames, the first {changed[0].name}: the "
        f"background is up to {100 * abs(most.light_change):.0f} % {which} than in the reference, which makes stripes "
        "less sure. Keep the light as it is during a scan, or scan again.",
    )


def _moved_notes(frames: Sequence[FrameFeatures]) -> tuple[str, ...]:
    moved = [frame for frame in frames if frame.reason in (MOVED, LOST)]
    if not moved:
        return ()
    first = moved[0]
    return (
        f"Object or camera moved during the scan: {len(moved)} of {len(frames)} frames were left out, the first "
        f"{first.name} (the fan's light is {first.shift_px:.1f} px or more aside, measured across its lines). "
        "Hold both still and scan again to use them all.",
    )
