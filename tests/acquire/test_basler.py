"""Basler cameras, through the real driver and its emulated camera."""

import sys
import time
from functools import partial
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from core.acquire.drivers.basler import connect, list_cameras
from core.acquire.drivers.genicam import GenICamSource
from core.acquire.drivers.pixel_formats import full_range
from core.acquire.source import Lasers, Region, SourceSettings, Unplugged
from core.errors import InputError
from core.files.pictures import write_picture

EMULATED = "0815-0000"


def basler(serial=EMULATED, setup=None):
    return GenICamSource("Basler", partial(connect, serial, setup))


@pytest.fixture
def pylon(monkeypatch):
    """The driver with one emulated camera plugged in."""
    module = pytest.importorskip("pypylon.pylon", reason="pypylon is not installed (pip install -e '.[basler]')")
    monkeypatch.setenv("PYLON_CAMEMU", "1")
    return module


def shows(folder, pixel_format="Mono8", size=(64, 48)):
    """Makes an emulated camera show the pictures of a folder, one after the other."""

    def setup(camera):
        camera.PixelFormat.SetValue(pixel_format)
        camera.Width.SetValue(size[0])
        camera.Height.SetValue(size[1])
        camera.TestImageSelector.SetValue("Off")
        camera.ImageFilename.SetValue(str(folder))
        camera.ImageFileMode.SetValue("On")

    return setup


@pytest.fixture
def pictures(tmp_path):
    rng = np.random.default_rng(3)
    made = [rng.integers(0, 256, (48, 64)).astype(np.uint8) for _ in range(3)]
    for number, picture in enumerate(made):
        write_picture(tmp_path / f"frame{number}.png", picture)
    return tmp_path, made


@pytest.fixture
def source(pylon, pictures):
    source = basler(setup=shows(pictures[0]))
    yield source
    source.close()


def test_cameras_are_listed_with_serial_number_and_name(pylon):
    assert (EMULATED, f"Basler Emulation ({EMULATED})", "BaslerCamEmu") in list_cameras()


def test_frames_are_the_cameras_pictures_in_order(source, pictures):
    source.configure(SourceSettings(rate_hz=20))
    source.open()
    frames = [source.read(2) for _ in range(6)]
    shown = [next(i for i, one in enumerate(pictures[1]) if np.array_equal(one, frame.picture)) for frame in frames]
    assert [(b - a) % 3 for a, b in pairwise(shown)] == [1] * 5
    assert [frame.index for frame in frames] == list(range(6))
    assert frames[-1].dropped == 0
    assert frames[0].picture.dtype == np.uint8
    assert np.diff([frame.time_s for frame in frames]).mean() == pytest.approx(0.05, abs=0.03)
    assert "Emulation" in source.name


def test_a_late_reader_gets_the_newest_frames_and_the_exact_number_of_lost_ones(source):
    source.configure(SourceSettings(rate_hz=500))
    source.open()
    first = source.read(2)
    time.sleep(0.6)
    frames = [source.read(2) for _ in range(12)]
    assert frames[-1].dropped > 3
    assert frames[-1].index == first.index + 12 + frames[-1].dropped


def test_the_first_camera_found_is_taken_without_a_number(pylon):
    source = basler("")
    source.open()
    assert source.read(2).picture.ndim == 2
    source.close()
    source.close()


@pytest.mark.parametrize(("pixel_format", "bits"), [("Mono12", 12), ("Mono16", 16)])
def test_deeper_pictures_fill_16_bits(pylon, pixel_format, bits):
    source = basler(setup=lambda camera: camera.PixelFormat.SetValue(pixel_format))
    source.open()
    picture = source.read(2).picture
    source.close()
    assert picture.dtype == np.uint16
    assert picture.max() > 2**15


def test_twelve_bits_are_spread_over_sixteen_white_to_white():
    spread = full_range(np.array([[0, 1, 2048, 4095]], np.uint16), 12)
    assert spread.tolist() == [[0, 16, 32776, 65535]]
    assert spread.dtype == np.uint16


def test_colour_formats_are_made_grey(pylon):
    source = basler(setup=lambda camera: camera.PixelFormat.SetValue("BGR8Packed"))
    source.open()
    assert source.read(2).picture.ndim == 2
    source.close()


def test_exposure_gain_and_rate_reach_the_camera(source):
    source.configure(SourceSettings(exposure_ms=3.0))
    source.open()
    source.configure(SourceSettings(gain_db=6.0, rate_hz=40.0))
    assert source._driver.camera.ExposureTime.GetValue() == pytest.approx(3000)
    assert source._driver.camera.Gain.GetValue() == pytest.approx(6.0, abs=0.1)
    assert source._driver.camera.AcquisitionFrameRate.GetValue() == pytest.approx(40)


def test_a_value_the_camera_does_not_take_says_what_it_does(source):
    source.open()
    with pytest.raises(InputError, match=r"gain of 60 dB is not between 0 and 48 dB"):
        source.configure(SourceSettings(gain_db=60))


def test_the_camera_says_what_it_can_be_told(source):
    assert source.capabilities.names == ()
    source.open()
    can = source.capabilities
    assert can.gain_db == (0, pytest.approx(48, abs=0.2))
    assert can.exposure_ms[0] < 1 < can.exposure_ms[1]
    assert {"Off", "Software"} <= set(can.triggers)
    assert {"Mono8", "Mono12"} <= set(can.pixel_formats)
    assert can.sensor[0] >= 64


def test_region_and_pixel_format_change_while_pictures_come(source):
    source.configure(SourceSettings(rate_hz=50))
    source.open()
    first = source.read(2)
    source.configure(SourceSettings(region=Region(8, 4, 32, 16), pixel_format="Mono12"))
    frame = source.read(2)
    assert frame.picture.shape == (16, 32)
    assert frame.picture.dtype == np.uint16
    assert frame.index > first.index
    assert frame.dropped == 0


def test_a_picture_that_is_asked_for_comes_and_no_other(source):
    source.configure(SourceSettings(trigger="Software", rate_hz=50))
    source.open()
    frames = [source.read(2) for _ in range(3)]
    time.sleep(0.2)
    frames.append(source.read(2))
    assert [frame.index for frame in frames] == [0, 1, 2, 3]
    assert frames[-1].dropped == 0
    source.configure(SourceSettings(trigger="Off"))
    assert source.read(2).index == 4


def test_no_frame_within_the_time_gives_none(source):
    source.configure(SourceSettings(rate_hz=4))
    source.open()
    source.read(1)
    assert source.read(0.01) is None


def test_a_camera_that_is_not_plugged_in_says_so(pylon):
    with pytest.raises(InputError, match=r"serial number 12345.*plug it in"):
        basler("12345").open()


def test_a_camera_in_use_says_so(pylon):
    def in_use(camera):
        raise pylon.RuntimeException("The device is controlled by another application. : thrown here")

    with pytest.raises(InputError, match=r"controlled by another application\).*no other program uses it"):
        basler(setup=in_use).open()


def test_a_camera_pulled_out_is_unplugged_and_can_be_opened_again(source, monkeypatch):
    source.open()
    source.read(2)
    gone = SimpleNamespace(
        RetrieveResult=lambda *_: SimpleNamespace(IsValid=lambda: False),
        IsCameraDeviceRemoved=lambda: True,
        IsGrabbing=lambda: True,
        StopGrabbing=source._driver.camera.StopGrabbing,
        Close=source._driver.camera.Close,
    )
    monkeypatch.setattr(source._driver, "camera", gone)
    with pytest.raises(Unplugged, match="pulled out"):
        source.read(0.1)
    with pytest.raises(Unplugged):
        source.read(0.1)
    source.open()
    assert source.read(2).index == 0


def test_a_driver_that_fails_while_reading_counts_as_unplugged(source):
    source.open()
    source._driver.camera.DetachDevice()
    with pytest.raises(Unplugged):
        for _ in range(10):
            source.read(0.1)


def test_a_frame_the_connection_broke_is_counted(source):
    source.open()
    broken = SimpleNamespace(
        GetNumberOfSkippedImages=lambda: 2, GetBlockID=lambda: 0, GrabSucceeded=lambda: False, Release=lambda: None
    )
    index = source.read(2).index
    assert source._frame(source._driver._grabbed(broken)) is None
    frame = source.read(2)
    assert frame.index >= index + 4
    assert frame.dropped >= 3


def test_a_cameras_own_clock_is_used_where_it_has_one(source):
    source.open()
    source.read(2)
    source._origin, source._driver._ticks_hz = None, 125e6

    def at(ticks):
        result = SimpleNamespace(
            GetNumberOfSkippedImages=lambda: 0,
            GetBlockID=lambda: 0,
            GrabSucceeded=lambda: True,
            GetArray=lambda: np.zeros((48, 64), np.uint8),
            GetTimeStamp=lambda: ticks,
            Release=lambda: None,
        )
        return source._frame(source._driver._grabbed(result)).time_s

    assert [at(10**9), at(10**9 + 12_500_000)] == pytest.approx([0.0, 0.1])


def test_lasers_are_a_persons_business():
    assert basler("").lasers(Lasers(fan=True, hand=False)) is False


def test_without_pypylon_one_sentence_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "pypylon", None)
    monkeypatch.setitem(sys.modules, "pypylon.pylon", None)
    for wanted in (list_cameras, basler("").open):
        with pytest.raises(InputError, match=r"pip install -e '\.\[basler\]'"):
            wanted()
