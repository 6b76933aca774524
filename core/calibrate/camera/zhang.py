"""Zhang's closed-form start of a camera calibration, from the homographies of a planar target.

References
----------
Zhang, Z., A flexible new technique for camera calibration, IEEE Trans. PAMI 22 (2000) 1330–1334,
doi:10.1109/34.888718: §3.1 (closed form), §3.3 (radial distortion), appendix A (homography).
Hartley, R., In defense of the eight-point algorithm, IEEE Trans. PAMI 19 (1997), doi:10.1109/34.601246.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.model import Pose
from core.model.arrays import Array

_REWEIGHTINGS = 8
"""Rounds of Cauchy's weights in a homography; single misfound corners have lost theirs by then."""
_CAUCHY_LIMIT = 3.0
"""Median misfits at which a corner has half its weight."""
_LEAST_INVERSE_SQUARE = 1e-4
"""Square of picture width over focal length below which views do not give a focal length: 100 widths."""


def homography(points: Array, uv: Array) -> Array:
    """Fit the homography (3, 3) from target points (N, 2) in mm to image points (N, 2) in pixels, N ≥ 5.

    Normalised direct linear transform, reweighted so that single misfound corners do not count.
    """
    from_target, to_image = _normalisation(points), _normalisation(uv)
    source, image = _apply(from_target, points), _apply(to_image, uv)
    ones, zeros = np.ones((len(source), 1)), np.zeros((len(source), 3))
    lifted = np.hstack([source, ones])
    rows = np.stack(
        [
            np.hstack([lifted, zeros, -image[:, :1] * lifted]),
            np.hstack([zeros, lifted, -image[:, 1:] * lifted]),
        ],
        axis=1,
    )
    weights = np.ones(len(source))
    for _ in range(_REWEIGHTINGS):
        matrix = np.linalg.svd((rows * weights[:, None, None]).reshape(-1, 9), full_matrices=False)[2][-1]
        depth = lifted @ matrix[6:]
        misfit = np.linalg.norm(rows @ matrix, axis=1) / np.maximum(np.abs(depth), 1e-9)
        scale = max(float(np.median(misfit)), 1e-9)
        weights = 1 / (
            np.abs(depth) * (1 + (misfit / (_CAUCHY_LIMIT * scale)) ** 2)
        )  # Cauchy; 1/depth makes it geometric
    result: Array = np.linalg.inv(to_image) @ matrix.reshape(3, 3) @ from_target
    return result / np.linalg.norm(result)


def homography_misfit(matrix: Array, points: Array, uv: Array) -> Array:
    """Compute distances (N,) in px between image points `uv` (N, 2) and target `points` (N, 2) mapped by `matrix`."""
    lifted = np.column_stack([points, np.ones(len(points))]) @ matrix.T
    with np.errstate(divide="ignore", invalid="ignore"):
        distances: Array = np.linalg.norm(lifted[:, :2] / lifted[:, 2:] - uv, axis=1)
    return np.nan_to_num(distances, nan=np.inf)


def intrinsic_matrix(homographies: Sequence[Array], image_size: tuple[int, int], skew: bool) -> Array | None:
    """Compute the camera matrix (3, 3) from homographies in closed form (Zhang §3.1); None where they allow none.

    Every homography gives two linear equations for B = A⁻ᵀ A⁻¹; without `skew` B₁₂ = 0 is one more.
    """
    centred = _picture_normalisation(image_size)
    rows = []
    for raw in homographies:
        h = centred @ raw
        h /= np.linalg.norm(h[:, :2])
        rows += [_conic_row(h, 0, 1), _conic_row(h, 0, 0) - _conic_row(h, 1, 1)]
    equations = np.array(rows)
    unknowns = np.arange(6) if skew else np.array([0, 2, 3, 4, 5])
    b = np.zeros(6)
    b[unknowns] = np.linalg.svd(equations[:, unknowns])[2][-1]
    b *= np.sign(b[0]) or 1.0
    conic = np.array([[b[0], b[1], b[3]], [b[1], b[2], b[4]], [b[3], b[4], b[5]]])
    try:
        lower = np.linalg.cholesky(conic)
    except np.linalg.LinAlgError:
        return None
    a = np.linalg.inv(centred) @ np.linalg.inv(lower.T)
    result: Array = a / a[2, 2]
    return result


def centred_matrix(homographies: Sequence[Array], image_size: tuple[int, int]) -> Array:
    """Compute a camera matrix (3, 3) of square pixels and centred principal point, its focal length fitted.

    For views that do not carry the full closed form. Where they do not even give a focal length it is taken as the
    picture's width.
    """
    width, height = image_size
    centre = np.array([(width - 1) / 2, (height - 1) / 2])
    to_centre = np.array([[1, 0, -centre[0]], [0, 1, -centre[1]], [0, 0, 1]]) / width
    to_centre[2, 2] = 1
    planar, constant = [], []
    for raw in homographies:
        h = to_centre @ raw
        h /= np.linalg.norm(h[:, :2])
        a, b = h[:, 0], h[:, 1]
        planar += [a[:2] @ b[:2], a[:2] @ a[:2] - b[:2] @ b[:2]]
        constant += [a[2] * b[2], a[2] ** 2 - b[2] ** 2]
    inverse_square = -float(np.dot(planar, constant) / max(np.dot(planar, planar), 1e-300))
    focal = width / np.sqrt(inverse_square) if inverse_square > _LEAST_INVERSE_SQUARE else float(width)
    return np.array([[focal, 0, centre[0]], [0, focal, centre[1]], [0, 0, 1]])


def pose_from_homography(matrix: Array, h: Array) -> Pose:
    """Compute the pose of a flat target from its homography `h` (3, 3) and the camera's `matrix` (3, 3)."""
    columns: Array = np.asarray(np.linalg.solve(matrix, h), dtype=np.float64)
    columns *= 2 / (np.linalg.norm(columns[:, 0]) + np.linalg.norm(columns[:, 1]))
    if columns[2, 2] < 0:
        columns = -columns
    first, second = columns[:, 0], columns[:, 1]
    u, _, vt = np.linalg.svd(np.column_stack([first, second, np.cross(first, second)]))
    rotation: Array = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
    return Pose(rotation, columns[:, 2])


def radial_start(matrix: Array, rays: Array, uv: Array, free: tuple[bool, bool]) -> tuple[float, float]:
    """Estimate the radial coefficients k1 and k2 by linear least squares (Zhang §3.3); 0 for one that is not `free`.

    `rays` (N, 2) are the undistorted x, y that the poses predict for the image points `uv` (N, 2).
    """
    r2 = np.sum(rays**2, axis=1)
    outward = rays @ matrix[:2, :2].T
    columns = np.stack([outward * r2[:, None], outward * (r2**2)[:, None]], axis=-1).reshape(-1, 2)
    missing = (uv - outward - matrix[:2, 2]).ravel()
    chosen = np.flatnonzero(free)
    k = np.zeros(2)
    if len(chosen):
        k[chosen] = np.linalg.lstsq(columns[:, chosen], missing, rcond=None)[0]
    return float(k[0]), float(k[1])


def _normalisation(xy: Array) -> Array:
    """The similarity (3, 3) that brings `xy` (N, 2) to mean 0 and mean length √2 (Hartley)."""
    mean = xy.mean(axis=0)
    scale = np.sqrt(2) / max(float(np.linalg.norm(xy - mean, axis=1).mean()), 1e-12)
    return np.array([[scale, 0, -scale * mean[0]], [0, scale, -scale * mean[1]], [0, 0, 1]])


def _picture_normalisation(image_size: tuple[int, int]) -> Array:
    """The similarity (3, 3) that brings the picture to about −1 … 1."""
    width, height = image_size
    scale = 2 / max(width, height)
    return np.array([[scale, 0, -scale * (width - 1) / 2], [0, scale, -scale * (height - 1) / 2], [0, 0, 1]])


def _apply(similarity: Array, xy: Array) -> Array:
    result: Array = xy @ similarity[:2, :2].T + similarity[:2, 2]
    return result


def _conic_row(h: Array, i: int, j: int) -> Array:
    """v_ij of Zhang's equation (7): h_iᵀ B h_j = v_ijᵀ (B11, B12, B22, B13, B23, B33)."""
    a, b = h[:, i], h[:, j]
    return np.array(
        [
            a[0] * b[0],
            a[0] * b[1] + a[1] * b[0],
            a[1] * b[1],
            a[2] * b[0] + a[0] * b[2],
            a[2] * b[1] + a[1] * b[2],
            a[2] * b[2],
        ]
    )
