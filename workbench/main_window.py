"""The frame: rail, pages with Back and Next, status bar, messages. It knows steps only through their table."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from PySide6.QtCore import QCoreApplication, QEvent, QSize, Qt
from PySide6.QtGui import QCloseEvent, QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import (
    QDockWidget,
    QHBoxLayout,
    QLabel,
    QMainWindow,
    QPushButton,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from workbench.bench import Bench
from workbench.menus import Menus
from workbench.notices import Notice
from workbench.pages.presenter import StepPresenter
from workbench.pages.project_doors import ProjectDoors
from workbench.pages.step_page import StepPage
from workbench.pages.welcome_page import WelcomePage
from workbench.remaining import Remaining, in_words
from workbench.steps import STEPS
from workbench.tasks import Task
from workbench.theme import icon
from workbench.views.notice_list import Banner, NoticeList
from workbench.views.step_rail import StepRail
from workbench.views.task_bar import TaskBar


class MainWindow(QMainWindow):
    """The workbench's one window."""

    def __init__(self, bench: Bench) -> None:
        super().__init__()
        self.bench, self.model = bench, bench.model
        self.setWindowTitle("Trisect")
        self.setMinimumHeight(680)  # how wide it must be, its pages know
        self.resize(1280, 800)
        self.setAcceptDrops(True)
        self.doors = ProjectDoors(bench, self)
        self.presenters: dict[str, StepPresenter] = {step.name: step.presenter(bench) for step in STEPS}
        self.pages: dict[str, StepPage] = {step.name: step.page(self.presenters[step.name]) for step in STEPS}
        self.rail = StepRail([(step.name, _step(step.title), step.icon) for step in STEPS])
        self.banner, self.notice_list, self.task_bar = Banner(), NoticeList(), TaskBar()
        self.welcome = WelcomePage(self.doors)
        self._title, self._help = QLabel(), QLabel()
        self._title.setObjectName("title")
        self._help.setObjectName("muted")
        self.missing = QLabel()
        self.missing.setObjectName("muted")
        self.back = QPushButton(self.tr("Back"))
        self.next = QPushButton(self.tr("Next"))
        self.next.setProperty("primary", True)
        self._stack, self._pages = QStackedWidget(), QStackedWidget()
        for page in self.pages.values():
            self._pages.addWidget(page)
        self._stack.addWidget(self.welcome)
        self._stack.addWidget(self._wizard())
        self.setCentralWidget(self._stack)
        self._current = ""
        self._task: Task | None = None
        self._remaining = Remaining({})
        self.log_file: Path | None = None
        self.messages = self._messages_dock()
        self.menus = Menus(self)
        self._connect()
        self._dress()
        if layout := bench.settings.layout("window"):
            self.restoreGeometry(layout)
        self._project_opened()

    @property
    def current(self) -> str:
        """The name of the step shown, or "" on the welcome page."""
        return self._current

    def go_to(self, name: str) -> None:
        """Show the page of a step."""
        if not self.model.is_open or name == self._current:
            return
        if self._current:
            self.presenters[self._current].left()
        self._current = name
        self._pages.setCurrentWidget(self.pages[name])
        self.rail.set_current(name)
        step = next(step for step in STEPS if step.name == name)
        self._title.setText(_step(step.title))
        self._help.setText(_step(step.help))
        self.presenters[name].entered()
        self._refresh()

    def go(self, by: int) -> None:
        """Back (−1) or Next (1)."""
        names = [step.name for step in STEPS]
        if not self._current:
            return
        place = names.index(self._current) + by
        if 0 <= place < len(names) and (by < 0 or not self.presenters[self._current].blocker()):
            self.go_to(names[place])

    def presenter_action(self, name: str) -> None:
        """Call what a shortcut means on the current page ("run", "accept", "live", "capture"), if it has it."""
        action = getattr(self.presenters.get(self._current), f"do_{name}", None)
        if action is not None:
            action()

    def cancel_task(self) -> None:
        """Cancel the running job."""
        if self._task is not None:
            self.task_bar.cancelling()
            self._task.cancel()

    def closeEvent(self, event: QCloseEvent) -> None:
        if not self.doors.may_leave([presenter.busy() for presenter in self.presenters.values()]):
            event.ignore()
            return
        for presenter in self.presenters.values():
            presenter.stop()
        self.bench.settings.keep_layout("window", self.saveGeometry())
        self.bench.settings.flush()
        for page in self.pages.values():
            page.close()
        self.bench.close()
        event.accept()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "menus"):
            self._dress()

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        if _dropped(event):
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        path = _dropped(event)
        if path is not None:
            self.doors.open_dropped(path)

    def _wizard(self) -> QWidget:
        head = QVBoxLayout()
        head.setContentsMargins(14, 8, 14, 2)
        head.setSpacing(1)
        head.addWidget(self._title)
        head.addWidget(self._help)
        foot = QHBoxLayout()
        foot.setContentsMargins(14, 6, 14, 8)
        foot.addWidget(self.back)
        foot.addStretch(1)
        foot.addWidget(self.missing)
        foot.addWidget(self.next)
        column = QVBoxLayout()
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(2)
        column.addLayout(head)
        column.addWidget(self.banner)
        column.addWidget(self._pages, 1)
        column.addLayout(foot)
        whole = QWidget()
        row = QHBoxLayout(whole)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(0)
        row.addWidget(self.rail)
        row.addLayout(column, 1)
        return whole

    def _messages_dock(self) -> QDockWidget:
        dock = QDockWidget(self.tr("Messages"), self)
        dock.setObjectName("messages")
        dock.setWidget(self.notice_list)
        dock.setFeatures(QDockWidget.DockWidgetFeature.DockWidgetClosable)
        self.addDockWidget(Qt.DockWidgetArea.BottomDockWidgetArea, dock)
        dock.hide()
        self._messages_button = QPushButton(self.tr("Messages"))
        self._messages_button.setFlat(True)
        self._messages_button.setIconSize(QSize(14, 14))
        self._messages_button.clicked.connect(lambda: dock.setVisible(not dock.isVisible()))
        self.statusBar().addPermanentWidget(self.task_bar)
        self.statusBar().addPermanentWidget(self._messages_button)
        return dock

    def _dress(self) -> None:
        self._messages_button.setIcon(icon("mdi6.message-text-outline"))
        self.back.setIcon(icon("mdi6.chevron-left"))

    def _connect(self) -> None:
        self.rail.chosen.connect(self.go_to)
        self.back.clicked.connect(lambda: self.go(-1))
        self.next.clicked.connect(lambda: self.go(1))
        self.model.opened.connect(self._project_opened)
        self.model.changed.connect(self._refresh)
        self.model.results_changed.connect(self._refresh)
        self.model.modified.connect(lambda _: self._show_name())
        self.model.failed.connect(lambda text: self.bench.notices.error(text))
        for presenter in self.presenters.values():
            presenter.changed.connect(self._refresh)
            presenter.go_to.connect(self.go_to)
        self.bench.notices.added.connect(self._on_notice)
        lane = self.bench.measuring
        lane.task_started.connect(self._task_started)
        lane.task_ended.connect(self._task_ended)
        self.task_bar.cancel_pressed.connect(self.cancel_task)
        self.task_bar.tick.connect(self._show_progress)
        self.doors.go_to.connect(self.go_to)

    def _project_opened(self) -> None:
        self.banner.hide()
        if self.model.is_open:
            self._stack.setCurrentIndex(1)
            self._current = ""
            self.go_to("project")
        else:
            self._current = ""
            self._stack.setCurrentIndex(0)
            self.welcome.refresh()
        self._show_name()
        self._refresh()

    def _refresh(self, *_: Any) -> None:
        self.menus.refresh()
        if not self.model.is_open:
            return
        states = self.model.states
        self.rail.set_states({name: (str(state.state), state.sentence) for name, state in states.items()})
        last = self._current == STEPS[-1].name
        missing = self.presenters[self._current].blocker() if self._current else ""
        self.next.setEnabled(not missing and not last)
        self.next.setVisible(not last)
        self.next.setToolTip(missing or self.tr("Go on to the next step"))
        self.missing.setText("" if last else missing)
        self.back.setEnabled(self._current != STEPS[0].name)

    def _show_name(self) -> None:
        if not self.model.is_open:
            self.setWindowTitle("Trisect")
            self.setWindowModified(False)
            return
        name = self.model.project.info.name or self.tr("Unnamed project")
        self.setWindowTitle(f"{name}[*] – Trisect")
        self.setWindowModified(self.model.is_modified)

    def _on_notice(self, notice: Notice) -> None:
        self.notice_list.add(str(notice.level), notice.text, notice.details, notice.at.strftime("%H:%M:%S"))
        if notice.level != "info":
            (self.banner if self.model.is_open else self.welcome.banner).show_notice(
                str(notice.level), notice.text, notice.details
            )
        else:
            self.statusBar().showMessage(notice.text, 8000)
        self._messages_button.setText(self.tr("Messages ({0})").format(self.notice_list.count()))

    def _task_started(self, task: Task) -> None:
        self._task = task
        self._stage = ""
        self._remaining = Remaining(self.bench.settings.stage_seconds(task.label))
        task.progressed.connect(self._task_progressed)
        task.done.connect(lambda _: self.bench.settings.keep_stage_seconds(task.label, self._remaining.finish()))
        self.task_bar.begin(task.label)

    def _task_progressed(self, stage: str, done: int, total: int) -> None:
        self._stage = stage
        self._remaining.tell(stage, done, total)
        self._show_progress()

    def _show_progress(self) -> None:
        if self._task is None or self._task.cancelling:
            return
        left = self._remaining.left
        words = self.tr("about {0} left").format(in_words(left)) if left is not None else ""
        self.task_bar.progress(self._task.label, self._stage, self._remaining.share, words)

    def _task_ended(self, task: Task) -> None:
        if task is self._task:
            self._task = None
            self.task_bar.end()


def _dropped(event: QDragEnterEvent | QDropEvent) -> Path | None:
    urls = [url for url in event.mimeData().urls() if url.isLocalFile()]
    return Path(urls[0].toLocalFile()) if urls else None


def _step(text: str) -> str:
    return QCoreApplication.translate("Steps", text)
