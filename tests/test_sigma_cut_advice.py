"""Advice to raise the σ cut names the option on the command line, and only there."""

import pytest

from core.inspect.fit.spanned import faces_not_spanned
from core.messages import ENGLISH, Message
from core.scan.reconstruct import LOCATE_BETTER
from workbench.language import text_of


@pytest.mark.parametrize("advice", [LOCATE_BETTER, faces_not_spanned([Message("gauge.top", "the top")])])
def test_raising_the_cut_comes_with_its_option(advice):
    assert "σ cut: --sigma-cut MM" in ENGLISH(advice)
    assert "σ cut" in text_of(advice) and "--sigma-cut" not in text_of(advice)
