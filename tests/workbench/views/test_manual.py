import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from babel.messages.pofile import read_po
from PySide6.QtCore import QUrl
from PySide6.QtGui import QTextBlock, QTextCursor
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from core.translations import language
from workbench.language import choose
from workbench.steps import STEPS
from workbench.views.manual import ManualWindow, headings, manual_folder, manual_page

PAGES = sorted(path.stem for path in manual_folder().glob("*.md"))
TRANSLATED = [(name, path.stem) for name in ("de", "zh_CN") for path in sorted((manual_folder() / name).glob("*.md"))]
FOR_USERS = {"first-measurement", "projects", "calibrate-camera", "calibrate-planes", "scan", "inspect", "report"}
TRANSLATIONS = Path(__file__).parents[3] / "resources" / "translations"
ITALIC = re.compile(r"(?<![*\w])\*([^*\n]+)\*(?!\*)")
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


@pytest.fixture
def in_language(qapp: QApplication) -> Iterator[Callable[[str], None]]:
    yield lambda name: choose(language(name), qapp)
    choose(language("en"), qapp)


@pytest.mark.parametrize("name", ["de", "zh_CN"])
def test_the_pages_for_users_and_of_every_step_are_in_the_windows_language(
    name: str, in_language: Callable[[str], None]
) -> None:
    in_language(name)
    assert {page for other, page in TRANSLATED if other == name} >= FOR_USERS
    for page in (*FOR_USERS, "index", *(step.manual for step in STEPS)):
        assert manual_page(page).parent.name == name, page
    assert manual_page("accuracy") == manual_folder() / "accuracy.md", "what is not translated is in English"


@pytest.mark.parametrize(("name", "page"), TRANSLATED)
def test_a_translated_page_has_headings_pictures_and_links_of_the_english_one(name: str, page: str) -> None:
    there, english = manual_folder() / name / f"{page}.md", manual_folder() / f"{page}.md"
    assert len(headings(there)) == len(headings(english))
    text, first = there.read_text(encoding="utf-8"), english.read_text(encoding="utf-8")
    assert set(LINK.findall(text)) <= set(PAGES)
    for other, place in re.findall(r"\]\(([\w-]*)(?:\.md)?#([\w-]+)\)", text):
        assert place in headings(manual_folder() / f"{other or page}.md"), place
    pictures = re.findall(r"pictures/(\w+\.png)", first)
    assert [part.rpartition("/")[2] for part in re.findall(r"pictures/(\S+\.png)", text)] == pictures
    for picture in re.findall(r"\]\((\S+\.png)\)", text):
        assert (there.parent / picture).is_file(), picture
    levels = [re.findall(r"^(#+) ", re.sub(r"(?ms)^```.*?^```$", "", one), re.MULTILINE) for one in (text, first)]
    assert levels[0] == levels[1]


NO_BUTTONS = {
    "de": {
        "Büschel",
        "U",
        "k",
        "u",
        "die Unsicherheit eingerechnet",
        "Leertaste",
        "Bild ab",
        "Bild auf",
        "größere x verbergen",
    },
    "zh_CN": {"平面束", "三交点", "U", "k", "u", "计入不确定度后", "空格", "Page Down", "Page Up", "隐藏 x 较大的一侧"},
}
"""In italics, but no words of the window alone: keys, terms, and words with a letter of an axis in them."""
KEYS = re.compile(r"((Shift|Umschalt|Ctrl|Strg)\+)?[A-Z]")


def plainly(words: str) -> str:
    """Words of the window without marks of keys, dots and colons."""
    return re.sub(r"\(&?[A-Z]\)|[&…]", "", words).strip()


@pytest.mark.parametrize(("name", "page"), TRANSLATED)
def test_a_translated_page_names_buttons_as_the_window_does(name: str, page: str) -> None:
    with (TRANSLATIONS / f"{name}.po").open("rb") as file:
        known = {
            plainly(said)
            for one in read_po(file)
            for said in (one.string if isinstance(one.string, (tuple, list)) else [one.string or ""])
        }
    text = re.sub(r"(?ms)^```.*?^```$", "", (manual_folder() / name / f"{page}.md").read_text(encoding="utf-8"))
    told = [plainly(part) for words in ITALIC.findall(text) for part in re.split(r"[,，]\s*", words)]
    known |= {plainly(part) for words in known for part in re.split(r"[,，]\s*", words)}
    assert [part for part in told if part not in known | NO_BUTTONS[name] and not KEYS.fullmatch(part)] == []


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
