"""A printed rectangle, dark throughout or an outline: its corners, where the lines through its sub-pixel edges meet."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from core.image.targets.dark_squares import DarkSquares, clockwise, dark_squares
from core.image.targets.edges import Line, corner_covariance
from core.image.targets.kinds import Rectangle
from core.image.targets.picture import Picture, as_8bit, enlarged, reduced
from core.image.targets.pose import LIKELIHOOD_STEP, estimate_pose, homography_of, map_by
from core.image.targets.quadrilateral import Edges, EdgeSearch, Side, corners_of
from core.image.targets.target_view import TargetNotFound, TargetView
from core.messages import Message
from core.model import Camera
from core.model.arrays import Array

SYSTEMATIC_PX = 0.005
"""What is left on perfect pictures, RMS per coordinate, over the unit of sampling: finer ones see the pixels' phase."""
LINE_UNITS = 9.0
"""Width of an outline in units of the sampling: thinner ones are sampled more finely, so that the edges stay apart."""
FINEST_UNIT = 0.25
"""Px, of the sampling."""
THINNEST_PX = 1.5
"""Width of an outline below which its two edges are not told apart: they would be off by more than is stated."""
THINNER = 0.6
"""Width of an outline's thinnest side over its mean, as perspective has it."""
NEAR_PX = 6.0
"""How far to either side of an edge the last rounds look."""
ROUGH_PX = 3.0
"""Corners of the rough search are this near, in px of the reduced picture."""
MISFIT_PX = 0.5
"""Largest misfit of an outline's corners beyond their uncertainty: lens distortion, lines drawn not quite as wide."""
GAUSSIAN_TO = 0.3
"""Share of how far an outline's edges reach across it that blur may differ in from a Gaussian one."""
_ROUNDS = 40
"""Of a fixed point: the last ones move it by less than 1e-6."""
GIVEN_WITHIN = 0.1
"""Corners that are given are this near to the true ones, as a share of the rectangle's diagonal in the picture."""

_EDGE_LOST: Mapping[Side, Message] = {
    "left": Message("target.rectangle_left_lost", "the rectangle is there, but its left edge cannot be followed"),
    "right": Message("target.rectangle_right_lost", "the rectangle is there, but its right edge cannot be followed"),
    "upper": Message("target.rectangle_upper_lost", "the rectangle is there, but its upper edge cannot be followed"),
    "lower": Message("target.rectangle_lower_lost", "the rectangle is there, but its lower edge cannot be followed"),
}
_SAY_WHERE = Message("advice.say_where", "say in its table where it is: region_px, or corners_px")


def detect_rectangle(
    rectangle: Rectangle, picture: Picture, name: str = "", camera: Camera | None = None
) -> TargetView:
    """Find the corners of `rectangle` in `picture` (H, W), in the order of `rectangle.points`, with covariance.

    Straight lines are fitted to its edges as to those of a black square, in undistorted rays if there is a `camera`; of
    an outline to its outer and its inner edges. An outline that is thin beside its blur looks wider than it is: its
    outer corners lie too far out and its inner ones too far in, by as much, and the covariance says so.

    Which of its sides is the width is told by the given corners, else by the `camera`: the better of both poses; else
    by the sides' lengths in the picture.

    Raises
    ------
    TargetNotFound
        If there is no such rectangle, several of like size, one cut off by the picture's border, one whose edges cannot
        be followed, or one whose width may be either side.
    """
    search = EdgeSearch(picture, camera, name, _EDGE_LOST)
    outer = _outer_edges(rectangle, search)
    outer = _from_corner(outer, outer.quad[_first(rectangle, outer, camera, name)])
    if not rectangle.line_mm:
        return _view(rectangle, [outer], name)
    seen = homography_of(rectangle.points[:4, :2], search.to_flat(outer.quad))
    assert seen is not None, "four corners of a quadrilateral that has an area"
    inner = search.to_pixels(map_by(seen, rectangle.points[4:, :2]))
    line_px = _line_px(outer.quad, inner)
    if line_px < THINNEST_PX:
        raise TargetNotFound(
            Message(
                "target.outline_too_thin", "the rectangle's outline is {px:.1f} px wide in the picture", px=line_px
            ),
            where=name,
            todo=Message("advice.wider_outline", "draw it wider, or go nearer: it must be {px:g} px", px=THINNEST_PX),
        )
    unit, near = _sampling(line_px)
    rims = [
        search.follow(quad, (near, near), inwards=quad is inner, unit=unit, thin=True) for quad in (outer.quad, inner)
    ]
    view = _view(rectangle, rims, name)
    _check_line(view, search)
    return view


def _check_line(view: TargetView, search: EdgeSearch) -> None:
    """Raise TargetNotFound unless all corners fit one rectangle outlined as stated, seen in perspective."""
    seen = search.to_flat(view.uv)
    homography = homography_of(view.points[:, :2], seen)
    off = np.inf if homography is None else np.abs(map_by(homography, view.points[:, :2]) - seen)
    if not np.all(off < MISFIT_PX + 4 * view.sigma[:, None]):
        raise TargetNotFound(
            Message(
                "target.outline_differs", "inner and outer edges of the rectangle do not fit its size_mm and line_mm"
            ),
            where=view.name,
            todo=Message("advice.check_line", "check both, and that no laser line runs along an edge"),
        )


def _outer_edges(rectangle: Rectangle, search: EdgeSearch) -> Edges:
    """The edges against the light around it, first as a reduced picture shows them, then in the whole one."""
    small, factor = reduced(as_8bit(search.picture), 900)
    line = rectangle.line_mm / np.sqrt(rectangle.width_mm * rectangle.height_mm)
    seen = dark_squares(small, line)
    given = rectangle.corners_px
    quad = _only(rectangle, seen, search.name) if given is None else _nearest(np.array(given), seen, factor)
    if rectangle.line_mm:
        at_first = replace(search, picture=small, camera=None)
        try:
            quad = _roughly(quad, at_first, line)
        except TargetNotFound:  # edges that the lens bends by more than their light reaches
            if search.camera is None:
                raise
            quad = _roughly(quad, replace(at_first, camera=search.camera.scaled(1 / factor)), line)
        quad = enlarged(quad, factor)
        unit, near = _sampling(THINNER * line * np.sqrt(_area(quad)))
        return search.follow(quad, (near, near), unit=unit, thin=True)
    quad = enlarged(quad, factor)
    near = GIVEN_WITHIN * _diagonal(quad) if given else min(4.0 * factor + 4, 0.1 * _diagonal(quad))
    return search.follow(quad, (near, min(NEAR_PX, near), min(NEAR_PX, near)))


def _roughly(quad: Array, search: EdgeSearch, line: float) -> Array:
    """The quadrilateral (4, 2) by its edges in a reduced picture; `line` is the line's width over its size."""
    unit, near = _sampling(THINNER * line * np.sqrt(_area(quad)))
    quad = search.follow(quad, (max(near, ROUGH_PX),), unit=unit, thin=True).quad
    return search.follow(quad, (near, near), unit=unit, thin=True).quad


def _nearest(given: Array, seen: DarkSquares, factor: int) -> Array:
    """Of what is seen in the reduced picture, what has the corners `given` (4, 2) in px of the whole; else these."""
    quad = clockwise((given + 0.5) / factor - 0.5)
    off = [float(np.linalg.norm(clockwise(one) - quad, axis=1).max()) for one in seen.whole]
    best = int(np.argmin(off)) if off else -1
    return seen.whole[best] if off and off[best] < GIVEN_WITHIN * _diagonal(quad) else quad


def _sampling(line_px: float) -> tuple[float, float]:
    """Unit of sampling for an outline of some width in px, and how far to look to either side: not across it."""
    unit = float(np.clip(line_px / LINE_UNITS, FINEST_UNIT, 1.0))
    return unit, min(NEAR_PX, max(0.4 * line_px, 2 * unit))


def _line_px(outer: Array, inner: Array) -> float:
    """Width in px of the thinnest end of a side of an outline between corners `outer` and `inner` (4, 2)."""
    along = np.roll(outer, -1, axis=0) - outer
    normal = np.column_stack([-along[:, 1], along[:, 0]]) / np.linalg.norm(along, axis=1, keepdims=True)
    ends = np.stack([inner, np.roll(inner, -1, axis=0)], axis=1) - outer[:, None]
    return float(np.einsum("kei,ki->ke", ends, normal).min())


def _area(quad: Array) -> float:
    u, v = quad.T
    return float(abs(u @ np.roll(v, -1) - v @ np.roll(u, -1)) / 2)


def _diagonal(quad: Array) -> float:
    return float(np.linalg.norm(quad[0] - quad[2]))


def _first(rectangle: Rectangle, outer: Edges, camera: Camera | None, name: str) -> int:
    """Which corner of the quadrilateral is the rectangle's first: the width goes from it clockwise to the next."""
    start = _width_begins(rectangle, outer, camera, name)
    return min((start, (start + 2) % 4), key=lambda k: float(outer.quad[k].sum()))


def _width_begins(rectangle: Rectangle, outer: Edges, camera: Camera | None, name: str) -> int:
    """0 or 1: a corner from which the width goes clockwise to the next."""
    quad = outer.quad
    if rectangle.corners_px is not None:
        ends = [int(np.argmin(np.linalg.norm(quad - corner, axis=1))) for corner in rectangle.corners_px[:2]]
        return (min(ends) if abs(ends[0] - ends[1]) == 1 else 3) % 2
    if rectangle.width_mm == rectangle.height_mm:
        return 0
    if camera is None:
        sides = np.linalg.norm(np.roll(quad, -1, axis=0) - quad, axis=1)
        first_is_longer = sides[0] + sides[2] >= sides[1] + sides[3]
        return 0 if first_is_longer == (rectangle.width_mm > rectangle.height_mm) else 1
    misfit = [_misfit(rectangle, _from_corner(outer, quad[start]), camera, name) for start in (0, 1)]
    if abs(misfit[0] - misfit[1]) < LIKELIHOOD_STEP:
        raise TargetNotFound(
            Message("target.rectangle_turned", "the rectangle is seen, but not which of its sides is the width"),
            where=name,
            todo=Message("advice.corners_along_width", "state its corners_px, the first two along its width"),
        )
    return int(np.argmin(misfit))


def _misfit(rectangle: Rectangle, outer: Edges, camera: Camera, name: str) -> float:
    """χ² of the best pose of its outer corners; ∞ if there is none before the camera."""
    try:
        view = _view(replace(rectangle, line_mm=0.0), [outer], name)
        estimate = estimate_pose(view, camera)
    except TargetNotFound:
        return np.inf
    return float((view.whitened(estimate.residuals) ** 2).sum())


def _from_corner(edges: Edges, corner: Array) -> Edges:
    """The same edges, beginning at the corner that is `corner` (2,)."""
    first = int(np.argmin(np.linalg.norm(edges.quad - corner, axis=1)))
    lines = (*edges.lines[first:], *edges.lines[:first])
    return replace(edges, quad=np.roll(edges.quad, -first, axis=0), lines=lines, blur_px=np.roll(edges.blur_px, -first))


def _view(rectangle: Rectangle, found: Sequence[Edges], name: str) -> TargetView:
    """The corners of one or both rims, and their covariance."""
    size = 8 * len(found)
    covariance = np.zeros((size, size))
    for rim, edges in enumerate(found):
        own = slice(8 * rim, 8 * rim + 8)
        systematic = (SYSTEMATIC_PX / edges.unit) ** 2 + edges.clipped_px**2
        covariance[own, own] = corner_covariance(edges.lines).reshape(8, 8) + systematic * np.eye(8)
    if len(found) > 1:
        spread = _spread_apart(*found)
        covariance += np.outer(spread, spread) + GAUSSIAN_TO**2 * np.diag(spread**2)
    sigma = np.sqrt(np.diag(covariance).reshape(-1, 2).mean(axis=1))
    return TargetView(rectangle.points, np.concatenate([edges.quad for edges in found]), sigma, name, covariance)


def _spread_apart(outer: Edges, inner: Edges) -> Array:
    """How far too far out and in (16,) in px corners of an outline may lie, as its edges' blur reaches across it."""
    moved = []
    for edges, way in ((outer, 1.0), (inner, -1.0)):
        flat_middle = np.mean([line.middle for line in edges.lines], axis=0)
        lines = [
            _moved_out(line, flat_middle, way * blur_reach(_distance(other, line), blur))
            for line, other, blur in zip(edges.lines, (inner if way > 0 else outer).lines, edges.blur_px, strict=True)
        ]
        moved.append(corners_of(lines) - corners_of(edges.lines))
    return np.concatenate(moved).ravel()


def _distance(line: Line, other: Line) -> float:
    return abs(float((line.middle - other.middle) @ other.normal))


def _moved_out(line: Line, middle: Array, by: float) -> Line:
    outwards = np.sign((line.middle - middle) @ line.normal)
    return replace(line, middle=line.middle + by * outwards * line.normal)


def blur_reach(apart: float, seen_blur: float) -> float:
    """Compute how far beyond a line's edge its slope is steepest, as that of its other edge weakens it there.

    A line of width w seen with a Gaussian blur of σ = 1 has the slope φ(d) − φ(d + w) at d beyond its edge, steepest
    where d φ(d) = (d + w) φ(d + w). Seen are how far `apart` the steepest places are, w + 2 d, and the line's depth
    over that slope as the `seen_blur` of a lone edge; both in px, as the result.
    """
    blur = seen_blur
    for _ in range(_ROUNDS):
        d = 0.0
        for _ in range(_ROUNDS):
            w = max(apart / blur - 2 * d, 1e-3)
            d = (d + w) * math.exp(-w * (2 * d + w) / 2)
        depth = math.erf(w / math.sqrt(8))
        steepest = math.exp(-d * d / 2) - math.exp(-((d + w) ** 2) / 2)
        blur = (blur * seen_blur * steepest / depth) ** 0.5 if depth and steepest else blur
    return d * blur


def _only(rectangle: Rectangle, seen: DarkSquares, name: str) -> Array:
    """The one quadrilateral seen; TargetNotFound if there is none, or several that might be meant."""
    if not seen.whole:
        if seen.cut_off:
            raise TargetNotFound(
                Message("target.rectangle_cut_off", "only a part of the rectangle is in the picture"),
                where=name,
                todo=Message("advice.show_whole_rectangle", "show all of it, with light paper all round"),
            )
        what = (
            Message("target.no_outline", "no rectangle outlined in dark on a light ground is seen in the picture")
            if rectangle.line_mm
            else Message("target.no_rectangle", "no dark rectangle on a light ground is seen in the picture")
        )
        raise TargetNotFound(
            what,
            where=name,
            todo=Message("advice.line_or_corners", "check line_mm, or say in its table where it is: corners_px"),
        )
    areas = [_area(quad) for quad in seen.whole]
    alike = sum(area > 0.5 * areas[0] for area in areas)
    if alike > 1:
        raise TargetNotFound(
            Message("target.many_rectangles", "{n} rectangles of like size are seen in the picture, not one", n=alike),
            where=name,
            todo=_SAY_WHERE,
        )
    return seen.whole[0]
