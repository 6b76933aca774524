import io

from pypdf import PdfReader
from reportlab.platypus import SimpleDocTemplate, Spacer

from core.report.layout.blocks import section
from core.report.layout.style import SANS, ReportLook, prepare_reportlab
from core.report.wording import Words

LOOK = ReportLook(Words(), "#14586E")


def pages(above):
    """Text of the pages of a section below a gap of `above` points."""
    stream = io.BytesIO()
    document = SimpleDocTemplate(stream, pagesize=(400, 300), initialFontName=SANS)
    body = [Spacer(0, 40), LOOK.text("the last line")]
    document.build([Spacer(1, above), section(LOOK, "here", "Studies", body)])
    return [page.extract_text() for page in PdfReader(io.BytesIO(stream.getvalue())).pages]


def test_a_heading_and_what_it_belongs_to_are_on_one_page_however_little_room_is_left():
    prepare_reportlab()
    broken = [pages(above) for above in range(20, 140, 2)]
    assert {len(one) for one in broken} == {1, 2}
    for one in broken:
        assert "Studies" in one[-1]
        assert "the last line" in one[-1]
