"""Points of the sweeps on known planes, as rows of the table of crossings: one for each cell of a centreline.

On a plane a sheet of light draws one straight line (with the lens's distortion taken off). So of each frame and plane
those cells are taken that lie on one line, the one that most of them lie on: a part that stands before the board draws
another beside it. What is printed on the board is left out, and a few px at its edges.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

import cv2
import numpy as np
from numpy.typing import NDArray

from core.findings.table import note_of
from core.image.stripes.centreline import Centreline
from core.image.stripes.runs import arc_length
from core.messages import Message, plain
from core.model import Camera
from core.model.arrays import Array
from core.scan.features.crossings import CrossingTable, Index
from core.scan.features.extraction import ScanFeatures
from core.scan.features.straightening import bent_back, straightened
from core.scan.known_planes.known_plane import KnownPlane

FROM_EDGES_PX = 4.0
"""Px from the outline within which nothing is taken, beside three standard deviations of the stripe."""
LEAST_COVERED_PX = 6.0
"""Px of a cell that have to lie on the plane: between the marks of a board there are no more."""
OFF_LINE_PX = 1.0
"""Px beside the common line, and five standard uncertainties, beyond which a cell lies on something else."""
LEAST_CELLS = 2
"""Cells of a frame on a plane, at least: with one the line has no direction."""
ON_PLANE_MM = 1.0
"""Distance in mm from a known plane within which a point of the surface is one of its board."""
BESIDE = 1.5
"""Stripe σ about a point within which the board has to be free of print as well: the brightness edge of a mark would
pull it."""


@dataclass(frozen=True, eq=False, slots=True)
class PlaneAgreement:
    """Agreement of the sweeps' points on a known plane with it.

    Parameters
    ----------
    name
        The board's.
    points, frames
        How many points count, and of how many frames.
    left_out
        How many do not, as they disagree.
    rms_mm
        Of their depths from the plane's.
    pi, outline
        The plane τ (3,) in 1/mm, and where it is seen, (K, 2) in px.
    """

    name: str
    points: int
    frames: int
    left_out: int
    rms_mm: float
    pi: Array
    outline: Array


def lying_on(points: Array, uv: Array, planes: Sequence[PlaneAgreement]) -> NDArray[np.bool_]:
    """Flag those `points` (N, 3) in mm, seen at `uv` (N, 2), that lie on one of the known planes."""
    flags = np.zeros(len(points), dtype=np.bool_)
    for plane in planes:
        near = np.abs(points @ plane.pi - 1) < ON_PLANE_MM * np.linalg.norm(plane.pi)
        outline = plane.outline.astype(np.float32)
        within = [cv2.pointPolygonTest(outline, one, False) >= 0 for one in uv[near].tolist()]
        flags[near] |= np.array(within, dtype=np.bool_)
    return flags


@dataclass(frozen=True, slots=True)
class _Cell:
    """Mean of a centreline's points in one cell on a plane, in px freed of distortion; `sigma` in px across it."""

    plane: int
    frame: int
    piece: int
    number: int
    along: float
    u: float
    v: float
    normal: tuple[float, float]
    sigma: float


def note_on_planes_alone(fits: Sequence[PlaneAgreement]) -> Message:
    """Make a note that a scan was measured by known planes alone, with how well the sweeps' points agree with them."""
    points = sum(fit.points for fit in fits)
    mm = np.sqrt(sum(fit.points * fit.rms_mm**2 for fit in fits) / max(points, 1))
    return note_of("scan.planes_alone", boards=tuple(plain(fit.name) for fit in fits), points=points, mm=float(mm))


def points_on_planes(
    features: ScanFeatures, planes: Sequence[KnownPlane], camera: Camera
) -> tuple[CrossingTable, Index]:
    """Collect the sweeps' points on the known `planes` as P rows of a table of crossings, and the plane (P,) of each.

    `camera` takes the distortion off.
    """
    cell_px, width = features.crossings.half_length_px, features.crossings.share_b.shape[1]
    seen = SeenBoards(planes, features.image_size, camera)
    return seen.points([(frame.index, frame.centrelines) for frame in features.frames], cell_px, width)


class SeenBoards:
    """Boards of known planes as `camera` sees them, in pictures of `image_size` (width, height)."""

    def __init__(self, planes: Sequence[KnownPlane], image_size: tuple[int, int], camera: Camera) -> None:
        self._faces, self._camera = [_Face.of(plane, image_size) for plane in planes], camera

    def points(
        self, frames: Sequence[tuple[int, Sequence[Centreline]]], cell_px: float, width: int
    ) -> tuple[CrossingTable, Index]:
        """Collect the points of `frames`, each an index with its centrelines, as `points_on_planes` does.

        Cells are `cell_px` long, and rows have shares `width` wide.
        """
        cells = [
            cell
            for frame, lines in frames
            for piece, line in enumerate(lines)
            for plane, face in enumerate(self._faces)
            for cell in _cells(plane, frame, piece, line, face, self._camera, cell_px)
        ]
        cells.sort(key=lambda cell: (cell.plane, cell.frame, cell.piece, cell.number))
        kept: list[tuple[_Cell, Array]] = []
        for _, group in groupby(cells, key=lambda cell: (cell.plane, cell.frame)):
            kept.extend(_on_one_line(list(group)))
        plane = np.array([cell.plane for cell, _ in kept], dtype=np.int64)
        return bent_back(_table(kept, cell_px, width), self._camera), plane


def frames_across(features: ScanFeatures, planes: Sequence[KnownPlane]) -> int:
    """Count the frames whose light lies on a board, be it on print or on plain board, over a cell at least."""
    faces, cell_px = [_Face.of(plane, features.image_size) for plane in planes], features.crossings.half_length_px
    return sum(
        any(np.count_nonzero(_at(face.inside, line.uv)) >= cell_px for line in frame.centrelines for face in faces)
        for frame in features.frames
    )


@dataclass(frozen=True, eq=False, slots=True)
class _Face:
    """Where a board is seen: `inside` its outline (H, W), and what is `plain` on it, without print."""

    inside: NDArray[np.bool_]
    plain: NDArray[np.bool_]

    @classmethod
    def of(cls, plane: KnownPlane, image_size: tuple[int, int]) -> _Face:
        filled = np.zeros(image_size[::-1], dtype=np.uint8)
        cv2.fillPoly(filled, [np.rint(plane.outline).astype(np.int32)], 1)
        inside = filled > 0
        return cls(inside, inside if plane.marks is None else inside & ~plane.marks)

    def carries(self, line: Centreline) -> NDArray[np.bool_]:
        """Flag the points (N,) of a centreline that lie on plain board, clear of its edges and of print."""
        on = _at(self.plain, line.uv) & ~line.saturated
        if not on.any():
            return on
        width, ways = line.width[:, None], (line.normal, line.tangent, -line.normal, -line.tangent)
        for way in ways:
            on &= _at(self.inside, line.uv + (FROM_EDGES_PX + 3 * width) * way)
            on &= _at(self.plain, line.uv + BESIDE * width * way)
        return on


def _cells(
    plane: int,
    frame: int,
    piece: int,
    line: Centreline,
    face: _Face,
    camera: Camera,
    cell_px: float,
) -> list[_Cell]:
    """The cells of one centreline that lie on one plane."""
    if len(line) < 2:
        return []
    on = face.carries(line)
    if not on.any():
        return []
    straight = straightened((line,), camera)[0]
    arc = arc_length(straight.uv)
    number = np.floor(arc / cell_px).astype(np.int64)
    step = np.gradient(arc)
    found = []
    for k in np.unique(number[on]):
        mine = on & (number == k)
        covered = float(step[mine].sum())
        if covered < LEAST_COVERED_PX:
            continue
        u, v = straight.uv[mine].mean(axis=0)
        sigma = float(np.median(straight.sigma[mine])) * np.sqrt(straight.correlation_px / covered)
        across = straight.normal[mine].mean(axis=0)
        n = (float(across[0]), float(across[1]))
        found.append(_Cell(plane, frame, piece, int(k), float(arc[mine].mean()), float(u), float(v), n, sigma))
    return found


def _on_one_line(cells: list[_Cell]) -> list[tuple[_Cell, Array]]:
    """Those cells that lie on the line that most of them lie on, and its unit tangent (2,) the way each runs."""
    if len(cells) < LEAST_CELLS:
        return []
    uv, sigma = np.array([(c.u, c.v) for c in cells]), np.array([c.sigma for c in cells])
    first, second = np.triu_indices(len(cells), 1)
    way = uv[second] - uv[first]
    length = np.linalg.norm(way, axis=1)
    normal = np.column_stack([way[:, 1], -way[:, 0]]) / np.maximum(length, 1e-9)[:, None]
    off = np.abs(np.einsum("pi,pci->pc", normal, uv[None] - uv[first][:, None]))
    close = off < OFF_LINE_PX + 5 * sigma
    best = int(np.argmax(close.sum(axis=1) - 1e-6 * np.where(close, off, 0.0).sum(axis=1) + 1e-9 * length))
    mine = np.flatnonzero(close[best])
    if len(mine) < LEAST_CELLS:
        return []
    weight = 1 / sigma[mine] ** 2
    middle = np.average(uv[mine], axis=0, weights=weight)
    spread = (uv[mine] - middle) * np.sqrt(weight)[:, None]
    tangent = np.linalg.svd(spread, full_matrices=False)[2][0]
    kept = []
    for k in mine:
        sign = np.sign(-cells[k].normal[1] * tangent[0] + cells[k].normal[0] * tangent[1]) or 1.0
        kept.append((cells[k], sign * tangent))
    return kept


def _table(rows: Sequence[tuple[_Cell, Array]], cell_px: float, width: int) -> CrossingTable:
    """The cells as rows, with shares `width` wide, the first of them that of the cell itself."""
    count, cells = len(rows), [cell for cell, _ in rows]
    tangent = np.array([way for _, way in rows]).reshape(-1, 2)
    sigma, none = np.array([cell.sigma for cell in cells]), np.zeros(count, dtype=np.int64)
    share = np.zeros((count, width))
    share[:, :1] = sigma[:, None]
    number = np.array([cell.number for cell in cells], dtype=np.int64)
    return CrossingTable(
        uv=np.array([(cell.u, cell.v) for cell in cells]).reshape(-1, 2),
        tangent_a=tangent,
        tangent_b=np.column_stack([tangent[:, 1], -tangent[:, 0]]),
        sigma_a=sigma,
        sigma_b=np.zeros(count),
        a=np.array([cell.frame for cell in cells], dtype=np.int64),
        b=none - 1,
        piece_a=np.array([cell.piece for cell in cells], dtype=np.int64),
        piece_b=none - 1,
        along_a=np.array([cell.along for cell in cells]),
        along_b=np.zeros(count),
        half_length_px=cell_px,
        cell_a=number,
        cell_b=none,
        share_a=share,
        share_b=np.zeros((count, width)),
    )


def _at(flags: NDArray[np.bool_], uv: Array) -> NDArray[np.bool_]:
    """What the pixels nearest to `uv` (N, 2) hold; those beyond the border what is there."""
    u, v = (np.rint(uv[:, axis]).astype(np.intp).clip(0, flags.shape[1 - axis] - 1) for axis in range(2))
    return np.asarray(flags[v, u], dtype=np.bool_)
