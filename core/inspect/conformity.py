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
    if not tolerance_mm > 0 or not U_mm >= 0 or deviation_mm != deviation_mm:
        raise ValueError(f"no decision from deviation {deviation_mm}, tolerance {tolerance_mm} and U {U_mm}")
    if abs(deviation_mm) + U_mm <= tolerance_mm:
        return CONFORMING
    if abs(deviation_mm) - U_mm > tolerance_mm:
        return NOT_CONFORMING
    return NOT_PROVEN
