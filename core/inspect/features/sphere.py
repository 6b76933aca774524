"""A sphere: diameter and form."""

from __future__ import annotations

import numpy as np

from core.errors import InputError
from core.inspect.elements import Element
from core.inspect.feature_spec import Auto, FeatureSpec, PointsOf
from core.inspect.features.measured import FeatureResult, Scene
from core.inspect.features.regions import points_in
from core.inspect.features.round import round_result
from core.inspect.sphere import find_sphere, through
from core.inspect.surface_fit import FEWEST, fit_surface
from core.inspect.uneven_light import with_uneven_light


def measure_sphere(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    """Fit a sphere to the points of the region that lie on one; InputError if they do not."""
    scene.know_normals()
    region, cloud = spec.regions[0], scene.cloud
    indices = points_in(region, spec.filters, scene)
    if not isinstance(region, PointsOf):
        part = cloud.select(indices)
        indices = indices[find_sphere(part, on_table=isinstance(region, Auto), progress=scene.progress)]
    if len(indices) < FEWEST:
        raise InputError(f"{len(indices)} points are too few for a sphere", todo="draw a larger region on it")
    start = through(cloud.points[indices])
    filters = spec.filters
    fit = fit_surface(cloud, np.sort(indices), start, scene.errors, tukey=filters.outliers, cell_mm=filters.cell_mm)
    fit = with_uneven_light(fit, cloud, scene.errors)
    return round_result(spec, scene, fit, Element.of_ball(fit))
