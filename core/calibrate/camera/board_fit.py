"""Estimation of the board's shape together with camera and poses.

The shape changes each point by a fixed direction, so that its columns stand beside the camera's in the normal
equations with the poses eliminated; after each step the camera is solved anew with the points where the board has
them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.calibrate.board_shape import Board, BoardShape, BoardTolerance
from core.calibrate.camera.bundle import Bundle, Normal, Observed, normal_equations
from core.calibrate.camera.covariance import SharedErrorFactors, free_covariance
from core.model.arrays import Array
from core.model.residuals import over_picture

PICTURE_CELLS = (8, 6)
"""Columns and rows of the parts of a picture in which all views may err alike: many against the camera's parameters,
and each with corners of several views."""


@dataclass(frozen=True, eq=False, slots=True)
class BoardFit:
    """Estimate of a board: its tolerance as prior, and the `values` (4,) of its shape so far."""

    board: Board
    tolerance: BoardTolerance
    values: Array

    @property
    def free(self) -> NDArray[np.intp]:
        """Indices of the board's shape parameters that are to be estimated."""
        return self.tolerance.free

    def shaped(self, flat: Sequence[Observed]) -> list[Observed]:
        """Replace the target points in views of a `flat` board by those of the board with its present shape."""
        return [replace(view, points=self.board.shaped(view.points, self.values)) for view in flat]

    def _normal(self, bundle: Bundle, flat: Sequence[Observed], free: NDArray[np.intp]) -> Normal:
        """Normal equations of the camera's `free` parameters and, behind them, the shape's, the poses eliminated."""
        changes = [self.board.changes(view.points)[..., self.free] for view in flat]
        return normal_equations(bundle, self.shaped(flat), free, changes)

    def covariance(
        self, bundle: Bundle, flat: Sequence[Observed], free: NDArray[np.intp], freedom: int
    ) -> tuple[Array, SharedErrorFactors]:
        """Compute the covariance of the camera's `free` and the board's parameters, and how it was widened.

        Raises
        ------
        numpy.linalg.LinAlgError
            When the views do not determine them.
        """
        normal = self._normal(bundle, flat, free)
        precision = self._precision(normal.cost / max(freedom, 1), len(free))
        cells = [over_picture(view.uv, bundle.camera.image_size, PICTURE_CELLS) for view in flat]
        return free_covariance(normal, [view.points for view in flat], cells, freedom, precision)

    def shape(self, covariance: Array, camera_parameters: int) -> BoardShape:
        """Make the board's shape, with the part of `covariance` (F + S, F + S) behind the camera's F parameters."""
        own = np.zeros((len(self.values), len(self.values)))
        own[np.ix_(self.free, self.free)] = covariance[camera_parameters:, camera_parameters:]
        return BoardShape(self.board, self.values, own)

    def _precision(self, variance: float, camera_parameters: int) -> Array:
        """Diagonal that the prior adds to the information, for residuals of `variance` per unit weight."""
        own = variance / self.tolerance.sd[self.free] ** 2
        return np.concatenate([np.zeros(camera_parameters), own])

    def step(self, bundle: Bundle, flat: Sequence[Observed], free: NDArray[np.intp], freedom: int) -> BoardFit:
        """Improve the board's shape by one Gauss–Newton step, in which camera and poses change too.

        Raises
        ------
        numpy.linalg.LinAlgError
            When the views do not determine camera and shape.
        """
        normal = self._normal(bundle, flat, free)
        precision = self._precision(normal.cost / max(freedom, 1), len(free))
        gradient = np.sum([part.sum(axis=0) for part in normal.gradients], axis=0)
        gradient[len(free) :] -= precision[len(free) :] * self.values[self.free]
        information = normal.information.sum(axis=0) + np.diag(precision)
        scale = 1 / np.sqrt(np.maximum(np.diag(information), 1e-300))
        change = scale * np.linalg.solve(information * np.outer(scale, scale), scale * gradient)
        values = self.values.copy()
        values[self.free] += change[len(free) :]
        return replace(self, values=values)
