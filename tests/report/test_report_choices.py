"""What the user adds to a report and leaves out of it: names, temperatures, remarks, repeats, sections, paper."""

import io
import re
from dataclasses import replace
from functools import cache

import numpy as np
import pypdfium2
import pytest
from pypdf import PdfReader

from core.inspect.shown.seen_from import SeenFrom
from core.report.content import CalibrationMark
from core.report.layout.style import TEXT_WIDTH, ReportLook
from core.report.pdf import build_report
from core.report.sections.calibration_tables import marks_table
from core.report.template import SECTIONS
from core.report.wording import Words
from core.scan.surface.fused_surface import Mesh

from .report_samples import block_content, gauge, repeats

NO_MESH = Mesh(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), np.zeros((0, 3), np.int64))

LEFT = SeenFrom(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, 600.0]), 80.0, 1.6)
"""The surface as it was left in 3D, seen from the camera."""


@cache
def pages(data):
    return [" ".join(page.extract_text().split()) for page in PdfReader(io.BytesIO(data)).pages]


def words(data):
    return " ".join(pages(data))


@pytest.fixture(scope="module")
def content():
    return block_content(repeats=repeats(), remarks="Cleaned with alcohol.\n\nLamp <off> & table warm.", view=LEFT)


@pytest.fixture(scope="module")
def whole(content):
    """All of it as a report, on A4."""
    return build_report(content)


@pytest.fixture(scope="module")
def quick(content):
    """The same without a point, so there is little to draw, and with few inputs, each of whose cells is laid out."""
    cloud, few = content.cloud.select(np.arange(0)), dict(list(content.hashes.items())[:4])
    bare = replace(content, overlay=None, mesh=NO_MESH, cloud=cloud, repeats=(), remarks="", hashes=few)
    return replace(bare, gauge=gauge(cloud, np.zeros(0, dtype=bool)))


def test_every_section_can_be_left_out_while_others_stay_and_the_last_page_names_it(content, whole):
    whole = words(whole)
    assert "Left out of this report by choice" not in whole
    pictures = ["surface", "view", "frame", "points", "maps"]  # drawn once is enough
    printable = [name for name in SECTIONS if name in content.printable]
    for half in (printable[::2], printable[1::2]):
        hidden = [name for name in printable if name in (*half, *pictures)]
        left_out = pages(build_report(replace(content, hidden=frozenset(hidden))))
        named = "; ".join(content.printable[name] for name in hidden)
        assert f"Left out of this report by choice: {named}." in left_out[-1]
        for name in printable:
            heading = content.printable[name]
            assert " ".join(left_out).count(heading) == (1 if name in hidden else whole.count(heading)), name
            assert heading in whole or name == "inputs"


def test_result_limits_warnings_and_the_hash_over_all_inputs_cannot_be_left_out(content):
    text = words(build_report(replace(content, hidden=frozenset(SECTIONS))))
    for needed in (
        "50.012 mm ± 0.024 mm",
        "What this result does not cover",
        "saturated on 0.8 %",
        content.inputs_digest,
    ):
        assert needed in text
    assert "frame_017.png" not in text
    assert text.index("Left out of this report") < text.index("End of report")


def test_a_section_that_was_empty_anyway_is_not_said_to_be_left_out(quick):
    text = words(build_report(replace(quick, hidden=frozenset({"repeats", "remarks", "frame", "settings"}))))
    assert "Left out of this report by choice: Software and settings." in text


def test_what_is_not_a_section_cannot_be_left_out(quick):
    with pytest.raises(ValueError, match="result: no section"):
        replace(quick, hidden=frozenset({"result"}))


def test_customer_and_temperatures_are_printed_and_nothing_is_corrected(quick):
    text = words(build_report(replace(quick, customer="Brandt & Söhne", air_celsius=20.42, part_celsius=-3.0)))
    assert "Customer Brandt & Söhne" in text
    assert "air 20.4 °C, part −3.0 °C; no correction to 20 °C was made" in text
    assert "Temperatures are those the operator stated; nothing is corrected to 20 °C." in text
    assert "Temperature was not measured" not in text


def test_one_temperature_alone_is_printed_alone(quick):
    text = words(build_report(replace(quick, part_celsius=21.0)))
    assert "Temperatures part 21.0 °C; no correction" in text


def test_remarks_keep_their_lines_and_their_characters(quick):
    text = words(build_report(replace(quick, remarks="First line.\n\n  2 < 3 & <b>so on</b>\n" + "校正ブロック " * 40)))
    assert "Remarks of the operator First line. 2 < 3 & <b>so on</b>" in text
    assert text.count("校正ブロック") == 40


def test_remarks_without_end_are_shortened_and_say_so(quick):
    data = build_report(replace(quick, remarks="word " * 5000))
    assert "shortened from 25000 characters" in words(data)
    assert len(pages(data)) <= 5


def test_repeats_are_listed_with_their_statistics(whole):
    text = words(whole)
    assert (
        "Repeated scans Repeats Mean s (n − 1) Nominal Bias Largest error "
        "10 50.012 mm 0.014 mm 50 mm +0.012 mm 0.027 mm" in text.replace("\u00a0", " ")
    )
    assert "1 scan-01 2026-03-14 14:00 49.991 0.024 2 −0.009 c3f1a09b22d4" in text
    assert "10 scan-10 2026-03-14 14:45" in text


def test_one_repeat_has_no_spread_and_no_chart(quick):
    text = words(build_report(replace(quick, repeats=repeats(1))))
    assert "in the order of measuring" not in text
    assert "1 49.991 mm needs two repeats 50 mm −0.009 mm 0.009 mm" in text.replace("\u00a0", " ")


def test_the_calibrations_of_a_repeat_are_parted_between_camera_and_fan(quick):
    one = replace(*repeats(1), calibration_id="5a3fa90b859f-5dd1523170c1")
    assert re.search(r"5a3fa90b859f-\s+5dd1523170c1", words(build_report(replace(quick, repeats=(one,)))))


def test_the_id_of_a_calibration_stays_in_one_line_however_wide_its_digits_are(content):
    def height(id_: str) -> float:
        marked = replace(content, calibrations=(CalibrationMark("planes", id_, "0" * 64),))
        return float(marks_table(ReportLook(Words(), content.template.accent), marked, TEXT_WIDTH).wrap(1000, 1000)[1])

    assert height("0" * 12) == height("f" * 12)


def test_many_repeats_with_long_names_are_cut_in_number_and_not_in_width(quick):
    name = "no_space_" * 12
    many = tuple(replace(one, scan=name, calibration_id="0123456789abcdef" * 2) for one in repeats(200))
    data = build_report(replace(quick, repeats=many, gauge=None))
    text = "".join(words(data).split())
    shown = text.count(name)
    assert 10 <= shown < 200
    assert f"and{200 - shown}more,listedintheproject" in text
    assert len(pages(data)) <= 6


@pytest.mark.parametrize(("paper", "size"), [("A4", (595.28, 841.89)), ("Letter", (612, 792))])
def test_every_page_has_the_size_of_its_paper_and_white_margins(content, whole, paper, size):
    document = pypdfium2.PdfDocument(whole if paper == content.paper else build_report(replace(content, paper=paper)))
    assert 2 <= len(document) <= 6
    for page in document:
        assert page.get_size() == pytest.approx(size, abs=0.01)
        picture = page.render(scale=1).to_numpy()
        assert picture[:, :48].min() == picture[:, -48:].min() == picture[:36].min() == 255


def test_other_words_and_other_sections_give_the_report_another_name(quick):
    changes = [
        {},
        {"customer": "X"},
        {"air_celsius": 20.0},
        {"part_celsius": 20.0},
        {"remarks": "X"},
        {"repeats": repeats(1)},
        {"hidden": frozenset({"frame"})},
    ]
    assert len({replace(quick, **change).report_id for change in changes}) == len(changes)
    assert replace(quick, paper="Letter").report_id == quick.report_id


def test_the_view_left_in_3d_is_a_figure_and_names_what_a_cut_hid(content, quick):
    cut = replace(LEFT, hidden=np.array([[5.0, 0, 600], [1.0, 0, 0]]))
    hidden = frozenset(SECTIONS) - {"view"}
    whole, half = (build_report(replace(content, hidden=hidden, view=view)) for view in (LEFT, cut))
    for data, said in ((whole, False), (half, True)):
        assert "The surface as it was left in 3D" in words(data)
        assert ("What the cut hid is not drawn." in words(data)) is said
    assert "as above" not in words(whole), "the section above is hidden"
    assert whole != half
    away = replace(LEFT, focal=np.array([5000.0, 0, 600]))
    for one in (replace(content, hidden=hidden, view=None), replace(content, hidden=hidden, view=away)):
        assert "left in 3D" not in words(build_report(one)), "nothing of the surface would be seen"
    assert replace(quick, view=LEFT).report_id == replace(quick, view=None).report_id, "there is no point to be seen"
    assert replace(content, view=cut).report_id != content.report_id
