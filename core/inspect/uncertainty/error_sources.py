"""What errs in the points of a face, cause by cause, and how strongly it acts on each stretch of a stripe.

Points of a scan are not independent. The centreline's noise is one and the same over a stretch; all points of a sweep
share the error of its light plane, and the sweeps share one network; camera and fan err in all points at once; a face
that is not flat errs in patches. With J stretches instead of N points, observation j of a linear model reads::

    misfit_j = x_j·β + s_j·z + a_jᵀ L ζ + d_j·ξ + σ_form f_j·η + ε_j

z the fan's speckle, which moves its own points and, through the network, the sweeps' planes; L Lᵀ the covariance of
these planes less what z does to them; z, ζ, ξ, η of unit variance, ε_j the stretch's own noise.

With P the covariance of the planes' errors and C theirs with z: of two jointly normal things the one is C z plus what
has the covariance P − C Cᵀ and is independent of z.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag
from scipy.sparse import block_diag as sparse_block_diag
from scipy.sparse import csr_array

from core.calibrate.deviations import LAWLESS, UNMEASURED
from core.inspect.causes import IN_TWO_VIEWS, Cause
from core.inspect.uncertainty.joined_errors import JoinedErrors
from core.inspect.uncertainty.point_errors import PointErrors, along_stripes
from core.inspect.uncertainty.skewed_light import light_below
from core.model.arrays import Array
from core.model.positive_definite import inverse_root
from core.scan.network.fan_speckle import FanSpeckle
from core.scan.surface.cloud import Cloud

GRAZING = 0.35
"""|cos| of incidence below which own noise across the surface falls no further where light planes are not known: the
pixel is uncertain as well."""
LEAST_GAIN, LARGEST_GAIN = 0.1, 3.0
"""Of a misfit by its depth's own noise; it runs away where a stripe lies so that noise hardly changes depths."""
FLOOR_MM = 2e-4
"""No stretch is known better than this across the surface."""
LEAST_REST = 0.3
"""What the fan's cells leave of a stretch's noise is never taken for less than this share of a point's: the windows
that points were averaged over are known by their usual length only."""


@dataclass(frozen=True, eq=False, slots=True)
class Precision:
    """Precision matrix M (J, J) of misfits y that light planes move: M = √W (1 − B (1 − V⁻¹) Bᵀ) √W, by Woodbury.

    √W times what the planes do is B R with Bᵀ B = 1 and few rows R, and V = 1 + R Rᵀ. Of any model D x of the rest
    Dᵀ M D is the information, and M (y − D x) is W times what it leaves of y with the planes as likely as can be.

    Parameters
    ----------
    weight
        (J,) the diagonal of W.
    basis
        B (J, m).
    root
        (m, m) lower triangular, with rootᵀ root = V⁻¹.
    """

    weight: Array
    basis: csr_array
    root: Array

    def times(self, columns: Array) -> Array:
        """Multiply M by `columns` (J, n)."""
        by_root = np.sqrt(self.weight)[:, None]
        scaled = by_root * columns
        felt = self.basis.T @ scaled
        return np.asarray(by_root * (scaled - self.basis @ (felt - self.root.T @ (self.root @ felt))))

    @property
    def diagonal(self) -> Array:
        """Diagonal (J,) of M."""
        kept = (self.basis @ self.root.T) ** 2
        taken = np.asarray(self.basis.power(2).sum(axis=1)) - kept.sum(axis=1)
        return np.asarray(self.weight * (1 - taken))


@dataclass(frozen=True, eq=False, slots=True)
class Sources:
    """Effects of each cause of error on J stretches, for unit variance each; see the module."""

    stretch: NDArray[np.int64]  # (N,) of each point
    share: Array  # (N,) weight of each point in its stretch, summing to 1
    own: Array  # (J,) standard deviation in mm
    of_fan: NDArray[np.bool_]  # (J,)
    speckle: Array  # (J, F)
    sweeps: Array  # (J, 3S)
    common: Array  # (J, K)
    form: Array  # (J, patches)
    behind: Array  # (J, 2) what skewed light, and what wider stripes, may do at most, in mm; 0 where none is seen
    below: Array  # (J, faces) what light from below each face does that nothing excludes
    on_planes: csr_array  # (J, 3S) how each follows its sweep's plane, in mm²: as many numbers as a sweep has
    planes: Array  # (3S, F + 3S) how the planes follow the causes of `speckle` and `sweeps`
    unexplained: NDArray[np.bool_]  # (K,) common errors whose law is not known: a fit must not take them out
    assumed: NDArray[np.bool_]  # (K,) common errors whose size nothing has measured
    cause_below: Cause  # what the row of `below` is called
    below_in_all: bool = False  # whether it is the same in all that is measured: all views see the same matter

    @property
    def explained(self) -> Array:
        """Columns (J, K′) of the matrix `common`: of the errors that a fit of the points can estimate."""
        return np.asarray(self.common[:, ~self.unexplained])

    @property
    def measured(self) -> Array:
        """Effects (J, K″), on J pieces of stripes, of common errors of measured size that a fit may estimate."""
        return np.asarray(self.common[:, ~(self.unexplained | self.assumed)])

    @classmethod
    def of(
        cls,
        cloud: Cloud,
        direction: Array,
        weights: Array,
        part: NDArray[np.int64],
        patch: NDArray[np.int64],
        errors: PointErrors,
    ) -> Sources:
        """Divide a cloud's points into pieces of stripes, and compute how each cause of error acts on each piece.

        Parameters
        ----------
        cloud
            The N points used.
        direction
            (3,) or (N, 3) ∂misfit/∂X_p.
        weights
            (N,) robust weights, above 0.
        part
            (N,) which face each point is on: stretches end there.
        patch
            (N,) number of the patch of a face each lies in, from 0.
        errors
            Of the points.
        """
        if isinstance(errors, JoinedErrors):
            return _joined(cloud, np.broadcast_to(direction, cloud.points.shape), weights, (part, patch), errors)
        place = errors.places(cloud)
        stretch = errors.stretches(cloud, part, place)
        depth = cloud.points[:, 2]
        rays = cloud.points / depth[:, None]
        gain = np.asarray((direction * rays).sum(axis=1), dtype=np.float64)
        of_noise = _gain_of_noise(cloud, np.broadcast_to(direction, cloud.points.shape), gain, errors)
        own = np.abs(of_noise) * errors.own_sigma(cloud)
        weight = weights / own**2
        share = weight / np.bincount(stretch, weight)[stretch]
        count = int(stretch.max()) + 1
        first = np.zeros(count, dtype=np.int64)
        first[stretch] = np.arange(len(stretch))

        def mean(values: Array) -> Array:
            return np.asarray(np.bincount(stretch, share * values, minlength=count))

        # A stretch of which the robust fit has silenced most is known less well.
        alive = np.clip(np.bincount(stretch, share * weights) / max(float(np.median(weights)), 1e-12), 0.05, 1.0)
        lever = np.column_stack([mean(-gain * depth**2 * form) for form in errors.forms(rays, cloud.uv).T])
        form = np.zeros((count, int(patch.max()) + 1))
        np.add.at(form, (stretch, patch), share)
        seen = light_below(cloud, part, np.broadcast_to(direction, cloud.points.shape), errors.part, errors.light)
        of_face = part[first]
        noise = mean(own)
        planes, on_planes = errors.planes_by_cause, _on_planes(cloud.sweep[first], lever, errors.sweeps)
        speckle, sweeps = np.split(on_planes @ planes, [planes.shape[1] - planes.shape[0]], axis=1)
        if errors.speckle is not None:
            known = np.flatnonzero(place >= 0)
            _add_fan(speckle, errors.speckle, place[known], stretch[known], (share * of_noise)[known])
            of_cells = (errors.speckle.shares[place[known]] ** 2).sum(axis=1)
            left = own.copy()
            left[known] *= np.sqrt(np.maximum(1 - of_cells / cloud.sigma[known] ** 2, 0.0))
            noise = _rest(errors, place, stretch, mean(left), noise)
        return cls(
            stretch,
            share,
            np.hypot(noise, FLOOR_MM) / np.sqrt(alive),
            cloud.sweep[first] < 0,
            speckle,
            sweeps,
            _of_common(cloud, direction, mean, stretch, errors),
            form,
            np.column_stack([mean(of_noise * mm[part]) for mm in (seen.skewed_mm, seen.wider_mm)]),
            (mean(of_noise) * seen.unseen_mm[of_face])[:, None] * (of_face[:, None] == np.arange(len(seen.unseen_mm))),
            on_planes,
            planes,
            np.array([source in LAWLESS for source in errors.sources], dtype=np.bool_),
            np.array([source in UNMEASURED for source in errors.sources], dtype=np.bool_),
            Cause.LIGHT_FROM_BELOW_ASSUMED
            if errors.part is None or errors.part.material is None
            else Cause.LIGHT_FROM_BELOW,
        )

    @property
    def by_own_noise(self) -> Array:
        """How the planes follow (3S, 3S) the causes of `sweeps`."""
        return self.planes[:, self.speckle.shape[1] :]

    def effects(self, others: Array) -> Array:
        """Stack the effects A (J, n) on J pieces of stripes: `others` (J, q), the fan's speckle, and the sweeps."""
        return np.hstack([others, self.speckle, self.sweeps])

    def information(self, others: Array, weight: Array) -> Array:
        """Compute the information matrix Aᵀ W A (n, n) of the `effects` A, with the weights W = diag(`weight` (J,)).

        All of a sweep's stretches follow its few numbers only, so that as many rows stand for them.
        """
        fan, swept = np.flatnonzero(self.of_fan), np.flatnonzero(~self.of_fan)
        weighted = weight[swept, None] * others[swept]
        planes = _few_rows(self.on_planes[swept], weight[swept])[1] @ self.planes
        across = (self.on_planes[swept].T @ weighted).T @ self.planes
        of_swept = np.block([[weighted.T @ others[swept], across], [across.T, planes.T @ planes]])
        rows = np.hstack([others[fan], self.speckle[fan], self.sweeps[fan]]) * np.sqrt(weight[fan])[:, None]
        return np.asarray(of_swept + rows.T @ rows)

    def precision(self, weight: Array) -> Precision:
        """Compute the precision of misfits that the `sweeps` move, and each its own noise, of the `weight` (J,)."""
        basis, rows = _few_rows(self.on_planes, weight)
        moved = rows @ self.by_own_noise
        variance = np.eye(len(moved)) + moved @ moved.T
        return Precision(weight, basis, inverse_root(variance) if len(moved) else variance)

    def mean(self, values: Array) -> Array:
        """Compute the weighted mean (J,) or (J, …) over each of J pieces of stripes of `values` (N,) or (N, …)."""
        columns = values.reshape(len(values), -1)
        means = np.column_stack([np.bincount(self.stretch, self.share * column) for column in columns.T])
        return np.asarray(means.reshape(len(self.own), *values.shape[1:]))


def _gain_of_noise(cloud: Cloud, direction: Array, gain: Array, errors: PointErrors) -> Array:
    """(N,) how the misfit follows the depth when it is the stripe's own noise that changes it.

    Noise moves the pixel by ε square to the stripe, along m in the plane of the rays, and the point stays on its light
    plane: δX = r δz + z (m, 0) ε with δz = −z² (π·m) ε. Where the surface faces the camera the second part does not
    matter; on a slanting one it adds as much as the first. The stripe runs along π × normal.
    """
    if errors.common is None:
        return np.copysign(np.maximum(np.abs(gain), GRAZING), gain)
    pis, depth = errors.common.planes(cloud.uv, cloud.sweep), cloud.points[:, 2]
    along = np.cross(pis, direction)
    seen = along[:, :2] - cloud.points[:, :2] / depth[:, None] * along[:, 2:]
    across = np.column_stack([seen[:, 1], -seen[:, 0]])
    slope = depth * (pis[:, :2] * across).sum(axis=1)
    moved = (direction[:, :2] * across).sum(axis=1)
    follows = gain - moved / np.where(np.abs(slope) > 1e-12, slope, 1e-12)
    return np.asarray(np.copysign(np.clip(np.abs(follows), LEAST_GAIN, LARGEST_GAIN), follows))


def _on_planes(sweep: NDArray[np.int64], lever: Array, sweeps: int) -> csr_array:
    """(J, 3S) how stretches follow the planes of the `sweep` (J,) of each by its `lever` (J, k); 0 of the fan."""
    size, swept = lever.shape[1], (sweep >= 0) & (sweeps > 0)
    place = size * sweep[swept, None] + np.arange(size)
    starts = np.concatenate([[0], size * np.cumsum(swept)])
    return csr_array((lever[swept].ravel(), place.ravel(), starts), (len(sweep), size * sweeps))


def _few_rows(on_planes: csr_array, weight: Array) -> tuple[csr_array, csr_array]:
    """Few rows R (m, 3S) that stand for A = `on_planes` (J, 3S) with the weights W, and B (J, m): √W A = B R, Bᵀ B = 1.

    Of each sweep the QR decomposition: Aᵀ W A itself loses to rounding what little is known of some planes' directions.
    """
    count, columns = on_planes.shape
    swept = np.flatnonzero(np.diff(on_planes.indptr))
    size = on_planes.nnz // max(len(swept), 1)
    if not size:
        return csr_array((count, 0)), csr_array((0, columns))
    lever = on_planes.data.reshape(-1, size) * np.sqrt(weight[swept])[:, None]
    sweep, each = np.unique(on_planes.indices[::size] // size, return_inverse=True)
    order, members = np.argsort(each, kind="stable"), np.bincount(each)
    within = np.empty_like(order)
    within[order] = np.arange(len(swept)) - np.repeat(np.cumsum(members) - members, members)
    stacked = np.zeros((len(sweep), max(int(members.max()), size), size))
    stacked[each, within] = lever
    unit, triangle = np.linalg.qr(stacked)
    numbers, rows = np.arange(size), size * len(sweep)
    basis = csr_array(
        (unit[each, within].ravel(), (size * each[:, None] + numbers).ravel(), on_planes.indptr), (count, rows)
    )
    place = np.broadcast_to(size * sweep[:, None, None] + numbers, triangle.shape)
    return basis, csr_array((triangle.ravel(), place.ravel(), size * np.arange(rows + 1)), (rows, columns))


def _add_fan(
    effect: Array, speckle: FanSpeckle, place: NDArray[np.int64], stretch: NDArray[np.int64], gain: Array
) -> None:
    """Add to `effect` (J, F) what cells do to stretches through the fan's points at `place`, with these gains (N,)."""
    for k, share in enumerate(speckle.shares[place].T):
        there = share != 0
        np.add.at(effect, (stretch[there], speckle.first[place[there]] + k), gain[there] * share[there])


def _rest(
    errors: PointErrors, place: NDArray[np.int64], stretch: NDArray[np.int64], left: Array, noise: Array
) -> Array:
    """Own noise (J,) of the means over stretches where points have `noise` (J,), and cells leave `left` (J,) of it.

    Averaged over a window longer than a cell, little is left of a point. Of what a shorter one leaves, the noise within
    the cell, the mean over all of the cell is free.
    """
    assert errors.speckle is not None
    known = place >= 0
    here = np.bincount(stretch[known], minlength=len(noise))
    whole = np.zeros(len(noise))
    whole[stretch[known]] = errors.speckle.members[errors.speckle.cell[place[known]]]
    part = errors.speckle_px * (1 / np.maximum(here, 1) - 1 / np.maximum(whole, 1))
    rest = np.maximum(np.minimum(left, noise * np.sqrt(np.maximum(part, 0.0))), LEAST_REST * noise)
    return np.asarray(np.where(here > 0, rest, noise))


def _of_common(
    cloud: Cloud, direction: Array, mean: Callable[[Array], Array], stretch: NDArray[np.int64], errors: PointErrors
) -> Array:
    """Effect (J, K) on each `stretch` (N,) of each calibration displaced by one standard deviation.

    It changes little over a stretch. Its mean over two places that stand for either half of the points is theirs, but
    for the third power of the stretch's length.
    """
    count = int(stretch.max()) + 1
    effect = np.zeros((count, len(errors.sources)))
    if errors.common is None:
        return effect
    along = along_stripes(cloud.uv, stretch)
    along -= mean(along)[stretch]
    spread = np.sqrt(mean(along**2))
    along /= np.where(spread > 0, spread, 1.0)[stretch]
    points = np.column_stack([cloud.uv, np.broadcast_to(direction, cloud.points.shape)])
    middle = np.column_stack([mean(column) for column in points.T])
    aside = np.column_stack([mean(along * column) for column in points.T])
    sweep = np.zeros(count, dtype=np.int64)
    sweep[stretch] = cloud.sweep
    for half in (middle - aside, middle + aside):
        for k, change in enumerate(errors.common.changes(half[:, :2], sweep)):
            effect[:, k] += np.einsum("ji,ji->j", change, half[:, 2:]) / 2
    return effect


def _joined(
    cloud: Cloud, direction: Array, weights: Array, places: tuple[NDArray[np.int64], ...], errors: JoinedErrors
) -> Sources:
    """Causes of error of a cloud of several views: each view's own, what all have in common, and the joint's.

    `places` are the face and the patch (N,) of each point.
    """
    part, patch = places
    stretch, share = np.zeros(len(cloud), dtype=np.int64), np.zeros(len(cloud))
    found: list[tuple[Sources | None, Array, Array]] = []
    count = 0
    for number, view in enumerate(errors.views):
        mine = np.flatnonzero(cloud.view == number)
        if not len(mine):
            found.append((None, np.zeros((0, len(view.motions))), np.zeros((0, int(patch.max()) + 1))))
            continue
        _, face = np.unique(part[mine], return_inverse=True)
        patches, on_patch = np.unique(patch[mine], return_inverse=True)
        own, towards = view.own(cloud.select(mine)), direction[mine] @ view.pose.rotation
        sources = Sources.of(own, towards, weights[mine], face, on_patch, view.errors)
        stretch[mine], share[mine] = sources.stretch + count, sources.share
        count += len(sources.own)
        moved = np.hstack([np.cross(cloud.points[mine], direction[mine]), direction[mine]])
        common = sources.mean(moved) @ view.motions.T
        common[:, view.columns] += sources.common
        form = np.zeros((len(sources.own), int(patch.max()) + 1))
        form[:, patches] = sources.form
        found.append((sources, common, form))
    known = [sources for sources, _, _ in found if sources is not None]
    of_planes = [view.errors.planes_by_cause for view in errors.views]
    cells = [planes.shape[1] - planes.shape[0] for planes in of_planes]
    below = [sources.below.sum(axis=1, keepdims=True) for sources in known]
    return Sources(
        stretch,
        share,
        np.concatenate([sources.own for sources in known]),
        np.concatenate([sources.of_fan for sources in known]),
        _apart([None if sources is None else sources.speckle for sources, _, _ in found], cells),
        _apart([None if one is None else one.sweeps for one, _, _ in found], [len(planes) for planes in of_planes]),
        np.vstack([common for _, common, _ in found]),
        np.vstack([form for _, _, form in found]),
        np.vstack([sources.behind for sources in known]),
        np.vstack(below),
        csr_array(
            sparse_block_diag(
                [
                    csr_array((0, len(planes))) if sources is None else sources.on_planes
                    for (sources, _, _), planes in zip(found, of_planes, strict=True)
                ],
                format="csr",
            )
        ),
        np.hstack(
            [
                block_diag(*(planes[:, :cell] for planes, cell in zip(of_planes, cells, strict=True))),
                block_diag(*(planes[:, cell:] for planes, cell in zip(of_planes, cells, strict=True))),
            ]
        ),
        np.array([source in LAWLESS for source in errors.sources] + [False] * len(errors.joint_causes), dtype=np.bool_),
        np.array(
            [source in UNMEASURED for source in errors.sources] + [False] * len(errors.joint_causes), dtype=np.bool_
        ),
        IN_TWO_VIEWS[known[0].cause_below] if len(known) > 1 else known[0].cause_below,
        below_in_all=True,
    )


def _apart(parts: list[Array | None], widths: list[int]) -> Array:
    """The effects of each view's own causes, as many as `widths` has, in columns of their own; None: it has no rows."""
    return np.asarray(
        block_diag(*(np.zeros((0, width)) if part is None else part for part, width in zip(parts, widths, strict=True)))
    )
