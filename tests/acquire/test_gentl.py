"""Cameras through GenTL producers: a real producer with simulated devices, and a stand-in for what it cannot do."""

import sys
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from core.acquire.drivers import gentl as gentl_driver
from core.acquire.drivers.genicam import DriverError, GenICamSource, Grabbed
from core.acquire.drivers.gentl import connect, list_cameras
from core.acquire.source import Region, SourceSettings, Unplugged
from core.errors import InputError

RED = "VikyTL_DEV_red"


@pytest.fixture
def producer(monkeypatch):
    """The producer of simulated devices that comes with harvesters' own library."""
    genicam = pytest.importorskip("genicam", reason="harvesters is not installed (pip install -e '.[genicam]')")
    folder = Path(genicam.__file__).parent
    if not (folder / "viky.cti").is_file():
        pytest.skip("this release of genicam brings no producer")
    monkeypatch.setenv(gentl_driver.PATH, str(folder))
    return folder / "viky.cti"


@pytest.fixture
def source(producer):
    source = GenICamSource("GenICam", partial(connect, RED))
    source.configure(SourceSettings(rate_hz=100))
    yield source
    source.close()


def test_the_cameras_of_all_producers_in_the_standard_folder_are_listed(producer):
    assert [identifier for identifier, _, _ in list_cameras()] == [RED, "VikyTL_DEV_green", "VikyTL_DEV_blue"]


def test_pictures_come_through_the_producer(source):
    source.open()
    frames = [source.read(2) for _ in range(4)]
    assert [frame.index for frame in frames] == [0, 1, 2, 3]
    assert frames[0].picture.shape == (400, 400)
    assert frames[0].picture.dtype == np.uint8
    assert frames[-1].dropped == 0
    assert "Viky" in source.name


def test_a_picture_is_kept_though_the_producer_uses_its_buffer_again(source):
    source.configure(SourceSettings(pixel_format="RGBa8"))
    source.open()
    first = source.read(2).picture
    before = first.copy()
    for _ in range(20):
        source.read(2)
    assert np.array_equal(first, before)
    assert np.ptp(before) > 100


def test_what_the_camera_has_can_be_set_while_it_runs_and_nothing_else(source):
    source.open()
    can = source.capabilities
    assert (can.rate_hz, can.pixel_formats, can.sensor) == ((1.0, 200.0), ("Mono8", "RGBa8"), (800, 800))
    assert can.exposure_ms is None
    source.read(2)
    source.configure(SourceSettings(region=Region(0, 0, 320, 200)))
    frame = source.read(2)
    assert frame.picture.shape == (200, 320)
    assert (frame.index, frame.dropped) == (1, 0)
    for settings, sentence in (
        (SourceSettings(exposure_ms=3.0), "does not let its exposure time be set; leave it as it is"),
        (SourceSettings(rate_hz=500.0), "500 Hz is not between 1 and 200 Hz"),
        (SourceSettings(region=Region(8, 0, 320, 200)), "begins at its first pixel"),
    ):
        with pytest.raises(InputError, match=sentence):
            source.configure(settings)
    assert source.read(2) is not None


def test_a_producer_can_be_named_with_or_without_a_camera(producer, monkeypatch):
    monkeypatch.delenv(gentl_driver.PATH)
    for identifier in (str(producer), f"{producer}#VikyTL_DEV_blue", f"{producer}#2"):
        driver = connect(identifier)
        assert "Viky" in driver.name
        driver.close()


def test_the_producer_is_asked_whether_a_silent_camera_is_still_there(producer, monkeypatch):
    driver = connect(RED)
    try:
        assert not driver.gone()
        monkeypatch.setattr(gentl_driver, "GONE_AFTER_S", 0.0)
        assert not driver.gone()
        driver._id = "pulled out"
        assert driver.gone()
    finally:
        driver.close()


@pytest.mark.parametrize(
    ("identifier", "sentence"),
    [("VikyTL_DEV_grey", r"no camera VikyTL_DEV_grey; plug it in; asked were viky\.cti"), ("/a.cti", "no such GenTL")],
)
def test_a_camera_or_producer_that_is_not_there_says_so(producer, identifier, sentence):
    with pytest.raises(InputError, match=sentence):
        connect(identifier)


def test_a_file_that_is_no_producer_says_so(producer, tmp_path):
    (tmp_path / "broken.cti").write_bytes(b"no library")
    with pytest.raises(InputError, match=r"broken\.cti: the producer cannot be used"):
        connect(str(tmp_path / "broken.cti"))


def test_without_any_producer_one_sentence_says_what_to_install(monkeypatch, tmp_path):
    monkeypatch.setenv(gentl_driver.PATH, str(tmp_path))
    assert list_cameras() == []
    with pytest.raises(InputError, match=r"no GenTL producer.*GENICAM_GENTL64_PATH"):
        connect("")


def test_without_harvesters_one_sentence_says_what_to_install(producer, monkeypatch):
    monkeypatch.setitem(sys.modules, "harvesters.core", None)
    for wanted in (list_cameras, partial(connect, "")):
        with pytest.raises(InputError, match=r"pip install -e '\.\[genicam\]'"):
            wanted()


class StandIn:
    """A driver whose camera loses frames and is pulled out, as a script says."""

    name = "Stand-in"

    def __init__(self, script, entries=("Mono8",)):
        self.script, self.calls, self.format = list(script), [], entries[0]
        self.features = SimpleNamespace(
            has=lambda name: name == "PixelFormat", entry=lambda name: self.format, entries=lambda name: entries
        )

    def start(self):
        self.calls.append("start")

    def stop(self):
        self.calls.append("stop")

    def grab(self, timeout_s):
        step = self.script.pop(0)
        if isinstance(step, Exception):
            raise step
        return step

    def gone(self):
        return not self.script

    def close(self):
        self.calls.append("close")


def grabbed(number, *, whole=True):
    return Grabbed(np.full(12, number, np.uint8) if whole else None, "Mono8", 4, 3, number, 10.0 + number / 4)


def test_lost_and_broken_frames_are_counted_exactly():
    source = GenICamSource("x", lambda: StandIn([grabbed(5), grabbed(8), grabbed(9, whole=False), grabbed(11)]))
    source.open()
    frames = [source.read(1) for _ in range(4)]
    assert frames[2] is None
    assert [(f.index, f.dropped, f.time_s) for f in frames if f] == [(0, 0, 0.0), (3, 2, 0.75), (6, 4, 1.5)]


@pytest.mark.parametrize("end", [[None], [DriverError("connection reset")]], ids=["silence", "error"])
def test_a_camera_pulled_out_is_closed_and_can_be_opened_again(end):
    drivers = [StandIn([grabbed(1), *end]), StandIn([grabbed(1)])]
    made = iter(drivers)
    source = GenICamSource("x", lambda: next(made))
    source.open()
    source.read(1)
    with pytest.raises(Unplugged, match="plug it in again"):
        source.read(1)
    assert drivers[0].calls == ["start", "close"]
    source.open()
    assert source.read(1).index == 0


def test_a_camera_without_grey_levels_is_refused_and_let_go_of():
    driver = StandIn([], entries=("BayerRG8", "YUV422_8"))
    with pytest.raises(InputError, match="gives BayerRG8 and no grey levels; set it to Mono8"):
        GenICamSource("x", lambda: driver).open()
    assert driver.calls == ["close"]
