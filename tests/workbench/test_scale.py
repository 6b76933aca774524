"""A screen of fine pixels: what holds at the usual scale holds where a pixel of the window is four of the screen's."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import Any

import pytest
from PySide6.QtWidgets import QWidget

from tests.workbench.running import ROOT

SCALE = "QT_SCALE_FACTOR"
"""Qt's environment variable; it counts from the start of a process."""

HELD = (
    "tests/workbench/test_fit.py",
    "tests/workbench/test_window_layout.py",
    "tests/workbench/views/image",
    "tests/workbench/views/pages",
    "tests/workbench/views/scene",
)
"""Tests of what hangs on pixels: room for words, and where the mouse is in pictures and in 3D."""


def test_a_picture_of_a_widget_has_the_pixels_of_its_scale(qtbot: Any) -> None:
    widget = QWidget()
    qtbot.addWidget(widget)
    widget.resize(100, 60)
    scale = float(os.environ.get(SCALE, "1"))
    assert widget.grab().toImage().width() == round(100 * scale)


@pytest.mark.accuracy  # a proof: it may take minutes
@pytest.mark.parametrize(("scale", "held"), [*(("2", one) for one in HELD), ("1.25", HELD[0]), ("1.5", HELD[0])])
def test_words_have_room_and_the_mouse_hits_what_it_is_over_at_other_scales(scale: str, held: str) -> None:
    scaled = f"{__file__}::{test_a_picture_of_a_widget_has_the_pixels_of_its_scale.__name__}"
    every = ("-m", "accuracy or not accuracy")  # in all languages
    command = [sys.executable, "-m", "pytest", "-q", "-x", *every, "-p", "no:cacheprovider", scaled, held]
    environment = os.environ | {SCALE: scale, "QT_QPA_PLATFORM": "offscreen"}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-4000:]
