"""What is handed over, in words."""

from __future__ import annotations

import pytest

from core.files.results.export_list import exports
from workbench.pages.report.words import export_words
from workbench.theme import icon


@pytest.mark.parametrize("kind", exports())
def test_every_export_has_a_title_a_help_and_an_icon(kind: str, qapp: object) -> None:
    title, help_text, symbol = export_words(kind)
    assert title and help_text and not icon(symbol).isNull()
