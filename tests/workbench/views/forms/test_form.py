import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QKeySequence, QShortcut, QWheelEvent
from PySide6.QtWidgets import QApplication

import workbench.language
from core.translations import language
from workbench.views.forms.editors import NumberRange
from workbench.views.forms.form import SettingsForm


@pytest.fixture
def form(qtbot):
    form = SettingsForm()
    qtbot.addWidget(form)
    form.add_section("Target")
    form.add_choice("kind", "Kind", [("checkerboard", "Checkerboard"), ("charuco", "ChArUco")], "What is printed.")
    form.add_number("columns", "Inner corners across", NumberRange(3, 60), "Along the longer side.")
    form.add_number("square", "Square", NumberRange(0.1, 200, decimals=3, step=0.5, unit="mm"), "One side.")
    form.add_number("air", "Air", NumberRange(-20, 60, decimals=1, unit="°C", none_text="unknown"), "While scanning.")
    form.add_check("constrain", "Keep the angles", "Off: each plane on its own.")
    form.add_text("part", "Part", "On the report.", placeholder="gauge block")
    form.add_multiline("notes", "Notes", "Under Remarks.")
    form.set_values({"columns": 17, "square": 10.0, "air": None, "part": "block", "notes": "", "unknown": 1})
    form.show()
    qtbot.waitExposed(form)
    form.activateWindow()
    form.setFocus()
    return form


@pytest.fixture
def german(monkeypatch):
    monkeypatch.setattr(workbench.language, "_chosen", language("de"))


@pytest.fixture
def told(form):
    told = []
    form.edited.connect(lambda key, value: told.append((key, value)))
    return told


def type_in(qtbot, editor, text):
    editor.setFocus()
    editor.selectAll()
    qtbot.keyClicks(editor, text)


def test_values_come_back_as_they_were_set(form):
    assert form.values() == {
        "kind": "checkerboard",
        "columns": 17,
        "square": 10.0,
        "air": None,
        "constrain": False,
        "part": "block",
        "notes": "",
    }
    assert isinstance(form.values()["columns"], int)


def test_setting_values_tells_nobody(form, told):
    form.set_values({"kind": "charuco", "columns": 9, "air": 20.5, "constrain": True, "part": "x", "notes": "y"})
    assert told == []
    assert form.values()["air"] == 20.5


def test_a_number_is_told_at_enter_and_not_at_each_key(qtbot, form, told):
    editor = form.editor("square")
    type_in(qtbot, editor, "12.5")
    assert told == []
    qtbot.keyClick(editor, Qt.Key.Key_Return)
    assert told == [("square", 12.5)]
    qtbot.keyClick(editor, Qt.Key.Key_Return)
    assert len(told) == 1


def test_a_decimal_comma_is_understood(qtbot, form, told):
    editor = form.editor("square")
    type_in(qtbot, editor, "9,75")
    qtbot.keyClick(editor, Qt.Key.Key_Return)
    assert told == [("square", 9.75)]


def test_a_text_is_told_when_the_focus_leaves(qtbot, form, told):
    editor = form.editor("part")
    type_in(qtbot, editor, "ring")
    assert told == []
    form.editor("square").setFocus()
    qtbot.waitUntil(lambda: bool(told))
    assert told == [("part", "ring")]


def test_several_lines_are_told_when_the_focus_leaves(qtbot, form, told):
    editor = form.editor("notes")
    type_in(qtbot, editor, "a")
    qtbot.keyClick(editor, Qt.Key.Key_Return)
    qtbot.keyClicks(editor, "b")
    assert told == []
    form.editor("square").setFocus()
    qtbot.waitUntil(lambda: bool(told))
    assert told == [("notes", "a\nb")]


def test_steps_by_the_arrows_are_told_once_they_have_ended(qtbot, form, told):
    editor = form.editor("columns")
    for _ in range(3):
        qtbot.keyClick(editor, Qt.Key.Key_Up)
    assert told == []
    qtbot.waitUntil(lambda: bool(told), timeout=2000)
    assert told == [("columns", 20)]


def test_steps_are_not_lost_when_the_form_is_hidden(qtbot, form, told):
    qtbot.keyClick(form.editor("columns"), Qt.Key.Key_Up)
    form.hide()
    assert told == [("columns", 18)]


def test_a_number_may_be_left_empty(qtbot, form, told):
    editor = form.editor("air")
    assert editor.text() == "unknown"
    type_in(qtbot, editor, "21.5")
    qtbot.keyClick(editor, Qt.Key.Key_Return)
    assert told == [("air", 21.5)]
    editor.selectAll()
    qtbot.keyClick(editor, Qt.Key.Key_Delete)
    qtbot.keyClick(editor, Qt.Key.Key_Return)
    assert told[1:] == [("air", None)]
    assert editor.text() == "unknown"


def test_the_smallest_number_is_not_none(form):
    form.set_values({"air": -20.0})
    assert form.values()["air"] == -20.0
    form.set_values({"air": float("nan")})
    assert form.values()["air"] is None


def test_a_choice_and_a_check_are_told_at_once(qtbot, form, told):
    choice = form.editor("kind")
    choice.setFocus()
    qtbot.keyClick(choice, Qt.Key.Key_Down)
    qtbot.keyClick(form.editor("constrain"), Qt.Key.Key_Space)
    assert told == [("kind", "charuco"), ("constrain", True)]


def test_what_is_half_typed_survives_the_same_values_set_again(qtbot, form, told):
    editor = form.editor("part")
    type_in(qtbot, editor, "ri")
    form.set_values({"part": "block"})
    qtbot.keyClicks(editor, "ng")
    qtbot.keyClick(editor, Qt.Key.Key_Return)
    assert told == [("part", "ring")]


@pytest.mark.parametrize("key", ["columns", "kind"])
def test_the_wheel_over_an_editor_without_focus_changes_nothing(form, key):
    form.editor("part").setFocus()
    before = form.values()[key]
    editor = form.editor(key)
    turn = QWheelEvent(
        QPointF(5, 5),
        QPointF(editor.mapToGlobal(QPoint(5, 5))),
        QPoint(),
        QPoint(0, -120),
        Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    QApplication.sendEvent(editor, turn)
    assert form.values()[key] == before
    assert not turn.isAccepted()


def test_units_stand_behind_numbers(form):
    assert form.editor("square").text() == "10.000 mm"


def test_a_complaint_stands_in_place_of_the_help(form, theme):
    form.set_complaint("square", "The square must be larger than 0 mm.")
    assert form.help_of("square") == "The square must be larger than 0 mm."
    theme("dark")
    form.set_complaint("square", "")
    assert form.help_of("square") == "One side."


def test_a_disabled_setting_says_why(form):
    form.set_editable("constrain", False, "Only for fans of three lines.")
    assert not form.editor("constrain").isEnabled()
    assert form.editor("constrain").toolTip() == "Only for fans of three lines."
    form.set_editable("constrain", True)
    assert form.editor("constrain").toolTip() == "Off: each plane on its own."


def test_every_editor_has_a_name_and_a_tooltip(form):
    for key in form.values():
        assert form.editor(key).toolTip()
        assert form.editor(key).accessibleName() or key == "constrain"


@pytest.mark.parametrize("key", ["part", "notes", "square", "air"])
def test_undo_is_the_editors_own_while_something_is_half_typed_and_else_the_windows(form, qtbot, key):
    undone = []
    shortcut = QShortcut(QKeySequence(QKeySequence.StandardKey.Undo), form)
    shortcut.activated.connect(lambda: undone.append("the project"))
    editor = form.editor(key)
    editor.setFocus()
    qtbot.keyClick(editor, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert undone == ["the project"]
    before = form.values()[key]
    type_in(qtbot, editor, "7")
    qtbot.keyClick(editor, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert undone == ["the project"]
    assert form.values()[key] == before
    type_in(qtbot, editor, "7")
    qtbot.keyClick(editor, Qt.Key.Key_Tab)
    assert form.values()[key] != before
    editor.setFocus()
    qtbot.keyClick(editor, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert undone == ["the project", "the project"]


@pytest.mark.parametrize("typed", ["12.25", "12,25"])
def test_numbers_are_shown_in_the_windows_language_and_typed_with_either_sign(german, form, qtbot, typed):
    square = form.editor("square")
    assert square.text() == "10,000 mm"
    type_in(qtbot, square, typed)
    qtbot.keyClick(square, Qt.Key.Key_Return)
    assert (square.text(), form.values()["square"]) == ("12,250 mm", 12.25)


@pytest.mark.parametrize("minus", ["-", "−"])
def test_a_number_below_zero_has_a_true_minus_and_takes_the_keyboards(german, form, qtbot, minus):
    air = form.editor("air")
    air.setFocus()
    air.selectAll()
    air.lineEdit().insert(f"{minus}3,5")  # pasted: no key has a true minus
    qtbot.keyClick(air, Qt.Key.Key_Return)
    assert (air.text(), form.values()["air"]) == ("−3,5 °C", -3.5)
    qtbot.keyClick(air, Qt.Key.Key_Up)
    assert form.values()["air"] == -2.5
