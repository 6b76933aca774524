"""`trisect target`: a sheet from words or from rig.toml, and what it refuses."""

import json

import pytest
from pypdf import PdfReader

from tests.simulated import trisect

RIG = """
[camera_target]
kind = "charuco"
squares = [9, 7]
square_mm = 18.0
marker_mm = 13.0

[plane_target]
kind = "black_square"
side_mm = 60.0

[laser_fan]
lines = 3
angle_deg = 5.0
"""


def page(path):
    return " ".join(PdfReader(path).pages[0].extract_text().split())


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("checkerboard",), "Checkerboard, 17 × 12 inner corners, 10 mm, on A4"),
        (("checkerboard", "--columns", 8, "--rows", 6, "--size-mm", 20), "Checkerboard, 8 × 6 inner corners, 20 mm"),
        (("charuco", "--paper", "letter"), "12 × 9 squares of 15 mm, markers 11.25 mm, DICT_4X4_100, on Letter"),
        (("circle_grid",), "Circle grid, 13 × 10, pitch 14 mm"),
        (("circle_grid", "--asymmetric", "--title", "Rig 2"), "Rig 2 · Asymmetric circle grid, 4 × 11, pitch 12 mm"),
        (("black_square", "--size-mm", 80), "Black square, side 80 mm"),
    ],
)
def test_every_kind_is_written_and_said(tmp_path, words, expected):
    out = tmp_path / "sheet.pdf"
    said = trisect("target", *words, "--out", out)
    assert said.code == 0
    assert expected in page(out)
    assert str(out) in said.out
    assert "print at 100 %" in said.out


def test_both_targets_of_a_rig_can_be_printed(tmp_path):
    (tmp_path / "rig.toml").write_text(RIG)
    for which, expected in (("camera", "ChArUco board, 9 × 7 squares"), ("plane", "Black square, side 60 mm")):
        out = tmp_path / f"{which}.pdf"
        said = trisect("target", "--rig", tmp_path / "rig.toml", "--which", which, "--out", out, "--json")
        assert json.loads(said.out)["file"] == str(out)
        assert expected in page(out)


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ((), "nothing says which target to print"),
        (("chessboard",), "'chessboard' is no kind of target; choose one of checkerboard, charuco"),
        (("checkerboard", "--rig", "rig.toml"), "both a kind of target and a rig are given"),
        (("checkerboard", "--paper", "A5"), "'A5' is no paper known here; choose one of Letter, A4"),
        (("checkerboard", "--size-mm", 20), "print it on A2, or make its squares at most 12.4 mm"),
        (("checkerboard", "--size-mm", 0), "square_mm must be positive"),
        (("checkerboard", "--columns", 0), "0 × 12 inner corners are too few"),
        (("charuco", "--dictionary", "NONE"), "is not one of OpenCV's"),
        (("--rig", "nowhere.toml"), "the file is missing"),
    ],
)
def test_bad_input_is_told_in_one_sentence_and_nothing_is_written(tmp_path, words, expected):
    said = trisect("target", *words, "--out", tmp_path / "sheet.pdf")
    assert said.code == 2
    assert expected in said.sentence
    assert not list(tmp_path.iterdir())
