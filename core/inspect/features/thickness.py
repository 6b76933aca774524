"""The thickness of a part: distance of two parallel faces, as `core.inspect.gauge` measures it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.errors import InputError
from core.inspect.characteristic import thickness_characteristic
from core.inspect.faces import FacePair, find_faces
from core.inspect.features.measured import FeatureResult, Scene
from core.inspect.features.regions import face_in
from core.inspect.gauge import measure_gauge
from core.inspect.plan.feature_spec import Auto, FeatureSpec
from core.messages import Message


def measure_thickness(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    """Measure the thickness between the faces in two regions (upper, lower), or the two largest parallel faces."""
    scene.ensure_normals()
    gauge = measure_gauge(
        scene.cloud, errors=scene.errors, regions=_faces(spec, scene), k=scene.k, progress=scene.progress
    )
    row = thickness_characteristic(gauge)
    row = replace(row, name=f"{spec.name} thickness", limits=spec.limits_of("thickness"))
    faces = (gauge.upper, gauge.lower)
    indices = np.concatenate([face.indices for face in faces])
    part = np.repeat([0, 1], [len(face.indices) for face in faces])
    order = np.argsort(indices, kind="stable")
    return FeatureResult(
        spec,
        characteristics=(row,),
        indices=indices[order],
        residuals=np.concatenate([face.residuals for face in faces])[order],
        part=part[order],
        chosen_by_nominal=bool(gauge.candidates),
    )


def _faces(spec: FeatureSpec, scene: Scene) -> FacePair | None:
    cloud, filters = scene.cloud, spec.filters
    if len(spec.regions) == 2:
        upper, lower = (face_in(region, filters, scene) for region in spec.regions)
        return FacePair(upper, lower)
    if not isinstance(spec.regions[0], Auto):
        raise InputError(
            Message("feature.thickness_regions", "a thickness has two regions, the upper and the lower face"),
            todo=Message("feature.advice_both_regions", "give both, or none"),
        )
    allowed, limits = np.inf if filters.sigma_max_mm is None else filters.sigma_max_mm, spec.limits_of("thickness")
    kept = np.flatnonzero(cloud.sigma <= allowed)
    nominal_mm = None if limits is None else limits.nominal
    pair = find_faces(cloud.select(kept), margin_mm=filters.margin_mm, nominal_mm=nominal_mm, progress=scene.progress)
    return replace(pair, upper=kept[pair.upper], lower=kept[pair.lower])
