"""A carrier seen in two views without pictures: the marks' centres, with the noise that is stated of them."""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from core.model import Camera, Pose
from core.simulate.effects.carrier import CarrierBeside
from core.simulate.scenario import Scenario
from core.simulate.scene.carrier import calibrated_carrier, true_positions
from core.views.carrier import Carrier
from core.views.joint import predicted_centres
from core.views.marks_seen import MarksSeen

CAMERA = Camera(
    (1920, 1374), np.array([[2495.0, 0.0, 964.0], [0, 2497.0, 640.0], [0, 0, 1]]), np.array([0.08, -0.38, 0, 0])
)
SIGMA_PX = 0.03
UP = np.diag([1.0, -1.0, -1.0])
"""Side A towards the camera."""


def carrier(seed: int = 0, marks: int = 12) -> Carrier:
    """As calibrated, off the truth by what it states."""
    return calibrated_carrier(Scenario(seed=seed, carrier=CarrierBeside(marks=marks)))


def exact(known: Carrier) -> Carrier:
    """The same with its true positions."""
    true = true_positions(len(known) // 2)[1]
    return replace(known, positions=true)


def poses(seed: int = 0) -> tuple[Pose, Pose]:
    """Side A up, then turned over and put down elsewhere."""
    rng = np.random.default_rng(seed)
    found = []
    for turned in (UP, UP @ np.diag([1.0, -1.0, -1.0])):
        tilt = Rotation.from_rotvec(rng.normal(0, 0.05, 3)).as_matrix()
        found.append(Pose(tilt @ turned, np.array([0.0, 50.0, 535.0]) + rng.normal(0, 3, 3)))
    return found[0], found[1]


def seen_in(
    true: Carrier, pose: Pose, side: int, rng: np.random.Generator, view: str, sigma: float = SIGMA_PX
) -> MarksSeen:
    """The marks of a side as the camera sees them."""
    numbers = true.numbers[true.on(side)]
    empty = MarksSeen(numbers, np.zeros((len(numbers), 2)), np.tile(sigma**2 * np.eye(2), (len(numbers), 1, 1)), view)
    uv = predicted_centres(true, true.positions, pose, empty, CAMERA) + sigma * rng.standard_normal((len(numbers), 2))
    return MarksSeen(numbers, uv, empty.covariance, view)


def both_seen(known: Carrier, seed: int = 0, sigma: float = SIGMA_PX) -> tuple[MarksSeen, MarksSeen]:
    """Both views of a carrier."""
    rng, true, (first, second) = np.random.default_rng(seed + 100), exact(known), poses(seed)
    return seen_in(true, first, 0, rng, "scan", sigma), seen_in(true, second, 1, rng, "turned", sigma)
