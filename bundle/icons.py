"""Icons as Windows and macOS want them, drawn from the program's own."""

from __future__ import annotations

import sys
from pathlib import Path

from contents import ROOT

SIDE_PX = 1024
"""The largest that macOS asks for."""


def write_icons(folder: Path) -> None:
    """Write the icon of this system's programs into a folder; Linux takes the drawing itself."""
    kind = {"win32": "ico", "darwin": "icns"}.get(sys.platform)
    if kind is None:
        return
    from PIL import Image
    from PySide6.QtGui import QGuiApplication, QIcon

    _app = QGuiApplication(["icons", "-platform", "offscreen"])
    drawn = folder / "icon.png"
    QIcon(str(ROOT / "resources" / "icons" / "trisect.svg")).pixmap(SIDE_PX, SIDE_PX).save(str(drawn))
    Image.open(drawn).save(folder / f"trisect.{kind}")
