"""± stands for one thing wherever a person reads it: the expanded uncertainty U, or the limits of a tolerance."""

import ast
import re
from dataclasses import replace
from pathlib import Path

import pytest

from core.files.exchange.records import FACT_COLUMNS, fact_row
from core.report.facts.fact import Fact
from core.report.wording import Words
from tests.report.report_samples import block_content

ROOT = Path(__file__).parents[2]
EXPANDED_OR_LIMIT = {"U", "U_shown", "expanded", "uncertainty", "limit", "tolerance"}
"""What texts write after ±; `uncertainty` and `expanded` are the U of a thickness."""


def test_a_standard_uncertainty_is_named_u_and_only_an_expanded_one_follows_the_sign():
    length = Fact("length", 50.00213, "mm", 3)
    assert replace(length, sd=0.0102).text(Words()) == "50.002 mm (u\xa0=\xa00.010 mm)"
    assert replace(length, U=0.0204).text(Words()) == "50.002 ± 0.020 mm"
    assert replace(length, sd=0.0102, U=0.0204).text(Words()) == "50.002 ± 0.020 mm"


def test_tables_for_other_programs_have_u_and_U_in_columns_of_their_own():
    standard, expanded = (fact_row("camera", fact, Words()) for fact in (Fact("α", 1.0, sd=0.1), Fact("h", 1.0, U=0.2)))
    assert (standard["u"], standard["U"]) == (0.1, None) and (expanded["u"], expanded["U"]) == (None, 0.2)
    assert tuple(standard) == FACT_COLUMNS


def test_every_fact_of_a_report_has_the_sign_for_U_alone():
    facts = [fact for facts in block_content().facts.values() for fact in facts]
    signed = {fact.text(Words()): fact for fact in facts if "±" in fact.text(Words())}
    permitted = {text for text, fact in signed.items() if text.startswith("±")}
    assert all(signed[text].U is not None for text in signed.keys() - permitted)
    assert any(fact.sd is not None for fact in facts) and any(fact.U is not None for fact in facts)


@pytest.mark.parametrize("room", ["core", "workbench", "trisect"])
def test_no_text_of_the_program_writes_a_standard_uncertainty_after_the_sign(room):
    found = set()
    for path in (ROOT / room).rglob("*.py"):
        texts = (one.value for one in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(one, ast.Constant))
        found |= {
            (path.name, name)
            for text in texts
            if isinstance(text, str)
            for name in re.findall(r"±[ \xa0]?\{(\w+)", text)
            if name not in EXPANDED_OR_LIMIT
        }
    assert not found
