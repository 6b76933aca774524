"""A list of views: its rows have room for all that is said of them."""

import pytest

from workbench.views.lists.view_list import ListRow, ViewList

WHY = "left out: the target is covered by a hand, and more than half of its corners are not seen in this picture"


@pytest.fixture
def shown(qtbot):
    views = ViewList()
    qtbot.addWidget(views)
    views.resize(320, 400)
    views.show()
    views.set_rows([ListRow("view00.png"), ListRow("view01.png", used=False, reason=WHY), ListRow("view02.png")])
    return views


def heights(views):
    return [views.table.rowHeight(place) for place in range(3)]


def test_a_row_is_as_high_as_why_it_was_left_out(shown):
    first, second, third = heights(shown)
    assert first == third
    area = shown.table.columnWidth(0)
    assert second > first + shown.fontMetrics().horizontalAdvance(WHY) // area * shown.fontMetrics().height() // 2


def test_with_room_in_one_line_it_is_as_high_as_any_other(shown, qtbot):
    shown.resize(2000, 400)
    qtbot.waitUntil(lambda: len(set(heights(shown))) == 1)


def test_the_room_goes_where_the_row_goes(shown):
    first, second, _ = heights(shown)
    shown.set_rows([ListRow("view01.png", used=False, reason=WHY), ListRow("view00.png"), ListRow("view02.png")])
    assert heights(shown) == [second, first, first]
    shown.set_rows([ListRow("view01.png"), ListRow("view00.png"), ListRow("view02.png")])
    assert len(set(heights(shown))) == 1
