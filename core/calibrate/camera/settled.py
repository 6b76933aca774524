"""Whether a camera was solved to the end: by what a further step would still change.

Judged is the calibration as it is kept, views, poses and shape of the target, so that of a file of an earlier version,
which does not say so, it is known as well.
"""

from __future__ import annotations

import numpy as np

from core.calibrate.camera.bundle import Bundle, Observed, normal_equations
from core.calibrate.camera.reprojection import parameters_of
from core.calibrate.results import CameraCalibration

SETTLED = 0.1
"""A step by less than this share of a parameter's standard deviation adds half a per cent to U at most."""


def has_settled(calibration: CameraCalibration) -> bool | None:
    """Whether the calibration has converged: one more Gauss–Newton step changes little; None if it keeps no views.

    A parameter of the value 0 has been held there, whatever its standard deviation.
    """
    camera, used = calibration.camera, [one for one in calibration.views if one.used]
    deviation = np.sqrt(np.maximum(np.diag(calibration.covariance), 0))
    free = np.flatnonzero((deviation > 0) & (parameters_of(camera) != 0))
    if not used or not len(free):
        return None
    views = []
    for one in used:
        view = Observed(calibration.board.shaped(one.view.points), one.view.uv, one.view.sigma**-2.0)
        views.append(view.select(one.counted) if len(one.counted) else view)
    try:
        normal = normal_equations(Bundle(camera, tuple(one.pose for one in used)), views, free)
        gradient = np.sum([own.sum(axis=0) for own in normal.gradients], axis=0)
        information = normal.information.sum(axis=0)
        unit = 1 / np.sqrt(np.maximum(np.diag(information), 1e-300))
        step = unit * np.linalg.solve(information * np.outer(unit, unit), unit * gradient)
    except np.linalg.LinAlgError:
        return False  # there is no such step
    return bool((np.abs(step) < SETTLED * deviation[free]).all())
