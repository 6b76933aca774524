"""Colour pictures of which nobody says which channel to look at."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from core.acquire.grey import saturated_in, to_grey
from core.files.recording.laser_channel import LaserChannel, LitPicture, against_background, laser_channel
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import open_set
from core.files.recording.rig import default_rig, rig_to_toml
from core.pipeline.steps.kept_features import features_key
from core.settings.options import Options
from tests import paper


def lit(colour, seed, light=True, room=60.0):
    """A picture (120, 160, 3) in room light with a stripe of light of a `colour` (blue, green, red) across it."""
    rng = np.random.default_rng(seed)
    picture = rng.normal(room, 4.0, (120, 160, 3))
    stripe = np.exp(-0.5 * ((np.arange(120) - 50) / 1.5) ** 2)[:, None, None]
    picture += light * stripe * np.asarray(colour, dtype=float)
    return np.clip(picture, 0, 255).round().astype(np.uint8)


RED, GREEN, BLUE, WHITE = (2, 8, 150), (5, 150, 20), (150, 8, 2), (60, 60, 60)


def test_frames_without_a_reference_are_judged_by_what_changes_and_not_by_what_is_painted():
    """A red line is painted on the wall, a weaker blue one moves over it."""
    frames = []
    for number in range(9):
        painted = lit(RED, number).astype(int)
        moved = np.roll(lit(BLUE, 20 + number), 10 * number, axis=0).astype(int)
        frames.append(LitPicture(np.clip(painted + 2 * (moved - 60) // 3, 0, 255).astype(np.uint8)))
    assert laser_channel(frames[:3]).channel != "blue"
    against = against_background(frames)
    assert len(against) == 3
    assert laser_channel(against).channel == "blue"


def test_two_frames_make_no_background():
    frames = [LitPicture(lit(RED, number)) for number in range(2)]
    assert against_background(frames) == frames


@pytest.mark.parametrize("with_off", [True, False])
@pytest.mark.parametrize(("colour", "channel"), [(RED, "red"), (BLUE, "blue")])
def test_the_channel_of_the_lasers_colour_is_chosen_and_told(colour, channel, with_off):
    pictures = [
        LitPicture(lit(colour, seed), lit(colour, 10 + seed, light=False) if with_off else None) for seed in range(3)
    ]
    chosen = laser_channel(pictures)
    assert chosen.channel == channel
    (note,) = chosen.notes("scan")
    assert f"in their {channel} channel" in str(note)


@pytest.mark.parametrize("colour", [WHITE, GREEN])
def test_light_that_grey_shows_about_as_well_stays_grey(colour):
    chosen = laser_channel([LitPicture(lit(colour, seed), lit(colour, 10 + seed, light=False)) for seed in range(3)])
    assert chosen == LaserChannel()
    assert chosen.notes("scan") == ()


def textured(colour, seed):
    """As `lit`, but on black and white squares of which the light takes as much as they give."""
    rng = np.random.default_rng(seed)
    rows, columns = np.mgrid[:240, :320]
    squares = np.where((rows // 8 + columns // 8) % 2, 150.0, 20.0)[:, :, None]
    stripe = np.exp(-0.5 * ((rows - 0.5 * columns - 30) / 1.5) ** 2)[:, :, None]
    picture = squares + rng.normal(0, 2.0, (240, 320, 3)) + stripe * np.asarray(colour, dtype=float)
    return np.clip(picture, 0, 255).round().astype(np.uint8)


@pytest.mark.parametrize(
    ("colour", "channel"), [((2, 8, 90), "red-green"), ((2, 90, 8), "green-red"), ((90, 8, 2), "blue-red")]
)
def test_among_black_and_white_marks_a_laser_is_looked_at_by_its_colour(colour, channel):
    chosen = laser_channel([LitPicture(textured(colour, seed)) for seed in range(3)])
    assert chosen.channel == channel
    assert "−" in str(chosen.notes("planes")[0])


def test_colours_that_a_jpeg_has_rounded_away_are_not_chosen():
    picture = textured((2, 8, 90), 1)
    data = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, 30])[1]
    seen = LitPicture(cv2.imdecode(data, cv2.IMREAD_UNCHANGED), data=data.tobytes())
    assert laser_channel([seen]).channel not in ("red-green", "green-red", "blue-red")


def test_a_difference_shows_nothing_where_a_channel_is_saturated():
    picture = np.zeros((4, 4, 3), np.uint8)
    picture[0, 0], picture[1, 1], picture[2, 2] = (0, 10, 60), (0, 60, 10), (0, 200, 255)
    grey = to_grey(picture, "red-green")
    assert [grey[3, 3], grey[0, 0], grey[1, 1], grey[2, 2]] == [63, 113, 13, 255]
    assert saturated_in(picture, "red-green").sum() == saturated_in(picture, None).sum() == 1
    assert not saturated_in(picture, "green").any()


def test_what_a_command_says_goes_before_rig_toml_and_leaves_the_target(tmp_path):
    recording_set = colour_set(tmp_path / "set", 'channel = "green"\n').with_channel("red-green")
    pictures = PictureReader(recording_set)
    assert [pictures.laser_channel(part).channel for part in ("camera", "planes", "scan")] == ["green"] + [
        "red-green"
    ] * 2
    colours = cv2.imread(str(recording_set.planes[0].on))
    assert (pictures.read(recording_set.planes[0].on) == to_grey(colours, "red-green")).all()
    assert (pictures.read_target(recording_set.planes[0].on) == colours[:, :, 1]).all()


def test_kept_features_are_those_of_the_channel_that_was_chosen(tmp_path):
    found, camera = colour_set(tmp_path / "set"), paper.HALF
    chosen = features_key(PictureReader(found), Options(), camera)
    assert chosen == features_key(PictureReader(found.with_channel("red")), Options(), camera)
    assert chosen != features_key(PictureReader(found.with_channel("red-green")), Options(), camera)
    assert chosen != features_key(
        PictureReader(replace(found, rig=replace(found.rig, mosaic="RGGB"))), Options(), camera
    )


def test_of_raw_pictures_the_channel_that_shows_the_laser_best_is_looked_at_in_any_case():
    pictures = [LitPicture(lit(WHITE, seed), lit(WHITE, 10 + seed, light=False)) for seed in range(3)]
    assert laser_channel(pictures, raw=True).channel in ("red", "green", "blue")
    assert laser_channel([LitPicture(textured((2, 8, 90), 1))], raw=True).channel == "red"


def test_a_channel_that_is_saturated_is_not_chosen():
    bright = (20, 90, 4000)
    assert laser_channel([LitPicture(lit(bright, 1), lit(bright, 2, light=False))]).channel not in ("red", "red-green")


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
    pictures = PictureReader(found)
    red = cv2.imread(str(found.planes[0].on))[:, :, 2]
    assert (pictures.read(found.planes[0].on) == red).all()
    assert pictures.laser_channel("scan").channel == "red"
    grey = cv2.imread(str(found.camera[0]), cv2.IMREAD_GRAYSCALE)
    assert np.abs(pictures.read(found.camera[0]).astype(int) - grey).max() <= 1


def test_what_rig_toml_states_is_taken_without_a_word(tmp_path):
    found = colour_set(tmp_path / "set", 'channel = "green"\n')
    pictures = PictureReader(found)
    assert pictures.laser_channel("planes") == LaserChannel("green")
    assert pictures.laser_channel("planes").notes("planes") == ()
    assert (pictures.read(found.frames[0]) == cv2.imread(str(found.frames[0]))[:, :, 1]).all()


def test_grey_pictures_have_no_channel(tmp_path):
    found = colour_set(tmp_path / "set")
    pictures = PictureReader(found)
    for path in (found.planes[0].on, found.planes[0].off):
        cv2.imwrite(str(path), cv2.imread(str(path), cv2.IMREAD_GRAYSCALE))
    assert pictures.laser_channel("planes") == LaserChannel()
