"""Grey levels of pictures in which targets are sought."""

from __future__ import annotations

import numpy as np
import pytest

from core.image.targets.picture import level_quantiles


@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
@pytest.mark.parametrize("size", [(1, 1), (1, 2), (7, 9), (40, 60)])
def test_quantiles_of_counted_levels_are_those_of_sorted_ones(
    kind: type[np.unsignedinteger], size: tuple[int, int]
) -> None:
    rng = np.random.default_rng(1)
    shares = (0.0, 0.002, 0.5, 0.98, 1.0, *rng.random(20))
    for limit in (1, 3, 200):
        levels: np.ndarray = rng.integers(0, limit, size).astype(kind)
        assert level_quantiles(levels, *shares) == [float(np.quantile(levels, share)) for share in shares]
