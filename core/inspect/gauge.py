"""The thickness of a gauge block: distance of its two parallel faces.

Baseline rule: **thickness is the distance of two parallel planes fitted jointly and robustly to the points of both
faces**, one common normal and two distances; see `core.inspect.plane_fit`. No point of the table is extrapolated by
itself, and no mean height is taken. Fitting is one step, uncertainty and verdict another, so that the thickness can be
measured again with displaced calibrations in between.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import InputError
from core.inspect.conformity import decide
from core.inspect.faces import FacePair, faces_in_polygons, find_faces
from core.inspect.plane_fit import ParallelPlanes, PlaneFit, fit_parallel_planes, fit_plane, refit_thickness
from core.inspect.results import Face, GaugeResult
from core.inspect.uncertainty import (
    calibration_contributions,
    combined,
    form_contribution,
    patches,
    point_contributions,
)
from core.model import LightPlane
from core.model.arrays import Array
from core.progress import Progress, silent
from core.scan.cloud import Cloud

Polygons = tuple[ArrayLike, ArrayLike]

RULE = "distance of two parallel planes fitted jointly and robustly to the points of both faces"
RULE_LINE = (
    "distance of two parallel lines fitted jointly and robustly to one light profile, "
    "at right angles to them and along the reference normal"
)


@dataclass(frozen=True, eq=False, slots=True)
class GaugeFit:
    """The two faces and the planes fitted to them.

    `planes` is the joint fit, over `pair.upper` and `pair.lower` (indices into the cloud, in the order of the fit's
    weights and gains); `upper` and `lower` are each fitted freely, `parallelism` (rad) is the angle between them.
    """

    planes: ParallelPlanes
    pair: FacePair
    upper: Face
    lower: Face
    parallelism: float

    @property
    def thickness_mm(self) -> float:
        """Distance of the two parallel planes."""
        return self.planes.thickness

    def thickness_of(self, points: Array) -> float:
        """Thickness in mm from the cloud's `points` (N, 3) measured again, faces and weights the same."""
        return refit_thickness(self.planes, points[self.pair.upper], points[self.pair.lower])


def fit_gauge(
    cloud: Cloud,
    *,
    regions: Polygons | FacePair | None = None,
    margin_mm: float = 1.5,
    tolerance_mm: float | None = None,
    reference_normal: Array | None = None,
    seed: int = 0,
    progress: Progress = silent,
) -> GaugeFit:
    """Find the two faces and fit them.

    Parameters
    ----------
    cloud
        The measured points.
    regions
        (upper, lower) polygons, each (n, 2) in pixels, or the points of the faces themselves; None: the two largest
        parallel faces are found.
    margin_mm, tolerance_mm, seed
        As for `core.inspect.faces.find_faces`; `tolerance_mm` is the search's, not the part's.
    reference_normal
        (3,) for a single light profile only: the table's normal.
    progress
        Told how far it is.

    Raises
    ------
    InputError
        If there are no two parallel faces, or the one given as the upper is not nearer to the camera.
    """
    if regions is None:
        pair = find_faces(cloud, margin_mm=margin_mm, tolerance_mm=tolerance_mm, seed=seed, progress=progress)
    elif isinstance(regions, FacePair):
        pair = regions
    else:
        pair = faces_in_polygons(cloud, *regions, margin_mm=margin_mm, tolerance_mm=tolerance_mm, seed=seed)
    upper, lower = cloud.select(pair.upper), cloud.select(pair.lower)
    planes = fit_parallel_planes(
        upper.points, lower.points, upper.sigma, lower.sigma, reference_normal=reference_normal
    )
    if planes.thickness <= 0:
        raise InputError(
            "the upper face lies behind the lower one as the camera sees them",
            where="[gauge] upper_polygon_px",
            todo="exchange upper_polygon_px and lower_polygon_px",
        )
    free = [
        fit_plane(face.points, face.sigma, reference_normal=None if planes.tilt_determined else planes.normal)
        for face in (upper, lower)
    ]
    cross = np.linalg.norm(np.cross(free[0].normal, free[1].normal))
    return GaugeFit(
        planes,
        pair,
        _face(free[0], pair.upper),
        _face(free[1], pair.lower),
        float(np.arctan2(cross, abs(free[0].normal @ free[1].normal))),
    )


def measure_gauge(
    cloud: Cloud,
    *,
    regions: Polygons | FacePair | None = None,
    fit: GaugeFit | None = None,
    nominal_mm: float | None = None,
    tolerance_mm: float | None = None,
    sweep_covariance: Array | None = None,
    camera_changes: Array | None = None,
    fan_changes: Array | None = None,
    correlation_px: float = 12.0,
    speckle_px: float = 12.0,
    k: float = 2.0,
    seed: int = 0,
    progress: Progress = silent,
) -> GaugeResult:
    """Thickness with uncertainty and verdict.

    Parameters
    ----------
    cloud
        The measured points.
    regions, seed
        As for `fit_gauge`; not used when `fit` is given.
    fit
        The fit of this very cloud, when it has been made already.
    nominal_mm, tolerance_mm
        What the part should be, ±; without both of them there is no verdict.
    sweep_covariance
        (3S, 3S) of the network's stacked π in 1/mm²; None: not known.
    camera_changes, fan_changes
        Changes of the thickness in mm for one-σ displaced calibrations (`core.inspect.remeasure`); None: not known,
        and then no row of the budget.
    correlation_px, speckle_px
        Lengths along a stripe over which centreline noise of the sweeps, and of the fan, is one and the same.
    k
        Coverage factor.
    progress
        Told how far it is.

    Raises
    ------
    InputError
        As `fit_gauge`.
    """
    fit = fit_gauge(cloud, regions=regions, seed=seed, progress=progress) if fit is None else fit
    indices, gains, residuals, patch = _used_points(cloud, fit)
    used = cloud.select(indices)
    gradient = gains[:, None] * fit.planes.normal
    rows = (
        *point_contributions(
            used,
            gradient,
            sweep_covariance=sweep_covariance,
            correlation_px=correlation_px,
            speckle_px=speckle_px,
        ),
        form_contribution(
            used,
            gradient,
            gains,
            residuals,
            patch,
            sweep_covariance=sweep_covariance,
            correlation_px=correlation_px,
            speckle_px=speckle_px,
        ),
        *calibration_contributions(camera_changes, fan_changes),
    )
    u = combined(rows)
    verdict = ""
    if nominal_mm is not None and tolerance_mm is not None:
        verdict = decide(fit.thickness_mm - nominal_mm, tolerance_mm, k * u)
    return GaugeResult(
        thickness_mm=fit.thickness_mm,
        u_mm=u,
        k=k,
        upper=fit.upper,
        lower=fit.lower,
        parallelism=fit.parallelism,
        budget=rows,
        nominal_mm=nominal_mm,
        tolerance_mm=tolerance_mm,
        verdict=verdict,
        normal=fit.planes.normal,
        rule=RULE if fit.planes.tilt_determined else RULE_LINE,
        notes=_notes(sweep_covariance, camera_changes, fan_changes),
    )


def _face(fit: PlaneFit, indices: NDArray[np.int64]) -> Face:
    """A face from its free fit: the points the fit kept, their residuals and the spread of 95 % of them."""
    kept = fit.weights > 0
    residuals = fit.residuals[kept]
    low, high = np.quantile(residuals, [0.025, 0.975])
    plane = LightPlane.from_normal(fit.normal, fit.distance)
    return Face(plane, indices[kept], residuals, float(high - low), float(np.sqrt(np.mean(residuals**2))))


def _used_points(cloud: Cloud, fit: GaugeFit) -> tuple[NDArray[np.int64], Array, Array, NDArray[np.int64]]:
    """Indices of the points with weight in the joint fit, their gains, residuals along the normal and patches."""
    axes = np.linalg.svd(fit.planes.normal[None, :])[2][1:].T
    columns: list[tuple[NDArray[np.int64], Array, Array, NDArray[np.int64]]] = []
    first = 0
    for side, indices in enumerate((fit.pair.upper, fit.pair.lower)):
        kept = fit.planes.weights[side] > 0
        patch = patches(cloud.points[indices[kept]], axes) + first
        first = int(patch.max()) + 1
        # Residuals are positive towards the camera, gains count along the normal, away from it.
        columns.append((indices[kept], fit.planes.gains[side][kept], -fit.planes.residuals[side][kept], patch))
    indices, gains, residuals, patch = (np.concatenate(column) for column in zip(*columns, strict=True))
    return indices, gains, residuals, patch


def _notes(sweeps: Array | None, camera: Array | None, fan: Array | None) -> tuple[str, ...]:
    """Sentences on what the stated uncertainty does not hold."""
    missing = [
        name
        for name, known in (("the sweeps' light planes", sweeps), ("the camera", camera), ("the fan", fan))
        if known is None
    ]
    return (f"The stated uncertainty does not hold that of {', '.join(missing)}.",) if missing else ()
