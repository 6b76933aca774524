"""Every text that the code tells is in the catalogues, and none is told past them."""

import ast
import os
import re
import shutil
import subprocess
from collections import Counter
from string import Formatter

import pytest

from core.messages import Message, plural_message
from core.report.wording import Words
from core.translations import PSEUDO, language, languages, preferred, strange
from tests import translations
from tests.code import modules, nodes

pytestmark = pytest.mark.usefixtures("syntax_trees")

OTHERS = [name for name in languages() if name != "en"]


def places(text):
    """What stands in braces, in any order."""
    return Counter((name, spec) for _, name, spec, _ in Formatter().parse(text) if name is not None)


def forms(text):
    return (text,) if isinstance(text, str) else tuple(text or ("",))


def test_the_texts_of_the_code_are_found():
    assert len(list(translations.texts("core/report"))) > 150


def test_a_code_has_one_text():
    told = {}
    for text in translations.texts():
        if text.code:
            told.setdefault(text.code, {}).setdefault(text.english, f"{text.path}:{text.line}")
    assert {code: where for code, where in told.items() if len(where) > 1} == {}


MAKERS = {"core/messages.py", "core/findings/finding.py"}
"""What makes messages of codes and texts that stand elsewhere."""


def test_code_and_text_of_a_message_stand_in_the_call():
    found = []
    for path in modules("core", "workbench", "trisect"):
        for node in nodes(path):
            if isinstance(node, ast.Call) and translations.called(node) in translations.CODED:
                given = (node.args[0], *node.args[translations.CODED[translations.called(node)]])
                if not all(isinstance(one, ast.Constant) for one in given):
                    found.append(path.relative_to(translations.ROOT).as_posix())
    assert {*found} <= MAKERS, "the catalogues cannot have what is put together"


@pytest.mark.parametrize("name", OTHERS)
def test_no_text_lacks_its_translation(name):
    catalog = translations.catalogue(name)
    lacking = []
    for text in translations.texts():
        known = catalog.get(text.english if len(text.english) > 1 else text.english[0], text.code or None)
        if known is None or known.fuzzy or not all(forms(known.string)):
            lacking.append(f"{text.path}:{text.line}: {text.code} {text.english[0]}")
    assert lacking == [], "make translations, then translate them"


@pytest.mark.parametrize("name", OTHERS)
def test_a_catalogue_has_nothing_that_no_code_tells(name):
    told = {(entry.context, forms(entry.id)) for entry in translations.template()}
    kept = {(entry.context, forms(entry.id)) for entry in translations.catalogue(name)}
    assert kept - told == set(), "make translations"


@pytest.mark.parametrize("name", OTHERS)
def test_a_translation_has_the_places_of_the_english_text(name):
    for entry in translations.catalogue(name):
        for told in filter(None, forms(entry.string) if entry.id else ()):
            assert {place for place, _ in places(told)} <= {place for place, _ in places(forms(entry.id)[-1])}, entry.id


def test_places_have_names():
    numbered = [text for text in translations.texts() if re.search(r"\{\d*[:}]", " ".join(text.english))]
    assert numbered == [], "a translator reads the names of the places"


def test_a_language_that_is_asked_for_gets_a_catalogue_of_every_text(tmp_path, monkeypatch):
    monkeypatch.setattr(translations, "FOLDER", tmp_path)
    monkeypatch.setattr("sys.argv", ["translations", "fr"])
    translations.main()
    assert len(translations.catalogue("fr")) == len(translations.template())


@pytest.mark.skipif(shutil.which("make") is None, reason="there is no make")
@pytest.mark.parametrize(
    ("given", "surroundings", "asked"),
    [(("LANGUAGE=fr",), {}, "tests.translations fr"), ((), {"LANGUAGE": "en_GB:en"}, "tests.translations")],
)
def test_make_asks_for_the_language_on_its_command_line_and_not_for_the_readers_own(given, surroundings, asked):
    command = ["make", "--dry-run", "translations", *given]
    surroundings_here = {name: value for name, value in os.environ.items() if not name.startswith("MAKE")}
    done = subprocess.run(
        command,
        cwd=translations.ROOT,
        env={**surroundings_here, **surroundings},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.splitlines()[-1].endswith(f"python -m {asked}")


def test_a_text_that_changed_is_kept_to_be_looked_at():
    old = translations.Catalog(locale="de")
    old.add("old words {a}", "alte Worte {a}", context="x.y")
    old.add("gone", "weg")
    wanted = translations.Catalog()
    wanted.add("new words {a}", context="x.y")
    new = translations.updated(old, wanted)
    entry = new.get("new words {a}", "x.y")
    assert (entry.string, entry.fuzzy, "gone" in new) == ("alte Worte {a}", True, False)


def test_texts_in_calls_within_calls_and_either_way_of_a_condition_are_found():
    source = 'f(Message("a.b", "one {x}", x=[g(Message("a.c", "two")) for _ in y]), tr("three" if z else "four"))'
    found = {(text.code, *text.english) for text in translations.texts_of(ast.walk(ast.parse(source)))}
    assert found == {("a.b", "one {x}"), ("a.c", "two"), ("", "three"), ("", "four")}


def test_german_is_read_with_its_numbers_lists_and_plurals():
    german = language("de")
    assert german(Message("", "{x:.2f}; {names:and}", x=-0.5, names=["a", "b", "c"])) == "−0,50; a, b und c"
    said = [german(plural_message("report.days", "{n:,} day", "{n:,} days", n=n)) for n in (1, 1204)]
    assert said == ["1 Tag", "1\u00a0204 Tage"]
    assert german.label("thickness") == "Dicke"


def test_what_a_language_lacks_is_told_in_english():
    assert Words.of("de")("no such words") == "no such words"
    assert Words.of("de").known("no such words") == "no such words"


def test_a_language_near_to_the_wanted_one_is_taken_and_english_where_there_is_none():
    assert [preferred(wanted) for wanted in (["", "de_CH.UTF-8"], ["xx", "de"], ["xx"], [PSEUDO])] == [
        "de", "de", "en", PSEUDO,
    ]  # fmt: skip


def test_the_pseudo_language_keeps_places_and_what_is_not_read():
    assert strange("<b>{n:.2f}</b> {{of}} &amp; frames") == "⟦<b>{n:.2f}</b> {{óóf}} &amp; fŕáámééš⟧"
    inner = Message("x.inner", "blurred")
    told = language(PSEUDO)(Message("x.y", "view {name}: {reason}", name="view01", reason=inner))
    assert told == "⟦vííééŵ view01: ⟦bļúúŕŕééd⟧⟧"


TELLING = {*translations.CODED, *translations.WORDS_AT, "Command", "Field"}
"""Calls whose texts the catalogues have, and those of what is typed, which is the same in every language."""
FOR_PROGRAMMERS = {
    "ValueError", "TypeError", "RuntimeError", "AssertionError", "KeyError", "NotImplementedError", "AttributeError",
    "BufferError", "EOFError", "OSError", "LinAlgError",
}  # fmt: skip
"""Raised for wrong arguments: nobody who uses the program reads them; nor what is written to a `_log`."""
READ_BY_PEOPLE = (
    "core/model", "core/checks", "core/wings/*/kinds", "core/wings/studies/acceptance_step.py",
    "core/image/targets/kinds.py", "core/image/stripes/stripe.py", "core/calibrate/board_shape.py",
    "core/acquire/drivers/pixel_formats.py", "core/files/stl.py",
)  # fmt: skip
"""Modules whose complaints about wrong values reach people: a `WrongValue` has a message, a `ValueError` none."""
ALLOWED = {
    "core/cli/simulating.py": "what the results of the sample say of their part",
    "core/inspect/causes.py": "what files and plans of earlier versions say",
    "core/files/exchange/dcc.py": "what the file says to other programs",
    "core/files/exchange/e57.py": "what the file says to other programs",
    "core/files/exchange/opencv_calibration.py": "what the file says to other programs",
    "core/wings/geometry/comparison/comparison_file.py": "what the file says to other programs",
    "core/files/results/frame_text.py": "what the file says to other programs",
    "core/files/results/mesh_export.py": "what the file says to other programs",
    "core/files/results/ply.py": "what the file says to other programs",
    "workbench/no_display.py": "names of packages",
    "trisect/start.py": "what is said where the program's own folders are not found, and its translations neither",
    "core/files/project/folder.py": "what the file says that a double click opens",
}
"""Where sentences may stand by themselves, and why."""
WORDS = 4
"""So many words make a sentence."""


def bypassing(of_module):
    """(line, text) of every sentence in a module, given all its nodes, that is told past the catalogues."""
    skipped = set()
    for node in of_module:
        body = getattr(node, "body", None)
        for line in body if isinstance(body, list) else ():
            if isinstance(line, ast.Expr) and isinstance(line.value, ast.Constant):
                skipped.add(line.value)  # a docstring
        if isinstance(node, ast.keyword) and node.arg in translations.DESCRIBED:
            skipped.add(node.value)
        called = node.func if isinstance(node, ast.Call) else None
        logged = isinstance(called, ast.Attribute) and ast.unparse(called.value) == "_log"
        if logged or isinstance(node, ast.Assert):
            skipped |= set(ast.walk(node))
        if isinstance(node, ast.Call) and translations.called(node) in TELLING | FOR_PROGRAMMERS:
            skipped |= {one for argument in node.args for one in ast.walk(argument)}
            if translations.called(node) in FOR_PROGRAMMERS:
                skipped |= set(ast.walk(node))
        if isinstance(node, ast.JoinedStr):
            skipped |= set(node.values)
    for node in of_module:
        if node in skipped:
            continue
        if isinstance(node, ast.JoinedStr):
            text = "".join(part.value if isinstance(part, ast.Constant) else "_" for part in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            text = node.value
        else:
            continue
        if len(re.findall(r"[A-Za-z]{2,}", text)) >= WORDS and len(re.findall(r"\b[A-Za-z]{2,}\b ", text)) >= WORDS - 1:
            yield node.lineno, text


def test_no_sentence_bypasses_the_catalogues():
    found = []
    for path in modules("core", "workbench", "trisect"):
        where = path.relative_to(translations.ROOT).as_posix()
        if not where.startswith(tuple(ALLOWED)):
            found += [f"{where}:{line}: {text}" for line, text in bypassing(nodes(path))]
    assert found == []


def calls(path, *names):
    return (node for node in nodes(path) if isinstance(node, ast.Call) and translations.called(node) in names)


def test_no_error_is_passed_on_as_its_english_text():
    found = []
    for path in modules("core", "workbench", "trisect"):
        told = [call for call in calls(path, "plain", "InputError") if call.args]
        found += [
            f"{path.relative_to(translations.ROOT)}:{call.lineno}"
            for call in told
            if ast.unparse(call.args[0]).startswith("str(")
        ]
    assert found == [], "tell error.what, error.reason or error.message: they are told in the reader's language"


def test_values_that_people_give_are_refused_with_a_message():
    found = []
    for where in READ_BY_PEOPLE:
        places = list(translations.ROOT.glob(where))
        assert places or where.startswith("core/wings/"), "a wing may be taken away, nothing else"
        for path in (path for place in places for path in (place.rglob("*.py") if place.is_dir() else [place])):
            found += [f"{path.relative_to(translations.ROOT)}:{call.lineno}" for call in calls(path, "ValueError")]
    assert found == [], "raise a WrongValue with a Message"
