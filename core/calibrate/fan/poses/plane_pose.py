"""One pose of the plane target: from a pair of pictures to target points and stripes.

With a picture of the same pose without laser, the stripes come from the difference and the target from the picture
without; without one, both come from the only picture, and only the light plate around the marks counts. Where the
plate's own brightness changes across a stripe, at the edge of a mark, the stripe's centre is pulled to the lighter
side: those points are left out. A picture without laser tells where marks are: then points are found up to their edges
(`core.calibrate.fan.poses.light_across_marks`). Light beside the plate, and what does not look like the laser's lines
on it, is left out as well (`core.calibrate.fan.poses.plate`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from core.calibrate.fan.poses.even_plate import DARK, EvenPlate
from core.calibrate.fan.poses.light_across_marks import across_marks, course_of, follows
from core.calibrate.fan.poses.plate import Plate, without_clutter
from core.calibrate.fan.poses.pose_features import MOVED_PX, PoseFeatures, usual_of, usual_stripe
from core.calibrate.fan.poses.stripe_lines import straight_lines
from core.image.mosaic import ALL_SITES, Sites
from core.image.stripes.bracket import Exposure, fused
from core.image.stripes.centreline import Centreline
from core.image.stripes.extraction import StripeSettings, choose_settings, extract_centrelines
from core.image.stripes.noise import (
    UNCOMPRESSED,
    Compression,
    NoiseModel,
    estimate_noise,
    estimate_noise_of_pair,
    free_of_structure,
)
from core.image.stripes.pair_exposure import Exposed
from core.image.stripes.ridge_picture import ridge_strength
from core.image.stripes.stripe import USUAL_STRIPE
from core.image.stripes.told_width import as_measured
from core.image.targets import CircleGrid, Target, TargetNotFound, camera_shift, detect, followed_shift, picture_shift
from core.image.targets.target_view import TargetView
from core.messages import Message
from core.model import Camera
from core.model.arrays import Array, runs_of

Picture = NDArray[Any]
"""(H, W) grey levels, uint8 or uint16."""

SURELY_STILL_PX = 0.25
"""A grid of circles followed from picture to picture no farther than this, with an error far smaller, need not be found
again to know that."""
PULL_PX = 0.05
"""A point that the plate's change of brightness may pull further than this is left out."""
STRONGEST = 0.999
"""Quantile over the target of what looks like a stripe: a few hot pixels are none."""
FLANK = 1.5
"""Stripe σ on either side of a point where the plate is looked at with the laser off."""
SHORTEST = 12
"""Runs with fewer points left are dropped."""
AS_BRIGHT = 0.25
"""Stripes less high than this share of those in use are another channel's crosstalk: it says nothing of the planes."""


@dataclass(frozen=True, eq=False, slots=True)
class ExtraPictures:
    """Further pictures and settings of a pose beside its pictures with the fan on and off.

    `target` are the same pictures, fan on and off, in the channel in which the target is looked for, None if that is
    theirs; `compression` is that of each picture; `further` are further exposures of them, shorter or longer.
    `sites` are those of raw pictures that see the laser. `others` are the pictures, fan on and off, in other channels
    in which its light may be seen as well, and the compression of each, by the channels' names.
    """

    target: tuple[Picture, Picture | None] | None = None
    compression: Compression = UNCOMPRESSED
    further: Sequence[tuple[Picture, Picture | None]] = ()
    sites: Sites = ALL_SITES
    others: Mapping[str, tuple[Picture, Picture, Compression]] = field(default_factory=dict)


NOTHING: Final = ExtraPictures()


def measure_plane_pose(
    name: str,
    on: Picture,
    off: Picture | None,
    target: Target,
    camera: Camera | None = None,
    settings: StripeSettings | None = None,
    margin_mm: float | None = None,
    beside: ExtraPictures = NOTHING,
) -> PoseFeatures:
    """Find target points and laser stripes in the pictures of one pose; if it cannot be used, the reason.

    Parameters
    ----------
    name
        The pose's name, for messages.
    on, off
        (H, W) uint8 or uint16, fan on and off; `off` None if there is no such picture.
    target
        The plane target.
    camera
        Helps finding straight edges under distortion.
    settings
        Width and contrast of the stripes; chosen from the picture if not given. A width that the picture contradicts
        gives way to the measured one.
    margin_mm
        How far the plate goes on beyond what is printed on it; None: not known.
    beside
        What there is beside these pictures.

    Raises
    ------
    ValueError
        If the two pictures differ in size or depth.
    """
    if off is not None and (on.shape != off.shape or on.dtype != off.dtype):
        raise ValueError(f"the pictures of {name} differ: {on.shape} {on.dtype} and {off.shape} {off.dtype}")
    lit, unlit = beside.target or (on, off)
    plate = lit if unlit is None else unlit
    try:
        view = detect(target, plate, name, camera, plane_only=True)
    except TargetNotFound as error:
        return PoseFeatures(name, None, (), error.what)
    moved = None if unlit is None else _movement(lit, unlit, view, target, camera)
    if moved is not None and moved >= MOVED_PX:
        reason = Message(
            "fan.target_moved",
            "the target moved by {shift_px:.2f} px between the pictures with the fan off and on",
            shift_px=moved,
        )
        return PoseFeatures(name, view, (), reason, moved_px=moved)
    moved_px = math.nan if moved is None else moved
    carrier = Plate(target, view, camera, margin_mm)
    outside = carrier.outside(on.shape)
    light = _Light.of(on, off, view, outside, beside)
    centrelines = _stripes(light, view, settings, beside)
    if not centrelines:
        seen = None
        if settings is not None:
            seen = usual_stripe([PoseFeatures(name, view, _stripes(light, view, None, beside))])
        if settings is None or seen is None:
            why = _no_stripe(on, off, view, settings or USUAL_STRIPE)
        else:
            why = _other_stripes(settings, seen)
        return PoseFeatures(name, view, (), why, moved_px=moved_px)
    carried = _Carried(plate, view, plate_level(plate, view), carrier, camera, off is not None)
    others = _in_others(centrelines, carried, outside, settings, beside)
    centrelines = carried.stripes(centrelines, light, beside)
    notes: tuple[Message, ...] = ()
    if off is not None and moved is None:
        note = Message(
            "fan.movement_unchecked",
            "{pose}: with the fan on the target is not found, so it was not checked whether it moved",
            pose=name,
        )
        notes = (note,)
    return PoseFeatures(name, view, centrelines, notes=notes, moved_px=moved_px, gain=light.gain, others=others)


def stripe_strength(on: Picture, off: Picture | None, settings: StripeSettings) -> NDArray[np.float32]:
    """Compute for each pixel (H, W) the height in grey levels of the laser stripe there, with `off` subtracted."""
    light = on.astype(np.float32)
    return ridge_strength(light if off is None else light - off.astype(np.float32), settings)


def _other_stripes(told: StripeSettings, seen: StripeSettings) -> Message:
    """Why no stripe was found as they were `told` to be, where there are some."""
    return Message(
        "fan.other_stripes",
        "no stripe was found {width_px:.0f} px wide and about {grey:.0f} grey levels high, as stated; those on the "
        "target are {seen_px:.0f} px wide and {seen_grey:.0f} high: state that, or let both be chosen",
        width_px=told.width_px,
        grey=told.contrast,
        seen_px=seen.width_px,
        seen_grey=seen.contrast,
    )


def _no_stripe(on: Picture, off: Picture | None, view: TargetView, settings: StripeSettings) -> Message:
    """Why no stripe was found, by what looks most like one about the target."""
    strength = stripe_strength(on, off, settings)[_window(view, on.shape, margin=0.25)]
    return Message(
        "fan.no_stripe",
        "no stripe was found: is the fan on? What looks most like a stripe {width_px:g} px wide on the target has "
        "{grey:.0f} grey levels",
        width_px=settings.width_px,
        grey=float(np.quantile(strength, STRONGEST)),
    )


@dataclass(frozen=True, eq=False, slots=True)
class _Light:
    """The laser's light by the sites alone that see it, (H, W) each: grey levels, what is saturated, what no plate.

    `full_scale` is the largest grey level there can be, `mean` that of the picture with the laser on; `further` is the
    light of further exposures; `gain` that of the picture with the laser on over the one without.
    """

    picture: NDArray[np.float32]
    saturated: NDArray[np.bool_]
    outside: NDArray[np.bool_]
    noise: NoiseModel
    full_scale: float
    mean: float
    further: tuple[_Light, ...] = ()
    gain: float = 1.0

    @classmethod
    def of(
        cls, on: Picture, off: Picture | None, view: TargetView, outside: NDArray[np.bool_], beside: ExtraPictures
    ) -> _Light:
        """The difference of two pictures, or the only one."""
        alone = replace(beside, further=())
        further = tuple(cls.of(*pictures, view, outside, alone) for pictures in beside.further)
        sites = beside.sites
        lit, outside = sites.of(on), sites.of(outside)
        picture, full_scale, exposed = lit.astype(np.float32), np.iinfo(lit.dtype).max, Exposed()
        if off is None:
            noise = replace(estimate_noise(picture), compression=beside.compression)
        else:
            without = sites.of(off).astype(np.float32)
            # the stripes lie on the plate; the rest of the picture may be dark
            there = replace(view, uv=sites.places_of(view.uv))
            of_plate = _window(there, without.shape, margin=0.25)
            exposed = Exposed.of(picture[of_plate], without[of_plate], full_scale)
            without = exposed.like(without)
            common = plate_level(without, there)
            one = free_of_structure(estimate_noise(without), estimate_noise_of_pair(picture, without, outside), common)
            noise = replace(one, compression=beside.compression).of_difference(common)
            picture -= without
        saturated, mean = lit >= full_scale, float(lit.mean())
        return cls(picture, saturated, outside, noise, float(full_scale), mean, further, exposed.gain)


def _stripes(
    light: _Light, view: TargetView, settings: StripeSettings | None, beside: ExtraPictures
) -> tuple[Centreline, ...]:
    """Centrelines of the laser on the plate, of all exposures."""
    sites = beside.sites
    there = _window(replace(view, uv=sites.places_of(view.uv)), light.picture.shape, margin=1.0)
    told = sites.stripe_of(settings)
    first, *others = (
        Exposure(_looked_for(each, there, told), each.saturated, each.mean / each.full_scale)
        for each in (light, *light.further)
    )
    found = fused(first, others)[0] if others else first.lines
    return sites.in_whole_picture(found)


@dataclass(frozen=True, eq=False, slots=True)
class _Carried:
    """What is known of a plate on which stripes were found: its picture (H, W), its target, its grey level and edges.

    `paired` is whether there is a picture without the laser.
    """

    plate: Picture
    view: TargetView
    level: float
    carrier: Plate
    camera: Camera | None
    paired: bool

    def stripes(self, found: tuple[Centreline, ...], light: _Light, beside: ExtraPictures) -> tuple[Centreline, ...]:
        """Of what was `found` what lies on the even plate, up to its marks and between them, without clutter."""
        found = _on_even_plate(found, self.plate, self.level, self.carrier, laser_off=self.paired)
        found = without_clutter(found, self.camera)
        if self.camera is None or not self.paired or beside.further:
            return found
        even = EvenPlate.of(self.plate, self.view, self.level)
        whole = _beside_marks(found, light, even, self.camera, beside.sites)
        whole = _on_even_plate(whole, even.picture, self.level, self.carrier, laser_off=True, uneven=even.uneven)
        return without_clutter(whole, None) or found


def _in_others(
    centrelines: Sequence[Centreline],
    carried: _Carried,
    outside: NDArray[np.bool_],
    settings: StripeSettings | None,
    beside: ExtraPictures,
) -> Mapping[str, tuple[Centreline, ...]]:
    """The stripes in the other channels of a pair of colour pictures that show them not much fainter."""
    uv = np.vstack([line.uv for line in centrelines])
    height = float(np.median(np.concatenate([line.strength for line in centrelines])))
    found = {}
    for channel, (on, off, compression) in beside.others.items():
        alone = ExtraPictures(compression=compression)
        light = _Light.of(on, off, carried.view, outside, alone)
        if float(np.median(_sample(light.picture, uv))) < AS_BRIGHT * height:
            continue
        stripes = carried.stripes(_stripes(light, carried.view, settings, alone), light, alone)
        if stripes:
            found[channel] = stripes
    return found


def _looked_for(light: _Light, there: tuple[slice, slice], settings: StripeSettings | None) -> tuple[Centreline, ...]:
    """Centrelines of stripes of these settings, chosen `there` if not given."""

    def look(stripe: StripeSettings) -> tuple[Centreline, ...]:
        return extract_centrelines(
            light.picture, stripe, noise=light.noise, saturated=light.saturated, ignore=light.outside
        )

    if settings is not None:
        return as_measured(settings, look)[1]
    chosen = choose_settings(np.ascontiguousarray(light.picture[there]), light.full_scale)
    return () if chosen is None else look(chosen)


def _beside_marks(
    centrelines: Sequence[Centreline], light: _Light, even: EvenPlate, camera: Camera, sites: Sites
) -> tuple[Centreline, ...]:
    """The same lines looked for again without what is printed on the plate: up to the marks, and between them."""
    usual = sites.stripe_of(usual_of(centrelines))
    courses = [course_of(line, camera, sites) for line in straight_lines(centrelines, camera)]
    courses = [course for course in courses if len(course)]
    if usual is None or not courses:
        return ()
    whole = across_marks(light.picture, light.saturated, sites.of(even.uneven) | light.outside, courses, usual)
    found = extract_centrelines(whole.picture, usual, noise=light.noise, saturated=whole.saturated, ignore=whole.beside)
    return sites.in_whole_picture(
        [whole.with_measured_sigma(line, usual.filter_px) for line in found if follows(line, courses, usual)]
    )


def _movement(on: Picture, off: Picture, view: TargetView, target: Target, camera: Camera | None) -> float | None:
    """How far in pixels the target is from `view` in the picture with the fan on; None if that cannot be told.

    Where a line of the fan lies along an edge, the target is not found, but its other edges tell. A grid of circles,
    which takes long to find, is only found anew where following its circles does not show that it stood still.
    """
    if not view.placed:
        return picture_shift(view, off, on)
    if isinstance(target, CircleGrid):
        followed = followed_shift(view, off, on)
        if followed is not None and followed < SURELY_STILL_PX:
            return followed
    try:
        return camera_shift(view, detect(target, on, view.name, camera, thorough=False))
    except TargetNotFound:
        return picture_shift(view, off, on)


def _window(view: TargetView, shape: tuple[int, ...], margin: float) -> tuple[slice, slice]:
    """Rows and columns of the target's points and `margin` times their extent on each side."""
    low, high = view.uv.min(axis=0), view.uv.max(axis=0)
    reach = margin * (high - low)
    left, top = np.maximum(low - reach, 0).astype(int)
    right, bottom = np.minimum(high + reach + 1, np.array(shape[::-1])).astype(int)
    return slice(top, bottom), slice(left, right)


def plate_level(plate: Picture, view: TargetView) -> float:
    """Compute the grey level of the light plate at and around the target's points."""
    return float(np.quantile(plate[_window(view, plate.shape, margin=0.25)][::4, ::4], 0.8))


def _on_even_plate(
    centrelines: Sequence[Centreline],
    plate: Picture | NDArray[np.float32],
    level: float,
    carrier: Plate,
    *,
    laser_off: bool,
    uneven: NDArray[np.bool_] | None = None,
) -> tuple[Centreline, ...]:
    """The points on the plate that is their `carrier`, nowhere `uneven`, no darker than DARK of its grey `level`.

    The centre of a stripe of σ = s on a plate whose brightness changes as exp(g n) across it moves by s² g. The plate
    is looked at where the stripe is if the laser is off there, else just beside it.
    """
    if not centrelines:
        return ()
    uv = np.vstack([line.uv for line in centrelines])
    across = np.vstack([line.normal for line in centrelines])
    width = np.concatenate([line.width for line in centrelines])
    width = np.clip(width, 0.5, 2 * np.median(width))
    reach = (FLANK if laser_off else 5.0) * width
    blur = float(np.median(width)) / 2 + 0.5
    smooth: NDArray[np.float32] = np.asarray(cv2.GaussianBlur(plate.astype(np.float32), (0, 0), blur), np.float32)
    beside = [uv + sign * (reach[:, None] * across) for sign in (-1, 1)]
    sides = [_sample(smooth, places) for places in beside]
    low, high = np.minimum(*sides), np.maximum(*sides)
    pull = width**2 * np.log(np.maximum(high, 1.0) / np.maximum(low, 1.0)) / (2 * reach)
    # brightness beside the stripe says less of what is under it: only steps count there
    even = carrier.contains(uv) & (low > DARK * level) & (pull < (PULL_PX if laser_off else 2 * PULL_PX))
    if uneven is not None:
        marks = uneven.astype(np.float32)
        even &= np.max([_sample(marks, places) for places in (uv, *beside)], axis=0) < 0.5
    kept, first = [], 0
    for line in centrelines:
        kept.extend(_runs(line, even[first : first + len(line)]))
        first += len(line)
    return tuple(kept)


def _sample(picture: NDArray[np.float32], uv: Array) -> Array:
    """Values (N,) of the picture at points (N, 2), linearly interpolated."""
    return np.asarray(map_coordinates(picture, uv.T[::-1], order=1, mode="nearest"), dtype=np.float64)


def _runs(line: Centreline, keep: NDArray[np.bool_]) -> list[Centreline]:
    """The unbroken runs of kept points that are long enough."""
    return [line.select(slice(a, b)) for a, b in runs_of(keep) if b - a >= SHORTEST]
