"""Printed targets, made pictures again and measured: the paper must be as true as the printer lets it."""

import io

import cv2
import numpy as np
import pypdfium2
import pytest
from pypdf import PdfReader

from core.errors import InputError
from core.image.targets import BlackSquare, Charuco, Checkerboard, CircleGrid, detect
from core.report.target_sheet import PAPER_MM, sheet_layout, target_sheet

DPI = 200
PX_PER_MM = DPI / 25.4
TARGETS = {
    "checkerboard": (Checkerboard(17, 12, 10.0), "A4"),
    "checkerboard on Letter": (Checkerboard(8, 6, 20.0), "Letter"),
    "charuco": (Charuco(9, 7, 18.0, 13.0), "A4"),
    "charuco with an even number of rows": (Charuco(6, 8, 22.5, 15.0, "5X5_100"), "A4"),
    "circle grid": (CircleGrid(9, 6, 18.0), "A4"),
    "asymmetric circle grid": (CircleGrid(4, 11, 12.0, asymmetric=True), "Letter"),
    "black square": (BlackSquare(60.0), "A4"),
}


def raster(data, dpi=DPI):
    return np.array(pypdfium2.PdfDocument(data)[0].render(scale=dpi / 72, grayscale=True).to_numpy())


@pytest.mark.accuracy
@pytest.mark.parametrize("name", TARGETS)
def test_a_printed_target_is_found_with_its_spacing_true_to_a_thousandth(name):
    target, paper = TARGETS[name]
    large = raster(target_sheet(target, paper, title="Rig 1"), 3 * DPI)  # pdfium puts lone rectangles on whole pixels
    picture = cv2.GaussianBlur(cv2.resize(large, None, fx=1 / 3, fy=1 / 3, interpolation=cv2.INTER_AREA), (0, 0), 0.7)
    view = detect(target, picture)
    assert len(view.points) == len(target.points)
    design = np.column_stack([view.points[:, :2], np.ones(len(view.points))])
    solution, *_ = np.linalg.lstsq(design, view.uv, rcond=None)
    np.testing.assert_allclose(solution[:2], PX_PER_MM * np.eye(2), atol=1e-3 * PX_PER_MM)
    assert np.abs(design @ solution - view.uv).max() < 0.2  # pixels of 0.13 mm


@pytest.mark.parametrize("name", TARGETS)
def test_a_target_lies_where_the_layout_says(name):
    target, paper = TARGETS[name]
    layout = sheet_layout(target, paper)
    dark = raster(target_sheet(target, paper)) < 128
    left, top = round(layout.left_mm * PX_PER_MM), round(layout.top_mm * PX_PER_MM)
    assert dark.shape == pytest.approx((layout.height_mm * PX_PER_MM, layout.width_mm * PX_PER_MM), abs=1)
    assert not dark[: top - 2].any()  # nothing above it
    assert dark[top : top + 40, left:].any()
    between = dark[top : top + 300, round(13.5 * PX_PER_MM) : left - 2]
    assert not between.any()  # white between ruler and target


@pytest.mark.parametrize(("columns", "rows", "dictionary"), [(5, 7, "DICT_4X4_50"), (6, 8, "DICT_6X6_250")])
def test_a_charuco_board_is_opencvs_own_pattern(columns, rows, dictionary):
    board = Charuco(columns, rows, 20.0, 15.0, dictionary)
    picture = raster(target_sheet(board, "A4"), dpi=254)  # ten pixels a mm
    layout = sheet_layout(board, "A4")
    left, top = round(10 * layout.left_mm), round(10 * layout.top_mm)
    markers = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, dictionary))
    opencvs = cv2.aruco.CharucoBoard((columns, rows), 20.0, 15.0, markers)
    expected = opencvs.generateImage((200 * columns, 200 * rows))
    found = picture[top : top + 200 * rows, left : left + 200 * columns]
    differing = (found < 128) != (expected < 128)
    assert not cv2.erode(differing.astype(np.uint8), np.ones((5, 5))).any()  # edges alone may differ


@pytest.mark.parametrize("turned", [False, True])
def test_both_rulers_are_100_mm_long_from_tick_to_tick(turned):
    dpi = 600
    picture = raster(target_sheet(BlackSquare(60.0), "A4"), dpi)
    mm = dpi / 25.4
    height = len(picture)
    if turned:  # ticks start at the line 6 mm from the left edge and are cut 1 mm beside it
        profile = picture[:, round(7.0 * mm)].astype(float)[height - round(135 * mm) : height - round(29 * mm)]
    else:  # the line is 24 mm above the lower edge
        profile = picture[height - round(25.0 * mm), : round(116 * mm)].astype(float)
    dark = profile < 128
    starts, ends = np.flatnonzero(np.diff(dark.astype(int)) == 1), np.flatnonzero(np.diff(dark.astype(int)) == -1)
    ticks = (starts + ends) / 2
    assert len(ticks) == 11
    assert (ticks[-1] - ticks[0]) / mm == pytest.approx(100, abs=0.06)


def test_a_sheet_says_what_it_is_and_how_to_print_it():
    text = (
        PdfReader(io.BytesIO(target_sheet(Charuco(9, 7, 18.0, 13.0), "A4", title="Rig 1 — тест")))
        .pages[0]
        .extract_text()
    )
    for words in (
        "Rig 1 — тест · ChArUco board, 9 × 7 squares of 18 mm, markers 13 mm, DICT_4X4_50, on A4",
        "Print at 100 %",
    ):
        assert words in " ".join(text.split())
    assert text.count("100 mm") == 2


def test_the_same_target_gives_the_same_bytes():
    assert target_sheet(BlackSquare(60.0), "A3") == target_sheet(BlackSquare(60.0), "A3")


def test_the_sheet_is_turned_where_the_target_asks_for_it():
    assert sheet_layout(Checkerboard(17, 12, 10.0), "A4").width_mm == 297
    assert sheet_layout(Checkerboard(12, 17, 10.0), "A4").width_mm == 210


@pytest.mark.parametrize("paper", PAPER_MM)
def test_the_target_is_in_the_middle_of_the_sheet_where_there_is_room(paper):
    layout = sheet_layout(BlackSquare(100.0), paper)
    assert layout.left_mm + 50 == layout.width_mm / 2
    assert layout.top_mm + 50 == layout.height_mm / 2


@pytest.mark.parametrize(
    ("target", "paper", "sentence"),
    [
        (Checkerboard(17, 12, 20.0), "A4", "print it on A2, or make its squares at most 12.4 mm for A4"),
        (Checkerboard(17, 12, 16.0), "Letter", "print it on Tabloid, or make its squares at most 12.9 mm for Letter"),
        (CircleGrid(40, 40, 20.0), "A2", "has room for .*; make its pitch at most 9.8 mm for A2"),
        (BlackSquare(400.0), "Tabloid", "make its side at most 249.4 mm for Tabloid"),
    ],
)
def test_a_target_that_does_not_fit_is_told_what_would(target, paper, sentence):
    with pytest.raises(InputError, match=sentence):
        target_sheet(target, paper)


def test_the_size_that_is_advised_fits():
    assert sheet_layout(Checkerboard(17, 12, 12.4), "A4")
    with pytest.raises(InputError):
        sheet_layout(Checkerboard(17, 12, 12.5), "A4")


def test_a_dictionary_too_small_for_the_board_is_named():
    with pytest.raises(InputError, match="the board has 60 markers, but DICT_4X4_50 only 50"):
        target_sheet(Charuco(12, 10, 10.0, 7.0), "A3")
