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
