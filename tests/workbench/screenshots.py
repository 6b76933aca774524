"""Pictures of every page for people to look at: python -m tests.workbench.screenshots FOLDER [--language de].

With --switched the window starts in English and the other theme, shows every page, and is switched while it runs, to
one language after the other.
With --readme only those that README and manual show, small (make pictures). QT_SCALE_FACTOR=2 makes them at twice the
size, on a screen of 3840 x 2160.
"""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import numpy as np
from PIL import Image
from PySide6.QtCore import QPoint, QSize, Qt
from PySide6.QtGui import QImage, QPainter
from PySide6.QtWidgets import QApplication, QScrollArea, QWidget

from core.files.results.mesh_export import write_stl
from core.inspect.conformity import Limits
from core.inspect.plan.feature_spec import Auto, Deviation, FeatureSpec, Section
from core.inspect.plan.inspection_plan import InspectionPlan
from core.scan.surface.fused_surface import Mesh
from core.simulate.scene.objects import gauge_block
from core.translations import PSEUDO, language, languages
from tests.wings.studies.grr_tables import AIAG
from tests.wings.studies.spc_tables import PISTON_RINGS
from tests.workbench.tabs import tab_titled
from workbench.app import Application, build_window, speak
from workbench.bench import Bench, make_bench
from workbench.language import choose
from workbench.main_window import MainWindow
from workbench.pages.report.stage import Stage
from workbench.settings import AppSettings
from workbench.steps import STEPS
from workbench.theme import is_polishing

SIZES = (QSize(960, 540), QSize(1000, 700), QSize(1280, 800), QSize(1920, 1080))
THEMES = ("light", "dark")
README = ("project", "camera", "planes", "scan", "inspect", "report")
README_SIZE, README_WIDTH = QSize(1280, 800), 900
PATIENCE_S = 600.0
TURNS = 5
"""Of the event loop before a picture, however long one of them took: a panel that grows has others laid out anew."""
NOMINAL = "block.stl"
PLAN = InspectionPlan(
    (
        FeatureSpec("block", "thickness", limits=(("thickness", Limits(50.0, -0.2, 0.2)),)),
        FeatureSpec("table", "plane", (Auto(1),)),
        FeatureSpec("top", "plane", (Auto(2),), limits=(("flatness", Limits(0.0, -math.inf, 0.1)),)),
        FeatureSpec("middle", "point", (Auto(2),)),
        FeatureSpec("height", "distance", of=("middle", "table")),
        FeatureSpec("flank", "plane", (Auto(3),)),
        FeatureSpec(
            "top to table", "parallelism", of=("top", "table"), limits=(("parallelism", Limits(0.0, -math.inf, 0.1)),)
        ),
        FeatureSpec("flank to table", "perpendicularity", of=("flank", "table")),
        FeatureSpec("profile", "section", section=Section(((300.0, 820.0), (1600.0, 820.0)))),
        FeatureSpec("nominal", "deviation", deviation=Deviation(NOMINAL, tolerance_mm=0.1)),
    )
)
"""Measured on the sample before its pictures are taken."""


def main() -> int:
    """Write welcome and all pages of the finished sample in all sizes and themes."""
    parser = argparse.ArgumentParser(prog="python -m tests.workbench.screenshots", description=__doc__)
    parser.add_argument("folder", nargs="?", type=Path, default=Path("screenshots"))
    parser.add_argument("--readme", action="store_true", help="only those that README and manual show")
    parser.add_argument("--language", nargs="+", choices=(*languages(), PSEUDO), default=["en"])
    parser.add_argument("--theme", choices=THEMES, help="only this one, and the window starts so")
    parser.add_argument("--switched", action="store_true", help="language and theme change when every page was shown")
    parser.add_argument("--sizes", nargs="+", type=_size, default=SIZES, metavar="WIDTHxHEIGHT")
    given = parser.parse_args()
    wanted = _Wanted(given.folder, (given.theme,) if given.theme else THEMES, tuple(given.sizes))
    if len(given.language) > 1 and not given.switched:
        parser.error("several languages want --switched")
    wanted.folder.mkdir(parents=True, exist_ok=True)
    app = Application(sys.argv[:1])
    choose(language("en" if given.switched else given.language[0]), app)
    before = wanted.themes[-1] if len(wanted.themes) > 1 else next(one for one in THEMES if one != wanted.themes[0])
    with tempfile.TemporaryDirectory() as home:
        bench = make_bench(AppSettings(Path(home) / "settings.ini"))
        bench.settings.projects_folder = Path(home) / "projects"
        bench.settings.theme = before if given.switched else wanted.themes[0]
        window = build_window(app, bench)
        window.show()
        try:
            if given.readme:
                _readme(app, bench, window, wanted.folder)
            elif given.switched:
                _open_sample(app, bench, window)
                for name in given.language:
                    window = _switched(app, bench, window, name)
                    _all(app, bench, window, replace(wanted, prefix=f"{name}-"))
            else:
                _each(app, bench, window, wanted, "0-welcome")
                _open_sample(app, bench, window)
                _all(app, bench, window, wanted)
        finally:
            bench.close()
            window.leave()
            bench.wait_until_closed()
    return 0


@dataclass(frozen=True)
class _Wanted:
    """Where the pictures go, and which."""

    folder: Path
    themes: tuple[str, ...]
    sizes: tuple[QSize, ...]
    prefix: str = ""
    """Of the names of the files."""


def _size(text: str) -> QSize:
    return QSize(*map(int, text.split("x")))


def _switched(app: QApplication, bench: Bench, window: MainWindow, name: str) -> MainWindow:
    """The window that takes this one's place for another language, once every page of this one was shown."""
    for step in STEPS:
        window.go_to(step.name)
        _settle(app, bench, 1.0)
    new: list[MainWindow] = []

    def put() -> MainWindow:
        new.append(build_window(app, bench))
        new[0].show()
        return new[0]

    speak(app, window, name, put)
    _wait(app, lambda: bool(new) and bool(new[0].current), PATIENCE_S)
    return new[0]


def _all(app: QApplication, bench: Bench, window: MainWindow, wanted: _Wanted) -> None:
    for number, step in enumerate(STEPS, start=1):
        window.go_to(step.name)
        if step.name == "report":
            _make_report(app, window)
        _settle(app, bench, 2.0)
        _drawn(app, bench, window, step.name)
        if step.name == "inspect":
            for name in _inspect_tabs(app, bench, window):
                _each(app, bench, window, wanted, f"{number}-inspect-{name}")
        else:
            _each(app, bench, window, wanted, f"{number}-{step.name}")
    window.enter_operator_mode()
    _settle(app, bench, 1.0)
    _each(app, bench, window, wanted, "9-operator")
    window.leave_operator_mode()


def _open_sample(app: QApplication, bench: Bench, window: MainWindow) -> None:
    """The finished sample, with features measured on it and a repeat."""
    window.projects.open_sample()
    _wait(app, lambda: window.model.is_open and not bench.measuring.busy, PATIENCE_S)
    assert window.model.folder is not None
    _write_nominal(window.model.folder / NOMINAL)
    window.go_to("inspect")
    inspect: Any = window.presenters["inspect"]
    _wait(app, lambda: inspect.scan.view is not None, PATIENCE_S)
    inspect.repeats.add()
    inspect.features.put_plan(PLAN, "features")
    inspect.features.measure()
    _wait(app, lambda: not inspect.features.measuring, PATIENCE_S)
    _make_report(app, window)


def _make_report(app: QApplication, window: MainWindow) -> None:
    """The report of what there is now."""
    report: Any = window.presenters["report"]
    report.do_run()
    _wait(app, lambda: report.stage is Stage.MADE, PATIENCE_S)


def _inspect_tabs(app: QApplication, bench: Bench, window: MainWindow) -> Iterator[str]:
    """Name after name of what there is to be seen on the inspect page, each shown before it is named."""
    inspect, page = cast(Any, window.presenters["inspect"]), cast(Any, window.pages["inspect"])
    studies = tab_titled(page.tabs, "Studies").studies

    def shown(tab: Any, feature: str = "") -> None:
        page.tabs.setCurrentWidget(tab)
        inspect.features.choose(feature)
        _settle(app, bench, 1.0)

    for name, tab, feature in (
        ("surface", page.surface, ""),
        ("feature", page.surface, "top"),
        ("parallelism", page.surface, "top to table"),
        ("perpendicularity", page.surface, "flank to table"),
        ("deviations", page.surface, "nominal"),
        ("picture", page.picture, "profile"),
        ("plot", page.plot, "profile"),
        ("histogram", page.plot, "nominal"),
        ("repeats", page.series, ""),
        ("no-studies", tab_titled(page.tabs, "Studies"), ""),
    ):
        shown(tab, feature)
        if feature:
            _side_to(page, page.features.form)
        yield name
    studies.begin("grr")
    studies.write(_published_study())
    studies.set_value("tolerance_mm", 4.0)
    yield "study-editor"
    studies.finish()
    _wait(app, lambda: studies.study is not None, PATIENCE_S)
    yield "studies"
    studies.begin("series")
    studies.write("\n".join(["value", *(f"{value:.3f}" for value in PISTON_RINGS.ravel())]))
    for key, value in (("name", "bore"), ("nominal_mm", 74.0), ("tolerance_mm", 0.05), ("size", 5)):
        studies.set_value(key, value)
    studies.finish()
    _wait(app, lambda: studies.draft is None, PATIENCE_S)
    _settle(app, bench, 1.0)
    yield "series"
    for key, value in (("primary", "table"), ("at 20 °C", True), ("with master", True), ("name", "Block 50 no. 7")):
        inspect.conditions.set_value(key, value)
    shown(page.surface)
    page.conditions_fold.expand(animate=False)
    _wait(app, lambda: not inspect.features.measuring, PATIENCE_S)
    _settle(app, bench, 0.5)
    _side_to(page, page.conditions_fold)
    yield "conditions"
    page.conditions_fold.collapse(animate=False)
    _wait(app, lambda: not bench.measuring.busy, PATIENCE_S)
    page.surface.choices.shapes["mesh"].click()
    _settle(app, bench, 3.0)
    yield "mesh"
    page.surface.choices.shapes["points"].click()
    inspect.cut.show(True)
    inspect.cut.hide(1)
    inspect.cut.turn_to(25.0, 0.0)
    yield "cut"
    inspect.cut.show(False)
    page.layer_folds["comparison"].expand(animate=False)
    comparison = inspect.layers["layer comparison"].layer
    comparison.set_value("align", "best fit")
    comparison.compare(inspect.model.folder / NOMINAL)
    _wait(app, lambda: comparison.shown is not None, PATIENCE_S)
    _settle(app, bench, 0.5)
    _side_to(page, page.layer_folds["comparison"])
    yield "comparison"
    page.layer_folds["comparison"].collapse(animate=False)


def _side_to(page: Any, widget: QWidget) -> None:
    """Scroll the side panel so that `widget` begins at its top."""
    QApplication.processEvents()
    for area in page.findChildren(QScrollArea):
        inside = area.widget()
        if inside is not None and inside.isAncestorOf(widget):
            area.verticalScrollBar().setValue(widget.mapTo(inside, QPoint(0, 0)).y())


def _write_nominal(path: Path) -> None:
    """The sample's block as a designer would draw it, from the program's own scene."""
    corners = gauge_block(50.0).triangles
    triangles = np.arange(3 * len(corners)).reshape(-1, 3)
    vertices = corners.reshape(-1, 3)
    write_stl(path, Mesh(vertices, np.zeros_like(vertices), np.zeros(len(vertices)), triangles))


def _published_study() -> str:
    """AIAG's example of a gauge R&R study."""
    cells = np.ndenumerate(AIAG)
    rows = [f"{part + 1};{'ABC'[operator]};{value:.2f}" for (part, operator, _), value in cells]
    return "\n".join(["part;operator;value", *rows])


def _readme(app: QApplication, bench: Bench, window: MainWindow, folder: Path) -> None:
    """The pictures of README and manual: few colours are enough, and keep them small."""
    window.resize(README_SIZE)
    _open_sample(app, bench, window)
    for name in README:
        window.go_to(name)
        if name == "inspect":
            page: Any = window.pages[name]
            page.presenter.features.choose("top")
            _settle(app, bench, 1.0)
            _side_to(page, page.features.form)
        _settle(app, bench, 8.0)
        _drawn(app, bench, window, name)
        window.statusBar().clearMessage()  # it may name a folder of this machine
        if name == "project":
            cast(Any, window.pages[name]).place.setText(str(Path("projects", "Sample")))  # as well
        _settle(app, bench, 0.3)
        small = grab(window).scaledToWidth(README_WIDTH, Qt.TransformationMode.SmoothTransformation)
        path = folder / f"{name}.png"
        small.save(str(path))
        with Image.open(path) as picture:
            flat = picture.convert("RGB").quantize(256, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
        flat.save(path, optimize=True)


def _each(app: QApplication, bench: Bench, window: MainWindow, wanted: _Wanted, name: str) -> None:
    for theme in wanted.themes:
        bench.settings.theme = theme
        for size in wanted.sizes:
            window.resize(size)
            window.move(0, 0)  # one as large as the screen would lie partly beside it
            _settle(app, bench, 0.7)
            path = wanted.folder / f"{wanted.prefix}{name}-{theme}-{size.width()}x{size.height()}.png"
            grab(window).save(str(path))


def _drawn(app: QApplication, bench: Bench, window: MainWindow, step: str) -> None:
    """Wait for the report's pages, which are drawn by another process."""
    if step == "report":
        report: Any = window.presenters[step]
        _wait(app, lambda: report.pages and not report.drawing, PATIENCE_S)
        _settle(app, bench, 1.0)


def grab(window: MainWindow) -> QImage:
    """The window as it is on the screen, 3D views included (they draw themselves, past Qt)."""
    screen = window.screen()
    shot = screen.grabWindow(window.winId()) if QApplication.platformName() == "xcb" else window.grab()
    image = shot.toImage().convertToFormat(QImage.Format.Format_RGB32)
    image.setDevicePixelRatio(1.0)  # all its pixels, whatever the scale
    flat = QImage(image.size(), QImage.Format.Format_RGB32)
    painter = QPainter(flat)
    painter.drawImage(0, 0, image)
    painter.end()
    return flat


def _settle(app: QApplication, bench: Bench, seconds: float) -> None:
    until = time.monotonic() + seconds
    _wait(app, lambda: time.monotonic() > until and not bench.quick.busy and not is_polishing(app), PATIENCE_S)
    for _ in range(TURNS):
        app.processEvents()


def _wait(app: QApplication, done: Callable[[], bool], seconds: float) -> None:
    until = time.monotonic() + seconds
    while not done():
        if time.monotonic() > until:
            raise TimeoutError("the window did not get there")
        app.processEvents()
        time.sleep(0.01)


if __name__ == "__main__":
    sys.exit(main())
