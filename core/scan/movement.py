"""How far the stripe has moved from one frame to another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.image.centreline import Centreline

SAMPLES = 60


def movement_px(now: Sequence[Centreline], before: Sequence[Centreline]) -> float:
    """Median distance in pixels, across the stripe, of the centrelines `now` from those `before`; NaN without any."""
    if not now or not before:
        return float("nan")
    uv = np.concatenate([piece.uv for piece in now])
    normal = np.concatenate([piece.normal for piece in now])
    others = np.concatenate([piece.uv for piece in before])
    few, some = max(1, len(uv) // SAMPLES), max(1, len(others) // (4 * SAMPLES))
    uv, normal, others = uv[::few], normal[::few], others[::some]
    apart = others[None, :, :] - uv[:, None, :]
    across = np.abs(np.einsum("nmi,ni->nm", apart, normal))
    nearest = np.argmin(np.sum(apart**2, axis=2), axis=1)
    return float(np.median(across[np.arange(len(uv)), nearest]))
