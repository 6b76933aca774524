"""The quick card: one page in every language, nothing lost, the keys those of the window."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import pytest
from pypdf import PdfReader

from core.report.layout.style import SANS
from core.report.quick_card import BY_HAND, CLAIM, KEYS, KEYS_TITLE, LEFT, RIGHT, TITLE, quick_card
from core.report.template import PAPERS, Paper
from core.translations import PSEUDO, languages
from core.translations import language as named
from tests.simulated import trisect
from workbench.menus import KEYS as WINDOW_KEYS


def text_of(card: bytes) -> str:
    pages = PdfReader(io.BytesIO(card)).pages
    assert len(pages) == 1
    return "".join(pages[0].extract_text().split())


def texts() -> list[str]:
    lines = [text for part in (*LEFT, *RIGHT) for text in (part.title, *part.lines)]
    return [TITLE, CLAIM, *lines, KEYS_TITLE, *(meaning for _, meaning in KEYS), *BY_HAND]


@pytest.mark.parametrize("paper", PAPERS)
@pytest.mark.parametrize("language", [*languages(), PSEUDO])
def test_all_of_it_is_on_one_page_in_every_language(language: str, paper: Paper) -> None:
    said = text_of(quick_card(language, paper))
    speak = named(language).label
    missing = [text for text in texts() if "".join(speak(text).split()) not in said]
    assert missing == []


def test_a_text_twice_as_long_is_refused_by_this_test_and_not_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    from core.report import quick_card as module

    monkeypatch.setattr(module, "LEFT", LEFT * 2)
    with pytest.raises(ValueError, match="no room"):
        quick_card()


def test_no_chinese_line_begins_with_a_stop() -> None:
    page = PdfReader(io.BytesIO(quick_card("zh_CN"))).pages[0]
    lines = [line.strip() for line in page.extract_text().splitlines()]
    assert [line for line in lines if line.startswith(("。", "、", "，"))] == []


def test_its_keys_are_those_of_the_window() -> None:
    window = ", ".join(WINDOW_KEYS.values())
    for key, _ in KEYS:
        for one in key.split(", "):
            assert one in window, key


def test_the_same_language_gives_the_same_bytes_with_its_fonts_embedded() -> None:
    assert quick_card("de") == quick_card("de")
    page: Any = PdfReader(io.BytesIO(quick_card("de"))).pages[0]
    fonts = page["/Resources"]["/Font"]
    assert any(SANS in str(font.get_object()["/BaseFont"]) or "DejaVu" in str(font) for font in fonts.values())


def test_the_command_writes_it_in_its_language(tmp_path: Path) -> None:
    out = tmp_path / "card.pdf"
    assert trisect("card", "--out", out, "--paper", "letter", "--language", "de").code == 0
    assert out.read_bytes() == quick_card("de", "Letter")
    assert trisect("card", "--out", out, "--paper", "A9").code == 2
