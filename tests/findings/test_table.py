"""The table of findings holds every note, and no other code."""

import pytest

from core.findings.finding import Effect, Finding, Weight
from core.findings.table import FINDINGS
from tests.translations import all_texts, texts

ROOMS = ("core/calibrate/", "core/image/", "core/scan/", "core/inspect/", "core/study/", "core/pipeline/steps/")
"""Rooms whose sentences are notes of results."""
LIVE = ("core/calibrate/camera/capture.py", "core/calibrate/camera/missing.py", "core/scan/preview/")
"""What these say is of the moment: of one picture, one crossing, the next sweep."""
ANSWERS = {"readjust.proposed", "readjust.undone"}
"""What a command answers."""


def test_every_row_is_a_message_of_the_program():
    assert {text.code for text in all_texts()} >= set(FINDINGS)


def test_what_takes_away_a_proof_is_grave():
    with pytest.raises(ValueError, match="is not grave"):
        Finding("scan.x", Weight.CAUTION, Effect.NO_PROOF)


def test_every_sentence_that_is_told_of_a_result_has_a_row():
    told = {
        text.code
        for text in texts(*ROOMS)
        if text.code and text.english[0].endswith(".") and not text.path.startswith(LIVE)
    }
    assert len(told) > 100
    assert told - set(FINDINGS) - ANSWERS == set()
