"""Is this laser's fan the pencil it is said to be?

The free fit of the planes with its covariance is all that the pictures say. A pencil is fitted to it; the sum of
squares that is left, in units of that covariance, tells whether the pencil describes the planes as well as no pencil.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.special import fdtrc

from core.calibrate.fan.bundle import Bundle
from core.calibrate.fan.pencil import FreePlanes, Pencil, PlaneSet, pencil_near
from core.calibrate.levenberg import DenseProblem, minimise
from core.messages import Message, decimals_of
from core.model import Fan, LightPlane
from core.model.arrays import Array

SIGNIFICANT = 0.01
"""A constraint is refused when chance alone would be this unkind more rarely than this."""

Constrained = Literal["auto", "always", "axis", "never"]
"""Hold the planes to the pencil where that suits the laser; always; to its axis only; not at all."""


@dataclass(frozen=True, eq=False, slots=True)
class Verdict:
    """Decision whether to use free planes or a pencil, and its reason.

    `start` are the planes to solve for in the end, `constrained_angles` those of the constrained planes; `converged`
    is whether the pencils compared were fitted to the end. The other fields are those of
    :class:`core.calibrate.results.FanCalibration`.
    """

    start: PlaneSet
    constrained_angles: tuple[float, ...]
    suits: bool | None
    pencil_gap_mm: float
    pencil_gap_sd_mm: float
    sentence: Message
    converged: bool = True


@dataclass(frozen=True, eq=False, slots=True)
class _Trial:
    """A pencil fitted to the free planes, and the probability of so bad a fit by chance."""

    pencil: Pencil
    p: float
    converged: bool


def judge(free: Bundle, volume: Sequence[Array], angle: float | None, constrained: Constrained) -> Verdict:
    """Decide whether the light planes are held to a pencil (one common axis), by how well the free ones fit it.

    Parameters
    ----------
    free
        The free fit.
    volume
        For each line, points (n_k, 3) in mm on it that span the work volume.
    angle
        In rad, fixed between neighbours; None: only the common axis is a constraint.
    constrained
        What to use, or "auto" for what suits the laser.
    """
    pis = free.planes.pis
    count = len(pis)
    free_angles = fan_of(free.planes).angles
    if count == 1 or (count == 2 and angle is None):
        sentence = Message("fan.one_plane", "one light plane: there is no pencil to hold it to")
        if count == 2:
            sentence = Message(
                "fan.two_planes", "two planes at an unknown angle always are a pencil: nothing constrains them"
            )
        return Verdict(FreePlanes(pis), free_angles, None, 0.0, math.nan, sentence)
    axis_only = _trial(free, None)
    gap, gap_sd = _gap(free, axis_only.pencil, volume)
    tied = axis_only if angle is None else _trial(free, angle)
    suits = tied.p >= SIGNIFICANT
    suited = "always" if suits else "axis" if axis_only.p >= SIGNIFICANT else "never"
    choices: dict[str, PlaneSet] = {"always": tied.pencil, "axis": axis_only.pencil, "never": FreePlanes(pis)}
    start = choices[suited if constrained == "auto" else constrained]
    return Verdict(
        start,
        fan_of(tied.pencil).angles,
        suits,
        gap,
        gap_sd,
        _sentence(start, tied, axis_only, free, angle, (gap, gap_sd), constrained != "auto"),
        tied.converged and axis_only.converged,
    )


def fan_of(planes: PlaneSet, covariance: Array | None = None) -> Fan:
    """Make a fan of the N planes of a set, with the `covariance` (3N, 3N) of their π, if given."""
    return Fan(tuple(LightPlane(pi) for pi in planes.pis), covariance)


def _trial(free: Bundle, angle: float | None) -> _Trial:
    """Fit a pencil to the free planes with their covariance as the weight."""
    pis = free.planes.pis
    scale = np.sqrt(np.diag(free.covariance))
    whiten = np.linalg.inv(np.linalg.cholesky(free.covariance / np.outer(scale, scale))) / scale

    def linearise(pencil: Pencil) -> DenseProblem:
        return DenseProblem(whiten @ (pencil.pis - pis).ravel(), whiten @ pencil.jacobian)

    solution = minimise(pencil_near(pis, angle), linearise, Pencil.moved)
    constraints = pis.size - solution.linear.jacobian.shape[1]
    if constraints == 0:
        return _Trial(solution.state, 1.0, solution.converged)
    excess = solution.linear.cost / constraints
    p = float(fdtrc(constraints, max(free.freedom, 1.0), excess))
    return _Trial(solution.state, p, solution.converged)


def _gap(free: Bundle, pencil: Pencil, volume: Sequence[Array]) -> tuple[float, float]:
    """Largest distance in mm of a free plane from the pencil's in the volume, and its standard deviation there."""
    found = []
    for line, (pi, own, points) in enumerate(zip(pencil.pis, free.planes.pis, volume, strict=True)):
        moved = _onto(own, points)
        distances = np.abs(LightPlane(pi).distances(moved))
        most, block = int(distances.argmax()), slice(3 * line, 3 * line + 3)
        variance = moved[most] @ free.covariance[block, block] @ moved[most]
        found.append((float(distances[most]), math.sqrt(max(variance, 0.0)) / float(np.linalg.norm(own))))
    return max(found)


def _onto(pi: Array, points: Array) -> Array:
    """`points` (N, 3) moved at right angles onto the plane π."""
    return points - np.outer(LightPlane(pi).distances(points), pi / np.linalg.norm(pi))


def _sentence(
    start: PlaneSet,
    tied: _Trial,
    axis_only: _Trial,
    free: Bundle,
    angle: float | None,
    gap: tuple[float, float],
    asked: bool,
) -> Message:
    """What the comparison found and which planes are used; `gap` in mm with its standard deviation."""
    gap_mm, gap_sd_mm = gap
    fan = fan_of(free.planes, free.covariance)
    angles = tuple(
        Message(
            "fan.angle_with_sd",
            "{angle:.{places}f}° (u = {sd:.{places}f}°)",
            angle=found,
            sd=sd,
            places=max(decimals_of(sd), 0),
        )
        for found, sd in zip(np.degrees(fan.angles), np.degrees(fan.angle_sds), strict=True)
    )
    if angle is None:
        wanted = Message("fan.one_axis", "one common axis")
    else:
        wanted = Message(
            "fan.one_axis_and_angles", "one common axis and angles of {angle:g}°", angle=float(np.degrees(angle))
        )
    if tied.p >= SIGNIFICANT:
        finding = Message("fan.suits", "{wanted}: this suits the laser", wanted=wanted)
    elif angle is not None and axis_only.p >= SIGNIFICANT:
        finding = Message(
            "fan.suits_but_angles",
            "{wanted}: this does not suit the laser; its planes do share an axis, but not at these angles",
            wanted=wanted,
        )
    else:
        finding = Message("fan.suits_not", "{wanted}: this does not suit the laser", wanted=wanted)
    if isinstance(start, FreePlanes):
        use = Message("fan.free_planes_used", "the freely fitted planes are used")
    elif start is axis_only.pencil and angle is not None:
        use = Message("fan.free_angles_used", "a pencil with free angles is used")
    else:
        use = Message("fan.constrained_used", "the constrained planes are used")
    if asked:
        use = Message("fan.used_as_asked", "{use}, as asked", use=use)
    return Message(
        "fan.verdict",
        "{finding} (fitted freely, the angles are {angles}, and the planes miss one axis by up to {gap:.{places}f} mm; "
        "p = {p:.2g}, below {limit:g} it is refused); {use}",
        finding=finding,
        angles=angles,
        gap=gap_mm,
        places=max(decimals_of(gap_sd_mm), 0),
        p=tied.p,
        limit=SIGNIFICANT,
        use=use,
    )
