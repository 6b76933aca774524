"""What sources can be told, and how they refuse what they cannot."""

import pickle

import pytest

from core.acquire.drivers.genicam import FrameNumbers
from core.acquire.settings import Capabilities, Region, SourceSettings
from core.errors import InputError

CAN = Capabilities(
    exposure_ms=(0.1, 50.0), triggers=("Off", "Line1"), pixel_formats=("Mono8", "Mono12"), sensor=(640, 480)
)


def test_capabilities_name_the_settings_a_source_has():
    assert CAN.names == ("exposure_ms", "trigger", "pixel_format", "region")
    assert Capabilities().names == ()


@pytest.mark.parametrize(
    ("told", "sentence"),
    [
        ({"gain_db": 3.0}, "camera: the source does not let its gain be set; leave it as it is."),
        ({"exposure_ms": 60.0}, "camera: the exposure time of 60 ms is not between 0.1 and 50 ms."),
        ({"trigger": "Line2"}, "camera: the trigger Line2 is not one of Off, Line1."),
        ({"pixel_format": "RGB8"}, "camera: the pixel format RGB8 is not one of Mono8, Mono12."),
        (
            {"region": Region(600, 0, 64, 64)},
            "camera: 64 × 64 pixels from column 600, row 0 is not within its 640 × 480.",
        ),
    ],
)
def test_what_a_source_cannot_be_told_is_refused_in_one_sentence(told, sentence):
    with pytest.raises(InputError) as refused:
        CAN.check(SourceSettings(**told), "camera")
    assert str(refused.value) == sentence


def test_what_a_source_can_be_told_passes():
    CAN.check(SourceSettings(5.0, None, None, "Line1", "Mono12", Region(0, 0, 640, 480)), "camera")


@pytest.mark.parametrize(
    "told",
    [{"trigger": "line one"}, {"pixel_format": ""}, {"region": (-1, 0, 5, 5)}, {"region": (0, 0, 0, 5)}],
)
def test_settings_no_camera_has_are_refused(told):
    with pytest.raises(InputError):
        SourceSettings(**{name: Region(*value) if name == "region" else value for name, value in told.items()})


def test_newer_settings_replace_older_ones_and_go_to_another_process():
    old = SourceSettings(exposure_ms=2.0, region=Region(0, 0, 8, 8))
    new = old.updated(SourceSettings(region=Region(4, 4, 8, 8), trigger="Off"))
    assert new == SourceSettings(exposure_ms=2.0, region=Region(4, 4, 8, 8), trigger="Off")
    assert pickle.loads(pickle.dumps(new)) == new
    assert new.only(("trigger", "gain_db")) == SourceSettings(trigger="Off")


@pytest.mark.parametrize(
    ("numbers", "missing"),
    [
        ((0, 1, 2, 5), 2),
        ((65534, 65535, 1, 2), 0),
        ((65534, 3), 3),
        ((70000, 70003), 2),
        ((7, 1, 2), 0),
        ((4, 4, 5), 0),
    ],
    ids=["a gap", "16 bits begin again", "a gap over their end", "more bits", "counted anew", "said twice"],
)
def test_gaps_in_the_cameras_numbers_are_counted(numbers, missing):
    counter = FrameNumbers()
    assert sum(counter.missing_before(number) for number in numbers) == missing
