"""Camera and poses from the views and corners that fit together, and the board's shape beside them.

The plain least-squares solution and the judgement of views and corners follow each other until the judgement stands.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from core.calibrate.board_fit import BoardFit
from core.calibrate.board_shape import SHAPE_PARAMETERS, Board, BoardTolerance
from core.calibrate.bundle import NO_PARAMETERS, Bundle, Observed, refine, refine_robustly, residual_lengths
from core.calibrate.camera_options import CameraOptions
from core.calibrate.screening import Verdict, judge

MIN_VIEWS = 3
_MAX_JUDGEMENTS = 8
_SHAPE_STEPS = 4
_SHAPE_SETTLED = 1e-4


def what_counts(observed: Sequence[Observed], verdicts: Sequence[Verdict]) -> tuple[list[int], list[Observed]]:
    """Indices of the views that are used, and of each of them the corners that count."""
    used = [i for i, verdict in enumerate(verdicts) if verdict.used]
    return used, [observed[i].select(verdicts[i].counted) for i in used]


def solve_judged(start: Bundle, observed: Sequence[Observed], options: CameraOptions) -> tuple[Bundle, list[Verdict]]:
    """Least squares on the views and corners that count, judged again until the judgement stands."""
    bundle = start
    verdicts = judge(residual_lengths(bundle, observed), [True] * len(observed), options.outliers)
    for _ in range(_MAX_JUDGEMENTS):
        used = [verdict.used for verdict in verdicts]
        if sum(used) < MIN_VIEWS:
            break
        bundle = _fit(bundle, observed, verdicts, options.free)
        before, verdicts = verdicts, judge(residual_lengths(bundle, observed), used, options.outliers)
        if all(
            a.used == b.used and np.array_equal(a.counted, b.counted) for a, b in zip(before, verdicts, strict=True)
        ):
            break
    return bundle, verdicts


def _fit(start: Bundle, observed: Sequence[Observed], verdicts: Sequence[Verdict], free: NDArray[np.intp]) -> Bundle:
    """The camera from the views that are used, and every view's pose before that camera."""
    used, counted = what_counts(observed, verdicts)
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
    """The board's shape beside the camera, from the solution with a `flat` board; the views are judged once more."""
    fit = BoardFit(Board.of([view.points for view in observed]), tolerance, np.zeros(len(SHAPE_PARAMETERS)))
    used, counted = what_counts(observed, verdicts)
    if not len(fit.free) or len(used) < MIN_VIEWS:
        return fit, flat, verdicts
    freedom = freedom_of(counted, options.free)
    bundle = flat
    try:
        for _ in range(_SHAPE_STEPS):
            before = fit.values
            fit = fit.step(bundle.of_views(used), counted, options.free, freedom)
            bundle = _fit(bundle, fit.shaped(observed), verdicts, options.free)
            if (np.abs(fit.values - before)[fit.free] < _SHAPE_SETTLED * tolerance.sd[fit.free]).all():
                break
        unsure = False
        if tolerance.flatness_mm is None:
            covariance, _ = fit.covariance(bundle.of_views(used), counted, options.free, freedom)
            unsure = not fit.shape(covariance, len(options.free)).surely_bowed
    except np.linalg.LinAlgError:
        unsure = True
    if unsure:
        return with_shape(flat, verdicts, observed, options, replace(tolerance, flatness_mm=0.0))
    bundle, verdicts = solve_judged(bundle, fit.shaped(observed), options)
    return fit, bundle, verdicts


def freedom_of(counted: Sequence[Observed], free: NDArray[np.intp]) -> int:
    """Observations less unknowns of camera and poses."""
    return 2 * sum(len(view.points) for view in counted) - len(free) - 6 * len(counted)
