"""Two faces of a part, each by itself: its own plane and flatness, and the angle between both."""

from __future__ import annotations

from collections.abc import Callable
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.inspect.faces import FacePair
from core.inspect.fit.form_zone import FormZone
from core.inspect.fit.plane_fit import ParallelPlaneFit, fit_plane
from core.inspect.fit.shapes import ParallelPlanes
from core.inspect.fit.spanned import spanned
from core.inspect.fit.surface_fit import fit_surface
from core.inspect.results import Face
from core.inspect.uncertainty.point_errors import PointErrors
from core.model import LightPlane
from core.model.arrays import Array
from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud
from core.stage_times import stage
from core.threads import ordered_map


def free_faces(
    cloud: Cloud,
    pair: FacePair,
    joint: Callable[[], ParallelPlaneFit],
    errors: PointErrors,
    progress: Progress = silent,
    *,
    tilt_determined: bool,
) -> tuple[Face, Face]:
    """Fit a plane with its flatness to the upper and to the lower face of a `pair`, independently of each other.

    Points that do not span a face leave open how it lies: it is that of the `joint` fit then, without flatness, which
    is asked for only then, or where it is not `tilt_determined`. Both are fitted at once; a StageTimes learns what that
    costs.
    """

    def face(job: tuple[NDArray[np.int64], Callable[[ParallelPlaneFit], float]]) -> Face:
        indices, distance = job
        with stage(progress, "faces"):
            reference = None if tilt_determined else joint().normal
            return _face(cloud, indices, errors, reference, lambda: (joint().normal, distance(joint())))

    upper, lower = ordered_map(
        face, ((pair.upper, attrgetter("upper_distance")), (pair.lower, attrgetter("lower_distance")))
    )
    return upper, lower


def angle_of(upper: Face, lower: Face) -> float | None:
    """Compute the angle in rad, 0 to π/2, between two faces; None if the points of one do not determine its plane."""
    if not (upper.spanned and lower.spanned):
        return None
    cross = np.linalg.norm(np.cross(upper.plane.normal, lower.plane.normal))
    return float(np.arctan2(cross, abs(upper.plane.normal @ lower.plane.normal)))


def _face(
    cloud: Cloud,
    indices: NDArray[np.int64],
    errors: PointErrors,
    reference: Array | None,
    joint: Callable[[], tuple[Array, float]],
) -> Face:
    """A face from its free fit: the points the fit kept, their residuals and the zone of its form.

    `reference` (3,) is the normal for a tilt that the points leave open; `joint` gives that normal, and the distance,
    which the joint fit has.
    """
    points, sigma = cloud.points[indices], cloud.sigma[indices]
    fit = fit_plane(points, sigma, reference_normal=reference)
    kept = fit.weights > 0
    shape = _plane(fit.normal, fit.distance, points[kept])
    if not spanned(shape, points[kept], sigma[kept], np.zeros(int(kept.sum()), dtype=np.int64)):
        normal, distance = joint()
        residuals = distance - points @ normal
        plane = LightPlane.from_normal(normal, distance)
        return Face(plane, indices, residuals, None, _rms(residuals), spanned=False)
    residuals = fit.residuals[kept]
    plane = LightPlane.from_normal(fit.normal, fit.distance)
    form = _form(cloud, indices[kept], shape, errors)
    flatness = (None, None) if form is None else (form.value, form.u)
    return Face(plane, indices[kept], residuals, flatness[0], _rms(residuals), flatness_u_mm=flatness[1])


def _form(cloud: Cloud, indices: NDArray[np.int64], shape: ParallelPlanes, errors: PointErrors) -> FormZone | None:
    """The zone of a face's form; None where its points are too few for it."""
    try:
        return fit_surface(cloud, indices, shape, errors, form_mm=0.0).form
    except InputError:
        return None


def _plane(normal: Array, distance: float, points: Array) -> ParallelPlanes:
    middle = points.mean(axis=0)
    return ParallelPlanes.through(-normal, (middle - normal * (normal @ middle - distance))[None])


def _rms(residuals: Array) -> float:
    return float(np.sqrt(np.mean(residuals**2)))
