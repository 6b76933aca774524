"""The inverse of a positive definite matrix, and the complaint about another one."""

import numpy as np
import pytest

from core.model.positive_definite import inverse_of


def test_it_is_the_inverse_and_what_is_no_such_matrix_is_refused():
    root = np.random.default_rng(1).normal(size=(40, 30))
    matrix = root.T @ root
    np.testing.assert_allclose(inverse_of(matrix) @ matrix, np.eye(30), atol=1e-9)
    with pytest.raises(np.linalg.LinAlgError):
        inverse_of(matrix - 100.0 * np.eye(30))
