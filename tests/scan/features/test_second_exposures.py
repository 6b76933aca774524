"""Second, shorter exposures of frames: what is saturated in the first one is measured in them."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from core.image.stripes.bracket import bracketed
from core.scan.features.extraction import FrameReader, SecondExposures, choose_sweep_stripe, saturated_pixels
from core.scan.features.frames import FrameFeatures, notes_on
from core.scan.features.reference import read_reference
from core.simulate.effects.sensor import SensorEffects
from core.simulate.recording import scan_of
from core.simulate.scenario import Scenario

TWICE = SensorEffects(brightness=2.0, bloom=0.3, second_exposure=8.0)
SHINY = Scenario(scale=0.25, frames=12, seed=3, speckle=0.0, gloss=20.0, sensor=TWICE)
"""Without speckle, of which the noise decides how much each picture sees."""
MATT = replace(SHINY, gloss=0.0, sensor=SensorEffects(second_exposure=8.0))
SHOWN = (3, 7, 11)


class Scan:
    """A few frames of a scenario read with and without their second exposures; `aside` moves the hand between them."""

    def __init__(self, scenario, aside=0):
        stage, sheets, _ = scan_of(scenario)
        self.reference = read_reference(stage.reference())
        self.dim = read_reference(stage.second_reference(), first=self.reference)
        frames = [(f"frame{i}", stage.frame(i, sheets[i])) for i in SHOWN]
        seconds = {f"frame{i}": stage.second_frame(i, sheets[i - aside]) for i in SHOWN}
        stripe = choose_sweep_stripe(frames, self.reference)
        second = SecondExposures(self.dim, choose_sweep_stripe(list(seconds.items()), self.dim), seconds.get)
        self.alone = [FrameReader(self.reference, stripe)(item) for item in enumerate(frames)]
        self.twice = [FrameReader(self.reference, stripe, second=second)(item) for item in enumerate(frames)]


@pytest.fixture(scope="module")
def shiny():
    return Scan(SHINY)


@pytest.fixture(scope="module")
def truth():
    """The sweeps' centrelines of the same light in pictures of 16 bits without noise, nowhere saturated."""
    dim = replace(SHINY, bits=16, noise=0.0, sensor=SensorEffects(brightness=0.125))
    stage, sheets, _ = scan_of(dim)
    reference = read_reference(stage.reference())
    frames = [(f"frame{i}", stage.frame(i, sheets[i])) for i in SHOWN]
    stripe = choose_sweep_stripe(frames, reference)
    return [FrameReader(reference, stripe)(item) for item in enumerate(frames)]


def usable(frames):
    return sum(int((~line.saturated).sum()) for frame in frames for line in frame.centrelines)


def misses(frames, truth):
    """Distance over σ of the points to the true lines, as far as these go."""
    found = []
    for frame, true in zip(frames, truth, strict=True):
        lines = true.centrelines
        uv, normal = np.vstack([line.uv for line in lines]), np.vstack([line.normal for line in lines])
        tree = cKDTree(uv)
        for line in frame.centrelines:
            distance, near = tree.query(line.uv)
            across = ((line.uv - uv[near]) * normal[near]).sum(axis=1)
            seen = (distance < 1.5) & ~line.saturated
            found.append(across[seen] / line.sigma[seen])
    return np.concatenate(found)


def test_where_a_part_shines_points_come_from_the_second_exposure_and_their_sigma_is_true(shiny, truth):
    assert usable(shiny.twice) > 1.3 * usable(shiny.alone)
    assert sum(frame.exposures.points for frame in shiny.twice) > 300
    errors = misses(shiny.twice, truth)
    assert len(errors) > 0.8 * usable(shiny.twice)
    spread = np.subtract(*np.quantile(errors, [0.8413, 0.1587])) / 2
    assert 0.7 < spread < 1.4
    assert abs(np.median(errors)) < 0.3


def test_points_of_one_line_go_on_ahead(shiny):
    for frame in shiny.twice:
        for line in frame.centrelines:
            ahead = (np.diff(line.uv, axis=0) * line.tangent[:-1]).sum(axis=1)
            assert ahead.min() > 0


def test_the_brightness_of_points_is_that_of_the_first_exposure(shiny):
    factors = [frame.exposures.factor for frame in shiny.twice]
    assert factors == pytest.approx([8.0] * 3, rel=0.03)
    brightest = max(line.strength.max() for frame in shiny.twice for line in frame.centrelines)
    assert brightest > 400


def test_the_fan_is_mended_alike(shiny):
    lines, both = bracketed(shiny.reference.fan, shiny.dim.fan, saturated_pixels(shiny.reference.base))
    assert both.points > 200
    before, now = (sum(line.saturated.sum() for line in fan) for fan in (shiny.reference.fan, lines))
    assert now < 0.3 * before


def test_what_is_nowhere_saturated_stays_as_it_is():
    scan = Scan(MATT)
    for alone, twice in zip(scan.alone, scan.twice, strict=True):
        clear = [not line.saturated.any() for line in alone.centrelines]
        for line, same in zip(alone.centrelines, clear, strict=True):
            if same:
                assert any(np.array_equal(line.uv, other.uv) for other in twice.centrelines)


def test_a_hand_that_moves_between_the_two_is_found_and_told():
    scan = Scan(SHINY, aside=1)
    for alone, twice in zip(scan.alone, scan.twice, strict=True):
        assert twice.exposures.points == 0
        assert [len(line) for line in twice.centrelines] == [len(line) for line in alone.centrelines]


def test_a_movement_of_a_fifth_of_a_pixel_is_one(shiny):
    line = max(shiny.alone[0].centrelines, key=len)
    line = replace(line, saturated=np.arange(len(line)) > len(line) // 2)
    picture = np.ones((2000, 2000), np.bool_)
    for shift, moved in ((0.02, False), (0.2, True)):
        other = replace(line, uv=line.uv + shift * line.normal, saturated=np.zeros(len(line), np.bool_))
        mended, both = bracketed([line], [other], picture)
        assert both.moved is moved
        assert both.shift_px == pytest.approx(shift, abs=0.005)
        assert (mended[0].uv[-1] != line.uv[-1]).any() is np.bool_(not moved)


def test_where_the_first_exposure_is_saturated_all_over_the_second_one_alone_counts(shiny):
    line = max(shiny.alone[0].centrelines, key=len)
    lost = replace(line, uv=line.uv + 0.8 * line.normal, saturated=np.ones(len(line), np.bool_))
    dim = replace(line, strength=line.strength / 8, saturated=np.zeros(len(line), np.bool_))
    (mended,), both = bracketed([lost], [dim], np.ones((2000, 2000), np.bool_))
    assert np.array_equal(mended.uv, dim.uv)
    assert (both.moved, both.points, both.shift_px) == (False, len(line), 0.0)
    assert mended.strength == pytest.approx(line.strength)


def test_the_notes_tell_of_second_exposures_and_of_those_that_are_of_no_use(shiny):
    (note,) = (one for one in notes_on(shiny.twice) if one.code == "scan.second_exposures")
    assert "3 of 3 frames have a second exposure, 3.0 f-stops shorter" in str(note)
    moved = replace(shiny.twice[1], exposures=replace(shiny.twice[1].exposures, moved=True, shift_px=0.4))
    (note,) = (one for one in notes_on([moved]) if one.code == "scan.second_exposures_moved")
    assert note.values["name"] == "frame7"
    assert notes_on([FrameFeatures(0, "alone", ())]) == ()
