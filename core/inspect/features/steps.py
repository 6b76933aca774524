"""Step heights: many parallel levels fitted jointly, one common normal and a height for each."""

from __future__ import annotations

import numpy as np

from core.errors import InputError
from core.findings.proof import Doubt
from core.inspect.faces import PARALLEL, SMALLEST_MM2
from core.inspect.features.measured import FeatureResult, Scene
from core.inspect.features.regions import Indices, face_in
from core.inspect.fit.judged_form import level, notes_on_form
from core.inspect.fit.plane_search import search_tolerance
from core.inspect.fit.shapes import ParallelPlanes
from core.inspect.fit.spanned import faces_not_spanned
from core.inspect.fit.surface_fit import fit_surface
from core.inspect.plan.feature_spec import Auto, FeatureSpec
from core.messages import Message


def measure_steps(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    """Measure the heights of parallel levels over the lowest, the farthest from the camera; InputError if but one."""
    faces = _levels(spec, scene)
    indices = np.concatenate(faces)
    part = np.repeat(np.arange(len(faces)), [len(face) for face in faces])
    order = np.argsort(indices, kind="stable")
    indices, part = indices[order], part[order]
    points = scene.cloud.points
    centres = np.array([points[face].mean(axis=0) for face in faces])
    largest = max(faces, key=len)
    normal = np.linalg.svd(points[largest] - points[largest].mean(axis=0), full_matrices=False)[2][2]
    start = ParallelPlanes.through(normal if normal @ centres[0] < 0 else -normal, centres)
    fit = fit_surface(
        scene.cloud,
        indices,
        start,
        scene.errors,
        part=part,
        tukey=spec.filters.outliers,
    )
    names = [level(number + 1) for number in range(len(faces))]
    notes = notes_on_form(scene.cloud, indices, fit.shape, scene.errors, names, part)
    alone = [name for name, spans in zip(names, fit.faces_spanned, strict=True) if not spans]
    doubts = (Doubt.of(faces_not_spanned(alone)),) if alone else ()
    rows = []
    for upper in range(1, len(faces)):
        lower = 0 if spec.over == "lowest" else upper - 1
        height, gradient = fit.shape.height(upper, lower)
        rule = Message(
            "feature.rule_step",
            "distance of level {upper} from level {lower}, parallel planes fitted jointly to all levels",
            upper=upper + 1,
            lower=lower + 1,
        )
        rows.append(
            scene.characteristic(
                spec,
                "height",
                height,
                fit.budget(gradient),
                result=f"height {upper}",
                rule=rule,
                notes=notes if upper == 1 else (),
                doubts=doubts,
            )
        )
    return FeatureResult(
        spec,
        characteristics=tuple(rows),
        indices=fit.indices,
        residuals=fit.residuals,
        part=fit.part,
        shape=fit.shape,
    )


def _levels(spec: FeatureSpec, scene: Scene) -> list[Indices]:
    """Points of each level, the lowest first."""
    if len(spec.regions) == 1 and isinstance(spec.regions[0], Auto):
        faces = _found(spec, scene)
    else:
        faces = [face_in(region, spec.filters, scene) for region in spec.regions]
    if len(faces) < 2:
        raise InputError(
            Message("feature.too_few_levels", "{n} level was found, and a step has two", n=len(faces)),
            todo=Message("feature.advice_scan_levels", "scan the other ones too, or draw a region on each"),
        )
    points = scene.cloud.points
    largest = points[max(faces, key=len)]
    normal = np.linalg.svd(largest - largest.mean(axis=0), full_matrices=False)[2][2]
    normal = normal if normal @ largest.mean(axis=0) > 0 else -normal
    return sorted(faces, key=lambda face: -float(np.median(points[face] @ normal)))


def _found(spec: FeatureSpec, scene: Scene) -> list[Indices]:
    """All faces of the cloud that are parallel to the largest one."""
    allowed = np.inf if spec.filters.sigma_max_mm is None else spec.filters.sigma_max_mm
    planes = [plane for plane in scene.planes(spec.filters.margin_mm) if plane.region.area_mm2 >= SMALLEST_MM2]
    faces: list[Indices] = []
    heights: list[float] = []
    for plane in planes:
        height = plane.distance
        apart = all(abs(height - other) > 2 * search_tolerance(scene.cloud) for other in heights)
        if abs(plane.normal @ planes[0].normal) > np.cos(PARALLEL) and apart:
            found = plane.region.indices
            faces.append(np.sort(found[scene.cloud.sigma[found] <= allowed]))
            heights.append(height)
    return faces
