"""Colour pictures of which nobody says which channel to look at."""

import cv2
import numpy as np
import pytest

from core.files.recording.laser_channel import LaserChannel, laser_channel
from core.files.recording.recording_set import open_set
from core.files.recording.rig import default_rig, rig_to_toml


def lit(colour, seed, light=True, room=60.0):
    """A picture (120, 160, 3) in room light with a stripe of light of a `colour` (blue, green, red) across it."""
    rng = np.random.default_rng(seed)
    picture = rng.normal(room, 4.0, (120, 160, 3))
    stripe = np.exp(-0.5 * ((np.arange(120) - 50) / 1.5) ** 2)[:, None, None]
    picture += light * stripe * np.asarray(colour, dtype=float)
    return np.clip(picture, 0, 255).round().astype(np.uint8)


RED, GREEN, BLUE, WHITE = (2, 8, 150), (5, 150, 20), (150, 8, 2), (60, 60, 60)


@pytest.mark.parametrize("with_off", [True, False])
@pytest.mark.parametrize(("colour", "channel"), [(RED, "red"), (BLUE, "blue")])
def test_the_channel_of_the_lasers_colour_is_chosen_and_told(colour, channel, with_off):
    pictures = [(lit(colour, seed), lit(colour, 10 + seed, light=False) if with_off else None) for seed in range(3)]
    chosen = laser_channel(pictures)
    assert chosen.channel == channel
    (note,) = chosen.notes("scan")
    assert f"in their {channel} channel" in str(note)


@pytest.mark.parametrize("colour", [WHITE, GREEN])
def test_light_that_grey_shows_about_as_well_stays_grey(colour):
    chosen = laser_channel([(lit(colour, seed), lit(colour, 10 + seed, light=False)) for seed in range(3)])
    assert chosen == LaserChannel()
    assert chosen.notes("scan") == ()


def test_a_channel_that_is_saturated_is_not_chosen():
    bright = (20, 90, 4000)
    assert laser_channel([(lit(bright, 1), lit(bright, 2, light=False))]).channel != "red"


def colour_set(folder, head="", colour=RED):
    for part in ("camera", "planes", "scan"):
        (folder / part).mkdir(parents=True)
    (folder / "rig.toml").write_text(head + rig_to_toml(default_rig()))
    cv2.imwrite(str(folder / "camera" / "a.png"), lit(WHITE, 1))
    cv2.imwrite(str(folder / "planes" / "a.png"), lit(colour, 2))
    cv2.imwrite(str(folder / "planes" / "a_off.png"), lit(colour, 3, light=False))
    cv2.imwrite(str(folder / "scan" / "f0.png"), lit(colour, 4))
    return open_set(folder)


def test_a_set_looks_at_each_part_in_its_best_channel_and_at_the_target_in_grey(tmp_path):
    found = colour_set(tmp_path / "set")
    red = cv2.imread(str(found.planes[0].on))[:, :, 2]
    assert (found.read(found.planes[0].on) == red).all()
    assert found.laser_channel("scan").channel == "red"
    grey = cv2.imread(str(found.camera[0]), cv2.IMREAD_GRAYSCALE)
    assert np.abs(found.read(found.camera[0]).astype(int) - grey).max() <= 1


def test_what_rig_toml_states_is_taken_without_a_word(tmp_path):
    found = colour_set(tmp_path / "set", 'channel = "green"\n')
    assert found.laser_channel("planes") == LaserChannel("green")
    assert found.laser_channel("planes").notes("planes") == ()
    assert (found.read(found.frames[0]) == cv2.imread(str(found.frames[0]))[:, :, 1]).all()


def test_grey_pictures_have_no_channel(tmp_path):
    found = colour_set(tmp_path / "set")
    for path in (found.planes[0].on, found.planes[0].off):
        cv2.imwrite(str(path), cv2.imread(str(path), cv2.IMREAD_GRAYSCALE))
    assert found.laser_channel("planes") == LaserChannel()
