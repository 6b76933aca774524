"""Readings of an acceptance check from the points of spheres and planes, fitted as VDI/VDE 2634 part 2 asks for.

Fits by plain least squares with nothing weighted; of the points three in a thousand may be left out, the worst. Form
and flatness are ranges: they grow with the number of points and hold their noise, as the guideline wants them to.

References
----------
VDI/VDE 2634 part 2:2012 (probing, sphere-spacing and flatness error; 3 ‰ of the points may be left out).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from core.model.arrays import Array

LEFT_OUT = 0.003
"""Share of the points that may be left out."""
ROUNDS = 20
FEWEST = 12


@dataclass(frozen=True, eq=False, slots=True)
class ProbedSphere:
    """A sphere by least squares: `centre` (3,), `diameter`, `form` (range of radial distances), in mm; points used."""

    centre: Array
    diameter: float
    form: float
    points: int


def probed_sphere(points: Array) -> ProbedSphere:
    """The sphere of free radius through (N, 3) points in mm.

    Raises
    ------
    ValueError
        If there are fewer than FEWEST points, or they lie in one plane.
    """
    _enough(points, "sphere")
    fitted, residuals, used = _trimmed(points, _sphere)
    return ProbedSphere(fitted[:3], 2 * float(fitted[3]), float(np.ptp(residuals)), used)


def probed_flatness(points: Array) -> tuple[float, int]:
    """Range in mm of the distances of (N, 3) points from their plane, and how many were used; ValueError as above."""
    _enough(points, "plane")
    _, residuals, used = _trimmed(points, _plane)
    return float(np.ptp(residuals)), used


def _enough(points: Array, what: str) -> None:
    if len(points) < FEWEST or not np.isfinite(points).all():
        raise ValueError(f"a {what} needs {FEWEST} finite points or more")


def _trimmed(points: Array, fit: Callable[[Array], tuple[Array, Callable[[Array], Array]]]) -> tuple[Array, Array, int]:
    """Parameters and residuals of the points kept: the worst LEFT_OUT of all are left out, until they stay the same."""
    kept = np.ones(len(points), dtype=bool)
    allowed = int(LEFT_OUT * len(points))
    for _ in range(ROUNDS):
        parameters, residuals_of = fit(points[kept])
        residuals = residuals_of(points)
        before, kept = kept, np.ones(len(points), dtype=bool)
        if allowed:
            kept[np.argsort(np.abs(residuals), kind="stable")[-allowed:]] = False
        if (kept == before).all():
            break
    return parameters, residuals[kept], int(kept.sum())


def _sphere(points: Array) -> tuple[Array, Callable[[Array], Array]]:
    """(4,) centre and radius of least orthogonal distances, by Gauss–Newton from the algebraic sphere."""
    middle = points.mean(axis=0)
    centred = points - middle
    start, _, rank, _ = np.linalg.lstsq(
        np.column_stack([2 * centred, np.ones(len(points))]), (centred**2).sum(axis=1), rcond=1e-9
    )
    if rank < 4:
        raise ValueError("the points of the sphere lie in one plane")
    centre, radius = start[:3], float(np.sqrt(start[3] + start[:3] @ start[:3]))
    for _ in range(50):
        away = centred - centre
        distance = np.linalg.norm(away, axis=1)
        design = np.column_stack([-away / distance[:, None], -np.ones(len(points))])
        step = np.linalg.lstsq(design, radius - distance, rcond=None)[0]
        centre, radius = centre + step[:3], radius + float(step[3])
        if np.abs(step).max() < 1e-10:
            break
    found = np.append(centre + middle, radius)
    return found, lambda all_points: np.asarray(np.linalg.norm(all_points - found[:3], axis=1) - found[3])


def _plane(points: Array) -> tuple[Array, Callable[[Array], Array]]:
    """(4,) unit normal and offset of least orthogonal distances."""
    middle = points.mean(axis=0)
    normal = np.linalg.svd(points - middle, full_matrices=False)[2][2]
    offset = float(normal @ middle)
    return np.append(normal, offset), lambda all_points: np.asarray(all_points @ normal - offset)
