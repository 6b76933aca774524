"""East Asian lines: they break between characters, and within no number, unit or foreign word."""

from __future__ import annotations

from itertools import pairwise

import pytest

from core.report.layout.paragraph import NOT_FIRST, Paragraph
from core.report.layout.style import ReportLook, markup, prepare_reportlab, styles_of
from core.report.wording import Words

SAID = (
    "与最佳拟合平面的偏差在 1 204 个点上的散布为 0.012 mm，测得的厚度为 50.012 mm ± 0.024 mm (k = 2)，低于公差 0.2 mm。"
    "光条宽 7 px，温度 20.3 °C，激光面倾斜 35 µrad；用 Trisect 的 network 方法，“高度 12 mm的台阶”，占 95 %。"
)
UNITS = ("mm", "px", "°C", "µrad", "%")


@pytest.fixture(scope="module")
def look() -> ReportLook:
    prepare_reportlab()
    return ReportLook(Words.of("zh_CN"), "#14586E")


def lines(paragraph: Paragraph, width: float) -> list[str]:
    """The text of each line as it is laid out so wide."""
    paragraph.wrap(width, 10_000)
    return ["".join(part.text for part in line.words) for line in paragraph.blPara.lines]


@pytest.mark.parametrize("style", ["body", "small", "bullet", "number"])
def test_no_line_parts_a_number_from_its_unit_or_a_word_or_begins_with_a_stop(look: ReportLook, style: str) -> None:
    for width in range(70, 420, 3):
        laid = lines(look.text(SAID, style), width)
        assert "".join(laid).replace("\u00a0", " ") == SAID, width
        for line, following in pairwise(laid):
            assert not following.startswith(UNITS), (width, line, following)
            assert following[0] not in NOT_FIRST, (width, line, following)
            assert not line.endswith(("“", "(")), (width, line)
            both_latin = line[-1].isascii() and line[-1].isalnum() and following[0].isascii() and following[0].isalnum()
            assert not both_latin, (width, line, following)


def test_lines_are_full_and_no_wider_than_there_is_room(look: ReportLook) -> None:
    for width in (80, 150, 300):
        paragraph = look.text(SAID)
        laid = lines(paragraph, width)
        assert all(line.extraSpace >= -1e-6 for line in paragraph.blPara.lines)
        longest_word = 9 * look.style("body").fontSize
        assert all(line.extraSpace < longest_word for line in paragraph.blPara.lines[:-1]), laid


def test_what_has_no_place_to_break_is_cut_where_the_line_is_full(look: ReportLook) -> None:
    digest = "0123456789abcdef" * 4
    laid = lines(look.text(digest), 100)
    assert len(laid) > 1 and "".join(laid) == digest and len(laid[0]) == len(laid[1])


def test_a_line_end_that_is_asked_for_and_a_text_in_two_fonts_are_kept(look: ReportLook) -> None:
    style = look.style("body")
    laid = lines(Paragraph(f"{markup('厚度')}<br/>{markup('宽度 5 mm')}", style), 300)
    assert [one.replace("\u00a0", " ").strip() for one in laid] == ["厚度", "宽度 5 mm"]


def test_a_paragraph_cut_by_the_end_of_a_page_loses_no_character(look: ReportLook) -> None:
    paragraph = look.text(SAID)
    _, height = paragraph.wrap(150, 10_000)
    pieces = paragraph.split(150, height / 2)
    said = "".join("".join(lines(piece, 150)) for piece in pieces)
    assert len(pieces) == 2 and said.replace("\u00a0", " ").replace(" ", "") == SAID.replace(" ", "")


def test_other_languages_break_at_spaces_as_before() -> None:
    prepare_reportlab()
    plain = Paragraph(markup("The thickness is 50 mm"), styles_of("#14586E")["body"])
    plain.wrap(60, 1000)
    assert [line[1] for line in plain.blPara.lines] == [["The", "thickness"], ["is", "50\u00a0mm"]]
