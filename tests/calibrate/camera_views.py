"""Synthetic views of a checkerboard by the paper's camera at half resolution."""

import numpy as np
from scipy.spatial.transform import Rotation

from core.image.targets.target_view import TargetView
from core.model import Pose
from tests import paper

TRUTH = paper.HALF


def board(columns: int = 17, rows: int = 12, square_mm: float = 10.0) -> np.ndarray:
    x, y = np.meshgrid(np.arange(columns), np.arange(rows))
    return np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)]) * square_mm


def shaped(points: np.ndarray, bow_x: float, bow_y: float, twist: float, aspect: float) -> np.ndarray:
    """The flat board bowed and drawn out."""
    off = points[:, :2] - points[:, :2].mean(axis=0)
    x, y = (off / off.max(axis=0)).T
    z = bow_x * x**2 + bow_y * y**2 + twist * x * y
    return points + np.column_stack([0.5 * aspect * off[:, 0], -0.5 * aspect * off[:, 1], z])


def random_pose(rng: np.random.Generator, points: np.ndarray, max_tilt: float) -> Pose:
    """The board's middle on a ray in the middle of the picture, 450 to 650 mm away, tilted in any direction."""
    direction = rng.uniform(0, 2 * np.pi)
    angle = max_tilt * np.sqrt(rng.uniform())
    tilted = Rotation.from_rotvec(angle * np.array([np.cos(direction), np.sin(direction), 0]))
    rotation = (tilted * Rotation.from_rotvec([0, 0, rng.uniform(-0.3, 0.3)])).as_matrix()
    width, height = TRUTH.image_size
    pixel = rng.uniform([0.28 * width, 0.28 * height], [0.72 * width, 0.72 * height])
    centre = TRUTH.rays(pixel[None])[0] * rng.uniform(450, 650)
    return Pose(rotation, centre - rotation @ points.mean(axis=0))


def synthetic_views(
    seed: int,
    count: int = 14,
    noise_px: float = 0.03,
    max_tilt_deg: float = 35.0,
    bend_px: float = 0.0,
    shape: tuple[float, float, float, float] | None = None,
) -> list[TargetView]:
    """Views with independent corner noise, and with `bend_px` of a smooth error common to a view's corners.

    `shape` of the board that is seen: mm it bows along x and y at its edges, mm of twist, and its aspect.
    """
    rng = np.random.default_rng(seed)
    points = board()
    x, y = ((points[:, :2] - points[:, :2].mean(axis=0)) / 80).T
    bends = np.column_stack([x * x, y * y, x * y, x**3, y**3])
    seen = points if shape is None else shaped(points, *shape)
    views: list[TargetView] = []
    while len(views) < count:
        uv = TRUTH.project_pose(random_pose(rng, points, np.deg2rad(max_tilt_deg)), seen)
        if (uv < 5).any() or (uv > np.array(TRUTH.image_size) - 5).any():
            continue
        uv = uv + rng.normal(0, noise_px, uv.shape) + bend_px * bends @ rng.normal(size=(5, 2))
        views.append(TargetView(points, uv, np.full(len(points), max(noise_px, 0.01)), f"view{len(views):02d}.png"))
    return views


def changed(view: TargetView, uv: np.ndarray) -> TargetView:
    return TargetView(view.points, uv, view.sigma, view.name)
