"""Raw frames on the disk: whole, in order, counted."""

import threading
import time

import numpy as np
import pytest

from core.errors import InputError
from core.files import atomic
from core.files.pictures import read_picture, write_picture
from core.files.recording.recorder import Recorder


def noise(seed, dtype=np.uint8):
    return np.random.default_rng(seed).integers(0, np.iinfo(dtype).max + 1, (20, 30)).astype(dtype)


class Disk:
    """A disk that can be held up, and filled."""

    def __init__(self):
        self.free, self.full = threading.Event(), False
        self.free.set()

    def __call__(self, path, picture):
        assert self.free.wait(10)
        if self.full:
            raise InputError("cannot be written, because the disk is full", where=path)
        write_picture(path, picture)


@pytest.fixture(autouse=True)
def no_threads_left():
    before = threading.active_count()
    yield
    assert threading.active_count() == before


@pytest.mark.parametrize("ending", [".png", ".pgm"])
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_pictures_come_back_as_they_were(tmp_path, dtype, ending):
    recorder = Recorder(tmp_path / "scan", ending=ending)
    for number in range(6):
        assert recorder.write(f"frame{number:04d}{ending}", noise(number, dtype))
    recorder.close()
    assert (recorder.written, recorder.dropped, recorder.waiting) == (6, 0, 0)
    for number in range(6):
        assert np.array_equal(read_picture(tmp_path / "scan" / f"frame{number:04d}{ending}"), noise(number, dtype))
    assert len(list((tmp_path / "scan").iterdir())) == 6


def test_flush_waits_until_all_are_written(tmp_path):
    recorder = Recorder(tmp_path)
    for number in range(5):
        recorder.write(f"frame{number}", noise(number))
    recorder.flush()
    assert recorder.written == len(list(tmp_path.glob("*.png"))) == 5
    recorder.close()


def test_a_disk_that_is_too_slow_drops_frames_tells_and_counts_them(tmp_path):
    disk = Disk()
    disk.free.clear()
    recorder = Recorder(tmp_path, waiting_bytes=3 * noise(0).nbytes, put=disk)
    taken = [recorder.write(f"frame{number}", noise(number)) for number in range(8)]
    assert taken == [True] * 3 + [False] * 5
    assert recorder.dropped == 5
    disk.free.set()
    recorder.flush()
    assert recorder.write("frame8", noise(8))
    recorder.close()
    assert recorder.written == 4
    assert sorted(path.stem for path in tmp_path.iterdir()) == ["frame0", "frame1", "frame2", "frame8"]


def test_one_picture_may_wait_however_large(tmp_path):
    recorder = Recorder(tmp_path, waiting_bytes=1)
    assert recorder.write("large", noise(1))
    recorder.close()
    assert recorder.written == 1


def test_a_full_disk_is_told_by_the_next_call_and_nothing_taken_is_lost_if_room_is_made(tmp_path):
    disk = Disk()
    disk.full = True
    recorder = Recorder(tmp_path, put=disk)
    recorder.write("frame0", noise(0))
    with pytest.raises(InputError, match=r"frame0.*full"):
        recorder.flush()
    disk.full = False
    assert recorder.write("frame1", noise(1))
    recorder.close()
    assert (recorder.written, recorder.dropped) == (2, 0)


def test_a_picture_that_meets_the_problem_is_counted_as_dropped(tmp_path):
    disk = Disk()
    disk.full = True
    recorder = Recorder(tmp_path, put=disk)
    recorder.write("frame0", noise(0))
    with pytest.raises(InputError, match="full"):
        while recorder.write("frame1", noise(1)):
            time.sleep(0.001)
    assert recorder.dropped == 1
    with pytest.raises(InputError, match="full"):
        recorder.close()
    assert recorder.written == 0
    assert recorder.dropped >= 2


def test_closing_on_a_full_disk_says_so_once_and_keeps_what_is_written(tmp_path):
    disk = Disk()
    recorder = Recorder(tmp_path, put=disk)
    recorder.write("frame0", noise(0))
    recorder.flush()
    disk.full = True
    recorder.write("frame1", noise(1))
    with pytest.raises(InputError, match="full"):
        recorder.close()
    recorder.close()
    assert (recorder.written, recorder.dropped) == (1, 1)
    assert np.array_equal(read_picture(tmp_path / "frame0.png"), noise(0))


def test_a_write_that_breaks_off_leaves_no_half_picture(tmp_path, monkeypatch):
    recorder = Recorder(tmp_path)

    def pulled(self, target):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(atomic.Path, "replace", pulled)
    recorder.write("frame0", noise(0))
    with pytest.raises(InputError, match="disk is full"):
        recorder.flush()
    with pytest.raises(InputError):
        recorder.close()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["", "../frame.png", "scan/frame.png"])
def test_names_are_plain(tmp_path, name):
    recorder = Recorder(tmp_path)
    with pytest.raises(ValueError, match="plain"):
        recorder.write(name, noise(0))
    recorder.close()


def test_a_folder_that_cannot_be_written_to_says_so_at_once(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        Recorder(tmp_path / "file" / "scan")
