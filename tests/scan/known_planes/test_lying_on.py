"""Which points lie on a known plane."""

import numpy as np

from core.scan.known_planes.points_on_planes import PlaneAgreement, lying_on

SQUARE = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
PLANE = PlaneAgreement("plate", 9, 3, 0, 0.01, np.array([0.0, 0.0, 1 / 500]), SQUARE)


def test_a_point_lies_on_a_plane_that_it_is_near_and_within_the_outline_of():
    points = np.array([[0.0, 0.0, 500.0], [0.0, 0.0, 500.0], [0.0, 0.0, 450.0]])
    uv = np.array([[5.0, 5.0], [50.0, 5.0], [5.0, 5.0]])
    assert lying_on(points, uv, [PLANE]).tolist() == [True, False, False]


def test_no_point_near_a_plane_lies_on_it():
    assert lying_on(np.array([[0.0, 0.0, 450.0]]), np.array([[5.0, 5.0]]), [PLANE]).tolist() == [False]
