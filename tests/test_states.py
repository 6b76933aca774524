"""How far something is and what was decided is told in the same word everywhere, in every language."""

import ast
import re
from typing import get_args

import pytest

from core import states
from core.files.results.check_file import CheckVerdict
from core.inspect.conformity import Verdict
from core.scan.preview.preflight import State as Condition
from tests.code import ROOT, modules, nodes
from tests.translations import all_texts, catalogue
from workbench.step_state import State

pytestmark = pytest.mark.usefixtures("syntax_trees")

TABLES = (states.STEP_STATES, states.CHECKS, states.CONDITIONS, states.DECISIONS)

STEMS = {
    "out of date": {"de": "veraltet", "zh_CN": "过期"},
    "ready": {"de": "bereit", "zh_CN": "就绪"},
    "in doubt": {"de": "zweifelhaft", "zh_CN": "存疑"},
    "not conforming": {"de": "nicht konform", "zh_CN": "不合格"},
    "not proven": {"de": "nicht nachgewiesen", "zh_CN": "未能证明"},
    "accepted": {"de": "angenommen|übernommen|akzept", "zh_CN": "接受"},
    "left out": {"de": "ausgelassen", "zh_CN": "剔除"},
    "not measured": {"de": "nicht gemessen|nicht als .* gemessen", "zh_CN": "未测量|未被测量|未作为.*测得"},
    "interrupted": {"de": "unterbrochen", "zh_CN": "中断"},
    "paused": {"de": "paus", "zh_CN": "暂停"},
}
"""What any text that says a state in English has in the other languages."""

OTHER_WORDS = r"outdated|stale|obsolete|expired|omitted|excluded|skipped|aborted|cancell?ed|halted|up to date|passed"
"""Nobody says a state in these: they are other words for out of date, left out, interrupted, done, in order. In quotes
they are keys in a file."""

NO_STATE = {
    "Make the surface in DIR ready for other programs",
    "may be left out. Control limits",
    "where that predicts views left out better",
    "What is left out is named on the last page",
    "Left out of this report by choice",
}
"""Sentences that have such words and say no state."""


def texts_of(name):
    """English and the translation of every text of a catalogue, of a plural its last form."""
    for entry in catalogue(name):
        if entry.id and entry.string:
            yield tuple(text if isinstance(text, str) else text[-1] for text in (entry.id, entry.string))


@pytest.mark.parametrize("name", ["de", "zh_CN"])
def test_a_state_has_the_same_word_in_every_text_of_a_language(name):
    wrong = [
        (english, told)
        for english, told in texts_of(name)
        for word, stem in STEMS.items()
        if re.search(rf"\b{word}\b", english, re.IGNORECASE)
        and not re.search(stem[name], told, re.IGNORECASE)
        and not any(sentence in english for sentence in NO_STATE)
    ]
    assert wrong == []


def test_that_a_result_is_out_of_date_is_worded_in_one_place():
    """A help text may name the state; what is said of a result that is comes from the table of states."""
    said = {text.path for text in all_texts() if re.search("out of date", text.english[-1], re.IGNORECASE)}
    assert said == {"core/states.py", "workbench/pages/whole.py"}


def test_no_text_says_a_state_in_another_word():
    said = [
        (text.code, text.english) for text in all_texts() if re.search(rf"(?<!\")\b({OTHER_WORDS})\b", text.english[-1])
    ]
    assert said == []


def test_every_state_has_a_word():
    assert set(states.CHECKS) == set(get_args(CheckVerdict))
    assert set(states.CONDITIONS) == set(get_args(Condition))
    assert set(states.STEP_STATES) == set(State)
    assert set(states.DECISIONS) >= set(Verdict)


def test_no_state_has_two_words_and_no_word_has_two_states():
    for table in TABLES:
        assert len(set(table.values())) == len(table)
    for name in ("de", "zh_CN"):
        told = {english: text for english, text in texts_of(name) if any(english in table.values() for table in TABLES)}
        assert len(set(told.values())) == len(told), name


def test_the_words_of_states_stand_in_one_table():
    """Elsewhere a word of the table is told by its key: as a literal it would be forgotten when the table changes."""
    words = {word for table in TABLES for word in table.values()} - {"not known"}  # as a number may be, too
    found = []
    for path in modules("core", "workbench", "trisect"):
        if path == ROOT / "core" / "states.py":
            continue
        for node in nodes(path):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") in ("tr", "label") and node.args:
                said = node.args[0]
                if isinstance(said, ast.Constant) and str(said.value).lower() in words:
                    found.append(f"{path.relative_to(ROOT)}:{node.lineno}: {said.value}")
    assert found == []
