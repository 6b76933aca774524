"""How much the hand's motion within an exposure has blurred each frame, by the widths of its stripes.

A stripe that moves while a frame is exposed is seen at all the places it passes: its section is as wide as at rest, and
as the spread of these places, in squares. A sheet that meets the surface obliquely is wider, too: by 1/cos of the angle
it makes with the surface's normal, as the camera sees it. Sheet and surface are known once the scan is solved, and
sections are compared by what that leaves. Where the sweeps of several frames pass the same part of the picture, their
sections at rest are then alike, so the narrowest of them tell how wide a stripe is there, and the others by how much
they are blurred. What blurs all frames alike, a hand at a steady speed, is not seen: it displaces nothing either.

σ of a centreline is that of its own, wider sections (`core.image.stripes.precision`). Where a hand speeds up or turns
back within an exposure the section is not symmetric either; on simulated scans exposed for 20 and 40 ms by a hand at
28 mm/s that trembles by 0.35 mm that was to be seen in one of four, in frames blurred by more than 1.4 px: twice the
usual errors, 96 % within 2σ, and the thickness no worse. So nothing is added to σ (tests/accuracy/test_motion.py).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from core.findings.table import note_of
from core.messages import Message
from core.model import Camera
from core.model.arrays import Array
from core.model.residuals import over_picture
from core.model.robust import mad_sd, median
from core.scan.features.frames import FrameFeatures
from core.scan.footprint import GRID, px_per_mm, surfaces_of
from core.scan.surface.cloud import Cloud

FEWEST_FRAMES = 4
"""Frames that pass a part at least, or it does not tell the width at rest."""
FEWEST_PARTS = 4
"""Parts in which a frame is compared at least, or nothing is said of it."""
AT_REST = 0.25
"""Quantile of the frames' widths in a part that is that at rest: a hand that trembles stands still now and then."""
MATTERS = 0.5
"""A blur of so many widths at rest counts: it makes sections an eighth wider. Frames of hands at rest reach 0.35."""
WORTH_A_NOTE = 0.1
"""Share of the frames that are blurred so, from which on it is told."""


def exposure_blurs(frames: Sequence[FrameFeatures], sheets: Mapping[int, Array], cloud: Cloud, camera: Camera) -> Array:
    """Estimate (F, 2) in px how much motion in its exposure widens each frame's stripe, and its σ if at rest.

    `sheets` are the light planes π (3,) of the frames that were located, `cloud` the points of all. NaN for frames that
    pass too few parts of the picture where others pass, too.
    """
    surfaces = surfaces_of(cloud, camera)
    rows: list[tuple[int, int, float, float]] = []
    for number, frame in enumerate(frames):
        lines = [line for line in frame.centrelines if not line.saturated.all()]
        if not lines or number not in sheets:
            continue
        uv = np.vstack([line.uv[~line.saturated] for line in lines])
        square = np.concatenate([line.width[~line.saturated] for line in lines]) ** 2
        part, per_mm = over_picture(uv, camera.image_size, GRID), px_per_mm(uv, sheets[number], surfaces, camera)
        for one in np.unique(part[np.isfinite(per_mm)]):
            mine = (part == one) & np.isfinite(per_mm)
            rows.append((number, int(one), median(square[mine]), median(per_mm[mine] ** 2)))
    found = np.full((len(frames), 2), np.nan)
    if not rows:
        return found
    of_frame, part, square, spread = (np.array(column) for column in zip(*rows, strict=True))
    model = spread + _of_lens(square, spread)
    rest = np.full(len(square), np.nan)
    for one in np.unique(part):
        mine = part == one
        if mine.sum() >= FEWEST_FRAMES:
            rest[mine] = np.quantile(square[mine] / model[mine], AT_REST) * model[mine]
    for number in np.unique(of_frame):
        mine = (of_frame == number) & np.isfinite(rest)
        if mine.sum() >= FEWEST_PARTS:
            more, at_rest = float(np.median(square[mine] - rest[mine])), float(np.median(rest[mine]))
            found[number] = np.sqrt(max(more, 0.0)), np.sqrt(at_rest)
    return found


def _of_lens(square: Array, spread: Array) -> float:
    """What lens and pixels add to a section, as the `spread` that adds as much: the one all sections fit best with.

    A section is as wide as the sheet, seen with the `spread` (M,) in px²/mm², and as the lens's blur: `square` (M,) in
    px² ∝ spread + c.
    """
    shares = np.median(spread) * np.concatenate([[0.0], np.geomspace(0.03, 100.0, 36)])
    scatter = [mad_sd(np.log(square / (spread + c)) - np.median(np.log(square / (spread + c)))) for c in shares]
    return float(shares[int(np.argmin(scatter))])


def notes_on_blur(blurs: Array) -> tuple[Message, ...]:
    """Make a note if the hand moved so fast in many exposures that points are less certain; () if not.

    `blurs` (F, 2) are as `exposure_blurs` gives them.
    """
    blur, at_rest = blurs.T
    known, blurred = np.isfinite(blur), blur > MATTERS * at_rest
    if blurred.sum() < max(1.0, WORTH_A_NOTE * known.sum()):
        return ()
    return (
        note_of(
            "scan.exposure_blur",
            n=int(blurred.sum()),
            known=int(known.sum()),
            blur_px=float(blur[blurred].max()),
            at_rest_px=float(np.median(at_rest[known])),
        ),
    )
