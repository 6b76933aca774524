"""A cylinder: diameter and form."""

from __future__ import annotations

from core.inspect.cylinder import find_cylinder
from core.inspect.elements import Element
from core.inspect.feature_spec import Auto, FeatureSpec
from core.inspect.features.measured import FeatureResult, Scene
from core.inspect.features.regions import points_in
from core.inspect.features.round import round_result
from core.inspect.surface_fit import fit_surface
from core.inspect.uneven_light import with_uneven_light


def measure_cylinder(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    """Fit a cylinder to the points of the region that lie on one; InputError if they do not."""
    scene.know_normals()
    region, cloud = spec.regions[0], scene.cloud
    indices = points_in(region, spec.filters, scene)
    on, start = find_cylinder(cloud.select(indices), on_table=isinstance(region, Auto), progress=scene.progress)
    filters = spec.filters
    fit = fit_surface(cloud, indices[on], start, scene.errors, tukey=filters.outliers, cell_mm=filters.cell_mm)
    fit = with_uneven_light(fit, cloud, scene.errors)
    return round_result(spec, scene, fit, Element.of_tube(fit))
