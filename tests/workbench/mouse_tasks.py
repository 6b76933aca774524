"""Tasks done in the real window with the mouse, as a new user would: python -m tests.workbench.mouse_tasks [NAME …].

Every action is a click on something that is in sight, or text that cannot be clicked; the program's own waiting is
timed apart. How long a person takes over the actions is told by the keystroke-level model: 1.35 s to find each, 1.1 s
to point and 0.2 s to click, 0.28 s a key; a panel that has to be scrolled is one more.
What the system's own windows for files take, where the tests' answer stands in, is counted as two clicks.

References
----------
Card, Moran, Newell, The keystroke-level model for user performance time with interactive systems, Communications of
the ACM 23 (1980), doi:10.1145/358886.358895.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np
from PySide6.QtCore import QPoint, Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QApplication,
    QComboBox,
    QDialogButtonBox,
    QLabel,
    QLineEdit,
    QMenu,
    QScrollArea,
    QWidget,
)

from core.files.project.folder import source_folder
from core.pipeline.project.sample_project import sample_project
from core.simulate.sample import sample_folder
from tests.workbench.running import ROOT
from tests.workbench.screenshots import grab
from workbench import first_measurement as first
from workbench.app import Application, build_window
from workbench.bench import Bench, make_bench
from workbench.main_window import MainWindow
from workbench.settings import AppSettings
from workbench.views import ask

LEFT = Qt.MouseButton.LeftButton
FIND_S, POINT_S, CLICK_S, KEY_S = 1.35, 1.1, 0.2, 0.28
FILE_CLICKS = 2
SOON_MS = 300
PATIENCE_S = 1800.0
"""A busy machine compiles for long at a first start."""
PICTURES = os.environ.get("TRISECT_TASK_PICTURES", "")
"""A folder for a picture of the window before each click, to see what a person had before them."""
ONE = "one"
"""Said by the program to itself."""


@dataclass
class Effort:
    """What a task took: clicks, turns of the wheel, keys, and the program's own seconds."""

    clicks: int = 0
    scrolls: int = 0
    keys: int = 0
    waited_s: float = 0.0

    @property
    def hand_s(self) -> float:
        """Seconds a person takes by the model, without waiting."""
        return (self.clicks + self.scrolls) * (FIND_S + POINT_S + CLICK_S) + self.keys * KEY_S


class Mouse:
    """Clicks what is in sight of one window, and counts."""

    def __init__(self, app: QApplication, bench: Bench, window: MainWindow) -> None:
        self.app, self.bench, self.window, self.effort = app, bench, window, Effort()

    def until(self, done: Callable[[], Any], what: str) -> None:
        """Let the program work."""
        begun = time.monotonic()
        while not done():
            if time.monotonic() - begun > PATIENCE_S:
                raise TimeoutError(f"waited for {what} on page {self.window.current!r}")
            self.app.processEvents()
            time.sleep(0.01)
        self.effort.waited_s += time.monotonic() - begun

    def idle(self) -> None:
        """Wait until nothing is measured or read."""
        self.until(lambda: not (self.bench.measuring.busy or self.bench.quick.busy), "the program to be done")

    def click(self, widget: QWidget, at: QPoint | None = None) -> None:
        """Click a widget once it can be, after scrolling to it where it is not in sight."""
        self.until(lambda: widget.isVisible() and widget.isEnabled(), f"{widget.accessibleName()} {widget.toolTip()}")
        place = widget.rect().center() if at is None else at
        if not widget.visibleRegion().contains(place):
            self._scroll_to(widget)
            self.until(lambda: widget.visibleRegion().contains(place), f"{widget} to be in sight")
        self._picture()
        self.effort.clicks += 1
        QTest.mouseClick(widget, LEFT, pos=place)
        self.app.processEvents()

    def menu(self, *titles: str) -> None:
        """Click through the window's menus: a title, and what is below it."""
        bar = self.window.menuBar()
        action = next(one for one in bar.actions() if one.text().replace("&", "") == titles[0])
        self.click(bar, bar.actionGeometry(action).center())
        self.below(cast(Any, action.menu()), titles[1:])

    def drop_down(self, button: QWidget, *titles: str) -> None:
        """Click a button with a menu, and what is in it; the menu holds everything up until then."""
        menu = next(one for one in button.findChildren(QMenu) if one.actions())
        QTimer.singleShot(SOON_MS, lambda: self.below(menu, titles))
        self.click(button)

    def choose(self, box: QComboBox, text: str) -> None:
        """Click a list that folds out, and an entry."""
        self.click(box)
        view = box.view()
        self.until(view.isVisible, "the list to fold out")
        index = box.model().index(box.findText(text), box.modelColumn())
        view.scrollTo(index)
        self._pause()
        self.click(view.viewport(), view.visualRect(index).center())
        self.until(lambda: not view.isVisible(), "the list to be folded")

    def write(self, field: QLineEdit, text: str, *, has_focus: bool = False) -> None:
        """Click a field and type."""
        if not has_focus:
            self.click(field)
        self.effort.keys += len(text)
        QTest.keyClicks(field, text)

    def key(self, widget: QWidget, key: Qt.Key) -> None:
        """One key, where only that does it."""
        self.effort.keys += 1
        QTest.keyClick(widget, key)
        self.app.processEvents()

    def step(self, name: str) -> None:
        """Go to a step by the rail."""
        self.click(self.window.rail._buttons[name])
        self.until(lambda: self.window.current == name, f"the page {name}")

    def activate(self) -> None:
        """Have the window in front, as a menu that closed leaves it where there is a window manager."""
        self.window.activateWindow()
        self.until(self.window.isActiveWindow, "the window to be in front")

    def _picture(self) -> None:
        """The window as it is before a click, into the folder that is named for that."""
        if PICTURES:
            QTest.qWait(SOON_MS)
            grab(self.window).save(str(Path(PICTURES) / f"{time.strftime('%H%M%S')}-{self.effort.clicks:02d}.png"))

    def _pause(self) -> None:
        """As long as a list or a dialog takes no click, lest it be the one that opened it."""
        QTest.qWait(2 * QApplication.doubleClickInterval())

    def press(self, words: str) -> None:
        """Click a button that is in sight, by how what stands on it begins."""

        def found() -> QAbstractButton | None:
            buttons = self.window.findChildren(QAbstractButton)
            return next((one for one in buttons if one.isVisible() and _says(one).startswith(words)), None)

        self.until(found, words)
        self.click(cast(QWidget, found()))

    def below(self, menu: QMenu, titles: tuple[str, ...]) -> None:
        """Click through a menu that is open."""
        self.until(menu.isVisible, "the menu")
        action = next(one for one in menu.actions() if one.text().replace("&", "") == titles[0])
        self.click(menu, menu.actionGeometry(action).center())
        if titles[1:]:
            self.below(cast(Any, action.menu()), titles[1:])

    def _scroll_to(self, widget: QWidget) -> None:
        self.effort.scrolls += 1
        above = widget.parentWidget()
        while above is not None:
            if isinstance(above, QScrollArea):
                above.ensureWidgetVisible(widget)
            above = above.parentWidget()
        self.app.processEvents()


def _is_in(widget: QWidget | None, around: QWidget | None) -> bool:
    return widget is not None and around is not None and (widget is around or around.isAncestorOf(widget))


def _says(button: QAbstractButton) -> str:
    return button.text().replace("&", "")


def first_measurement(m: Mouse) -> None:
    """From the welcome page to the report, doing what the line at the top says."""
    bar, told = m.window.instructions, {one.text: one for one in first.ORDER}
    m.click(m.window.welcome.first)
    m.until(bar.isVisible, "the instructions")
    while (now := told.get(bar.words.text())) is not first.FINISHED:
        if now is None:
            m.until(lambda: bar.words.text() in told, "the next instruction")
            continue
        if m.window.current != now.page:
            m.click(m.window.next)
            continue
        page: Any = m.window.pages[now.page]
        if now is first.PROJECT:
            operator = next(one for one in page.findChildren(QLineEdit) if one.accessibleName() == "Operator")
            m.write(operator, "Ann")
            m.click(m.window.next)
        else:
            m.click(page.card.buttons[now.button])
        before = now.text
        m.until(lambda: bar.words.text() != before, f"what comes after {before}")  # noqa: B023  asked at once
    m.idle()
    assert "report" in m.window.model.results


def next_part(m: Mouse) -> None:
    """Another part of the same kind: plan, limits and report of the last one, its own pictures, its own number."""
    assert m.window.model.folder is not None
    pictures = source_folder(m.window.model.folder, m.window.model.project.sources.scan)
    assert pictures is not None

    def fill() -> None:
        dialog: Any = QApplication.activeModalWidget()
        m.write(dialog.serial, "0815", has_focus=dialog.serial.hasFocus())
        m.click(dialog.buttons.button(QDialogButtonBox.StandardButton.Ok))

    before = m.window.model.folder
    QTimer.singleShot(2 * SOON_MS, fill)
    m.menu("File", "Next part …")
    m.until(lambda: m.window.model.folder not in (before, None), "the next part's project")
    m.idle()
    assert m.window.current == "scan"
    scan: Any = m.window.pages["scan"]
    ask.choose_folder = lambda *_: pictures
    m.effort.clicks += FILE_CLICKS
    m.click(scan.source.browse)
    m.idle()
    m.click(scan.card.buttons["whole"])
    m.until(lambda: "report" in m.window.model.results, "the report")
    m.idle()


def why_poor(m: Mouse) -> None:
    """Which view a calibration fits worst, and where in it."""
    m.step("camera")
    page: Any = m.window.pages["camera"]
    views = page.views
    worst = max(range(len(views.model.rows)), key=lambda row: views.model.rows[row].value or 0.0)
    index = views.model.index(worst, 1)
    views.table.scrollTo(index)
    m.click(views.table.viewport(), views.table.visualRect(index).center())
    m.idle()
    assert page.presenter.current == views.model.rows[worst].name


def step_by_clicking(m: Mouse) -> None:
    """The height of the upper face over the lower one, clicked in 3D."""
    m.step("inspect")
    inspect, page = cast(Any, m.window.presenters["inspect"]), cast(Any, m.window.pages["inspect"])
    m.until(lambda: inspect.scan.view is not None, "the surface")
    m.idle()
    surface, view, count = page.surface, inspect.scan.view, len(inspect.features.plan.features)
    bar = next(
        one for one in surface.scene.findChildren(QWidget) if hasattr(one, "widgetForAction")
        and one.widgetForAction(surface.clicks["step"]) is not None
    )  # fmt: skip
    m.click(bar.widgetForAction(surface.clicks["step"]))
    canvas = surface.scene._canvas
    for face in (1, 2):
        places = view.points[view.face == face]
        spots = surface.scene.screen_positions(places)
        spot = spots[np.argmin(np.linalg.norm(spots - np.median(spots, axis=0), axis=1))]
        m.click(canvas, QPoint(round(spot[0]), round(spot[1])))
        m.until(lambda: inspect.clicked.proposal is not None, "a face")
        m.until(lambda: len(inspect.clicked.proposal.faces) == face and not m.bench.quick.busy, "the face")  # noqa: B023
    m.key(canvas, Qt.Key.Key_Return)
    m.until(lambda: len(inspect.features.plan.features) > count, "the feature")
    m.until(lambda: not inspect.features.measuring and inspect.features.shown is not None, "its value")


def report_in_chinese(m: Mouse) -> None:
    """From a finished measurement to its report in Chinese."""
    m.step("report")
    page: Any = m.window.pages["report"]
    m.choose(page.language, "中文")
    m.click(page.make)
    m.until(lambda: "report" in m.window.model.results and not m.bench.measuring.busy, "the report")
    m.idle()
    assert m.window.model.project.report.language == "zh_CN"


SCENE = "scale = 0.25\nseed = 3\n"
"""Of the simulated rig, which otherwise renders pictures of full size while it is watched."""
VIEWS, POSES, FRAMES = 8, 6, 60
"""So many are recorded live."""


def simulated_tour(m: Mouse) -> None:
    """From the welcome page to the report on the simulated rig, live."""
    scene = Path(tempfile.mkdtemp()) / "small.toml"
    scene.write_text(SCENE)
    m.click(m.window.welcome.simulated)
    m.until(lambda: m.window.current == "camera", "the camera page")
    for step, wanted in (("camera", VIEWS), ("planes", POSES)):
        page: Any = m.window.pages[step]
        live = page.presenter.live
        m.until(lambda: not live.settings.looking, "the scenes to be listed")  # noqa: B023  asked at once
        if step == "camera":
            live.settings.set_id(str(scene))  # smaller pictures, for time: no part of the task
        m.press("Start live")
        m.until(lambda: live.recorded >= wanted or not live.running, f"{wanted} pictures")  # noqa: B023
        if live.running:
            m.press("Stop")
        m.click(page.card.buttons["accept"])
        m.click(m.window.next)
    scan: Any = m.window.pages["scan"]
    m.until(lambda: scan.presenter.work.fan is not None, "the calibrations to be read")
    m.press("Start live")
    m.until(lambda: scan.presenter.live.recorded >= FRAMES, f"{FRAMES} frames")
    m.press("Stop")
    m.until(lambda: "gauge" in m.window.model.results, "the thickness")
    m.idle()
    m.click(m.window.next)
    m.click(m.window.next)
    m.click(cast(Any, m.window.pages["report"]).make)
    m.until(lambda: "report" in m.window.model.results, "the report")
    m.idle()


def own_recording(m: Mouse) -> None:
    """A folder of pictures with its rig.toml, recorded elsewhere: to the report."""
    folder = sample_folder()
    ask.choose_folder = lambda *_: folder
    m.effort.clicks += FILE_CLICKS

    def confirm() -> None:
        dialog: Any = QApplication.activeModalWidget()
        m.click(dialog.findChild(QDialogButtonBox).button(QDialogButtonBox.StandardButton.Ok))

    QTimer.singleShot(2 * SOON_MS, confirm)
    m.click(m.window.welcome.from_set)
    m.until(lambda: m.window.model.is_open, "the project")
    m.idle()
    m.press("Measure everything")
    m.until(lambda: "report" in m.window.model.results, "the report")
    m.idle()


def limits_to_pdf(m: Mouse) -> None:
    """The height of the upper face clicked in 3D, with limits, to the report."""
    step_by_clicking(m)
    page: Any = m.window.pages["inspect"]
    panel = page.features
    view = panel.list
    index = view.currentIndex()
    m.effort.clicks += 1
    view.customContextMenuRequested.emit(view.visualRect(index).center())
    m.below(panel._row_menu, ("Limits …",))
    m.activate()
    m.until(lambda: _is_in(QApplication.focusWidget(), panel.form.first_limit), "the field")
    for text in ("50", "-0.2", "0.2"):
        field: Any = QApplication.focusWidget()
        m.effort.keys += len(text) + 1
        field.selectAll()
        QTest.keyClicks(field, text)
        QTest.keyClick(field, Qt.Key.Key_Tab)
    m.idle()
    name = page.presenter.features.chosen
    m.until(lambda: (result := page.presenter.features.result(name)) and result.rows[0].verdict, "a verdict")
    m.step("report")
    m.click(cast(Any, m.window.pages["report"]).make)
    m.until(lambda: "report" in m.window.model.results and not m.bench.measuring.busy, "the report")
    m.idle()


def wrong_count(m: Mouse) -> None:
    """The board's columns are entered wrong: what the program does about it, to a calibrated camera."""
    m.step("camera")
    page: Any = m.window.pages["camera"]
    presenter = page.presenter
    m.idle()
    columns = presenter.target.target_values()["columns"]
    presenter.target.set_target("columns", columns + 1)  # the mistake, no part of the task
    m.effort = Effort()
    m.click(page.card.buttons["run"])
    m.until(lambda: presenter.counted is not None, "the right number to be seen")
    m.press("Take over")
    m.until(lambda: presenter.counted is None and not m.bench.measuring.busy, "the pictures to be searched again")
    m.idle()
    assert presenter.target.target_values()["columns"] == columns
    assert m.window.rail.state_of("camera") == "done", "it is the calibration that was accepted before"


def why_large(m: Mouse) -> None:
    """U is large: the page says why and what helps; the material was not stated, and is now."""
    m.step("inspect")
    page, presenter = cast(Any, m.window.pages["inspect"]), cast(Any, m.window.presenters["inspect"])
    scan = presenter.scan

    def measure() -> float:
        m.click(page.card.buttons["measure"])
        m.until(lambda: scan.gauge is not None and not scan.is_thickness_old, "the thickness")
        m.idle()
        return float(scan.gauge.U_mm)

    m.idle()
    presenter.part.set_value("material", "")  # the mistake, and what was measured with it, no part of the task
    before = measure()
    m.step("project")
    m.effort = Effort()
    m.step("inspect")
    told = "State the material, under The part."
    m.until(lambda: any(one.isVisible() and told in one.text() for one in m.window.findChildren(QLabel)), told)
    m.click(page.part_fold.toggleButton())
    m.until(page.part.isVisible, "the fold to open")
    m.choose(next(box for box in page.part.findChildren(QComboBox) if box.findText("Metal") >= 0), "Metal")
    after = measure()
    assert after < before / 2, f"U was {before:.4f} mm and is {after:.4f} mm"


TASKS: tuple[tuple[str, bool, Callable[[Mouse], None]], ...] = (
    ("First measurement", False, first_measurement),
    ("Next part with plan, limits and report of the last", True, next_part),
    ("Which view makes a calibration worst", True, why_poor),
    ("A step by clicking two faces", True, step_by_clicking),
    ("Report in Chinese", True, report_in_chinese),
    ("Tour on the simulated rig, live", False, simulated_tour),
    ("Own recorded set to the report", False, own_recording),
    ("Thickness by two clicks, with limits, to the PDF", True, limits_to_pdf),
    ("Board counted wrongly, to a camera", True, wrong_count),
    ("Why U is large, and mended", True, why_large),
)
"""Title, whether the finished sample is open when it begins, and what is done."""


def main(given: list[str]) -> int:
    """Do the tasks (those named), each in a program of its own, and print the manual's table.

    What it starts itself names one task, and the folders it is done in and on.
    """
    tasks = {do.__name__: (title, on_sample, do) for title, on_sample, do in TASKS}
    if given[:1] == [ONE]:
        _, name, place, on = given
        print(_row(tasks[name], Path(place), Path(on)), flush=True)
        return 0
    print("| task | clicks | scrolls | keys | hand, s | program, s |\n|---|---|---|---|---|---|", flush=True)
    failed = 0
    with tempfile.TemporaryDirectory() as home:
        sample = sample_project(Path(home) / "Sample")
        for name in given or tasks:
            here = Path(home) / name
            here.mkdir()
            did = subprocess.run(
                [sys.executable, "-m", "tests.workbench.mouse_tasks", ONE, name, here, sample], cwd=ROOT
            )
            failed += did.returncode != 0
    return failed


def _row(task: tuple[str, bool, Callable[[Mouse], None]], home: Path, sample: Path) -> str:
    title, on_sample, do = task
    app = Application(sys.argv[:1])
    bench, window = _window(app, home)
    mouse = Mouse(app, bench, window)
    if on_sample:
        window.projects.open_project(Path(shutil.copytree(sample, home / "Sample")))
        mouse.until(lambda: window.model.is_open, "the project")
        mouse.idle()
    mouse.effort = Effort()
    try:
        do(mouse)
    finally:
        bench.close()
        window.leave()
        bench.wait_until_closed()
    one = mouse.effort
    return f"| {title} | {one.clicks} | {one.scrolls} | {one.keys} | {one.hand_s:.0f} | {one.waited_s:.0f} |"


def _window(app: QApplication, home: Path) -> tuple[Bench, MainWindow]:
    bench = make_bench(AppSettings(home / "settings.ini"))
    bench.settings.projects_folder = home / "projects"
    window = build_window(app, bench, "light")
    window.resize(1280, 800)
    window.show()
    return bench, window


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
