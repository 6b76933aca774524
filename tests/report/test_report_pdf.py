import io
from dataclasses import replace
from datetime import UTC, date, datetime
from functools import cache
from hashlib import sha256

import matplotlib
import numpy as np
import pytest
from pypdf import PdfReader

from core.calibrate.results import NO_FAN
from core.checks.artefact_check import Artefact, ArtefactCheck
from core.errors import Cancelled
from core.inspect.causes import Cause
from core.inspect.characteristic import thickness_characteristic
from core.inspect.results import Contribution
from core.messages import plain
from core.model.certificate import Certificate
from core.pipeline.steps.report_step import method_in_words
from core.report.facts.of_budget import reported_rows
from core.report.pdf import build_report
from core.report.template import SECTIONS
from core.scan.results import FrameRecord
from core.scan.surface.fused_surface import Mesh

from .report_samples import block_content, gauge

NO_MESH = Mesh(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), np.zeros((0, 3), np.int64))


def reader(data):
    return PdfReader(io.BytesIO(data))


@cache
def words(data):
    """All text of a PDF, every run of blanks and line ends made one space."""
    return " ".join(" ".join(page.extract_text() for page in reader(data).pages).split())


def bare(text):
    return "".join(text.split())


@pytest.fixture(scope="module")
def content():
    return block_content()


@pytest.fixture(scope="module")
def data(content):
    return build_report(content)


@pytest.fixture(scope="module")
def quick(content):
    """The same without a point, so there is nothing to draw, and with few inputs, each of whose cells is laid out."""
    few = dict(list(content.hashes.items())[:4])
    nothing = content.cloud.select(np.arange(0))
    return replace(content, overlay=None, mesh=NO_MESH, cloud=nothing, gauge=None, hashes=few)


def test_result_is_printed_with_its_expanded_uncertainty_and_unit(data):
    assert "Thickness 50.012 mm ± 0.024 mm (k = 2)" in words(data)
    assert "+0.012 mm" in words(data)
    assert "±0.2 mm" in words(data)


def test_part_rig_calibrations_software_and_budget_are_named(data, content):
    text = words(data)
    for expected in (
        "Gauge block 50 mm",
        "GB-50-0417",
        "M. Jørgensen",
        "Werkzeugbau Süd",
        "checkerboard, 17 × 12 inner corners",
        "2494.92",
        "Views 11 of 12",
        "Corners off by 0.075 px",
        "Poses 7 of 8",
        "5.000 4.929",
        "0.034",
        "Trisect 0.1.0",
        "Fan's centrelines (static speckle) normal 0.041 mm 0.20 0.0082 ∞ 48",
        "Combined standard uncertainty u 0.0118",
        "stripe contrast automatic (38 grey levels)",
        "saturated on 0.8 %",
    ):
        assert expected in text, expected
    assert content.gauge.budget[-1].u_mm < 0.0001
    assert "< 0.0001" in text


def test_every_page_says_which_of_how_many_it_is(data):
    pages = reader(data).pages
    assert 1 <= len(pages) <= 5
    for number, page in enumerate(pages, start=1):
        assert f"page {number} of {len(pages)}" in page.extract_text()
    assert "End of report" in pages[-1].extract_text()
    assert "End of report" not in pages[0].extract_text()


def test_frames_left_out_are_counted_by_reason(data):
    text = words(data)
    assert "56 of 60" in text
    assert "no sweep stripe found 2 frame_017.png, frame_018.png" in text
    assert "the board lies half outside the picture 1 camera/view_07.png" in text


def test_every_input_is_printed_with_its_hash(data, content):
    text = words(data)
    assert content.inputs_digest in text
    for path, digest in content.hashes.items():
        assert f"{path.rpartition('/')[2]} {digest[:10]}" in text
    assert "in full are in run.json" in text


def test_traceability_names_certificates_laboratories_and_days_and_what_is_not_stated(quick):
    lapsed = Certificate("D-K 7", "Labor Nord", date(2026, 1, 31))
    known = replace(
        quick, certificates={"camera_target": lapsed, "known_planes.wall": lapsed}, hidden=frozenset(SECTIONS)
    )
    text = words(build_report(known))
    assert "Board wall D-K 7 Labor Nord 2026-01-31, lapsed" in text
    assert "Camera target D-K 7 Labor Nord 2026-01-31, lapsed" in text
    assert "Plane target none stated" in text and "Artefact none stated" in text
    assert replace(known, certificates={}).report_id != known.report_id


def test_the_day_of_the_report_stands_beside_that_of_the_measurement(quick):
    text = words(build_report(replace(quick, reported=date(2026, 3, 20))))
    assert "Measured 2026-03-14 15:09:26" in text and "Report made 2026-03-20" in text


def test_days_of_a_report_are_written_as_in_its_language(quick):
    due = {"camera_target": Certificate("D-K 7", "Labor Nord", date(2026, 1, 31))}
    german = replace(quick, reported=date(2026, 3, 20), certificates=due, language="de")
    text = words(build_report(german))
    assert "20.03.2026" in text and "31.01.2026" in text and "2026-0" not in text


def test_page_one_has_one_hash_and_files_are_named_by_short_ones(data, content):
    first = " ".join(reader(data).pages[0].extract_text().split())
    assert first.count("SHA-256") == 1 and f"Inputs, SHA-256 {content.inputs_digest[:12]}…" in first
    assert f"settings: {content.settings_digest[:12]}…" in words(data)


def test_a_length_has_rows_of_size_and_temperatures_even_where_they_add_nothing(content):
    stated = thickness_characteristic(gauge(content.cloud, np.zeros(len(content.cloud), dtype=bool), k=2.0))
    known = replace(stated, budget=(Contribution(Cause.CAMERA, 0.01), Contribution(Cause.SCALE_ASSUMED, 0.002)))
    told = [str(row.words) for row in reported_rows(known)]
    assert told[2:] == ["temperature of the calibration target", "temperature of the part"]
    assert [row.u_mm for row in reported_rows(known)][2:] == [0, 0]
    for other in (replace(known, at_20=None), replace(known, quantity="angle", kind="angle"), stated):
        assert reported_rows(other) == other.budget


def test_how_to_read_the_report_explains_its_letters(data):
    text = words(data)
    assert "How to read this report" in text
    for term in ("α, β Focal length", "γ Skew", "ν_eff Effective degrees of freedom of u", "not proven U is too large"):
        assert term in text, term


def test_fonts_are_embedded(data):
    fonts = {}
    for page in reader(data).pages:
        for font in page["/Resources"]["/Font"].values():
            descriptor = font.get_object()["/FontDescriptor"]
            fonts[font.get_object()["/BaseFont"]] = "/FontFile2" in descriptor
    assert fonts
    assert all(fonts.values()), fonts


def test_metadata_name_title_author_and_subject(data, content):
    metadata = reader(data).metadata
    assert metadata.title == f"Measurement report {content.report_id}"
    assert "Werkzeugbau Süd" in metadata.author
    assert metadata.subject == "Thickness of Gauge block 50 mm"
    assert metadata.creation_date == content.timestamp


def test_the_date_stands_in_one_place_of_the_text_and_nothing_else_depends_on_it(data, content):
    assert words(data).count("2026") == 1
    without_pictures = replace(content, hidden=frozenset({"surface", "frame", "points", "maps"}))
    later = build_report(replace(without_pictures, timestamp=datetime(2031, 12, 1, 7, 8, 9, tzinfo=UTC)))
    assert words(later) == words(build_report(without_pictures)).replace("2026-03-14 15:09:26", "2031-12-01 07:08:09")


def test_same_content_gives_the_same_bytes_whatever_the_users_plot_settings(data):
    with matplotlib.rc_context({"font.size": 20, "axes.grid": True, "lines.linewidth": 9}):
        assert build_report(block_content()) == data
        assert matplotlib.rcParams["font.size"] == 20


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"thickness_mm": 50.19}, ("? Not proven", "Neither conformity nor non-conformity")),
        ({"thickness_mm": 50.3}, ("✗ Not conforming", "Non-conformity is proven")),
        ({}, ("✓ Conforming", "Conformity is proven")),
        ({"nominal_mm": None, "tolerance_mm": None}, ("without a verdict",)),
        ({"u_mm": float("nan")}, ("50.012 mm (uncertainty unknown)",)),
    ],
)
def test_verdict_is_given_in_words_with_its_reason(quick, changes, expected):
    measured = gauge(quick.cloud, np.zeros(0, dtype=bool), **changes)
    text = words(build_report(replace(quick, gauge=measured)))
    for words_expected in expected:
        assert words_expected in text


def test_without_a_gauge_the_report_is_of_the_cloud(content):
    text = words(build_report(replace(content, gauge=None, part="Mask")))
    assert "Point cloud 21 120 points" in text
    assert "Median σ" in text
    assert "Uncertainty budget" not in text
    assert "Thickness" not in text


def test_without_any_point_there_is_still_a_report(quick):
    empty = replace(quick, frames=(), hashes={}, settings={}, notes=(), rig={}, part="", laboratory="")
    text = words(build_report(empty))
    assert "No point was measured" in text
    assert "Part not named" in text
    assert "No frame was given" in text


def test_one_point_is_drawn(quick, content):
    one = replace(quick, cloud=content.cloud.select(np.array([7])))
    assert "Point cloud 1 point " in words(build_report(one))


@pytest.mark.parametrize(
    "name",
    [
        "Endmaß Größe Ø50 „geprüft“",
        pytest.param("Κύβος μέτρησης", marks=pytest.mark.accuracy),
        pytest.param("Концевая мера длины", marks=pytest.mark.accuracy),
        "校正ブロック",
        pytest.param("게이지 블록", marks=pytest.mark.accuracy),
        "<b>A & B</b> &amp; </para>",
        "x" * 400,
        pytest.param("no_space_" * 40, marks=pytest.mark.accuracy),
    ],
)
def test_names_in_any_script_and_of_any_length_are_whole(quick, name):
    data = build_report(replace(quick, part=name, operator=name[::-1], notes=(plain(f"Note: {name}."),)))
    text = bare(words(data))
    assert text.count(bare(name)) >= 2
    assert bare(name[::-1]) in text


def test_a_text_beyond_measure_is_shortened_and_says_so(quick):
    text = words(build_report(replace(quick, part="W" * 20000, rig={"key": "v " * 9000}, notes=(plain("n " * 9000),))))
    assert "shortened from 20000 characters" in text


def test_a_long_scan_stays_within_four_pages_and_counts_what_it_leaves_out(content):
    hashes = {f"scan/frame_{n:05d}.png": sha256(str(n).encode()).hexdigest() for n in range(1500)}
    frames = tuple(FrameRecord(n, f"frame_{n:05d}.png", n % 3 > 0, plain(f"reason {n % 40}")) for n in range(1500))
    notes = tuple(plain(f"Note {n} of a long series.") for n in range(60))
    data = build_report(replace(content, hashes=hashes, frames=frames, notes=notes))
    text = words(data)
    assert len(reader(data).pages) <= 5
    assert "1 000 of 1 500" in text
    assert text.count("more, listed in run.json") == 3


def test_progress_is_told_and_can_cancel(quick):
    told = []
    build_report(quick, lambda step, done, total: told.append((done, total)))
    assert told[0][0] == 0
    assert told[-1][0] == told[-1][1]
    assert [done for done, _ in told] == sorted(done for done, _ in told)

    def stop(step, done, total):
        raise Cancelled

    with pytest.raises(Cancelled):
        build_report(quick, stop)


def test_known_artefacts_are_printed_with_certificate_e_n_and_verdict(quick):
    good = ArtefactCheck(
        Artefact("GB 50-7", 50.0003, 0.0004, 2.0, "D-K-15070 2026-03", date(2028, 3, 1)),
        50.004,
        0.009,
        date(2026, 5, 4),
    )
    wrong = ArtefactCheck(Artefact("B 20-1", 20.0, 0.0003, kind="sphere"), 20.0412, 0.012, date(2026, 5, 3))
    content = replace(quick, artefacts=(good, wrong))
    text = words(build_report(content))
    assert "Checks by known artefacts" in text
    for expected in (
        "GB 50-7 (block, thickness) in order +0.004 ± 0.018 50.004 ± 0.018 50.00030 ± 0.00040 0.21 D-K-15070 2026-03 "
        "2028-03-01 2026-05-04",
        "B 20-1 (sphere, diameter) changed +0.041 ± 0.024 20.041 ± 0.024 20.00000 ± 0.00030 1.72 not stated "
        "not stated 2026-05-03",
    ):
        assert expected in text, text[text.find("known artefacts") :][:600]
    assert content.report_id != quick.report_id
    assert "Checks by known artefacts" not in words(build_report(quick))
    assert "E_n" not in words(build_report(replace(content, hidden=frozenset({"artefacts"}))))


def test_the_decision_rule_is_named_always(content, data):
    assert "Decision rule: ISO 14253-1, a deviation must stay within" in words(data)
    without = replace(content, gauge=replace(content.gauge, nominal_mm=None, tolerance_mm=None))
    assert "Decision rule: none, for no limits are stated." in words(build_report(without))


def test_without_a_fan_nothing_is_said_of_one(content):
    rig = {"Camera": content.rig["Camera"], "Camera target": content.rig["Camera target"]}
    alone = replace(content, fan=NO_FAN, rig=rig, method=method_in_words("network", has_fan=False))
    said = words(build_report(alone))
    assert "tied to known planes" in said and "Camera target none stated" in said
    of_fan = ("Laser planes", "line and the fan", "Plane target", "Fixed laser")
    assert not [one for one in of_fan if one in said]
