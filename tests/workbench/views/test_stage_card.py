import pytest
from PySide6.QtCore import Qt

from workbench.views.stage_card import CardButton, StageCard


def test_space_after_accept_does_not_reject(qtbot):
    done = []
    ready = {key: ("", "tip") for key in ("accept", "reject")}

    def accept():
        done.append("accept")
        card.show_stage("Accepted", "", {**ready, "accept": ("accepted already", "tip")})

    card = StageCard(
        [
            CardButton("accept", "Accept", "mdi6.check-bold", accept),
            CardButton("reject", "Reject", "mdi6.close-thick", lambda: done.append("reject")),
        ]
    )
    qtbot.addWidget(card)
    card.show_stage("Calibrated", "", ready, "accept")
    card.show()
    card.activateWindow()
    card.buttons["accept"].setFocus()
    qtbot.waitUntil(card.buttons["accept"].hasFocus)
    for _ in range(2):
        qtbot.keyClick(card.window().focusWidget(), Qt.Key.Key_Space)
    assert done == ["accept"]
    assert card.hasFocus()


@pytest.mark.parametrize("said", ["", "Done.", "Look at the views and leave out what is bad. " * 6])
def test_a_steady_sentence_takes_two_lines_and_its_tip_tells_what_is_cut(qtbot, said):
    card = StageCard([CardButton("run", "Run", "mdi6.play", lambda: None)])
    qtbot.addWidget(card)
    card.resize(300, 200)
    card.show()
    two = 2 * card.words.fontMetrics().lineSpacing()
    card.show_stage("Stage", said, {"run": ("", "Run it")}, steady=True)
    qtbot.waitUntil(lambda: card.words.heightForWidth(card.words.width()) == two)
    assert card.words.text() == said
    qtbot.waitUntil(lambda: card.words.toolTip() == (said if len(said) > 100 else ""))
    card.show_stage("Stage", said, {"run": ("", "Run it")})
    assert not card.words.toolTip()
    needed = card.words.heightForWidth(card.words.width())
    assert needed > two if len(said) > 100 else needed == two, "else what is long is told whole"
