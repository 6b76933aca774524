"""How far errors that corners share seem to widen a camera's covariance by chance alone."""

import numpy as np
import pytest

from core.calibrate.camera.bundle import Normal
from core.calibrate.camera.covariance import SharedErrorFactors, free_covariance

FREE, CORNERS = 5, 30


def independent(rng: np.random.Generator, seen: np.ndarray) -> SharedErrorFactors:
    """Factors of views (V, FREE) that see each parameter so well, whose corners err independently by 1."""
    views = len(seen)
    design = rng.normal(size=(views, 2 * CORNERS, FREE)) * seen[:, None]
    stacked = design.reshape(-1, FREE)
    noise = rng.normal(size=len(stacked))
    left = noise - stacked @ np.linalg.lstsq(stacked, noise, rcond=None)[0]
    shares = (design * left.reshape(views, -1, 1)).reshape(views, CORNERS, 2, FREE).sum(axis=2)
    normal = Normal(np.swapaxes(design, 1, 2) @ design, tuple(shares), float(left @ left))
    board = [np.pad(np.arange(CORNERS, dtype=np.float64)[:, None], ((0, 0), (0, 2)))] * views
    cells = [np.arange(CORNERS) % 6] * views
    return free_covariance(normal, board, cells, len(left) - FREE)[1]


@pytest.mark.parametrize(
    "seen",
    [
        pytest.param(np.ones((6, FREE)), id="each view sees all alike"),
        pytest.param(0.05 + 3.0 * np.eye(6)[:, :FREE] + 0.2 * np.eye(6, FREE, -1), id="each sees another parameter"),
        pytest.param(np.geomspace(1, 8, 6)[:, None] * np.ones(FREE), id="one sees most of all"),
    ],
)
def test_independent_corners_seem_to_err_together_as_rarely_as_stated(seen):
    rng = np.random.default_rng(3)
    drawn = [independent(rng, seen) for _ in range(500)]
    beyond = np.mean([one.within_views > 1 + 2 * one.chance for one in drawn])
    assert 0.004 <= beyond <= 0.06, "2.3 % of a normal distribution"
