"""The simulated carrier: where its marks are, where it lies in each view, and what its file says of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from core.image.targets.coded_rings import code_of
from core.inspect.uncertainty.part import TARGET_AT_20
from core.model import Pose
from core.model.arrays import Array
from core.simulate.scenario import Scenario
from core.simulate.scene.boards import BLACK, WHITE
from core.simulate.scene.image import generator
from core.simulate.scene.patterns import Pattern
from core.simulate.scene.scene import TABLE_ALBEDO, Board
from core.views.carrier import Carrier
from core.views.layout import two_sided

SIDES = ("carrier-a", "carrier-b")
"""Names of the boards that are the carrier's sides."""
HALF_MM = (104.0, 82.0)
"""Half of the carrier's width and height."""
THICK_MM = 4.0
"""Thickness of the carrier."""
DISC_MM = 4.0
"""Radius of the marks' discs."""
HEIGHT_SHARE = 0.46
"""Of the block's height that is below the carrier, side A up."""
U_FLAT_MM, U_DEPTH_MM, U_SIDES_MM, U_SIDES_RAD = 0.003, 0.005, 0.006, 6e-5
"""Of the simulated calibration of the carrier: of each mark in the carrier's plane and out of it, and of side B as a
whole against side A."""
_TURNED_YAW_DEG, _TURNED_SHIFT_MM = 3.0, (2.0, -1.5)
"""Turn and shift of the block on the table once it is turned over, against where it stood before."""


def true_positions(marks: int) -> tuple[NDArray[np.int64], Array]:
    """Make the numbers (2N,) and true positions (2N, 3) in mm of `marks` on side A, then as many on side B."""
    return two_sided(marks, HALF_MM, DISC_MM, THICK_MM)


def calibrated_carrier(scenario: Scenario) -> Carrier:
    """Make the carrier as its calibration by the plane target states it: off the truth by a draw from its covariance.

    Where the plates are larger than stated it is stated smaller by as much.
    """
    marks = scenario.carrier.marks
    numbers, true = true_positions(marks)
    sides = np.repeat([0, 1], marks)
    own = np.tile([U_FLAT_MM, U_FLAT_MM, U_DEPTH_MM], 2 * marks)
    together = np.zeros((6 * marks, 6))
    for axis in range(3):
        turn = np.zeros(3)
        turn[axis] = U_SIDES_RAD
        together[:, axis] = (np.cross(turn, true) * sides[:, None]).ravel()
        together[axis::3, 3 + axis] = U_SIDES_MM * sides
    rng = generator(scenario.seed, "carrier")
    drawn = own * rng.standard_normal(6 * marks) + together @ rng.standard_normal(6)
    covariance = np.diag(own**2) + together @ together.T
    stated = true / (1 + scenario.plates.plane_scale) + drawn.reshape(-1, 3)
    return Carrier(
        numbers,
        sides,
        stated,
        covariance,
        DISC_MM,
        scaled_by_target=True,
        name="simulated carrier",
        temperature=TARGET_AT_20,
    )


def pose_table_carrier(scenario: Scenario) -> Pose:
    """Make the pose of the carrier on the table: side A up, or, in the second view, turned over."""
    carrier, height = scenario.carrier, scenario.height_mm
    yaw, place = scenario.yaw_deg, np.array([scenario.right_mm, scenario.away_mm])
    if not carrier.turned:
        turn = Rotation.from_euler("z", yaw, degrees=True)
        return Pose(turn.as_matrix(), np.array([*place, HEIGHT_SHARE * height]))
    turn = Rotation.from_euler("z", yaw + _TURNED_YAW_DEG, degrees=True)
    above = HEIGHT_SHARE if carrier.again else 1 - HEIGHT_SHARE
    over = np.eye(3) if carrier.again else np.diag([1.0, -1.0, -1.0])
    return Pose(turn.as_matrix() @ over, np.array([*(place + _TURNED_SHIFT_MM), above * height]))


def pose_carrier_part(scenario: Scenario) -> Pose:
    """Make the pose of the block in its carrier; its own frame has the origin in the middle of its lower face."""
    slipped = scenario.carrier.slipped_mm if scenario.carrier.turned else 0.0
    return Pose(np.eye(3), np.array([0.0, 0.0, slipped - HEIGHT_SHARE * scenario.height_mm]))


def carrier_boards(scenario: Scenario, pose_cam_table: Pose) -> Sequence[Board]:
    """Make the board that is the side of the carrier facing the camera."""
    carrier = scenario.carrier
    if not carrier.marks:
        return ()
    side = int(carrier.turned and not carrier.again)
    numbers, positions = true_positions(carrier.marks)
    mine = slice(side * carrier.marks, (side + 1) * carrier.marks)
    flip = np.array([1.0, 1.0 if side else -1.0])  # a pattern's y runs down the side that faces the camera
    rings = positions[mine, :2] * flip
    if side:
        rings[0] += [carrier.moved_mm, 0.0]
    smears = rings[1 : 1 + carrier.smeared] + [0.25 * DISC_MM, 0.1 * DISC_MM]
    half = np.array(HALF_MM)
    pattern = Pattern(
        np.array([-half[0], half[0]]),
        np.array([-half[1], half[1]]),
        np.array([[WHITE]]),
        TABLE_ALBEDO,
        np.concatenate([rings, smears]),
        DISC_MM,
        BLACK,
        rings,
        np.array([code_of(int(number)) for number in numbers[mine]]),
    )
    facing = Pose(
        np.diag([1.0, 1.0, 1.0] if side else [1.0, -1.0, -1.0]), np.array([0.0, 0.0, (0.5 - side) * THICK_MM])
    )
    pose = pose_cam_table @ pose_table_carrier(scenario) @ facing
    return (Board(SIDES[side], pattern, pose, -carrier.bent_mm if side else carrier.bent_mm),)
