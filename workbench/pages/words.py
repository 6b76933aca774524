"""How pages write values, the same everywhere: numbers with their units, a dash for what is not known."""

from __future__ import annotations

import math
from collections.abc import Iterable

from core.messages import decimals_of
from core.report.facts.fact import Fact, Reader, for_reader, heading
from core.report.facts.table import FactTable
from core.report.wording import Words
from workbench.language import chosen, number
from workbench.views.lists.data_table import DataTable
from workbench.views.lists.value_rows import ValueRow, ValueRows


def length(value: float, unit: str, digits: int = 3) -> str:
    """Write a length with its unit, "px" or "mm", to `digits` decimals; a dash for NaN."""
    return "–" if math.isnan(value) else f"{number(value, f'.{digits}f')} {unit}"


def px(value: float) -> str:
    """Write a length in pixels with its unit; a dash for NaN."""
    return length(value, "px")


def mm(value: float, digits: int = 3) -> str:
    """Write a length in millimetres with its unit, to `digits` decimals; a dash for NaN."""
    return length(value, "mm", digits)


def sigma(value_mm: float) -> str:
    """Write a standard uncertainty in millimetres, to two significant digits."""
    return mm(value_mm, max(decimals_of(value_mm), 0))


def degrees(value: float, digits: int = 3) -> str:
    """Write an angle given in rad in degrees, to `digits` decimals."""
    return f"{number(math.degrees(value), f'.{digits}f')}°"


def percent(share: float) -> str:
    """Write a share (0 … 1) in percent."""
    return f"{number(100 * share, '.0f')} %"


def count(number: int) -> str:
    """Write an integer with thin spaces between thousands."""
    return f"{number:,}".replace(",", "\u2009")


def wording() -> Words:
    """Return the words and number formats of the reports in the window's language."""
    return Words(chosen())


def show_facts(rows: ValueRows, facts: Iterable[Fact], tables: Iterable[FactTable] = ()) -> None:
    """Show facts in rows: those for a technician in sight, all others and the `tables` folded."""
    facts, words = tuple(facts), wording()
    in_sight = [fact_row(fact) for fact in facts if fact.level == Reader.TECHNICIAN]
    folded = [fact_row(fact) for fact in facts if fact.level > Reader.TECHNICIAN]
    lines: list[ValueRow] = [(heading(name), text, "", "") for table in tables for name, text in table.lines(words)]
    rows.set_rows(in_sight, folded + lines)


def fact_lines(facts: Iterable[Fact]) -> str:
    """Write the facts meant for a technician as text, one line each."""
    words = wording()
    return "\n".join(
        words("{name}: {value}", name=fact.heading(words), value=fact.text(words))
        for fact in for_reader(facts, Reader.TECHNICIAN)
    )


def fact_row(fact: Fact) -> ValueRow:
    """Convert a fact to a row of label, value, tooltip and level."""
    words = wording()
    return fact.heading(words), fact.text(words), words.known(fact.tip), fact.grade


def show_table(shown: DataTable, table: FactTable) -> None:
    """Show a table of facts, without the columns meant for metrologists only."""
    words, table = wording(), table.for_reader(Reader.AUDITOR)
    shown.set_headers([(heading(words.known(one.label)), one.unit, words.known(one.tip)) for one in table.columns])
    shown.set_rows(table.texts(words))
