"""Scripts that the report's own fonts lack: set in a font of this computer, or a note says what is missing."""

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pikepdf
import pytest
from fontTools.fontBuilder import FontBuilder
from fontTools.pens.recordingPen import RecordingPen
from fontTools.pens.t2CharStringPen import T2CharStringPen
from fontTools.pens.ttGlyphPen import TTGlyphPen
from fontTools.ttLib import TTFont
from pikepdf import pdfa
from pypdf import PdfReader

from core.report.layout import foreign_fonts
from core.report.layout.converted_font import converted_font
from core.report.layout.foreign_fonts import is_east_asian
from core.report.layout.style import NO_FONT, NOT_EMBEDDED, ReportLook, font_note, markup, prepare_reportlab
from core.report.pdf import build_report
from core.report.plots.charts import points_figure
from core.report.plots.figures import FAMILY, drawable, families, new_figure, pixels
from core.report.template import SECTIONS
from core.report.wording import Words
from core.translations import language
from tests.report.report_samples import block_content

ROOT = Path(__file__).parents[3]
CHINESE, THAI = "量块", "ก"


def font_file(path, characters, *, truetype=True, licence=0):
    """A font with a square for each of these characters; its outlines are TrueType's, or PostScript's."""
    pen = TTGlyphPen(None) if truetype else T2CharStringPen(1000, None)
    for move, at in ((pen.moveTo, (0, 0)), (pen.lineTo, (0, 900)), (pen.lineTo, (900, 900)), (pen.lineTo, (900, 0))):
        move(at)
    pen.closePath()
    names = {ord(character): f"g{ord(character):X}" for character in characters}
    builder = FontBuilder(1000, isTTF=truetype)
    builder.setupGlyphOrder([".notdef", *names.values()])
    builder.setupCharacterMap(names)
    square = pen.glyph() if truetype else pen.getCharString()
    squares = dict.fromkeys((".notdef", *names.values()), square)
    if truetype:
        builder.setupGlyf(squares)
    else:
        builder.setupCFF("Squares", {}, squares, {})
    builder.setupHorizontalMetrics({name: (1000, 0) for name in (".notdef", *names.values())})
    builder.setupHorizontalHeader(ascent=900, descent=-100)
    ps_name = f"Squares-{path.stem}"  # reportlab takes two fonts of one name for the same
    builder.setupNameTable({"familyName": "Squares", "styleName": "Regular", "psName": ps_name})
    builder.setupOS2(sTypoAscender=900, sTypoDescender=-100, fsType=licence)
    builder.setupPost()
    builder.save(str(path))


@pytest.fixture
def computer(monkeypatch):
    """A computer with these fonts alone: (family, path)."""
    prepare_reportlab()

    def has(*fonts):
        monkeypatch.setattr(foreign_fonts, "system_fonts", lambda: fonts)
        forget()

    yield has
    forget()


def forget():
    foreign_fonts.embedded_font.cache_clear()
    foreign_fonts.drawn_family.cache_clear()


@pytest.fixture(scope="module")
def bare():
    return replace(block_content(), hidden=frozenset(SECTIONS), gauge=None)


def fonts_and_text(data):
    pages = PdfReader(io.BytesIO(data)).pages
    fonts = [font.get_object() for page in pages for font in page["/Resources"]["/Font"].values()]
    return fonts, " ".join("".join(page.extract_text() for page in pages).split())


def test_a_font_of_this_computer_is_embedded_for_its_characters_alone(computer, bare, tmp_path):
    font_file(tmp_path / "squares.ttf", CHINESE)
    computer(("Squares", str(tmp_path / "squares.ttf")))
    fonts, text = fonts_and_text(build_report(replace(bare, part=f"Teil {CHINESE} 7")))
    assert f"Teil {CHINESE} 7" in text
    assert any("Squares" in font["/BaseFont"] for font in fonts)
    assert all("/FontFile2" in font["/FontDescriptor"] for font in fonts)
    assert str(NOT_EMBEDDED) not in text
    assert markup(f"a{CHINESE}b") == f'a<font name="Foreign-squares">{CHINESE}</font>b'
    assert (drawable(CHINESE), families(CHINESE)) == (CHINESE, ["DejaVu Sans", "Squares"])


@pytest.mark.parametrize("licence", [0x2, 0x100, 0x200])
def test_plots_take_a_font_that_no_report_may_embed(computer, tmp_path, licence):
    font_file(tmp_path / "restricted.otf", CHINESE, truetype=False, licence=licence)
    computer(("Squares", str(tmp_path / "restricted.otf")))
    assert font_note([CHINESE]) == NOT_EMBEDDED
    assert (drawable(CHINESE), families(CHINESE)) == (CHINESE, ["DejaVu Sans", "Squares"])


def test_a_chinese_report_is_an_archive_where_the_only_chinese_font_has_postscript_outlines(computer, bare, tmp_path):
    written = (ROOT / "resources" / "translations" / "zh_CN.po").read_text(encoding="utf-8")
    chinese = sorted({one for one in f"{written} 年月日" if is_east_asian(one)})  # dates are written by babel
    font_file(tmp_path / "all.otf", "".join(chinese), truetype=False)
    computer(("Squares", str(tmp_path / "all.otf")))
    content = replace(bare, part=CHINESE, language="zh_CN", attachments={"a.json": b"{}"})
    data = build_report(content)
    assert "测量报告" in fonts_and_text(data)[1] and str(NOT_EMBEDDED) not in fonts_and_text(data)[1]
    assert list(pdfa.validate_written(io.BytesIO(data), "3b").findings) == []
    with pikepdf.open(io.BytesIO(data)) as pdf:
        assert pdf.open_metadata()["pdfaid:part"] == "3"
        fonts = {str(one.BaseFont): one for page in pdf.pages for one in page.resources.Font.values()}
        (squares, *_) = [one for name, one in fonts.items() if "Squares" in name]
        program = TTFont(io.BytesIO(squares.FontDescriptor.FontFile2.read_bytes()))
        assert len(program.getGlyphOrder()) <= 257 and set(map(float, squares.Widths)) == {1000.0}
    forget()
    assert build_report(content) == data, "whenever it is made"


def test_a_converted_font_keeps_shapes_and_widths(tmp_path):
    font_file(tmp_path / "postscript.otf", CHINESE, truetype=False)
    font = converted_font("Converted", str(tmp_path / "postscript.otf"))
    assert font.face.charWidths == {ord(one): 1000.0 for one in CHINESE}
    made = TTFont(io.BytesIO(font.face.makeSubset([0, ord(CHINESE[1])])))
    pen = RecordingPen()
    made.getGlyphSet()[made.getGlyphOrder()[1]].draw(pen)
    corners = {point for _, points in pen.value for point in points}
    assert corners == {(0, 0), (0, 900), (900, 900), (900, 0)}
    font_file(tmp_path / "truetype.ttf", CHINESE)
    with pytest.raises(ValueError, match="no PostScript outlines"):
        converted_font("Converted", str(tmp_path / "truetype.ttf"))


def test_east_asian_text_without_a_font_is_left_to_the_readers_program_and_a_note_says_so(computer, bare):
    computer()
    fonts, text = fonts_and_text(build_report(replace(bare, part=CHINESE)))
    assert CHINESE in text
    assert str(NOT_EMBEDDED) in text
    assert any("/FontDescriptor" not in font or "/FontFile2" not in font["/FontDescriptor"] for font in fonts)
    german = fonts_and_text(build_report(replace(bare, part=CHINESE, language="de")))[1]
    assert "Einige ostasiatische Zeichen dieses Berichts" in german


def test_a_character_no_font_has_is_printed_by_its_code_point_and_a_note_says_so(computer, bare):
    computer()
    text = fonts_and_text(build_report(replace(bare, part=f"part {THAI}\U00010330\ntwo")))[1]
    assert "part [U+0E01][U+10330] two" in text
    assert str(NO_FONT) in text


def test_a_font_that_cannot_be_read_or_embedded_is_passed_over(computer, tmp_path):
    (tmp_path / "broken.ttf").write_bytes(b"no font")
    font_file(tmp_path / "thai.ttf", THAI)
    computer(("Broken", str(tmp_path / "broken.ttf")), ("Thai", str(tmp_path / "thai.ttf")))
    assert foreign_fonts.embedded_font(THAI) == "Foreign-thai"
    assert font_note([f"x {THAI}"]) is None


def test_what_the_reports_own_fonts_have_needs_no_note(computer):
    computer()
    assert font_note(["Größe Κύβος Концевая 50 µm ± σ\u00a0\n"]) is None


def test_this_computers_fonts_are_files_and_none_has_a_box_for_everything():
    assert all("Last Resort" not in family for family, _ in foreign_fonts.system_fonts())


@pytest.mark.filterwarnings("error")
def test_a_plot_has_no_empty_boxes(computer, bare):
    """Matplotlib warns of each character that its font lacks."""
    computer()
    figure = points_figure(
        ReportLook(Words(), "#14586E"), bare.cloud, {CHINESE: np.arange(50)}, (1920, 1374), 160.0, 70.0
    )
    figure.canvas.draw()
    assert [text.get_text().split("\n")[0] for text in figure.axes[0].get_legend().get_texts()] == ["??"]


def test_what_is_drawn_beside_paragraphs_is_in_the_language_of_the_report_as_well(computer):
    computer()
    fonts, text = fonts_and_text(build_report(replace(block_content(), language="zh_CN", hidden=frozenset(SECTIONS))))
    assert "/STSong-Light" in {font["/BaseFont"] for font in fonts}
    for words in ("conforming", "nominal"):
        assert language("zh_CN").label(words) in text
    assert "第 1 页" in text


def test_words_of_a_plot_are_drawn_in_a_font_that_has_them(computer, tmp_path):
    font_file(tmp_path / "squares.ttf", CHINESE)
    computer(("Squares", str(tmp_path / "squares.ttf")))
    figure = new_figure(30, 20)
    said, english = figure.text(0.1, 0.5, f"{CHINESE} 7"), figure.text(0.1, 0.1, "block 7")
    with pytest.warns(UserWarning, match="Glyph"):  # which matplotlib does not know: it is of this test alone
        pixels(figure)
    assert said.get_fontfamily() == [FAMILY, "Squares"]
    assert english.get_fontfamily() != said.get_fontfamily()
