"""The carrier: reference marks on both sides of a plate or frame that a part is held in, and how well they are known.

Its frame has the origin amid the carrier, z out of side A. The marks' errors are correlated: those of one side were
calibrated together, and how the two sides lie to each other was seen in fewer pictures.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.inspect.uncertainty.part import TargetTemperature
from core.model import Pose
from core.model.arrays import Array, frozen_array, set_field
from core.model.positive_definite import inverse_root

FEWEST_MARKS = 4
"""Marks that a view needs: with three, one that has moved cannot be told from the others."""


NOT_STATED = TargetTemperature()
AT_CELSIUS = 20.0
"""Temperature that lengths are stated at, ISO 1."""


class MarkKind(StrEnum):
    """Kind of a reference mark."""

    RING = "ring"
    """A printed coded ring: its disc's centre is seen in a picture."""
    BALL = "ball"
    """A ball of certified radius: its centre is fitted to points of a scan."""


@dataclass(frozen=True, eq=False, slots=True)
class Carrier:
    """Reference marks of a carrier, as calibrated.

    Parameters
    ----------
    numbers
        (N,) the number that each mark is known by, all different; of rings that of the code.
    sides
        (N,) 0 on side A, 1 on side B.
    positions
        (N, 3) in mm in the carrier's frame, at 20 °C: the centres of discs or balls.
    covariance
        (3N, 3N) in mm² of the stacked positions.
    radius_mm
        Of the discs, or the certified one of the balls.
    kind
        Rings or balls.
    scaled_by_target
        Whether the carrier was calibrated by the rig's own plane target: then it is larger than stated by as much as
        all that the rig measures. If not, or if that is not known, the rig's scale is in the thickness in full.
    name
        Of the carrier, for reports.
    temperature
        Of the carrier while the views are taken, and its expansion.
    as_printed
        Whether nobody has measured where its marks are: then nothing joined by it is proven.
    """

    numbers: NDArray[np.int64]
    sides: NDArray[np.int64]
    positions: Array
    covariance: Array
    radius_mm: float
    kind: MarkKind = MarkKind.RING
    scaled_by_target: bool = False
    name: str = ""
    temperature: TargetTemperature = NOT_STATED
    as_printed: bool = False

    def __post_init__(self) -> None:
        count = len(self.positions)
        set_field(self, "positions", frozen_array(self.positions, (count, 3), "positions"))
        set_field(self, "covariance", frozen_array(self.covariance, (3 * count, 3 * count), "covariance"))
        for name in ("numbers", "sides"):
            index = np.array(getattr(self, name), dtype=np.int64).reshape(count)
            index.flags.writeable = False
            set_field(self, name, index)
        if len(set(self.numbers.tolist())) != count:
            raise ValueError("two marks of a carrier have the same number")

    def __len__(self) -> int:
        return len(self.positions)

    @property
    def sigma(self) -> Array:
        """Standard uncertainties (N, 3) of the marks' positions in mm."""
        return np.asarray(np.sqrt(np.diag(self.covariance)).reshape(-1, 3), dtype=np.float64)

    @property
    def root(self) -> Array:
        """Root R (3N, r) of the covariance: R Rᵀ is the covariance."""
        values, vectors = np.linalg.eigh((self.covariance + self.covariance.T) / 2)
        kept = values > 1e-12 * max(float(values.max(initial=0.0)), 1e-300)
        return np.asarray(vectors[:, kept] * np.sqrt(values[kept]), dtype=np.float64)

    @property
    def growth(self) -> tuple[float, float]:
        """By what share of itself it is larger than at 20 °C, by a stated temperature, with the uncertainty of that."""
        (celsius, u_celsius, _), (alpha, u_alpha) = self.temperature.warmth, self.temperature.expansion
        warmer = celsius - AT_CELSIUS
        return alpha * warmer, float(np.hypot(np.hypot(alpha, u_alpha) * u_celsius, u_alpha * warmer))

    def index_of(self, numbers: NDArray[np.int64]) -> NDArray[np.intp]:
        """Find the places (n,) of the marks with these numbers (n,), which the carrier must have."""
        order = np.argsort(self.numbers)
        return np.asarray(order[np.searchsorted(self.numbers[order], numbers)])

    def on(self, side: int) -> NDArray[np.bool_]:
        """Select (N,) the marks of a side, 0 for A and 1 for B."""
        return np.asarray(self.sides == side)


class Fit(NamedTuple):
    """How marks may be laid on those of a carrier: the pairing (n,), the pose (carrier ← seen), and its RMS in mm."""

    marks: tuple[int, ...]
    pose: Pose
    rms_mm: float


def rigid_fit(points: Array, onto: Array) -> Pose:
    """Fit the rigid motion that lays `points` (N, 3) onto `onto` (N, 3) with the least squares.

    References
    ----------
    Arun, K. S., Huang, T. S., Blostein, S. D., Least-squares fitting of two 3-D point sets, IEEE PAMI 9 (1987),
    doi:10.1109/TPAMI.1987.4767965.
    """
    middle, target = points.mean(axis=0), onto.mean(axis=0)
    u, _, vt = np.linalg.svd((points - middle).T @ (onto - target))
    turn = vt.T @ np.diag([1.0, 1.0, np.sign(np.linalg.det(vt.T @ u.T))]) @ u.T
    return Pose(turn, target - turn @ middle)


def fits_of(points: Array, positions: Array, tolerance_mm: float) -> list[Fit]:
    """List the ways to lay marks without numbers, `points` (n, 3), on `positions` (N, 3) in mm, the best first.

    Every way in which all distances between them agree to `tolerance_mm`; two ways differ in the pairing.
    """
    own, known = (np.linalg.norm(p[:, None] - p[None], axis=2) for p in (points, positions))
    chosen: list[tuple[int, ...]] = [()]
    for here in range(len(points)):
        grown = []
        for way in chosen:
            for candidate in set(range(len(positions))) - set(way):
                off = np.abs(known[candidate, list(way)] - own[here, : len(way)])
                if (off <= tolerance_mm).all():
                    grown.append((*way, candidate))
        chosen = grown
    found = []
    for way in chosen:
        onto = positions[list(way)]
        pose = rigid_fit(points, onto)
        rms = float(np.sqrt(np.mean(np.sum((pose.apply(points) - onto) ** 2, axis=1))))
        if rms <= tolerance_mm:
            found.append(Fit(way, pose, rms))
    return sorted(found, key=lambda one: one.rms_mm)


def second_fit_mm(carrier: Carrier) -> float:
    """Compute the RMS distance in mm by which the next best way misses to lay a carrier's marks on themselves.

    Marks without numbers can be confused if it is not far above what they are uncertain by; infinite where no other
    way comes near. It tells the symmetry of a layout.
    """
    reach = 0.1 * float(np.ptp(carrier.positions, axis=0).max())
    others = [
        one.rms_mm
        for one in fits_of(carrier.positions, carrier.positions, reach)
        if one.marks != tuple(range(len(carrier)))
    ]
    return min(others, default=np.inf)


def u_of_plane(positions: Array, sigma_mm: float, at: Array) -> float:
    """Compute the standard uncertainty in mm, out of their plane, of the place `at` (2,) tied to marks (N, 3).

    `sigma_mm` is that of each mark out of the plane.
    """
    flat = np.column_stack([np.ones(len(positions)), positions[:, :2] - at])
    root = inverse_root(flat.T @ flat)
    return float(sigma_mm * np.linalg.norm(root[:, 0]))


def place_to_add(carrier: Carrier, side: int) -> Array:
    """Find the place (2,) in mm, within the outline of a side's marks, where another mark would help its plane most."""
    mine = carrier.positions[carrier.on(side)]
    low, high = mine[:, :2].min(axis=0), mine[:, :2].max(axis=0)
    steps = np.linspace(0.0, 1.0, 9)
    places = low + (high - low) * np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    middle = mine[:, :2].mean(axis=0)
    gains = [
        u_of_plane(np.vstack([mine, [*place, mine[:, 2].mean()]]), 1.0, middle + corner)
        for place in places
        for corner in [high - middle]
    ]
    return np.asarray(places[int(np.argmin(gains))])
