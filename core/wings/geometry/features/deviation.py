"""The deviation of a part from its nominal surface: a map, and what it comes to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.inspect.causes import Cause
from core.inspect.characteristic import Characteristic
from core.inspect.features.measured import FeatureResult, Scene
from core.inspect.features.regions import points_in
from core.inspect.fit.judged_form import notes_on_deviation
from core.inspect.fit.plane_search import search_tolerance
from core.inspect.fit.surface_fit import u_of_quantiles
from core.inspect.plan.alignment import best_fit
from core.inspect.plan.feature_spec import Deviation, FeatureSpec
from core.inspect.results import Contribution
from core.inspect.shown.deviation_map import DeviationMap
from core.inspect.uncertainty.budget import budget
from core.inspect.uncertainty.error_sources import GRAZING, Sources
from core.inspect.uncertainty.point_errors import patches
from core.messages import Message
from core.model import Pose
from core.model.arrays import Array
from core.scan.surface.cloud import Cloud
from core.scan.surface.triangles import Nearest, ProximityQuery, Triangles

MOST_POINTS = 40_000
"""Points of the cloud that the figures rest on, spread evenly over it."""
TABLE = 1.2
"""A plane larger than the part by this factor is what it stands on."""
ALIKE = 0.5
"""Points whose surface faces more than 60° elsewhere than the nominal one are of another side."""
FEWEST = 12
"""Points: twice the six freedoms of an alignment."""
LARGEST = 0.95
"""Share of the points whose deviations a profile deviation holds."""


def measure_deviation(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    """Align a nominal surface with the scan and measure the deviation; InputError if it fails or none was read."""
    if spec.deviation is None or spec.deviation.nominal not in scene.nominals:
        raise InputError(
            Message("feature.nominal_not_read", "its nominal surface was not read"),
            todo=Message("feature.advice_name_nominal", "name a STEP file, or an STL file in mm"),
        )
    asked, nominal = spec.deviation, scene.nominals[spec.deviation.nominal]
    indices = points_in(spec.regions[0], spec.filters, scene)
    indices = indices[_above_table(scene.cloud.points[indices], nominal, scene)]
    query = ProximityQuery(nominal)
    pose = _pose(asked, query, indices, scene)
    step = max(1, len(indices) // MOST_POINTS)
    used = indices[::step]
    cloud = scene.cloud.select(used)
    near = query.nearest(pose.inverse().apply(cloud.points), asked.reach_mm)
    kept = _facing(cloud.normals, near, pose) & (np.abs(near.distance) <= asked.reach_mm)
    if kept.sum() < FEWEST:
        raise InputError(
            Message(
                "feature.few_points_near_nominal",
                "{n} measured points lie within {reach_mm:g} mm of the nominal surface",
                n=kept.sum(),
                reach_mm=asked.reach_mm,
            ),
            todo=Message("feature.advice_alignment_or_reach", "check the alignment, or allow a larger reach_mm"),
        )
    used, cloud, deviation = used[kept], cloud.select(kept), near.distance[kept]
    normals = near.normal[kept] @ pose.rotation.T
    rows = _characteristics(spec, scene, cloud, deviation, normals)
    return FeatureResult(
        spec,
        characteristics=rows,
        indices=used,
        residuals=deviation,
        part=np.zeros(len(used), dtype=np.int64),
        deviations=_map(asked, scene, query, pose, (used, cloud, deviation, normals)),
    )


def _pose(asked: Deviation, query: ProximityQuery, indices: NDArray[np.int64], scene: Scene) -> Pose:
    """The nominal surface's coordinates into the camera frame."""
    if asked.align == "as measured":
        return Pose.identity()
    if asked.align == "frame":
        if scene.pose_camera_part is None:
            raise InputError(
                Message("feature.no_part_coordinates_to_align", "there are no part coordinates to align it by"),
                todo=Message("feature.advice_give_frame", "give the plan a frame"),
            )
        return scene.pose_camera_part
    planes = scene.planes(0.0)
    up = -planes[0].normal if planes else np.array([0.0, 0.0, -1.0])
    if len(indices) < FEWEST:
        raise InputError(
            Message(
                "feature.only_a_plane_scanned",
                "nothing but a plane was scanned, so there is no part to lay the nominal surface on",
            )
        )
    return best_fit(scene.cloud.points[indices], up, query, scene.progress).pose_camera_nominal


def _above_table(points: Array, nominal: Triangles, scene: Scene) -> NDArray[np.bool_]:
    """Which points (N, 3) are not on what the part stands on: a plane much larger than the part."""
    planes = scene.planes(0.0)
    table = scene.cloud.points[planes[0].region.indices] if planes else np.zeros((1, 3))
    if np.linalg.norm(np.ptp(table, axis=0)) <= TABLE * nominal.size_mm:
        return np.ones(len(points), dtype=np.bool_)
    height = planes[0].distance - points @ planes[0].normal
    return np.asarray(height > 3 * search_tolerance(scene.cloud))


def _facing(normals: Array, near: Nearest, pose: Pose) -> NDArray[np.bool_]:
    """Which points' surfaces do not face elsewhere than the nominal one does; unknown normals face anywhere."""
    cosine = (normals * (near.normal @ pose.rotation.T)).sum(axis=1)
    return np.asarray((cosine > ALIKE) | ~normals.any(axis=1))


def _characteristics(
    spec: FeatureSpec, scene: Scene, cloud: Cloud, deviation: Array, normals: Array
) -> tuple[Characteristic, ...]:
    """Profile deviation and mean deviation, with what the alignment cannot see taken out of their uncertainty."""
    one = np.zeros(len(cloud), dtype=np.int64)
    sources = Sources.of(cloud, normals, np.ones(len(cloud)), one, patches(cloud.uv, one), scene.errors)
    calibrations = scene.errors.calibrations
    fitted = spec.deviation is not None and spec.deviation.align == "best fit"
    size = np.abs(deviation)
    largest = float(np.quantile(size, LARGEST))
    ranks = np.argsort(np.argsort(size)) / max(len(size) - 1, 1)
    at_end = np.abs(ranks - LARGEST) <= 0.01
    gains = {
        "profile": 2 * np.where(at_end, np.sign(deviation), 0.0) / max(int(at_end.sum()), 1),
        "mean": np.full(len(deviation), 1 / len(deviation)),
    }
    rows = {}
    for name, gain in gains.items():
        of_stretch = np.asarray(np.bincount(sources.stretch, gain, minlength=len(sources.own)), dtype=np.float64)
        if fitted:
            of_stretch = _without_alignment(of_stretch, sources, cloud, normals)
        rows[name] = budget(of_stretch, sources, calibrations=calibrations)
    stripe = np.unique(cloud.sweep, return_inverse=True)[1]
    sampled = {"profile": u_of_quantiles(size, (LARGEST,), (2.0,), stripe), "mean": _u_of_mean(deviation, stripe)}
    for name in ("profile", "mean") if fitted else ("profile",):  # what is common to the stripes the alignment takes
        own = [row for row in rows[name] if row.source in calibrations]
        rows[name] = (Contribution(Cause.SAMPLING, sampled[name]), *own)
    if spec.deviation is not None and (chord_mm := scene.nominals[spec.deviation.nominal].chord_mm):
        u_mm = chord_mm / np.sqrt(3)  # anything within it, to either side
        rows = {
            name: (*rows[name], Contribution(Cause.FACETS, times * u_mm))
            for name, times in (("profile", 2), ("mean", 1))
        }
    profile = Message(
        "feature.rule_profile", "twice the deviation from the nominal surface that 95 % of the points do not exceed"
    )
    mean = Message("feature.rule_mean_deviation", "mean deviation from the nominal surface")
    return (
        scene.characteristic(
            spec,
            "profile",
            2 * largest,
            rows["profile"],
            rule=profile,
            notes=notes_on_deviation(cloud, deviation, normals, scene.errors),
        ),
        scene.characteristic(spec, "mean", float(np.mean(deviation)), rows["mean"], rule=mean),
    )


def _u_of_mean(deviation: Array, stripe: NDArray[np.int64]) -> float:
    """Standard uncertainty of a mean over stripes that err by themselves: of a ratio of sums, by its residuals."""
    left = np.bincount(stripe, deviation - deviation.mean())
    return float(np.sqrt(np.sum(left**2) * len(left) / max(len(left) - 1, 1)) / len(deviation))


def _without_alignment(gain: Array, sources: Sources, cloud: Cloud, normals: Array) -> Array:
    """Gains (J,) after the part has been moved as a whole to where it fits best: such errors do no harm."""
    middle = cloud.points.mean(axis=0)
    design = sources.mean(np.hstack([normals, np.cross(cloud.points - middle, normals)]))
    design = design / np.maximum(np.linalg.norm(design, axis=0), 1e-12)
    weight = np.bincount(sources.stretch, minlength=len(sources.own)).astype(np.float64)
    moved = np.linalg.lstsq((design * weight[:, None]).T @ design, design.T @ gain, rcond=None)[0]
    return np.asarray(gain - weight * (design @ moved))


def _map(
    asked: Deviation,
    scene: Scene,
    query: ProximityQuery,
    pose: Pose,
    points: tuple[NDArray[np.int64], Cloud, Array, Array],
) -> DeviationMap:
    """Over the mesh's measured vertices, or over the points where there is no mesh."""
    nominal = query.surface.moved(pose.rotation, pose.translation).corners
    if scene.mesh is None or not len(scene.mesh.vertices):
        used, cloud, deviation, normals = points
        sigma = cloud.sigma * _slant(cloud.points, normals)
        return DeviationMap(cloud.points, used, deviation, sigma, asked.tolerance_mm, pose, nominal)
    mesh = scene.mesh
    mine = np.flatnonzero(mesh.measured & _above_table(mesh.vertices, query.surface, scene))
    near = query.nearest(pose.inverse().apply(mesh.vertices[mine]), asked.reach_mm)
    close = _facing(mesh.normals[mine], near, pose) & (np.abs(near.distance) <= asked.reach_mm)
    kept = mine[close]
    normals = near.normal[close] @ pose.rotation.T
    sigma = mesh.sigma[kept] * _slant(mesh.vertices[kept], normals)
    return DeviationMap(mesh.vertices[kept], kept, near.distance[close], sigma, asked.tolerance_mm, pose, nominal)


def _slant(points: Array, normals: Array) -> Array:
    """How much of an error of depth lies across the surface."""
    return np.asarray(np.maximum(np.abs((normals * points).sum(axis=1)) / points[:, 2], GRAZING))
