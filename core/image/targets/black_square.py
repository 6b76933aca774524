"""The paper's plane target: the corners of a black square, where the lines through its sub-pixel edges meet."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from core.image.targets.dark_squares import DarkSquares, dark_squares, first_corner
from core.image.targets.edges import Line, PictureSpline, Profiles, corner_covariance, fit_line, meet, profiles
from core.image.targets.kinds import BlackSquare
from core.image.targets.picture import Picture, as_8bit, enlarged, reduced
from core.image.targets.target_view import TargetNotFound, TargetView
from core.messages import Field, Message
from core.model import Camera
from core.model.arrays import Array
from core.model.robust import mad_sd, median

SYSTEMATIC_PX = 0.005
"""What is left on perfect pictures, RMS per coordinate."""

_END = 0.06
"""Share of an edge left out at either end, where the other edge's blur reaches it."""

UNSUSPICIOUS_PX = 0.4
"""Scatter of an edge's points about its line in pixels that is never suspected, however straight the others are."""
LARGEST_SCATTER_PX = 3.0
"""Scatter of an edge's points about its line in pixels, not suspected up to here, and always from here on."""

CLIPPED_SHARE = 0.5
"""Shift of a clipped edge (over-exposed plate, or black cut off at zero), as a share of the edge's blur σ."""

Side = Literal["left", "right", "upper", "lower"]
_EDGE_LOST: Mapping[Side, Message] = {
    "left": Message("target.left_edge_lost", "the black square is there, but its left edge cannot be followed"),
    "right": Message("target.right_edge_lost", "the black square is there, but its right edge cannot be followed"),
    "upper": Message("target.upper_edge_lost", "the black square is there, but its upper edge cannot be followed"),
    "lower": Message("target.lower_edge_lost", "the black square is there, but its lower edge cannot be followed"),
}
_SHOW_EDGE = Message(
    "advice.show_edge", "check focus and exposure, and that neither a thing nor a laser line covers the edge"
)
_KIND = Field("plane_target.kind", whole=True)


def detect_black_square(
    square: BlackSquare, picture: Picture, name: str = "", camera: Camera | None = None
) -> TargetView:
    """Find the corners of `square` in `picture` (H, W), in the order of `square.points`, with covariance.

    Edge points are the steepest places of profiles across each edge, one per pixel of edge. Those that a laser stripe
    disturbs are left out: by the level of the dark or the bright side, and by Tukey's weights in the line fit. Lines
    are fitted in undistorted rays if there is a `camera`, in pixels if not.

    Raises
    ------
    TargetNotFound
        If there is no dark square on a light ground, several of like size, one cut off by the picture's border, or
        one whose edges cannot be followed.
    """
    small, factor = reduced(as_8bit(picture), 900)
    seen = dark_squares(small)
    _check_single(seen, name)
    flat = _StraightEdges(camera)
    quad = enlarged(seen.whole[0], factor)
    near = min(4.0 * factor + 4, 0.1 * float(np.linalg.norm(quad[0] - quad[2])))
    spline = PictureSpline(picture, quad, 2 * near + 16)
    for half_width in (near, min(6.0, near), min(6.0, near)):
        across = [_across(spline, flat, quad[k], quad[(k + 1) % 4], half_width) for k in range(4)]
        undisturbed = _undisturbed([profile for _, _, profile in across])
        edges = [_edge(flat, *each, use) for each, use in zip(across, undisturbed, strict=True)]
        for k, edge in enumerate(edges):
            if edge is None or _follows_something_else(edges, k):
                raise TargetNotFound(_EDGE_LOST[_side(quad, k)], where=name, todo=_SHOW_EDGE)
        lines = [edge for edge in edges if edge is not None]
        quad = flat.to_pixels(np.array([meet(lines[k - 1], lines[k]) for k in range(4)]))
    clipped = max(_clipped_shift(picture, profile) for _, _, profile in across)
    first = first_corner(quad)
    order = np.roll(np.arange(4), -first)
    covariance = corner_covariance(lines)[order][:, :, order].reshape(8, 8)
    covariance = covariance + (SYSTEMATIC_PX**2 + clipped**2) * np.eye(8)
    sigma = np.sqrt(np.diag(covariance).reshape(4, 2).mean(axis=1))
    return TargetView(square.points, quad[order], sigma, name, covariance)


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
    spline: PictureSpline, flat: _StraightEdges, start: Array, end: Array, half_width: float
) -> tuple[Array, Array, Profiles]:
    """Points (K, 2) along the edge from `start` to `end`, the outward normals there, and the profiles along them."""
    a, b = flat.of(np.array([start, end]))
    length = float(np.linalg.norm(end - start))
    left_out = float(np.clip(5 / length, _END, 0.25))
    uv = flat.to_pixels(a + np.linspace(left_out, 1 - left_out, int(np.clip(length, 40, 4000)))[:, None] * (b - a))
    tangent = np.gradient(uv, axis=0)
    outward = np.column_stack([tangent[:, 1], -tangent[:, 0]]) / np.linalg.norm(tangent, axis=1, keepdims=True)
    return uv, outward, profiles(spline, uv, outward, half_width)


def _edge(flat: _StraightEdges, uv: Array, outward: Array, across: Profiles, use: NDArray[np.bool_]) -> Line | None:
    """The line, in flat coordinates, through the edge points that `use` selects."""
    points = flat.of(uv + across.offset[:, None] * outward)
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
    blur = (bright - dark) / (np.sqrt(2 * np.pi) * max(float(np.median(across.steepness[across.valid])), 1e-9))
    return float(CLIPPED_SHARE * blur)


def _check_single(seen: DarkSquares, name: str) -> None:
    """Refuse a picture with no whole square or with several that might be meant."""
    if not seen.whole:
        if seen.cut_off:
            raise TargetNotFound(
                Message("target.square_cut_off", "only a part of the black square is in the picture"),
                where=name,
                todo=Message(
                    "advice.show_whole_square",
                    "move the target so that the whole square is seen, with light plate all round it",
                ),
            )
        raise TargetNotFound(
            Message("target.no_square", "no black square on a light plate is seen in the picture"),
            where=name,
            todo=Message("advice.leave_out_or_check_kind", "leave the picture out, or check {field}", field=_KIND),
        )
    sizes = [float(np.linalg.norm(quad[0] - quad[2]) * np.linalg.norm(quad[1] - quad[3])) for quad in seen.whole]
    alike = sum(size > 0.5 * sizes[0] for size in sizes)
    if alike > 1:
        raise TargetNotFound(
            Message("target.many_squares", "{n} dark squares of like size are seen in the picture, not one", n=alike),
            where=name,
            todo=Message("advice.check_kind_or_cover", "check {field}, or cover the others", field=_KIND),
        )


def _side(quad: Array, k: int) -> Side:
    """Which side of the picture edge `k` of a `quad` (4, 2) is on."""
    du, dv = (quad[k] + quad[(k + 1) % 4]) / 2 - quad.mean(axis=0)
    if abs(du) > abs(dv):
        return "right" if du > 0 else "left"
    return "lower" if dv > 0 else "upper"
