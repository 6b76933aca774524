"""Whether points span a surface: whether it is fixed by where they lie, or but by their noise.

Points of one stripe lie in its light plane, exactly: a plane through them is the light plane, whatever they lie on, and
the rms of its residuals is 0. What fixes a shape are the differences of its design matrix from point to point
(`core.inspect.fit.shapes`); with the points' own uncertainty the matrix is uncertain as well. A shape is fixed only if
each combination of its parameters moves the points by several times as much as their noise alone makes it seem to::

    min_v |D v| / |N v| ≥ SPANNED_SIGMAS,    |N v|² = Σ_p σ_p² |∂(D v)_p / ∂X_p|²

For a plane that is the spread of its points in its narrowest direction over their σ.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import eigh

from core.findings.table import note_of
from core.inspect.fit.shapes import Parts, Shape
from core.messages import Command, Message
from core.model.arrays import Array

SPANNED_SIGMAS = 5.0
"""Of points of one stripe the ratio is 0.2 to 3, of a section 1 mm wide 8, of two stripes a few mm apart 50."""
_STEP_MM = 1e-4
"""By which points are moved to see how the design follows."""
_SINGULAR = 1e-12
"""Of a design of unit columns: below, a combination of parameters does not move the points at all."""


def spanned(shape: Shape, points: Array, sigma: Array, part: Parts) -> bool:
    """Whether `points` (N, 3) in mm determine all parameters of a shape in spite of their noise `sigma` (N,).

    Parameters
    ----------
    shape
        As it was fitted to them.
    points, sigma
        (N, 3) in mm in the camera frame, and the standard uncertainty (N,) of their depths in mm.
    part
        (N,) which face each is on; a face without points is not asked for.
    """
    design = shape.design(points, part)
    size = np.linalg.norm(design, axis=0)
    moving = size > 0
    design, noise = design[:, moving] / size[moving], np.zeros((int(moving.sum()),) * 2)
    for axis in np.eye(3):
        moved = shape.design(points + _STEP_MM * axis, part)[:, moving] / size[moving]
        by_noise = sigma[:, None] * (moved - design) / _STEP_MM
        noise += by_noise.T @ by_noise
    signal = design.T @ design
    signal[np.diag_indices(len(signal))] += _SINGULAR
    worst = float(eigh(noise, signal, eigvals_only=True)[-1])
    return worst * SPANNED_SIGMAS**2 <= 1


def faces_not_spanned(names: Sequence[Message]) -> Message:
    """Make the note that results on the faces called `names` prove nothing, as their points fix no surface."""
    return note_of("surface.faces_not_spanned", name=list(names), command=Command("--sigma-cut MM"))
