"""exp(−y) in plain multiplications, so that compiled loops over pixels do many at once."""

from __future__ import annotations

from numba import njit

_FAR = 16.0  # beyond, the light of a stripe is gone


@njit(cache=True, nogil=True, error_model="numpy", fastmath=True)
def bell(y: float) -> float:
    """exp(−y) for y ≥ 0, within 1e-7: Taylor's series of the sixteenth part, squared four times."""
    t = min(y, _FAR) * (1 / 16)
    tail = 1 - t / 4 * (1 - t / 5 * (1 - t / 6 * (1 - t / 7)))
    p = 1 - t * (1 - t / 2 * (1 - t / 3 * tail))
    p *= p
    p *= p
    p *= p
    return p * p
