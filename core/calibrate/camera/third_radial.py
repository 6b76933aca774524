"""Whether a lens asks for its third radial coefficient k3: only where that surely foretells pictures left out better.

Each picture in turn is left out, and the cameras without and with k3 that the others give are held against it, its pose
fitted to it: nothing else can tell that. With the pose eliminated, S the information of all pictures, S_v and g_v that
of one and its share of the gradient, which sums to zero where the camera is solved, leaving the picture out moves the
camera by

    δ = −(S − S_v)⁻¹ g_v,      and the picture's χ² becomes      χ²_v − 2 δ·g_v + δᵀ S_v δ.

So no camera needs to be solved again. As with the skew (`core.calibrate.camera.skew`), the gain is relative, picture by
picture, and the simpler model is kept unless the mean gain is above zero by MANY_ERRORS of its standard errors.

References
----------
Belsley, D. A., Kuh, E. & Welsch, R. E., Regression Diagnostics (1980), §2.1 (what leaving observations out changes).
Stone, M., J. R. Stat. Soc. B 36 (1974) 111–147, doi:10.1111/j.2517-6161.1974.tb00994.x (cross-validatory choice).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.calibrate.camera.bundle import Bundle, Observed, normal_equations, refine, residual_lengths
from core.calibrate.camera.skew import FEWEST_VIEWS, MANY_ERRORS
from core.calibrate.results import CAMERA_PARAMETERS
from core.findings.table import note_of
from core.messages import Message
from core.model import Camera
from core.model.arrays import Array

K3 = CAMERA_PARAMETERS.index("k3")

_BORDER = 9
"""Places along each side of the picture that must have a ray: the distortion is smooth."""


@dataclass(frozen=True, slots=True)
class ThirdRadial:
    """Effect of k3 on the fit and on the picture.

    Parameters
    ----------
    gain, gain_error
        Mean share by which squared residuals of pictures left out become smaller, and its standard error.
    px
        The most that a corner of the pictures is predicted elsewhere.
    mm, depth_mm
        That across the line of sight, at the median depth of the corners.
    """

    gain: float
    gain_error: float
    px: float
    mm: float
    depth_mm: float

    @property
    def note(self) -> Message:
        """Note that the third radial coefficient k3 is solved for, and its effect."""
        return note_of(
            "camera.third_radial",
            gain=self.gain,
            gain_error=self.gain_error,
            px=self.px,
            mm=self.mm,
            depth_mm=self.depth_mm,
        )


def third_radial(solved: Bundle, counted: Sequence[Observed], free: NDArray[np.intp]) -> ThirdRadial | None:
    """Compute how the third radial coefficient k3 improves a camera `solved` without it; None where it does not.

    `free` are the free parameters, without k3. None also with fewer than FEWEST_VIEWS views, or where the picture would
    have no ray at its border.
    """
    if len(counted) < FEWEST_VIEWS:
        return None
    with_k3 = np.append(free, K3)
    bent = refine(solved, counted, with_k3, tolerance=1e-8)
    try:
        left_out = [left_out_misfits(*model) for model in ((solved, counted, free), (bent, counted, with_k3))]
    except np.linalg.LinAlgError:
        return None
    gains = 1 - left_out[1] / np.maximum(left_out[0], 1e-300)
    error = float(gains.std(ddof=1) / np.sqrt(len(gains)))
    if not gains.mean() > MANY_ERRORS * error or (_has_ray(solved.camera) & ~_has_ray(bent.camera)).any():
        return None
    moved = [
        np.linalg.norm(solved.camera.project_pose(a, view.points) - bent.camera.project_pose(b, view.points), axis=1)
        for a, b, view in zip(solved.poses, bent.poses, counted, strict=True)
    ]
    depths = [pose.apply(view.points)[:, 2] for pose, view in zip(bent.poses, counted, strict=True)]
    px, depth = float(np.concatenate(moved).max()), float(np.median(np.concatenate(depths)))
    return ThirdRadial(float(gains.mean()), error, px, px * depth / bent.camera.focal, depth)


def left_out_misfits(solved: Bundle, counted: Sequence[Observed], free: NDArray[np.intp]) -> Array:
    """Compute χ² (V,) of the residuals of each view for the camera solved from all other views.

    `solved` is from all of them.

    Raises
    ------
    numpy.linalg.LinAlgError
        When the others do not determine the camera.
    """
    normal = normal_equations(solved, counted, free)
    gradients = np.array([own.sum(axis=0) for own in normal.gradients])
    total, pull = normal.information.sum(axis=0), gradients.sum(axis=0)
    scale = 1 / np.sqrt(np.maximum(np.diag(total), 1e-300))
    rest = (total - normal.information) * np.outer(scale, scale)
    moved = scale * np.linalg.solve(rest, (scale * (pull - gradients))[..., None])[..., 0]
    here = np.array([float(np.sum(lengths**2)) for lengths in residual_lengths(solved, counted)])
    away = np.einsum("vi,vij,vj->v", moved, normal.information, moved) - 2 * (moved * gradients).sum(axis=1)
    return np.asarray(here + away, dtype=np.float64)


def _has_ray(camera: Camera) -> NDArray[np.bool_]:
    """Whether places along the picture's border have one."""
    width, height = camera.image_size
    across, down = np.linspace(0, width - 1, _BORDER), np.linspace(0, height - 1, _BORDER)
    sides = [(across, 0 * across), (across, 0 * across + height - 1), (0 * down, down), (0 * down + width - 1, down)]
    uv = np.concatenate([np.column_stack(side) for side in sides])
    return np.asarray(np.isfinite(camera.undistort(uv)).all(axis=1))
