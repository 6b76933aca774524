"""Judgement of residuals: noise is called noise, however long its grain, and a common pattern is found."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d
from scipy.special import chdtrc

from core.model.residuals import (
    Judgement,
    Residuals,
    SharedErrors,
    along_line,
    judge_residuals,
    judge_with_shared,
    over_picture,
    without_line,
)

T = np.linspace(-1, 1, 140)


def judged(seed: int, groups: int = 12, bend: float = 0.0, grain: float = 0.0) -> Judgement:
    """Of lines with noise of 0.1 mm, half of which is stated, and a common bend in mm."""
    rng = np.random.default_rng(seed)
    noise = rng.normal(size=(groups, len(T)))
    if grain:
        noise = gaussian_filter1d(noise, grain, axis=1) * np.sqrt(2 * np.sqrt(np.pi) * grain)
    values = np.array([without_line(T, 0.1 * own + bend * (T**2 - 1 / 3)) for own in noise])
    return judge_residuals(
        Residuals(
            values.ravel(),
            np.full(values.size, 0.05),
            np.repeat(np.arange(groups), len(T)),
            np.tile(along_line(T, 7), groups),
            7,
        )
    )


def test_residuals_twice_as_large_as_stated_are_told_as_that():
    assert judged(1).times == pytest.approx(2, rel=0.05)
    assert judged(1).together == pytest.approx(1, rel=0.1)


def test_neighbours_that_err_together_are_seen_as_runs_and_not_as_a_pattern():
    found = judged(2, grain=6.0)
    assert found.together > 3
    assert found.systematic == 0


def test_chance_is_called_a_pattern_as_rarely_as_stated():
    accused = sum(judged(seed, grain=6.0).p < 0.05 for seed in range(200))
    assert 1 <= accused <= 22


def test_a_common_bend_is_found_with_its_size():
    found = judged(3, bend=0.1, grain=2.0)
    assert found.p < 0.005
    assert found.systematic == pytest.approx(0.1 * np.sqrt(4 / 45), rel=0.25)
    assert found.profile[0] > 0 > found.profile[3]


def test_a_bend_with_another_sign_in_each_group_is_no_common_pattern():
    rng = np.random.default_rng(4)
    values = np.array([sign * (T**2 - 1 / 3) for sign in rng.choice([-1.0, 1.0], 14)])
    group, cell = np.repeat(np.arange(14), len(T)), np.tile(along_line(T, 7), 14)
    assert judge_residuals(Residuals(values.ravel(), np.ones(values.size), group, cell, 7)).systematic == 0


def test_few_groups_accuse_nobody():
    assert judged(5, groups=5, bend=1.0).p == 1
    assert judged(5, groups=8, bend=1.0).p < 0.01


def test_places_in_a_picture_are_numbered_row_by_row():
    uv = np.array([[0.0, 0.0], [99.0, 0.0], [0.0, 49.0], [99.0, 49.0], [40.0, 24.0]])
    assert over_picture(uv, (100, 50), (4, 2)).tolist() == [0, 3, 4, 7, 1]


def test_places_where_nothing_is_keep_their_number():
    group, cell = np.repeat(np.arange(10), 20), np.tile(np.repeat([0, 2], 10), 10)
    found = judge_residuals(Residuals(np.where(cell == 2, 1.0, -1.0), np.ones(200), group, cell, 5))
    assert found.profile.tolist()[::2][:2] == [-1.0, 1.0]
    assert np.isnan(found.profile[[1, 3, 4]]).all()
    assert found.strongest in (0, 2)
    assert found.systematic == pytest.approx(1.0)


def judged_with_shared(seed: int, bend: float = 0.0, stated: float = 1.0, known: bool = True) -> Judgement:
    """Of 400 residuals with own noise of 0.1, a bend that all share with a random size, and one that is a form."""
    rng = np.random.default_rng(seed)
    at = rng.uniform(-1, 1, (400, 2))
    shared = 0.2 * np.column_stack([at[:, 0] ** 2 - 1 / 3, at[:, 0] * at[:, 1]])
    values = 0.1 * rng.normal(size=400) + shared @ rng.normal(size=2) + bend * (at[:, 1] ** 2 - 1 / 3)
    cell = (np.floor(3 * (at + 1)) @ [1, 6]).astype(np.intp)
    own = np.full(400, 0.1 * stated)
    acting = SharedErrors(own, shared if known else np.zeros((400, 0)), np.column_stack([np.ones(400), at]))
    return judge_with_shared(Residuals(values, np.hypot(own, stated * 0.1), np.arange(400), cell, 36), acting)


def test_a_pattern_that_shared_errors_explain_is_chance_as_rarely_as_stated():
    found = [judged_with_shared(seed) for seed in range(200)]
    assert 1 <= sum(one.p < 0.05 for one in found) <= 22
    assert np.mean([one.alone for one in found]) == pytest.approx(1.0, abs=0.02)
    assert sum(judged_with_shared(seed, known=False).p < 0.01 for seed in range(20)) > 10


def scatter_of_few_planes(seed: int, stated: float = 1.0) -> Judgement:
    """Of 300 residuals most of whose error is that of the 6 planes they lie on."""
    rng = np.random.default_rng(seed)
    group, own = np.repeat(np.arange(6), 50), np.full(300, 0.1)
    shared = 0.2 * (group[:, None] == np.arange(6))
    values = own * rng.normal(size=300) + shared @ rng.normal(size=6)
    acting = SharedErrors(stated * own, stated * shared, np.ones((300, 1)))
    expected = stated * np.hypot(own, 0.2)
    return judge_with_shared(Residuals(values, expected, group, np.zeros(300, np.intp), 1), acting)


def test_the_whole_scatter_is_known_by_as_few_freedoms_as_there_are_shared_errors():
    found = [scatter_of_few_planes(seed) for seed in range(200)]
    freedom = np.array([one.whole_freedom for one in found])
    assert ((freedom > 5) & (freedom < 12)).all()
    by_chance = chdtrc(freedom, freedom * np.array([one.whole for one in found]) ** 2)
    assert 2 <= (by_chance < 0.05).sum() <= 20
    assert np.mean([one.whole**2 for one in found]) == pytest.approx(1.0, abs=0.1)
    assert np.mean([one.times > 1.2 for one in found]) > 0.1, "what is stated of each says little of six planes"
    assert scatter_of_few_planes(3, stated=0.5).whole == pytest.approx(2 * found[3].whole)


def test_a_pattern_beyond_shared_errors_is_found_with_its_size_whatever_the_stated_noise():
    for stated in (1.0, 0.5):
        found = judged_with_shared(7, bend=0.3, stated=stated)
        assert found.p < 1e-6
        assert found.systematic == pytest.approx(0.3 * np.sqrt(4 / 45), rel=0.3)
        assert found.profile[3] > 0 > found.profile[15]
        assert found.alone == pytest.approx(1 / stated, rel=0.1)


def test_parameters_that_few_residuals_do_not_determine_change_no_judgement():
    rng = np.random.default_rng(4)
    values, own, cell = rng.normal(0, 0.1, 14), np.geomspace(0.003, 0.04, 14), np.arange(14, dtype=np.intp) % 6
    at, shared = rng.normal(size=14), rng.normal(0, 1e-3, (14, 20))
    design = np.column_stack([np.ones(14), at])
    residuals = Residuals(values, own, np.arange(14), cell, 6)
    needed = judge_with_shared(residuals, SharedErrors(own, shared, design))
    doubled = np.column_stack([design, 3.1 * at - 0.7, np.zeros(14)])
    more = judge_with_shared(residuals, SharedErrors(own, shared, doubled))
    assert more.freedom == needed.freedom
    assert more.p == pytest.approx(needed.p, rel=1e-6)
    np.testing.assert_allclose(more.profile, needed.profile, rtol=1e-6)
