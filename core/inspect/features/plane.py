"""A plane face, its flatness; and a point, the place amid a small piece of surface."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from core.inspect.characteristic import Characteristic
from core.inspect.features.measured import FeatureResult, Scene
from core.inspect.features.regions import face_in, points_in
from core.inspect.fit.elements import Element
from core.inspect.fit.judged_form import FACE, PIECE, notes_on_form
from core.inspect.fit.plane_fit import fit_plane
from core.inspect.fit.shapes import ParallelPlanes
from core.inspect.fit.surface_fit import SurfaceFit, fit_surface
from core.inspect.plan.feature_spec import FeatureSpec, InBox, InSphere
from core.messages import Message


def measure_plane(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    """Fit a plane to the plane face in the feature's region, with its flatness; InputError if there is none."""
    indices = face_in(spec.regions[0], spec.filters, scene)
    fit = _fitted(spec, scene, indices)
    assert fit.form is not None
    rule = Message(
        "feature.rule_flatness_zone",
        "width of the zone of the deviations from the plane over {mm:.1f} mm and more, without the points' noise",
        mm=fit.form.length_mm,
    )
    notes = notes_on_form(scene.cloud, indices, fit.shape, scene.errors, (FACE,))
    flatness = scene.characteristic(spec, "flatness", fit.form.value, fit.form.budget, rule=rule, notes=notes)
    return _result(spec, fit, (flatness,), Element.of_plane(fit))


def measure_point(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    """Measure one point: the middle of the points of a small region, on the plane fitted to them.

    Of that piece of surface the residuals are judged as those of a face; the place itself rests on three numbers of it,
    and of one measured point nothing is left over that could be judged.
    """
    region = spec.regions[0]
    whole = isinstance(region, InSphere | InBox)
    indices = points_in(region, spec.filters, scene) if whole else face_in(region, spec.filters, scene)
    fit = _fitted(spec, scene, indices)
    notes = notes_on_form(scene.cloud, indices, fit.shape, scene.errors, (PIECE,))
    return replace(_result(spec, fit, (), Element.of_plane(fit, "point")), notes=notes)


def _fitted(spec: FeatureSpec, scene: Scene, indices: NDArray[np.int64]) -> SurfaceFit[ParallelPlanes]:
    points = scene.cloud.points[indices]
    centre = points.mean(axis=0)
    if len(points) >= 3:
        plane = fit_plane(points, scene.cloud.sigma[indices])
        start = ParallelPlanes.through(-plane.normal, centre - plane.normal * (plane.normal @ centre - plane.distance))
    else:
        start = ParallelPlanes.through(-centre / np.linalg.norm(centre), centre)
    filters = spec.filters
    return fit_surface(scene.cloud, indices, start, scene.errors, tukey=filters.outliers, form_mm=filters.cell_mm)


def _result(
    spec: FeatureSpec, fit: SurfaceFit[ParallelPlanes], characteristics: tuple[Characteristic, ...], element: Element
) -> FeatureResult:
    return FeatureResult(
        spec,
        characteristics=characteristics,
        indices=fit.indices,
        residuals=fit.residuals,
        part=fit.part,
        element=element,
        shape=fit.shape,
    )
