"""Which cause explains most of what a scan's crossings are off too much: the true one, and alone."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from core.calibrate.change import changes as rig_changes
from core.calibrate.change import displaced_fan, laser_of
from core.errors import InputError
from core.findings.finding import Weight
from core.findings.proof import ScanFacts
from core.findings.table import FINDINGS
from core.scan.between_frames import Between
from core.scan.causes import Normal, causes_of_light, choose, compare_causes, note_on_causes
from core.scan.fan_watch import FanRest
from core.scan.features.frames import FrameFeatures
from core.scan.first_cause import Cause, Suspect
from core.scan.method import ReconstructOptions
from core.scan.reconstruct import reconstruct
from core.scan.standstill import RigidInterval
from core.simulate.effects.warming import Warming
from core.simulate.scenario import Scenario
from tests.scan.centreline_scan import ExactScan
from tests.scan.test_fan_watch import AT, BLOCK, features_of


@pytest.fixture(scope="module")
def still():
    return ExactScan.of(Scenario(height_mm=50.0, seed=4, scale=0.35, frames=24))


def compared(scan, *, seed=1, fan=None, movements=None):
    """The solved scan, and what its causes are with a fan calibrated so."""
    camera, fan = scan.rig.camera, scan.rig.fan if fan is None else fan
    features = scan.measured(seed)
    solved = reconstruct(features, camera, fan)
    if movements is not None:
        solved = replace(solved, movements=movements)
    return solved, compare_causes(features, solved, camera, fan, (), rig_changes(camera, fan))


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.accuracy)])
def test_nothing_explains_a_scan_that_is_in_order(still, seed):
    solved, causes = compared(still, seed=seed, movements=(Between(11, 12),))
    assert causes == ()
    assert not replace(solved, movements=()).needs_cause


def test_a_part_that_moved_is_the_first_cause_and_says_when():
    mask = ExactScan.of(Scenario(object="mask", scale=0.35), moved=(30, (0.3, 0.0, 0.0)))
    solved, causes = compared(mask)
    assert solved.needs_cause and causes[0].suspect == Suspect.MOVED and causes[0].share > 0.5
    (note,) = note_on_causes(
        causes, ScanFacts(moved=solved.moved), solved.movements, [f"frame{n:02d}" for n in range(60)]
    )
    assert note.code == "scan.most_likely_cause"
    assert str(note).startswith("Most likely cause: something moved between frame29 and frame30 (explains ")


def light_of(shift_px):
    """Features of 30 frames whose light lies aside by so much in each, in 12 stretches of a noise of 0.005 px."""
    rng = np.random.default_rng(1)
    frames = [FrameFeatures(i, f"f{i}", (), fan_shifts_px=rng.normal(shift_px(i), 0.005, 12)) for i in range(30)]
    return SimpleNamespace(frames=frames)


@pytest.mark.parametrize(
    ("shift_px", "movements", "suspects"),
    [
        (lambda i: 0.0, (Between(14, 15),), []),
        (lambda i: 0.3 * (i >= 15), (Between(14, 15),), [Suspect.MOVED]),
        (lambda i: 0.02 * i, (), [Suspect.DRIFTED]),
        (lambda i: 0.3 * (i >= 15) + 0.01 * i, (Between(14, 15),), [Suspect.MOVED, Suspect.DRIFTED]),
    ],
)
def test_the_fans_light_alone_says_what_share_a_movement_and_a_drift_have(shift_px, movements, suspects):
    """Where no sweep can be located there are no crossings to compare."""
    causes = causes_of_light(light_of(shift_px), movements)
    assert [one.suspect for one in causes] == suspects
    assert sum(one.share for one in causes) == pytest.approx(min(len(suspects), 1), abs=0.02)


@pytest.mark.parametrize("jump_px", [0.0, 0.3])
def test_where_the_fans_light_is_at_rest_nothing_moved(jump_px):
    """Crossings gain by a movement also where all sweeps disagree with a fan whose lines bend."""
    mask, rng = ExactScan.of(Scenario(object="mask", scale=0.35), moved=(30, (0.3, 0.0, 0.0))), np.random.default_rng(1)
    features, camera, fan = mask.measured(1), mask.rig.camera, mask.rig.fan
    solved = reconstruct(features, camera, fan)
    frames = tuple(
        replace(one, fan_shifts_px=rng.normal(jump_px * (one.index >= 30), 0.005, 12)) for one in features.frames
    )
    causes = compare_causes(replace(features, frames=frames), solved, camera, fan, (), rig_changes(camera, fan))
    assert solved.movements and (Suspect.MOVED in {one.suspect for one in causes}) == bool(jump_px)


@pytest.mark.parametrize(
    ("changes", "suspect"),
    [
        ({"moved_frame": 0, "warming": Warming(scan_px=0.3, scan_focal_ppm=150, scan_urad=100)}, Suspect.DRIFTED),
        ({"lifted_mm": 0.4}, Suspect.MOVED),
        pytest.param({"bumped_px": 0.2}, Suspect.MOVED, marks=pytest.mark.accuracy),
    ],
)
def test_a_drift_is_no_movement_and_a_movement_no_drift(changes, suspect):
    """Both are compared, also where only one was found: that of a rendered block."""
    features, rig = features_of(replace(BLOCK, **changes))
    solved = reconstruct(features, rig.camera, rig.fan)
    assert solved.needs_cause
    seen = replace(solved, movements=(Between(AT - 1, AT),))
    first, *others = compare_causes(features, seen, rig.camera, rig.fan, (), rig_changes(rig.camera, rig.fan))
    assert first.suspect == suspect and first.share > 0.5
    assert sum(one.share for one in others) < first.share / 4


@pytest.mark.parametrize("axis", [0, 2])  # a turn about the other one changes no crossing
def test_a_laser_that_turned_is_the_first_cause(still, axis):
    turned = displaced_fan(still.rig.fan, np.radians(0.2) * np.eye(3)[axis], laser_of(still.rig.fan))
    _, causes = compared(still, fan=turned, movements=(Between(11, 12),))
    assert causes[0].suspect == Suspect.RIG_CHANGED and causes[0].share > 0.5


@pytest.mark.parametrize("watched", [True, False])
def test_a_scan_that_a_turned_laser_leaves_without_a_point_is_refused_by_that(still, watched):
    """Crossings a hundred times as far off as their noise gain by a movement, too: the fan's light may deny it."""
    features, rng = still.measured(1), np.random.default_rng(1)
    if watched:
        frames = (replace(one, fan_shifts_px=rng.normal(0.0, 0.005, 12)) for one in features.frames)
        features = replace(features, frames=tuple(frames))
    turned = displaced_fan(still.rig.fan, np.array([0.0, 0.0, -0.1]), laser_of(still.rig.fan))
    with pytest.raises(InputError) as refused:
        reconstruct(features, still.rig.camera, turned, ReconstructOptions(row_time_us=0.0))
    assert refused.value.code == ("scan.changed_and_not_solved" if watched else "scan.no_points_because")
    assert ("the fixed laser turned" in str(refused.value)) == watched
    assert ("calibrate it again" in str(refused.value)) == watched


def of_two(gradient, misfit, *, alike=0.0, places=1):
    """Two causes of one number each, that move crossings `alike`, of the size of the noise."""
    information = np.array([[1.0, alike], [alike, 1.0]])
    suspects = (Suspect.DRIFTED, Suspect.MOVED)
    return Normal(
        information, np.array(gradient), information, suspects, dict.fromkeys(suspects, places), misfit, 100.0
    )


def test_what_the_first_cause_leaves_is_told_of_the_second():
    first, second = choose(of_two([20.0, 10.0], 600.0))
    assert (first.suspect, second.suspect) == (Suspect.DRIFTED, Suspect.MOVED)
    assert first.share == pytest.approx(0.8, abs=0.02) and second.share == pytest.approx(0.2, abs=0.02)


def test_a_cause_that_explains_nothing_of_what_is_left_is_not_told():
    (only,) = choose(of_two([20.0, 18.0], 500.0, alike=0.9))
    assert only.suspect == Suspect.DRIFTED and only.share == pytest.approx(1.0, abs=0.02)


def test_what_chance_explains_is_no_cause_and_more_so_if_more_was_tried():
    assert choose(of_two([3.5, 0.0], 112.0))[0].suspect == Suspect.DRIFTED
    assert choose(of_two([3.5, 0.0], 112.0, places=60)) == ()
    assert choose(of_two([0.0, 0.0], 900.0)) == ()


def test_what_nothing_explains_counts_as_too_large():
    (only,) = choose(of_two([20.0, 0.0], 1300.0))
    assert only.share == pytest.approx(400 / 1200, abs=0.01)


def test_an_unsure_cause_that_explains_more_does_not_hide_a_sure_one():
    """The calibrations leave the first so uncertain that chance explains as much; the second they do not touch."""
    suspects = (Suspect.RIG_CHANGED, Suspect.MOVED)
    normal = Normal(
        np.eye(2),
        np.sqrt([200.0, 150.0]),
        np.diag([60.0, 1.0]),
        suspects,
        dict.fromkeys(suspects, 1),
        450.0,
        100.0,
    )
    (only,) = choose(normal)
    assert only.suspect == Suspect.MOVED and only.p < 1e-6


def test_a_cause_without_doubt_of_the_result_is_a_caution():
    (note,) = note_on_causes((Cause(Suspect.SECOND_BOUNCES, 0.97, 30, 1e-12),), ScanFacts(), (), [])
    assert note.code == "scan.most_likely_scatter" and "97 % of what is too large" in str(note)
    assert note_on_causes((), ScanFacts(), (), []) == ()


@pytest.mark.parametrize(
    ("suspect", "fact"),
    [
        (Suspect.MOVED, "moved"),
        (Suspect.DRIFTED, "drifted"),
        (Suspect.RIG_CHANGED, "rig_changed"),
        (Suspect.RIG_CHANGED, "rig_seems_changed"),
    ],
)
def test_a_cause_is_grave_only_beside_the_fact_that_takes_the_proof_away(suspect, fact):
    """A measurement that conforms has no red sentence beside it that says that the rig drifted."""

    def weight(facts):
        (note,) = note_on_causes((Cause(suspect, 0.6, 3, 1e-4),), facts, (), [])
        return FINDINGS[note.code].weight

    assert weight(ScanFacts(**{fact: True})) == Weight.GRAVE
    assert weight(ScanFacts(**{fact: False}, collapsed=True)) == Weight.CAUTION


def test_a_movement_has_the_same_two_frames_in_every_sentence():
    """Frames without a stripe between them tell nothing of when: crossings know it no better."""
    names, seen = [f"frame{n:02d}" for n in range(20)], Between(9, 12)
    (likely,) = note_on_causes((Cause(Suspect.MOVED, 0.9, 6, 1e-9),), ScanFacts(moved=True), (seen,), names)
    (of_crossings,) = RigidInterval(np.ones(4, dtype=bool), (seen,), known=True).note(names, 10)
    at_rest = np.arange(20) < 12
    (of_light,) = FanRest(at_rest, (seen,), 0.3, 0.1, 1.0, frames=20, stretches=9).note(names, 10)
    for note in (likely, of_crossings, of_light):
        assert "between frame09 and frame12" in str(note)
