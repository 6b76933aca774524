import cv2
import numpy as np
import pytest

from core.files.pictures import compression_of


@pytest.fixture
def picture() -> np.ndarray:
    return np.random.default_rng(0).integers(0, 255, (40, 40), dtype=np.uint8)


@pytest.mark.parametrize(("quality", "grey"), [(50, 3.84), (75, 1.94), (95, 0.38), (100, 0.29)])
def test_the_quantisation_table_says_what_compression_leaves(tmp_path, picture, quality, grey):
    """Quality 50 is the standard's own table, T.81 annex K.1: its first terms are 16, 11, 12, 14, 12, 10, …"""
    path = tmp_path / "a.jpg"
    cv2.imwrite(str(path), picture, [cv2.IMWRITE_JPEG_QUALITY, quality])
    assert compression_of(path).grey == pytest.approx(grey, abs=0.02)


def test_colour_counts_by_its_brightness(tmp_path, picture):
    path = tmp_path / "a.jpg"
    cv2.imwrite(str(path), np.dstack([picture] * 3), [cv2.IMWRITE_JPEG_QUALITY, 50])
    assert compression_of(path).grey == pytest.approx(3.84, abs=0.02)


def test_lossless_missing_and_broken_files_have_lost_nothing(tmp_path, picture):
    path = tmp_path / "a.png"
    cv2.imwrite(str(path), picture)
    assert compression_of(path).grey == 0.0
    assert compression_of(tmp_path / "none.jpg").grey == 0.0
    broken = tmp_path / "broken.jpg"
    for data in (b"\xff\xd8", b"\xff\xd8\xff\xdb\x00\x43\x00\x10", b"\xff\xd8nothing at all", b""):
        broken.write_bytes(data)
        assert compression_of(broken).grey == 0.0


def test_the_lasers_colour_is_as_coarse_as_the_colours_of_the_file(tmp_path, picture):
    """T.81 annex K.2, the standard's table of colours, begins 17, 18, 18, 24, 21, …; they have half the pixels."""
    path = tmp_path / "a.jpg"
    cv2.imwrite(str(path), np.dstack([picture] * 3), [cv2.IMWRITE_JPEG_QUALITY, 50])
    steps = np.array([17, 18, 18, 24, 21, 24, 47, 26, 26, 47])
    of_colours = 2 * np.sqrt(np.mean(steps**2) / 12)
    colour = compression_of(path, "red-green")
    assert colour.grey == pytest.approx(of_colours * np.hypot(0.344136, 1.402 + 0.714136), rel=0.01)
    assert colour.block_px == 16
    red = compression_of(path, "red")
    assert red.grey == pytest.approx(np.hypot(3.84, 1.402 * of_colours), rel=0.01)
    cv2.imwrite(
        str(path),
        np.dstack([picture] * 3),
        [cv2.IMWRITE_JPEG_QUALITY, 50, cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444],
    )
    assert compression_of(path, "red-green").grey == pytest.approx(colour.grey / 2, rel=0.01)
    assert compression_of(path, "red-green").block_px == 8
