"""Planes that change while rows are read out."""

import numpy as np
import pytest
from numpy.polynomial.legendre import legfit

from core.scan.network.read_out import FASTEST, MOST_TERMS, Hand, ReadOut, row_forms, row_planes

ROWS = 1000


def test_forms_times_coefficients_are_the_plane_of_the_row_times_the_ray():
    rng = np.random.default_rng(1)
    rays, v, coefficients = rng.normal(size=(20, 3)), rng.uniform(0, ROWS, 20), rng.normal(size=(20, 12))
    by_forms = (row_forms(rays, v, ROWS, 12) * coefficients).sum(axis=1)
    assert by_forms == pytest.approx((row_planes(coefficients, v, ROWS) * rays).sum(axis=1))


def test_a_plane_that_does_not_change_is_handed_on_to_the_last_bit():
    rays, pis = np.random.default_rng(2).normal(size=(2, 5, 3))
    assert row_forms(rays, np.arange(5.0), ROWS, 3) is rays
    assert row_planes(pis, np.arange(5.0), ROWS) is pis


def test_the_middle_row_sees_the_first_term_of_a_steady_hand():
    coefficients = np.arange(6.0)[None]
    assert row_planes(coefficients, np.array([(ROWS - 1) / 2]), ROWS)[0] == pytest.approx([0, 1, 2])


def test_tremor_has_the_terms_of_its_sine():
    """RMS over the phase of Legendre's coefficients, by numbers and by Bessel functions."""
    time_s, amplitude = 0.071, 0.35
    t = np.linspace(-1, 1, 2001)
    phases = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    waves = {
        f: np.array([legfit(t, amplitude * np.sin(np.pi * f * time_s * t + phase), 9) for phase in phases])
        for f in (8.0, 10.0, 12.0)
    }
    largest = np.max([np.sqrt(np.mean(one**2, axis=0)) for one in waves.values()], axis=0)
    stated = Hand(0.0, amplitude).tremor_terms_mm(MOST_TERMS, time_s)
    assert stated == pytest.approx(largest[1 : 1 + MOST_TERMS], rel=0.02)


@pytest.mark.parametrize(("time_ms", "terms"), [(0.0, 0), (1.0, 1), (20.0, 2), (71.0, 5)])
def test_a_slower_read_out_needs_more_terms(time_ms, terms):
    assert len(ReadOut.of(ROWS, time_ms, FASTEST).shifts_mm) == terms


def test_a_hand_keeps_its_speed_from_frame_to_frame_but_not_its_tremor():
    read_out = ReadOut.of(ROWS, 71.0, Hand(30.0, 0.35))
    covariance = np.linalg.inv(read_out.weight(4).toarray()[3 :: read_out.size, 3 :: read_out.size])
    steady = (30.0 * 0.071 / 2) ** 2
    assert covariance[0, 0] == pytest.approx(steady + read_out.shifts_mm[0] ** 2)
    assert covariance[0, 1] == pytest.approx(steady * np.exp(-1 / 8))
    assert np.count_nonzero(read_out.weight(4).toarray()[6 :: read_out.size, 6 :: read_out.size]) == 4


def test_what_is_left_out_of_the_determinant_does_not_depend_on_the_hand():
    def whole(hand):
        weight = ReadOut.of(ROWS, 71.0, FASTEST).by(hand).weight(5).toarray()
        known = weight.diagonal() > 0
        return np.linalg.slogdet(weight[np.ix_(known, known)])[1]

    slow, fast = Hand(20.0, 0.02), Hand(80.0, 0.4)
    log_det = {hand: ReadOut.of(ROWS, 71.0, FASTEST).by(hand).log_det_weight(5) for hand in (slow, fast)}
    assert log_det[slow] - log_det[fast] == pytest.approx(whole(slow) - whole(fast))
