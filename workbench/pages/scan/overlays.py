"""What is drawn over a picture of a scan: stripes, crossings, points, coverage."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.image.stripes.centreline import Centreline
from core.model.arrays import Array
from core.pipeline.live.events import PlanesDetail
from core.scan.preview.hints import HintLimits
from core.scan.preview.shown import FramePreview
from workbench.language import text_of, tr
from workbench.views.colours import (
    CORNER,
    COVERED,
    CROSSING_GOOD,
    CROSSING_LEFT_OUT,
    CROSSING_WEAK,
    EXCLUDED,
    KNOWN_PLANE,
    SWEEP,
    fan_colour,
)
from workbench.views.image.view import ImageView

PREVIEW_SIGMA_MM = HintLimits().sigma_mm
"""σ at the end of the scale while a scan runs: beyond it better crossings are asked for."""

LIT = "#FFB000"
"""Cells with light that has given no points yet."""

GAP_PX = 4.0
"""Points farther apart than this are not joined."""

_UNKNOWN = -1
"""Stands in place of a line's number where it is not known."""
_CROSSINGS = ("good", "weak", "left out")


def show_fan(image: ImageView, lines: Sequence[Sequence[Centreline]], *, numbered: bool = True) -> None:
    """Show the fan's centrelines on a picture, in one layer a line; not `numbered`: all in one layer."""
    names = []
    for place, pieces in enumerate(lines, start=1):
        if not pieces:
            continue
        names.append(f"fan {place}")
        title = tr("fan, line {number}", number=place) if numbered else tr("fan")
        image.set_lines(names[-1], [piece.uv for piece in pieces], colour=fan_colour(place), width=1.6, title=title)
    _remove_others(image, "fan ", names)


def show_fan_pieces(image: ImageView, pieces: Sequence[Centreline], line: Sequence[int]) -> None:
    """Show the fan's centrelines on a picture; `line` is each one's fan line from 0, or −1 if not known."""
    count = max(line, default=_UNKNOWN) + 1
    show_fan(image, [[piece for piece, of in zip(pieces, line, strict=True) if of == k] for k in range(count)])
    unknown = [piece.uv for piece, of in zip(pieces, line, strict=True) if of == _UNKNOWN]
    if unknown:
        image.set_lines("fan ?", unknown, colour=EXCLUDED, width=1.4, title=tr("fan, line not known"))


def show_target(image: ImageView, detail: PlanesDetail) -> None:
    """Show the plane target and the stripes on it, each stripe in the colour of its fan line if that is known."""
    if detail.uv is None:
        image.remove_layer("target")
    else:
        image.set_points("target", detail.uv, colour=CORNER.colour, symbol=CORNER.symbol, size=10, title=tr("target"))
    names = []
    for line in sorted(set(detail.line)):
        names.append(f"stripe {line}")
        pieces = [uv for uv, of in zip(detail.stripes, detail.line, strict=True) if of == line]
        colour = EXCLUDED if line == _UNKNOWN else fan_colour(line + 1)
        title = tr("fan, line not known") if line == _UNKNOWN else tr("fan, line {number}", number=line + 1)
        image.set_lines(names[-1], pieces, colour=colour, width=2.0, title=title)
    _remove_others(image, "stripe ", names)


def show_sweep(image: ImageView, pieces: Sequence[Centreline], sigma: Sequence[ArrayLike] = ()) -> None:
    """Show the hand-held laser's centrelines on a picture, coloured by the points' `sigma` if it is given."""
    lines = [piece.uv for piece in pieces]
    if len(sigma) == len(lines):
        title = tr("sweep: σ 0 … {limit:g} mm, else grey", limit=PREVIEW_SIGMA_MM)
        image.set_lines("sweep", lines, values=sigma, limits=(0.0, PREVIEW_SIGMA_MM), width=2.4, title=title)
    else:
        image.set_lines("sweep", lines, colour=SWEEP, width=1.6, title=tr("sweep"))


def show_swept(image: ImageView, pieces: Sequence[Centreline], bounced: Sequence[int]) -> None:
    """Show the centrelines of a measured frame; those numbered in `bounced`, by reflected light, are marked.

    Those `bounced`, by their number, in another colour and marked with ×.
    """
    show_sweep(image, [piece for number, piece in enumerate(pieces) if number not in bounced])
    if bounced:
        mirrored = [pieces[number].uv for number in bounced]
        image.set_lines(
            "second bounces", mirrored, colour=CROSSING_LEFT_OUT.colour, width=1.6, labels=["×"] * len(mirrored),
            title=tr("second bounce, left out"),
        )  # fmt: skip
    else:
        image.remove_layer("second bounces")


def show_crossings(image: ImageView, preview: FramePreview | None) -> None:
    """Show crossings: good as green circles, weak as amber triangles, left out as red crosses; None: none."""
    titles = (tr("crossing, good"), tr("crossing, weak"), tr("crossing, left out"))
    for status, (name, mark, title) in enumerate(
        zip(_CROSSINGS, (CROSSING_GOOD, CROSSING_WEAK, CROSSING_LEFT_OUT), titles, strict=True)
    ):
        if preview is None:
            image.remove_layer(name)
            continue
        chosen = np.flatnonzero(preview.crossing_status == status)
        tips = [text_of(preview.crossing_reason[place]) for place in chosen]
        uv = preview.crossing_uv[chosen]
        image.set_points(name, uv, colour=mark.colour, symbol=mark.symbol, size=11, tips=tips, title=title)


def show_points(
    image: ImageView, uv: NDArray[np.float32] | None, sigma: NDArray[np.float32] | None, limit_mm: float
) -> None:
    """Show the measured points of a frame at pixels `uv` (N, 2), coloured by σ (N,) in mm up to `limit_mm`."""
    if uv is None or sigma is None:
        image.remove_layer("points")
        return
    ends = np.flatnonzero(np.hypot(*np.diff(uv, axis=0).T) > GAP_PX) + 1
    image.set_lines(
        "points", np.split(uv, ends), values=np.split(sigma, ends), limits=(0.0, limit_mm), width=4.0,
        title=tr("points: σ 0 … {limit:g} mm", limit=limit_mm),
    )  # fmt: skip


def show_known_planes(image: ImageView, outlines: Mapping[str, Array]) -> None:
    """Show the known planes, each a closed outline (K, 2) in px with its name; none removes them."""
    if not outlines:
        image.remove_layer("known planes")
        return
    closed = [np.concatenate([outline, outline[:1]]) for outline in outlines.values()]
    image.set_lines("known planes", closed, colour=KNOWN_PLANE, labels=list(outlines), title=tr("known planes"))


def show_coverage(image: ImageView, cells: NDArray[np.bool_], lit: NDArray[np.bool_]) -> None:
    """Show the grid cells that have points, and those that were lit but have none; both (rows, columns)."""
    image.set_cells("covered", cells, COVERED, title=tr("covered with points"))
    image.set_cells("lit", lit & ~cells, LIT, title=tr("lit, no points yet"))


def _remove_others(image: ImageView, start: str, keep: Sequence[str]) -> None:
    for name in image.layer_names():
        if name.startswith(start) and name not in keep:
            image.remove_layer(name)
