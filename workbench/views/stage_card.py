"""How far a step is, what to do next, and the buttons for it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from PySide6.QtWidgets import QFrame, QHBoxLayout, QPushButton, QSizePolicy, QWidget

from workbench.theme import icon
from workbench.views.common import IconLabel
from workbench.views.layouts import FewLines, RoomySentence, enable, in_column, in_row, mark_primary
from workbench.views.lists.value_rows import VERDICT_ICONS, VerdictKind


@dataclass(frozen=True, slots=True)
class CardButton:
    """Button of the card: `why_not` (a sentence, or "") disables it, `tip` describes its action."""

    key: str
    text: str
    symbol: str
    do: Callable[[], object]


class StageCard(QFrame):
    """Card with a title, a sentence, and buttons of which one may be the primary."""

    def __init__(self, buttons: Sequence[CardButton], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("card")
        self.title, self.words, self.sign = RoomySentence(), FewLines(), IconLabel(16)
        self.sign.hide()
        self.sign.setSizePolicy(
            QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Ignored
        )  # it comes without moving anything
        self.title.setObjectName("heading")
        row = QHBoxLayout()
        row.setSpacing(6)
        self.buttons: dict[str, QPushButton] = {}
        self._symbols = {button.key: button.symbol for button in buttons}
        for entry in buttons:
            button = QPushButton(entry.text)
            button.setIconSize(button.iconSize() * 0.9)
            button.clicked.connect(lambda _=False, do=entry.do: do())
            row.addWidget(button, 1)
            self.buttons[entry.key] = button
        in_column(self.title, in_row(self.sign, (self.words, 1), spacing=6), row, on=self, margins=(10, 8, 10, 10))

    def show_stage(
        self,
        title: str,
        words: str,
        tips: Mapping[str, tuple[str, str]],
        primary: str = "",
        *,
        steady: bool = False,
        verdict: VerdictKind = "",
    ) -> None:
        """Show the title, the sentence, the buttons' tooltips or reasons, the primary button, and a verdict.

        Parameters
        ----------
        title, words
            In short, and in a sentence.
        tips
            For each button why it cannot be pressed ("" if it can), and what it does.
        primary
            The button that is the next thing to do, or "".
        steady
            A result comes or goes at this stage: the words take two lines whatever they say, as a value below them may
            be in hand.
        verdict
            Whose sign stands before the words; "" for none.
        """
        self.title.setText(title)
        self.words.set_text(words, steady=steady)
        if verdict:
            symbol, colour = VERDICT_ICONS[verdict]
            self.sign.show_icon(symbol, colour)
        self.sign.setVisible(bool(verdict))
        for key, (why_not, tip) in tips.items():
            button, main = self.buttons[key], key == primary
            enable(button, why_not, tip)
            button.setIcon(icon(self._symbols[key], colour="on_accent" if main and not why_not else ""))
            mark_primary(button, main)
