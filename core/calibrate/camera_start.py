"""Where the adjustment of a camera starts: the best of a few closed forms.

References
----------
Zhang, Z., IEEE Trans. PAMI 22 (2000) 1330–1334, doi:10.1109/34.888718.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from core.calibrate.bundle import Bundle, Observed, residual_lengths
from core.calibrate.camera_options import CameraOptions
from core.calibrate.zhang import centred_matrix, intrinsic_matrix, pose_from_homography, radial_start
from core.model import Camera
from core.model.arrays import Array


def start_of(
    homographies: Sequence[Array], observed: Sequence[Observed], image_size: tuple[int, int], options: CameraOptions
) -> Bundle:
    """The closed-form start with the smallest median residual among Zhang's and the one with a centred camera.

    `homographies` (3, 3) are those of the views `observed`, in the same order.
    """
    matrices = [
        centred_matrix(homographies, image_size),
        intrinsic_matrix(homographies, image_size, options.skew),
    ]
    free = ("k1" not in options.fixed, "k2" not in options.fixed)
    starts = []
    for matrix, radial in product(matrices, (free, (False, False))):
        if matrix is None:
            continue
        poses = tuple(pose_from_homography(matrix, h) for h in homographies)
        undistorted = Camera(image_size, matrix)
        positions = np.concatenate([p.apply(view.points) for p, view in zip(poses, observed, strict=True)])
        uv = np.concatenate([view.uv for view in observed])
        k1, k2 = radial_start(matrix, positions[:, :2] / positions[:, 2:], uv, radial)
        camera = replace(undistorted, distortion=np.array([k1, k2, 0, 0]))
        starts.append(Bundle(camera, poses))
    return min(starts, key=lambda start: float(np.median(np.concatenate(residual_lengths(start, observed)))))
