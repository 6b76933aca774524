"""Normal equations of unknowns that all poses have in common and six that each pose has of its own.

The poses' own unknowns are eliminated, so that the cost grows with their number and not with its cube. What each pose
adds to the equations of the common unknowns is kept: taken off again, it gives the solution of all other poses by one
Gauss–Newton step, without fitting anew.

References
----------
Triggs, B. et al., Bundle adjustment – a modern synthesis, Vision Algorithms (2000) 298–372, §6.1,
doi:10.1007/3-540-44480-7_21.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array

OWN = 6
"""Unknowns of a pose: a turn and a shift."""
SMALLEST = 1e-15
"""Share of the largest eigenvalue below which a direction is not determined: its variance is huge then."""


class PoseEquations:
    """Residuals in standard deviations near a state, with their derivatives.

    Parameters
    ----------
    residuals
        (M,).
    common
        (M, C), their derivatives by the common unknowns.
    own
        (M, 6), by those of the pose each belongs to.
    rows
        For each of P poses the indices of its residuals.
    known
        Residuals (K,) of what is known of the common unknowns, and their derivatives (K, C).
    """

    def __init__(
        self,
        residuals: Array,
        common: Array,
        own: Array,
        rows: Sequence[NDArray[np.intp]],
        known: tuple[Array, Array],
    ) -> None:
        self.residuals, self.common, self.own, self.rows = residuals, common, own, rows
        self.cost = float(residuals @ residuals + known[0] @ known[0])
        self._known = known
        joined = np.column_stack([own, common, residuals])
        parts = [joined[of_pose] for of_pose in rows]
        self._products = np.array([part.T @ part for part in parts])

    def by_first(self, count: int) -> PoseEquations:
        """Restrict the equations to the first `count` common unknowns; the other common unknowns are taken as known."""
        known = (self._known[0], self._known[1][:, :count])
        return PoseEquations(self.residuals, self.common[:, :count], self.own, self.rows, known)

    def step(self, damping: float) -> Array:
        """Solve for the step (C + 6P,) of C common unknowns, then of P poses, with a Levenberg `damping`."""
        normal, gradient, followed = self._reduced(damping)
        common = -_solved(normal, gradient)
        own = -(followed[..., -1] + followed[..., :-1] @ common)
        return np.concatenate([common, own.ravel()])

    @property
    def covariance(self) -> Array:
        """Covariance (C, C) of the common unknowns, for residuals of unit variance."""
        return inverse(self._reduced(0.0)[0])

    def followed_by(self, first: int) -> Array:
        """Compute how the first common unknowns follow a change of the others, (first, C − first), poses adjusted."""
        normal = self._reduced(0.0)[0]
        return np.asarray(-inverse(normal[:first, :first]) @ normal[:first, first:], dtype=np.float64)

    def leverages(self) -> Array:
        """Compute the leverage (M,), 0 … 1, of each residual: the share of its error that the fit takes up."""
        inverse_own = np.array([inverse(products[:OWN, :OWN]) for products in self._products])
        covariance = self.covariance
        shares = np.zeros(len(self.residuals))
        for rows, products, of_own in zip(self.rows, self._products, inverse_own, strict=True):
            own, common = self.own[rows], self.common[rows]
            left = common - own @ (of_own @ products[:OWN, OWN:-1])
            shares[rows] = ((own @ of_own) * own).sum(axis=1) + ((left @ covariance) * left).sum(axis=1)
        return shares

    def steps_without_each(self) -> Array:
        """Compute for each of P poses how leaving it out would move the C common unknowns, (P, C), to first order."""
        normal, gradient, _ = self._reduced(0.0)
        return np.array([-inverse(normal - part[:, :-1]) @ (gradient - part[:, -1]) for part in self._parts()])

    def _parts(self) -> Array:
        """(P, C, C + 1): what each pose adds to the normal matrix and gradient of the common unknowns."""
        own, mixed = self._products[:, :OWN, :OWN], self._products[:, :OWN, OWN:]
        followed = np.linalg.solve(own, mixed)
        parts: Array = self._products[:, OWN:-1, OWN:] - mixed[..., :-1].transpose(0, 2, 1) @ followed
        return parts

    def _reduced(self, damping: float) -> tuple[Array, Array, Array]:
        """Normal matrix (C, C) and gradient (C,) of the common unknowns, and how each pose follows."""
        own, mixed = self._products[:, :OWN, :OWN].copy(), self._products[:, :OWN, OWN:]
        every = np.arange(OWN)
        own[:, every, every] += damping * _positive(own[:, every, every])
        followed = np.linalg.solve(own, mixed)
        total = self._products[:, OWN:-1, OWN:].sum(axis=0)
        residuals, jacobian = self._known
        total += jacobian.T @ np.column_stack([jacobian, residuals])
        every = np.arange(len(total))
        total[every, every] += damping * _positive(total[every, every])
        total -= np.einsum("pik,pil->kl", mixed[..., :-1], followed, optimize=True)
        return total[:, :-1], total[:, -1], followed


def inverse(normal: Array) -> Array:
    """Invert a normal matrix (N, N), scaled to a unit diagonal first, as mm, rad and 1/mm differ by orders of size."""
    scale = np.sqrt(_positive(np.diag(normal)))
    values, vectors = np.linalg.eigh(normal / np.outer(scale, scale))
    values = np.maximum(values, SMALLEST * values[-1])
    found: Array = (vectors / values) @ vectors.T / np.outer(scale, scale)
    return found


def _solved(normal: Array, gradient: Array) -> Array:
    scale = np.sqrt(_positive(np.diag(normal)))
    return np.asarray(np.linalg.solve(normal / np.outer(scale, scale), gradient / scale) / scale, dtype=np.float64)


def _positive(values: Array) -> Array:
    return np.asarray(np.where(values > 0, values, 1.0), dtype=np.float64)
