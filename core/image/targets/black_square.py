"""The paper's plane target: the corners of a black square, where the lines through its sub-pixel edges meet."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from core.image.targets.dark_squares import DarkSquares, dark_squares, first_corner
from core.image.targets.edges import corner_covariance
from core.image.targets.kinds import BlackSquare
from core.image.targets.picture import Picture, as_8bit, enlarged, reduced
from core.image.targets.quadrilateral import EdgeSearch, Side
from core.image.targets.target_view import TargetNotFound, TargetView
from core.messages import Field, Message
from core.model import Camera

SYSTEMATIC_PX = 0.005
"""What is left on perfect pictures, RMS per coordinate."""

_EDGE_LOST: Mapping[Side, Message] = {
    "left": Message("target.left_edge_lost", "the black square is there, but its left edge cannot be followed"),
    "right": Message("target.right_edge_lost", "the black square is there, but its right edge cannot be followed"),
    "upper": Message("target.upper_edge_lost", "the black square is there, but its upper edge cannot be followed"),
    "lower": Message("target.lower_edge_lost", "the black square is there, but its lower edge cannot be followed"),
}
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
    quad = enlarged(seen.whole[0], factor)
    near = min(4.0 * factor + 4, 0.1 * float(np.linalg.norm(quad[0] - quad[2])))
    found = EdgeSearch(picture, camera, name, _EDGE_LOST).follow(quad, (near, min(6.0, near), min(6.0, near)))
    quad = found.quad
    first = first_corner(quad)
    order = np.roll(np.arange(4), -first)
    covariance = corner_covariance(found.lines)[order][:, :, order].reshape(8, 8)
    covariance = covariance + (SYSTEMATIC_PX**2 + found.clipped_px**2) * np.eye(8)
    sigma = np.sqrt(np.diag(covariance).reshape(4, 2).mean(axis=1))
    return TargetView(square.points, quad[order], sigma, name, covariance)


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
