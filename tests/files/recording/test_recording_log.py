"""The log of a recording: complete whenever the program dies, and when the disk is full."""

import os
import struct
import subprocess
import sys
import threading
import warnings
import zlib
from datetime import UTC, datetime, timedelta
from pathlib import Path

import cv2
import numpy as np
import pytest

from core.acquire.source import Frame
from core.errors import InputError
from core.files.pictures import read_picture, write_picture
from core.files.recording import recording_log
from core.files.recording.recorder import Recorder
from core.files.recording.recording_log import LOG, FolderLog, LoggedFrame, RecordingLog, lost_frames, read_log
from core.files.recording.set_listing import check_sizes, scan_frames
from tests.files.killed_recorder import picture, size_of

AT = datetime(2026, 3, 1, 10, tzinfo=UTC)


def frame(number, dropped=0):
    return Frame(picture(number), number + dropped, number / 10, dropped)


@pytest.mark.accuracy
@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
def test_killed_at_100_moments_every_acknowledged_frame_is_there_and_readable(tmp_path):
    command = [sys.executable, "-m", "tests.files.killed_recorder", str(tmp_path), "100"]
    told = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120).stdout
    runs = [line.rsplit(" ", 1) for line in told.splitlines()]
    assert len(runs) == 100
    assert sum(int(count) > 0 for _, count in runs) > 50
    kept = set()
    for number, (folder, acknowledged) in enumerate(runs):
        size = size_of(number)
        frames = read_log(Path(folder))
        kept |= {Path(one.name).suffix for one in frames}
        assert len(frames) >= int(acknowledged)
        assert [one.index for one in frames] == list(range(len(frames)))
        for one in frames:
            assert np.array_equal(read_picture(Path(folder) / one.name), picture(one.index, size))
        listed = scan_frames(Path(folder))[1]
        assert len(frames) <= len(listed) <= len(frames) + 1  # a last one whose line was not written
        for path in listed:
            assert read_picture(path).shape == size
    assert kept == {".png", ".pgm"}


@pytest.mark.parametrize("ending", [".png", ".pgm"])
def test_the_log_says_when_each_frame_was_exposed_and_how_many_were_lost(tmp_path, ending):
    recorder = Recorder(tmp_path, ending=ending)
    recorder.write("frame0", picture(0), frame(0))
    recorder.write("frame1", picture(1), frame(1, dropped=3))
    recorder.close()
    assert read_log(tmp_path) == (
        LoggedFrame(f"frame0{ending}", 0, 0.0, 0),
        LoggedFrame(f"frame1{ending}", 4, 0.1, 3),
    )
    assert (tmp_path / LOG).read_text().splitlines()[0] == "name,index,time_s,dropped,taken_at,camera"


def test_frames_lost_by_source_and_disk_are_counted_together(tmp_path):
    held = threading.Event()

    def slowly(path, levels):
        assert held.wait(10)
        write_picture(path, levels)

    recorder = Recorder(tmp_path, waiting_bytes=1, put=slowly)
    taken = [recorder.write(f"frame{number}", picture(number), frame(number)) for number in range(3)]
    held.set()
    recorder.flush()
    recorder.write("frame3", picture(3), frame(3, dropped=5))
    recorder.close()
    assert taken == [True, False, False]
    log = read_log(tmp_path)
    assert [one.dropped for one in log] == [0, 7]
    assert lost_frames(log) == 7
    reopened = LoggedFrame("frame4.png", 0, 0.0, 0)
    assert lost_frames((*log, reopened)) == 7


def test_pictures_without_a_frame_leave_no_log(tmp_path):
    recorder = Recorder(tmp_path)
    recorder.write("view00", picture(0))
    recorder.close()
    assert not (tmp_path / LOG).exists()
    assert read_log(tmp_path) == ()


def test_a_torn_last_line_is_not_counted_and_a_torn_line_before_is_told(tmp_path):
    head = "name,index,time_s,dropped\n"
    (tmp_path / LOG).write_text(head + "frame0.png,0,0.0,0\nframe1.png,1,0.")
    assert [one.name for one in read_log(tmp_path)] == ["frame0.png"]
    (tmp_path / LOG).write_text(head + "frame0.png,0,0.\nframe1.png,1,0.1,0\n")
    with pytest.raises(InputError, match="a line is damaged"):
        read_log(tmp_path)


def test_a_line_that_does_not_fit_on_the_disk_is_taken_back_and_written_later(tmp_path, monkeypatch):
    log = RecordingLog(tmp_path)
    log.add(LoggedFrame("frame0.png", 0, 0.0, 0))
    real = os.write
    monkeypatch.setattr(recording_log.os, "write", lambda file, data: real(file, data[:5]))
    with pytest.raises(InputError, match="disk is full"):
        log.add(LoggedFrame("frame1.png", 1, 0.1, 0))
    monkeypatch.undo()
    assert len(read_log(tmp_path)) == 1
    log.add(LoggedFrame("frame1.png", 1, 0.1, 0))
    log.close()
    assert [one.index for one in read_log(tmp_path)] == [0, 1]


@pytest.fixture
def tiny_disk(tmp_path):
    """A disk of 256 KiB."""
    disk = tmp_path / "disk"
    disk.mkdir()
    made = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=256k", "tmpfs", str(disk)], capture_output=True)
    if made.returncode:
        pytest.skip("no disk can be mounted here without more rights")
    yield disk
    subprocess.run(["umount", "-l", str(disk)], check=True, capture_output=True)


@pytest.mark.parametrize("ending", [".png", ".pgm"])
def test_a_disk_that_really_fills_up_keeps_all_that_was_taken_and_goes_on_when_there_is_room(tiny_disk, ending):
    (tiny_disk / "ballast").write_bytes(bytes(100 * 1024))
    noise = [np.random.default_rng(n).integers(0, 256, (100, 100)).astype(np.uint8) for n in range(40)]
    recorder = Recorder(tiny_disk / "scan", ending=ending)
    told, taken = "", []
    for number, levels in enumerate(noise):
        try:
            if recorder.write(f"frame{number:02d}", levels, Frame(levels, number, 0.0, 0)):
                taken.append(number)
            recorder.flush()
        except InputError as full:
            told = str(full)
            break
    assert "the disk is full" in told
    there = read_log(tiny_disk / "scan")
    assert len(there) == recorder.written > 3
    (tiny_disk / "ballast").unlink()
    recorder.close()
    assert [one.index for one in read_log(tiny_disk / "scan")] == taken
    for number in taken:
        assert np.array_equal(read_picture(tiny_disk / "scan" / f"frame{number:02d}{ending}"), noise[number])
    assert recorder.dropped == 0


def test_a_recording_as_pgm_opens_as_a_recording_set_with_the_very_same_frames(tmp_path):
    levels = [np.random.default_rng(n).integers(0, 256, (40, 60)).astype(np.uint8) for n in range(4)]
    for ending in (".png", ".pgm"):
        recorder = Recorder(tmp_path / ending[1:] / "scan", ending=ending)
        for number, one in enumerate(levels):
            recorder.write(f"frame{number}", one, Frame(one, number, number / 14, 0))
        recorder.close()
        write_picture(tmp_path / ending[1:] / "scan" / "reference.png", levels[0])
        reference, frames = scan_frames(tmp_path / ending[1:] / "scan")
        assert reference is not None
        check_sizes([reference, *frames])
        assert [path.name for path in frames] == [f"frame{number}{ending}" for number in range(4)]
        for path, one in zip(frames, levels, strict=True):
            assert np.array_equal(read_picture(path), one)


def test_the_head_of_a_large_cameras_picture_is_read_without_a_warning(tmp_path):
    """Found by `make fuzz`: Pillow warns from 89 million pixels on, and cameras have 151."""
    cv2.imwrite(str(tmp_path / "a.png"), np.zeros((4, 4), np.uint8))
    data = bytearray((tmp_path / "a.png").read_bytes())
    data[16:24] = struct.pack(">II", 14204, 10652)
    data[29:33] = struct.pack(">I", zlib.crc32(data[12:29]))
    (tmp_path / "a.png").write_bytes(data)
    cv2.imwrite(str(tmp_path / "b.png"), np.zeros((4, 4), np.uint8))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(InputError, match="14204 × 10652"):
            check_sizes([tmp_path / "b.png", tmp_path / "a.png"])


def when_taken(pictures):
    return FolderLog.of(pictures[0].parent).acquisition(pictures)


def recorded(folder, names, camera, at):
    """The log of pictures that a camera took a minute apart, from `at` on."""
    log = RecordingLog(folder)
    for number, name in enumerate(names):
        log.add(LoggedFrame(name, number, 0.1 * number, 0, at + timedelta(minutes=number) if camera else None, camera))
    log.close()
    return [folder / name for name in names]


def test_the_log_of_a_camera_says_which_it_was_and_when(tmp_path):
    before = datetime.now(UTC)
    recorder = Recorder(tmp_path)
    recorder.write("frame0", picture(0), frame(0), 'Basler "ace", 12 lab')
    recorder.write("frame1", picture(1), frame(1), 'Basler "ace", 12 lab')
    recorder.close()
    taken = when_taken([tmp_path / "frame0.png", tmp_path / "frame1.png"])
    assert taken.camera == 'Basler "ace", 12 lab'
    assert before - timedelta(seconds=1) < taken.first <= taken.last <= datetime.now(UTC)


def test_of_a_replay_of_other_cameras_and_of_pictures_that_are_not_in_it_the_log_knows_nothing(tmp_path):
    folders = [tmp_path / name for name in ("replay", "two", "old")]
    for folder in folders:
        folder.mkdir()
    replay, two, old = folders
    assert when_taken(recorded(replay, ["a.png", "b.png"], "", AT)) is None
    one, other = recorded(two, ["a.png"], "one", AT), recorded(two, ["b.png"], "other", AT)
    assert when_taken(one).camera == "one"
    assert when_taken([*one, *other]) is None
    assert when_taken([*one, two / "c.png"]) is None
    (old / LOG).write_text("name,index,time_s,dropped\na.png,0,0.0,0\n")
    assert when_taken([old / "a.png"]) is None
    assert when_taken([tmp_path / "a.png"]) is None
    assert FolderLog.of(tmp_path).acquisition([]) is None
    assert FolderLog.of(None) == FolderLog()


def test_a_time_without_its_zone_is_no_time(tmp_path):
    (tmp_path / LOG).write_text("name,index,time_s,dropped,taken_at,camera\na.png,0,0.0,0,2026-03-01T10:00:00,one\n")
    with pytest.raises(InputError, match="time zone"):
        read_log(tmp_path)
    log = FolderLog.of(tmp_path)
    assert (log.frames, log.lost, log.acquisition([tmp_path / "a.png"])) == ((), 0, None)
    assert [note.code for note in log.notes] == ["set.log_not_read"]
