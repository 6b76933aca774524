"""Correction of a scan for a surface that bends: it is solved a second time with its stripes moved.

On such a surface all stripes lie a little beside their light planes (`core.scan.surface.sections`), the same way, so no
mean removes it: a ball comes out too small. How far they lie is known once a first solution has given the surface.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from core.image.stripes.centreline import Centreline
from core.image.stripes.runs import arc_length
from core.model import Camera, Fan
from core.model.arrays import Array
from core.model.robust import median
from core.progress import Progress, silent
from core.scan.features.bent_crossings import BentLine, crossed_again
from core.scan.features.extraction import ScanFeatures
from core.scan.features.straightening import straightened
from core.scan.known_planes.known_plane import KnownPlane
from core.scan.method import Method, ReconstructOptions
from core.scan.reconstruct import reconstruct
from core.scan.results import ScanResult
from core.scan.surface.bends import Bends, bends_of
from core.scan.surface.sections import Stripe, estimate_light, toward_light
from core.scan.sweeps.fan_lines import UNASSIGNED

# When a scan is solved twice. So that a ball comes out true and a flat part stays as it is:
# tests/scan/test_bend_correction.py holds them.
LEAST_OFFSET_PX = 1e-3
"""Points that would move by less do not count: a tenth of the floor of a centreline's σ."""
LEAST_MOVED_SHARE = 0.003
"""Where no larger share of the points would move, all stay: edges, not a bend."""
OFFSET_UNCERTAINTY = 0.25
"""Standard uncertainty of an offset as a share of it: the law, the bend and the light's direction may be wrong."""


Offsets = dict[tuple[int, int], Array]
"""Offsets (N,) in px along the normals of a centreline, given by its frame (−1: the fan) and piece."""


def reconstruct_twice(
    features: ScanFeatures,
    camera: Camera,
    fan: Fan,
    options: ReconstructOptions | None = None,
    progress: Progress = silent,
    planes: Sequence[KnownPlane] = (),
) -> tuple[ScanFeatures, ScanResult]:
    """Solve the scan and, if its surface bends, again with corrected features; return those last used and the result.

    The network ties the sweeps to known `planes` as well. By the paper's method it is solved once, as the paper does.

    Raises
    ------
    InputError
        As `core.scan.reconstruct.reconstruct`.
    """
    first = reconstruct(features, camera, fan, options, progress, planes=planes)
    if options is not None and options.method != Method.NETWORK:
        return features, first
    corrected = corrected_for_bends(features, first, camera, fan)
    if corrected is features:
        return features, first
    return corrected, reconstruct(corrected, camera, fan, options, progress, first.fan_lines, planes)


def corrected_for_bends(features: ScanFeatures, scan: ScanResult, camera: Camera, fan: Fan) -> ScanFeatures:
    """Move centrelines and crossings in the pictures to where the light planes cut the surface found by `scan`.

    Returns `features` themselves where the surface has no bend that matters.
    """
    bends = bends_of(scan.cloud, features.image_size)
    if bends.flat:
        return features
    stripes = list(_stripes(features, scan, camera, fan, bends))
    fan_light, sweep_light, blur = estimate_light(stripes)
    of_sheet: dict[int, list[Stripe]] = {}
    for stripe in stripes:
        of_sheet.setdefault(stripe.sheet, []).append(stripe)
    offsets: Offsets = {}
    for mine in of_sheet.values():
        light = fan_light if mine[0].frame < 0 else sweep_light
        toward = toward_light(mine, light, blur)
        offsets |= {(stripe.frame, stripe.piece): stripe.offsets(light, blur, toward) for stripe in mine}
    moved = np.concatenate([np.zeros(0), *offsets.values()])
    if np.count_nonzero(np.abs(moved) > LEAST_OFFSET_PX) <= LEAST_MOVED_SHARE * len(moved):
        return features
    return _moved(features, stripes, offsets, camera)


def _stripes(features: ScanFeatures, scan: ScanResult, camera: Camera, fan: Fan, bends: Bends) -> Iterator[Stripe]:
    """Every centreline whose light plane is known; the fan's sheets are −1 − line."""
    for piece, (line, number) in enumerate(zip(features.fan, scan.fan_lines.line, strict=True)):
        if number != UNASSIGNED and len(line):
            yield Stripe.of(-1 - number, -1, piece, line, fan.planes[number].pi, camera, bends)
    for numbers, frame in zip(scan.pis, scan.sweep_frames.tolist(), strict=True):
        for piece, line in enumerate(features.frames[frame].centrelines):
            if len(line) and (frame, piece) not in scan.second_bounces:
                middle = np.array([median(line.uv[:, 1])])
                pi = scan.read_out.planes(numbers[None], middle)[0]
                yield Stripe.of(frame, frame, piece, line, pi, camera, bends)


def _moved(features: ScanFeatures, stripes: Sequence[Stripe], offsets: Offsets, camera: Camera) -> ScanFeatures:
    """Centrelines moved back by the offsets, less sure by a share of them, and met again where the surface bends."""

    def lines(frame: int, pieces: Sequence[Centreline]) -> tuple[Centreline, ...]:
        return tuple(_line(line, offsets.get((frame, piece))) for piece, line in enumerate(pieces))

    fan = lines(-1, features.fan)
    frames = tuple(replace(one, centrelines=lines(one.index, one.centrelines)) for one in features.frames)
    bent = {}
    for stripe in stripes:
        if stripe.bent.any():
            line = (fan if stripe.frame < 0 else frames[stripe.frame].centrelines)[stripe.piece]
            arc = arc_length(straightened((line,), camera)[0].uv)
            bent[stripe.frame, stripe.piece] = BentLine(line, arc, stripe.bent)
    return replace(features, fan=fan, frames=frames, crossings=crossed_again(features.crossings, bent))


def _line(line: Centreline, off: Array | None) -> Centreline:
    if off is None:
        return line
    return replace(line, uv=line.uv - off[:, None] * line.normal, sigma=np.hypot(line.sigma, OFFSET_UNCERTAINTY * off))
