"""What is said to the hand while a scan is recorded."""

from dataclasses import replace
from typing import Any

import pytest
from PySide6.QtCore import QSize
from PySide6.QtGui import QFontMetrics

from core.image.exclusion import Exclusion
from core.messages import plain
from core.scan.preview.hints import ENOUGH
from core.scan.preview.preflight import Check
from tests.workbench.pages import scan_cases as cases
from workbench.pages.scan.guidance import Situation, guidance
from workbench.pages.scan.guide import LARGEST, SMALLEST, Large

DETAIL = cases.detail(0)
NOW = Situation("Live: Camera 1", False, False, ("", ""), False, DETAIL, ())


def with_preview(**changed: Any) -> Situation:
    assert DETAIL.preview is not None
    return NOW._replace(detail=replace(DETAIL, preview=replace(DETAIL.preview, **changed)))


@pytest.mark.parametrize(
    ("now", "level", "said", "button"),
    [
        (NOW, "good", "Good. Go on", "Stop"),
        (with_preview(hints=(plain("Tilt the laser more."), plain("Slower."))), "warn", "Tilt the laser more.", "Stop"),
        (with_preview(exclusion=Exclusion.MOVED), "bad", "Object or camera moved", "Stop"),
        (with_preview(exclusion=Exclusion.WITHOUT_STRIPE), "warn", "No stripe of the hand-held laser.", "Stop"),
        (NOW._replace(detail=replace(DETAIL, share=ENOUGH)), "good", "Enough is covered: stop.", "Stop"),
        (NOW._replace(detail=replace(DETAIL, stage="paused"), paused=True), "warn", "Paused", "Resume"),
        (NOW._replace(question=("Disk full.", "Continue"), paused=True), "", "Disk full.", "Continue"),
        (NOW._replace(detail=cases.detail(0, stage="reference")), "", "Taking the reference", "Stop"),
        (NOW._replace(detail=None), "", "Live: Camera 1", "Stop"),
        (NOW._replace(gone=True), "bad", "The source is unplugged.", "Stop"),
        (NOW._replace(stopping=True), "", "Stopping …", "Stop"),
    ],
)
def test_one_sentence_is_said_the_first_that_matters(now, level, said, button):
    found = guidance(now)
    assert (found.level, found.button) == (level, button)
    assert found.sentence.startswith(said)


def test_what_is_covered_stands_beside_what_is_needed_and_only_while_frames_are_recorded():
    found = guidance(NOW)
    assert (found.covered, found.needed) == ("63 %", "of 70 % needed")
    assert guidance(NOW._replace(detail=cases.detail(0, stage="ready"))).covered == ""


def test_a_check_that_failed_before_is_still_said_in_small_letters():
    checks = (Check("reference", "ok", plain("It holds.")), Check("lines", "failed", plain("Only 2 lines.")))
    assert guidance(NOW._replace(checks=checks)).beside == "Only 2 lines."


@pytest.mark.parametrize("size", [QSize(600, 90), QSize(320, 90), QSize(1200, 60)])
def test_a_sentence_is_as_large_as_there_is_room_for_and_whole(qtbot, size):
    label = Large()
    qtbot.addWidget(label)
    label.resize(size)
    label.setText("Tilt more.")
    short = label.font().pixelSize()
    label.setText("Switch the three-line laser on and the hand-held laser off, then take the reference.")
    long = label.font().pixelSize()
    assert LARGEST == short > long >= SMALLEST
    taken = QFontMetrics(label.font()).boundingRect(label.rect(), 0x1000, label.text())
    assert taken.height() <= size.height()
