"""Choice of live views of the target: still, sharp, and unlike those taken before."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from core.calibrate.camera.coverage import MAP_COLUMNS, picture_cells
from core.calibrate.camera.missing import (
    CAMERA_VIEWS,
    Series,
    ViewGeometry,
    missing_from,
    typical_camera,
    view_geometry,
    what_is_missing,
)
from core.calibrate.camera.wanted_view import next_view_outline
from core.image.targets.target_view import TargetView
from core.messages import Message
from core.model import Camera
from core.model.arrays import Array

__all__ = ["CaptureJudge", "CaptureLimits", "Verdict", "moved_px", "what_is_missing"]

# Held by tests/calibrate/camera/test_capture.py on the simulated camera.
_SAME_PLACE_SHARE = 0.6
"""Two views share their place in the picture if the cells of both are this share of the cells of either."""
_SHOWN_FOR_S = 1.0
"""Time in s that TAKEN stays."""
_SHARPEST_PX = 0.7
"""Gaussian σ in px that the sharpest view counts as at least: no lens is sharper on its pixels."""
_REFERENCE_WIDTH_PX = 1920
"""Width of the picture for which limits in px are stated."""


@dataclass(frozen=True, slots=True)
class CaptureLimits:
    """Limits within which a view is taken.

    Parameters
    ----------
    still_s, still_px_s
        For so long, seen in two views at least, the corners must not move faster than so many px/s, in a picture
        1920 px wide.
    blur_px
        Gaussian σ of the edges, at most.
    blurred
        How many times as blurred as the sharpest view seen is too much: a smear, or focus that was lost.
    turned, nearer
        Angle in rad, and ratio of distances, from which on two views are different.
    """

    still_s: float = 0.2
    still_px_s: float = 8.0
    blur_px: float = 2.5
    blurred: float = 1.8
    turned: float = float(np.deg2rad(10.0))
    nearer: float = 1.2


TAKEN = Message("live.taken", "Taken.")
HOLD_STILL = Message("live.hold_still", "Hold still.")


@dataclass(frozen=True, slots=True)
class Verdict:
    """Decision on a view: whether to take it, and the reason.

    `of_no_use` if the target must be held otherwise to take one.
    """

    take: bool
    sentence: Message
    of_no_use: bool = False


class CaptureJudge:
    """Judge of the views of a live picture, one after another.

    `views` are those taken so far and those known from before, `cells` (rows, MAP_COLUMNS) what of the picture they
    cover.
    """

    def __init__(
        self,
        image_size: tuple[int, int],
        camera: Camera | None = None,
        limits: CaptureLimits | None = None,
        series: Series = CAMERA_VIEWS,
    ) -> None:
        self._series = series
        self._image_size, self._limits = image_size, limits or CaptureLimits()
        self._camera = camera or typical_camera(image_size)
        self._rows = max(1, round(MAP_COLUMNS * image_size[1] / image_size[0]))
        self._recent: deque[tuple[float, TargetView]] = deque()
        self._sharpest = float("inf")
        self._taken: list[tuple[TargetView, ViewGeometry | None]] = []
        self._taken_at = float("-inf")

    @property
    def views(self) -> tuple[TargetView, ...]:
        """Views of the target taken so far."""
        return tuple(view for view, _ in self._taken)

    @property
    def cells(self) -> NDArray[np.bool_]:
        """Cells (rows, MAP_COLUMNS) of the picture, True where a view taken has a point."""
        return self._cells(np.concatenate([np.zeros((0, 2)), *(view.uv for view in self.views)]))

    def judge(self, view: TargetView | None, blur_px: float, time_s: float, why_not: Message | None = None) -> Verdict:
        """Judge whether to take the `view` in a live picture now: it must be still, sharp and add to those taken.

        Parameters
        ----------
        view
            What the picture shows of the target, or None, with `why_not` as the reason.
        blur_px
            Gaussian σ of its edges (:func:`core.image.sharpness.edge_blur_px`).
        time_s
            When it was exposed.
        """
        if view is None:
            self._recent.clear()
            unseen = why_not or Message("live.target_unseen", "The target is not seen.")
            return Verdict(False, TAKEN) if self._just_taken(time_s) else Verdict(False, unseen, of_no_use=True)
        self._recent.append((time_s, view))
        if self._just_taken(time_s):
            return Verdict(False, TAKEN)
        if not self._still():
            return Verdict(False, HOLD_STILL)
        self._sharpest = min(self._sharpest, blur_px)
        if not blur_px <= min(self._limits.blur_px, self._limits.blurred * max(self._sharpest, _SHARPEST_PX)):
            blurred = Message(
                "live.too_blurred", "Too blurred (edges {blur_px:.1f} px wide): hold still or focus.", blur_px=blur_px
            )
            return Verdict(False, blurred, of_no_use=True)
        already_there = self._already_there(view_geometry(view, self._camera), self._cells(view.uv))
        return Verdict(True, TAKEN) if already_there is None else Verdict(False, already_there, of_no_use=True)

    def add_earlier(self, views: Iterable[TargetView]) -> None:
        """Add the views of an earlier recording that is continued."""
        for view in views:
            nameless = TargetView(view.points, view.uv, view.sigma, "")
            self._taken.append((nameless, view_geometry(nameless, self._camera)))

    def record_taken(self, view: TargetView, time_s: float) -> None:
        """Record that a view was taken at `time_s`, by this judge's verdict or by hand."""
        self._taken.append((view, view_geometry(view, self._camera)))
        self._taken_at = time_s

    def forget(self, name: str) -> None:
        """Remove the view called `name`, which the user deleted, from those taken."""
        self._taken = [(view, geometry) for view, geometry in self._taken if view.name != name]

    def missing(self) -> tuple[Message, ...]:
        """Advise what to record next, for what the views taken lack; () if they suffice."""
        return missing_from(self.views, [geometry for _, geometry in self._taken], self._image_size, self._series)

    def next_outline(self) -> Array | None:
        """Outline (5, 2) in px, closed, of the target in the view that would add most; None if none is wanted.

        Nor is anything wanted before a first view was taken.
        """
        known = [geometry for _, geometry in self._taken if geometry is not None]
        if not known or not self.missing():
            return None
        points = np.concatenate([view.points[:, :2] for view in self.views])
        covered = self.cells

        def adds(geometry: ViewGeometry, uv: Array) -> float | None:
            cells = self._cells(uv)
            if self._already_there(geometry, cells) is not None:
                return None
            return float(np.mean(cells & ~covered)) if self._series.everywhere else 0.0

        middle = None if self._series.everywhere else np.mean([view.uv.mean(axis=0) for view in self.views], axis=0)
        return next_view_outline(np.array([points.min(axis=0), points.max(axis=0)]), self._camera, known, adds, middle)

    def _just_taken(self, time_s: float) -> bool:
        return 0 <= time_s - self._taken_at < _SHOWN_FOR_S

    def _still(self) -> bool:
        """Whether the target has rested for long enough; forgets what is older than needed to tell."""
        recent = self._recent
        while len(recent) > 2 and recent[-1][0] - recent[1][0] >= self._limits.still_s:
            recent.popleft()
        if len(recent) < 2 or recent[-1][0] - recent[0][0] < self._limits.still_s:
            return False
        limit = self._limits.still_px_s * max(self._image_size) / _REFERENCE_WIDTH_PX
        return all(
            moved_px(view, moved) <= limit * max(after - before, 1e-3)
            for (before, view), (after, moved) in pairwise(recent)
        )

    def _already_there(self, geometry: ViewGeometry | None, cells: NDArray[np.bool_]) -> Message | None:
        """The sentence for a view like one that was taken; None if it adds something."""
        thing = self._series.thing
        here = False
        for other, seen in self._taken:
            covered = self._cells(other.uv)
            if np.sum(cells & covered) < _SAME_PLACE_SHARE * np.sum(cells | covered):
                continue
            here = True
            if geometry is None or seen is None:
                return Message("live.place_taken", "Move the {thing}: this place is already taken.", thing=thing)
            turned = geometry.angle_to(seen) >= self._limits.turned
            nearer = abs(np.log(geometry.distance / seen.distance)) >= np.log(self._limits.nearer)
            if not turned and not nearer:
                return Message("live.tilt_taken", "Turn the {thing}: this tilt is already there.", thing=thing)
        if here or geometry is None or not np.all(self.cells[cells]):
            return None
        alike = any(seen is not None and geometry.angle_to(seen) < self._limits.turned for _, seen in self._taken)
        if not alike:
            return None
        return Message(
            "live.tilt_and_place_taken",
            "Turn or move the {thing}: this tilt and place are already there.",
            thing=thing,
        )

    def _cells(self, uv: Array) -> NDArray[np.bool_]:
        return picture_cells(uv, self._image_size, MAP_COLUMNS, self._rows)


def moved_px(before: TargetView, after: TargetView) -> float:
    """Compute the median movement in px of the points seen in both views; infinite if there are none."""
    first, second = (
        np.round(view.points[:, 0] * 1e3) * 1e7 + np.round(view.points[:, 1] * 1e3) for view in (before, after)
    )
    _, one, other = np.intersect1d(first, second, assume_unique=True, return_indices=True)
    if not len(one):
        return float("inf")
    return float(np.median(np.linalg.norm(after.uv[other] - before.uv[one], axis=1)))
