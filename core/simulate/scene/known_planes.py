"""Known planes of a scenario: what its boards are, where they lie, and what rig.toml states of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from core.calibrate.board_shape import TRUE, BoardTolerance
from core.files.recording.rig import KnownPlaneTarget
from core.image.targets import Target
from core.model import Camera, Pose
from core.model.arrays import Array
from core.simulate.scenario import Scenario
from core.simulate.scene.boards import printed
from core.simulate.scene.corner import CORNER, FAR, NEAR, corner_planes
from core.simulate.scene.scene import TABLE_ALBEDO, Board
from core.simulate.scene.wrong_plates import scaled

PLATE = "plate"
"""Name of the board with the plane target."""
PLATE_THICK_MM = 3.0
"""Of the plate that lies on the table."""
CORNER_BEGINS_MM = 37.0
"""How far behind the table's middle the near board has its rim: where the object no longer reaches."""
REGION_ROUND_PX = 10
"""A region in rig.toml is drawn by hand, so near to the board's outline."""


def boards_of(scenario: Scenario, plate: Target, table: Pose) -> tuple[Board, ...]:
    """Make the boards of a scenario in the camera frame; `plate` is its plane target, `table` the table's pose."""
    beside, boards = scenario.boards, []
    if beside.plate:
        pattern = scaled(printed(plate), (1 + scenario.plates.plane_scale) * (1 + beside.larger) - 1)
        turn = Rotation.from_euler("z", beside.plate_turned_deg, degrees=True).as_matrix()
        lying = turn @ np.diag([1.0, -1.0, -1.0])  # a plate's z points into it
        middle = np.array([beside.plate_right_mm, beside.plate_away_mm, PLATE_THICK_MM])
        place = Pose(lying, middle - lying @ pattern.outline.mean(axis=0))
        boards.append(Board(PLATE, pattern, _in_camera(table, place), scenario.plates.plane_bow_mm))
    if beside.corner:
        for name, target, side in zip((NEAR, FAR), CORNER[beside.kind], (-1.0, 1.0), strict=True):
            pattern = scaled(printed(target), beside.larger)
            boards.append(Board(name, pattern, _in_camera(table, leaning(pattern.outline, beside.corner_deg, side))))
    if boards and beside.bent_mm:
        first = boards[0]
        boards[0] = Board(first.name, first.pattern, first.pose, first.bow_mm + beside.bent_mm)
    return tuple(Board(one.name, one.pattern.on(TABLE_ALBEDO), one.pose, one.bow_mm) for one in boards)


def leaning(outline: Array, corner_deg: float, side: float) -> Pose:
    """Place a board with its lower (`side` +1) or upper edge (−1) in the corner's edge, in the table's frame."""
    lean = np.radians((180.0 - corner_deg) / 2)
    (_, top, _), (_, bottom, _) = outline.min(axis=0), outline.max(axis=0)
    edge = CORNER_BEGINS_MM + (bottom - top) * np.cos(lean)
    down = np.array([0.0, -np.cos(lean), -side * np.sin(lean)])
    right = np.array([1.0, 0.0, 0.0])
    rotation = np.column_stack([right, down, np.cross(right, down)])
    on_edge = np.array([outline[:, 0].mean(), bottom if side > 0 else top, 0.0])
    return Pose(rotation, np.array([0.0, edge, 0.0]) - rotation @ on_edge)


def _in_camera(table: Pose, place: Pose) -> Pose:
    return Pose(table.rotation @ place.rotation, table.apply(place.translation[None])[0])


def stated_planes(scenario: Scenario, boards: tuple[Board, ...], camera: Camera) -> dict[str, KnownPlaneTarget]:
    """State what is printed on the boards, as rig.toml has it; the plate is the plane target and needs no table."""
    stated = corner_planes(scenario.boards.kind, TRUE if scenario.stated else BoardTolerance())
    drawn = scenario.boards.kind == "rectangle"
    return {
        board.name: replace(stated[board.name], region_px=_region(board, camera) if drawn else None)
        for board in boards
        if board.name in stated
    }


def _region(board: Board, camera: Camera) -> tuple[tuple[float, float], ...]:
    uv = camera.project_pose(board.pose, board.pattern.outline)
    return tuple((float(u), float(v)) for u, v in REGION_ROUND_PX * np.round(uv / REGION_ROUND_PX))
