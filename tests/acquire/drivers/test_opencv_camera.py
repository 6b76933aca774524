"""OpenCV's cameras and video files: frames, losses, unplugging, coming back."""

import threading

import cv2
import numpy as np
import pytest

from core.acquire.drivers.opencv_camera import WAITING, OpenCVSource, list_cameras
from core.acquire.source import Ended, Lasers, SourceSettings, Unplugged
from core.errors import InputError

AS_FAST = SourceSettings(rate_hz=0)


class FakeCapture:
    """A camera that gives a frame whenever the test says so, until it is pulled out."""

    def __init__(self, opened=True, backend="V4L2", refuses=()):
        self.opened, self.backend, self.refuses = opened, backend, refuses
        self.frames, self.given = threading.Semaphore(0), 0
        self.pulled = self.released = False
        self.settings = {}
        self.done = threading.Condition()

    def isOpened(self):
        return self.opened

    def getBackendName(self):
        return self.backend

    def get(self, key):
        return 0.0

    def set(self, key, value):
        if key in self.refuses:
            return False
        self.settings[key] = value
        return True

    def read(self):
        with self.done:
            self.done.notify_all()
        while not self.frames.acquire(timeout=0.002):
            if self.pulled or self.released:
                return False, None
        self.given += 1
        return True, np.full((4, 6, 3), self.given, np.uint8)

    def give(self, count):
        """Give frames and wait until all of them are taken."""
        for _ in range(count):
            self.frames.release()
        with self.done:
            assert self.done.wait_for(lambda: self.frames._value == 0, 5)
            self.done.wait(0.05)

    def release(self):
        self.released = True


@pytest.fixture
def camera():
    """A source on fake cameras: calling it opens one, closing pulls it."""
    captures = []

    def capture(address):
        captures.append(FakeCapture())
        return captures[-1]

    source = OpenCVSource("0", capture=capture)
    source.captures = captures
    yield source
    for one in captures:
        one.pulled = True
    source.close()


@pytest.fixture
def video(tmp_path):
    path = tmp_path / "scan.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 50.0, (64, 48))
    for level in range(0, 200, 20):
        writer.write(np.full((48, 64, 3), level, np.uint8))
    writer.release()
    return path


def test_a_video_file_gives_all_its_frames_grey_and_ends(video):
    source = OpenCVSource(str(video))
    source.configure(AS_FAST)
    source.open()
    frames = [source.read(1) for _ in range(10)]
    assert [round(frame.picture.mean() / 20) for frame in frames] == list(range(10))
    assert frames[0].picture.shape == (48, 64)
    assert frames[0].picture.dtype == np.uint8
    assert [frame.index for frame in frames] == list(range(10))
    assert frames[-1].dropped == 0
    with pytest.raises(Ended):
        source.read(1)
    source.close()
    assert source.name == "scan.avi"


def test_a_video_file_plays_at_its_own_rate(video):
    source = OpenCVSource(str(video))
    source.open()
    assert source.read(1).time_s == 0
    assert source.read(0.0) is None
    assert source.read(1).time_s == pytest.approx(0.02)
    source.close()


def test_a_video_file_can_be_opened_again(video):
    source = OpenCVSource(str(video))
    source.configure(AS_FAST)
    for _ in range(2):
        source.open()
        assert source.read(1).index == 0
    source.close()
    source.close()


def test_one_colour_can_be_taken(tmp_path):
    path = tmp_path / "red.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 25.0, (64, 48))
    writer.write(np.full((48, 64, 3), (0, 0, 200), np.uint8))
    writer.release()
    source = OpenCVSource(str(path), "red")
    source.open()
    assert source.read(1).picture.mean() == pytest.approx(200, abs=6)
    source.close()


def test_what_is_no_video_says_so(tmp_path):
    (tmp_path / "notes.avi").write_text("no video")
    with pytest.raises(InputError, match="no video that can be read"):
        OpenCVSource(str(tmp_path / "notes.avi")).open()
    with pytest.raises(InputError, match="no such video file"):
        OpenCVSource(str(tmp_path / "missing.avi")).open()


def test_a_camera_that_is_not_there_says_what_to_do():
    source = OpenCVSource("7", capture=lambda _: FakeCapture(opened=False))
    with pytest.raises(InputError, match=r"camera 7.*plugged in"):
        source.open()
    with pytest.raises(InputError, match="network"):
        OpenCVSource("rtsp://there/stream", capture=lambda _: FakeCapture(opened=False)).open()


def test_frames_read_in_time_are_all_there(camera):
    camera.open()
    frames = []
    for _ in range(5):
        camera.captures[0].frames.release()
        frames.append(camera.read(5))
    assert [frame.index for frame in frames] == list(range(5))
    assert [frame.picture[0, 0] for frame in frames] == [1, 2, 3, 4, 5]
    assert frames[-1].dropped == 0
    assert np.all(np.diff([frame.time_s for frame in frames]) >= 0)


def test_the_newest_frames_wait_for_a_late_reader_and_the_others_are_counted(camera):
    camera.open()
    camera.captures[0].give(10)
    frame = camera.read(5)
    assert frame.index == 10 - WAITING
    assert frame.dropped == 10 - WAITING


def test_no_frame_within_the_time_gives_none(camera):
    camera.open()
    assert camera.read(0.01) is None


def test_a_camera_pulled_out_is_unplugged_and_can_be_opened_again(camera):
    camera.open()
    camera.captures[0].give(1)
    camera.captures[0].pulled = True
    assert camera.read(5).index == 0
    with pytest.raises(Unplugged, match="plug it in"):
        camera.read(5)
    assert camera.captures[0].released
    with pytest.raises(Unplugged):
        camera.read(5)
    camera.open()
    camera.captures[1].frames.release()
    assert camera.read(5).index == 0


def test_closing_ends_the_thread_and_lets_go_of_the_camera(camera):
    before = threading.active_count()
    camera.open()
    camera.captures[0].frames.release()
    camera.read(5)
    camera.captures[0].frames.release()
    camera.close()
    assert camera.captures[0].released
    assert threading.active_count() == before


def test_settings_go_to_the_camera_in_its_own_units(camera):
    camera.configure(SourceSettings(exposure_ms=8.0))
    camera.open()
    camera.configure(SourceSettings(gain_db=3.0, rate_hz=30.0))
    settings = camera.captures[0].settings
    assert settings[cv2.CAP_PROP_EXPOSURE] == pytest.approx(80)
    assert settings[cv2.CAP_PROP_GAIN] == 3.0
    assert settings[cv2.CAP_PROP_FPS] == 30.0
    windows = OpenCVSource("0", capture=lambda _: windows_capture)
    windows_capture = FakeCapture(backend="MSMF")
    windows.configure(SourceSettings(exposure_ms=125.0))
    windows.open()
    assert windows_capture.settings[cv2.CAP_PROP_EXPOSURE] == pytest.approx(-3)
    windows_capture.pulled = True
    windows.close()


def test_a_setting_the_camera_refuses_says_so(camera):
    camera.open()
    camera.captures[0].refuses = (cv2.CAP_PROP_EXPOSURE,)
    with pytest.raises(InputError, match="exposure time"):
        camera.configure(SourceSettings(exposure_ms=1.0))


def test_lasers_are_a_persons_business(camera):
    assert camera.lasers(Lasers(fan=True, hand=False)) is False


def test_cameras_are_listed_by_number_without_their_other_devices(tmp_path, monkeypatch):
    monkeypatch.setattr("platform.system", lambda: "Linux")
    for node, index, name in (("video10", "0", "Microscope"), ("video2", "0", "Webcam"), ("video3", "1", "Webcam")):
        (tmp_path / node).mkdir()
        (tmp_path / node / "index").write_text(index + "\n")
        (tmp_path / node / "name").write_text(name + "\n")
    assert list_cameras(tmp_path) == [("2", "Webcam"), ("10", "Microscope")]
    assert list_cameras(tmp_path / "none") == []
