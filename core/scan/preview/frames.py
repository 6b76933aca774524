"""Preview of a running scan: each frame's crossings, its light plane, and points good enough to be shown.

The network over all frames is the result; this is only the preview. Each sweep is located as it comes
(`core.scan.sweeps.tracking`), the numbers of the fan's lines are settled on the way, and the cloud shown so far is
renewed when more is known, a little after each frame: no frame waits for it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from core.image.stripes.centreline import Centreline
from core.messages import Message
from core.model import Camera, Fan
from core.model.arrays import Array
from core.scan.features.crossings import CrossingWindow
from core.scan.features.extraction import FrameFeatures, ReferenceFeatures
from core.scan.features.frames import FEW_CROSSINGS
from core.scan.known_planes.known_plane import Control
from core.scan.network.sweep_plane import plane_condition
from core.scan.preview.crossing_marks import CrossingMarks, mark_crossings
from core.scan.preview.hints import HandState, HintLimits, hints_for
from core.scan.preview.shown import FramePreview, PreviewCloud, cloud_of, empty_preview
from core.scan.reconstruct import FARTHEST_SHARE, NEAREST_SHARE
from core.scan.surface.triangulate import LEAST_INVERSE_DEPTH
from core.scan.sweeps.fan_lines import UNASSIGNED, FanLines
from core.scan.sweeps.tracking import SweepTracker, TrackedSweep, movement_px

# Chosen so that renewing the cloud never keeps a frame waiting; tests/scan/preview/test_frames.py holds that.
RENEWED_AT_ONCE = 128
"""Sweeps renewed in one go if they lie where they lay before,"""
RELOCATION = 8
"""and what a sweep counts for that must be located again: about so many times the work."""


@dataclass(frozen=True, slots=True)
class PreviewOptions:
    """Options of a scan's preview: which and how many points are shown, and when hints are given.

    Points up to `largest_sigma_mm` are shown (twenty times the result's: a frame alone is less sure), every `thin`-th
    of a stripe; of a long scan fewer, of all its frames alike, so that the sweeps' stripes have no more than
    `most_points`, which a window can draw while a scan runs.
    """

    largest_sigma_mm: float = 1.0
    thin: int = 3
    most_points: int = 200_000
    window: CrossingWindow = field(default_factory=CrossingWindow)
    hints: HintLimits = field(default_factory=HintLimits)


@dataclass(frozen=True, eq=False, slots=True)
class StripeRays:
    """The points of one frame's stripe: `rays` (N, 3), and their σ across the stripe as vectors (N, 2) in x, y."""

    frame: int
    uv: Array
    rays: Array
    across: Array
    intensity: Array
    usable: NDArray[np.bool_]

    @classmethod
    def of(cls, frame: int, pieces: Sequence[Centreline], camera: Camera) -> StripeRays:
        """Collect the points of the centrelines `pieces` of a `frame`, in their order, with their rays by `camera`."""
        uv = np.concatenate([np.zeros((0, 2)), *(piece.uv for piece in pieces)])
        normal = np.concatenate([np.zeros((0, 2)), *(piece.normal for piece in pieces)])
        sigma = np.concatenate([np.zeros(0), *(piece.sigma for piece in pieces)])
        strength = np.concatenate([np.zeros(0), *(piece.strength for piece in pieces)])
        saturated = np.concatenate([np.zeros(0, np.bool_), *(piece.saturated for piece in pieces)])
        rays = camera.rays(uv)
        across = np.einsum("nij,nj->ni", camera.ray_jacobian(rays), normal) * sigma[:, None]
        return cls(frame, uv, rays, across, strength, ~saturated & np.isfinite(rays).all(axis=1))

    def thinned(self, step: int = 2) -> StripeRays:
        """Select every `step`-th point of the stripe, as a copy, so that the others' memory can be freed."""
        return StripeRays(
            self.frame,
            self.uv[::step].copy(),
            self.rays[::step].copy(),
            self.across[::step].copy(),
            self.intensity[::step].copy(),
            self.usable[::step].copy(),
        )

    def __len__(self) -> int:
        return len(self.rays)

    def depth(self, pi: Array, covariance: Array) -> tuple[Array, Array]:
        """Compute the depth (N,) in mm of the stripe on the plane `pi` (3,) with `covariance` (3, 3), and its σ (N,).

        NaN where there is none.
        """
        inverse = self.rays @ pi
        inverse = np.where(self.usable & (inverse > LEAST_INVERSE_DEPTH), inverse, np.nan)
        variance = np.einsum("ni,ij,nj->n", self.rays, covariance, self.rays, optimize=True)
        variance = variance + (self.across @ pi[:2]) ** 2
        return 1 / inverse, np.sqrt(np.maximum(variance, 0)) / inverse**2

    def cloud(self, depth: Array, sigma: Array, keep: NDArray[np.bool_]) -> PreviewCloud:
        """Make a cloud for display of the points in the mask `keep` (N,), at `depth` (N,) with `sigma` (N,) in mm."""
        return PreviewCloud(
            (self.rays[keep] * depth[keep, None]).astype(np.float32),
            sigma[keep].astype(np.float32),
            self.intensity[keep].astype(np.float32),
            self.uv[keep].astype(np.float32),
            np.full(np.count_nonzero(keep), self.frame, np.int32),
        )


class Preview:
    """Preview of a scan, made from the features of its frames one after another.

    Built once per scan from the features of its reference picture
    (:func:`core.scan.features.extraction.read_reference`). Without a fan known planes locate the sweeps; beside one
    they locate nothing here. Not to be called from two threads at once.
    """

    def __init__(
        self,
        reference: ReferenceFeatures,
        camera: Camera,
        known: Fan | Control,
        options: PreviewOptions | None = None,
        lines: FanLines | None = None,
    ) -> None:
        self._options = options = options or PreviewOptions()
        control = Control.of(known)
        self._camera, self._fan, self._reference = camera, control.fan, reference
        self._boards = () if control.fan.lines else tuple(plane.name for plane in control.planes)
        self._tracker = SweepTracker(reference.fan, camera, control, options.window, lines=lines)
        self._thin_fan = [piece.select(slice(None, None, options.thin)) for piece in reference.fan]
        self._fan_rays = [StripeRays.of(-1, [piece], camera) for piece in self._thin_fan]
        self._stripes: dict[int, StripeRays] = {}
        self._kept, self._step = 0, 1
        self._waiting: deque[int] = deque()
        self._coming: list[PreviewCloud] | None = None
        self._whole: PreviewCloud | None = None
        self._thinned = False
        self._before: Sequence[Centreline] = ()
        self._before_index = -1
        self._speed_before = float("nan")
        self._told: tuple[int, ...] | None = None
        self._limits = _depth_limits(self._fan_clouds())

    @property
    def fan_lines(self) -> tuple[tuple[Centreline, ...], ...]:
        """The fan's centrelines for each line number, thinned for display; those not settled are in none."""
        pieces = list(zip(self._thin_fan, self._tracker.lines.line, strict=True))
        return tuple(tuple(piece for piece, k in pieces if k == line) for line in range(self._fan.lines))

    def cloud(self) -> PreviewCloud:
        """Collect all points located so far, those of the fan first."""
        return PreviewCloud.joined([*self._fan_clouds(), *map(self._points_of, self._stripes)])

    @property
    def has_more(self) -> bool:
        """Whether earlier sweeps wait to be located again, which `go_on` does after a frame is shown."""
        return self._coming is not None or self._thinned or self._tracker.is_due

    def go_on(self) -> None:
        """Do a small part of locating earlier sweeps again with what later frames have shown, while `has_more`.

        Called again and again it adjusts the anchors when that is due, and then makes the cloud anew by them,
        RENEWED_AT_ONCE sweeps at a time. The next frame brings the cloud once it is complete.
        """
        if self._coming is None:
            self._begin()
            return
        work = 0
        while self._waiting and work < RENEWED_AT_ONCE:
            frame = self._waiting.popleft()
            work += RELOCATION if self._tracker.is_outdated(frame) else 1
            self._coming.append(self._points_of(frame))
        if not self._waiting:
            self._whole, self._coming = PreviewCloud.joined(self._coming), None

    def __call__(self, features: FrameFeatures) -> FramePreview:
        """Make the preview of one frame from its `features`; frames come in the order of time."""
        if not features.centrelines:
            self._before, self._speed_before = (), float("nan")
            return self._with_updates(empty_preview(features.index, features.name, features.exclusion))
        sweep = self._tracker.add(features.index, features.centrelines)
        thin = tuple(piece.select(slice(None, None, self._options.thin)) for piece in features.centrelines)
        stripe = StripeRays.of(features.index, thin, self._camera)
        plane = sweep.plane
        sigma = np.full(len(stripe), np.nan) if plane is None else stripe.depth(plane.pi, plane.covariance)[1]
        self._keep(stripe)
        points = self._points_of(features.index)
        marks = mark_crossings(sweep, self._tracker.lines, self._boards)
        lines_met, condition = self._met(sweep)
        speed = movement_px(features.centrelines, self._before) / max(1, features.index - self._before_index)
        lasting = min(speed, self._speed_before)  # one jump, as from the end of a pass to the next, is no haste
        self._before, self._before_index, self._speed_before = features.centrelines, features.index, speed
        preview = FramePreview(
            features.index,
            features.name,
            thin,
            tuple(np.split(sigma, np.cumsum([len(piece) for piece in thin])[:-1])),
            marks.uv,
            marks.status,
            marks.reason,
            condition,
            speed,
            np.asarray(points.points, dtype=np.float64),
            np.asarray(points.sigma, dtype=np.float64),
            np.asarray(points.intensity, dtype=np.float64),
            np.asarray(points.uv, dtype=np.float64),
            self._hints(stripe, lines_met, sigma, lasting),
            None if len(points) else self._why_no_points(marks, located=plane is not None),
        )
        return self._with_updates(preview)

    def _keep(self, stripe: StripeRays) -> None:
        """Keep the points of a frame as dense as those before, and every second of all when they become too many."""
        self._stripes[stripe.frame] = kept = stripe.thinned(self._step)
        self._kept += len(kept)
        if self._kept > self._options.most_points:
            self._step *= 2
            self._stripes = {frame: stripe.thinned() for frame, stripe in self._stripes.items()}
            self._kept = sum(map(len, self._stripes.values()))
            self._thinned, self._coming = True, None
        elif self._coming is not None:
            self._waiting.append(stripe.frame)

    def _begin(self) -> None:
        """Adjust the anchors if that is due, and begin to make the cloud anew if there is a reason."""
        before, anew = self._tracker.lines.line, self._thinned
        if self._tracker.is_due:
            anew |= self._tracker.adjust() or self._tracker.lines.line != before
        if anew:
            self._thinned, self._waiting = False, deque(self._stripes)
            self._coming = self._fan_clouds()
            self._limits = _depth_limits(self._coming)

    def _points_of(self, frame: int) -> PreviewCloud:
        """The points of one sweep within the cut, by what is known now."""
        plane = self._tracker.located_anew(frame).plane
        if plane is None:
            return PreviewCloud.joined([])
        stripe = self._stripes[frame]
        depth, sigma = stripe.depth(plane.pi, plane.covariance)
        return stripe.cloud(depth, sigma, self._worth_showing(depth, sigma))

    def _with_updates(self, preview: FramePreview) -> FramePreview:
        """The preview with the whole cloud and the fan's lines, if they are new."""
        line = self._tracker.lines.line
        whole, self._whole = self._whole, None
        if self._told is None:
            whole = self.cloud()
        elif whole is not None:
            whole = PreviewCloud.joined([whole, cloud_of(preview)])
        changed, self._told = line != self._told, line
        return replace(preview, renewed=whole, fan_lines=self.fan_lines if changed else None)

    def _met(self, sweep: TrackedSweep) -> tuple[int, float]:
        """How many lines of the fan, or known planes, the sweep crosses, and the condition of those crossings."""
        line = self._tracker.line_of(sweep.crossings)
        rows = np.flatnonzero(line != UNASSIGNED)
        line = line[rows]
        condition = plane_condition(sweep.geometry.rays[rows]) if sweep.plane is None else sweep.plane.condition
        return len(np.unique(line)), condition

    def _hints(self, stripe: StripeRays, lines_met: int, sigma: Array, speed: float) -> tuple[Message, ...]:
        known = sigma[np.isfinite(sigma)]
        state = HandState(
            lines_met,
            self._fan.lines or len(self._boards),
            float(np.median(known)) if len(known) else float("nan"),
            speed,
            self._reference.image_size[0],
            float(np.median(stripe.intensity)),
            self._reference.full_scale,
            float(np.mean(~stripe.usable)),
            has_fan=self._fan.lines > 0,
        )
        return hints_for(state, self._options.hints)

    def _why_no_points(self, marks: CrossingMarks, *, located: bool) -> Message:
        if located:
            return Message("scan.preview_uncertain", "its light plane is too uncertain for any point to be shown")
        if not self._fan.lines:
            return Message("scan.preview_off_boards", "its stripe lies on too few boards to be located")
        if not len(marks.uv):
            return Message("scan.preview_without_crossing", "its stripe crosses no line of the fan")
        return FEW_CROSSINGS

    def _fan_clouds(self) -> list[PreviewCloud]:
        """The fan's own points, measured directly."""
        clouds = []
        for stripe, line in zip(self._fan_rays, self._tracker.lines.line, strict=True):
            if line != UNASSIGNED:
                depth, sigma = stripe.depth(self._fan.planes[line].pi, np.zeros((3, 3)))
                clouds.append(stripe.cloud(depth, sigma, np.isfinite(depth)))
        return clouds

    def _worth_showing(self, depth: Array, sigma: Array) -> NDArray[np.bool_]:
        near, far = self._limits
        return np.asarray((sigma <= self._options.largest_sigma_mm) & (depth > near) & (depth < far))


def _depth_limits(fan: Sequence[PreviewCloud]) -> tuple[float, float]:
    """Nearest and farthest depth in mm of points that are shown, as `core.scan.reconstruct` cuts them."""
    depth = PreviewCloud.joined(fan).points[:, 2]
    return (NEAREST_SHARE * float(depth.min()), FARTHEST_SHARE * float(depth.max())) if len(depth) else (0.0, np.inf)
