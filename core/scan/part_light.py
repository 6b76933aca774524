"""Whether stripes are wider on a part than on the table, which light that comes from below its surface makes them.

A section of width w, in px, is that of the sheet, as the camera sees it where it meets the surface, and that of lens
and pixels: w² = S g² + B(z), with S the square of the sheet's σ in mm, g the px that a mm across the sheet is seen as
(`core.scan.footprint`), and B the blur, which follows the depth z as the lens is focused. The poses of the fan's
calibration, a plate at known places, tell B and how it changes with z; what of it they do not tell counts in the end.
The stripe of each frame is met by table and part, so S is that of its own table.

Light from below the surface, seen t mm behind it, is as light t z⁻¹/|π| mm beside the sheet. So a section on the part
has Δ·(g/(z|π|))² more, with Δ the variance of the depths from which light comes, in mm². That of light a share f of
which comes evenly from 0 to D is D² (f/3 − f²/4), its mean f D/2; falling exponentially, τ² (2f − f²) and f τ. So the
mean is at most 0.8 √Δ, unless most of the light comes evenly from below, as it is of the cube root of the third
cumulant (`core.inspect.uncertainty.skewed_light`).

The scatter of the frames tells how sure that is. A laser that is out of focus on the part, a glossy one whose lobe
narrows or widens stripes, and a slant that is not known to the end change widths as well: less than LEAST_WIDER says
nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from core.image.stripes.centreline import Centreline
from core.model import Camera, Fan, Pose
from core.model.arrays import Array
from core.model.robust import mad_sd, median
from core.scan.footprint import footprint
from core.scan.network.datum import main_plane
from core.scan.surface.cloud import Cloud

SURELY = 4.0
"""Standard errors from which on stripes on the part are surely wider."""
LEAST_WIDER = 0.03
"""Share from which on they count as wider."""
MEAN_OF_SPREAD = 0.8
"""Mean depth of the light over the standard deviation of its depths, at most; see above."""
ON_PART_MM = 3.0
"""Depth between table and part from which on a point is on the other."""
LEAST_FACE = 0.1
"""Share of the points that lie on the part, or on the table behind it, at least."""
LEAST_INVERSE_DEPTH = 1e-6
"""In 1/mm: what is farther is nowhere."""
FEWEST_POINTS, FEWEST_FRAMES = 15, 8
"""Points of a stripe on table and on part, each, at least; and frames that have so many, or their scatter tells
nothing."""
ENOUGH_POINTS = 20_000
"""Points that tell where table and part lie; of more, evenly thinned out, as many to twice as many are looked at."""
_ROUNDS, _LEAST_OFF_PX2 = 10, 1e-9
"""Of reweighting, and least deviation that a weight is judged by."""
_FEWEST_ROWS = 8
"""Stripes on plates from which on the calibration tells the lens's blur."""
_MEDIAN_ERROR = 1.2533
"""Standard error of a median over that of a mean."""


@dataclass(frozen=True, eq=False, slots=True)
class PartLight:
    """Width of the laser stripes on a part against their width on the table.

    Parameters
    ----------
    wider, error
        Share by which they are wider than distance, slant and focus make them, and its standard error.
    behind_mm
        How far behind the surface their light comes from at most, on the mean, in mm of depth; 0 where they are not
        surely wider.
    table
        (3,) plane of the table, in inverse-depth form.
    """

    wider: float
    error: float
    behind_mm: float
    table: Array

    @property
    def surely(self) -> bool:
        """Whether the stripes are surely wider on the part than distance, slant and focus would make them."""
        return self.wider > max(SURELY * self.error, LEAST_WIDER)


class Blur(NamedTuple):
    """Square of the lens's blur in px² at the depth `depth_mm`, and its change per mm of depth."""

    square: float
    per_mm: float
    depth_mm: float

    def at(self, depth: Array) -> Array:
        """Compute the squared blur (N,) in px² at depths (N,) in mm; never below 0."""
        return np.maximum(self.square + self.per_mm * (depth - self.depth_mm), 0.0)


def blur_of(plates: Iterable[tuple[Pose, Sequence[Centreline]]], camera: Camera, fan: Fan) -> Blur | None:
    """Estimate the lens's blur from the stripes on a calibration's plates, each with its pose; None for too few."""
    rows = []
    for pose, stripes in plates:
        normal = pose.rotation[:, 2]
        plate = normal / (normal @ pose.translation)
        for line in stripes:
            seen = line.select(~line.saturated)
            if len(seen) < FEWEST_POINTS:
                continue
            inverse_depth = camera.rays(seen.uv) @ plate
            off = [median(np.abs(camera.rays(seen.uv) @ pi / inverse_depth - 1)) for pi in fan.pis]
            spread = footprint(seen.uv, fan.pis[int(np.argmin(off))], plate, camera) ** 2
            known = np.isfinite(spread)
            if known.sum() >= FEWEST_POINTS:
                depth = 1 / inverse_depth[known]
                rows.append((median(seen.width[known] ** 2), median(spread[known]), median(depth)))
    if len(rows) < _FEWEST_ROWS:
        return None
    square, spread, depth = np.array(rows).T
    middle = float(np.mean(depth))
    design = np.column_stack([spread, np.ones(len(rows)), depth - middle])
    weight = np.ones(len(rows))
    for _ in range(_ROUNDS):
        found = np.linalg.lstsq(design * weight[:, None], square * weight, rcond=None)[0]
        off_px = np.abs(square - design @ found)
        weight = 1 / np.sqrt(1 + (off_px / max(_LEAST_OFF_PX2, 2 * float(np.median(off_px)))) ** 2)
    return Blur(float(np.clip(found[1], 0.0, square.min())), float(found[2]), middle)


def light_on_part(
    stripes: Iterable[tuple[Sequence[Centreline], Array]], cloud: Cloud, camera: Camera, blur: Blur | None
) -> PartLight | None:
    """Compare the width of laser stripes on the part with that on the table; None where too few frames show both.

    Parameters
    ----------
    stripes
        Of each frame the pieces of its stripe, and the sheet π (3,) they lie on.
    cloud
        The points of the scan: most of them, or those on the farthest plane, are the table's.
    camera
        That took the frames.
    blur
        Of its lens; None: not known, and as small as it may be.
    """
    some = slice(None, None, max(1, len(cloud) // ENOUGH_POINTS))
    faces = _faces(camera.rays(cloud.uv[some]), 1 / cloud.points[some, 2])
    if faces is None:
        return None
    table, top = faces
    found = []
    for pieces, sheet in stripes:
        seen = [piece.select(~piece.saturated) for piece in pieces if not piece.saturated.all()]
        if not seen:
            continue
        uv, square = np.vstack([piece.uv for piece in seen]), np.concatenate([piece.width for piece in seen]) ** 2
        inverse_depth = camera.rays(uv) @ sheet
        there, here = footprint(uv, sheet, table, camera), footprint(uv, sheet, top, camera)
        on_table, on_part = np.isfinite(there), np.isfinite(here)
        if min(on_table.sum(), on_part.sum()) < FEWEST_POINTS:
            continue
        per_mm, depth = np.where(on_table, there, here), 1 / inverse_depth
        of_blur = np.zeros(len(depth)) if blur is None else blur.at(depth)
        sheet_square = max(float(np.median(((square - of_blur) / per_mm**2)[on_table])), 0.0)
        expected = sheet_square * per_mm**2 + of_blur
        per_depth = per_mm * inverse_depth / np.linalg.norm(sheet)
        ratio = float(np.median((square / expected)[on_part]))
        more = float(np.median(((square - expected) / per_depth**2)[on_part]))
        found.append((np.sqrt(ratio) - 1, more))
    if len(found) < FEWEST_FRAMES:
        return None
    wider, more = np.array(found).T
    error = _MEDIAN_ERROR * mad_sd(wider - np.median(wider)) / np.sqrt(len(wider))
    behind = MEAN_OF_SPREAD * float(np.sqrt(max(np.median(more), 0.0)))
    light = PartLight(float(np.median(wider)), float(error), behind, table)
    return light if light.surely else replace(light, behind_mm=0.0)


def _faces(rays: Array, inverse_depths: Array) -> tuple[Array, Array] | None:
    """The plane of the table and that of most points before it, at `inverse_depths` (N,) on `rays` (N, 3).

    None where there are no two. Most points may be on the part: the table is what lies behind.
    """
    first, _ = main_plane(rays, inverse_depths)
    before = 1 / np.maximum(rays @ first, LEAST_INVERSE_DEPTH) - 1 / inverse_depths
    for side, is_table in ((before < -ON_PART_MM, True), (before > ON_PART_MM, False)):
        if side.mean() > LEAST_FACE:
            second, _ = main_plane(rays[side], inverse_depths[side])
            return (second, first) if is_table else (first, second)
    return None
