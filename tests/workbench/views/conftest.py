from collections.abc import Callable, Iterator

import pytest
from PySide6.QtWidgets import QApplication

from workbench.theme import apply_theme


@pytest.fixture
def theme(qapp: QApplication) -> Iterator[Callable[[str], None]]:
    """Dresses the application for this test alone."""
    style, palette, sheet = qapp.style().objectName(), qapp.palette(), qapp.styleSheet()
    yield lambda name: apply_theme(qapp, name)
    qapp.setStyleSheet(sheet)
    qapp.setStyle(style)
    qapp.setPalette(palette)
