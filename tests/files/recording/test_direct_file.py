"""Large files straight to the disk: the bytes that were given, whole or not at all, on every file system."""

import errno
import os

import numpy as np
import pytest

from core.errors import InputError
from core.files.pictures import picture_parts, read_picture
from core.files.recording import direct_file
from core.files.recording.direct_file import BLOCK, WORTH_BYTES, DirectWriter

LARGE = WORTH_BYTES + BLOCK + 17
only_linux = pytest.mark.skipif(not hasattr(os, "O_DIRECT"), reason="this system has no direct writes")


def noise(size):
    return np.random.default_rng(size).integers(0, 256, size).astype(np.uint8).tobytes()


@pytest.fixture
def opened(monkeypatch):
    """How files are opened for direct writes."""
    flags, real = [], os.open

    def noted(path, flag, *rest, **named):
        flags.append(flag)
        return real(path, flag, *rest, **named)

    monkeypatch.setattr(direct_file.os, "open", noted)
    return flags


@pytest.mark.parametrize("size", [0, 5, WORTH_BYTES, LARGE, 3 * WORTH_BYTES])
def test_files_hold_what_was_given_whatever_was_written_before(tmp_path, size):
    writer = DirectWriter()
    writer.write(tmp_path / "before", noise(4 * WORTH_BYTES))
    writer.write(tmp_path / "file", b"head", memoryview(noise(size)))
    assert (tmp_path / "file").read_bytes() == b"head" + noise(size)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["before", "file"]


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_a_large_frame_comes_back_as_it_was(tmp_path, dtype):
    frame = np.random.default_rng(0).integers(0, np.iinfo(dtype).max + 1, (1001, 1203)).astype(dtype)
    path = tmp_path / "frame.pgm"
    DirectWriter().write(path, *picture_parts(path, frame))
    assert np.array_equal(read_picture(path), frame)


@only_linux
def test_large_files_go_directly_and_small_ones_do_not(tmp_path, opened):
    writer = DirectWriter()
    writer.write(tmp_path / "small", noise(100))
    assert opened == []
    writer.write(tmp_path / "large", noise(LARGE))
    assert opened[0] & os.O_DIRECT


@only_linux
@pytest.mark.parametrize("at", ["open", "write"])
def test_where_the_file_system_cannot_files_are_written_plainly_from_then_on(tmp_path, monkeypatch, opened, at):
    real = getattr(os, at)

    def cannot(*arguments):
        if at == "open":
            os.close(real(*arguments))  # as Linux does: the file is there all the same
        raise OSError(errno.EINVAL, os.strerror(errno.EINVAL))

    with monkeypatch.context() as patch:
        patch.setattr(direct_file.os, at, cannot)
        writer = DirectWriter()
        writer.write(tmp_path / "one", noise(LARGE))
    tried = len(opened)
    writer.write(tmp_path / "two", noise(LARGE))
    assert len(opened) == tried
    assert (tmp_path / "one").read_bytes() == (tmp_path / "two").read_bytes() == noise(LARGE)
    assert len(list(tmp_path.iterdir())) == 2


@only_linux
def test_a_disk_that_fills_up_in_the_middle_leaves_nothing_and_takes_the_next_file(tmp_path, monkeypatch):
    real = os.write

    def full(file, data):
        if len(data) > WORTH_BYTES:
            return real(file, data[:BLOCK])
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    writer = DirectWriter()
    with monkeypatch.context() as patch, pytest.raises(InputError, match=r"file.*the disk is full"):
        patch.setattr(direct_file.os, "write", full)
        writer.write(tmp_path / "file", noise(LARGE))
    assert list(tmp_path.iterdir()) == []
    writer.write(tmp_path / "file", noise(LARGE))
    assert (tmp_path / "file").read_bytes() == noise(LARGE)
