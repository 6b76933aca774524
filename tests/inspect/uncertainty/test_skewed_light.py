"""Light that comes from below the surface: what is seen of it, and what follows."""

from dataclasses import replace

import numpy as np
import pytest

from core.inspect.causes import Cause
from core.inspect.conformity import Verdict
from core.inspect.faces import FacePair
from core.inspect.gauge import measure_gauge
from core.inspect.results import Contribution
from core.inspect.uncertainty.part import Part
from core.inspect.uncertainty.skewed_light import (
    MEAN_OF_CUMULANT,
    MeanSkewness,
    doubts_of_light,
    farthest_mean_mm,
    is_surely_skewed,
    mean_skewness,
    unseen_mean_mm,
)
from core.scan.part_light import PartLight
from tests.inspect.block_scan import BlockScan

TOLD = "inspection.light_is_skewed"


@pytest.fixture(scope="module")
def scan():
    return BlockScan(height=50.0, sweeps=18)


def gauge_of(scan, upper, lower=0.0, noise=0.03):
    """Thickness where sections have these mean skewnesses on the two faces, and σ of 0.7 mm in depth."""
    cloud = scan.measure(np.random.default_rng(3))
    by_sweep = np.random.default_rng(4).normal(0, noise, (2, int(cloud.sweep.max()) + 2))
    on = scan.upper.astype(int)
    skewness = np.where(scan.upper, upper, lower) + by_sweep[on, np.maximum(cloud.sweep, -1)]
    cloud = replace(cloud, skewness=skewness, spread_mm=np.full(len(cloud), 0.7))
    return measure_gauge(
        cloud,
        errors=scan.errors(common=scan.common_errors(camera=1.0004, fan=1.0002)),
        regions=FacePair(np.flatnonzero(scan.upper), np.flatnonzero(~scan.upper)),
        nominal_mm=50.0,
        tolerance_mm=5.0,
    )


def test_nothing_changes_where_sections_are_symmetric_within_their_scatter(scan):
    plain = measure_gauge(
        scan.measure(np.random.default_rng(3)),
        errors=scan.errors(common=scan.common_errors(camera=1.0004, fan=1.0002)),
        regions=FacePair(np.flatnonzero(scan.upper), np.flatnonzero(~scan.upper)),
        nominal_mm=50.0,
        tolerance_mm=5.0,
    )
    seen = gauge_of(scan, 0.0)
    assert (seen.thickness_mm, seen.u_mm, seen.k) == (plain.thickness_mm, plain.u_mm, plain.k)
    assert [row.source for row in seen.budget] == [row.source for row in plain.budget]
    assert seen.verdict == Verdict.CONFORMING


def test_light_from_below_is_in_the_uncertainty_and_proves_nothing(scan):
    seen = gauge_of(scan, 0.08)
    (row,) = (row for row in seen.budget if row.source == Cause.SKEWED_LIGHT)
    assert 2 * row.u_mm == pytest.approx(0.8 * 0.08 ** (1 / 3) * 0.7, rel=0.2)
    assert seen.U_mm >= 2 * row.u_mm
    assert seen.verdict == Verdict.NOT_PROVEN
    assert TOLD in {note.code for note in seen.notes}


def test_stripes_that_are_wider_on_the_part_are_in_the_uncertainty_and_prove_nothing(scan):
    """However symmetric they are; a face on the table, and an offset that a master has measured, have nothing of it."""
    cloud = scan.measure(np.random.default_rng(3))
    wide = PartLight(0.2, 0.01, 0.3, table_of(cloud, scan))

    def measured(**more):
        errors = scan.errors(common=scan.common_errors(camera=1.0004, fan=1.0002))
        regions = FacePair(np.flatnonzero(scan.upper), np.flatnonzero(~scan.upper))
        return measure_gauge(cloud, errors=replace(errors, **more), regions=regions, nominal_mm=50.0, tolerance_mm=5.0)

    plain, seen = measured(), measured(light=wide)
    (row,) = (row for row in seen.budget if row.source == Cause.SKEWED_LIGHT)
    assert 2 * row.u_mm == pytest.approx(0.3, rel=0.2)
    assert seen.thickness_mm == plain.thickness_mm
    assert (seen.verdict, plain.verdict) == (Verdict.NOT_PROVEN, Verdict.CONFORMING)
    assert TOLD in {note.code for note in seen.notes}
    of_master = measured(light=wide, part=Part(material="wax", offset_mm=0.1, offset_sd_mm=0.01))
    assert Cause.SKEWED_LIGHT not in {row.source for row in of_master.budget}
    matt = measured(light=replace(wide, behind_mm=0.0))
    assert (matt.thickness_mm, matt.u_mm) == (plain.thickness_mm, plain.u_mm)


@pytest.mark.parametrize(("upper", "lower"), [(0.05, 0.0), (-0.05, 0.0), (0.05, 0.05)], ids=["up", "down", "alike"])
def test_sections_that_are_skewed_a_little_hide_nothing_of_their_width(scan, upper, lower):
    """Surely skewed by 0.05 mm of depth and wider by 0.3 mm: U holds the larger, whatever the sign."""
    cloud = scan.measure(np.random.default_rng(3))
    noise = np.random.default_rng(4).normal(0, 1e-4, int(cloud.sweep.max()) + 2)
    skewness = np.where(scan.upper, upper, lower) + noise[np.maximum(cloud.sweep, -1)]
    spread = 0.05 / (MEAN_OF_CUMULANT * np.cbrt(0.05))
    cloud = replace(cloud, skewness=skewness, spread_mm=np.full(len(cloud), spread))
    wide = PartLight(0.2, 0.01, 0.3, table_of(cloud, scan))

    def row_of(light):
        errors = replace(scan.errors(common=scan.common_errors(camera=1.0004, fan=1.0002)), light=light)
        regions = FacePair(np.flatnonzero(scan.upper), np.flatnonzero(~scan.upper))
        gauge = measure_gauge(cloud, errors=errors, regions=regions, nominal_mm=50.0, tolerance_mm=5.0)
        return max((2 * row.u_mm for row in gauge.budget if row.source == Cause.SKEWED_LIGHT), default=0.0)

    by_skewness, by_both = row_of(None), row_of(wide)
    assert by_skewness == pytest.approx(0.05 if upper != lower else 0.0, abs=0.015)
    assert 0.95 * 0.3 < by_both < 1.2 * 0.3


def table_of(cloud, scan):
    """The plane π of the lower face."""
    return np.linalg.lstsq(cloud.points[~scan.upper], np.ones(np.sum(~scan.upper)), rcond=None)[0]


def test_light_that_may_come_from_below_the_other_face_hides_no_doubt(scan):
    sure = gauge_of(scan, 0.08)
    (row,) = (row for row in sure.budget if row.source == Cause.SKEWED_LIGHT)
    small = replace(row, u_mm=0.3 * np.sqrt(sure.u_mm**2 - row.u_mm**2))
    others = [one for one in sure.budget if one.source != Cause.SKEWED_LIGHT]
    assert doubts_of_light([*others, small]) is not None
    assert doubts_of_light([*others, small, Contribution(Cause.LIGHT_FROM_BELOW_ASSUMED, 1.0)]) is not None


def test_light_that_is_skewed_alike_on_both_faces_moves_no_distance_between_them(scan):
    """As that of a laser whose beam is skewed."""
    seen = gauge_of(scan, 0.08, 0.08)
    assert TOLD not in {note.code for note in seen.notes}
    assert seen.U_mm < 1.1 * gauge_of(scan, 0.0).U_mm


@pytest.mark.parametrize(
    ("sweeps", "errors", "surely"), [(1e4, 4.1, True), (23, 4.1, False), (23, 5.2, True), (9, 99, False)]
)
def test_the_fewer_sweeps_tell_their_own_error_the_more_of_it_is_asked(sweeps, errors, surely):
    assert is_surely_skewed(MeanSkewness(0.02 * errors, 0.02, sweeps)) is surely
    assert is_surely_skewed(MeanSkewness(-0.02 * errors, 0.02, sweeps)) is surely


def test_few_sweeps_tell_nothing():
    sweep = np.repeat(np.arange(5), 40)
    assert mean_skewness(np.full(200, 0.1), sweep).error == np.inf, "they do not scatter at all"
    skewness = 0.1 + np.repeat(np.array([-1, 1, 0, -1, 1]) * 1e-3, 40)
    seen = mean_skewness(skewness, sweep)
    assert seen.mean > 50 * seen.error and seen.sweeps == pytest.approx(5)
    unsure = MeanSkewness(0.0, 0.02, 5.0)
    assert unseen_mean_mm(unsure, 0.7, 0.5) > unseen_mean_mm(unsure._replace(sweeps=25.0), 0.7, 0.5)
    assert mean_skewness(skewness[:80], sweep[:80]).error == np.inf


def test_sections_on_a_curved_face_are_skewed_without_that(scan):
    cloud, rng = scan.measure(np.random.default_rng(3)), np.random.default_rng(1)
    skewness = rng.normal(0.1, 0.01, len(cloud))
    cloud = replace(cloud, skewness=skewness, spread_mm=np.full(len(cloud), 0.7))
    part, flat = np.zeros(len(cloud), dtype=np.int64), np.tile([0.0, 0.0, 1.0], (len(cloud), 1))
    assert farthest_mean_mm(cloud, part, flat)[0] > 0.2
    curved = flat + np.linspace(0, 0.1, len(cloud))[:, None]
    assert farthest_mean_mm(cloud, part, curved)[0] == 0


def seen(mean, error):
    return MeanSkewness(mean, error, 25.0)


def test_what_skewness_leaves_of_light_from_below_shrinks_as_it_is_known_better():
    known = [unseen_mean_mm(seen(0.0, error), 0.6, 0.5) for error in (np.inf, 0.1, 0.02, 0.002)]
    assert known == sorted(known, reverse=True) and known[0] > 0.1 > 0.015 > known[-1]
    assert unseen_mean_mm(seen(0.03, 0.01), 1.0, 0.5) > unseen_mean_mm(seen(0.0, 0.01), 1.0, 0.5)
    assert unseen_mean_mm(seen(0.0, 0.01), 1.0, 0.0) == 0.0
    assert unseen_mean_mm(seen(0.0, 0.01), 1.0, 1.0) > unseen_mean_mm(seen(0.0, 0.01), 1.0, 0.5)


def test_twice_the_uncertainty_holds_nineteen_of_twenty_parts_whose_light_is_as_was_assumed():
    rng = np.random.default_rng(8)
    held = []
    for number in range(600):
        share, deep = rng.uniform(0, 0.5), np.exp(rng.uniform(np.log(0.1), np.log(3.0)))
        below = rng.random() < 0.5
        even = deep**3 * (share / 4 - share**2 / 2 + share**3 / 4)
        exponential = (deep / 2) ** 3 * (6 * share - 6 * share**2 + 2 * share**3)
        skewness = rng.normal(below * (even if number % 2 else exponential), 0.01)
        held.append(share * deep / 2 * below <= 2 * unseen_mean_mm(seen(skewness, 0.01), 1.0, 0.5))
    assert 0.93 <= np.mean(held) <= 0.98
