"""Sheets of a corner: two boards that are told apart, with what is to be measured and stated of them."""

import io
import json

import numpy as np
import pypdfium2
import pytest
from pypdf import PdfReader

from core.files.recording.rig import read_rig
from core.image.targets import TargetNotFound, detect
from core.report.corner_sheet import corner_sheets, corner_targets
from tests.simulated import trisect

DPI = 120


@pytest.mark.parametrize("paper", ["A4", "Letter"])
def test_each_board_is_found_on_its_own_page_and_the_other_one_is_not(paper):
    targets = corner_targets("charuco", paper)
    pages = pypdfium2.PdfDocument(corner_sheets(targets, paper, ""))
    pictures = [np.array(page.render(scale=DPI / 72, grayscale=True).to_numpy()) for page in pages]
    both = np.vstack(pictures[:2])
    for number, target in enumerate(targets.values()):
        view = detect(target, both)
        assert len(view.points) == len(target.points)
        assert (view.uv[:, 1] > len(pictures[0])).all() == bool(number)
        with pytest.raises(TargetNotFound, match=r"none of the board's, \d+ to \d+; check first_id"):
            detect(target, pictures[1 - number])


def test_outlined_boards_are_found_in_their_half_of_a_picture_of_both():
    targets = corner_targets("rectangle", "A4")
    pages = pypdfium2.PdfDocument(corner_sheets(targets, "A4", ""))
    both = np.vstack([np.array(page.render(scale=DPI / 72, grayscale=True).to_numpy()) for page in list(pages)[:2]])
    height, width = both.shape
    for number, target in enumerate(targets.values()):
        top, bottom = number * height / 2, (number + 1) * height / 2 - 1
        view = detect(target, both, region_px=[[0, top], [width - 1, top], [width - 1, bottom], [0, bottom]])
        sides = np.linalg.norm(np.roll(view.uv[:4], -1, axis=0) - view.uv[:4], axis=1)
        assert sides[:2] / DPI * 25.4 == pytest.approx([target.width_mm, target.height_mm], abs=0.3)


@pytest.mark.parametrize("board", ["charuco", "rectangle"])
def test_what_the_command_prints_and_the_last_page_shows_is_a_rig_without_fan(tmp_path, board):
    said = trisect("target", "corner", "--board", board, "--out", tmp_path / "corner.pdf", "--json")
    assert said.code == 0, said.err
    tables = json.loads(said.out)["rig"]
    (tmp_path / "rig.toml").write_text(tables)
    rig = read_rig(tmp_path / "rig.toml")
    assert {name: one.target for name, one in rig.known_planes.items()} == corner_targets(board, "A4")
    assert [one.print_of for one in rig.known_planes.values()] == [None, "floor"] and not rig.has_fan
    pages = [page.extract_text() for page in PdfReader(io.BytesIO((tmp_path / "corner.pdf").read_bytes())).pages]
    assert len(pages) == 3
    assert all(line in pages[2] for line in tables.splitlines())
    assert ("region_px" in pages[2]) == (board == "rectangle")
    sides = ["255.0 mm", "150.0 mm"] if board == "charuco" else ["260.0 mm", "160.0 mm"]
    assert pages[0].splitlines()[-2:] == sides


def test_a_kind_of_board_that_there_is_not_is_told(tmp_path):
    said = trisect("target", "corner", "--board", "paper", "--out", tmp_path / "corner.pdf")
    assert said.code == 2 and "charuco" in said.sentence
