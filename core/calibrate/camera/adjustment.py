"""Adjustment of camera, poses and the board's shape to the views and corners that fit together; its options.

The plain least-squares solution and the judgement of views and corners follow each other until the judgement stands.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from core.calibrate.board_shape import SHAPE_PARAMETERS, Board, BoardTolerance
from core.calibrate.camera.board_fit import BoardFit
from core.calibrate.camera.bundle import NO_PARAMETERS, Bundle, Observed, refine, refine_robustly, residual_lengths
from core.calibrate.camera.options import CameraOptions
from core.calibrate.camera.screening import Verdict, judge
from core.calibrate.results import CAMERA_PARAMETERS

LEAST_VIEWS = 3
"""Of a flat target, for all of A with its skew (Zhang 2000, §3.1)."""
_MOST_JUDGEMENTS = 8
"""Rounds of solving and judging views at most; mostly two."""
_SHAPE_STEPS = 4
"""Gauss–Newton steps of the board's shape at most: it is nearly linear."""
_SHAPE_SETTLED = 1e-4
"""Step, as a share of the parameters' prior standard deviations, below which the shape is found."""


def free_parameters(options: CameraOptions) -> NDArray[np.intp]:
    """Return the indices (F,) in CAMERA_PARAMETERS of the parameters that these options leave to be solved for."""
    zero = options.fixed | ({"gamma"} if options.skew is False else set()) | (set() if options.k3 else {"k3"})
    return np.array([i for i, name in enumerate(CAMERA_PARAMETERS) if name not in zero], dtype=np.intp)


def counted_observations(observed: Sequence[Observed], verdicts: Sequence[Verdict]) -> tuple[list[int], list[Observed]]:
    """Select the views that the `verdicts` use, as their indices and as their observations of the counted corners."""
    used = [i for i, verdict in enumerate(verdicts) if verdict.used]
    return used, [observed[i].select(verdicts[i].counted) for i in used]


def solve_judged(start: Bundle, observed: Sequence[Observed], options: CameraOptions) -> tuple[Bundle, list[Verdict]]:
    """Solve for camera and poses by least squares, and judge views and corners by the residuals, until both stay."""
    bundle = start
    verdicts = judge(residual_lengths(bundle, observed), [True] * len(observed), options.outliers)
    for _ in range(_MOST_JUDGEMENTS):
        used = [verdict.used for verdict in verdicts]
        if sum(used) < LEAST_VIEWS:
            break
        bundle = _fit(bundle, observed, verdicts, free_parameters(options))
        before, verdicts = verdicts, judge(residual_lengths(bundle, observed), used, options.outliers)
        if all(
            a.used == b.used and np.array_equal(a.counted, b.counted) for a, b in zip(before, verdicts, strict=True)
        ):
            break
    return bundle, verdicts


def _fit(start: Bundle, observed: Sequence[Observed], verdicts: Sequence[Verdict], free: NDArray[np.intp]) -> Bundle:
    """The camera from the views that are used, and every view's pose before that camera."""
    used, counted = counted_observations(observed, verdicts)
    solved = refine(start.of_views(used), counted, free)
    poses = dict(zip(used, solved.poses, strict=True))
    for i, view in enumerate(observed):
        if i not in poses:
            alone = Bundle(solved.camera, (start.poses[i],))
            poses[i] = refine_robustly(alone, [view], NO_PARAMETERS).poses[0]
    return Bundle(solved.camera, tuple(poses[i] for i in range(len(observed))))


def with_shape(
    flat: Bundle,
    verdicts: list[Verdict],
    observed: Sequence[Observed],
    options: CameraOptions,
    tolerance: BoardTolerance,
) -> tuple[BoardFit, Bundle, list[Verdict]]:
    """Solve for the board's shape beside the camera, from the solution for a `flat` board, and judge the views again.

    Returns the board, the solution and the verdicts; those given where no shape is to be solved for, or too few views
    are used.
    """
    fit = BoardFit(Board.of([view.points for view in observed]), tolerance, np.zeros(len(SHAPE_PARAMETERS)))
    used, counted = counted_observations(observed, verdicts)
    if not len(fit.free) or len(used) < LEAST_VIEWS:
        return fit, flat, verdicts
    free = free_parameters(options)
    freedom = freedom_of(counted, free)
    bundle = flat
    try:
        for _ in range(_SHAPE_STEPS):
            before = fit.values
            fit = fit.step(bundle.of_views(used), counted, free, freedom)
            bundle = _fit(bundle, fit.shaped(observed), verdicts, free)
            if (np.abs(fit.values - before)[fit.free] < _SHAPE_SETTLED * tolerance.sd[fit.free]).all():
                break
        unsure = False
        if tolerance.flatness_mm is None:
            covariance, _ = fit.covariance(bundle.of_views(used), counted, free, freedom)
            unsure = not fit.shape(covariance, len(free)).surely_bowed
    except np.linalg.LinAlgError:
        unsure = True
    if unsure:
        return with_shape(flat, verdicts, observed, options, replace(tolerance, flatness_mm=0.0))
    bundle, verdicts = solve_judged(bundle, fit.shaped(observed), options)
    return fit, bundle, verdicts


def freedom_of(counted: Sequence[Observed], free: NDArray[np.intp]) -> int:
    """Compute the degrees of freedom: two for each corner counted, less the `free` parameters and six for each pose."""
    return 2 * sum(len(view.points) for view in counted) - len(free) - 6 * len(counted)
