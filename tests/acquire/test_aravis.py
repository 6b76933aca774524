"""Cameras through Aravis: a GigE Vision camera that only exists on the loopback, spoken to by the real protocol."""

import shutil
import subprocess
import time
from functools import partial
from itertools import pairwise

import numpy as np
import pytest

from core.acquire.drivers import aravis as aravis_driver
from core.acquire.drivers.aravis import connect, list_cameras
from core.acquire.drivers.genicam import GenICamSource
from core.acquire.source import Region, SourceSettings
from core.errors import InputError
from core.files.recording.rig import Rig
from core.image.targets import BlackSquare, Checkerboard
from core.pipeline.live.commands import Stop
from core.pipeline.live.events import LiveBack, LiveUnplugged, LiveView
from tests.pipeline.live_bench import Window, record

FAKE = "arv-fake-gv-camera-0.8"


def start_camera(*options):
    return subprocess.Popen([FAKE, "-i", "127.0.0.1", *options], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def wait_for_camera():
    for _ in range(10):
        try:
            connect("127.0.0.1").close()
        except InputError:
            continue
        return
    pytest.skip("the fake camera does not answer on the loopback")


@pytest.fixture
def camera():
    """A camera process on the loopback."""
    if shutil.which(FAKE) is None:
        pytest.skip(f"{FAKE} is not installed (apt install aravis-tools)")
    if aravis_driver.is_missing():
        pytest.skip(str(aravis_driver.INSTALL))
    process = start_camera()
    wait_for_camera()
    yield process
    process.kill()
    process.wait()


@pytest.fixture
def source(camera):
    source = GenICamSource("Aravis", partial(connect, "127.0.0.1"))
    source.configure(SourceSettings(rate_hz=50, region=Region(0, 0, 128, 96)))
    source.open()
    yield source
    source.close()


def test_pictures_come_through_the_network_with_the_cameras_own_times(source):
    frames = [source.read(2) for _ in range(10)]
    assert {frame.picture.shape for frame in frames} == {(96, 128)}
    assert frames[0].picture.dtype == np.uint8
    assert [frame.index for frame in frames] == list(range(10))
    assert all(0 < b.time_s - a.time_s < 0.5 for a, b in pairwise(frames))
    assert np.ptp(frames[0].picture) > 50
    assert source.name == "Aravis Fake"


def test_what_the_camera_has_can_be_set_while_it_runs(source):
    can = source.capabilities
    assert can.sensor == (2048, 2048)
    assert can.gain_db is None
    assert {"Off", "Software"} <= set(can.triggers)
    before = source.read(2)
    source.configure(SourceSettings(region=Region(16, 8, 64, 32), pixel_format="Mono16", exposure_ms=2.0))
    frame = source.read(2)
    assert frame.picture.shape == (32, 64)
    assert frame.picture.dtype == np.uint16
    assert frame.index == before.index + 1
    assert source._driver.features.number("ExposureTimeAbs") == pytest.approx(2000)
    with pytest.raises(InputError, match="does not let its gain be set"):
        source.configure(SourceSettings(gain_db=3.0))
    assert source.read(2) is not None


def test_a_late_reader_knows_exactly_how_many_frames_it_lost(source):
    source.read(2)
    time.sleep(0.6)
    read = [source.read(2) for _ in range(20)]
    frames = [frame for frame in read if frame is not None]  # of a picture in transit a part may be lost, too: dropped
    assert frames[-1].dropped > 3
    assert frames[-1].index + 1 == 1 + len(frames) + frames[-1].dropped
    spent = frames[-1].time_s * 50
    assert frames[-1].index == pytest.approx(spent, rel=0.25)


def test_a_picture_is_asked_for_by_software(source):
    source.configure(SourceSettings(trigger="Software"))
    assert [source.read(2).picture.shape for _ in range(3)] == [(96, 128)] * 3
    source.configure(SourceSettings(trigger="Off"))
    assert source.read(2) is not None


@pytest.mark.accuracy
def test_a_camera_that_falls_silent_is_told_and_looked_for_and_the_recording_goes_on_with_it(
    source, camera, monkeypatch, tmp_path
):
    again, really_open = [], source.open

    def look_for_it():
        try:
            really_open()
        except InputError:
            if not again:  # it was really away: now it is plugged in
                again.append(start_camera())
            raise

    def pull_it_out(event):
        if isinstance(event, LiveView) and event.index > 2 and camera.poll() is None:
            camera.kill()
            camera.wait()

    monkeypatch.setattr(source, "open", look_for_it)
    window = Window(pull_it_out, lambda event: Stop() if window.all(LiveBack) and isinstance(event, LiveView) else None)
    rig = Rig(Checkerboard(17, 12, 10.0), BlackSquare(60.0), 3, np.radians(5.0))
    try:
        ended = record(monkeypatch, source, window, "camera", rig, tmp_path / "views")
    finally:
        for process in again:
            process.kill()
            process.wait()
    assert ended.error is None
    (gone,) = window.all(LiveUnplugged)
    assert str(gone.sentence).endswith("plug it in again.")
    assert len(again) == len(window.all(LiveBack)) == 1
    first, last = window.all(LiveView)[0], window.all(LiveView)[-1]
    assert last.index <= first.index + 20  # counted anew
    assert last.picture.shape == (96, 128)
    assert ended.dropped >= first.dropped


def test_broken_frames_are_counted_and_not_shown(camera):
    camera.kill()
    camera.wait()
    lossy = start_camera("-r", "20")
    source = GenICamSource("Aravis", partial(connect, "127.0.0.1"))
    try:
        wait_for_camera()
        source.configure(SourceSettings(rate_hz=50, region=Region(0, 0, 200, 200)))
        source.open()
        frames = [frame for _ in range(60) if (frame := source.read(1)) is not None]
        assert len(frames) > 5
        assert frames[-1].dropped > 0
        assert frames[-1].index + 1 == len(frames) + frames[-1].dropped
    finally:
        source.close()
        lossy.kill()
        lossy.wait()


def test_cameras_that_answer_are_listed(camera):
    assert ("Aravis-Fake-GV01", "Aravis Fake", "GigEVision 127.0.0.1") in list_cameras()


def test_a_camera_that_is_not_there_says_so(camera):
    with pytest.raises(InputError, match=r"Nobody cannot be opened.*plugged in"):
        connect("Nobody")


def test_without_aravis_one_sentence_says_what_to_install(monkeypatch):
    def missing():
        raise ImportError("gi")

    monkeypatch.setattr(aravis_driver, "_introspection", missing)
    assert aravis_driver.is_missing()
    with pytest.raises(InputError, match=r"apt install gir1\.2-aravis-0\.8 python3-gi"):
        list_cameras()


def test_another_pythons_packages_are_left_alone(tmp_path):
    (tmp_path / "gi").mkdir()
    (tmp_path / "gi" / "_gi.cpython-27-x86_64-linux-gnu.so").touch()
    assert not aravis_driver._is_for_us(tmp_path)
