"""Further exposures of frames, shorter and longer: what is saturated in one is measured in the next shorter one."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from core.image.stripes.bracket import Exposure, bracketed, fused
from core.scan.features.extraction import FrameReader, FurtherExposures, choose_sweep_stripe, saturated_pixels
from core.scan.features.frames import FrameFeatures, notes_on
from core.scan.features.reference import read_reference
from core.simulate.effects.sensor import SensorEffects
from core.simulate.recording import scan_of
from core.simulate.scenario import Scenario

TWICE = SensorEffects(brightness=2.0, bloom=0.3, second_exposure=8.0)
SHINY = Scenario(scale=0.25, frames=12, seed=3, speckle=0.0, gloss=20.0, sensor=TWICE)
"""Without speckle, of which the noise decides how much each picture sees."""
MATT = replace(SHINY, gloss=0.0, sensor=SensorEffects(second_exposure=8.0))
DARK = SensorEffects(brightness=0.5, bloom=0.3, second_exposure=0.25, third_exposure=4.0)
"""A first exposure for neither the dark nor the shiny: the second one is longer, the third one shorter."""
SHOWN = (3, 7, 11)


class Scan:
    """A few frames of a scenario read with and without their second exposures; `aside` moves the hand between them."""

    def __init__(self, scenario, aside=0):
        stage, sheets, _ = scan_of(scenario)
        self.reference = read_reference(stage.reference())
        frames = [(f"frame{i}", stage.frame(i, sheets[i])) for i in SHOWN]
        shots = {f"frame{i}": stage.further_frames(i, sheets[i - aside]) for i in SHOWN}
        stripe = choose_sweep_stripe(frames, self.reference)
        self.further = {}
        for number, picture in stage.further_references().items():
            seen = read_reference(picture, first=self.reference)
            again = {name: pictures[number] for name, pictures in shots.items()}
            self.further[number] = FurtherExposures(seen, choose_sweep_stripe(list(again.items()), seen), again.get)
        self.alone = [FrameReader(self.reference, stripe)(item) for item in enumerate(frames)]
        self.twice = [FrameReader(self.reference, stripe, further=self.further)(item) for item in enumerate(frames)]


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


@pytest.fixture(scope="module")
def thrice():
    return Scan(replace(SHINY, gloss=40.0, sensor=DARK))


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
    assert sum(frame.exposures[2].points for frame in shiny.twice) > 300
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
    factors = [frame.exposures[2].factor for frame in shiny.twice]
    assert factors == pytest.approx([8.0] * 3, rel=0.03)
    brightest = max(line.strength.max() for frame in shiny.twice for line in frame.centrelines)
    assert brightest > 400


def test_the_fan_is_mended_alike(shiny):
    lines, both = bracketed(shiny.reference.fan, shiny.further[2].reference.fan, saturated_pixels(shiny.reference.base))
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
        assert twice.exposures[2].points == 0
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


def test_the_notes_tell_of_further_exposures_and_of_those_that_are_of_no_use(shiny):
    (note,) = (one for one in notes_on(shiny.twice) if one.code == "scan.further_exposures")
    assert "3 of 3 frames have an exposure @2, 3.0 EV shorter than the first one" in str(note)
    moved = replace(shiny.twice[1], exposures={2: replace(shiny.twice[1].exposures[2], moved=True, shift_px=0.4)})
    (note,) = (one for one in notes_on([moved]) if one.code == "scan.further_exposures_moved")
    assert note.values["name"] == "frame7"
    assert notes_on([FrameFeatures(0, "alone", ())]) == ()


def medians(frames, name):
    return np.median([value for frame in frames for line in frame.centrelines for value in getattr(line, name)])


def test_of_three_exposures_each_point_is_from_the_longest_that_is_not_saturated(thrice, truth):
    longer, shorter = ([frame.exposures[number] for frame in thrice.twice] for number in (2, 3))
    assert [seen.factor for seen in longer] == pytest.approx([0.25] * 3, rel=0.05)
    assert [seen.factor for seen in shorter] == pytest.approx([4.0] * 3, rel=0.15)
    of_longer, of_shorter = (sum(seen.points for seen in each) for each in (longer, shorter))
    total = sum(len(line) for frame in thrice.twice for line in frame.centrelines)
    assert of_longer > 0.5 * total
    assert 0 < of_shorter < total - of_longer
    assert medians(thrice.twice, "sigma") < 0.6 * medians(thrice.alone, "sigma")
    assert medians(thrice.twice, "strength") == pytest.approx(medians(thrice.alone, "strength"), rel=0.2)
    errors = misses(thrice.twice, truth)
    spread = np.subtract(*np.quantile(errors, [0.8413, 0.1587])) / 2
    assert 0.7 < spread < 1.4
    assert abs(np.median(errors)) < 0.3


def test_the_notes_tell_of_each_further_exposure_whether_it_is_longer(thrice):
    notes = [str(one) for one in notes_on(thrice.twice) if one.code == "scan.further_exposures"]
    assert len(notes) == 2
    assert "@2, 2.0 EV longer" in notes[0]
    assert "@3, 2.0 EV shorter" in notes[1]


def test_a_longer_exposure_that_moved_is_left_out_and_the_shorter_one_is_not(shiny):
    line = max(shiny.alone[0].centrelines, key=len)
    line = replace(line, saturated=np.arange(len(line)) > len(line) // 2)
    none, everywhere = np.zeros((2000, 2000), np.bool_), np.ones((2000, 2000), np.bool_)
    clear = np.zeros(len(line), np.bool_)
    first = Exposure([line], everywhere, 0.4)
    long = Exposure([replace(line, uv=line.uv + 0.2 * line.normal, strength=4 * line.strength)], everywhere, 0.9)
    short = Exposure([replace(line, strength=line.strength / 8, saturated=clear)], none, 0.1)
    for others in ((long, short), (short, long)):
        (mended,), told = fused(first, others)
        told = dict(zip(others, told, strict=True))
        assert (told[long].moved, told[long].points, told[long].factor) == (True, 0, pytest.approx(0.25))
        assert (told[short].moved, told[short].factor) == (False, pytest.approx(8))
        assert told[short].points > 0.4 * len(line)
        assert np.abs(mended.uv - line.uv).max() < 1e-9
        assert mended.strength == pytest.approx(line.strength)
