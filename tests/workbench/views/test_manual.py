import re
from collections.abc import Iterator

import pytest
from PySide6.QtCore import QUrl
from PySide6.QtGui import QTextBlock, QTextCursor
from pytestqt.qtbot import QtBot

from workbench.views.manual import ManualWindow, manual_folder

PAGES = sorted(path.stem for path in manual_folder().glob("*.md"))
LINK = re.compile(r"\]\(([\w-]+)\.md\)")


@pytest.fixture
def manual(qtbot: QtBot) -> ManualWindow:
    window = ManualWindow()
    qtbot.addWidget(window)
    return window


@pytest.mark.parametrize("name", PAGES)
def test_every_page_is_shown_with_its_title_and_without_what_is_for_the_builder(
    manual: ManualWindow, name: str
) -> None:
    manual.pages.open_page(name)
    text = manual.pages.toPlainText()
    title = (manual_folder() / f"{name}.md").read_text(encoding="utf-8").partition("\n")[0]
    assert text.startswith(title.removeprefix("# "))
    assert "toctree" not in text


@pytest.mark.parametrize("name", PAGES)
def test_every_link_between_pages_leads_to_one(name: str) -> None:
    links = LINK.findall((manual_folder() / f"{name}.md").read_text(encoding="utf-8"))
    assert not set(links) - set(PAGES)


def anchors(name: str) -> list[tuple[str, str]]:
    """Page and heading of each link of a page that leads to a place within one."""
    text = (manual_folder() / f"{name}.md").read_text(encoding="utf-8")
    return [(page or name, place) for page, place in re.findall(r"\]\(([\w-]*)(?:\.md)?#([\w-]+)\)", text)]


def slug(heading: QTextBlock) -> str:
    """The name of a heading in links; none of other text."""
    level = heading.blockFormat().headingLevel()
    return re.sub(r"[^\w-]", "", heading.text().lower().replace(" ", "-")) if level else ""


def blocks(manual: ManualWindow) -> Iterator[QTextBlock]:
    block = manual.pages.document().begin()
    while block.isValid():
        yield block
        block = block.next()


@pytest.mark.parametrize("name", [name for name in PAGES if anchors(name)])
def test_a_link_to_a_place_in_a_page_leads_there(manual: ManualWindow, name: str) -> None:
    manual.resize(800, 300)
    manual.show()
    for page, place in anchors(name):
        manual.pages.open_page(name)
        manual.pages.verticalScrollBar().setValue(0)
        manual.pages.anchorClicked.emit(QUrl(f"{page}.md#{place}"))
        bar = manual.pages.verticalScrollBar()
        heading = next(one for one in blocks(manual) if slug(one) == place)
        top = manual.pages.cursorRect(QTextCursor(heading)).top()
        assert abs(top) < 10 or (bar.value() == bar.maximum() and 0 < top < bar.pageStep()), f"{page}.md#{place}"


def test_contents_leads_to_every_page() -> None:
    links = LINK.findall((manual_folder() / "index.md").read_text(encoding="utf-8"))
    assert set(PAGES) - set(links) == {"index"}


def test_a_link_is_followed_and_back_returns(manual: ManualWindow) -> None:
    manual.pages.open_page("index")
    assert not manual.back.isEnabled() and manual.back.toolTip() == "No page was opened before this one."
    manual.pages.anchorClicked.emit(QUrl("scan.md"))
    assert manual.pages.toPlainText().startswith("Scan")
    assert not manual.forward.isEnabled() and manual.forward.toolTip() == "No page was opened after this one."
    manual.back.click()
    assert manual.forward.isEnabled() and manual.forward.toolTip() == "The page after"
    assert manual.pages.toPlainText().startswith("Trisect")


def test_pictures_of_a_page_are_found(manual: ManualWindow) -> None:
    manual.pages.open_page("inspect")
    source = manual.pages.source().resolved(QUrl("../pictures/inspect.png"))
    assert manual.pages.loadResource(2, source) is not None


def test_the_page_on_inspecting_begins_with_the_tools_of_the_mouse_and_has_the_file_at_its_end(
    manual: ManualWindow,
) -> None:
    manual.pages.open_page("inspect")
    titles = [one.text() for one in blocks(manual) if one.blockFormat().headingLevel() == 2]
    assert titles[0] == "Click a face" and titles[-1] == "A plan as a file"
    said = manual.pages.toPlainText()
    assert "[[feature]]" not in said[: said.index(titles[-1])]
