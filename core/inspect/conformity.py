"""The decision rule: what a measured deviation proves about a tolerance."""

from __future__ import annotations

CONFORMING = "conforming"
NOT_CONFORMING = "not conforming"
NOT_PROVEN = "not proven"


def decide(deviation_mm: float, tolerance_mm: float, U_mm: float) -> str:
    """Conformity with the tolerance ± `tolerance_mm` by ISO 14253-1, for the maker of a part.

    The expanded uncertainty U narrows the tolerance for the proof of conformity and widens it for the proof of
    nonconformity; between the two nothing is proven.

    Parameters
    ----------
    deviation_mm
        Measured − nominal.
    tolerance_mm
        Largest permitted deviation, to either side.
    U_mm
        Expanded uncertainty of the deviation.

    Returns
    -------
    str
        "conforming", "not conforming" or "not proven".

    Raises
    ------
    ValueError
        If the tolerance is not positive, U is negative, or a value is not a number.

    References
    ----------
    ISO 14253-1, Decision rules for verifying conformity or nonconformity with specifications, with U as guard band.

    Examples
    --------
    >>> decide(0.05, 0.20, 0.10), decide(0.15, 0.20, 0.10), decide(-0.35, 0.20, 0.10)
    ('conforming', 'not proven', 'not conforming')
    """
    if not tolerance_mm > 0:
        raise ValueError(f"no decision from a tolerance of {tolerance_mm}")
    return decide_between(deviation_mm, -tolerance_mm, tolerance_mm, U_mm)


def decide_between(deviation: float, lower: float, upper: float, U: float) -> str:
    """Conformity with deviations permitted from `lower` to `upper` (±inf: no limit), by the same rule, in any one unit.

    Raises
    ------
    ValueError
        If the limits are not in order, U is negative, or a value is not a number.

    Examples
    --------
    >>> decide_between(0.03, -0.01, 0.05, 0.01), decide_between(0.045, float("-inf"), 0.05, 0.01)
    ('conforming', 'not proven')
    """
    if not lower <= upper or not U >= 0 or deviation != deviation:
        raise ValueError(f"no decision from deviation {deviation}, limits {lower} to {upper} and U {U}")
    if lower + U <= deviation <= upper - U:
        return CONFORMING
    if deviation < lower - U or deviation > upper + U:
        return NOT_CONFORMING
    return NOT_PROVEN
