"""What a round feature, a sphere or a cylinder, gives: diameter and form."""

from __future__ import annotations

import numpy as np

from core.inspect.elements import Element
from core.inspect.feature_spec import FeatureSpec
from core.inspect.features.measured import FeatureResult, Scene
from core.inspect.shapes import Ball, Tube
from core.inspect.surface_fit import SurfaceFit


def round_result(
    spec: FeatureSpec,
    scene: Scene,
    fit: SurfaceFit[Ball] | SurfaceFit[Tube],
    element: Element,
) -> FeatureResult:
    """The result of a fitted round surface."""
    twice_the_radius = np.append(np.zeros(fit.parameters - 1), 2.0)
    rows = fit.budget(twice_the_radius)
    rule = f"diameter of the {spec.kind} of least squares, by the points' covariance"
    form_rule = f"range that holds 95 % of the deviations from the {spec.kind}"
    return FeatureResult(
        spec,
        characteristics=(
            scene.characteristic(spec, "diameter", 2 * fit.shape.radius, rows, rule=rule),
            scene.characteristic(spec, "form", fit.form.value, fit.form.budget, rule=form_rule),
        ),
        indices=fit.indices,
        residuals=fit.residuals,
        part=fit.part,
        element=element,
        shape=fit.shape,
    )
