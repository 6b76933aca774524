"""An acceptance check after the pattern of VDI/VDE 2634 part 2: spheres, a ball bar and a plane in several positions.

What is checked, each against a limit of its own:

- probing error, form: the range of the radial distances of a sphere's points from the sphere fitted to them;
- probing error, size: the fitted diameter less the calibrated one;
- sphere-spacing error: the measured distance of two spheres' centres less the calibrated one;
- flatness error: the range of the distances of a plane's points from the plane fitted to them.

Fits are by least squares, and three points in a thousand may be left out. The check follows the guideline's pattern; it
is no certificate, and nobody's accreditation stands behind it.

References
----------
VDI/VDE 2634 part 2:2012, Optical 3-D measuring systems – Systems based on area scanning.
ISO 14253-1:2017 (the uncertainty of the check counts against whoever proves).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from core.inspect.conformity import CONFORMING, NOT_CONFORMING, NOT_PROVEN, Zones

Quantity: TypeAlias = Literal["form", "size", "spacing", "flatness"]
QUANTITIES: tuple[Quantity, ...] = get_args(Quantity)

POSITIONS: Mapping[Quantity, int] = {"form": 10, "size": 10, "spacing": 7, "flatness": 6}
"""Positions in the measuring volume that the guideline asks for."""
TITLES: Mapping[Quantity, str] = {
    "form": "probing error, form",
    "size": "probing error, size",
    "spacing": "sphere-spacing error",
    "flatness": "flatness error",
}
PATTERN = "Acceptance check after the pattern of VDI/VDE 2634 part 2; not a certificate."


@dataclass(frozen=True, slots=True)
class Reading:
    """One quantity of one artefact in one position.

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
        Standard uncertainty of the calibrated value (and of whatever else the check adds), in mm.
    """

    quantity: Quantity
    position: str
    measured: float
    calibrated: float = 0.0
    u: float = 0.0

    @property
    def error(self) -> float:
        """Measured − calibrated."""
        return self.measured - self.calibrated


@dataclass(frozen=True, slots=True)
class CheckedQuantity:
    """All positions of one quantity against its limit.

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
    def title(self) -> str:
        """In words."""
        return TITLES[self.quantity]

    @property
    def worst(self) -> Reading:
        """The reading with the largest magnitude of error."""
        return max(self.readings, key=lambda one: abs(one.error))

    @property
    def largest_error(self) -> float:
        """Error of the worst reading, with its sign."""
        return self.worst.error

    def verdict_of(self, reading: Reading) -> str:
        """Decision on one reading, "" without a limit."""
        return "" if self.limit is None else Zones(-self.limit, self.limit, self.k * reading.u).verdict(reading.error)

    @property
    def verdict(self) -> str:
        """Of the worst of the readings: one that does not conform is enough, all must conform."""
        return _worst(self.verdict_of(one) for one in self.readings)

    @property
    def enough_positions(self) -> bool:
        """Whether there are as many positions as the guideline asks for."""
        return len({one.position for one in self.readings}) >= POSITIONS[self.quantity]


@dataclass(frozen=True, slots=True)
class AcceptanceCheck:
    """The check: one entry for each quantity read."""

    quantities: tuple[CheckedQuantity, ...]

    @property
    def verdict(self) -> str:
        """Of the worst quantity with a limit; "" if none has one."""
        return _worst(one.verdict for one in self.quantities if one.verdict)

    @property
    def notes(self) -> tuple[str, ...]:
        """What to know about the figures, whole sentences; the first says what this is and is not."""
        said = [PATTERN]
        for one in self.quantities:
            if not one.enough_positions:
                count = len({reading.position for reading in one.readings})
                said.append(f"{one.title}: {count} of the {POSITIONS[one.quantity]} positions the guideline asks for.")
            if one.limit is not None and not any(reading.u for reading in one.readings):
                said.append(f"{one.title}: no uncertainty of the artefact was stated; the verdict takes it as nothing.")
        return tuple(said)


def acceptance_check(
    readings: Sequence[Reading], limits: Mapping[Quantity, float] | None = None, *, k: float = 2.0
) -> AcceptanceCheck:
    """Check `readings` against `limits` in mm by quantity.

    Raises
    ------
    ValueError
        If there is no reading, or a limit is not above 0.
    """
    limits = limits or {}
    if not readings:
        raise ValueError("an acceptance check needs a reading")
    for quantity, limit in limits.items():
        if not limit > 0:
            raise ValueError(f"a limit of {limit} for {TITLES[quantity]} is none")
    found = []
    for quantity in QUANTITIES:
        mine = tuple(one for one in readings if one.quantity == quantity)
        if mine:
            found.append(CheckedQuantity(quantity, mine, limits.get(quantity), k))
    return AcceptanceCheck(tuple(found))


def _worst(verdicts: Iterable[str]) -> str:
    found = set(verdicts)
    return next((one for one in (NOT_CONFORMING, NOT_PROVEN, CONFORMING) if one in found), "")
