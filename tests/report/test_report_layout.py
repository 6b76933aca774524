import io
from dataclasses import replace

import pytest
from PIL import Image
from pypdf import PdfReader
from reportlab.lib.utils import ImageReader
from reportlab.platypus import SimpleDocTemplate, Spacer

from core.report.layout.blocks import Heading, OnOnePage, Picture, Sections, section
from core.report.layout.style import SANS, ReportLook, prepare_reportlab
from core.report.pdf import LIMITS
from core.report.sections.standard import story
from core.report.wording import Words

from .report_samples import block_content

LOOK = ReportLook(Words(), "#14586E")


def pages(above):
    """Text of the pages of a section below a gap of `above` points."""
    stream = io.BytesIO()
    document = SimpleDocTemplate(stream, pagesize=(400, 300), initialFontName=SANS)
    body = [Spacer(0, 40), LOOK.text("the last line")]
    document.build([Spacer(1, above), section(LOOK, "here", "Studies", body)])
    return [page.extract_text() for page in PdfReader(io.BytesIO(stream.getvalue())).pages]


def page_of_picture(above, height=200):
    """On which page of 288 points a section with a picture is, below a gap, and how large the picture is."""
    picture = Picture(ImageReader(Image.new("RGB", (600, 300))), 1.0)
    picture.inner, picture.height = picture.inner * height / picture.height, height
    picture.width = 200
    seen = []
    picture.draw = lambda: seen.append((picture.canv.getPageNumber(), picture.height))
    document = SimpleDocTemplate(io.BytesIO(), pagesize=(400, 432), initialFontName=SANS)
    document.build([Spacer(1, above), section(LOOK, "here", "Studies", [picture])])
    return seen[0]


def test_a_picture_becomes_smaller_where_that_keeps_it_on_the_page():
    prepare_reportlab()
    found = [page_of_picture(above) for above in range(0, 200, 4)]
    first = [height for page, height in found if page == 1]
    assert first[0] == 200 and 150 < min(first) < 190, "it shrinks, but stays readable"
    assert first == sorted(first, reverse=True)
    assert {height for page, height in found if page == 2} == {200}, "on a new page it has its own size"


def test_a_heading_and_what_it_belongs_to_are_on_one_page_however_little_room_is_left():
    prepare_reportlab()
    broken = [pages(above) for above in range(20, 140, 2)]
    assert {len(one) for one in broken} == {1, 2}
    for one in broken:
        assert "Studies" in one[-1]
        assert "the last line" in one[-1]


def heights_by_page(*heights, above):
    """On which page of 288 points each of several sections is, below a gap; they cannot shrink."""
    places = {}

    def block(number, height):
        made = Spacer(1, height)
        made.draw = lambda: places.setdefault(number, made.canv.getPageNumber())
        return OnOnePage([made])

    document = SimpleDocTemplate(io.BytesIO(), pagesize=(400, 432), initialFontName=SANS)
    document.build([Spacer(1, above), Sections([block(number, height) for number, height in enumerate(heights)])])
    return [places[number] for number in range(len(heights))]


def test_a_section_that_fits_goes_before_one_that_does_not():
    prepare_reportlab()
    assert heights_by_page(200, 100, 60, above=100) == [2, 1, 1]
    assert heights_by_page(150, 100, 60, above=10) == [1, 1, 2], "in their order where they fit"
    assert heights_by_page(250, 250, 20, above=0) == [1, 2, 1]


def test_no_number_is_parted_from_its_unit_however_wide_its_column_is():
    prepare_reportlab()
    said = "17 × 12 corners, squares of 10 mm, off by 0.03 mm (95 % of points), at 20 °C"
    for width in range(60, 240, 3):
        paragraph = LOOK.text(said, "small")
        paragraph.wrap(width, 1000)
        lines = [" ".join(words) for _, words in paragraph.blPara.lines]
        assert len(lines) > 1
        assert not [line for line in lines if line.split()[0] in ("mm,", "mm", "%", "°C")]


@pytest.mark.parametrize("remarks", ["Table warm.", "One line.\n" * 60])
def test_what_a_result_rests_on_fills_pages_in_any_order_but_long_remarks_flow(remarks):
    prepare_reportlab()
    parts = story(LOOK, replace(block_content(), remarks=remarks), {}, LIMITS[0])
    moved = [one for one in parts if isinstance(one, Sections)][-1].sections
    keys = [inside.key for one in moved for inside in one._content if isinstance(inside, Heading)]
    assert keys == ["traceability", "calibrations", "frames", "notes", "reading"] + ["remarks"] * (
        remarks == "Table warm."
    )
