"""A report of a whole inspection: all characteristics, budgets, studies, deviations, template, languages, links."""

import io
import math
import re
from dataclasses import replace
from functools import cache
from typing import get_args

import numpy as np
import pypdfium2
import pytest
from matplotlib.text import Text
from pypdf import PdfReader

from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Limits, Verdict
from core.inspect.plan.control_frame import ControlFrame
from core.inspect.plan.feature_kind import ToleranceSymbol
from core.inspect.results import Contribution
from core.messages import label, plain
from core.progress import silent
from core.report import pdf
from core.report.content import MOST_CALLOUTS, ReportedStudy
from core.report.drawings import drawings
from core.report.layout.style import BOLD, SANS, ReportLook, words_width
from core.report.pdf import build_report
from core.report.plots.charts import callouts, surface_figure
from core.report.plots.run_chart import run_chart_figure
from core.report.sections.result import DECIDED, WIDTHS
from core.report.template import SECTIONS, ReportTemplate
from core.report.wording import SIGNS, Words, verdict_title
from core.scan.surface.fused_surface import Mesh
from core.translations import language

from .inspection_samples import whole_content

NO_MESH = Mesh(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), np.zeros((0, 3), np.int64))
LEFT_OUT = frozenset(SECTIONS) - {"budget", "signatures"}


def reader(data):
    return PdfReader(io.BytesIO(data))


@cache
def words(data):
    return " ".join(" ".join(page.extract_text() for page in reader(data).pages).split())


@pytest.fixture(scope="module")
def content():
    return whole_content()


@pytest.fixture(scope="module")
def data(content):
    return build_report(content)


@pytest.fixture(scope="module")
def quick(content):
    """The same with what cannot be left out, budgets and signatures: nothing is drawn, and few cells are laid out."""
    return replace(content, hidden=LEFT_OUT, repeats=(), studies=())


def test_every_characteristic_is_in_the_table_with_what_is_asked_U_k_and_its_decision(data):
    text = words(data)
    for row in (
        "50 mm ±0.2 mm 50.012 mm 0.013 mm 2.05 +0.012 mm ✓ Conforming",
        "top flatness 0 mm at most 0.05 mm 0.0310 mm 0.0080 mm 2 +0.0310 mm ✓ Conforming",
        "top to side 90° ±0.06° 89.950° 0.040° 2 −0.050° ? Not proven",
        "step 2 height 10 mm ±0.05 mm 10.200 mm 0.020 mm 2 +0.200 mm ✗ Not conforming",
        "ball diameter 24.980 mm 0.040 mm 2 – No verdict",
        "unknown 3 mm at most +0.03 mm unknown unknown 2 ? Not proven",
    ):
        assert row in text.replace("\u00a0", " "), row


def test_the_part_is_as_good_as_its_worst_characteristic(data):
    text = words(data)
    assert "step 2 height: the worst of 7 characteristics 10.200 mm ± 0.020 mm (k = 2)" in text.replace("\u00a0", " ")
    assert text.index("✗ Not conforming") < text.index("Characteristic nominal"), "in the box above the table"


def test_a_budget_has_value_distribution_sensitivity_contribution_and_freedom_of_each_input(data):
    text = words(data)
    assert "Temperature of the part 21.3 °C rectangular 0.50 °C 0.0024 0.00120 ∞ 4" in text
    assert "Repeatability of the scans t 0.0021 mm 1.0 0.00210 9.0 11" in text
    assert "Effective degrees of freedom ν_eff 768" in text
    assert "Expanded uncertainty U = k·u, k = 2.05, mm 0.013" in text
    assert "Camera calibration normal 0.0200 ∞ 100" in text, "of the angle, in degrees"


def test_very_many_degrees_of_freedom_are_not_counted_out(quick):
    first, *others = quick.inspected
    many = replace(first, budget=tuple(replace(row, dof=4e5) for row in first.budget))
    text = words(build_report(replace(quick, inspected=(many, *others))))
    assert "Effective degrees of freedom ν_eff > 1000" in text


def test_calibrations_have_id_age_and_hash(data):
    text = words(data)
    assert "Camera calibration c3f1a09b22d4, age 12 days" in text
    assert "Laser planes 9b22d4c3f1a0, age not known" in text
    assert "c3f1a09b22d4 2026-03-02 12:09 12 days " + "ab" * 6 + "…" in text
    lines = [page.get_textpage().get_text_range() for page in pypdfium2.PdfDocument(data)]
    assert any("2026-03-02 12:09 12 days" in line for line in lines), "the date is not parted from its time"
    assert "Rig 0123456789ab" in text


def test_a_length_stated_at_20_degrees_is_not_said_to_be_uncorrected(data):
    text = words(data)
    assert "block thickness: Stated at 20 °C: −0.75 µm for a part at 21.3 °C." in text
    assert "no correction to 20 °C was made" not in text
    assert "nothing is corrected" not in text


def test_the_worst_of_each_feature_is_called_out_on_the_surface_with_value_U_and_decision(content):
    look = ReportLook(Words(), content.template.accent)
    called = {one.said.split("\n")[0]: one for one in callouts(look, content)}
    assert list(called) == ["top to side ?", "top flatness ✓", "thickness ✓"], "the worst first"
    assert called["top flatness ✓"].said.endswith("0.0310 ± 0.0080 mm")
    top = content.cloud.points[content.points["top"]]
    assert np.min(np.linalg.norm(top - called["top flatness ✓"].place, axis=1)) == 0
    assert np.linalg.norm(called["top flatness ✓"].place - top.mean(axis=0)) < 5
    drawn = surface_figure(look, content.mesh, content.cloud, None, 170, 90, list(called.values()))
    canvas = drawn.canvas
    canvas.draw()
    words = [text for text in drawn.findobj(Text) if text.get_text()]
    dimensions = [text for text in words if re.fullmatch(r"[\d.]+ mm", text.get_text())]
    boxes = [text.get_window_extent() for text in words if "±" in text.get_text()]
    assert len(dimensions) == 2 and len(boxes) == 3
    assert not any(box.overlaps(text.get_window_extent()) for box in boxes for text in dimensions)
    many = {f"f{n}": np.arange(n, n + 5) for n in range(30)}
    rows = tuple(Characteristic(f"f{n} flatness", "flatness", 0.1, 0.01, doubts=()) for n in range(30))
    crowded = replace(content, inspected=rows, points=many, features={f"f{n} flatness": f"f{n}" for n in range(30)})
    assert len(callouts(look, crowded)) == MOST_CALLOUTS


def test_what_is_asked_of_form_and_lie_stands_as_a_feature_control_frame_with_its_datums(quick):
    (flatness,) = (one for one in quick.inspected if one.name == "top flatness")
    frames = {f"top {symbol}": ControlFrame(symbol, 0.05, "⌀", ("A", "B")) for symbol in get_args(ToleranceSymbol)}
    rows = tuple(replace(flatness, name=name) for name in frames)
    asked = replace(quick, inspected=rows, features=dict.fromkeys(frames, "top"), control_frames=frames)
    text = words(build_report(replace(asked, datums={"top": "C"}))).replace("\u00a0", " ")
    for name in frames:
        assert f"{name} ⌀0.05 A B Datum C 0 mm" in text


def test_a_cross_section_has_its_profile_and_the_rows_measured_in_it(data):
    text = words(data).replace("\u00a0", " ")
    after = text[text.rindex("cut A: measured points near the plane of the section. Dimensions are") :]
    assert after.index("step 2 height 10 mm ±0.05 mm 10.200 mm 0.020 mm 2 +0.200 mm ✗ Not conforming") < 200


def test_names_of_ones_own_stay_as_they_are_though_the_catalogue_has_the_words(content):
    look = ReportLook(Words(language("de")), content.template.accent)
    points = {"files": content.gauge.upper.indices}
    known = [replace(content, points=points), replace(content, points=points, inspected=())]
    drawn = [drawings(look, one, silent)["points"]() for one in known]
    legends = [text.get_text().split("\n")[0] for one in drawn for text in one.axes[0].get_legend().get_texts()]
    assert sorted(legends) == sorted(2 * ["Obere Fläche", "Untere Fläche", "files"])
    studies = [ReportedStudy(label("Series"), name, ()) for name in (label("thickness"), "files")]
    assert [study.title(look.words) for study in studies] == ["Serie: Dicke", "Serie: files"]


def test_what_a_wing_tells_of_studies_is_printed_with_figures_tables_and_notes(content, data):
    text = words(data)
    assert "Gauge R&R Verdict Repeats Mean s (n − 1) Nominal Bias acceptable 5 50.0100 mm 0.0042 mm" in text
    assert "Series: thickness Verdict Repeats" in text
    assert "quantity largest error, mm limit, mm p0 +0.0100 0.05" in text
    assert "p1: Stated at 20 °C: −0.75 µm for a part at 21.3 °C." in text
    drawn = drawings(ReportLook(Words(), content.template.accent), content, silent)
    assert [name for name in drawn if name.startswith("study-")] == ["study-1"]


@pytest.mark.parametrize(("fits_at", "pages"), [(0.9, 4), (0.6, 5)])
def test_pictures_become_smaller_to_save_a_last_page_with_hardly_anything_on_it(monkeypatch, content, fits_at, pages):
    def typeset(look, content, pictures, limits, pages, longest, *, trial):
        if limits.picture_scale > fits_at:
            raise pdf._TooLongError
        return pdf._Typeset(longest, 0.9, b"")

    monkeypatch.setattr(pdf, "_typeset", typeset)
    was = pdf._Typeset(5, 0.1, b"")
    limits, tried = pdf._without_last_page(ReportLook(Words(), "#14586E"), content, {}, pdf.LIMITS[0], was)
    assert tried.pages == pages
    assert limits == (replace(pdf.LIMITS[0], picture_scale=0.88) if pages == 4 else pdf.LIMITS[0])


@pytest.mark.parametrize(("count", "panels"), [(12, 2), (4, 1)])
def test_a_run_chart_has_a_histogram_beside_it_once_there_are_values_for_one(content, count, panels):
    values = (50.0 + 0.01 * np.random.default_rng(0).standard_normal(count)).tolist()
    figure = run_chart_figure(
        ReportLook(Words(), content.template.accent), values, (), {"mean": 50.0}, "mm", 170.0, 42.0
    )
    assert len(figure.axes) == panels
    bars = [bar.get_width() for axes in figure.axes[1:] for bar in axes.patches]
    assert sum(bars) == (count if panels == 2 else 0)
    lines = [line for axes in figure.axes for line in axes.lines if list(line.get_ydata()) == [50.0, 50.0]]
    assert len(lines) == panels, "the mean goes across both"


def test_template_gives_name_address_colour_footer_text_and_signatures(content, data):
    pages = reader(data).pages
    assert all("Amtsgericht Stuttgart HRB 12345" in page.extract_text() for page in pages)
    first, last = pages[0].extract_text(), pages[-1].extract_text()
    assert all(line in first for line in ("Werkzeugbau Süd GmbH", "70565 Stuttgart", "Brandt & Söhne"))
    assert "Results refer to the item measured only." in last
    assert last.index("M. Jørgensen") < last.index("Dr. A. Brandt") < last.index("End of report")
    assert last.count("Date, signature") == 2
    picture = pypdfium2.PdfDocument(data)[0].render(scale=1).to_numpy()[:, :, :3]
    logo = np.argwhere(np.all(np.abs(picture.astype(int) - [0x30, 0x20, 0x70]) < 6, axis=2))
    assert len(logo) > 1000
    assert logo[:, 1].max() > 530, "the logo is on the right"


def test_without_a_template_the_operator_signs(quick):
    text = words(build_report(replace(quick, template=ReportTemplate(), operator="M. J.")))
    assert text.count("Date, signature") == 1
    assert "M. J. Date, signature" in text


def test_sections_are_in_the_outline_and_results_lead_to_their_budgets(data):
    document = reader(data)

    def titles(entries):
        return [title for entry in entries for title in (titles(entry) if isinstance(entry, list) else [entry.title])]

    outline = titles(document.outline)
    for expected in ("Result", "What this result does not cover", "Measured surface", "Uncertainty budget",
                     "Uncertainty budget of top to side", "Studies", "Gauge R&R", "Notes and warnings",
                     "Inputs"):  # fmt: skip
        assert expected in outline
    pages = [" ".join(page.extract_text().split()) for page in document.pages]
    heads = (
        "Notes and warnings •",
        "Uncertainty budget of thickness",
        "Uncertainty budget of block thickness",
        "Uncertainty budget of top to side",
    )
    assert links_of_first_page(document) == sorted(
        number for head in heads for number, text in enumerate(pages) if head in text
    )


def test_results_whose_budgets_are_left_out_for_want_of_room_have_no_link(quick):
    one = quick.inspected[2]
    many = tuple(replace(one, name=f"angle {number}") for number in range(45))
    document = reader(build_report(replace(quick, inspected=many, gauge=None)))
    text = " ".join(" ".join(page.extract_text() for page in document.pages).split())
    assert text.count("Uncertainty budget of angle") == 40
    assert "and 5 more, listed in inspection.json" in text
    assert sum(len(page.get("/Annots", ())) for page in document.pages) == 40 + 1, "and one to the notes"


def links_of_first_page(document):
    """Numbers of the pages that links on page one lead to, sorted."""
    numbers = {page.indirect_reference.idnum: number for number, page in enumerate(document.pages)}
    links = [note.get_object()["/Dest"] for note in document.pages[0].get("/Annots", ())]
    return sorted(numbers[list.__getitem__(link, 0).idnum] for link in links)


def test_a_hidden_budget_is_not_linked_to(quick):
    document = reader(build_report(replace(quick, hidden=quick.hidden | {"budget"})))
    assert len(links_of_first_page(document)) == 1, "the one to the notes"


def test_fonts_are_embedded_and_text_is_selectable_whatever_is_printed(data):
    for page in reader(data).pages:
        for font in page["/Resources"]["/Font"].values():
            assert "/FontFile2" in font.get_object()["/FontDescriptor"], font.get_object()["/BaseFont"]
            assert "/ToUnicode" in font.get_object()


def test_in_german_words_and_numbers_are_german_and_the_file_says_so(content):
    data = build_report(replace(content, language="de", paper="Letter"))
    text = words(data).replace("\u00a0", " ")
    for expected in (
        "Messbericht",
        "Seite 1 von",
        "50 mm ±0,2 mm 50,012 mm 0,013 mm 2,05 +0,012 mm ✓ Konform",
        "höchstens 0,05 mm",
        "Was dieses Ergebnis nicht umfasst",
        "Temperatur des Teils 21,3 °C Rechteck 0,50 °C",
        "Erweiterte Messunsicherheit U = k·u, k = 2,05",
        "Messsystemanalyse (R&R) Entscheidung",
        "Alter 12 Tage",
        "Datum, Unterschrift",
        "Ende des Berichts",
    ):
        assert expected in text, expected
    for english in ("Uncertainty", "deviation", "Calibration", "page 1", "Report", "share"):
        assert english not in text, english
    pieces = [re.split(r"{[^}]+}", label) for label in language("de").labels]
    whole = {piece.strip() for sentence in pieces for piece in sentence if piece.strip().count(" ") > 3}
    assert len(whole) > 40
    assert [piece for piece in whole if piece in text] == []
    assert "die Tafel hat sich zwischen den Bildern ohne und mit Fächer um 0,90 px bewegt" in text
    document = reader(data)
    assert document.trailer["/Root"]["/Lang"] == "de"
    assert document.metadata.title.startswith("Messbericht TR-")


def test_every_section_can_be_left_out_in_german_too(content):
    text = words(build_report(replace(content, language="de", hidden=frozenset(SECTIONS))))
    assert "In diesem Bericht bewusst weggelassen: Gemessene Oberfläche" in text
    assert "Unterschriften." in text


LONG = ("Ein sehr langer Merkmalsname ohne Ende über mehrere Zeilen " * 3).strip()


@pytest.mark.parametrize("name", [LONG, "x" * 150, "Κύβος μέτρησης Концевая мера " * 4, "校正ブロックの厚さ" * 8])
@pytest.mark.parametrize("paper", ["A4", pytest.param("Letter", marks=pytest.mark.accuracy)])
def test_no_cell_is_cut_whatever_stands_in_it(quick, name, paper):
    limits = Limits(50.123456, -0.123456, 123.456789)
    budget = (Contribution(name, 0.004, 12.5, "rectangular", 7.5, 123456.789, "°C"),)
    rows = tuple(
        Characteristic(
            f"{name} {n}", "thickness", 50.1, 0.004, limits=limits, budget=budget, rule=plain(name), doubts=()
        )
        for n in range(3)
    )
    template = ReportTemplate(name=name, address=(name,), footer=name, text=name, signatures=(name, name, name, name))
    data = build_report(
        replace(quick, inspected=rows, template=template, customer=name, operator=name, part=name, paper=paper)
    )
    text = "".join(words(data).split())
    bare = "".join(name.split())
    assert text.count(bare) >= 3 * 3 + 2 + 4 + 3, "rows, rules, budgets, head, signatures, people"
    for page in pypdfium2.PdfDocument(data):
        picture = page.render(scale=1).to_numpy()
        assert picture[:, :40].min() == picture[:, -40:].min() == 255, "nothing in the margins"


def test_the_same_content_gives_the_same_bytes(content, data):
    assert build_report(whole_content()) == data


def test_the_name_of_a_report_follows_what_it_says(content):
    changes = ({}, {"language": "de"}, {"inspected": content.inspected[:2]}, {"template": ReportTemplate(name="X")},
               {"studies": ()})  # fmt: skip
    assert len({replace(content, **change).report_id for change in changes}) == len(changes)
    assert replace(content, paper="Letter").report_id == content.report_id


def test_one_result_alone_fills_the_box_whatever_is_asked_of_it(quick):
    for limits, expected in (
        (Limits(0.0, -math.inf, 0.05), "Tolerance at most 0.05"),
        (Limits(0.0, -0.1, math.inf), "Tolerance at least −0.1"),
        (None, "without a verdict"),
    ):
        one = Characteristic("top flatness", "flatness", 0.031, 0.004, limits=limits, doubts=())
        text = words(build_report(replace(quick, gauge=None, inspected=(one,)))).replace("\u00a0", " ")
        assert "top flatness 0.0310 mm ± 0.0080 mm (k = 2)" in text
        assert expected in " ".join(text.split()) or expected.replace("Tolerance ", "") in text


@pytest.mark.parametrize("name", ["en", "de"])
@pytest.mark.parametrize("verdict", list(Verdict))
def test_a_decision_stands_in_one_line(name, verdict):
    font = SANS if DECIDED[verdict] == "small" else BOLD
    decided = f"{SIGNS[verdict]} {verdict_title(verdict, Words.of(name))}"
    assert words_width(decided, font, 7) < WIDTHS[-1] - 5  # its padding


@pytest.mark.parametrize("name", ["en", "de"])
def test_no_head_of_the_result_breaks_within_a_word(name):
    heads = ("nominal", "permitted", "measured", "U", "k", "deviation", "verdict")
    for width, head in zip(WIDTHS, heads, strict=True):
        assert words_width(Words.of(name)(head), SANS, 7) < width - 6, head  # its padding
