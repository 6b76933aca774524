"""Shape of a board that is not as it should be: bowed, twisted, or printed longer one way than the other.

The shape is common to all views and unknown; views from different sides tell it. It is a second-degree surface
z = a x² + b y² + c x y over the board, in units of half its size, so that a, b and c are millimetres at its edges, and
an aspect, the share by which it is longer in x and shorter in y. What a technician knows of the board is a prior on
each. The board's size itself no view tells: it scales all lengths alike and leaves the camera as it is.

References
----------
Strobl, K. H. & Hirzinger, G., More accurate pinhole camera calibration with imperfect planar target, ICCV Workshops
(2011) 1068–1075, doi:10.1109/ICCVW.2011.6130369.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from core.errors import WrongValue
from core.findings.table import note_of
from core.messages import Field, Message
from core.model.arrays import Array

SHAPE_PARAMETERS = ("bow_x", "bow_y", "twist", "aspect")
"""Names and order of a shape's parameters: mm, mm, mm and a share."""

SUSPECTED_MM = 0.2
"""Standard deviation in mm of how far a board may be from flat of which nothing is known: a print on a usual board."""
SUSPECTED_SCALE = 5e-4
"""Standard uncertainty of the size of a target of which nothing is known, as a share of it: an office laser printer's,
whose feed rollers and drum grow with warmth and wear."""

LARGEST_SCALE_SD = 0.1
"""Larger standard uncertainties of a size, as a share of it, are absurd."""

SURE = 1e-4
"""A board is bowed for sure if the probability that a flat one looks so is smaller; tests/calibrate/test_board_shape.py
holds it."""


Target = Literal["camera_target", "plane_target"]
"""The targets of calibrations, by their tables in rig.toml."""


def size_assumed(target: Target, scale_sd: float) -> Message:
    """Note the relative standard uncertainty `scale_sd` that is assumed of the size of a `target`."""
    return note_of("target.size_assumed", field=Field(f"{target}.scale_sd", whole=True), per_mille=scale_sd * 1e3)


@dataclass(frozen=True, slots=True)
class BoardTolerance:
    """Tolerance of a printed board, as far as it is known.

    Parameters
    ----------
    flatness_mm
        Standard deviation of how far its edges may be off the plane through its middle; 0: it is flat. None: nothing is
        known; it is taken as flat unless the views surely show otherwise.
    scale_sd
        Standard uncertainty of its size as a share of it, in x and in y on their own; 0: it is true. None: nothing is
        known; it is taken for a print of SUSPECTED_SCALE.

    Raises
    ------
    WrongValue
        If either is negative or absurd.
    """

    flatness_mm: float | None = None
    scale_sd: float | None = None

    def __post_init__(self) -> None:
        if self.flatness_mm is not None and not 0 <= self.flatness_mm <= 100:
            raise WrongValue(
                Message(
                    "target.flatness_absurd",
                    "a flatness of {flatness_mm:g} mm is not between 0 and 100 mm",
                    flatness_mm=self.flatness_mm,
                )
            )
        if self.scale_sd is not None and not 0 <= self.scale_sd <= LARGEST_SCALE_SD:
            raise WrongValue(
                Message(
                    "target.scale_absurd",
                    "a relative uncertainty of {scale_sd:g} of the size is not between 0 and {most:g}",
                    scale_sd=self.scale_sd,
                    most=LARGEST_SCALE_SD,
                )
            )

    def notes(self, target: Target, *, shape_known: bool = False) -> tuple[Message, ...]:
        """Note the size and flatness assumed of this `target`, where rig.toml states none; () where nothing is assumed.

        A bow of the camera's target is found in its views, so only the plane target's flatness is ever assumed, and
        that not where its shape is known from them. That the plane target's size is assumed is told by the fact
        `scale_assumed` of the fan, as a comparison with another target may still confirm it.
        """
        flatness = note_of("target.flatness_assumed", field=Field(f"{target}.flatness_mm", whole=True), mm=SUSPECTED_MM)
        notes = []
        if self.scale_sd is None and target == "camera_target":
            notes.append(size_assumed(target, SUSPECTED_SCALE))
        if self.flatness_mm is None and target == "plane_target" and not shape_known:
            notes.append(flatness)
        return tuple(notes)

    @property
    def size_sd(self) -> float:
        """Relative standard uncertainty of the board's size, stated or assumed."""
        return SUSPECTED_SCALE if self.scale_sd is None else self.scale_sd

    @property
    def flatness_sd_mm(self) -> float:
        """Standard deviation in mm of how far the board's edges are off its plane, stated or assumed."""
        return SUSPECTED_MM if self.flatness_mm is None else self.flatness_mm

    @property
    def sd(self) -> Array:
        """Prior standard deviations (4,) of the board's shape parameters; 0 for those taken as known."""
        flatness = self.flatness_sd_mm
        aspect = self.size_sd * np.sqrt(2)  # the difference of two independent sizes
        return np.array([flatness, flatness, flatness, aspect])

    @property
    def free(self) -> NDArray[np.intp]:
        """Indices of the board's shape parameters that are to be estimated: those whose prior is not 0."""
        return np.flatnonzero(self.sd)


TRUE = BoardTolerance(0.0, 0.0)
"""Of a target that is as it should be."""

MADE: Mapping[str, BoardTolerance] = {
    "laser printer": BoardTolerance(SUSPECTED_MM, SUSPECTED_SCALE),
    "print shop": BoardTolerance(0.1, 2e-4),
    "chrome on glass": BoardTolerance(0.005, 1e-5),
}
"""How true targets usually are, by how they were made: a sheet fixed to a plate, a print on a sandwich of aluminium
(0.1 mm in 500 mm by its makers), and a photomask (a few micrometres)."""


@dataclass(frozen=True, eq=False, slots=True)
class Board:
    """The points of a flat board: their `middle` (2,) and `half` their extent (2,), in mm."""

    middle: Array = field(default_factory=lambda: np.zeros(2))
    half: Array = field(default_factory=lambda: np.ones(2))

    @classmethod
    def of(cls, points: Sequence[Array]) -> Board:
        """Make the board that just holds all target `points` (N, 3) of several views, in mm."""
        joined = np.concatenate(points)[:, :2]
        low, high = joined.min(axis=0), joined.max(axis=0)
        return cls((low + high) / 2, np.maximum((high - low) / 2, 1e-9))

    def changes(self, points: Array) -> Array:
        """Compute the derivatives (N, 3, 4) of flat board `points` (N, 3) by the four shape parameters."""
        off = points[:, :2] - self.middle
        x, y = (off / self.half).T
        derivative = np.zeros((len(points), 3, 4))
        derivative[:, 2, :3] = np.column_stack([x * x, y * y, x * y])
        derivative[:, 0, 3], derivative[:, 1, 3] = 0.5 * off[:, 0], -0.5 * off[:, 1]
        return derivative

    def shaped(self, points: Array, values: Array) -> Array:
        """Move flat board `points` (N, 3) in mm by the shape parameters `values` (4,): bow and size."""
        return np.asarray(points + self.changes(points) @ values, dtype=np.float64)


@dataclass(frozen=True, eq=False, slots=True)
class BoardShape:
    """A board's shape: `values` (4,) in the order of SHAPE_PARAMETERS and their `covariance` (4, 4)."""

    board: Board = field(default_factory=Board)

    values: Array = field(default_factory=lambda: np.zeros(4))
    covariance: Array = field(default_factory=lambda: np.zeros((4, 4)))

    @property
    def sd(self) -> Array:
        """Standard deviations (4,) of the board's estimated shape parameters."""
        return np.asarray(np.sqrt(np.maximum(np.diag(self.covariance), 0)), dtype=np.float64)

    @property
    def departure_mm(self) -> float:
        """Range of z in mm over the bowed board, its corners included; 0 if it is flat."""
        grid = np.linspace(-1, 1, 21)
        x, y = (axis.ravel() for axis in np.meshgrid(grid, grid))
        return float(np.ptp(self.values[0] * x * x + self.values[1] * y * y + self.values[2] * x * y))

    @property
    def surely_bowed(self) -> bool:
        """Whether the board's bow is larger than its estimated covariance explains by chance."""
        bow = self.values[:3]
        if not bow.any():
            return False
        chance = float(chdtrc(len(bow), bow @ np.linalg.pinv(self.covariance[:3, :3], hermitian=True) @ bow))
        return chance < SURE

    def shaped(self, points: Array) -> Array:
        """Move the points (N, 3) of a flat board in mm to where this bowed board has them."""
        return self.board.shaped(points, self.values)
