"""Uncertainty of a measured quantity q (a thickness, a radius) from the points it rests on, by the GUM.

Every point lies on the known ray r of its pixel, so all that can be wrong with it is its depth: δX_p = r_p δz_p, and
δq = Σ_p g_p δz_p with g_p = ∂q/∂X_p · r_p. What makes the depths wrong, and how it adds up:

- *point noise*: one and the same over a stretch of `correlation_px` along a stripe, independent beyond;
- *sweep planes*: δz_p = −z_p² r_p·δπ_i for all points of sweep i, with the network's covariance C of all π:
  u² = aᵀ C a with a_i = −Σ_p g_p z_p² r_p;
- *fan speckle*: the fan's own points, whose speckle stands still: the same as point noise with its own length;
- *camera*, *fan calibration*: common to all points; the change of q when the calibration moves by one standard
  deviation along each of its principal directions, re-measured by the caller;
- *form*: what the residuals show beyond all that: faces that are not flat, errors nobody has named.

References
----------
JCGM 100:2008, Guide to the expression of uncertainty in measurement, 5.2 (correlated input quantities).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from core.inspect.results import Contribution
from core.model.arrays import Array
from core.scan.cloud import Cloud

POINT_NOISE = "centreline noise of the sweeps' points"
SWEEP_PLANES = "light planes of the sweeps (network)"
FAN_SPECKLE = "centreline noise of the fan's points (speckle)"
CAMERA = "camera calibration"
FAN_CALIBRATION = "fan calibration"
FORM = "form of the faces beyond the stated noise"

OWN_SHARE = 0.1
"""A point's own noise is never taken for less than this share of its σ."""


def combined(contributions: Iterable[Contribution]) -> float:
    """Combined standard uncertainty in mm of independent contributions."""
    return float(np.sqrt(sum(row.u_mm**2 for row in contributions)))


def point_contributions(
    cloud: Cloud,
    gradient: Array,
    *,
    sweep_covariance: Array | None = None,
    correlation_px: float = 12.0,
    speckle_px: float = 12.0,
) -> tuple[Contribution, ...]:
    """What the points' own noise, the sweeps' planes and the fan's speckle contribute.

    Parameters
    ----------
    cloud
        The M points used.
    gradient
        (M, 3) ∂q/∂X_p.
    sweep_covariance
        (3S, 3S) covariance of the sweeps' stacked π in 1/mm²; `cloud.sweep` counts its blocks. None: not known; then
        all of a point's σ counts as its own noise, which makes u too small where sweeps dominate.
    correlation_px
        Length along a stripe in pixels over which the sweeps' centreline noise is one and the same.
    speckle_px
        The same for the fan's own points.

    Raises
    ------
    ValueError
        If the covariance has no block for a sweep of the cloud.
    """
    depth_gain, lever = _sensitivities(cloud, gradient)
    own = _own_sigma(cloud, sweep_covariance)
    of_fan = cloud.sweep < 0
    rows = []
    for source, part, length in ((POINT_NOISE, ~of_fan, correlation_px), (FAN_SPECKLE, of_fan, speckle_px)):
        if part.any():
            stretches = _stretches(cloud.select(part), gradient[part], length)
            shared = np.bincount(stretches, (depth_gain * own)[part])
            rows.append(Contribution(source, float(np.sqrt(shared @ shared))))
    if sweep_covariance is not None and not of_fan.all():
        a = _per_sweep(cloud.sweep, lever, len(sweep_covariance) // 3)
        rows.insert(1, Contribution(SWEEP_PLANES, float(np.sqrt(max(float(a @ sweep_covariance @ a), 0.0)))))
    return tuple(rows)


def form_contribution(
    cloud: Cloud,
    gradient: Array,
    normal_gain: Array,
    residuals: Array,
    patch: NDArray[np.int64],
    *,
    sweep_covariance: Array | None = None,
    correlation_px: float = 12.0,
    speckle_px: float = 12.0,
) -> Contribution:
    """What the residuals show beyond point noise and sweep planes.

    Residuals are summed over patches of the faces with the points' gains: the scatter of these sums is the variance
    of q whatever is correlated inside a patch (a cluster-robust, "sandwich" estimate). What point noise and sweep
    planes predict for the same sums is taken off; nothing is left where the model is complete.

    Parameters
    ----------
    cloud, gradient, sweep_covariance, correlation_px, speckle_px
        As for `point_contributions`.
    normal_gain
        (M,) ∂q/∂(shift along the normal).
    residuals
        (M,) in mm along the same normal.
    patch
        (M,) number of the patch each point lies in, from 0.
    """
    depth_gain, lever = _sensitivities(cloud, gradient)
    own = _own_sigma(cloud, sweep_covariance)
    observed = np.bincount(patch, normal_gain * residuals)
    of_fan = cloud.sweep < 0
    predicted = 0.0
    for part, length in ((~of_fan, correlation_px), (of_fan, speckle_px)):
        if part.any():
            stretches = _stretches(cloud.select(part), gradient[part], length)
            shared = np.bincount(_pairs(patch[part], stretches), (depth_gain * own)[part])
            predicted += float(shared @ shared)
    if sweep_covariance is not None and not of_fan.all():
        for number in range(len(observed)):
            inside = patch == number
            a = _per_sweep(cloud.sweep[inside], lever[inside], len(sweep_covariance) // 3)
            predicted += float(a @ sweep_covariance @ a)
    return Contribution(FORM, float(np.sqrt(max(float(observed @ observed) - predicted, 0.0))))


def patches(points: Array, axes: Array, across: int = 6) -> NDArray[np.int64]:
    """Number of the patch of a face each point lies in: `across` × `across` over its extent along `axes` (3, 2)."""
    flat = points @ axes
    low, size = flat.min(axis=0), np.maximum(np.ptp(flat, axis=0), 1e-9)
    column, row = np.minimum((flat - low) / size * across, across - 1).astype(np.int64).T
    numbers: NDArray[np.int64] = row * across + column
    return numbers


def calibration_contributions(camera_changes: Array | None, fan_changes: Array | None) -> tuple[Contribution, ...]:
    """The rows of the calibrations: root sum of squares of q's changes (mm) for one-σ displaced calibrations."""
    rows = []
    for source, changes in ((CAMERA, camera_changes), (FAN_CALIBRATION, fan_changes)):
        if changes is not None:
            rows.append(Contribution(source, float(np.linalg.norm(changes))))
    return tuple(rows)


def _sensitivities(cloud: Cloud, gradient: Array) -> tuple[Array, Array]:
    """∂q/∂z_p (M,) and each point's share (M, 3) of a = ∂q/∂π of its sweep."""
    depth = cloud.points[:, 2]
    rays = cloud.points / depth[:, None]
    depth_gain = np.asarray((gradient * rays).sum(axis=1), dtype=np.float64)
    return depth_gain, -(depth_gain * depth**2)[:, None] * rays


def _own_sigma(cloud: Cloud, sweep_covariance: Array | None) -> Array:
    """σ of each depth less the share of its sweep's plane."""
    if sweep_covariance is None:
        return cloud.sigma
    blocks = sweep_covariance.reshape(len(sweep_covariance) // 3, 3, -1, 3)
    if cloud.sweep.max(initial=-1) >= len(blocks):
        raise ValueError(f"the covariance holds {len(blocks)} sweeps, the cloud counts to {cloud.sweep.max()}")
    swept = np.flatnonzero(cloud.sweep >= 0)
    index = cloud.sweep[swept]
    depth = cloud.points[swept, 2]
    rays = cloud.points[swept] / depth[:, None]
    diagonal = blocks[np.arange(len(blocks)), :, np.arange(len(blocks)), :]
    plane = depth**4 * np.einsum("ni,nij,nj->n", rays, diagonal[index], rays)
    own = cloud.sigma**2
    own[swept] = np.maximum(own[swept] - plane, OWN_SHARE**2 * own[swept])
    return np.asarray(np.sqrt(own), dtype=np.float64)


def _per_sweep(sweep: NDArray[np.int64], lever: Array, sweeps: int) -> Array:
    """Σ of `lever` (M, 3) over the points of each sweep, stacked (3S,)."""
    swept = sweep >= 0
    sums = [np.bincount(sweep[swept], lever[swept, axis], minlength=sweeps) for axis in range(3)]
    return np.asarray(np.column_stack(sums).ravel(), dtype=np.float64)


def _stretches(cloud: Cloud, gradient: Array, length_px: float) -> NDArray[np.int64]:
    """Number of the stretch of stripe, `length_px` long, that each point lies on.

    Stretches run along the main direction of each sweep's points in the picture; the two faces of a thickness, whose
    gradients point opposite ways, never share one.
    """
    side = (gradient[:, 2] > 0).astype(np.int64)
    _, stripe = np.unique(cloud.sweep * 2 + side, return_inverse=True)
    count = np.bincount(stripe)
    centred = cloud.uv - np.column_stack([np.bincount(stripe, cloud.uv[:, k]) / count for k in range(2)])[stripe]
    u, v = centred.T
    uu, vv, uv = (np.bincount(stripe, product) for product in (u * u, v * v, u * v))
    angle = 0.5 * np.arctan2(2 * uv, uu - vv)
    along = np.floor((u * np.cos(angle)[stripe] + v * np.sin(angle)[stripe]) / length_px).astype(np.int64)
    return _pairs(stripe, along - along.min())


def _pairs(first: NDArray[np.int64], second: NDArray[np.int64]) -> NDArray[np.int64]:
    """Number, from 0, of each different pair of numbers ≥ 0."""
    return np.asarray(np.unique(first * (second.max() + 1) + second, return_inverse=True)[1], dtype=np.int64)
