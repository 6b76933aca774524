"""Stripes that are exposed too long are told, with that as the reason why nothing can be measured."""

from dataclasses import replace

import pytest

from core.errors import InputError
from core.scan.features.extraction import extract_features
from core.scan.features.overexposure import overexposed
from core.scan.reconstruct import reconstruct
from core.simulate.effects.sensor import SensorEffects
from core.simulate.recording import scan_of, scenario_rig
from core.simulate.scenario import Scenario

RIG = Scenario(scale=0.25, frames=12, seed=3)


def features_of(scenario):
    stage, sheets, _ = scan_of(scenario)
    frames = [(f"frame{i:04d}", stage.frame(i, sheets[i])) for i in range(3, 12, 2)]
    return extract_features(stage.reference(), frames, len(frames))


def test_a_scan_that_is_far_too_bright_is_refused_for_that():
    rig = scenario_rig(RIG)
    bright = features_of(replace(RIG, sensor=SensorEffects(brightness=6.0)))
    with pytest.raises(InputError) as refused:
        reconstruct(bright, rig.camera, rig.fan)
    assert refused.value.code == "scan.overexposed"
    assert "expose shorter" in str(refused.value)


def test_stripes_as_they_should_be_are_not_called_overexposed():
    seen = features_of(RIG)
    assert overexposed(seen.fan, [piece for frame in seen.frames for piece in frame.centrelines]) is None
    assert overexposed((), ()) is None
