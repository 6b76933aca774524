"""A sentence said large in a picture stands long enough to be read."""

import numpy as np
import pytest

from workbench.views.image import announcement
from workbench.views.image.view import ImageView


@pytest.fixture
def view(qtbot):
    made = ImageView()
    qtbot.addWidget(made)
    made.resize(600, 400)
    made.set_picture(np.zeros((40, 60), np.uint8))
    made.show()
    return made


def test_a_sentence_stands_although_the_next_one_has_come_and_only_the_last_follows(qtbot, view, monkeypatch):
    monkeypatch.setattr(announcement, "STAYS_MS", 200)
    for sentence in ("Hold still.", "Too blurred.", "Taken."):
        view.announce(sentence)
        assert view.announced == "Hold still."
    qtbot.waitUntil(lambda: view.announced != "Hold still.")
    assert view.announced == "Taken."
    qtbot.waitUntil(lambda: view.announced == "")


def test_it_is_larger_than_other_text_and_stays_within_the_picture(view):
    view.announce("Turn or move the target: this tilt and place are already there.")
    label = view.findChild(announcement.Announcement)
    assert label.fontInfo().pixelSize() > 1.5 * view.fontInfo().pixelSize()
    assert label.geometry().left() >= 0
    assert label.geometry().right() <= view.width()
