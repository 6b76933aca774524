"""The form all pages share: the picture or 3D view in the middle, a panel of parameters and quality at the side."""

from __future__ import annotations

from functools import partial
from typing import Any

from PySide6.QtCore import QEvent, Qt
from PySide6.QtWidgets import QSizePolicy, QSplitter, QVBoxLayout, QWidget
from superqt import QCollapsible

from workbench.language import tr
from workbench.pages.presenter import StepPresenter
from workbench.refresh import Refresh
from workbench.theme import icon
from workbench.views.layouts import UpAndDown, holding, in_column
from workbench.views.stage_card import StageCard

SIDE_WIDTH, NARROWEST_SIDE = 380, 300
"""Pixels of the panel at the side: at first, and at least."""
LIST_HEIGHT, LIST_SHARE = 240, 0.36
"""A list of pictures at the side is at least so many pixels high, and takes this share of a higher page.

It takes less where then nothing at the side has to be scrolled to.
"""
FIELD_MARGIN = 60
"""So many pixels above and below a field are brought in sight with it: what it is, and what it means."""
ANY_HEIGHT = 16_777_215
"""Qt's own largest height of a widget: no limit."""


class StepPage(QWidget):
    """Page of the wizard.

    `refresh` is called once in the turn of the event loop after its presenter has changed, however often it did, and
    only while the page is visible. A page that was hidden meanwhile is refreshed before it is shown, by whoever shows
    it with `prepare`; never while Qt is showing it, widget by widget. `card` has the buttons of what is done here.
    """

    card: StageCard

    @property
    def takes_the_window(self) -> bool:
        """Whether the page needs the whole window now, so that no other page can be chosen."""
        return False

    def __init__(self, presenter: StepPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.refreshing = Refresh(self._refresh_if_seen, self)
        self.presenter: Any = presenter
        self._stale = True
        self._lists: list[QWidget] = []
        self.kept_panels: dict[str, QCollapsible] = {}
        """Panels that the user alone folds and unfolds, by the name under which that is remembered."""
        self.centre = QVBoxLayout()
        self.centre.setContentsMargins(8, 8, 8, 8)
        self.pinned = in_column(margins=(10, 8, 10, 0), spacing=8)
        self.side = in_column(margins=(10, 8, 10, 8), spacing=8)
        self.splitter = QSplitter(Qt.Orientation.Horizontal)
        self.splitter.addWidget(holding(self.centre))
        self.side_panel = self._side_panel()
        self.splitter.addWidget(self.side_panel)
        self.splitter.setStretchFactor(0, 1)
        self.splitter.setCollapsible(0, False)
        self.splitter.setSizes([900, SIDE_WIDTH])
        in_column(self.splitter, on=self)
        presenter.changed.connect(self.refreshing.soon)
        self.presenter.model.opened.connect(self.scroll_to_top)

    def refresh(self) -> None:
        """Show what the page's presenter says now."""

    def scroll_to_top(self) -> None:
        """Scroll the panels at the side to the top."""
        self.scrolled.verticalScrollBar().setValue(0)

    def enter(self, editor: QWidget | None) -> None:
        """Scroll the field `editor` at the side into view and give it the focus; None does nothing."""
        if editor is None:
            return
        self.refreshing.at_once()  # or what it shows anew would take the side back to its top
        self.side.activate()
        self.scrolled.ensureWidgetVisible(editor, 0, FIELD_MARGIN)
        editor.setFocus(Qt.FocusReason.OtherFocusReason)

    def add_panel(self, title: str, widget: QWidget, *, collapsed: bool = False, kept: str = "") -> QCollapsible:
        """Add a panel with a title at the side, which can be folded; with `kept`, its folding is remembered."""
        panel = QCollapsible(title)
        panel.setDuration(0)
        outside, inside = panel.layout(), panel.content().layout()
        assert outside is not None and inside is not None
        outside.setContentsMargins(0, 0, 0, 0)
        inside.setContentsMargins(4, 2, 2, 4)
        panel.setExpandedIcon(icon("mdi6.chevron-down", colour="muted"))
        panel.setCollapsedIcon(icon("mdi6.chevron-right", colour="muted"))
        panel.addWidget(widget)
        # What holds it to the height of words that are not wrapped: its filter, its policy, its alignment.
        widget.removeEventFilter(panel)
        panel.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)
        outside.setAlignment(Qt.AlignmentFlag(0))
        panel.toggled.connect(partial(_show_content, panel.content()))
        if collapsed:
            panel.collapse(animate=False)
        else:
            panel.expand(animate=False)
        self.side.insertWidget(self.side.count() - 1, panel)
        if kept:
            self.kept_panels[kept] = panel
        return panel

    def add_to_side(self, widget: QWidget) -> None:
        """Add a widget, which cannot be folded, at the bottom of the side."""
        self.side.insertWidget(self.side.count() - 1, widget)

    def pin_to_side(self, widget: QWidget) -> None:
        """Add a widget at the top of the side, which stays visible while the rest is scrolled."""
        self.pinned.addWidget(widget)

    def add_list(self, title: str, widget: QWidget) -> QCollapsible:
        """Add a panel with a list at the side; the list's height grows with the page."""
        self._lists.append(widget)
        self._fit_lists()
        return self.add_panel(title, widget, kept="list")

    def _fit_lists(self) -> None:
        for widget in self._lists:
            share = max(LIST_HEIGHT, round(LIST_SHARE * self.height()))
            lacking = self.scrolled.lacking() - widget.minimumHeight() + share if widget.isVisible() else 0
            gives = max(lacking, 0) if share - lacking >= LIST_HEIGHT else 0
            widget.setMinimumHeight(share - gives)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.refreshing.soon()  # icons and colours are the theme's

    def prepare(self) -> None:
        """Bring the page up to date before it is shown."""
        if self._stale:
            self._stale = False
            self.refresh()

    def showEvent(self, event: Any) -> None:
        super().showEvent(event)
        if self._stale:
            self.refreshing.soon()

    def _refresh_if_seen(self) -> None:
        self._stale = not self.isVisible()
        if not self._stale:
            self.refresh()

    def _side_panel(self) -> QWidget:
        self.side.addStretch(1)
        inside = holding(self.side)
        inside.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)
        self.scrolled = scroll = UpAndDown(inside, NARROWEST_SIDE, steady=True)
        scroll.setAccessibleName(tr("Settings and quality"))
        scroll.fitted.connect(self._fit_lists)
        return holding(in_column(self.pinned, (scroll, 1), spacing=0))


def _show_content(content: QWidget, shown: bool) -> None:
    """What is folded away is not seen, nor reached by keys; what is not has the height it needs."""
    content.setMaximumHeight(ANY_HEIGHT if shown else 0)
    content.setVisible(shown)
