"""What the command line prints is in the reader's language: `--language`, TRISECT_LANGUAGE, or the locale."""

import json
import re
import shutil

import pytest

from core.cli import language
from core.cli.app import whole_command
from core.cli.simulating import HELP_VALUES
from core.files.project.data import ProjectFile, new_project
from core.files.project.folder import create_project
from core.translations import PSEUDO
from tests.report.test_report_pseudo import outside_brackets
from tests.simulated import CUT, trisect

SAME_EVERYWHERE = re.compile(
    r"(/[\w.\-/…]+)+|[\w.\-]+\.(png|json|toml|pdf|csv|ply|stl|trisectz)\b|[0-9a-f]{6,}|E_n|ndc|Cgk?|ANOVA|RMS|RMSE|trisect|"
    r"frame\d+|view\d+|pose\d+|alpha|beta|gamma"
)
"""Paths, names of files, hashes, symbols."""
FOLDERS = {"camera", "planes", "scan"}
"""Of a recording set, as `import` names them."""


@pytest.fixture(autouse=True)
def no_language_of_this_computer(monkeypatch):
    for name in ("TRISECT_LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG"):
        monkeypatch.delenv(name, raising=False)
    yield
    language.choose([])


def left_in_english(*words):
    """The words that a command prints in the pseudo-language outside its brackets: they are in no catalogue."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("TRISECT_LANGUAGE", PSEUDO)
        said = trisect(*words)
    assert said.code in (0, 1), said.err
    text = outside_brackets(SAME_EVERYWHERE.sub(" ", f"{said.out}\n{said.err}"))
    assert "⟦" in said.out + said.err
    return set(re.findall(r"[^\W\d_]{3,}", text))


@pytest.mark.parametrize(
    "step",
    ["gauge", *(pytest.param(step, marks=pytest.mark.accuracy) for step in ("camera", "planes", "scan", "report"))],
)
def test_no_step_of_a_measurement_prints_an_untranslated_word(simulated, measured, tmp_path, step):
    out = shutil.copytree(measured, tmp_path / "out")
    assert left_in_english(step, simulated, "--out", out, *(CUT if step == "scan" else ())) == set()


@pytest.mark.accuracy
def test_no_other_command_prints_an_untranslated_word(simulated, measured, tmp_path):
    out = shutil.copytree(measured, tmp_path / "out")
    project = tmp_path / "project"
    create_project(project, ProjectFile(new_project("2026")))
    commands = [
        ("mesh", out, "--format", "stl", "--fill-holes", 2, "--triangles", 900),
        ("export", out, "--format", "csv,json"),
        ("target", "--out", tmp_path / "target.pdf", "charuco"),
        ("import", tmp_path / "new", "--camera", simulated / "camera", "--dry-run"),
        ("import", tmp_path / "new", "--camera", simulated / "camera"),
        ("check", simulated, "--out", out, "--history"),
        ("pack", project, "--out", tmp_path / "p.trisectz"),
        ("unpack", tmp_path / "p.trisectz", "--out", tmp_path / "again"),
    ]
    left = {
        " ".join(map(str, words[:2])): left_in_english(*words) - (FOLDERS if words[0] == "import" else set())
        for words in commands
    }
    assert {command: words for command, words in left.items() if words} == {}


def words_of(*texts):
    return re.findall(r"[^\W\d_]{3,}", " ".join(texts))


def test_all_help_is_in_the_catalogues():
    language.choose([language.OPTION, PSEUDO])
    command = language.speak(whole_command()[0], HELP_VALUES)
    texts = [
        text for one in language._all_of(command) for text in (one.help, one.epilog, *(p.help for p in one.params))
    ]
    assert len(texts) > 250
    assert [text for text in texts if text and not text.startswith("⟦")] == []


def commands(found, *path):
    """What is typed for each command and each group of commands, and what Typer knows of it."""
    yield path, found
    for name, one in getattr(found, "commands", {}).items():
        yield from commands(one, *path, name)


def typed_alike(command):
    """Words that are typed, or stand for what is typed, in every language."""
    for one in command.params:
        choices = one.type_descriptor.choices or ()
        yield from (*one.opts, *one.secondary_opts, one.metavar or "", *(choice.value for choice in choices))
        yield str(getattr(one.default, "value", one.default))
    everywhere = ("--quiet", "-q", "--verbose", "-v", "--language", "CODE", "--help", "-h")
    yield from (*getattr(command, "commands", ()), *everywhere)


@pytest.mark.parametrize(
    ("path", "command"), [pytest.param(*one, id=" ".join(one[0])) for one in commands(whole_command()[0])]
)
def test_no_help_has_an_untranslated_word(monkeypatch, path, command):
    monkeypatch.setenv("COLUMNS", "300")  # in narrow columns a word is broken in two
    said = trisect(*path, "--help", "--language", PSEUDO)
    assert (said.code, said.out.count("⟦") > 5) == (0, True)
    words = set(re.findall(r"[^\W\d_][\w.\-/]+", outside_brackets(said.out)))
    alike = {word for text in typed_alike(command) for word in re.findall(r"[^\W\d_][\w.\-/]+", text)}
    assert words - alike - {"trisect", *path} == set()


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("scann",), 'there is no command "scann"; perhaps you mean scan.'),
        (("--language", "en"), "a command is missing; see trisect --help."),
        (("scan",), "SET is missing; see trisect scan --help."),
        (("scan", "set"), "--out is missing; see trisect scan --help."),
        (("scan", "my", "set", "--out", "dir"), 'there is no place for "set"; see trisect scan --help.'),
        (("scan", "--methd", "network"), "there is no option --methd; perhaps you mean --method."),
        (("scan", "--qqq"), "there is no option --qqq; see trisect scan --help."),
        (("scan", "set", "--out"), "--out: needs a value."),
        (("scan", "set", "--profile=4"), "--profile: takes no value."),
        (("scan", "set", "--method", "magic"), '--method: there is no "magic"; choose among network, three-crossings.'),
        (("scan", "set", "--sigma-cut", "fine"), '--sigma-cut: "fine" is no number; see trisect scan --help.'),
        (("target", "--columns", "3.5"), '--columns: "3.5" is no whole number; see trisect target --help.'),
    ],
)
def test_a_wrong_command_line_is_told_in_one_sentence_in_each_language(monkeypatch, words, sentence):
    said = trisect(*words)
    assert (said.code, said.out, said.sentence) == (2, "", f"trisect: {sentence}")
    if "--language" not in words:
        monkeypatch.setenv("TRISECT_LANGUAGE", PSEUDO)
        said = trisect(*words)
        left = set(re.findall(r"[^\W\d_]{2,}", outside_brackets(said.err)))
        assert (said.code, left <= {"trisect", *re.findall(r"\w+", " ".join(words))}) == (2, True), said.err


def test_a_wrong_command_line_is_told_to_programs_too():
    told = json.loads(trisect("scan", "--json").out)
    assert (told["code"], told["values"]) == ("cli.missing", {"name": "SET"})


def test_every_command_stands_under_a_heading_that_says_what_it_is_for():
    assert [path for path, one in commands(whole_command()[0]) if len(path) == 1 and not one.rich_help_panel] == []
    said = trisect("--help", "--language", "de")
    headings = ["Ein Teil messen", "Den Aufbau kalibrieren und prüfen", "Berichte, Studien, andere Programme"]
    assert [heading for heading in headings if f"─ {heading} ─" not in said.out] == []


def test_chinese_help_is_not_cut_at_the_end_of_a_line():
    said = trisect("check", "--language", "zh_CN", "--help").out
    assert ("相机和激光器" in said, "…" in said) == (True, False)


@pytest.mark.parametrize(
    ("surroundings", "words", "expected"),
    [
        ({"LC_ALL": "C", "LANG": "de_DE.UTF-8"}, (), "there is no such folder"),
        ({"LANG": "de_CH.UTF-8"}, (), "diesen Ordner gibt es nicht"),
        ({"LC_ALL": "zh_CN.UTF-8"}, (), "没有这个文件夹"),
        ({"LC_ALL": "zh_CN.UTF-8", "TRISECT_LANGUAGE": "de"}, (), "diesen Ordner gibt es nicht"),
        ({"LANG": "de_DE.UTF-8"}, ("--language", "en"), "there is no such folder"),
        ({}, ("--language=zh_CN",), "没有这个文件夹"),
    ],
)
def test_a_refusal_is_told_in_the_language_asked_for_and_else_in_that_of_the_locale(
    monkeypatch, tmp_path, surroundings, words, expected
):
    for name, value in surroundings.items():
        monkeypatch.setenv(name, value)
    said = trisect("gauge", tmp_path / "none", "--out", tmp_path, *words)
    assert (said.code, expected in said.err) == (2, True), said.err


def test_an_unknown_language_is_refused_with_those_there_are(tmp_path):
    said = trisect("gauge", tmp_path, "--out", tmp_path, "--language", "fr")
    assert (said.code, said.sentence) == (2, 'trisect: --language: there is no "fr"; choose among en, de, zh_CN.')


def test_json_is_the_same_in_every_language(simulated, measured, tmp_path):
    out = shutil.copytree(measured, tmp_path / "out")
    told = [
        json.loads(trisect("gauge", simulated, "--out", out, "--json", "--language", name).out) for name in ("en", "de")
    ]
    assert told[0] == told[1]
    refused = [
        trisect("gauge", tmp_path / "none", "--out", out, "--json", "--language", name).out for name in ("en", "de")
    ]
    assert refused[0] == refused[1]
