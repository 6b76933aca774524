"""A sphere and a cylinder: diameter and form."""

from __future__ import annotations

import numpy as np

from core.errors import InputError
from core.inspect.features.measured import FeatureResult, Scene
from core.inspect.features.regions import grown_at, points_in, sure_enough
from core.inspect.fit.elements import Element
from core.inspect.fit.judged_form import CYLINDER, SPHERE, notes_on_form
from core.inspect.fit.round import find_cylinder, find_sphere, sphere_through, too_few_for_a_sphere, with_uneven_light
from core.inspect.fit.shapes import Cylinder, Sphere
from core.inspect.fit.surface_fit import FEWEST, SurfaceFit, fit_surface
from core.inspect.plan.feature_spec import Auto, FaceAt, FeatureSpec, PointsOf
from core.messages import Message


def measure_sphere(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    """Measure diameter and form of a sphere on the points of the region that lie on one; InputError if none do."""
    scene.ensure_normals()
    region, cloud = spec.regions[0], scene.cloud
    if isinstance(region, FaceAt):
        indices = sure_enough(grown_at(region, scene, "sphere").indices, spec.filters, scene)
    else:
        indices = points_in(region, spec.filters, scene)
    if not isinstance(region, PointsOf | FaceAt):
        part = cloud.select(indices)
        indices = indices[find_sphere(part, on_table=isinstance(region, Auto), progress=scene.progress)]
    if len(indices) < FEWEST:
        raise InputError(
            too_few_for_a_sphere(len(indices)),
            todo=Message("feature.advice_larger_region", "draw a larger region on it"),
        )
    indices, start = np.sort(indices), sphere_through(cloud.points[indices])
    filters = spec.filters
    fit = fit_surface(cloud, indices, start, scene.errors, tukey=filters.outliers, form_mm=filters.cell_mm)
    fit = with_uneven_light(fit, cloud, scene.errors)
    notes = notes_on_form(cloud, indices, fit.shape, scene.errors, (SPHERE,))
    rule = Message("feature.rule_sphere", "diameter of the sphere of least squares, by the points' covariance")
    return _result(spec, scene, fit, Element.of_sphere(fit), rule, notes)


def measure_cylinder(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    """Measure diameter and form of a cylinder on the points of the region that lie on one; InputError if none do."""
    scene.ensure_normals()
    region, cloud, filters = spec.regions[0], scene.cloud, spec.filters
    if isinstance(region, FaceAt):
        grown = grown_at(region, scene, "cylinder")
        indices, start = sure_enough(grown.indices, filters, scene), grown.shape
        assert isinstance(start, Cylinder)
    else:
        indices = points_in(region, filters, scene)
        on, start = find_cylinder(cloud.select(indices), on_table=isinstance(region, Auto), progress=scene.progress)
        indices = indices[on]
    fit = fit_surface(cloud, indices, start, scene.errors, tukey=filters.outliers, form_mm=filters.cell_mm)
    fit = with_uneven_light(fit, cloud, scene.errors)
    notes = notes_on_form(cloud, indices, fit.shape, scene.errors, (CYLINDER,))
    rule = Message("feature.rule_cylinder", "diameter of the cylinder of least squares, by the points' covariance")
    return _result(spec, scene, fit, Element.of_cylinder(fit), rule, notes)


def _result(
    spec: FeatureSpec,
    scene: Scene,
    fit: SurfaceFit[Sphere] | SurfaceFit[Cylinder],
    element: Element,
    rule: Message,
    notes: tuple[Message, ...],
) -> FeatureResult:
    """`rule` of the diameter; `notes` on the form."""
    assert fit.form is not None
    of_form = Message(
        "feature.rule_form_zone",
        "width of the zone of the deviations from the surface over {mm:.1f} mm and more, without the points' noise",
        mm=fit.form.length_mm,
    )
    twice_the_radius = np.append(np.zeros(fit.parameters - 1), 2.0)
    rows = fit.budget(twice_the_radius)
    return FeatureResult(
        spec,
        characteristics=(
            scene.characteristic(spec, "diameter", 2 * fit.shape.radius, rows, rule=rule),
            scene.characteristic(spec, "form", fit.form.value, fit.form.budget, rule=of_form, notes=notes),
        ),
        indices=fit.indices,
        residuals=fit.residuals,
        part=fit.part,
        element=element,
        shape=fit.shape,
    )
