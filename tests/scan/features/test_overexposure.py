"""Stripes that are exposed too long are told, with that as the reason why nothing can be measured."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from core.errors import InputError
from core.scan.features.extraction import extract_features
from core.scan.features.overexposure import notes_on_shine, overexposed
from core.scan.reconstruct import reconstruct
from core.simulate.effects.sensor import SensorEffects
from core.simulate.recording import scan_of, scenario_rig
from core.simulate.scenario import Scenario

RIG = Scenario(scale=0.25, frames=12, seed=3)
FAR_TOO_BRIGHT = replace(RIG, scale=0.15, sensor=SensorEffects(brightness=6.0))
"""Larger pictures show no more: their saturated areas are followed for seconds."""


def features_of(scenario):
    stage, sheets, _ = scan_of(scenario)
    frames = [(f"frame{i:04d}", stage.frame(i, sheets[i])) for i in range(3, 12, 2)]
    return extract_features(stage.reference(), frames, len(frames))


@cache
def features_far_too_bright(scale=FAR_TOO_BRIGHT.scale):
    return features_of(replace(FAR_TOO_BRIGHT, scale=scale))


@pytest.mark.parametrize(
    "scale", [FAR_TOO_BRIGHT.scale, 0.12], ids=["no crossing", "three crossings that locate nothing"]
)
def test_a_scan_that_is_far_too_bright_is_refused_for_that(scale):
    rig, bright = scenario_rig(replace(FAR_TOO_BRIGHT, scale=scale)), features_far_too_bright(scale)
    with pytest.raises(InputError) as refused:
        reconstruct(bright, rig.camera, rig.fan)
    assert refused.value.code == "scan.overexposed"
    assert "expose shorter" in str(refused.value)


def test_stripes_as_they_should_be_are_not_called_overexposed():
    seen = features_of(RIG)
    assert overexposed(seen.fan, [piece for frame in seen.frames for piece in frame.centrelines]) is None
    assert overexposed((), ()) is None


def shine_of(scenario):
    return shine_in(features_of(scenario))


def shine_in(seen):
    return notes_on_shine(seen.fan, [piece for frame in seen.frames for piece in frame.centrelines], 255.0)


@pytest.mark.parametrize(
    ("gloss", "stops"), [pytest.param(3.0, (0.5, 1.0), marks=pytest.mark.accuracy), (20.0, (1.0, 2.5))]
)
def test_a_glossy_part_is_told_with_how_much_less_to_expose(gloss, stops):
    (note,) = shine_of(replace(RIG, gloss=gloss))
    assert note.code == "scan.shines"
    assert stops[0] <= note.values["stops"] <= stops[1]
    assert "EV less" in str(note)


@pytest.mark.parametrize(
    "scenario", [RIG, pytest.param(replace(RIG, seed=7), marks=pytest.mark.accuracy), replace(RIG, speckle=0.35)]
)
def test_a_matt_part_is_not_said_to_shine(scenario):
    assert shine_of(scenario) == ()


def test_sweeps_that_saturate_where_they_cross_the_fan_are_not_said_to_shine():
    seen = features_of(RIG)
    sweeps = [piece for frame in seen.frames for piece in frame.centrelines]
    sweeps = [replace(piece, saturated=np.arange(len(piece.saturated)) % 50 == 0) for piece in sweeps]
    assert notes_on_shine(seen.fan, sweeps, 255.0) == ()


def test_a_stripe_that_is_saturated_at_its_grains_all_along_does_not_shine():
    """A matt table near the laser is lit the more: path-traced, 4 to 5 % of the fan's points were called gloss."""
    seen = features_of(RIG)
    bright = [replace(piece, saturated=np.arange(len(piece.saturated)) % 12 == 0) for piece in seen.fan]
    (note,) = notes_on_shine(bright, (), 255.0)
    assert note.code == "scan.bright_in_part"
    assert "matt" not in str(note)


def test_a_scan_that_is_refused_as_overexposed_is_not_said_to_shine_as_well():
    assert shine_in(features_far_too_bright()) == ()
