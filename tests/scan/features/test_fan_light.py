"""Pictures exposed otherwise than the reference: told by the fan's light, and the fan is not taken for the sweep."""

import cv2
import numpy as np
import pytest

from core.scan.features.extraction import extract_features
from core.scan.features.fan_light import FanLight
from core.scan.features.reference import read_reference
from core.simulate.effects.warming import Warming
from core.simulate.recording import scan_of
from core.simulate.scenario import Scenario

BLACK = 5.0
GAINS = (1.4, 0.7, 1.0, 1.25, 0.8, 1.1)


@pytest.fixture(scope="module")
def scan():
    scenario = Scenario(scale=0.25, frames=36, seed=3)
    stage, sheets, _ = scan_of(scenario)
    return stage.reference(), [(f"frame{i:04d}", stage.frame(i, sheets[i])) for i in (3, 8, 14, 20, 25, 30)]


def exposed(picture, gain):
    """The picture as a camera makes it that collects so many times the light."""
    return np.clip(np.rint(BLACK + gain * (picture - BLACK)), 0, 255).astype(np.uint8)


def on_fan(frame, fan):
    """How many points of a frame's stripe lie along a line of the fan for a long way."""
    lit = np.concatenate([piece.uv for piece in fan])
    pieces = (piece.uv for piece in frame.centrelines)
    near = [np.linalg.norm(uv[:, None] - lit[None, ::2], axis=2).min(axis=1) < 2 for uv in pieces]
    return sum(int(one.sum()) for one in near if one.mean() > 0.5)


def test_the_gain_of_each_picture_is_found_by_the_fan(scan):
    reference, frames = scan
    seen = read_reference(reference)
    for (_, picture), gain in zip(frames, GAINS, strict=True):
        found = seen.of_lasers(exposed(picture, gain)).gain
        assert found - 1 == pytest.approx(gain - 1, abs=0.01 + 0.2 * abs(gain - 1))


@pytest.mark.parametrize("at", [60.0, 320.0, 580.0])
@pytest.mark.parametrize("gain", [0.8, 1.0, 1.2])
def test_a_gain_is_found_however_the_background_rises_across_the_picture(at, gain):
    """From 12 to 24 grey levels, under a faint fan: the background's change is no light of the fan, nor lacks it."""
    u = np.broadcast_to(np.arange(640.0), (400, 640))
    bare = (12 * (1 + u / 639)).astype(np.float32)
    base = bare + np.where(np.abs(u - at) < 8, 15 * np.exp(-(((u - at) / 2) ** 2) / 2), 0).astype(np.float32)
    found = FanLight.of(base, bare, 255.0).gain(np.float32(gain - 1) * base)
    assert found == pytest.approx(gain, abs=0.02)


@pytest.mark.parametrize("shift_px", [0.3, 0.8])
def test_a_fan_that_lies_aside_is_no_other_exposure_and_one_is_found_all_the_same(scan, shift_px):
    reference, frames = scan
    seen, aside = read_reference(reference), np.float32([[1, 0, shift_px], [0, 1, 0]])
    for _, picture in frames[:2]:
        moved = cv2.warpAffine(picture.astype(np.float32), aside, picture.shape[::-1], flags=cv2.INTER_CUBIC)
        assert seen.of_lasers(exposed(moved, 1.0)).gain == 1.0
        for gain in (0.75, 1.3):
            assert abs(seen.of_lasers(exposed(moved, gain)).gain - 1) > 0.5 * abs(gain - 1)


def test_a_fan_of_a_warm_rig_is_no_other_exposure():
    warm = Scenario(scale=0.25, frames=36, seed=1, warming=Warming(scan_px=1.5, scan_focal_ppm=750, scan_urad=450))
    stage, sheets, _ = scan_of(warm)
    seen = read_reference(stage.reference())
    assert [seen.of_lasers(stage.frame(i, sheets[i])).gain for i in (30, 35)] == [1.0, 1.0]


def test_a_fan_brighter_than_in_the_reference_is_no_sweep(scan):
    reference, frames = scan
    bright = [(name, exposed(picture, 1.5)) for name, picture in frames]
    still = extract_features(reference, frames, len(frames))
    found = extract_features(reference, bright, len(frames))
    note = next(note for note in found.notes if note.code == "scan.brightness_changed")
    assert note.values["n"] == len(frames) and note.values["percent"] == pytest.approx(50, abs=10)
    assert not any(note.code == "scan.room_light_changed" for note in found.faults), "it is the exposure"
    for one, other in zip(still.frames, found.frames, strict=True):
        assert on_fan(other, found.fan) <= on_fan(one, still.fan) + 20
        assert sum(map(len, other.centrelines)) > 0.9 * sum(map(len, one.centrelines))


def test_pictures_of_one_exposure_are_not_touched(scan):
    reference, frames = scan
    seen = read_reference(reference)
    for _, picture in frames:
        light = seen.of_lasers(picture)
        assert light.gain == 1 and np.array_equal(light.difference, seen.difference(picture))


def test_a_frame_without_the_fan_is_not_brought_back(scan):
    reference, _ = scan
    seen = read_reference(reference)
    assert seen.of_lasers(np.full_like(reference, 8)).gain == 1
