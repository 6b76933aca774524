"""An acceptance check after the pattern of VDI/VDE 2634 part 2: spheres, a ball bar and a plane in several positions.

What is checked, each against a limit of its own:

- probing error, form: the range of the radial distances of a sphere's points from the sphere fitted to them;
- probing error, size: the fitted diameter less the calibrated one;
- sphere-spacing error: the measured distance of two spheres' centres less the calibrated one;
- flatness error: the range of the distances of a plane's points from the plane fitted to them.

Fits are by plain least squares with nothing weighted; of the points three in a thousand may be left out, the worst.
Form and flatness are ranges: they grow with the number of points and hold their noise, as the guideline wants them to.
The check follows the guideline's pattern; it is no certificate, and nobody's accreditation stands behind it.

References
----------
VDI/VDE 2634 part 2:2012, Optical 3-D measuring systems – Systems based on area scanning
(probing, sphere-spacing and flatness error; 3 ‰ of the points may be left out).
ISO 14253-1:2017 (the uncertainty of the check counts against whoever proves).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np

from core.checks.artefact_check import left_by_check
from core.errors import WrongValue
from core.findings.proof import Doubt, Doubts, notes_of
from core.findings.table import note_of
from core.inspect.conformity import Limits, Verdict, decide
from core.messages import Message, label
from core.model.arrays import Array
from core.wings.studies.kinds.doubted import doubted_among, doubts_of_study

LEFT_OUT = 0.003
"""Share of the points that may be left out."""
ROUNDS = 20
"""Of fitting and leaving out, at most; it ends when the worst points stay the same."""
FEWEST = 12
"""Points of an artefact: three times what a sphere needs."""


@dataclass(frozen=True, eq=False, slots=True)
class ProbedSphere:
    """Sphere by least squares: `centre` (3,), `diameter`, `form` (range of radial distances), in mm; points used."""

    centre: Array
    diameter: float
    form: float
    points: int


def probed_sphere(points: Array) -> ProbedSphere:
    """Fit a sphere of free radius to points (N, 3) in mm: diameter, form and the points used.

    Raises
    ------
    WrongValue
        If there are fewer than FEWEST points, or they lie in one plane.
    """
    _enough(points, label("sphere"))
    fitted, residuals, used = _trimmed(points, _sphere)
    return ProbedSphere(fitted[:3], 2 * float(fitted[3]), float(np.ptp(residuals)), used)


def probed_flatness(points: Array) -> tuple[float, int]:
    """Compute the range in mm of the distances of points (N, 3) from a fitted plane, and how many points were used."""
    _enough(points, label("plane"))
    _, residuals, used = _trimmed(points, _plane)
    return float(np.ptp(residuals)), used


def _enough(points: Array, what: str) -> None:
    if len(points) < FEWEST or not np.isfinite(points).all():
        raise WrongValue(
            Message(
                "study.too_few_points", "a {artefact} needs {least} finite points or more", artefact=what, least=FEWEST
            )
        )


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
        raise WrongValue(Message("study.sphere_flat", "the points of the sphere lie in one plane"))
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


Quantity: TypeAlias = Literal["form", "size", "spacing", "flatness"]
QUANTITIES: tuple[Quantity, ...] = get_args(Quantity)

POSITIONS: Mapping[Quantity, int] = {"form": 10, "size": 10, "spacing": 7, "flatness": 6}
"""Positions in the measuring volume that the guideline asks for."""
TITLES: Mapping[Quantity, Message] = {
    "form": Message("study.probing_form", "probing error, form"),
    "size": Message("study.probing_size", "probing error, size"),
    "spacing": Message("study.sphere_spacing", "sphere-spacing error"),
    "flatness": Message("study.flatness_error", "flatness error"),
}
PATTERN = note_of("study.after_the_guideline")


@dataclass(frozen=True, slots=True)
class Reading:
    """Reading of one quantity of one artefact in one position.

    Parameters
    ----------
    quantity
        "form" and "flatness" are ranges, "size" a diameter, "spacing" a distance.
    position
        Where the artefact stood, in words.
    measured
        In mm.
    calibrated
        Of the artefact, in mm; 0 for form and flatness, whose artefact must be much better than the limit.
    u
        Standard uncertainty of the calibrated value (and of whatever else the check adds), in mm; 0 if not stated.
    doubts
        By what facts of its scan it proves nothing; those that an artefact is measured to clear up do not count.
    """

    quantity: Quantity
    position: str
    measured: float
    calibrated: float = 0.0
    u: float = 0.0
    doubts: Doubts = ()

    @property
    def error(self) -> float:
        """Error of the reading in mm, measured − calibrated."""
        return self.measured - self.calibrated


@dataclass(frozen=True, slots=True)
class CheckedQuantity:
    """Readings of one quantity in all positions against its limit.

    Parameters
    ----------
    quantity
        Which.
    readings
        In the order given.
    limit
        Largest permitted magnitude of the error in mm; None: none was stated.
    k
        Coverage factor of U = k·u.
    """

    quantity: Quantity
    readings: tuple[Reading, ...]
    limit: float | None
    k: float

    @property
    def title(self) -> Message:
        """Name of the quantity that is checked, as "probing error, form"."""
        return TITLES[self.quantity]

    @property
    def worst(self) -> Reading:
        """Reading with the error of the largest magnitude."""
        return max(self.readings, key=lambda one: abs(one.error))

    @property
    def largest_error(self) -> float:
        """Error of the largest magnitude among the readings, in mm with its sign."""
        return self.worst.error

    def verdict_of(self, reading: Reading) -> Verdict:
        """Decide whether the error of one reading is within ± the limit; `Verdict.NONE` without a limit."""
        doubts = (*left_by_check(reading.doubts), *(self._of_artefact if reading.u <= 0 else ()))
        return decide(reading.error, Limits.around(0.0, self.limit), self.k * reading.u, doubts)

    @property
    def doubts(self) -> Doubts:
        """Reasons why the readings prove nothing: doubts of their scans, or an artefact without uncertainty.

        () for none.
        """
        doubted = doubted_among((reading.position, left_by_check(reading.doubts)) for reading in self.readings)
        return (*doubts_of_study(doubted), *self._of_artefact)

    @property
    def _of_artefact(self) -> Doubts:
        """That readings prove nothing whose artefact has no uncertainty; () where all have one."""
        if all(reading.u > 0 for reading in self.readings):
            return ()
        return (Doubt.of(note_of("study.artefact_without_u", what=self.title)),)

    @property
    def verdict(self) -> Verdict:
        """Verdict on this quantity: the worst verdict among its readings; `Verdict.NONE` without a limit."""
        return Verdict.worst(self.verdict_of(one) for one in self.readings)

    @property
    def positions(self) -> int:
        """Number of different positions that the readings were taken in."""
        return len({one.position for one in self.readings})

    @property
    def enough_positions(self) -> bool:
        """Whether readings were taken in as many positions as VDI/VDE 2634 part 2 requires."""
        return self.positions >= POSITIONS[self.quantity]


@dataclass(frozen=True, slots=True)
class AcceptanceCheck:
    """Acceptance check: one entry for each quantity read."""

    quantities: tuple[CheckedQuantity, ...]

    @property
    def verdict(self) -> Verdict:
        """Verdict on the check: the worst among the quantities with a limit; `Verdict.NONE` if none has a limit."""
        return Verdict.worst(one.verdict for one in self.quantities)

    @property
    def notes(self) -> tuple[Message, ...]:
        """Notes on the check: that it is no certificate, where positions are too few, and doubts."""
        said = [PATTERN]
        for one in self.quantities:
            if not one.enough_positions:
                said.append(
                    note_of("study.few_positions", what=one.title, n=one.positions, all=POSITIONS[one.quantity])
                )
            if one.limit is not None:
                said += notes_of(one.doubts)
        return tuple(dict.fromkeys(said))  # what is in doubt by a scan is so for each quantity read from it


def acceptance_check(
    readings: Sequence[Reading], limits: Mapping[Quantity, float] | None = None, *, k: float = 2.0
) -> AcceptanceCheck:
    """Compare readings of artefacts with the permitted errors in mm, `limits`, of each quantity.

    Raises
    ------
    WrongValue
        If there is no reading, or a limit is not above 0.
    """
    limits = limits or {}
    if not readings:
        raise WrongValue(Message("study.no_reading", "an acceptance check needs a reading"))
    for quantity, limit in limits.items():
        if not limit > 0:
            raise WrongValue(
                Message(
                    "study.limit_not_positive",
                    "the limit for {quantity} must be above 0, not {limit}",
                    quantity=TITLES[quantity],
                    limit=limit,
                )
            )
    found = []
    for quantity in QUANTITIES:
        mine = tuple(one for one in readings if one.quantity == quantity)
        if mine:
            found.append(CheckedQuantity(quantity, mine, limits.get(quantity), k))
    return AcceptanceCheck(tuple(found))
