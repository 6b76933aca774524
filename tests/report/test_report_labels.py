"""Every fixed word of a report is in every language."""

import ast
import re
from pathlib import Path

import pytest

import core.report
from core.report.calibration_tables import KINDS
from core.report.language import TABLES, Words
from core.report.section_names import SECTIONS
from core.report.studies import TITLES
from core.report.template import LANGUAGES
from core.report.wording import VERDICTS

FOLDER = Path(core.report.__file__).parent
WORDS_AT = {"words": slice(0, 1), "say": slice(0, 1), "section": slice(2, 3), "heads": slice(1, None),
            "count": slice(1, 2)}  # fmt: skip
"""Calls that take fixed words, and which of their arguments those are."""


def literals(argument):
    """The texts that an argument can be."""
    if isinstance(argument, ast.IfExp):
        return literals(argument.body) + literals(argument.orelse)
    return [argument.value] if isinstance(argument, ast.Constant) and isinstance(argument.value, str) else []


def fixed_words():
    """Every text that the report's modules hand to a language, by the module."""
    found = {}
    for path in sorted(FOLDER.glob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            name = getattr(getattr(node, "func", None), "attr", getattr(getattr(node, "func", None), "id", ""))
            if isinstance(node, ast.Call) and name in WORDS_AT:
                for argument in node.args[WORDS_AT[name]]:
                    for text in filter(None, literals(argument)):
                        found[text] = path.name
                        if name == "count":
                            found[f"{text}s"] = path.name
    return found


def test_the_modules_words_are_found():
    assert len(fixed_words()) > 130


@pytest.mark.parametrize("language", [language for language in LANGUAGES if language != "en"])
def test_no_label_lacks_a_language(language):
    table = TABLES[language]
    assert {text: path for text, path in fixed_words().items() if text not in table} == {}
    for constants in (SECTIONS, VERDICTS, TITLES, KINDS):
        assert set(constants.values()) <= set(table)


@pytest.mark.parametrize("table", TABLES.values(), ids=TABLES.keys())
def test_a_translation_has_the_same_places_to_fill(table):
    for english, other in table.items():
        assert sorted(re.findall(r"{\w+}", english)) == sorted(re.findall(r"{\w+}", other)), english
        assert other.strip()


def test_a_word_that_a_language_lacks_is_an_error_and_a_foreign_sentence_is_not():
    with pytest.raises(KeyError):
        Words("de")("no such words")
    assert Words("de").known("no such words") == "no such words"
    assert Words("de").known("thickness") == "Dicke"
