"""`trisect study` on the command line: its words in every language, its help, its output."""

import subprocess
import sys

import numpy as np
import pytest

from core.cli import language
from tests.simulated import trisect
from tests.test_cli_language import left_in_english
from tests.test_cli_talk import completed
from tests.test_extras import extras_loaded_by
from tests.wings.studies.grr_tables import AIAG


@pytest.mark.accuracy
def test_no_study_prints_an_untranslated_word(tmp_path):
    cells = [f"{p};{o};{value}\n" for (p, o, _), value in np.ndenumerate(AIAG)]
    (tmp_path / "grr.csv").write_text("part;operator;value\n" + "".join(cells))
    (tmp_path / "repeats.csv").write_text("value;u_mm\n50.01;0.01\n50.02;0.01\n49.99;0.01\n50.0;0.01\n")
    values = 50 + 0.01 * np.random.default_rng(1).standard_normal(40) + 0.1 * (np.arange(40) > 35)
    (tmp_path / "series.csv").write_text("value;u_mm\n" + "".join(f"{one};0.01\n" for one in values))
    limits = ("--nominal", 50, "--tolerance", 0.2)
    commands = [
        ("study", "repeats", tmp_path / "repeats.csv", *limits),
        ("study", "type1", tmp_path / "repeats.csv", *limits, "--resolution", 0.001),
        ("study", "grr", tmp_path / "grr.csv", "--tolerance", 8),
        ("study", "series", tmp_path / "series.csv", *limits),
        ("study", "series", tmp_path / "repeats.csv", *limits),
    ]
    left = {" ".join(map(str, words[:3])): left_in_english(*words) for words in commands}
    assert {command: words for command, words in left.items() if words} == {}


@pytest.mark.parametrize(("name", "shown"), [("thickness", "Dicke"), ("camera", "camera"), ("files", "files")])
def test_a_name_of_ones_own_is_not_translated_though_the_catalogue_has_the_word(tmp_path, name, shown):
    (tmp_path / "repeats.csv").write_text("value;u_mm\n50.01;0.01\n50.02;0.01\n49.99;0.01\n")
    said = trisect("study", "repeats", tmp_path / "repeats.csv", "--characteristic", name, "--language", "de")
    assert said.out.splitlines()[0].split(": ")[1].strip() == shown, said.out
    assert language.text_of("files") == "Dateien"


def test_a_study_that_is_none_is_refused_in_a_sentence():
    assert trisect("study", "x").sentence == 'trisect: there is no command "x"; see trisect study --help.'


def test_a_shell_completes_the_studies_without_numba():
    assert "study" in completed("trisect ")
    assert {"repeats", "grr"} <= set(completed("trisect study "))


def test_a_study_needs_no_extra():
    assert extras_loaded_by("core.wings.studies.studying") == []


def test_the_reader_of_our_output_may_leave_early(tmp_path):
    (tmp_path / "values.csv").write_text("value\n50.01\n50.02\n50.03\n")
    command = [sys.executable, "-m", "core.cli", "study", "repeats", str(tmp_path / "values.csv"), "--json", "--quiet"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    process.stdout.close()
    complaints = process.stderr.read()
    process.stderr.close()
    process.wait(timeout=120)
    assert complaints == b""
