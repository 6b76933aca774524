"""Camera and light planes of the paper, with which most scenes of the tests are made.

Sun et al., Sensors 2023, 23, 13, §5.1 and eq. (6), doi:10.3390/s23010013.
"""

import numpy as np

from core.model import Camera

CAMERA = Camera(
    (3840, 2748),
    np.array([[4990.2635, 0.77900164, 1929.2399], [0, 4993.9024, 1279.1607], [0, 0, 1]]),
    np.array([0.0815, -0.3809, 0.0042, -0.0004]),
)
HALF = CAMERA.scaled(0.5)
"""The same at half resolution."""
PLANES = -np.array([[0.922, -7.397, -1.429], [1.321, -9.319, -0.992], [1.986, -12.52, -0.263]]) / 1000
"""π (3, 3) in 1/mm of the fan's lines, as published: rounded, so no exact pencil."""
