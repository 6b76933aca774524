"""The wheel scrolls; it changes no field that was not chosen before."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import QAbstractSlider, QAbstractSpinBox, QApplication, QComboBox, QScrollBar, QWidget

from core.files.project.data import new_project
from tests.workbench.test_fit import window_in
from workbench.bench import Bench
from workbench.steps import STEPS


def fields(window: QWidget) -> list[Any]:
    """Every field that the wheel could change."""
    kinds = (QComboBox, QAbstractSpinBox, QAbstractSlider)
    found = [one for kind in kinds for one in window.findChildren(kind) if not isinstance(one, QScrollBar)]
    return [one for one in found if one.parentWidget() is not None]


def said(field: Any) -> object:
    """What a field shows."""
    return field.currentIndex() if isinstance(field, QComboBox) else getattr(field, "value", lambda: None)()


def turned(field: QWidget) -> QWheelEvent:
    """One notch of the wheel over it."""
    middle = QPointF(field.rect().center())
    none = Qt.MouseButton.NoButton, Qt.KeyboardModifier.NoModifier
    return QWheelEvent(
        middle, QPointF(field.mapToGlobal(middle.toPoint())), QPoint(), QPoint(0, -120), *none,
        Qt.ScrollPhase.NoScrollPhase, False,
    )  # fmt: skip


def test_the_wheel_over_a_field_of_any_page_changes_nothing_and_chooses_nothing(
    bench: Bench, qapp: QApplication, qtbot: Any, tmp_path: Any
) -> None:
    with window_in("en", bench, qapp, qtbot) as window:
        bench.model.create(tmp_path / "project", new_project("Block"))
        for step in STEPS:
            window.go_to(step.name)
            qtbot.wait(10)
        found = fields(window)
        assert len(found) > 20
        for field in found:
            name = f"{type(field).__name__} {field.accessibleName()}"
            assert not field.focusPolicy() & Qt.FocusPolicy.WheelFocus.value & ~Qt.FocusPolicy.StrongFocus.value, name
            before = said(field)
            QApplication.sendEvent(field, turned(field))
            assert said(field) == before, name
