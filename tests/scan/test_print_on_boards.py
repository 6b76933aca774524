"""Print on a board that the reference shows as pieces of the fan's light: it is not watched, nor told as light."""

import numpy as np

from core.image.stripes.centreline import Centreline
from core.image.stripes.stripe import StripeSettings
from core.scan.fan_watch import fan_shifts, watch_fan
from core.scan.features.extraction import FrameFeatures, ScanFeatures
from core.scan.features.reference import STRETCH
from core.scan.known_planes.known_plane import Control
from core.scan.print_on_boards import printed_on_boards
from core.scan.sweeps.fan_lines import AMBIGUOUS, UNASSIGNED, FanLines
from tests.scan.known_planes.planes_on_paper import CORNER, board, scan_on_paper
from tests.scan.synthetic import CAMERA, FAN

COUNT = 4 * STRETCH


def piece(uv):
    count = len(uv)
    none = np.zeros(count, dtype=bool)
    return Centreline(
        uv, np.tile([0.0, 1.0], (count, 1)), np.full(count, 2.0), np.full(count, 50.0), np.ones(count), none
    )


def on_the_board(line, plane):
    """Where light plane `line` of the fan cuts the board, px by px."""
    u = np.linspace(300.0, 300.0 + COUNT - 1, COUNT)
    v = np.full(COUNT, 250.0)
    for _ in range(60):
        rays = CAMERA.rays(np.column_stack([u, v]))
        step = CAMERA.rays(np.column_stack([u, v + 1])) - rays
        way = FAN.planes[line].pi - plane.pi
        v = v - (rays @ way) / (step @ way)
    return np.column_stack([u, v])


def test_print_is_neither_watched_nor_told_and_light_on_the_board_is():
    plane = board(CORNER[0], 0)
    light = on_the_board(1, plane)
    outline = np.array(
        [[10.0, light[:, 1].min() - 300], [1900.0, light[:, 1].min() - 300], [1900.0, 1300.0], [10.0, 1300.0]]
    )
    plane = board(CORNER[0], 0, place=(outline[0], outline[2]))
    elsewhere = [piece(light - [0.0, 80.0 + 30 * k]) for k in range(3)]
    beside = piece(light - [0.0, 500.0])
    pieces = (piece(light), *elsewhere, beside)
    lines = FanLines((UNASSIGNED,) * 5, (AMBIGUOUS,) * 5, ((0, 1),) * 5)
    control = Control(FAN, (plane,))
    printed = printed_on_boards(pieces, lines, control, CAMERA)
    assert printed.tolist() == [False, True, True, True, False]
    assert not printed_on_boards(pieces, FanLines.settled_as([1] * 5), control, CAMERA).any(), "of a line: light"
    assert not printed_on_boards(pieces, lines, Control(FAN), CAMERA).any()
    table = scan_on_paper(1, count=2).features.crossings
    shifts = np.repeat([0.0, 9.0, 9.0, 9.0, 0.0], 4)
    frames = tuple(FrameFeatures(k, f"{k}", (), fan_shifts_px=shifts * (k > 6)) for k in range(12))
    stripe = StripeSettings(3.0, 50.0)
    features = ScanFeatures(CAMERA.image_size, pieces, frames, table, stripe, stripe)
    assert fan_shifts(features, printed)[1].shape == (12, 8) and not fan_shifts(features, printed)[1].any()
    assert watch_fan(features, lines, CAMERA, FAN).movements
    assert not watch_fan(features, lines, CAMERA, FAN, printed).movements
