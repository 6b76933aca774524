"""When a live view of the target is worth taking: still, sharp, and unlike those taken before."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from core.calibrate.coverage import picture_cells
from core.calibrate.missing import (
    CAMERA_VIEWS,
    Series,
    ViewGeometry,
    missing_from,
    stand_in_camera,
    view_geometry,
    what_is_missing,
)
from core.image.target_view import TargetView
from core.model import Camera
from core.model.arrays import Array

__all__ = ["CaptureJudge", "CaptureLimits", "Verdict", "moved_px", "what_is_missing"]

COLUMNS = 16
"""Cells across the picture in the map of what the views cover."""

_LIKE_PLACE = 0.6
"""Two views share their place in the picture if the cells of both are this share of the cells of either."""

_SHOWN_FOR_S = 1.0
"""How long "Taken." stays."""


@dataclass(frozen=True, slots=True)
class CaptureLimits:
    """When a view is taken.

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


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether to take the view, and the sentence that says why or why not."""

    take: bool
    sentence: str


class CaptureJudge:
    """Judges the views of a live picture one after another.

    `views` are those taken so far and those known from before, `cells` (rows, COLUMNS) what of the picture they cover.
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
        self._camera = camera or stand_in_camera(image_size)
        self._rows = max(1, round(COLUMNS * image_size[1] / image_size[0]))
        self._recent: deque[tuple[float, TargetView]] = deque()
        self._sharpest = float("inf")
        self._taken: list[tuple[TargetView, ViewGeometry | None]] = []
        self._taken_at = float("-inf")

    @property
    def views(self) -> tuple[TargetView, ...]:
        """The views taken so far."""
        return tuple(view for view, _ in self._taken)

    @property
    def cells(self) -> NDArray[np.bool_]:
        """Which cells (rows, COLUMNS) of the picture hold a point of a view taken."""
        return self._cells(np.concatenate([np.zeros((0, 2)), *(view.uv for view in self.views)]))

    def judge(self, view: TargetView | None, blur_px: float, time_s: float, why_not: str = "") -> Verdict:
        """Whether to take this view.

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
            return Verdict(False, self._just_taken(time_s) or why_not or "The target is not seen.")
        self._recent.append((time_s, view))
        if sentence := self._just_taken(time_s):
            return Verdict(False, sentence)
        if not self._still():
            return Verdict(False, "Hold still.")
        self._sharpest = min(self._sharpest, blur_px)
        if not blur_px <= min(self._limits.blur_px, self._limits.blurred * max(self._sharpest, 0.7)):
            return Verdict(False, f"Too blurred (edges {blur_px:.1f} px wide): hold still or focus.")
        if sentence := self._already_there(view):
            return Verdict(False, sentence)
        return Verdict(True, "Taken.")

    def know(self, views: Iterable[TargetView]) -> None:
        """Views of an earlier recording, which new ones are added to; they cannot be thrown away here."""
        for view in views:
            nameless = TargetView(view.points, view.uv, view.sigma, "")
            self._taken.append((nameless, view_geometry(nameless, self._camera)))

    def taken(self, view: TargetView, time_s: float) -> None:
        """The view was taken, by this judge's word or by hand."""
        self._taken.append((view, view_geometry(view, self._camera)))
        self._taken_at = time_s

    def forget(self, name: str) -> None:
        """The view of this name was thrown away."""
        self._taken = [(view, geometry) for view, geometry in self._taken if view.name != name]

    def missing(self) -> tuple[str, ...]:
        """What the views taken so far lack, in words."""
        return missing_from(self.views, [geometry for _, geometry in self._taken], self._image_size, self._series)

    def _just_taken(self, time_s: float) -> str:
        return "Taken." if 0 <= time_s - self._taken_at < _SHOWN_FOR_S else ""

    def _still(self) -> bool:
        """Whether the target has rested for long enough; forgets what is older than needed to tell."""
        recent = self._recent
        while len(recent) > 2 and recent[-1][0] - recent[1][0] >= self._limits.still_s:
            recent.popleft()
        if len(recent) < 2 or recent[-1][0] - recent[0][0] < self._limits.still_s:
            return False
        limit = self._limits.still_px_s * max(self._image_size) / 1920
        return all(
            moved_px(view, moved) <= limit * max(after - before, 1e-3)
            for (before, view), (after, moved) in pairwise(recent)
        )

    def _already_there(self, view: TargetView) -> str:
        """The sentence for a view like one that was taken, or "" if it adds something."""
        geometry, cells = view_geometry(view, self._camera), self._cells(view.uv)
        here = False
        for other, seen in self._taken:
            covered = self._cells(other.uv)
            if np.sum(cells & covered) < _LIKE_PLACE * np.sum(cells | covered):
                continue
            here = True
            if geometry is None or seen is None:
                return f"Move the {self._series.thing}: this place is already taken."
            turned = geometry.angle_to(seen) >= self._limits.turned
            nearer = abs(np.log(geometry.distance / seen.distance)) >= np.log(self._limits.nearer)
            if not turned and not nearer:
                return f"Turn the {self._series.thing}: this tilt is already there."
        if here or geometry is None or not np.all(self.cells[cells]):
            return ""
        alike = any(seen is not None and geometry.angle_to(seen) < self._limits.turned for _, seen in self._taken)
        return f"Turn or move the {self._series.thing}: this tilt and place are already there." if alike else ""

    def _cells(self, uv: Array) -> NDArray[np.bool_]:
        return picture_cells(uv, self._image_size, COLUMNS, self._rows)


def moved_px(before: TargetView, after: TargetView) -> float:
    """Median movement in pixels of the points that both views show; infinite if there are none."""
    first, second = (
        np.round(view.points[:, 0] * 1e3) * 1e7 + np.round(view.points[:, 1] * 1e3) for view in (before, after)
    )
    _, one, other = np.intersect1d(first, second, assume_unique=True, return_indices=True)
    if not len(one):
        return float("inf")
    return float(np.median(np.linalg.norm(after.uv[other] - before.uv[one], axis=1)))
