"""Folders played back as if a camera took them now."""

import numpy as np
import pytest

from core.acquire.pace import Pace
from core.acquire.replay import FRAMES_HELD, ReplaySource
from core.acquire.source import Ended, Lasers, SourceSettings, Unplugged
from core.errors import InputError
from core.files.pictures import read_picture, write_picture
from core.files.recording.replay_pictures import ReplayPictures

FAN, DARK, BOTH = Lasers(fan=True, hand=False), Lasers(fan=False, hand=False), Lasers(fan=True, hand=True)
AS_FAST = SourceSettings(rate_hz=0)


class Clock:
    """Time that only goes on when somebody waits."""

    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now

    def sleep(self, seconds):
        self.now += seconds


def grey(level):
    return np.full((6, 8), level, np.uint8)


def save(folder, **levels):
    folder.mkdir(parents=True, exist_ok=True)
    for name, level in levels.items():
        write_picture(folder / f"{name}.png", grey(level))


def replay(folder, **choices):
    clock = Clock()
    listing = ReplayPictures(folder)
    holds = FRAMES_HELD if listing.is_set else {}
    source = ReplaySource(
        "replay", folder, listing, read_picture, holds=holds, clock=clock, sleep=clock.sleep, **choices
    )
    source.open()
    return source, clock


def levels(source, count):
    return [int(source.read(1).picture[0, 0]) for _ in range(count)]


@pytest.fixture
def recorded(tmp_path):
    save(tmp_path / "camera", view0=10, view1=11)
    save(tmp_path / "planes", pose0=20, pose0_off=120, pose1=21, pose1_off=121)
    save(tmp_path / "scan", reference=30, frame0=31, frame1=32)
    return tmp_path


def test_a_plain_folder_is_played_once_in_the_order_of_its_names(tmp_path):
    save(tmp_path, b=2, a=1, c=3)
    (tmp_path / "notes.txt").write_text("not a picture")
    source, _ = replay(tmp_path)
    source.prepare("scan")
    source.lasers(BOTH)
    frames = [source.read(1) for _ in range(3)]
    assert [frame.picture[0, 0] for frame in frames] == [1, 2, 3]
    assert [frame.index for frame in frames] == [0, 1, 2]
    assert [frame.time_s for frame in frames] == pytest.approx([0.0, 0.1, 0.2])
    for _ in range(2):
        with pytest.raises(Ended):
            source.read(1)


def test_a_loop_begins_again(tmp_path):
    save(tmp_path, a=1, b=2)
    source, _ = replay(tmp_path, loops=True)
    assert levels(source, 5) == [1, 2, 1, 2, 1]


def test_frames_come_at_the_rate_and_a_late_reader_gets_all_of_them(tmp_path):
    save(tmp_path, a=1, b=2, c=3, d=4)
    source, clock = replay(tmp_path)
    source.configure(SourceSettings(rate_hz=4))
    assert levels(source, 2) == [1, 2]
    assert clock.now == pytest.approx(0.25)
    assert source.read(0.1) is None
    clock.now += 10
    before = clock.now
    assert levels(source, 2) == [3, 4]
    assert clock.now - before == pytest.approx(0.25)


def test_as_fast_as_read_never_waits(tmp_path):
    save(tmp_path, a=1, b=2, c=3)
    source, clock = replay(tmp_path)
    source.configure(AS_FAST)
    assert levels(source, 3) == [1, 2, 3]
    assert clock.now == 0


def test_views_of_a_recording_are_held_for_a_while(recorded):
    source, _ = replay(recorded)
    source.prepare("camera")
    assert levels(source, 24) == [10] * 12 + [11] * 12
    with pytest.raises(Ended):
        source.read(1)


def test_switching_the_fan_shows_the_same_pose_with_and_without_it(recorded):
    source, _ = replay(recorded)
    source.prepare("planes")
    assert source.lasers(FAN) is True
    assert levels(source, 5) == [20] * 5
    assert source.lasers(DARK) is True
    assert levels(source, 3) == [120] * 3
    source.lasers(FAN)
    assert levels(source, 27) == [20] * 25 + [21] * 2


def test_poses_shown_once_each_come_with_and_without_the_fan_in_turn(recorded):
    source, _ = replay(recorded / "planes")
    source.prepare("planes")
    shown = []
    for _ in range(2):
        source.lasers(FAN)
        shown += levels(source, 1)
        source.lasers(DARK)
        shown += levels(source, 1)
    assert shown == [20, 120, 21, 121]


def test_the_reference_is_shown_until_the_hand_begins(recorded):
    source, _ = replay(recorded)
    source.prepare("scan")
    assert source.lasers(FAN) is True
    assert levels(source, 5) == [30] * 5
    assert source.lasers(BOTH) is True
    assert levels(source, 2) == [31, 32]
    with pytest.raises(Ended):
        source.read(1)


def test_what_was_not_recorded_cannot_be_switched(recorded):
    (recorded / "planes" / "pose1_off.png").unlink()
    (recorded / "scan" / "reference.png").unlink()
    source, _ = replay(recorded)
    source.prepare("planes")
    assert source.lasers(DARK) is False
    source.prepare("scan")
    assert source.lasers(FAN) is False
    assert levels(source, 2) == [31, 32]


def test_a_damaged_picture_is_told_once_and_the_next_one_follows(tmp_path):
    save(tmp_path, a=1, c=3)
    (tmp_path / "b.png").write_bytes(b"no picture")
    source, _ = replay(tmp_path)
    assert levels(source, 1) == [1]
    with pytest.raises(InputError, match=r"b\.png"):
        source.read(1)
    assert levels(source, 1) == [3]


def test_a_folder_that_vanishes_is_unplugged_and_can_come_back(tmp_path):
    folder = tmp_path / "stick"
    save(folder, a=1, b=2)
    source, _ = replay(folder)
    levels(source, 1)
    folder.rename(tmp_path / "pulled")
    with pytest.raises(Unplugged):
        source.read(1)
    with pytest.raises(InputError, match="no such folder"):
        source.open()
    (tmp_path / "pulled").rename(folder)
    source.open()
    assert levels(source, 1) == [2]


def test_a_part_that_has_no_pictures_is_at_its_end(recorded):
    for picture in (recorded / "camera").iterdir():
        picture.unlink()
    source, _ = replay(recorded)
    source.prepare("camera")
    with pytest.raises(Ended):
        source.read(1)


def test_a_file_is_no_folder(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="not a folder"):
        replay(tmp_path / "file")


def test_pictures_handed_out_are_not_shared(recorded):
    source, _ = replay(recorded)
    source.prepare("camera")
    source.read(1).picture[:] = 0
    assert levels(source, 1) == [10]


def test_a_pace_waits_no_longer_than_allowed():
    clock = Clock()
    pace = Pace(1.0, clock, clock.sleep)
    assert pace.wait(0.0)
    assert not pace.wait(0.4)
    assert clock.now == pytest.approx(0.4)
    assert pace.wait(0.7)
    assert clock.now == pytest.approx(1.0)
