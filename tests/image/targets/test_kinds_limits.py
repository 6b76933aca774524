import pytest

from core.image.targets.kinds import BlackSquare, Checkerboard, CircleGrid


@pytest.mark.parametrize("kind", [Checkerboard, CircleGrid])
def test_a_target_beyond_all_targets_is_refused(kind):
    with pytest.raises(ValueError, match="are too many: at most 500 in a row"):
        kind(10**9, 12, 10.0)
    for size in (1e300, 1e-300):
        with pytest.raises(ValueError, match=r"must be from 0\.001 to 5000 mm"):
            kind(17, 12, size)


def test_so_is_a_square():
    with pytest.raises(ValueError, match="side_mm must be from"):
        BlackSquare(1e300)
