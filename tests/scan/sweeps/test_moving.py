"""Rendered scans by a hand that moves while rows are read out, measured with the true camera and fan."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from core.inspect.gauge import fit_gauge
from core.inspect.uncertainty.budget import combined
from core.inspect.uncertainty.point_errors import PointErrors
from core.scan.features.extraction import FeatureOptions, extract_features
from core.scan.method import ReconstructOptions
from core.scan.reconstruct import reconstruct
from core.simulate.recording import moving_sheets, scan_of, scenario_rig
from core.simulate.scenario import Scenario
from core.simulate.truth import Truth
from tests.accuracy.twin import depth_errors

STILL = Scenario(scale=0.4, frames=30, seed=1)
ROLLING = replace(STILL, readout_ms=71.0)
TREMBLING = replace(ROLLING, hand_mm_s=28.0, tremor_mm=0.35)


@cache
def seen(scenario):
    """Features of a scenario's scan, its rig, and the truth of its depths."""
    rig = scenario_rig(scenario)
    stage, sheets, figures = scan_of(scenario, rig)
    moving = moving_sheets(scenario, sheets)
    pictures = ((f"frame{i:04d}", stage.frame(i, *sheets)) for i, sheets in enumerate(moving))
    features = extract_features(stage.reference(), pictures, len(moving), FeatureOptions(camera=rig.camera))
    return features, rig, Truth(rig.camera, rig.fan, {}, {}, {}, figures, stage.maps.depth, stage.maps.table)


def measured(scenario, row_time_us, cut_mm=0.1):
    features, rig, truth = seen(scenario)
    options = ReconstructOptions(sigma_cut_mm=cut_mm, row_time_us=row_time_us)
    return reconstruct(features, rig.camera, rig.fan, options), truth, features


def row_time_us(scenario):
    return 1000 * scenario.readout_ms / seen(scenario)[1].camera.image_size[1]


def misses(result, truth):
    """Errors of the sweeps' points in their σ."""
    errors, swept = depth_errors(truth, result.cloud), result.cloud.sweep >= 0
    ratio = np.abs(errors[swept]) / result.cloud.sigma[swept]
    return ratio[np.isfinite(ratio)]


def codes(result):
    return [note.code for note in result.notes]


@pytest.mark.accuracy
@pytest.mark.parametrize(("hand", "seed"), [((14.0, 0.0), 1), ((28.0, 0.0), 2), ((28.0, 0.35), 3)])
def test_points_lie_within_what_is_stated_however_the_hand_moves(hand, seed):
    scenario = replace(ROLLING, hand_mm_s=hand[0], tremor_mm=hand[1], seed=seed)
    result, truth, features = measured(scenario, row_time_us(scenario))
    ratio = misses(result, truth)
    print(f"{hand}: {len(ratio)} points, {100 * np.mean(ratio < 2):.1f} % within 2 sigma")
    assert np.mean(ratio < 2) > 0.88
    assert "scan.hand_moved" in codes(result)
    errors = PointErrors.of_scan(features, result.covariance, None, result.speckle, result.pis.shape[1])
    fit = fit_gauge(result.cloud, errors=errors)
    assert abs(fit.thickness_mm - 50.0) <= 2 * combined(fit.budget)


@pytest.mark.accuracy
def test_points_that_are_lost_to_the_hand_have_that_reason():
    result, _, _ = measured(TREMBLING, row_time_us(TREMBLING), cut_mm=0.05)
    assert "scan.points_unsure_by_motion" in codes(result)


@pytest.mark.accuracy
def test_sheets_twisted_by_tremor_ask_for_their_motion_where_no_row_time_is_stated():
    result, truth, _ = measured(TREMBLING, None)
    assert "scan.rows_roll" in codes(result)
    assert np.mean(misses(result, truth) < 2) > 0.88


@pytest.mark.accuracy
def test_a_global_shutter_gives_the_same_stated_or_not():
    stated, _, _ = measured(STILL, 0.0)
    unstated, _, _ = measured(STILL, None)
    assert np.array_equal(stated.cloud.points, unstated.cloud.points)
    assert np.array_equal(stated.covariance, unstated.covariance)
    assert stated.pis.shape[1] == 3
