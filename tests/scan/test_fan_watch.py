"""Things that move within a rendered scan: which frames, how far, and what is kept."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from core.errors import InputError
from core.messages import plain
from core.scan import reconstruct as reconstruct_module
from core.scan.between_frames import Between
from core.scan.fan_watch import possible_movements
from core.scan.features.extraction import FeatureOptions, extract_features
from core.scan.method import Method, ReconstructOptions
from core.scan.reconstruct import reconstruct
from core.scan.records import MOVED_FRAME
from core.simulate.effects.warming import Warming
from core.simulate.recording import moved_stage, scan_of
from core.simulate.scenario import Scenario

AT = 16
SEEDS = pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.accuracy)])
BLOCK = Scenario(object="block", scale=0.25, frames=30, seed=1, moved_frame=AT)
FRAME, STRETCH = np.arange(40)[:, None], np.arange(12)


@cache
def features_of(scenario):
    stage, sheets, _ = scan_of(scenario)
    later = moved_stage(scenario, stage.rig) or stage
    pictures = (
        (f"frame{i:04d}", (stage if i < scenario.moved_frame else later).frame(i, sheet))
        for i, sheet in enumerate(sheets)
    )
    options = FeatureOptions(camera=stage.rig.camera)
    return extract_features(stage.reference(), pictures, len(sheets), options), stage.rig


def measured(method=Method.NETWORK, **changes):
    features, rig = features_of(replace(BLOCK, **changes))
    return reconstruct(features, rig.camera, rig.fan, ReconstructOptions(method, sigma_cut_mm=0.2))


@SEEDS
def test_a_scan_at_rest_is_not_suspected(seed):
    result = measured(seed=seed)
    assert (result.moved, result.drifted) == (False, False)
    assert not {note.code for note in result.notes} & {"scan.fan_shifted", "scan.rest_not_judged"}


@pytest.mark.parametrize(("method", "moved"), [(Method.NETWORK, False), (Method.THREE_CROSSINGS, None)])
def test_of_light_watched_in_five_frames_only_crossings_tell_and_that_is_told(method, moved):
    """Ten sweeps say by them whether anything moved, none whether the rig drifted."""
    features, rig = features_of(replace(BLOCK, moved_frame=0))
    ignore_update = tuple(replace(one, fan_shifts_px=np.zeros(0)) for one in features.frames[5:])
    few = replace(features, frames=(*features.frames[:5], *ignore_update))
    result = reconstruct(few, rig.camera, rig.fan, ReconstructOptions(method, sigma_cut_mm=0.2))
    assert (result.moved, result.drifted) == (moved, None)
    (told,) = (note for note in result.notes if note.code == "scan.rest_not_judged")
    assert (told.values["n"], told.values["least"]) == (5, 6)


def test_what_moved_is_told_and_left_out_by_three_crossings_too():
    result = measured(Method.THREE_CROSSINGS, lifted_mm=0.4)
    assert (result.moved, result.notes[0].code) == (True, "scan.fan_shifted")
    assert {frame.reason for frame in result.frames[AT:]} == {MOVED_FRAME}


@pytest.mark.parametrize(
    ("what", "who"),
    [
        ({"lifted_mm": 0.4}, "scan.the_part"),
        pytest.param({"table_mm": 0.4}, "scan.everything", marks=pytest.mark.accuracy),
        pytest.param({"bumped_px": 0.2}, "scan.everything", marks=pytest.mark.accuracy),
    ],
)
@SEEDS
def test_what_moved_is_told_first_with_its_frames_and_by_how_far(what, who, seed):
    result = measured(seed=seed, **what)
    first = result.notes[0]
    assert result.moved
    assert first.code == "scan.fan_shifted"
    assert first.values["what"].code == who
    assert f"between frame{AT - 1:04d} and frame{AT:04d}" in str(first)
    if "bumped_px" not in what:
        assert 0.25 < first.values["shift_mm"] < 0.5
    assert {frame.reason for frame in result.frames[AT:]} == {MOVED_FRAME}


@pytest.mark.accuracy
def test_a_part_that_is_put_back_is_used_before_and_after():
    features, rig = features_of(BLOCK)
    lifted, _ = features_of(replace(BLOCK, lifted_mm=0.4, moved_frame=0))
    frames = tuple(lifted.frames[i] if 10 <= i < 15 else frame for i, frame in enumerate(features.frames))
    result = reconstruct(replace(features, frames=frames), rig.camera, rig.fan, ReconstructOptions(sigma_cut_mm=0.2))
    assert [frame.reason == MOVED_FRAME for frame in result.frames] == [10 <= i < 15 for i in range(30)]
    assert "between frame0009 and frame0010 and between frame0014 and frame0015" in str(result.notes[0])


@pytest.mark.accuracy
def test_a_camera_bumped_early_is_refused_with_what_happened_and_when():
    with pytest.raises(InputError, match="the first frame after it is frame0006, and only 6 frames"):
        measured(bumped_px=2.0, moved_frame=6)


@SEEDS
def test_a_rig_that_warms_is_told_as_a_drift_and_all_frames_are_used(seed):
    warming = Warming(scan_px=0.1, scan_focal_ppm=50, scan_urad=20)
    result = measured(seed=seed, moved_frame=0, warming=warming)
    assert result.drifted
    assert not result.moved
    assert result.notes[0].code == "scan.drifted"
    assert 0.01 < result.notes[0].values["shift_px"] < 0.1
    assert not {note.code for note in result.notes} & {"scan.fan_shifted", "scan.moved", "scan.second_bounces"}
    assert not [frame for frame in result.frames if frame.reason == MOVED_FRAME]


@pytest.mark.parametrize(
    ("what", "code"),
    [
        ({"lifted_mm": 0.4}, "scan.moved_and_not_solved"),
        ({"moved_frame": 0, "warming": Warming(scan_px=0.1, scan_focal_ppm=50, scan_urad=20)}, "scan.drifted_too_much"),
    ],
)
def test_what_cannot_be_solved_is_refused_for_what_moved(what, code, monkeypatch):
    def not_solved(*_):
        raise InputError(plain("nothing fits"))

    monkeypatch.setattr(reconstruct_module, "_solve", not_solved)
    with pytest.raises(InputError, match=r"moved .* nothing fits \(what is named first explains \d+ %") as refused:
        measured(**what)
    assert refused.value.code == code


def test_shares_of_causes_are_worked_out_for_a_complaint_only(monkeypatch):
    def ask(*_):
        raise AssertionError("nobody complains")

    monkeypatch.setattr(reconstruct_module, "causes_of_light", ask)
    assert measured(lifted_mm=0.4).moved


@pytest.mark.accuracy
@pytest.mark.parametrize("seed", [1, 3])
def test_a_rig_that_warms_too_much_is_refused_for_its_drift_or_told_to_drift(seed):
    warming = Warming(scan_px=1.0, scan_focal_ppm=500, scan_urad=300)
    try:
        assert measured(seed=seed, moved_frame=0, warming=warming).drifted
    except InputError as refused:
        assert refused.code == "scan.drifted_too_much"
        assert "warm up" in str(refused.todo)


def possible_at(at, shifts_px, noise_px):
    """First frames after those of the movements that light which lies aside so, with noise, does not deny."""
    shifts = np.random.default_rng(3).normal(shifts_px, noise_px)
    movements = [Between(frame - 1, frame) for frame in at]
    left = possible_movements(movements, FRAME[:, 0], shifts, np.full(shifts.shape[1], noise_px))
    return tuple(one.first_after for one in left)


@pytest.mark.parametrize(
    ("shift_px", "noise_px", "at", "possible"),
    [
        pytest.param(0.0, 0.005, (20,), (), id="at rest"),
        pytest.param(0.3 * ((FRAME >= 15) & (FRAME < 20)), 0.005, (15, 20), (15, 20), id="away for a while"),
        pytest.param(0.3 * (FRAME >= 15), 0.005, (15, 25), (15,), id="crossings find another one"),
        pytest.param(0.2 * (FRAME >= 36), 0.1, (36,), (36,), id="noisy, few frames after it"),
        pytest.param(0.05 * (FRAME >= 20), 0.05, (20,), (20,), id="noisy, and little"),
        pytest.param(0.0, 0.05, (20,), (20,), id="noisy, and unknown"),
        pytest.param(0.3 * ((FRAME >= 20) & (STRETCH < 2)), 0.005, (20,), (20,), id="two stretches"),
        pytest.param(0.015 * (FRAME >= 20), 0.01, (20,), (20,), id="in all stretches together"),
    ],
)
def test_the_fans_light_denies_only_movements_that_it_would_surely_show(shift_px, noise_px, at, possible):
    assert possible_at(at, shift_px + np.zeros((40, 12)), noise_px) == possible


def test_the_fans_light_denies_no_movement_that_it_shows_itself_though_others_are_near():
    """Between those that crossings find there are frames too few to show it again."""
    three = 0.03 * ((FRAME >= 20) & (np.arange(100) < 3))
    assert possible_at((17, 20, 23), three, 0.008) == (20,)
