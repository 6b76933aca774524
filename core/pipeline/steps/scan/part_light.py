"""Whether stripes on the part of a solved scan are wider than on the table."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from core.findings.table import note_of
from core.image.stripes.centreline import Centreline
from core.messages import Message
from core.model import Pose
from core.pipeline.steps.scan.judgement import Solved, StoredPoses
from core.pipeline.steps.workspace import Calibration
from core.scan.network.read_out import row_planes
from core.scan.part_light import PartLight, blur_of, light_on_part

Plates = Sequence[tuple[Pose, Sequence[Centreline]]]
"""The plates of a calibration, each with its pose and the stripes on it."""


def part_light(solved: Solved, plates: Plates) -> PartLight | None:
    """Compare the width of laser stripes on the part with that on the table; None where too little is known."""
    scan, camera = solved.scan, solved.calibration.camera.camera
    if scan.collapsed:
        return None
    blur = blur_of(plates, camera, solved.calibration.fan.fan)
    return light_on_part(_stripes(solved), scan.cloud, camera, blur)


def plates_of(kept: StoredPoses, calibration: Calibration) -> Plates:
    """Collect the pose and the stripes of each plate that a fan was calibrated from, as far as they are stored.

    A re-adjustment moves the fan by tenths of a mm: how wide a lens at half a metre blurs stripes is as before.
    """
    stripes = {pose.name: pose.centrelines for pose in kept.poses}
    return [(pose.pose, stripes[pose.name]) for pose in calibration.fan.poses if pose.used and pose.name in stripes]


def notes_on_part_light(light: PartLight | None) -> tuple[Message, ...]:
    """Make a note if stripes on the part are surely wider than on the table; () if not, or not known."""
    if light is None or not light.surely:
        return ()
    return (
        note_of(
            "scan.stripes_wider_on_part",
            percent=100 * light.wider,
            U=200 * light.error,
            behind_mm=light.behind_mm,
        ),
    )


def _stripes(solved: Solved) -> Iterator[tuple[Sequence[Centreline], np.ndarray]]:
    """Each located frame's stripes but for second bounces, and the sheet they lie on in its middle row."""
    scan, frames = solved.scan, solved.features.frames
    rows = solved.features.image_size[1]
    sheets = row_planes(scan.pis, np.full(len(scan.pis), rows / 2), rows)
    for number, sheet in zip(scan.sweep_frames.tolist(), sheets, strict=True):
        pieces = enumerate(frames[number].centrelines)
        yield [piece for k, piece in pieces if (number, k) not in scan.second_bounces.pieces], sheet
