"""The inverse of a positive definite matrix and its root, and the complaint about another one."""

import numpy as np
import pytest
from scipy.linalg import cho_factor

from core.model.positive_definite import inverse_by, inverse_root


def test_it_is_the_inverse_and_what_is_no_such_matrix_is_refused():
    root = np.random.default_rng(1).normal(size=(40, 30))
    matrix = root.T @ root
    inverse = inverse_by(cho_factor(matrix, lower=True)[0])
    np.testing.assert_allclose(inverse @ matrix, np.eye(30), atol=1e-9)
    found = inverse_root(matrix)
    assert not np.triu(found, 1).any()
    np.testing.assert_allclose(found.T @ found, inverse, atol=1e-12)
    with pytest.raises(np.linalg.LinAlgError):
        inverse_root(matrix - 100.0 * np.eye(30))
