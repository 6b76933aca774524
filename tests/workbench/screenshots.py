"""Pictures of every page for people to look at: python -m tests.workbench.screenshots FOLDER [--readme].

With --readme only the four that the README shows, small (make pictures).
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from PIL import Image
from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QImage, QPainter
from PySide6.QtWidgets import QApplication

from workbench.app import Application, build_window
from workbench.bench import Bench, make_bench
from workbench.main_window import MainWindow
from workbench.settings import AppSettings
from workbench.steps import STEPS

SIZES = (QSize(1280, 800), QSize(1920, 1080))
THEMES = ("light", "dark")
README = ("camera", "scan", "inspect", "report")
README_WIDTH = 900


def main() -> int:
    """Write welcome and all pages of the finished sample in both sizes and themes."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "screenshots")
    folder.mkdir(parents=True, exist_ok=True)
    app = Application(sys.argv[:1])
    with tempfile.TemporaryDirectory() as home:
        bench = make_bench(AppSettings(Path(home) / "settings.ini"))
        bench.settings.projects_folder = Path(home) / "projects"
        window = build_window(app, bench, "light")
        window.show()
        try:
            (_readme if "--readme" in sys.argv else _all)(app, bench, window, folder)
        finally:
            window.close()
    return 0


def _all(app: QApplication, bench: Bench, window: MainWindow, folder: Path) -> None:
    _each(app, bench, window, folder, "0-welcome")
    window.doors.open_sample()
    _wait(app, lambda: window.model.is_open and not bench.measuring.busy, 300)
    for number, step in enumerate(STEPS, start=1):
        window.go_to(step.name)
        _settle(app, bench, 2.0)
        _each(app, bench, window, folder, f"{number}-{step.name}")


def _readme(app: QApplication, bench: Bench, window: MainWindow, folder: Path) -> None:
    """The README's pictures: few colours are enough, and keep them small."""
    window.resize(SIZES[0])
    window.doors.open_sample()
    _wait(app, lambda: window.model.is_open and not bench.measuring.busy, 300)
    for name in README:
        window.go_to(name)
        _settle(app, bench, 8.0)
        small = grab(window).scaledToWidth(README_WIDTH, Qt.TransformationMode.SmoothTransformation)
        path = folder / f"{name}.png"
        small.save(str(path))
        with Image.open(path) as picture:
            flat = picture.convert("RGB").quantize(128, dither=Image.Dither.NONE)
        flat.save(path, optimize=True)


def _each(app: QApplication, bench: Bench, window: MainWindow, folder: Path, name: str) -> None:
    for theme in THEMES:
        bench.settings.theme = theme
        for size in SIZES:
            window.resize(size)
            _settle(app, bench, 0.7)
            path = folder / f"{name}-{theme}-{size.width()}x{size.height()}.png"
            grab(window).save(str(path))


def grab(window: MainWindow) -> QImage:
    """The window as it is on the screen, 3D views included (they draw themselves, past Qt)."""
    screen = window.screen()
    shot = screen.grabWindow(window.winId()) if QApplication.platformName() == "xcb" else window.grab()
    image = shot.toImage().convertToFormat(QImage.Format.Format_RGB32)
    flat = QImage(image.size(), QImage.Format.Format_RGB32)
    painter = QPainter(flat)
    painter.drawImage(0, 0, image)
    painter.end()
    return flat


def _settle(app: QApplication, bench: Bench, seconds: float) -> None:
    until = time.monotonic() + seconds
    _wait(app, lambda: time.monotonic() > until and not bench.quick.busy, 30)


def _wait(app: QApplication, done: Callable[[], bool], seconds: float) -> None:
    until = time.monotonic() + seconds
    while not done():
        if time.monotonic() > until:
            raise TimeoutError("the window did not get there")
        app.processEvents()
        time.sleep(0.01)


if __name__ == "__main__":
    sys.exit(main())
