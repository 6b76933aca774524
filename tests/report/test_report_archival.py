"""The report as PDF/A-3b: the rules of ISO 19005-3 that it could break, each on a report that has everything."""

import io
import re
from dataclasses import replace

import pikepdf
import pytest
from fontTools.ttLib import TTFont
from pikepdf import Name, pdfa
from PIL import ImageCms

from core.report.archival import archived
from core.report.pdf import build_report
from tests.report.inspection_samples import whole_content

PICTURES = frozenset({"surface", "frame", "points", "maps", "deviation", "sections"})

ATTACHED = {"gauge.json": b'{"thickness_mm": 50.0}', "camera.json": '{"name": "\u76f8\u673a"}'.encode()}


@pytest.fixture(scope="module")
def data():
    return build_report(replace(whole_content(), attachments=ATTACHED))


@pytest.fixture
def pdf(data):
    with pikepdf.open(io.BytesIO(data)) as opened:
        yield opened


def fonts(pdf):
    return {str(font.BaseFont): font for page in pdf.pages for font in page.resources.Font.values()}


def test_the_file_says_what_it_is_and_its_metadata_agree(pdf):
    meta = pdf.open_metadata()
    assert (meta["pdfaid:part"], meta["pdfaid:conformance"]) == ("3", "B")
    assert (meta["dc:title"], meta["xmp:CreatorTool"]) == (str(pdf.docinfo.Title), str(pdf.docinfo.Creator))
    at = re.sub(r"\D", "", str(pdf.docinfo.CreationDate))[:14]
    assert re.sub(r"\D", "", meta["xmp:CreateDate"])[:14] == at
    assert Name.Filter not in pdf.Root.Metadata


def test_its_colours_are_those_of_an_embedded_srgb_profile(pdf):
    (intent,) = pdf.Root.OutputIntents
    profile = intent.DestOutputProfile
    assert (intent.S, profile.N) == (Name.GTS_PDFA1, 3)
    read = ImageCms.ImageCmsProfile(io.BytesIO(profile.read_bytes()))
    assert "sRGB" in ImageCms.getProfileDescription(read)
    assert read.profile.xcolor_space.strip() == "RGB"


def test_no_page_has_what_is_forbidden_and_links_are_printed(pdf):
    assert not {"/AA", "/JavaScript", "/AcroForm"} & set(pdf.Root.keys())
    assert all(Name.Trans not in page.obj and Name.AA not in page.obj for page in pdf.pages)
    links = [link for page in pdf.pages for link in page.obj.get(Name.Annots, ())]
    assert links
    assert {int(link.F) for link in links} == {4}
    assert not pdf.is_encrypted


def streams(pdf):
    return [one for one in pdf.objects if isinstance(one, pikepdf.Stream)]


def test_the_file_has_an_identity_and_nothing_of_it_is_encoded_or_kept_elsewhere(pdf):
    first, second = pdf.trailer.ID
    assert len(bytes(first)) == len(bytes(second)) == 16
    filters = {str(one.get(Name.Filter, "")) for one in streams(pdf)}
    assert not any(forbidden in said for said in filters for forbidden in ("LZW", "Crypt"))
    assert not [one for one in streams(pdf) if {"/F", "/FFilter", "/FDecodeParms"} & set(one.keys())]


def test_whatever_is_transparent_is_blended_in_a_stated_colour_space(pdf):
    groups = [one.Group for one in (*streams(pdf), *(page.obj for page in pdf.pages)) if Name.Group in one]
    assert all(Name.Transparency == group.S and Name.CS in group for group in groups)
    modes = {str(one.get(Name.BM, Name.Normal)) for one in pdf.objects if isinstance(one, pikepdf.Dictionary)}
    assert modes == {"/Normal"}
    assert not [one for one in streams(pdf) if one.get(Name.Interpolate, False) or Name.Alternates in one]


def test_every_font_is_embedded_with_the_widths_it_has(pdf):
    found = fonts(pdf)
    assert any("Mono" in name for name in found)
    for name, font in found.items():
        program = TTFont(io.BytesIO(font.FontDescriptor.FontFile2.read_bytes()))
        glyphs, scale = program.getGlyphOrder(), 1000 / program["head"].unitsPerEm
        codes = program["cmap"].tables[0].cmap
        for code, width in enumerate(font.Widths, start=int(font.FirstChar)):
            if codes.get(code, glyphs[0]) != glyphs[0]:
                assert abs(float(width) - scale * program["hmtx"][codes[code]][0]) < 1, (name, code)


def test_a_report_with_a_font_that_is_only_named_does_not_say_that_it_is_an_archive(data):
    with pikepdf.open(io.BytesIO(data)) as pdf:
        next(iter(fonts(pdf).values())).FontDescriptor.__delitem__(Name.FontFile2)
        del pdf.Root.Metadata
        stream = io.BytesIO()
        pdf.save(stream)
    with pikepdf.open(io.BytesIO(archived(stream.getvalue(), {}))) as pdf:
        assert "pdfaid:part" not in pdf.open_metadata()


def test_the_results_are_attached_to_the_byte_and_said_to_be_what_the_pages_show(pdf):
    assert {name: spec.get_file().read_bytes() for name, spec in pdf.attachments.items()} == ATTACHED
    made = str(pdf.docinfo.CreationDate).rstrip("'")
    for spec in pdf.Root.AF:
        file = spec.EF.F
        assert (spec.AFRelationship, str(file.Subtype)) == (Name.Data, "/application/json")
        assert (str(spec.F), str(file.Params.ModDate).rstrip("'")) == (str(spec.UF), made)
    assert len(pdf.Root.AF) == len(ATTACHED)


def test_a_report_without_attachments_keeps_to_the_second_part_of_the_standard():
    without_pictures = whole_content(hidden=PICTURES, studies=(), repeats=())
    with pikepdf.open(io.BytesIO(build_report(without_pictures))) as pdf:
        assert pdf.open_metadata()["pdfaid:part"] == "2"
        assert Name.AF not in pdf.Root


def test_the_validator_of_pikepdf_finds_nothing(data):
    assert list(pdfa.validate_written(io.BytesIO(data), "3b").findings) == []
