"""Boards of a planned rig without a fan: where they stand, what light falls on them, and the known planes they give."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.image.targets import Rectangle, Target
from core.image.targets.target_view import TargetView
from core.model import Camera, Pose
from core.model.arrays import Array
from core.scan.known_planes.known_plane import KnownPlane
from core.scan.known_planes.seen_plane import BoardOf, plane_of_view
from core.simulate.scene.boards import printed
from core.simulate.scene.image import generator
from core.simulate.scene.known_planes import leaning
from core.simulate.scene.laser import Sheet
from core.wings.rig_planning.prediction.calibrating import (
    EDGE_PX,
    STATED,
    face_of,
    on_plate,
    square_covariance,
    view_of,
)
from core.wings.rig_planning.prediction.design import Design
from core.wings.rig_planning.prediction.light_lines import LitLine, lit_lines


def board_poses(design: Design) -> tuple[Pose, ...]:
    """Compute the poses of a design's boards in the camera frame: a corner behind the part, as in the simulation."""
    table, poses = design.table(), []
    for (_, board), side in zip(design.boards, (-1.0, 1.0), strict=True):
        place = leaning(printed(board.target).outline, design.corner_deg, side)
        poses.append(Pose(table.rotation @ place.rotation, table.apply(place.translation[None])[0]))
    return tuple(poses)


def board_triangles(design: Design) -> Array:
    """List the triangles (T, 3, 3) in mm by which the boards hide what is behind them."""
    corners = [
        pose.apply(printed(board.target).outline)
        for (_, board), pose in zip(design.boards, board_poses(design), strict=True)
    ]
    return np.array([[c[i], c[j], c[k]] for c in corners for i, j, k in ((0, 1, 2), (0, 2, 3))]).reshape(-1, 3, 3)


def lines_on_boards(
    design: Design, sheet: Sheet, occluders: Array, camera: Camera, blur_px: float, filter_px: float
) -> list[LitLine]:
    """Compute the stripes that one light `sheet` draws on the light parts of the boards, less what hides or shades."""
    found: list[LitLine] = []
    for (_, board), pose in zip(design.boards, board_poses(design), strict=True):
        plate = printed(board.target)
        lit = lit_lines(sheet, (face_of(plate, pose),), occluders, camera, blur_px, filter_px)
        found += on_plate(lit, plate, pose)
    return found


def plan_planes(design: Design, camera: Camera, seed: int) -> tuple[KnownPlane, ...]:
    """Simulate what pictures of the boards give, seen by the calibrated `camera`: their planes."""
    true, noise = design.camera(), generator(seed, "boards noise")
    planes = []
    for (name, board), pose in zip(design.boards, board_poses(design), strict=True):
        view = _view(name, true, pose, board.target, noise)
        stated = BoardOf(name, board.target, board.board, board.margin_mm, board.print_of or name)
        planes.append(plane_of_view(stated, view, camera))
    return tuple(planes)


def _view(name: str, camera: Camera, pose: Pose, target: Target, noise: np.random.Generator) -> TargetView:
    """What the detector would find of a board; the edges of an outline are fitted as those of a square."""
    if not isinstance(target, Rectangle):
        return view_of(name, camera, pose, target, noise)
    uv = camera.project_pose(pose, target.points)
    covariance = _of_loops([square_covariance(four, EDGE_PX) for four in uv.reshape(-1, 4, 2)])
    error = (np.linalg.cholesky(covariance) @ noise.standard_normal(2 * len(uv))).reshape(-1, 2)
    sigma = STATED * np.sqrt(np.diag(covariance).reshape(-1, 2).mean(axis=1))
    return TargetView(target.points, uv + error, sigma, name, STATED**2 * covariance)


def _of_loops(each: Sequence[Array]) -> Array:
    """Covariance of the corners of several outlines, found apart."""
    size = len(each[0])
    joint = np.zeros((size * len(each), size * len(each)))
    for number, one in enumerate(each):
        block = slice(size * number, size * (number + 1))
        joint[block, block] = one
    return joint
