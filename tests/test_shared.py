"""What tests share."""

import pytest

from tests.shared import ENOUGH, each_once


@pytest.mark.parametrize(("kinds", "least", "pairs"), [("abc", 3, "a1 b2 c1"), ("ab", ENOUGH, "a1 b2 a2 b1 a1")])
def test_each_kind_is_tried_once_and_as_many_sets_as_a_claim_needs(kinds, least, pairs):
    assert " ".join(f"{kind}{seed}" for kind, seed in each_once(kinds, (1, 2), least)) == pairs


def test_seeds_go_on_where_kinds_begin_anew():
    found = each_once("abc", (1, 2))
    assert len(set(found)) == len(found) == ENOUGH
