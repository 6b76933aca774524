import errno
import os
import subprocess
import sys
import textwrap
from pathlib import Path

import cv2
import numpy as np
import pytest

from core.errors import InputError
from core.files.atomic import make_folder, write_bytes, write_text
from core.files.pictures import is_picture, read_picture, write_picture


@pytest.fixture
def grey():
    rng = np.random.default_rng(1)
    smooth = cv2.GaussianBlur(rng.uniform(0, 255, (60, 90)), (0, 0), 4)
    return cv2.normalize(smooth, None, 0, 255, cv2.NORM_MINMAX).astype(np.uint8)


def encoded(suffix: str, picture: np.ndarray) -> bytes:
    return cv2.imencode(suffix, picture)[1].tobytes()


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_png_round_trip_is_lossless(tmp_path, grey, dtype):
    picture = grey.astype(dtype) * (1 if dtype is np.uint8 else 200)
    write_picture(tmp_path / "größe Ω.png", picture)
    back = read_picture(tmp_path / "größe Ω.png")
    assert back.dtype == dtype
    assert np.array_equal(back, picture)


@pytest.mark.parametrize("suffix", [".png", ".tif", ".bmp", ".pgm"])
def test_lossless_kinds_read_exactly(tmp_path, grey, suffix):
    path = tmp_path / f"a{suffix}"
    path.write_bytes(encoded(suffix, grey))
    assert np.array_equal(read_picture(path), grey)


def test_jpeg_reads_closely(tmp_path, grey):
    path = tmp_path / "a.jpg"
    path.write_bytes(encoded(".jpg", grey))
    assert np.abs(read_picture(path).astype(int) - grey).max() < 12


@pytest.mark.parametrize("suffix", [".png", ".tif", ".bmp", ".pgm", ".jpg"])
@pytest.mark.parametrize("share", [0.02, 0.3, 0.6, 0.95, 0.98])
def test_truncated_picture_is_refused_by_name(tmp_path, grey, suffix, share):
    data = encoded(suffix, grey)
    path = tmp_path / f"broken{suffix}"
    path.write_bytes(data[: min(int(share * len(data)), len(data) - 2)])
    with pytest.raises(InputError, match=f"broken\\{suffix}"):
        read_picture(path)


def test_damaged_png_is_refused(tmp_path, grey):
    data = bytearray(encoded(".png", grey))
    data[len(data) // 2] ^= 0xFF
    (tmp_path / "a.png").write_bytes(data)
    with pytest.raises(InputError, match="checksum"):
        read_picture(tmp_path / "a.png")


def test_empty_and_foreign_files_are_refused(tmp_path):
    (tmp_path / "a.png").write_bytes(b"")
    (tmp_path / "b.png").write_bytes(b"hello, this is no picture at all")
    with pytest.raises(InputError, match="empty"):
        read_picture(tmp_path / "a.png")
    with pytest.raises(InputError, match="no readable picture"):
        read_picture(tmp_path / "b.png")
    with pytest.raises(InputError, match=r"missing\.png: cannot be read"):
        read_picture(tmp_path / "missing.png")


def test_floating_point_tiff_is_refused(tmp_path, grey):
    (tmp_path / "a.tif").write_bytes(encoded(".tif", grey.astype(np.float32)))
    with pytest.raises(InputError, match="8 or 16 bit"):
        read_picture(tmp_path / "a.tif")


def test_colour_is_reduced_to_grey_or_to_the_channel_named(tmp_path, grey):
    blue, green, red = grey, grey[::-1], grey[:, ::-1]
    (tmp_path / "a.png").write_bytes(encoded(".png", cv2.merge([blue, green, red])))
    for name, plane in (("blue", blue), ("green", green), ("red", red)):
        assert np.array_equal(read_picture(tmp_path / "a.png", name), plane)
    luma = 0.114 * blue + 0.587 * green + 0.299 * red
    assert np.abs(read_picture(tmp_path / "a.png") - luma).max() <= 0.51


def test_alpha_is_dropped(tmp_path, grey):
    (tmp_path / "a.png").write_bytes(encoded(".png", cv2.merge([grey, grey, grey, grey[::-1]])))
    assert np.array_equal(read_picture(tmp_path / "a.png"), grey)


def test_picture_names():
    assert is_picture(Path("a/B.TIFF"))
    assert not is_picture(Path("a/._b.png"))
    assert not is_picture(Path("a/notes.txt"))


def test_failed_write_keeps_the_old_file_and_leaves_nothing_beside_it(tmp_path, monkeypatch):
    write_text(tmp_path / "a.json", "old")

    def full(_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(InputError, match=r"a\.json: cannot be written, because the disk is full"):
        write_text(tmp_path / "a.json", "new")
    assert (tmp_path / "a.json").read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.json"]


def test_interrupted_write_leaves_nothing(tmp_path, monkeypatch):
    def interrupted(_):
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "fsync", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_bytes(tmp_path / "a.bin", b"x" * 1000)
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(sys.platform == "win32", reason="resource limits are POSIX")
def test_file_system_that_really_refuses_bytes(tmp_path):
    script = """
        import resource, sys
        from pathlib import Path
        from core.errors import InputError
        from core.files.atomic import write_bytes
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
        try:
            write_bytes(Path(sys.argv[1]), bytes(100_000))
        except InputError as error:
            print(error)
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script), str(tmp_path / "a.bin")], capture_output=True, text=True
    )
    assert "a.bin: cannot be written" in done.stdout
    assert not list(tmp_path.iterdir())


def test_folder_under_a_file_is_refused(tmp_path):
    (tmp_path / "out").write_text("I am a file")
    with pytest.raises(InputError, match="a file stands where a folder is needed"):
        make_folder(tmp_path / "out" / "deep")
    with pytest.raises(InputError, match="a file stands where a folder is needed"):
        make_folder(tmp_path / "out")


@pytest.mark.skipif(sys.platform == "win32", reason="permissions are POSIX")
def test_written_files_are_readable_as_any_other(tmp_path):
    write_text(tmp_path / "a", "x")
    (tmp_path / "b").write_text("x")
    assert (tmp_path / "a").stat().st_mode == (tmp_path / "b").stat().st_mode
