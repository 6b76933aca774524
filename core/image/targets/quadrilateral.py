"""Edges of a quadrilateral followed to sub-pixel: straight lines through the steepest places of grey profiles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from core.image.targets.edges import Line, PictureSpline, Profiles, fit_line, meet, profiles
from core.image.targets.picture import Picture
from core.image.targets.target_view import TargetNotFound
from core.messages import Message
from core.model import Camera
from core.model.arrays import Array
from core.model.robust import mad_sd, median

_END = 0.06
"""Share of an edge left out at either end, where the other edge's blur reaches it."""

UNSUSPICIOUS_PX = 0.4
"""Scatter of an edge's points about its line in pixels that is never suspected, however straight the others are."""
LARGEST_SCATTER_PX = 3.0
"""Scatter of an edge's points about its line in pixels, not suspected up to here, and always from here on."""

CLIPPED_SHARE = 0.5
"""Shift of a clipped edge (over-exposed plate, or black cut off at zero), as a share of the edge's blur σ."""

LIGHT_WITHIN_PX = 4.5
"""The light at an edge reaches its level within so many pixels, whatever the blur."""

Side = Literal["left", "right", "upper", "lower"]
"""Which edge of a quadrilateral, as the picture shows it."""

SHOW_EDGE = Message(
    "advice.show_edge", "check focus and exposure, and that neither a thing nor a laser line covers the edge"
)


@dataclass(frozen=True, eq=False, slots=True)
class Edges:
    """Edges of a quadrilateral in a picture.

    Parameters
    ----------
    quad
        (4, 2) its corners in px, where neighbouring lines meet; clockwise.
    lines
        Its four edges in flat coordinates, px at the middle of the picture: corner k is where lines k − 1 and k meet.
    blur_px
        (4,) σ of the edges' rise in px, with that of the filter that finds them.
    clipped_px
        How far an edge may have moved because its bright or its dark side is clipped; 0 if neither is.
    unit
        That of the profiles' sampling, in px.
    """

    quad: Array
    lines: tuple[Line, ...]
    blur_px: Array
    clipped_px: float
    unit: float = 1.0


@dataclass(frozen=True, eq=False, slots=True)
class EdgeSearch:
    """Search for the edges of quadrilaterals in one picture.

    Parameters
    ----------
    picture, camera
        (H, W) grey levels, and the camera in whose rays edges are straight; None: they are straight in pixels.
    name, lost
        The picture's name, and what is wrong if an edge cannot be followed, by the side it is on.
    """

    picture: Picture
    camera: Camera | None
    name: str
    lost: Mapping[Side, Message]

    def follow(
        self,
        quad: Array,
        half_widths: Sequence[float],
        *,
        inwards: bool = False,
        unit: float = 1.0,
        thin: bool = False,
    ) -> Edges:
        """Follow the edges of `quad` (4, 2), clockwise in px, in rounds that look less and less far to either side.

        Parameters
        ----------
        half_widths
            How far in px each round looks.
        inwards
            Whether the light lies within, not around it.
        unit
            Size in px that profiles are sampled and smoothed by, over the usual: less for what is thin.
        thin
            Whether what is dark is a line that profiles reach across: each edge's are then judged by themselves.

        Raises
        ------
        TargetNotFound
            If one of the edges cannot be followed.
        """
        flat = _StraightEdges(self.camera)
        spline = PictureSpline(self.picture, quad, 2 * half_widths[0] + 16)
        for half_width in half_widths:
            across = [
                _across(spline, flat, quad[[k, (k + 1) % 4]], half_width, -1.0 if inwards else 1.0, unit)
                for k in range(4)
            ]
            seen = [profile for _, _, profile in across]
            for k, profile in enumerate(seen):
                if not profile.valid.any():
                    raise TargetNotFound(self.lost[_side(quad, k)], where=self.name, todo=SHOW_EDGE)
            undisturbed = [_undisturbed([profile])[0] for profile in seen] if thin else _undisturbed(seen)
            edges = [_edge(flat, *each, use) for each, use in zip(across, undisturbed, strict=True)]
            for k, edge in enumerate(edges):
                if edge is None or _follows_something_else(edges, k):
                    raise TargetNotFound(self.lost[_side(quad, k)], where=self.name, todo=SHOW_EDGE)
            lines = tuple(edge for edge in edges if edge is not None)
            quad = flat.to_pixels(corners_of(lines))
        clipped = max(_clipped_shift(self.picture, profile) for profile in seen)
        blur = [_blur(profile, _light(spline, *each)) for each, profile in zip(across, seen, strict=True)]
        return Edges(quad, lines, np.array(blur), clipped, unit)

    def to_flat(self, uv: Array) -> Array:
        """Convert image points (N, 2) to coordinates (N, 2) in which straight edges are straight, px at the middle."""
        return _StraightEdges(self.camera).of(uv)

    def to_pixels(self, flat: Array) -> Array:
        """Convert flat coordinates (N, 2) to image points (N, 2)."""
        return _StraightEdges(self.camera).to_pixels(flat)


def corners_of(lines: Sequence[Line]) -> Array:
    """Compute where neighbouring lines meet, (K, 2): corner k is on lines k − 1 and k."""
    return np.array([meet(lines[k - 1], lines[k]) for k in range(len(lines))])


class _StraightEdges:
    """Coordinates in which straight edges are straight: ray coordinates times the focal length, or pixels."""

    def __init__(self, camera: Camera | None) -> None:
        self._camera = camera

    def of(self, uv: Array) -> Array:
        """Flat coordinates (N, 2), in pixels at the middle of the picture, of image points (N, 2)."""
        return uv if self._camera is None else self._camera.undistort(uv) * self._camera.focal

    def to_pixels(self, flat: Array) -> Array:
        """Image points (N, 2) of flat coordinates (N, 2)."""
        return flat if self._camera is None else self._camera.pixels(flat / self._camera.focal)


def _across(
    spline: PictureSpline, flat: _StraightEdges, ends: Array, half_width: float, outwards: float, unit: float
) -> tuple[Array, Array, Profiles]:
    """Points (K, 2) along the edge between `ends` (2, 2), the normals to the light there, and profiles along them."""
    a, b = flat.of(ends)
    length = float(np.linalg.norm(ends[1] - ends[0]))
    left_out = float(np.clip(5 / length, _END, 0.25))
    uv = flat.to_pixels(a + np.linspace(left_out, 1 - left_out, int(np.clip(length, 40, 4000)))[:, None] * (b - a))
    tangent = np.gradient(uv, axis=0)
    outward = np.column_stack([tangent[:, 1], -tangent[:, 0]]) / np.linalg.norm(tangent, axis=1, keepdims=True)
    towards_light = outwards * outward
    return uv, towards_light, profiles(spline, uv, towards_light, half_width, unit)


def _edge(flat: _StraightEdges, uv: Array, normal: Array, across: Profiles, use: NDArray[np.bool_]) -> Line | None:
    """The line, in flat coordinates, through the edge points that `use` selects."""
    points = flat.of(uv + across.offset[:, None] * normal)
    return fit_line(points, use & np.isfinite(points).all(axis=1), floor=0.01)


def _follows_something_else(edges: list[Line | None], k: int) -> bool:
    """Whether edge `k`'s points scatter far more than the others': it follows something else, such as a stripe."""
    scatter = [np.inf if edge is None else edge.sigma for edge in edges]
    return scatter[k] > min(LARGEST_SCATTER_PX, max(UNSUSPICIOUS_PX, 6 * float(np.median(scatter))))


def _undisturbed(edges: list[Profiles]) -> list[NDArray[np.bool_]]:
    """For each edge, which of its profiles (K,) no stripe of light crosses.

    From dark to bright the level must not fall again, by more than noise and 10 % of the contrast; it must stay near
    its own running median at either end, and not exceed the four edges' common level by more than 15 % of the contrast
    (a stripe that runs along an edge is usual there). Where that leaves too little, uneven light is taken to be the
    reason and the last rule is dropped.
    """
    dark = float(np.nanmedian([np.nanmedian(edge.dark) for edge in edges]))
    bright = float(np.nanmedian([np.nanmedian(edge.bright) for edge in edges]))
    slack = 0.15 * (bright - dark)
    usual_fall = float(np.nanmedian(np.concatenate([edge.fall for edge in edges])))
    chosen = []
    for edge in edges:
        with np.errstate(invalid="ignore"):
            rising = edge.valid & (edge.fall < 1.5 * usual_fall + 0.1 * (bright - dark))
            common = rising & (edge.dark < dark + slack) & (edge.bright < bright + slack)
        steady = rising & _near_running_median(edge.dark) & _near_running_median(edge.bright)
        both = steady & common
        if both.sum() < 0.3 * len(both):
            both = common if common.sum() >= 0.3 * len(both) else steady
        chosen.append(both)
    return chosen


def _near_running_median(level: Array) -> NDArray[np.bool_]:
    """Where `level` (N,) stays near its own running median."""
    known = np.where(np.isfinite(level), level, np.nanmedian(level) if np.isfinite(level).any() else 0.0)
    away = known - median_filter(known, size=max(15, len(known) // 2), mode="nearest")
    scale = max(mad_sd(away - median(away)), 0.5)
    usual: NDArray[np.bool_] = np.isfinite(level) & (np.abs(away) < 5 * scale)
    return usual


def _clipped_shift(picture: Picture, across: Profiles) -> float:
    """How far, in pixels, an edge may have moved because its bright or its dark side is clipped; 0 if neither is."""
    white = float(np.iinfo(picture.dtype).max)
    dark, bright = float(np.nanmedian(across.dark)), float(np.nanmedian(across.bright))
    if bright < 0.995 * white and dark > 0:
        return 0.0
    return CLIPPED_SHARE * _blur(across, bright)


def _blur(across: Profiles, bright: float) -> float:
    """σ in pixels of a Gaussian edge as steep as this one, up to the level `bright`."""
    step = bright - float(np.nanmedian(across.dark))
    return step / float(np.sqrt(2 * np.pi) * max(float(np.median(across.steepness[across.valid])), 1e-9))


def _light(spline: PictureSpline, uv: Array, normal: Array, across: Profiles) -> float:
    """Grey level of the light beyond an edge, at the distance from it at which it is lightest."""
    reach = np.arange(1.0, LIGHT_WITHIN_PX, 0.5)
    levels = spline.at((uv + across.offset[:, None] * normal)[:, None] + reach[:, None] * normal[:, None])
    return float(np.nanmedian(levels, axis=0).max())


def _side(quad: Array, k: int) -> Side:
    """Which side of the picture edge `k` of a `quad` (4, 2) is on."""
    du, dv = (quad[k] + quad[(k + 1) % 4]) / 2 - quad.mean(axis=0)
    if abs(du) > abs(dv):
        return "right" if du > 0 else "left"
    return "lower" if dv > 0 else "upper"
