"""What is left of light that lies unevenly on a curved surface, in the surface fitted: an effect on its parameters.

On a flank a stripe's section is brighter on the side turned to the laser, so its middle is off to there. A scan that is
solved twice has taken that off (`core.scan.uneven_sections`), but for a part. That pulls the flanks, where surface
normal and line of sight make an angle of cosine c, against the top. Radius and centre follow, the further the less of
the surface is seen, by 1/(1 − c): the centre along the line of sight, as far as the radius grows, for the top stays
where it is.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np

from core.inspect.point_errors import PointErrors
from core.inspect.shapes import Ball, Tube
from core.inspect.surface_fit import SurfaceFit
from core.inspect.uncertainty import Effect
from core.model.arrays import Array
from core.scan.cloud import Cloud
from core.scan.normals import pixel_angle

Round = TypeVar("Round", Ball, Tube)

SECTION = 0.8
"""How far a section of light of σ w on a surface of radius R may be off at the flanks, radially, in w²/R: 2 to 3 on
rendered spheres of 50 mm as they are seen, of which a third at most is left where the scan was solved twice."""
LEAST_SEEN = 0.1
"""1 − c of what is seen of a surface is taken to be at least this."""
UNEVEN_LIGHT = "light that lies unevenly on the curved surface"


def with_uneven_light(fit: SurfaceFit[Round], cloud: Cloud, errors: PointErrors) -> SurfaceFit[Round]:
    """The fit to points of `cloud`, as unsure as uneven light makes it; as it is where the stripes' σ is not known."""
    if not errors.stripe_px > 0:
        return fit
    used = cloud.select(fit.indices)
    outward = fit.shape.outward(used.points, fit.part)
    cosine = np.abs((outward * used.points).sum(axis=1)) / np.linalg.norm(used.points, axis=1)
    width = errors.stripe_px * pixel_angle(used.points, used.uv) * float(np.median(used.points[:, 2]))
    at_flank = SECTION * width**2 / fit.shape.radius
    grown = at_flank / max(1 - float(np.quantile(cosine, 0.05)), LEAST_SEEN)
    effect = Effect(UNEVEN_LIGHT, grown * _moved(fit.shape)[:, None], shared=False, point_mm=at_flank)
    return replace(fit, effects=(*fit.effects, effect))


def _moved(shape: Ball | Tube) -> Array:
    """(p,) how the parameters follow when the radius grows by 1 and the top stays where it is."""
    away = shape.centre / np.linalg.norm(shape.centre)
    if isinstance(shape, Ball):
        return np.append(away, 1.0)
    return np.concatenate([away @ shape.axes, np.zeros(2 if shape.turns else 0), [1.0]])
