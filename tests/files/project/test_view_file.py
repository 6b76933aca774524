"""How the surface was left in 3D, kept beside the project."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.files.project.view_file import NAME, drop_view, drop_view_of_another, read_view, write_view
from core.inspect.shown.seen_from import SeenFrom
from core.model import Pose

VIEW = SeenFrom(Pose.from_vector([0.4, -0.2, 1.1, 0, 0, 0]).rotation, np.array([3.0, -4.0, 520.25]), 61.5, 1.75)
CUT = replace(VIEW, hidden=np.array([[0.0, 0, 500], [0.6, 0.8, 0]]))


@pytest.mark.parametrize("view", [VIEW, CUT])
def test_a_view_comes_back_as_it_was(view: SeenFrom, tmp_path: Path) -> None:
    write_view(tmp_path, view, "part")
    back = read_view(tmp_path)
    assert back is not None
    np.testing.assert_allclose(back.axes, view.axes, atol=1e-6)
    assert back.words.split()[9:] == view.words.split()[9:], "its place and size to the last digit that is kept"
    write_view(tmp_path, back, "part")
    first = (tmp_path / NAME).read_bytes()
    write_view(tmp_path, view, "part")
    assert (tmp_path / NAME).read_bytes() == first


def of(**changed: object) -> str:
    """The text of a file that can be read, but for what is changed."""
    axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    return json.dumps(
        {"recording": "part", "axes": axes, "focal": [0, 0, 0], "half_height_mm": 5, "aspect": 1, **changed}
    )


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        of(axes=[[1, 0, 0], [0, 1, 0]]),
        of(axes=[[1, 0, 0], [0, 1, 0], [0, 0, 2]]),
        of(axes=[[1, 0, 0], [0, 1, 0], [0, 0, -1]]),  # in a mirror
        of(half_height_mm=0),
        of(focal=[0, 0, math.nan]),
    ],
)
def test_what_is_no_view_leaves_the_report_without_one(text: str, tmp_path: Path) -> None:
    (tmp_path / NAME).write_text(text, encoding="utf-8")
    assert read_view(tmp_path) is None


def test_a_view_goes_with_the_recording_it_is_of(tmp_path: Path) -> None:
    (tmp_path / NAME).write_text(of(), encoding="utf-8")
    drop_view_of_another(tmp_path, "part")
    assert read_view(tmp_path) is not None, "the same pictures measured again"
    drop_view_of_another(tmp_path, "another part")
    assert not (tmp_path / NAME).exists()
    drop_view_of_another(tmp_path, "another part")
    (tmp_path / NAME).write_text("[]", encoding="utf-8")
    drop_view_of_another(tmp_path, "another part")
    assert not (tmp_path / NAME).exists(), "nobody knows of what it is"
    drop_view(tmp_path)


def test_what_is_beyond_the_view_or_hidden_is_not_in_sight() -> None:
    view = SeenFrom(np.eye(3), np.array([0.0, 0, 500]), 10.0, 2.0, np.array([[0.0, 5, 500], [0, 1, 0]]))
    points = np.array([[0.0, 0, 500], [19, 0, 400], [21, 0, 500], [0, -11, 500], [0, 6, 500]])
    assert view.in_sight(points).tolist() == [True, True, False, False, False]
