"""What was told last beside a running job."""

from __future__ import annotations

from typing import Any

from PySide6.QtWidgets import QPushButton

from workbench.views.task_bar import StatusBar


def test_a_message_without_room_is_cut_with_an_ellipsis_and_told_whole_by_its_tip(qtbot: Any) -> None:
    bar = StatusBar()
    qtbot.addWidget(bar)
    bar.addPermanentWidget(QPushButton("Messages"))
    bar.resize(300, 30)
    bar.show()
    text = "Nobody is named in this project, so everybody may do everything. The manual says how people are named."
    bar.showMessage(text, 60_000)
    said = bar._said
    qtbot.waitUntil(lambda: said.width() > 100)
    assert bar.width() == 300 and said.geometry().right() < 300
    assert said.toolTip() == bar.currentMessage() == text
    assert said._elidedText().endswith("…")
    bar.clearMessage()
    assert bar.currentMessage() == ""
    bar.showMessage("Saved", 1)
    qtbot.waitUntil(lambda: bar.currentMessage() == "")
