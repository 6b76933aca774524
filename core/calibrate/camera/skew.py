"""Whether a camera's skew γ is worth solving for: only where it predicts views that had no part in solving for it.

A γ that is many of its σ away from zero may still be nothing: what else is wrong (a curled board, a lens that the model
does not have) goes into whatever is free. Then it does not help with views it has not seen.

Of the two models the simpler one is kept unless the other foretells surely better, by MANY_ERRORS standard errors of
the mean gain: in the manner of the one-standard-error rule. Nothing is lost by it: a skew that is there and too small
to show is in the uncertainty of the camera without it (`core.calibrate.camera.calibration`).

References
----------
Breiman, L. et al., Classification and Regression Trees (1984), §3.4.3 (the one-standard-error rule).
Stone, M., Cross-validatory choice and assessment of statistical predictions, J. R. Stat. Soc. B 36 (1974) 111–147,
doi:10.1111/j.2517-6161.1974.tb00994.x.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from core.calibrate.camera.bundle import NO_PARAMETERS, Bundle, Observed, refine, residuals
from core.calibrate.results import CAMERA_PARAMETERS

SKEW = CAMERA_PARAMETERS.index("gamma")

PARTS = 5
"""The views are left out a fifth at a time."""

FEWEST_VIEWS = 6
"""With fewer views each fifth is one view at most, and the cameras of the others hardly determined."""

MANY_ERRORS = 2.0
"""Standard errors of the mean gain that are hardly chance: 2 in 100 above it."""


def skew_helps(solved: Bundle, counted: Sequence[Observed], free: NDArray[np.intp]) -> bool:
    """Whether a camera with skew predicts views left out of its fit better than one without skew.

    `free` are the free parameters with the skew among them. A left-out view's pose is fitted to all its corners, for
    nothing else can tell it; what is compared is the mean square of its residuals, view by view, relative to that
    without skew: the gain must be above zero by MANY_ERRORS of its standard errors, told by how much the views differ.
    False with fewer than FEWEST_VIEWS views.
    """
    if len(counted) < FEWEST_VIEWS:
        return False
    gains = np.zeros(len(counted))
    numbers = np.arange(len(counted))
    for part in range(PARTS):
        rest, left = numbers[numbers % PARTS != part], numbers[numbers % PARTS == part]
        with_skew, without = (
            _misfits(_solved_from(solved, counted, rest, parameters), solved, counted, left)
            for parameters in (free, free[free != SKEW])
        )
        gains[left] = 1 - with_skew / np.maximum(without, 1e-300)
    error = gains.std(ddof=1) / np.sqrt(len(gains))
    return bool(gains.mean() > MANY_ERRORS * error)


def _solved_from(
    solved: Bundle, counted: Sequence[Observed], views: NDArray[np.intp], free: NDArray[np.intp]
) -> Bundle:
    start = solved.of_views(list(views))
    if SKEW not in free:
        matrix = start.camera.matrix.copy()
        matrix[0, 1] = 0.0
        start = replace(start, camera=replace(start.camera, matrix=matrix))
    return refine(start, [counted[i] for i in views], free, tolerance=1e-8)


def _misfits(
    trained: Bundle, solved: Bundle, counted: Sequence[Observed], views: NDArray[np.intp]
) -> NDArray[np.float64]:
    """Weighted mean square residual of each of `views`, at the pose that suits it best before the `trained` camera."""
    observed = [counted[i] for i in views]
    fitted = refine(Bundle(trained.camera, tuple(solved.poses[i] for i in views)), observed, NO_PARAMETERS, 1e-8)
    return np.array(
        [
            float(np.mean(view.weights * (residuals(fitted.camera, pose, view) ** 2).sum(axis=1)))
            for pose, view in zip(fitted.poses, observed, strict=True)
        ]
    )
