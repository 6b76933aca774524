import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QGuiApplication

from tests.workbench.clipped import clipped
from workbench.views.lists.data_table import DataTable
from workbench.views.lists.view_list import ListRow, ViewList

LEFT = Qt.MouseButton.LeftButton


def rows(count=4, **changed):
    made = [ListRow(f"view{i}.png", 0.1 * i, f"{0.1 * i:.3f} px") for i in range(1, count + 1)]
    return [changed.get(row.name.removesuffix(".png"), row) for row in made]


@pytest.fixture
def view_list(qtbot):
    view_list = ViewList()
    view_list.resize(350, 300)
    qtbot.addWidget(view_list)
    view_list.set_headers("View", "RMS [px]")
    view_list.set_rows(rows())
    view_list.show()
    qtbot.waitExposed(view_list)
    return view_list


def names(view_list):
    return [row.name.removesuffix(".png") for row in view_list.rows()]


def place(view_list, row, x):
    return QPoint(x, view_list.table.rowViewportPosition(row) + 10)


def test_a_header_wider_than_its_column_ends_with_an_ellipsis_and_one_that_did_not_would_be_seen(view_list):
    view_list.set_headers("View", "Median σ of all points [mm]")
    assert clipped(view_list) == {}
    view_list.table.horizontalHeader().setTextElideMode(Qt.TextElideMode.ElideNone)
    assert set(clipped(view_list)) == {"Median σ of all points [mm]"}


def test_a_header_a_little_wider_than_usual_is_seen_whole(view_list):
    view_list.set_headers("Frame", "Median σ [mm]")
    view_list.table.horizontalHeader().setTextElideMode(Qt.TextElideMode.ElideNone)
    assert clipped(view_list) == {}


def test_a_click_on_the_check_box_tells_and_leaves_the_current_row(qtbot, view_list):
    view_list.set_current("view3.png")
    said = []
    view_list.toggled.connect(lambda *args: said.append(args))
    view_list.toggled_together.connect(lambda *args: said.append(args))
    qtbot.mouseClick(view_list.table.viewport(), LEFT, pos=place(view_list, 1, 12))
    assert said == [("view2.png", False), (("view2.png",), False)]
    assert not view_list.rows()[1].used
    assert view_list.current() == "view3.png"


def test_a_click_on_a_row_goes_to_it(qtbot, view_list):
    with qtbot.waitSignal(view_list.current_changed) as said, qtbot.assertNotEmitted(view_list.toggled):
        qtbot.mouseClick(view_list.table.viewport(), LEFT, pos=place(view_list, 2, 120))
    assert said.args == ["view3.png"]


def test_space_toggles_all_chosen_rows_at_once(qtbot, view_list):
    view_list.set_current("view1.png")
    qtbot.keyClick(view_list.table, Qt.Key.Key_Down, Qt.KeyboardModifier.ShiftModifier)
    with qtbot.waitSignal(view_list.toggled_together) as said:
        qtbot.keyClick(view_list.table, Qt.Key.Key_Space)
    assert said.args == [("view1.png", "view2.png"), False]
    with qtbot.waitSignal(view_list.toggled_together) as said:
        qtbot.keyClick(view_list.table, Qt.Key.Key_Space)
    assert said.args == [("view1.png", "view2.png"), True]


def test_arrows_go_from_row_to_row(qtbot, view_list):
    view_list.set_current("view1.png")
    with qtbot.waitSignal(view_list.current_changed) as said:
        qtbot.keyClick(view_list.table, Qt.Key.Key_Down)
    assert said.args == ["view2.png"]


def test_setting_the_current_row_tells_nobody(qtbot, view_list):
    with qtbot.assertNotEmitted(view_list.current_changed):
        view_list.set_current("view2.png")
        view_list.set_current("never there")
    assert view_list.current() == "view2.png"


def test_new_rows_keep_current_chosen_and_scroll(qtbot, view_list):
    view_list.set_rows(rows(60))
    view_list.set_current("view30.png")
    qtbot.keyClick(view_list.table, Qt.Key.Key_Down, Qt.KeyboardModifier.ShiftModifier)
    view_list.table.verticalScrollBar().setValue(700)
    with qtbot.assertNotEmitted(view_list.current_changed):
        view_list.set_rows(rows(60, view30=ListRow("view30.png", 1.0, "1.000 px", False, "left out by hand")))
        assert view_list.table.verticalScrollBar().value() == 700
        view_list.set_rows(rows(61))
    assert view_list.current() == "view31.png"
    assert view_list.chosen() == ("view30.png", "view31.png")
    assert view_list.table.verticalScrollBar().value() == 700


def test_the_current_row_stays_in_sight_in_a_lower_list_unless_it_was_scrolled_away(qtbot, view_list):
    view_list.resize(350, 900)
    view_list.set_rows(rows(60))
    view_list.set_current("view14.png")
    view_list.resize(350, 300)
    qtbot.waitUntil(lambda: in_sight(view_list))
    view_list.table.verticalScrollBar().setValue(0)
    view_list.resize(350, 250)
    qtbot.wait(20)
    assert view_list.table.verticalScrollBar().value() == 0 and not in_sight(view_list)


def test_a_row_gone_to_before_the_list_has_its_height_is_in_sight_then(qtbot):
    view_list = ViewList()
    qtbot.addWidget(view_list)
    view_list.set_rows(rows(60))
    view_list.set_current("view35.png")
    view_list.resize(350, 300)
    view_list.show()
    qtbot.waitUntil(lambda: in_sight(view_list))


def in_sight(view_list):
    table = view_list.table
    return table.viewport().rect().contains(table.visualRect(table.currentIndex()))


def test_losing_the_current_row_is_told(qtbot, view_list):
    view_list.set_current("view4.png")
    with qtbot.waitSignal(view_list.current_changed) as said:
        view_list.set_rows(rows(2))
    assert said.args == [view_list.current()]


def test_headers_sort_by_name_as_people_do_and_by_value_with_unknown_last(view_list):
    view_list.set_rows([ListRow("v10", 0.1), ListRow("v2", None), ListRow("v1", 0.3)])
    view_list.table.sortByColumn(0, Qt.SortOrder.AscendingOrder)
    assert names(view_list) == ["v1", "v2", "v10"]
    view_list.table.sortByColumn(1, Qt.SortOrder.DescendingOrder)
    assert names(view_list) == ["v1", "v10", "v2"]
    view_list.set_rows([ListRow("v10", 0.5), ListRow("v2", None), ListRow("v1", 0.3)])
    assert names(view_list) == ["v10", "v1", "v2"]
    view_list.table.sortByColumn(-1, Qt.SortOrder.AscendingOrder)
    assert names(view_list) == ["v10", "v2", "v1"]


def test_sorting_keeps_the_current_row(view_list):
    view_list.set_current("view1.png")
    view_list.table.sortByColumn(1, Qt.SortOrder.DescendingOrder)
    assert names(view_list)[0] == "view4"
    assert view_list.current() == "view1.png"


def test_rows_are_drawn_in_every_state(theme, view_list):
    grey, colour = np.zeros((30, 41), dtype=np.uint8), np.zeros((31, 40, 3), dtype=np.uint8)
    view_list.set_rows(
        [
            ListRow("a", 0.1, "0.100 px", True, "", grey),
            ListRow("b", 0.2, "0.200 px", False, "left out by hand", colour, "Second view"),
            ListRow("c", None, "–", False, "no corners were found on this picture, which is very dark"),
            ListRow("d", float("nan"), "–"),
        ]
    )
    view_list.set_current("b")
    for name in ("light", "dark"):
        theme(name)
        view_list.grab()


@pytest.fixture
def table(qtbot):
    table = DataTable()
    qtbot.addWidget(table)
    table.set_headers([("Scan", ""), ("Thickness", "mm"), ("Verdict", "")])
    table.set_rows([["first", "50.01 ± 0.03", "conforming"], ["second", "−0.02", "not proven"]])
    table.show()
    qtbot.waitExposed(table)
    return table


def sides(table, columns):
    texts = (table.table.model().index(0, column).data(Qt.ItemDataRole.TextAlignmentRole) for column in range(columns))
    return [Qt.AlignmentFlag(one) & Qt.AlignmentFlag.AlignHorizontal_Mask for one in texts]


def test_numbers_stand_right_and_words_left(table):
    left, right = Qt.AlignmentFlag.AlignLeft, Qt.AlignmentFlag.AlignRight
    assert sides(table, 3) == [left, right, left]


def test_a_column_without_any_text_stands_left_as_it_does_before_there_are_rows(table):
    table.set_rows([["first", "50.01", ""], ["second", "", ""]])
    assert sides(table, 3)[2] == Qt.AlignmentFlag.AlignLeft


def test_ctrl_c_copies_the_chosen_rows_with_tabs_and_headers(qtbot, table):
    table.set_current_row(1)
    qtbot.keyClick(table.table, Qt.Key.Key_C, Qt.KeyboardModifier.ControlModifier)
    assert QGuiApplication.clipboard().text() == "Scan\tThickness [mm]\tVerdict\nsecond\t−0.02\tnot proven"


def test_all_rows_are_copied_when_none_is_chosen(table):
    table.table.clearSelection()
    assert len(table.copied().split("\n")) == 3


def test_the_row_gone_to_is_told_and_kept(qtbot, table):
    with qtbot.waitSignal(table.current_row_changed) as said:
        table.set_current_row(1)
    assert said.args == [1]
    with qtbot.assertNotEmitted(table.current_row_changed):
        table.set_rows([["first", "1", ""], ["second", "2", ""], ["third", "3", ""]])
    assert table.current_row() == 1
    table.set_rows([])
    assert table.current_row() == -1


def test_a_row_of_another_length_is_refused(table):
    with pytest.raises(ValueError, match="columns"):
        table.set_rows([["only", "two"]])


@pytest.mark.parametrize(("last", "reaches"), [("22.7", False), ("in use", True)])
def test_numbers_do_not_stand_alone_at_the_far_end_of_a_wide_table(qtbot, last, reaches):
    table = DataTable()
    qtbot.addWidget(table)
    table.resize(900, 200)
    table.set_headers([("Source", ""), ("s", "mm"), ("Of T", "%")])
    table.set_rows([("gauge R&R", "0.302", last)])
    table.show()
    qtbot.waitExposed(table)
    header = table.table.horizontalHeader()
    assert (header.length() >= table.table.viewport().width()) is reaches
