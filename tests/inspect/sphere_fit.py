"""A sphere fitted to a cloud by itself, without a plan."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.inspect.fit.plane_search import POINT_CLOUD
from core.inspect.fit.round import find_sphere, sphere_through, too_few_for_a_sphere, with_uneven_light
from core.inspect.fit.shapes import Sphere
from core.inspect.fit.surface_fit import FEWEST, SurfaceFit, fit_surface
from core.inspect.results import Contribution
from core.inspect.uncertainty.budget import combined
from core.inspect.uncertainty.point_errors import PointErrors
from core.model.arrays import Array
from core.scan.surface.cloud import Cloud


@dataclass(frozen=True, eq=False, slots=True)
class SphereFit:
    """A sphere: `centre` (3,) and `radius_mm` in mm, camera frame, with `u_mm` the radius's standard uncertainty.

    `indices` into the cloud of the points used; `residuals` (mm) of these, outwards positive; `form_mm` is the zone of
    its form, free of the points' noise, and `u_form_mm` the standard uncertainty of
    that spread; `budget` says what `u_mm` is made of, and `fit` all that is known of the fitted surface.
    """

    centre: Array
    radius_mm: float
    u_mm: float
    form_mm: float
    indices: NDArray[np.int64]
    residuals: Array
    budget: tuple[Contribution, ...]
    u_form_mm: float
    fit: SurfaceFit[Sphere]

    @property
    def diameter_mm(self) -> float:
        """Twice the radius; its standard uncertainty is twice the radius's."""
        return 2 * self.radius_mm


def fit_sphere(
    cloud: Cloud,
    indices: NDArray[np.int64] | None = None,
    *,
    errors: PointErrors | None = None,
    seed: int = 0,
) -> SphereFit:
    """Robust fit of a sphere by least orthogonal distances, with the true covariance of its points.

    Tukey's biweight says which points belong to it; the generalised fit of `core.inspect.fit.generalised` follows.

    Parameters
    ----------
    cloud
        The measured points.
    indices
        Of the points on the sphere; None: found by `find_sphere`.
    errors
        How the points' errors hang together; None: each stretch of a stripe by itself.
    seed
        Of the search.

    Raises
    ------
    InputError
        If there is no sphere, or fewer than 12 points on it.
    """
    indices = find_sphere(cloud, seed=seed) if indices is None else indices
    if len(indices) < FEWEST:
        raise InputError(
            too_few_for_a_sphere(len(indices)),
            where=POINT_CLOUD,
        )
    errors = errors or PointErrors()
    fit = fit_surface(cloud, indices, sphere_through(cloud.points[indices]), errors, form_mm=0.0)
    fit = with_uneven_light(fit, cloud, errors)
    assert fit.form is not None
    rows = fit.budget(np.array([0.0, 0.0, 0.0, 1.0]))
    sphere = fit.shape
    return SphereFit(
        sphere.centre, sphere.radius, combined(rows), fit.form.value, fit.indices, fit.residuals, rows, fit.form.u, fit
    )
