"""Data for showing a scan and its frames. Light to import: a window needs it at its start."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from core.image.exclusion import Excludable, Reason
from core.image.stripes.centreline import Centreline
from core.image.stripes.stripe import StripeSettings
from core.messages import Message
from core.model import LightPlane
from core.model.arrays import Array
from core.scan.features.frames import FrameRecord

Float32 = NDArray[np.float32]
Picture8 = NDArray[np.uint8]
"""(H, W) grey levels for display."""


class CrossingStatus(IntEnum):
    """Quality of a crossing, by which it is drawn: good, weak or left out."""

    GOOD = 0
    WEAK = 1
    LEFT_OUT = 2


@dataclass(frozen=True, eq=False, slots=True)
class PreviewCloud:
    """Points for display, light enough to be sent from process to process.

    `points` (P, 3) in mm in the camera frame, `sigma` (P,) standard uncertainty of depth in mm, `intensity` (P,) in
    grey levels, `uv` (P, 2) in pixels, `frame` (P,) the index of the frame, −1 for the fan's own points.
    """

    points: Float32
    sigma: Float32
    intensity: Float32
    uv: Float32
    frame: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.points)

    @classmethod
    def joined(cls, clouds: Sequence[PreviewCloud]) -> PreviewCloud:
        """Concatenate the points of `clouds`, in order."""
        nothing = np.zeros(0, np.float32)
        flat = np.zeros((0, 3), np.float32), nothing, nothing, np.zeros((0, 2), np.float32), np.zeros(0, np.int32)
        parts = [(c.points, c.sigma, c.intensity, c.uv, c.frame) for c in clouds]
        return cls(*(np.concatenate(arrays) for arrays in zip(flat, *parts, strict=True)))


@dataclass(frozen=True, eq=False, slots=True)
class FramePreview(Excludable):
    """Preview of one frame: its stripe, its crossings with their quality, its points and hints for the hand.

    Parameters
    ----------
    index, name
        Of the frame.
    centrelines
        The stripe, thinned for display.
    sigma_mm
        For each of the centrelines, (N,) standard uncertainty of depth in mm; NaN where it is unknown.
    crossing_uv
        (M, 2) in pixels.
    crossing_status
        (M,) `CrossingStatus`.
    crossing_reason
        One sentence for each crossing.
    condition
        Of the crossings with the fan: ratio of singular values, infinite when they are collinear or too few; NaN
        without a fan.
    speed_px
        How far the stripe moves from frame to frame, in pixels: since the last frame looked at, by their number; NaN
        if not known.
    points, point_sigma, point_intensity
        (P, 3) in mm in the camera frame, (P,) in mm, (P,) in grey levels: the points worth showing.
    point_uv
        (P, 2) where they are in the picture, in pixels.
    hints
        At most two short sentences for the hand.
    exclusion
        Why there are no points; None if there are.
    renewed
        Not None: all points so far, this frame's and the fan's own included, located anew; they replace all that was
        given before. So with the first frame.
    fan_lines
        Not None: the fan's centrelines by line number, thinned for display, as far as settled; with the first frame,
        and again whenever a number has changed.
    """

    index: int
    name: str
    centrelines: tuple[Centreline, ...]
    sigma_mm: tuple[Array, ...]
    crossing_uv: Array
    crossing_status: NDArray[np.int8]
    crossing_reason: tuple[Message, ...]
    condition: float
    speed_px: float
    points: Array
    point_sigma: Array
    point_intensity: Array
    point_uv: Array
    hints: tuple[Message, ...]
    exclusion: Reason | None
    renewed: PreviewCloud | None = None
    fan_lines: tuple[tuple[Centreline, ...], ...] | None = None


def cloud_of(preview: FramePreview) -> PreviewCloud:
    """Make a cloud for display of the points of one frame's `preview` alone."""
    return PreviewCloud(
        preview.points.astype(np.float32),
        preview.point_sigma.astype(np.float32),
        preview.point_intensity.astype(np.float32),
        preview.point_uv.astype(np.float32),
        np.full(len(preview.points), preview.index, np.int32),
    )


def empty_preview(index: int, name: str, exclusion: Reason | None) -> FramePreview:
    """Make the preview of a frame that shows no stripe; `exclusion` is the reason."""
    none, empty = np.zeros(0), np.zeros((0, 2))
    return FramePreview(
        index,
        name,
        (),
        (),
        empty,
        np.zeros(0, np.int8),
        (),
        float("inf"),
        float("nan"),
        np.zeros((0, 3)),
        none,
        none,
        empty,
        (),
        exclusion,
    )


def stripes_alone(index: int, name: str, exclusion: Reason | None, centrelines: tuple[Centreline, ...]) -> FramePreview:
    """Make the preview of a frame of which nothing but its stripe is known."""
    return replace(empty_preview(index, name, exclusion), centrelines=centrelines, condition=float("nan"))


@dataclass(frozen=True, eq=False, slots=True)
class FrameStages:
    """Pictures and features of one frame at every stage of processing.

    Parameters
    ----------
    index, name
        Of the frame, in the order of the recording.
    picture
        As it was recorded.
    difference
        Frame − reference, brightened alike for all frames; what is darker than the reference is black.
    ridge
        Steger's strength at the stripe's scale, brightened in the same way.
    brighter
        Grey levels of `difference` and `ridge` for one grey level of the picture.
    sweep
        The hand-held laser's centrelines.
    fan
        The fan's centrelines, and in `fan_line` the line (from 0) each of them belongs to; −1 where that is not known.
    seen
        Crossings, each good, weak or left out with the reason, as this frame gives them by itself; None without
        calibrations, or a fan.
    shift_px
        How far the fan's light is from where it is in the reference.
    left_out
        Whether this frame is left out by hand; its stages are shown all the same.
    reason
        Why there is no sweep; None if there is.
    bounced
        Which of the sweep's centrelines the measurement left out as second bounces.
    """

    index: int
    name: str
    picture: Picture8
    difference: Picture8
    ridge: Picture8
    brighter: float
    sweep: tuple[Centreline, ...]
    fan: tuple[Centreline, ...]
    fan_line: tuple[int, ...]
    seen: FramePreview | None
    shift_px: float
    left_out: bool
    reason: Message | None
    bounced: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class SettledScan:
    """Settings that a finished measurement found: the stripes' width and contrast, the line of each fan centreline.

    `second_bounces` are frame and number of the sweeps' centrelines that it left out as such.
    """

    sweep_stripe: StripeSettings | None
    fan_stripe: StripeSettings
    fan_line: tuple[int, ...]
    second_bounces: tuple[tuple[int, int], ...] = ()


@dataclass(frozen=True, eq=False, slots=True)
class ShownScan:
    """Measured scan for display, light enough to be sent from process to process.

    Parameters
    ----------
    points, sigma
        (N, 3) float32 in mm in the camera frame, and (N,) float32, the standard uncertainty of each depth in mm without
        what is common to the whole scan.
    uv, frame
        (N, 2) float32, the pixel each was seen at, and (N,) int32, the index of its frame; −1 for the fan's own.
    triangles
        How many the mesh has.
    frames, frames_used
        The record of every frame, and how many of them gave points.
    median_sigma_mm, sigma_95_mm
        Half and 95 % of the points have no larger σ; NaN without points.
    share
        Covered share (0 … 1) of what was lit, as in `core.scan.surface.coverage_map`.
    stripe
        Width and contrast of the hand-held laser's stripe, as the measurement settled them.
    notes
        Notes for the technician about the scan; those about frames that gave no points are not among them.
    problems
        Why a result that exists cannot be shown: whole sentences.
    ground
        Plane of the lower face, where the thickness of this scan was measured.
    known_planes
        By their boards' names, (K, 2) px: where the known planes it was measured with are seen.
    """

    points: NDArray[np.float32]
    sigma: NDArray[np.float32]
    uv: NDArray[np.float32]
    frame: NDArray[np.int32]
    triangles: int
    frames: tuple[FrameRecord, ...]
    frames_used: int
    median_sigma_mm: float
    sigma_95_mm: float
    share: float
    stripe: StripeSettings | None
    notes: tuple[Message, ...]
    problems: tuple[Message, ...]
    ground: LightPlane | None = None
    known_planes: Mapping[str, Array] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.points)
