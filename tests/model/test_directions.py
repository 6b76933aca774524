import numpy as np

from core.model.directions import square_to


def test_the_two_are_units_square_to_the_direction_and_to_each_other():
    directions = np.vstack([np.random.default_rng(3).normal(size=(200, 3)), np.eye(3), -np.eye(3)])
    frames = square_to(directions)
    assert frames.shape == (206, 3, 2)
    np.testing.assert_allclose(np.swapaxes(frames, 1, 2) @ frames, np.broadcast_to(np.eye(2), (206, 2, 2)), atol=1e-14)
    np.testing.assert_allclose(np.einsum("ni,nik->nk", directions, frames), 0, atol=1e-13)


def test_one_direction_has_the_same_two_as_among_others():
    directions = np.random.default_rng(4).normal(size=(50, 3))
    frames = square_to(directions)
    for direction, frame in zip(directions, frames, strict=True):
        np.testing.assert_array_equal(square_to(direction), frame)
