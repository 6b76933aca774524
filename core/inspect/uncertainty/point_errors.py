"""What makes the points of a cloud wrong, and which of them are wrong together.

Every point lies on the known ray r of its pixel, so noise can only move its depth: δX_p = r_p δz_p. Depths are wrong by

- *own noise* of the centreline, one and the same over a stretch of a stripe, independent beyond: σ_p;
- *sweep planes*: δz_p = −z_p² r_p·δπ_i for all points of sweep i, with the network's covariance of all π;
- *the fan's speckle*, which its own points and the sweeps' planes have in common (`core.scan.network.fan_speckle`);
- *common errors* of camera and fan: each calibration one standard deviation off moves all points at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from core.calibrate.deviations import FANS, UNEXPLAINED, Source
from core.findings.proof import SCAN_UNKNOWN, Doubt, Doubts, ScanFacts
from core.findings.table import note_of
from core.image.stripes.centreline import Centreline
from core.inspect.causes import CALIBRATIONS, Cause
from core.inspect.uncertainty.part import Part
from core.messages import Message
from core.model.arrays import Array
from core.scan.common_errors import CommonErrors
from core.scan.features.extraction import ScanFeatures
from core.scan.network.fan_speckle import FanSpeckle
from core.scan.network.read_out import row_forms
from core.scan.part_light import PartLight
from core.scan.surface.cloud import Cloud

PATCHES = 6
"""Patches of a face along each of its sides, for its form."""
OWN_SHARE = 0.1
"""A point's own noise is never taken for less than this share of its σ."""


@dataclass(frozen=True, eq=False)
class PointErrors:
    """Errors of a cloud's points and how they are correlated.

    Parameters
    ----------
    sweep_covariance
        (3S, 3S) of the network's stacked π in 1/mm²; `Cloud.sweep` counts its blocks, of `sweep_size` rows each. None:
        not known; then all of a point's σ counts as its own noise, which makes u too small where sweeps dominate.
    common
        What displaced calibrations do to the points; None: not known.
    correlation_px, speckle_px
        Lengths along a stripe over which the centreline noise of the sweeps, and of the fan, is one and the same.
    speckle
        What the fan's points and the sweeps have in common; None: taken for independent of each other.
    stripe_px
        σ of the light's sections in the picture; 0: not known. On a curved surface they are uneven.
    facts
        Of the scan: what decides whether anything measured in it can prove conformity. None: not known, which proves
        nothing.
    """

    sweep_covariance: Array | None = None
    common: CommonErrors | None = None
    correlation_px: float = 12.0
    speckle_px: float = 12.0
    speckle: FanSpeckle | None = None
    stripe_px: float = 0.0
    facts: ScanFacts | None = None
    light: PartLight | None = None
    """How much wider stripes are on the part than on the table; None: not known."""
    part: Part | None = None
    """What is stated of the part; None: it is as opaque and as cold as it need be."""
    sweep_size: int = 3
    """How many numbers describe a sweep: more than 3 where planes change with the rows."""
    image_rows: int = 1
    """Rows of a picture."""
    swept: bool = True
    """Whether any points lie on the light planes of sweeps; False: all are the fan's."""

    @property
    def doubts(self) -> Doubts:
        """Reasons why nothing measured in the scan proves anything: facts of the scan, gaps in uncertainties."""
        missing = self.missing()
        of_u = (Doubt.of(note_of("inspection.missing_in_u", missing=missing)),) if missing else ()
        if self.facts is None:
            return of_u or (SCAN_UNKNOWN,)
        return (*self.facts.doubts, *of_u)

    @classmethod
    def of_scan(
        cls,
        features: ScanFeatures,
        sweep_covariance: Array,
        common: CommonErrors | None,
        speckle: FanSpeckle | None = None,
        sweep_size: int = 3,
    ) -> PointErrors:
        """Make the errors of a scan's points from its features, the sweeps' covariance and displaced calibrations.

        `sweep_size` numbers describe a sweep.
        """
        swept = [piece for frame in features.frames for piece in frame.centrelines]
        lengths = _correlation_px(swept), _correlation_px(features.fan)
        width = float(np.median(np.concatenate([piece.width for piece in swept]))) if swept else 0.0
        rows = features.image_size[1]
        return cls(sweep_covariance, common, *lengths, speckle, width, sweep_size=sweep_size, image_rows=rows)

    @classmethod
    def of_fan(cls, pieces: Sequence[Centreline], common: CommonErrors) -> PointErrors:
        """Make the errors of points of the fan alone, without sweeps; `pieces` are the fan's centrelines."""
        return cls(common=common, speckle_px=_correlation_px(pieces), swept=False)

    @property
    def calibrations(self) -> tuple[Cause, ...]:
        """Calibrations (K,) that the common errors come from, as causes; () if the errors are not known."""
        return tuple(CALIBRATIONS[source] for source in self.sources)

    @property
    def sources(self) -> tuple[Source, ...]:
        """Calibrations (K,) that the common errors come from, by name as "camera"; () if the errors are not known."""
        return () if self.common is None else self.common.sources

    def bent_light(self, cloud: Cloud) -> Array:
        """Compute the standard uncertainty (N,) in mm of depths as the fan's light sheets are not plane; else 0."""
        if not self.knows(UNEXPLAINED) or self.common is None:
            return np.zeros(len(cloud))
        return self.common.sigma_of(UNEXPLAINED, cloud)

    def knows(self, source: Source) -> bool:
        """Whether the errors by the calibration `source` are among the common errors."""
        return self.common is not None and source in self.common.sources

    def missing(self) -> tuple[Message, ...]:
        """List what an uncertainty computed from these errors lacks, as messages to be put into a sentence."""
        lacking = []
        if self.swept and self.sweep_covariance is None:
            lacking.append(Message("gauge.without_sweeps", "that of the sweeps' light planes"))
        elif self.swept and self.speckle is None:
            lacking.append(Message("gauge.without_speckle", "what the sweeps owe to the fan's speckle"))
        if not self.knows("camera"):
            lacking.append(Message("gauge.without_camera", "that of the camera"))
        has_fan = self.common is None or self.common.fans.shape[1] > 0
        if has_fan and not any(map(self.knows, FANS)):
            lacking.append(Message("gauge.without_fan", "that of the fan"))
        return tuple(lacking)

    @property
    def sweeps(self) -> int:
        """Number of sweeps in the sweeps' covariance."""
        return 0 if self.sweep_covariance is None else len(self.sweep_covariance) // self.sweep_size

    @cached_property
    def planes_by_cause(self) -> Array:
        """Factor (3S, F + 3S) of the sweep planes' covariance, F columns by the fan's speckle; (0, F) if unknown.

        With P their covariance and C that with the cells, the square root of P − C Cᵀ.
        """
        cells = 0 if self.speckle is None else self.speckle.covariance.shape[1]
        if self.sweep_covariance is None:
            return np.zeros((0, cells))
        shared = np.zeros((len(self.sweep_covariance), 0)) if self.speckle is None else self.speckle.covariance
        return np.hstack([shared, _root(self.sweep_covariance - shared @ shared.T)])

    def forms(self, rays: Array, uv: Array) -> Array:
        """Compute the factors (N, sweep_size) of a sweep's parameters in 1/z at `rays` (N, 3) of pixels `uv`."""
        return row_forms(rays, uv[:, 1], self.image_rows, self.sweep_size)

    def own_sigma(self, cloud: Cloud) -> Array:
        """Compute the σ (N,) in mm of each depth without the share of its sweep's light plane.

        Raises
        ------
        ValueError
            If the covariance has no block for a sweep of the cloud.
        """
        if self.sweep_covariance is None:
            return cloud.sigma
        blocks = self.sweep_covariance.reshape(self.sweeps, self.sweep_size, -1, self.sweep_size)
        if cloud.sweep.max(initial=-1) >= len(blocks):
            raise ValueError(f"the covariance holds {len(blocks)} sweeps, the cloud counts to {cloud.sweep.max()}")
        swept = np.flatnonzero(cloud.sweep >= 0)
        depth = cloud.points[swept, 2]
        rays = self.forms(cloud.points[swept] / depth[:, None], cloud.uv[swept])
        diagonal = blocks[np.arange(len(blocks)), :, np.arange(len(blocks)), :]
        plane = depth**4 * np.einsum("ni,nij,nj->n", rays, diagonal[cloud.sweep[swept]], rays)
        own = cloud.sigma**2
        own[swept] = np.maximum(own[swept] - plane, OWN_SHARE**2 * own[swept])
        return np.asarray(np.sqrt(own), dtype=np.float64)

    def places(self, cloud: Cloud) -> NDArray[np.int64]:
        """Find the place (N,) of each of a cloud's points among the fan's points in `speckle`; −1 if it has none."""
        place = np.full(len(cloud), -1, dtype=np.int64)
        if self.speckle is not None:
            of_fan = np.flatnonzero(cloud.sweep < 0)
            place[of_fan] = self.speckle.places(cloud.uv[of_fan])
        return place

    def stretches(self, cloud: Cloud, part: NDArray[np.int64], place: NDArray[np.int64]) -> NDArray[np.int64]:
        """Assign each point (N,) to a piece of a stripe, numbered from 0; each piece lies on one face `part`.

        Those of the fan are the cells of `speckle` where `place` (N,), as of `places`, knows the point.
        """
        _, stripe = np.unique((cloud.sweep - cloud.sweep.min()) * (part.max() + 1) + part, return_inverse=True)
        length = np.where(cloud.sweep < 0, self.speckle_px, self.correlation_px)
        along = np.floor(along_stripes(cloud.uv, stripe) / length).astype(np.int64)
        if self.speckle is not None:
            known = place >= 0
            stripe = np.where(known, stripe.max() + 1 + part, stripe)
            along = np.where(known, self.speckle.cell[place], along) if known.any() else along
        return pairs(stripe, along - along.min())


def _root(covariance: Array) -> Array:
    """R (n, n) with R Rᵀ = `covariance`, found in units of its standard deviations: they differ by many powers."""
    size = np.sqrt(np.maximum(covariance.diagonal(), 1e-300))
    values, vectors = np.linalg.eigh((covariance + covariance.T) / (2 * np.outer(size, size)))
    return np.asarray(size[:, None] * vectors * np.sqrt(np.maximum(values, 0.0)))


def _correlation_px(pieces: Sequence[Centreline]) -> float:
    """Length in pixels over which the noise of a typical point counts as one: the median over all points."""
    lengths = np.array([len(piece) for piece in pieces], dtype=np.int64)
    correlations = np.array([piece.correlation_px for piece in pieces])
    return float(np.median(np.repeat(correlations, lengths))) if len(pieces) else 1.0


def patches(flat: Array, face: NDArray[np.int64]) -> NDArray[np.int64]:
    """Assign each of the points (N, 2) to one of PATCHES × PATCHES patches of its `face` (N,); return numbers (N,)."""
    number = np.zeros(len(flat), dtype=np.int64)
    for index in np.unique(face):
        mine = face == index
        low, size = flat[mine].min(axis=0), np.maximum(np.ptp(flat[mine], axis=0), 1e-9)
        column, row = np.minimum((flat[mine] - low) / size * PATCHES, PATCHES - 1).astype(np.int64).T
        number[mine] = (index * PATCHES + row) * PATCHES + column
    return number


def pairs(first: NDArray[np.int64], second: NDArray[np.int64]) -> NDArray[np.int64]:
    """Assign to each pair of integers ≥ 0 (N,) a number from 0, equal for equal pairs."""
    return np.asarray(np.unique(first * (second.max() + 1) + second, return_inverse=True)[1], dtype=np.int64)


def along_stripes(uv: Array, stripe: NDArray[np.int64]) -> Array:
    """Compute where (N,) in px points lie along the main direction of their `stripe` (N,), from the middle of it."""
    count = np.bincount(stripe)
    centred = uv - np.column_stack([np.bincount(stripe, uv[:, k]) / count for k in range(2)])[stripe]
    u, v = centred.T
    uu, vv, both = (np.bincount(stripe, product) for product in (u * u, v * v, u * v))
    angle = 0.5 * np.arctan2(2 * both, uu - vv)
    return np.asarray(u * np.cos(angle)[stripe] + v * np.sin(angle)[stripe], dtype=np.float64)
