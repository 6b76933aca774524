"""One picture with what was found in it, or the live picture."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QWidget

from core.model.arrays import Array
from core.pipeline.live.events import CameraDetail, LiveView, PlanesDetail
from workbench.language import text_of, tr
from workbench.views.colours import CORNER, WANTED
from workbench.views.forms.source_chooser import NextAction
from workbench.views.image.view import ImageView
from workbench.views.layouts import in_column
from workbench.views.plots.meters import HintBar

LIVE = "live"


class PictureTab(QWidget):
    """Tab with one picture and what was found in it, or with the live picture."""

    DETAIL: ClassVar[type]
    """What a live picture comes with once it has been looked at."""
    CORNER_SIZE: ClassVar[int]

    def __init__(self, presenter: Any, next_action: Callable[[], NextAction], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter, self._next_action = presenter, next_action
        self._name = ""
        """Of the picture that is shown."""
        self.image, self.line, self.hints = ImageView(), QLabel(), HintBar()
        self.line.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.line.setWordWrap(True)
        in_column(self.line, (self.image, 1), self.hints, on=self, margins=(6, 6, 6, 6))
        presenter.look.picture.connect(self._show_picture)
        presenter.live.show_by(self._draw_live)
        presenter.live.started.connect(self._live_started)
        presenter.live.notice.connect(self.image.announce)

    # ---- what differs

    @abstractmethod
    def _sentence(self) -> str:
        """What is said of the picture that is looked at."""

    @abstractmethod
    def _invitation(self) -> str:
        """What to do where there are no pictures."""

    @abstractmethod
    def _words(self) -> tuple[str, str, str]:
        """What is drawn at the corners; what the covered cells are covered by; what is said while nothing is seen."""

    def _draw(self, *, anew: bool = False) -> None:
        """Draw what was found in the picture shown; `anew` even if it is drawn already."""

    def _draw_more(self, detail: Any) -> None:
        """Draw what else is seen in a live picture."""

    # ---- the same

    def refresh(self) -> None:
        """Show the current picture with what was found in it, or the state of the live source."""
        p, live = self._presenter, self._presenter.live
        self.hints.setVisible(live.running)
        self.line.setVisible(not live.running and bool(p.current))
        if live.running:
            if self._name != LIVE and not live.live:
                self.image.clear(live.state_text())
            return
        self.image.announce("")
        if self._name == LIVE:
            self._name = ""
            self.image.clear_layers()
            p.look.again()
        if not p.current:
            self._empty()
            return
        self.line.setText(self._sentence())
        self._draw()

    def _live_started(self, _: object) -> None:
        self.image.clear_layers()

    def _empty(self) -> None:
        self._name = ""
        self.line.setText("")
        self.image.clear(self._invitation(), *self._next_action())

    def _show_picture(self, name: str, picture: Any) -> None:
        if self._presenter.live.running:
            return
        self.image.clear_layers()
        self.image.set_picture(picture)
        self._name = name
        self._draw(anew=True)

    def _draw_corners(self, corners: Array) -> None:
        self.image.set_points(
            "corners", corners, colour=CORNER.colour, symbol=CORNER.symbol, size=self.CORNER_SIZE,
            title=self._words()[0],
        )  # fmt: skip

    def _draw_live(self, view: LiveView) -> None:
        if self._name != LIVE:
            self.image.clear_layers()
            self._name = LIVE
        self.image.set_picture(view.picture, scale=view.scale)
        detail: Any = view.detail
        _, covered, looking = self._words()
        if not isinstance(detail, self.DETAIL):
            self.hints.set_hints([looking])
            return
        assert isinstance(detail, CameraDetail | PlanesDetail)
        self.image.set_cells("covered", detail.cells, title=covered)
        if detail.uv is None:
            self.image.remove_layer("corners")
        else:
            self._draw_corners(detail.uv)
        if detail.wanted is None:
            self.image.remove_layer("wanted")
        else:
            self.image.set_lines("wanted", [detail.wanted], colour=WANTED, width=3.0, title=tr("wanted next"))
        self._draw_more(detail)
        if not detail.missing:
            self.image.announce("")
            self.hints.set_hints([tr("Nothing is missing: press Stop, and it is calibrated.")])
            return
        seen = () if detail.sentence is None else (detail.sentence,)
        self.image.announce("".join(map(text_of, seen)))
        where = () if detail.wanted is None else (tr("The outline in the picture shows where it would add most."),)
        self.hints.set_hints([*map(text_of, (*seen, *detail.missing[:2])), *where])
