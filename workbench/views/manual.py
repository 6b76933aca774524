"""The manual in a window of its own, offline: the pages that `make docs` builds for a browser, and their translations.

A page in the window's language lies in a folder of its name (`de/scan.md`); where there is none, it is the English one.
Its headings are those of the English page one by one, and links name them as there.
"""

from __future__ import annotations

import re
from importlib.resources import files
from pathlib import Path

from PySide6.QtCore import Qt, QUrl
from PySide6.QtGui import QDesktopServices, QTextBlockFormat, QTextCharFormat, QTextCursor, QTextDocument
from PySide6.QtWidgets import QHBoxLayout, QPushButton, QTextBrowser, QVBoxLayout, QWidget

from workbench.language import language_name, tr
from workbench.views.layouts import enable, keep_focus, resize_on_screen

SIZE = (980, 900)
"""Width and height of the manual's window at first, in pixels."""
MARGIN_PX = 24
"""Room around the text."""
ABOVE_HEADING_PX = 18
"""Room above a heading, so that it is seen to belong to what follows."""
_NOT_IN_ANCHORS = re.compile(r"[^\w-]")  # as MyST makes names of headings
_FENCED = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
_DIRECTIVE = re.compile(r"^```{.*?^```$", re.MULTILINE | re.DOTALL)  # for Sphinx alone


def manual_folder() -> Path:
    """Return the folder that holds the pages of the manual."""
    return Path(str(files("resources") / "manual"))


def manual_page(name: str) -> Path:
    """Return the path of the manual's page called `name`, in the window's language if that is translated."""
    translated = manual_folder() / language_name() / f"{name}.md"
    return translated if translated.is_file() else manual_folder() / f"{name}.md"


def headings(path: Path) -> list[str]:
    """List the link names of all headings of a manual's page, as Sphinx makes them."""
    lines = _FENCED.sub("", path.read_text(encoding="utf-8")).splitlines()
    titles = [line.lstrip("#").strip() for line in lines if line.startswith("#")]
    return [_NOT_IN_ANCHORS.sub("", title.lower().replace(" ", "-")) for title in titles]


class ManualPages(QTextBrowser):
    """Browser of the pages, with links between them; links to elsewhere go to the system's browser."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setOpenLinks(False)
        self.anchorClicked.connect(self._follow)

    def open_page(self, name: str) -> None:
        """Show the manual's page called `name`, as "scan"."""
        self._show(QUrl.fromLocalFile(str(manual_page(name))))

    def _follow(self, link: QUrl) -> None:
        target = self.source().resolved(link)
        if not target.isLocalFile():
            QDesktopServices.openUrl(target)
            return
        path = Path(target.toLocalFile())
        if path.suffix == ".md":  # as it is in the window's language, whichever page the link is on
            place = target.fragment()
            target = QUrl.fromLocalFile(str(manual_page(path.stem)))
            target.setFragment(place)
        self._show(target)

    def _show(self, target: QUrl) -> None:
        self.setSource(target)
        self.scrollToAnchor(target.fragment())

    def doSetSource(
        self, name: QUrl | str, type: QTextDocument.ResourceType = QTextDocument.ResourceType.UnknownResource
    ) -> None:
        """Load a page of the manual as Markdown; directives for Sphinx are left out (called by Qt)."""
        path = Path(QUrl(name).toLocalFile())
        if path.suffix != ".md" or not path.is_file():
            return
        super().doSetSource(name, type)  # the history, and where pictures are looked for
        self.setMarkdown(_DIRECTIVE.sub("", path.read_text(encoding="utf-8")))
        self.document().setBaseUrl(QUrl(name))
        self.document().setDocumentMargin(MARGIN_PX)
        self._dress_headings(headings(manual_folder() / path.name)[1:])

    def _dress_headings(self, names: list[str]) -> None:
        """Space above them, and the `names` by which links know them."""
        block, left = self.document().begin().next(), iter(names)
        while block.isValid():
            if block.blockFormat().headingLevel():
                cursor = QTextCursor(block)
                spaced = QTextBlockFormat()
                spaced.setTopMargin(ABOVE_HEADING_PX)
                cursor.mergeBlockFormat(spaced)
                named = QTextCharFormat()
                named.setAnchor(True)
                named.setAnchorNames([next(left, "")])
                cursor.movePosition(QTextCursor.MoveOperation.NextCharacter, QTextCursor.MoveMode.KeepAnchor)
                cursor.mergeCharFormat(named)
            block = block.next()


class ManualWindow(QWidget):
    """Window with the manual and buttons for back, forward and its first page."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent, Qt.WindowType.Window)
        self.setWindowTitle(tr("Manual"))
        resize_on_screen(self, *SIZE)
        self.pages = ManualPages(self)
        self.back, self.forward, self.start = (
            QPushButton(text, self) for text in (tr("Back"), tr("Forward"), tr("Contents"))
        )
        self.back.clicked.connect(self.pages.backward)
        self.forward.clicked.connect(self.pages.forward)
        self.start.clicked.connect(self._open_contents)
        self.pages.historyChanged.connect(self._show_buttons)
        self._show_buttons()
        buttons = QHBoxLayout()
        for button in (self.back, self.forward, self.start):
            buttons.addWidget(button)
        buttons.addStretch()
        column = QVBoxLayout(self)
        column.addLayout(buttons)
        column.addWidget(self.pages)

    def open_page(self, name: str) -> None:
        """Show the manual's page called `name`, with the window in front."""
        self.pages.open_page(name)
        self.show()
        self.raise_()
        self.activateWindow()

    def _show_buttons(self) -> None:
        before, after = self.pages.isBackwardAvailable(), self.pages.isForwardAvailable()
        enable(self.back, "" if before else tr("No page was opened before this one."), tr("The page before"))
        enable(self.forward, "" if after else tr("No page was opened after this one."), tr("The page after"))

    def focusNextPrevChild(self, next: bool) -> bool:
        return keep_focus(self) or super().focusNextPrevChild(next)

    def _open_contents(self) -> None:
        self.pages.open_page("index")
