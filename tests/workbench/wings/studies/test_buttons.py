"""What can be done with studies, by what holds of them."""

from itertools import product

import pytest

from tests.workbench.pages.inspect.test_buttons import BOOLS, WHY, are_sentences
from workbench.wings.studies.studies import StudiesFacts, studies_buttons

STUDIES = [StudiesFacts(*v) for v in product(("", "Reading the table"), WHY, WHY, BOOLS, BOOLS)]


@pytest.mark.parametrize("facts", STUDIES, ids=str)
def test_studies_are_made_one_at_a_time_and_of_something(facts: StudiesFacts) -> None:
    can = studies_buttons(facts)
    assert are_sentences(can)
    free, kept = not facts.busy, not (facts.busy or facts.cannot_write)
    assert (can.begin == "") == kept, "what cannot be kept is not begun"
    assert (can.type1 == "") == (kept and not facts.no_type1)
    assert (can.make == "") == (kept and facts.rows)
    assert (can.remove == "") == (can.export == "") == (free and facts.chosen)
    assert (can.read == "") == free
    if facts.busy:
        assert can.read == "Wait for what is under way: Reading the table.", "it is named"
