"""The history of a rig's checks on the disk."""

from dataclasses import replace
from datetime import date, timedelta

import pytest

from core.calibrate.change import DEFAULT_STABILITY, STABLE
from core.calibrate.rig_spread import FACTORS
from core.checks.artefact_check import Artefact, ArtefactCheck
from core.checks.control_chart import FEWEST
from core.cli.output import history_rows
from core.errors import InputError
from core.files.results.rig_history import QUIET_DAYS, PastCheck, RigHistory, history_file, read_history, store_check
from core.findings.proof import Doubt
from tests.check_cases import check, nowhere

FIRST = PastCheck.of(check(), 21.5)


def later(days, error_mm=0.01, **more):
    return replace(
        FIRST, taken_at=FIRST.taken_at + timedelta(days=days), pictures_id=f"pictures-{days}", error_mm=error_mm, **more
    )


def test_checks_are_kept_in_the_order_of_their_pictures():
    store_check("bench", later(2))
    store_check("bench", FIRST)
    history = store_check("bench", PastCheck.of(nowhere()))
    assert [one.taken_at for one in read_history("bench").checks] == sorted(one.taken_at for one in history.checks)
    last = read_history("bench").checks[-1]
    assert repr(last) == repr(later(2)), "from Python 3.13 on records with NaN in a field are not equal"
    assert read_history("other").checks == ()


def test_the_same_pictures_checked_again_are_one_check():
    store_check("bench", FIRST)
    history = store_check("bench", replace(FIRST, p=0.2))
    assert [one.p for one in history.checks] == [0.2]
    assert len(store_check("bench", replace(FIRST, calibration_id="another")).checks) == 2


def test_a_damaged_history_is_named():
    store_check("bench", FIRST)
    history_file("bench").write_text('{"rig": "bench", "checks": [{"p": 2}]}')
    with pytest.raises(InputError, match=r"bench\.json.*taken_at"):
        read_history("bench")
    with pytest.raises(InputError):
        store_check("bench", FIRST)


def test_what_a_dataclass_of_a_file_must_be_is_told_in_words():
    store_check("bench", FIRST)
    short = history_file("bench").read_text().replace('"likelihoods": null', '"likelihoods": [1]')
    for text, wrong in (
        (short, r"checks\[0\]\.likelihoods is \[1\], not \d+ finite numbers"),
        ('{"rig": "bench", "checks": 3}', "checks is 3, not a list"),
        ('{"rig": "bench"}', r"checks is missing\."),
    ):
        history_file("bench").write_text(text)
        with pytest.raises(InputError, match=wrong):
            read_history("bench")


def test_a_drift_beyond_the_rigs_own_scatter_is_told_though_the_pictures_pass():
    scatter = (0.010, 0.012, 0.009, 0.011, 0.010, 0.012, 0.011, 0.009)
    history = RigHistory("bench", tuple(later(day, mm) for day, mm in enumerate(scatter)))
    steady, drifted = later(9, 0.012), later(9, 0.05)
    assert history.added(steady).beyond(steady) is None
    assert history.added(drifted).beyond(drifted).code == "check.beyond_history"
    failed = tuple(replace(one, verdict="failed") for one in history.checks)
    assert RigHistory("bench", failed).beyond(drifted) is None, "failed checks are no history to go by"


def test_before_there_is_a_history_what_is_stated_counts():
    assert RigHistory("bench").beyond(later(0, 0.08)) is None
    assert RigHistory("bench").beyond(later(0, 0.12)).code == "check.beyond_stated"


def test_a_rig_that_nothing_can_change_is_held_to_what_its_check_can_see():
    stable = later(0, 0.04, stated_mm=0.0)
    assert RigHistory("bench").beyond(stable) is None, "within ± 3 u of the check itself, u = 0.025"
    assert RigHistory("bench").beyond(replace(stable, error_mm=0.08)) is not None


def test_parts_of_another_height_have_the_same_chart():
    history = RigHistory("bench", tuple(later(day, 0.01 + 0.001 * (day % 3), step_mm=50.0) for day in range(9)))
    half = later(10, 0.0055, step_mm=25.0)
    assert history.chart(half).centre == pytest.approx(0.5 * history.chart(later(10)).centre)
    assert history.beyond(half) is None


def test_an_artefact_has_a_chart_of_its_own():
    pictures = tuple(later(day, 0.01) for day in range(9))
    block = later(10, 0.03, artefact="GB 50-7", e_n=0.8)
    history = RigHistory("bench", pictures).added(block)
    assert history.like(block) == (block,)
    assert not history.chart(block).own and history.chart(later(11)).own
    store_check("bench", block)
    assert repr(read_history("bench").checks) == repr((block,))


def spread(days, error_mm=0.0, stated_mm=0.04, stated=None, **kept):
    """How much a rig changes by checks on so many days that say nothing of the factor but by the charted step."""
    more = {"likelihoods": (0.0,) * len(FACTORS), "stated_mm": stated_mm, **kept}
    history = RigHistory("bench", tuple(later(day, error_mm, **more) for day in range(days)))
    return history.spread(FIRST.calibration_id, FIRST.taken_at + timedelta(days=days, hours=1), stated)


def test_few_checks_may_say_that_a_rig_changes_more_but_only_many_that_it_changes_less():
    quiet = tuple(-10.0 * factor for factor in FACTORS)
    history = RigHistory(
        "bench", tuple(later(day, 0.0, likelihoods=quiet, stated_mm=0.04) for day in range(QUIET_DAYS))
    )
    when = FIRST.taken_at + timedelta(days=QUIET_DAYS, hours=1)
    assert history.spread(FIRST.calibration_id, when).factor < 0.2
    assert replace(history, checks=history.checks[1:]).spread(FIRST.calibration_id, when) is None
    assert spread(FEWEST, error_mm=0.12).factor == pytest.approx(3.0 * 2.366 / 2, rel=1e-3), "Student's t of 8 days"
    assert spread(FEWEST - 1, error_mm=0.12) is None


def test_what_is_stated_of_a_rig_counts_unless_its_checks_show_more():
    half, stable = DEFAULT_STABILITY.times(0.1, 0.1, 0.1, 0.5), STABLE
    assert spread(FEWEST, error_mm=0.12, stated=half).factor == spread(FEWEST, error_mm=0.12).factor
    assert spread(FEWEST, error_mm=0.02, stated=half).factor == pytest.approx(0.5 * 2.366 / 2, rel=1e-3), (
        "more than 0.5"
    )
    assert spread(FEWEST, error_mm=0.01, stated=half) is None
    assert spread(QUIET_DAYS, error_mm=0.0, stated=half) is None, "no check makes a statement smaller"
    assert spread(FEWEST, error_mm=0.12, stated=stable) is None


def test_a_check_made_with_a_stated_stability_counts_against_the_default_as_well():
    assert spread(FEWEST, error_mm=0.12, stated_mm=0.01, default_mm=0.04) == spread(FEWEST, error_mm=0.12)


@pytest.mark.parametrize("stated_mm", [0.0, float("nan")])
def test_a_check_by_which_no_step_is_assumed_wrong_says_nothing_of_the_rig(stated_mm):
    assert spread(QUIET_DAYS, error_mm=0.12, stated_mm=stated_mm) is None


BLOCK = Artefact("GB 50-7", 50.0003, 0.0004, 2.0, "D-K-15070 2026-03", date(2028, 3, 1))


MOVED = (Doubt.named("moved"),)


def measured_block(days: float, measured_mm: float, block: Artefact = BLOCK) -> PastCheck:
    taken_at = FIRST.taken_at + timedelta(days=days)
    check = ArtefactCheck(block, measured_mm, 0.009, taken_at.astimezone().date())
    return PastCheck.of_measured(check, taken_at, (FIRST.calibration_id, f"frames-{days}"), 20.5)


def test_an_artefact_is_kept_with_what_its_certificate_says():
    store_check("bench", measured_block(1, 50.004))
    (kept,) = read_history("bench").checks
    assert repr(kept) == repr(measured_block(1, 50.004))
    told = kept.of_artefact
    assert told is not None and told.artefact == BLOCK
    assert (told.measured_mm, told.u_mm, told.e_n) == pytest.approx((50.004, 0.009, kept.e_n))
    assert PastCheck.of(check()).of_artefact is None
    assert replace(kept, certified_u_mm=float("nan")).of_artefact is None, "kept before certificates were"


def test_a_step_is_kept_with_its_kind_and_what_was_measured_of_it():
    step = replace(BLOCK, id="S 20", value_mm=20.0, kind="step")
    measured = ArtefactCheck(step, 20.003, 0.009, FIRST.taken_at.astimezone().date(), "stairs height 2", doubts=MOVED)
    store_check("bench", PastCheck.of_measured(measured, FIRST.taken_at, (FIRST.calibration_id, "frames"), None))
    (kept,) = read_history("bench").checks
    assert kept.of_artefact is not None
    assert (kept.of_artefact.artefact, kept.of_artefact.characteristic) == (step, "stairs height 2")
    assert (kept.verdict, kept.doubts, kept.of_artefact.doubts) == ("doubtful", ("moved",), MOVED)
    assert len(RigHistory("bench", (kept,)).added(replace(kept, characteristic="stairs height 1")).checks) == 2
    assert len(RigHistory("bench", (kept,)).added(replace(kept, artefact="S 21")).checks) == 1, "corrected"


def test_of_each_artefact_the_check_nearest_in_time_counts():
    other = replace(BLOCK, id="GB 20-1", value_mm=20.0)
    checks = (measured_block(1, 50.001), measured_block(3, 50.003), measured_block(9, 50.009))
    history = RigHistory("bench", (FIRST, *checks, measured_block(5, 20.002, other)))
    when = FIRST.taken_at + timedelta(days=4)
    found = history.artefacts(FIRST.calibration_id, when)
    assert [(one.artefact.id, one.measured_mm) for one in found] == [
        ("GB 20-1", pytest.approx(20.002)), ("GB 50-7", pytest.approx(50.003)),
    ]  # fmt: skip
    assert history.artefacts("another", when) == ()


def test_a_day_that_there_is_not_is_told():
    store_check("bench", measured_block(1, 50.004))
    text = history_file("bench").read_text().replace("2028-03-01", "2028-13-01")
    history_file("bench").write_text(text)
    with pytest.raises(InputError, match=r"checks\[0\]\.due is .2028-13-01., not a date"):
        read_history("bench")


def test_the_printed_history_has_the_temperature_where_it_is_known():
    lines = dict(history_rows(RigHistory("bench", (replace(FIRST, celsius=None), later(1)))))
    told = list(lines.values())[1:]
    assert [line.endswith(", air 21.5 °C") for line in told] == [False, True]
    assert "°C" not in told[0]


def artefact_history(errors_um):
    """A block measured on so many days, with pictures of checks between."""
    blocks = [measured_block(day, BLOCK.value_mm + 1e-3 * um) for day, um in enumerate(errors_um)]
    return RigHistory("bench", tuple(sorted((*blocks, *map(later, range(9))), key=lambda one: one.taken_at)))


STEADY_UM = (4, 5, 3, 4, 6, 4, 5, 3)


def test_an_artefact_that_drifts_within_its_certificate_is_told_by_its_own_history():
    history, drifted = artefact_history(STEADY_UM), measured_block(20, BLOCK.value_mm + 0.015)
    steady = measured_block(20, BLOCK.value_mm + 0.005)
    assert abs(drifted.e_n) < 1 and history.beyond(steady) is None
    told = history.beyond(drifted)
    assert told is not None and told.code == "artefact.beyond_history" and "the 8 measurements before" in str(told)
    (found,) = history.added(drifted).artefacts(FIRST.calibration_id, drifted.taken_at)
    assert found.verdict == "doubtful" and found.sentence == told
    assert artefact_history(STEADY_UM[:5]).beyond(drifted) is None, "few measurements have no limits of their own"


def test_each_artefact_is_charted_by_itself_with_limits_for_its_last_result():
    other = measured_block(4.5, 20.002, replace(BLOCK, id="GB 20-1", value_mm=20.0))
    history = artefact_history(STEADY_UM).added(other).added(measured_block(20, BLOCK.value_mm + 0.015))
    one, two = history.artefact_charts(FIRST.calibration_id)
    assert [check.artefact for check in one.checks] == ["GB 20-1"] and not one.limits.own
    assert len(two.checks) == len(STEADY_UM) + 1 and two.limits.own and two.limits.n == len(STEADY_UM)
    assert two.limits.contains(0.005) and not two.limits.contains(0.015)
    assert history.artefact_charts("another") == ()


def test_the_printed_history_says_of_an_artefact_its_error_and_by_what_it_is_held():
    history = artefact_history(STEADY_UM)
    told = [line for _, line in history_rows(history) if "GB 50-7" in line]
    assert len(told) == len(STEADY_UM)
    assert "E_n 0.22" in told[0] and "off by +0.004 mm" in told[0]
    assert "allowed by its uncertainty, air 20.5 °C" in told[0]
