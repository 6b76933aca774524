"""What is said to the hand while a scan is recorded."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import pytest
from PySide6.QtCore import QSize
from PySide6.QtGui import QFontMetrics

from core.image.exclusion import Exclusion
from core.messages import plain
from core.scan.preview.hints import ENOUGH, HandState, HintLimits, hints_for
from core.scan.preview.preflight import Check
from core.translations import language
from tests.workbench.pages import scan_cases as cases
from workbench.language import choose
from workbench.pages.scan.guidance import Situation, guidance
from workbench.pages.scan.guide import LARGEST, SMALLEST, GuideBand, Large

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


FROM_TWO_METRES_PX = 22
"""At a window of 1280 pixels these are a third of them high where its picture is made three times smaller: 7 pixels."""
HAND = HandState(3, 3, 0.1, 2.0, 1280, 200.0, 255.0, 0.0)
HINTS = [
    hints_for(state, HintLimits())[0]
    for state in (
        replace(HAND, strength=5.0),
        replace(HAND, saturated=0.9),
        replace(HAND, speed_px=123.0),
        replace(HAND, sigma_mm=9.0, lines_met=1),
        replace(HAND, sigma_mm=9.0),
    )
]
SITUATIONS = (
    NOW,
    NOW._replace(gone=True),
    NOW._replace(stopping=True),
    NOW._replace(paused=True),
    NOW._replace(detail=cases.detail(0, stage="reference")),
    NOW._replace(detail=cases.detail(0, stage="ready")),
    NOW._replace(detail=replace(DETAIL, share=ENOUGH)),
    *(with_preview(hints=(hint,)) for hint in HINTS),
    *(with_preview(exclusion=one) for one in (Exclusion.MOVED, Exclusion.WITHOUT_FAN, Exclusion.WITHOUT_STRIPE)),
)


@pytest.mark.parametrize("name", ["en", "de", "zh_CN"])
def test_at_1280_pixels_every_sentence_and_number_can_be_read_from_two_metres(qtbot, qapp, name):
    def shown(now: Situation) -> GuideBand:
        live = SimpleNamespace(recorded=123, go_on=lambda: None, buttons=SimpleNamespace(start=""))
        band = GuideBand(cast(Any, SimpleNamespace(live=live, guidance=guidance(now))))
        qtbot.addWidget(band)
        band.resize(1280, band.height())
        band.show()
        band.refresh()
        qtbot.waitUntil(lambda: bool(band.sentence.text()))
        return band

    try:
        choose(language(name), qapp)
        for now in SITUATIONS:
            band = shown(now)
            label = band.sentence
            taken = QFontMetrics(label.font()).boundingRect(label.rect(), 0x1000, label.text())
            assert taken.height() <= label.height() and label.font().pixelSize() >= 28, label.text()
            assert "123 px" not in label.text(), "a line break parts no number from its unit"
            assert min(one.font().pixelSize() for one in (band.needed, band.counts)) >= FROM_TWO_METRES_PX
            assert band.counts.geometry().bottom() < band.height() and band.covered.geometry().top() >= 0
    finally:
        choose(language("en"), qapp)
