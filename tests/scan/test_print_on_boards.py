"""Print on a board that the reference shows as pieces of the fan's light: it is not watched, nor told as light."""

from dataclasses import replace

import numpy as np

from core.image.stripes.centreline import Centreline
from core.image.stripes.stripe import StripeSettings
from core.scan.fan_watch import fan_shifts, watch_fan
from core.scan.features.extraction import FrameFeatures, ScanFeatures
from core.scan.features.reference import STRETCH
from core.scan.print_on_boards import printed_on_boards
from core.scan.sweeps.fan_lines import PRINT, UNASSIGNED
from core.scan.sweeps.locate import number_fan_lines
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
    light = on_the_board(1, board(CORNER[0], 0))
    top = light[:, 1].min() - 300
    elsewhere = [light - [0.0, 80.0 + 30 * k] for k in range(3)]
    before, beside = light + [0.0, 120.0], light - [0.0, 500.0]
    pieces = tuple(piece(uv) for uv in (light, *elsewhere, before, beside))
    width, height = CAMERA.image_size
    picture, marks = np.full((height, width), 200, np.uint8), np.zeros((height, width), bool)
    for uv in (light, *elsewhere, beside):  # strips of 7 px between dark marks
        for du, dv in ((0, k) for k in (*range(-14, -3), *range(4, 15))):
            at = (np.rint(uv[:, 1]).astype(int) + dv).clip(0, height - 1), np.rint(uv[:, 0]).astype(int) + du
            picture[at], marks[at] = 20, True
    plane = replace(board(CORNER[0], 0, place=((10.0, top), (1900.0, 1300.0))), picture=picture, marks=marks)
    printed = printed_on_boards(pieces, [plane], FAN, CAMERA)
    assert printed.tolist() == [False, True, True, True, False, False], "light on the board or before it is none"
    dark = replace(plane, picture=np.full_like(picture, 20))
    assert not printed_on_boards(pieces, [dark], FAN, CAMERA).any(), "strips that its picture does not show"
    assert not printed_on_boards(pieces, [], FAN, CAMERA).any()
    table = scan_on_paper(1, count=2).features.crossings
    lines = number_fan_lines(pieces, table, CAMERA, FAN, printed=printed)
    assert [lines.line[k] for k in np.flatnonzero(printed)] == [UNASSIGNED] * 3
    shifts = np.repeat([0.0, 9.0, 9.0, 9.0, 0.0, 0.0], 4)
    frames = tuple(FrameFeatures(k, f"{k}", (), fan_shifts_px=shifts * (k > 6) + 1e-3 * np.sin(k)) for k in range(12))
    stripe = StripeSettings(3.0, 50.0)
    features = ScanFeatures(CAMERA.image_size, pieces, frames, table, stripe, stripe)
    assert fan_shifts(features, printed)[1].shape == (12, 12)
    assert watch_fan(features, lines, CAMERA, FAN).movements
    assert not watch_fan(features, lines, CAMERA, FAN, printed).movements


def test_where_all_is_print_no_line_is_numbered():
    pieces = (piece(np.column_stack([np.arange(60.0), np.full(60, 9.0)])),)
    lines = number_fan_lines(
        pieces, scan_on_paper(1, count=2).features.crossings, CAMERA, FAN, printed=np.ones(1, bool)
    )
    assert lines.line == (UNASSIGNED,) and lines.reason == (PRINT,)
