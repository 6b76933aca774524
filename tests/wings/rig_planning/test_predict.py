from dataclasses import replace

import numpy as np
import pytest

from core.errors import Cancelled, InputError
from core.inspect.causes import Cause
from core.messages import plain
from core.scan.method import ReconstructOptions
from core.wings.rig_planning.prediction.bounds import bounds_of
from core.wings.rig_planning.prediction.changes import CHANGES, Change, Effect, advice, compare
from core.wings.rig_planning.prediction.predict import Planner
from tests.wings.rig_planning.small import CUT_MM, SMALL

HEIGHT = 50.0


@pytest.fixture(scope="module")
def planner():
    return Planner(solving=ReconstructOptions(sigma_cut_mm=CUT_MM))


@pytest.fixture(scope="module")
def base(planner):
    return planner.predict(SMALL, HEIGHT, scans=1)


@pytest.mark.accuracy
def test_u_is_the_sum_of_its_budget_and_holds_the_errors_drawn(planner):
    base = planner.predict(SMALL, HEIGHT, scans=2)
    total = np.sqrt(sum(row.u_mm**2 for row in base.budget))

    assert base.u_mm == pytest.approx(total, rel=1e-6)
    assert base.U_mm == pytest.approx(base.k * base.u_mm)
    assert np.all(np.abs(base.errors_mm) < 5 * np.array(base.each_u_mm))
    assert 0.01 < base.u_mm < 0.15


@pytest.mark.accuracy
def test_no_plan_promises_more_than_the_pictures_hold(base):
    """Nor much less: between lie smoothing that stops at edges, and a network that knows no shapes."""
    floor = next(one for one in bounds_of(SMALL, (HEIGHT,)) if str(one.quantity) == "thickness of 50 mm").with_speckle
    print(f"planned u {base.u_mm:.4f} mm, bound {floor:.4f} mm")

    assert floor < base.u_mm < 3 * floor


def test_the_map_shows_sigma_where_block_and_table_are_seen(base):
    seen = np.isfinite(base.sigma.own)

    assert 0.2 < seen.mean() < 1.0
    assert np.array_equal(seen, np.isfinite(base.sigma.common))
    assert 0 < np.nanmax(base.sigma.own) <= CUT_MM
    assert np.allclose(base.sigma.total[seen] ** 2, (base.sigma.own**2 + base.sigma.common**2)[seen])


@pytest.mark.accuracy  # that it writes the same bytes is in test_plan_command.py
def test_the_same_plan_gives_the_same_figures(base):
    again = Planner(solving=ReconstructOptions(sigma_cut_mm=CUT_MM)).predict(SMALL, HEIGHT, scans=1)

    assert again.each_u_mm == base.each_u_mm[:1]
    assert np.array_equal(again.sigma.own, base.sigma.own, equal_nan=True)


@pytest.mark.accuracy
def test_more_poses_leave_less_of_the_fans_share(planner, base):
    many = planner.predict(replace(SMALL, poses=3 * SMALL.poses), HEIGHT, scans=1)

    def fan(prediction):
        return next(row.u_mm for row in prediction.budget if row.source == Cause.FAN_CALIBRATION)

    assert fan(many) < 0.75 * fan(base)
    assert many.u_mm < base.u_mm


@pytest.mark.accuracy
def test_without_speckle_a_thickness_is_surer(planner, base):
    assert planner.predict(replace(SMALL, speckle=0.0), HEIGHT, scans=1).u_mm < 0.85 * base.u_mm


def test_changes_come_with_the_most_helpful_first_and_say_why_one_cannot_be_made(planner, base):
    """What a change gives is made up: `test_a_shorter_baseline_makes_u_larger` has it from the planner."""

    class MadeUp:
        def predict(self, design, height_mm, scans):
            if design.views < 2:
                return planner.predict(design, height_mm, scans)
            return replace(base, u_mm=base.u_mm * design.poses / SMALL.poses)

    def poses(name, times):
        return Change(
            plain(name), lambda design: plain("1"), lambda design: replace(design, poses=times * design.poses)
        )

    impossible = Change(plain("no views"), lambda design: plain("1"), lambda design: replace(design, views=1))
    chosen = (impossible, poses("worse", 2), poses("the same", 1))
    effects = compare(MadeUp(), SMALL, base, scans=1, changes=chosen)

    assert [str(effect.change) for effect in effects] == ["the same", "worse", "no views"]
    assert [effect.U_mm for effect in effects[:2]] == pytest.approx([base.U_mm, 2 * base.U_mm])
    assert all(effect.before_mm == base.U_mm for effect in effects)
    assert effects[-1].U_mm is None
    assert effects[-1].reason.code == "plan.impossible"


@pytest.mark.accuracy
def test_a_shorter_baseline_makes_u_larger(planner, base):
    (chosen,) = (change for change in CHANGES if str(change.name) == "baseline of the fan 20 % shorter")
    (effect,) = compare(planner, SMALL, base, scans=1, changes=(chosen,))

    assert effect.share > 1, "the light planes meet the rays at smaller angles"


def test_advice_names_the_best_change_or_says_that_none_helps():
    good = Effect(plain("poses doubled"), plain("18"), 0.031, 0.024)
    none = Effect(plain("views doubled"), plain("28"), 0.031, 0.0309)
    failed = Effect(plain("longer lens"), plain("10 mm"), 0.031, None, plain("the target does not fit"))

    assert str(advice((good, none))) == "Most helps: poses doubled (18): U 0.031 → 0.024 mm."
    assert advice((none, failed)).code == "plan.no_change_helps"
    assert advice((failed,)).code == "plan.no_change_helps"


def test_a_rig_whose_fan_misses_the_picture_is_told():
    with pytest.raises(InputError):
        Planner().predict(replace(SMALL, focal_mm=60.0), HEIGHT)


def test_what_a_solver_says_is_told_of_the_plan(planner):
    with pytest.raises(InputError, match="could not be measured") as told:
        planner.predict(replace(SMALL, block_mm=(8.0, 8.0)), HEIGHT)
    assert str(told.value).startswith("[plan]")


def test_a_plan_can_be_cancelled():
    def cancel(step, done, total):
        if step == "stripes" or done > 0:
            raise Cancelled

    with pytest.raises(Cancelled):
        Planner(cancel).predict(SMALL, HEIGHT)


def test_what_may_change_after_the_calibration_is_a_row_of_the_plan_and_a_check_takes_most_of_it(planner, base):
    unstated = replace(planner, stability=None)  # with calibrations and scan that are known already
    unchecked = unstated.predict(SMALL, HEIGHT)
    checked = unstated.predict(replace(SMALL, check_poses=3), HEIGHT)

    def change(prediction):
        return sum(row.u_mm for row in prediction.budget if row.source == Cause.CHANGE_ASSUMED)

    assert not change(base), "of a rig that nothing changes"
    assert 0.02 < change(unchecked) < 0.1
    assert change(checked) < 0.7 * change(unchecked)
    assert unchecked.each_u_mm[0] > 1.5 * base.each_u_mm[0]
    assert checked.each_u_mm[0] < 1.2 * base.each_u_mm[0]
