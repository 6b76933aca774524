"""`trisect report`, `export` and `import-camera`: the choices, the files, and what is said when something is wrong."""

import json
import re
import shutil

import pytest
from pypdf import PdfReader

from tests.simulated import trisect

TEMPLATE = 'name = "House of Gauges"\nlanguage = "de"\nwithout = ["frame"]\nsignatures = ["A. Brandt"]\n'


@pytest.fixture
def out(measured, tmp_path):
    return shutil.copytree(measured, tmp_path / "out")


def text_of(path):
    return " ".join(" ".join(page.extract_text() for page in PdfReader(str(path)).pages).split())


def test_the_report_follows_template_language_paper_sections_and_names(simulated, out, tmp_path):
    (tmp_path / "house.toml").write_text(TEMPLATE)
    said = trisect("report", simulated, "--out", out, "--template", tmp_path / "house.toml", "--paper", "letter",
                   "--without", "inputs", "--customer", "Brandt & Söhne", "--operator", "M. J.",
                   "--serial", "GB-1")  # fmt: skip
    assert said.code == 0, said.err
    text = text_of(out / "report.pdf")
    for expected in ("Messbericht", "House of Gauges", "Brandt & Söhne", "GB-1", "A. Brandt Datum, Unterschrift",
                     "bewusst weggelassen: Ein Bild des Scans; Eingaben"):  # fmt: skip
        assert expected in text
    assert float(PdfReader(str(out / "report.pdf")).pages[0].mediabox.width) == 612


def test_what_is_said_on_the_command_line_goes_before_the_template(simulated, out, tmp_path):
    without_pictures = TEMPLATE.replace('"frame"', '"surface", "frame", "points", "maps"')
    (tmp_path / "house.toml").write_text(without_pictures)
    words = ("--template", tmp_path / "house.toml", "--language", "en")
    assert trisect("report", simulated, "--out", out, *words).code == 0
    assert "Measurement report" in text_of(out / "report.pdf")


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--language", "fr"), '--language: there is no "fr"; choose among en, de, zh_CN.'),
        (("--paper", "A3"), '--paper: there is no "A3"; choose among A4, Letter.'),
        (("--without", "result"), '--without: there is no section "result" to leave out; choose among surface'),
        (("--template", "missing.toml"), "missing.toml"),
        (("--study", "missing.json"), "missing.json"),
    ],
)
def test_a_wrong_choice_is_one_sentence_and_the_old_report_stays(simulated, out, words, sentence):
    before = (out / "report.pdf").read_bytes()
    said = trisect("report", simulated, "--out", out, *words)
    assert (said.code, sentence in said.sentence) == (2, True), said.err
    assert (out / "report.pdf").read_bytes() == before


def test_results_are_exported_beside_themselves_in_several_formats(out):
    said = trisect("export", out, "--format", "xlsx,dfq", "-f", "results", "--serial", "GB-1", "--json")
    assert said.code == 0, said.err
    assert set(json.loads(said.out)["files"]) == {"xlsx", "dfq", "results"}
    assert json.loads((out / "result.json").read_text())["item"]["serial"] == "GB-1"
    assert b"K0014/1 GB-1\r\n" in (out / "result.dfq").read_bytes()


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--format", "doc"), 'there is no format "doc"; choose among pdf, cloud'),
        (("--format", ","), "no format is given"),
        (("--format", "ros"), "camera_info has no skew"),
    ],
)
def test_what_cannot_be_exported_is_one_sentence(out, words, sentence):
    said = trisect("export", out, *words)
    assert (said.code, sentence in said.sentence) == (2, True), said.err


def test_a_folder_without_results_has_nothing_to_export(tmp_path):
    said = trisect("export", tmp_path, "--format", "xlsx")
    assert (said.code, "run.json: the file is missing" in said.sentence) == (2, True)


def test_a_camera_goes_to_opencv_and_comes_back_to_calibrate_the_planes_with(tiny_set, tiny_measured, tmp_path):
    assert trisect("export", tiny_measured, "--format", "opencv", "--to", tmp_path / "handed").code == 0
    said = trisect("import-camera", tmp_path / "handed" / "camera_opencv.yml", "--out", tmp_path / "again")
    assert said.code == 0, said.err
    assert "calibrated by another program" in said.out
    ours, theirs = (json.loads((folder / "camera.json").read_text()) for folder in (tiny_measured, tmp_path / "again"))
    assert (theirs["matrix"], theirs["distortion"], theirs["id"]) == (ours["matrix"], ours["distortion"], ours["id"])
    assert trisect("planes", tiny_set, "--out", tmp_path / "again").code == 0


def test_help_of_export_names_every_format():
    from core.files.results.export_list import EXPORTS

    said = re.split(r"[^\w-]+", trisect("export", "--help").out)
    assert [name for name in EXPORTS if name not in said] == []
