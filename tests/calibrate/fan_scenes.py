"""Poses of a flat target under the paper's fan, as the picture features would show them, with the truth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from core.calibrate.board_shape import Board, BoardShape
from core.calibrate.fan.pencil import pencil_near
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.image.stripes.centreline import Centreline
from core.image.targets import BlackSquare, Checkerboard
from core.image.targets.target_view import TargetView
from core.model import Pose
from tests import paper

CAMERA = paper.HALF
ALPHA = np.deg2rad(5)
PAPER = pencil_near(paper.PLANES, ALPHA).pis
SQUARE = BlackSquare(60.0).points
GRID = Checkerboard(9, 7, 10.0).points
PLATE = Board(np.array([30.0, 30.0]), np.array([75.0, 75.0]))
"""What the stripes lie on."""


@dataclass(frozen=True)
class Noise:
    corner_px: float = 0.02
    stripe_px: float = 0.06
    grain_px: float = 2.0
    flatness_mm: float = 0.0
    """How far each stripe's place on the plate is off its plane."""
    scatter_mm: float = 0.0
    """How far the plate itself is from where its points say, in the middle and by either tilt at its edges."""


QUIET = Noise(1e-6, 1e-6, 0.0)


def poses(count: int, seed: int) -> list[Pose]:
    """Targets at 450 … 600 mm, tilted by up to 35°, where all three lines meet them."""
    rng = np.random.default_rng(seed)
    found = []
    for z in np.linspace(450, 600, count):
        tilt = Rotation.from_euler("yxz", rng.uniform([-35, -30, -20], [35, 30, 20]), degrees=True)
        centre = np.array([rng.uniform(-20, 20), 0.075 * z + rng.uniform(-10, 10), z])
        found.append(Pose(tilt.as_matrix(), centre - tilt.apply([30.0, 30.0, 0.0])))
    return found


def displaced(pose: Pose, ahead: float, tilt_x: float, tilt_y: float) -> Pose:
    """The pose with the plate's middle moved along its normal, and its edges by its tilts, all in mm."""
    half, middle = PLATE.half, np.append(PLATE.middle, 0.0)
    turned = pose.rotation @ Rotation.from_rotvec([tilt_x / half[1], tilt_y / half[0], 0.0]).as_matrix()
    return Pose(turned, pose.apply(middle[None])[0] - turned @ middle + ahead * pose.rotation[:, 2])


def bowed(*bow: float) -> BoardShape:
    """The plate with these bows in mm at its edges."""
    return BoardShape(PLATE, np.array([*bow, 0.0]), np.zeros((4, 4)))


def stripe(
    pi: np.ndarray,
    pose: Pose,
    noise: Noise,
    rng: np.random.Generator,
    reach: float = 70.0,
    shape: BoardShape | None = None,
    bow: float = 0.0,
) -> Centreline:
    """The centreline of a light plane on the target, points about one pixel apart, within `reach` mm of its middle.

    Light with a `bow` in 1/mm leaves its plane by bow · x² mm.
    """
    normal = pose.rotation[:, 2]
    direction = np.cross(pi, normal)
    direction /= np.linalg.norm(direction)
    if direction[0] < 0:
        direction = -direction
    middle = pose.apply([[30.0, 30.0, 0.0]])[0]
    system = np.array([pi, normal, direction])
    foot = np.linalg.solve(system, [1.0, normal @ pose.translation, direction @ middle])
    points = foot + np.linspace(-reach, reach, int(2 * reach * CAMERA.focal / foot[2]))[:, None] * direction
    if shape is not None or bow:
        for _ in range(4):
            height = 0.0 if shape is None else shape.shaped(pose.inverse().apply(points) * [1, 1, 0])[:, 2]
            lit = 1 + np.linalg.norm(pi) * bow * points[:, 0] ** 2
            known = np.column_stack(
                [lit, np.broadcast_to(normal @ pose.translation + height, len(points)), points @ direction]
            )
            points = np.linalg.solve(system, known.T).T
    uv = CAMERA.project(points)
    inside = ((uv > 4) & (uv < np.array(CAMERA.image_size) - 5)).all(axis=1)
    uv = uv[inside]
    tangent = np.gradient(uv, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    across = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    error = rng.normal(0, 1, len(uv))
    if noise.grain_px:
        error = gaussian_filter1d(error, noise.grain_px) * np.sqrt(2 * np.sqrt(np.pi) * noise.grain_px)
    count = len(uv)
    return Centreline(
        uv + noise.stripe_px * error[:, None] * across,
        across,
        np.full(count, 1.6),
        np.full(count, 120.0),
        np.full(count, noise.stripe_px),
        np.zeros(count, dtype=bool),
    )


def features(
    where: list[Pose],
    noise: Noise,
    seed: int,
    *,
    pis: np.ndarray = PAPER,
    points: np.ndarray = SQUARE,
    shape: BoardShape | None = None,
    bow: float = 0.0,
) -> list[PoseFeatures]:
    """What pictures of the poses would show; the stripes in an order that tells nothing.

    `bow` is the light's, as of `stripe`.
    """
    rng = np.random.default_rng(seed)
    found = []
    for number, pose in enumerate(where):
        seen = points if shape is None else shape.shaped(points)
        uv = CAMERA.project_pose(pose, seen) + rng.normal(0, noise.corner_px, (len(points), 2))
        view = TargetView(points, uv, np.full(len(points), noise.corner_px), f"p{number}")
        lines = []
        truly = displaced(pose, *rng.normal(0, noise.scatter_mm, 3)) if noise.scatter_mm else pose
        for pi in pis:
            bent = Pose(truly.rotation, truly.translation + truly.rotation[:, 2] * rng.normal(0, noise.flatness_mm))
            lines.append(stripe(pi, bent, noise, rng, shape=shape, bow=bow))
        rng.shuffle(lines)
        found.append(PoseFeatures(f"p{number}", view, tuple(lines)))
    return found
