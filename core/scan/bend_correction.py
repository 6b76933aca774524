"""A scan solved twice: the second time with its stripes where their light planes cut the surface found first.

On a surface that bends all stripes lie a little beside their light planes (`core.scan.sections`), the same way, so no
mean gets rid of it: a ball comes out too small. How far, is known once the surface is.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from core.image.centreline import Centreline
from core.image.pieces import arc_length
from core.model import Camera, Fan
from core.model.arrays import Array
from core.progress import Progress, silent
from core.scan.bends import Bends, bends_of
from core.scan.bent_crossings import BentLine, met_again
from core.scan.fan_lines import UNASSIGNED
from core.scan.features import ScanFeatures
from core.scan.reconstruct import ReconstructOptions, reconstruct
from core.scan.results import ScanResult
from core.scan.sections import Stripe, light_of, toward_light
from core.scan.straightening import straightened

NOTICED_PX = 1e-3
"""Points that would move by less need not."""
FEW = 0.003
"""Where no larger share of the points would move, all stay: edges, not a bend."""
LAW = 0.25
"""Share of t by which the law, bend and light direction may be wrong: uncertainty of what is moved."""


Offsets = dict[tuple[int, int], Array]
"""How far (N,) in px along its normals the light of a centreline, given by frame (−1: the fan) and piece, lies off."""


def reconstruct_twice(
    features: ScanFeatures,
    camera: Camera,
    fan: Fan,
    options: ReconstructOptions | None = None,
    progress: Progress = silent,
) -> tuple[ScanFeatures, ScanResult]:
    """Solve the scan, and where its surface bends again: the features it rests on in the end, and the solution.

    By the paper's method it is solved once: nothing of ours is in it.

    Raises
    ------
    InputError
        As `core.scan.reconstruct.reconstruct`.
    """
    first = reconstruct(features, camera, fan, options, progress)
    if options is not None and options.method != "network":
        return features, first
    even = evened(features, first, camera, fan)
    if even is features:
        return features, first
    return even, reconstruct(even, camera, fan, options, progress, first.fan_lines)


def evened(features: ScanFeatures, scan: ScanResult, camera: Camera, fan: Fan) -> ScanFeatures:
    """The features with centrelines and crossings where the light planes cut the surface that `scan` has found.

    `features` themselves where the surface has no bend that matters.
    """
    bends = bends_of(scan.cloud, features.image_size)
    if bends.flat:
        return features
    stripes = list(_stripes(features, scan, camera, fan, bends))
    fan_light, sweep_light, blur = light_of(stripes)
    of_sheet: dict[int, list[Stripe]] = {}
    for stripe in stripes:
        of_sheet.setdefault(stripe.sheet, []).append(stripe)
    offsets: Offsets = {}
    for mine in of_sheet.values():
        light = fan_light if mine[0].frame < 0 else sweep_light
        toward = toward_light(mine, light, blur)
        offsets |= {(stripe.frame, stripe.piece): stripe.offsets(light, blur, toward) for stripe in mine}
    moved = np.concatenate([np.zeros(0), *offsets.values()])
    if np.count_nonzero(np.abs(moved) > NOTICED_PX) <= FEW * len(moved):
        return features
    return _moved(features, stripes, offsets, camera)


def _stripes(features: ScanFeatures, scan: ScanResult, camera: Camera, fan: Fan, bends: Bends) -> Iterator[Stripe]:
    """Every centreline whose light plane is known; the fan's sheets are −1 − line."""
    for piece, (line, number) in enumerate(zip(features.fan, scan.fan_lines.line, strict=True)):
        if number != UNASSIGNED and len(line):
            yield Stripe.of(-1 - number, -1, piece, line, fan.planes[number].pi, camera, bends)
    for pi, frame in zip(scan.pis, scan.sweep_frames.tolist(), strict=True):
        for piece, line in enumerate(features.frames[frame].centrelines):
            if len(line):
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
    return replace(features, fan=fan, frames=frames, crossings=met_again(features.crossings, bent))


def _line(line: Centreline, off: Array | None) -> Centreline:
    if off is None:
        return line
    return replace(line, uv=line.uv - off[:, None] * line.normal, sigma=np.hypot(line.sigma, LAW * off))
